//! Derives the word of a grammar that is looked at module by module, with what the turtle draws for it.

use std::sync::Arc;

use linden::grow::{GrowError, grow_as};
use linden::lsystem::{LSystem, LsystemError, Traced, TracedModule, TurtleSettings, trace};
use linden::monitor::Holding;
use linden::recipe::Recipe;
use linden::skeleton::SkeletonError;
use linden::skeleton::refine::Refinement;
use linden_raster::Extent;
use unicode_width::UnicodeWidthStr;

use super::Watcher;
use super::grow::Plant;

/// A word that is wanted.
#[derive(Clone, Debug)]
pub struct WordRequest {
    /// Whose grammar.
    pub recipe: Arc<Recipe>,
    /// After how many steps.
    pub step: u32,
}

impl PartialEq for WordRequest {
    /// Recipes are compared by where they are.
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.recipe, &other.recipe) && self.step == other.step
    }
}

/// A word, or why there is none.
#[derive(Debug)]
pub struct Derivation {
    /// What was asked.
    pub request: WordRequest,
    /// The word.
    pub outcome: Result<Arc<DerivedWord>, NoWord>,
}

/// Why there is no word.
#[derive(Debug)]
pub struct NoWord {
    /// A sentence.
    pub why: String,
    /// The most steps, fewer than asked for, of which the word is known to be short enough.
    pub fits: Option<u32>,
}

/// A word with what the turtle draws for it, as the grammar says: neither refined nor edited.
#[derive(Debug)]
pub struct DerivedWord {
    /// What was asked.
    pub request: WordRequest,
    /// Its modules.
    pub traced: Traced,
    /// For each module the cells that it takes in [`short`].
    pub widths: Vec<u16>,
    /// What the turtle draws: none where it draws nothing, or cannot ([`Traced::undrawn`]).
    pub plant: Option<Plant>,
    /// What pictures frame.
    pub extent: Option<Extent>,
}

/// A module as the panel has it among others: its arguments rounded to four digits.
pub fn short(module: &TracedModule) -> String {
    let rounded = |argument: &f64| {
        let text = format!("{argument:.3e}");
        text.parse().map_or(text, |number: f64| number.to_string())
    };
    match &module.arguments[..] {
        [] => module.symbol.to_string(),
        arguments => {
            let arguments: Vec<String> = arguments.iter().map(rounded).collect();
            format!("{}({})", module.symbol, arguments.join(","))
        }
    }
}

/// Derives a word; `None` when it was cancelled.
pub fn derive(request: WordRequest, watcher: &Watcher<'_>) -> Option<Derivation> {
    match derived(&request, watcher) {
        Ok(word) => Some(Derivation { request, outcome: Ok(Arc::new(word)) }),
        Err(None) => None,
        Err(Some(no_word)) => Some(Derivation { request, outcome: Err(no_word) }),
    }
}

/// `Err(None)` when it was cancelled.
fn derived(request: &WordRequest, watcher: &Watcher<'_>) -> Result<DerivedWord, Option<NoWord>> {
    let preset = &request.recipe.preset;
    let no_grammar = || NoWord { why: "this tree grows without a grammar".to_owned(), fits: None };
    let lsystem = preset.settings::<LSystem>().ok_or_else(|| Some(no_grammar()))?;
    let settings = TurtleSettings { derivations: request.step, ..lsystem.turtle(preset.seed()) };
    let traced = trace(&lsystem.grammar, &settings, watcher).map_err(|error| match error {
        LsystemError::Cancelled(_) => None,
        error => {
            let fits = match error {
                LsystemError::TooManyToTrace { fits, .. }
                | LsystemError::TooManySymbols { fits, .. }
                | LsystemError::GrewPastLimit { fits, .. } => fits,
                _ => None,
            };
            Some(NoWord { why: error.to_string(), fits })
        }
    })?;
    let widths: Vec<u16> = traced.modules.iter().map(|module| short(module).width() as u16).collect();
    let modules = traced.modules.len() * (size_of::<TracedModule>() + size_of::<u16>());
    let holding = Holding::new(watcher, modules as u64);
    let plant = if traced.undrawn.is_none() { drawn(request, &holding)? } else { None };
    let extent = plant.as_ref().and_then(Plant::extent);
    Ok(DerivedWord { request: request.clone(), traced, widths, plant, extent })
}

/// What the turtle draws, exactly where it says.
fn drawn(request: &WordRequest, holding: &Holding<'_>) -> Result<Option<Plant>, Option<NoWord>> {
    let mut recipe = (*request.recipe).clone();
    if let Some(generator) = recipe.preset.generator.at_step(request.step) {
        recipe.preset.generator = generator;
    }
    recipe.preset.refinement = Refinement::default();
    recipe.preset.edits.clear();
    // As thick as a whole tree: that may be one that nobody could grow.
    match grow_as(&recipe, &|| Ok(None), holding) {
        Ok(grown) => Ok(Some(Plant { organs: Arc::clone(&grown.given), ..Plant::from(&grown) })),
        Err(GrowError::Cancelled(_)) => Err(None),
        Err(GrowError::Skeleton(SkeletonError::Empty)) => Ok(None),
        Err(error) => Err(Some(NoWord { why: error.to_string(), fits: None })),
    }
}
