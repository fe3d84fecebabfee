//! The ages that a tree is written at, as `--ages` says them.

use std::sync::Arc;

use linden::preset::{Age, Preset};
use linden::recipe::Recipe;

use super::dialog::ExportDialog;
use super::knobs::{ExportKnobs, text_in};
use crate::source::OF_AGE;
use crate::tui::tree::Tree;

impl ExportDialog {
    /// The ages that are written; none: the one that the tree has.
    pub fn chosen_ages(&self) -> Vec<Age> {
        self.ages_of(&self.ages).unwrap_or_default()
    }

    /// Reads a list of ages as `--ages` does; an empty one is none.
    ///
    /// # Errors
    /// What is wrong with it, or why this tree cannot be written at several.
    pub fn ages_of(&self, list: &str) -> Result<Vec<Age>, String> {
        let Some(preset) = self.knobs.as_ref().map(ExportKnobs::preset).filter(|_| !list.trim().is_empty())
        else {
            return Ok(Vec::new());
        };
        if let Some(knob) = self.age_turned {
            return Err(format!(
                "'{knob}' is turned, which says how old the tree is: reset it among the knobs first"
            ));
        }
        preset.ages_of(list).map_err(|error| error.to_string())
    }
}

/// The knob that says how old a tree is and was turned, if one was.
pub fn age_turned(tree: &Tree) -> Option<&'static str> {
    tree.turned().into_iter().find(|name| OF_AGE.contains(name))
}

/// A tree at some ages, by their names. What else was turned holds at all of them.
pub fn at_ages(
    recipe: &Recipe,
    ages: &[Age],
    turned: &[&'static str],
) -> Result<Vec<(String, Arc<Recipe>)>, String> {
    let at = |age: &Age| {
        let aged = recipe.preset.at_age(age).map_err(|error| error.to_string())?;
        let aged = with_turned(aged, &recipe.preset, turned)?;
        Ok((age.name.clone(), Arc::new(recipe.with_preset(aged))))
    };
    ages.iter().map(at).collect()
}

fn with_turned(mut aged: Preset, tree: &Preset, turned: &[&'static str]) -> Result<Preset, String> {
    let of_tree = tree.all_knobs();
    for name in turned {
        let knob = of_tree.iter().find(|(knob, _)| knob.knob.name == *name);
        if let Some(text) = knob.and_then(|(knob, _)| text_in(tree, knob)) {
            aged.set(name, &text).map_err(|error| error.to_string())?;
        }
    }
    Ok(aged)
}
