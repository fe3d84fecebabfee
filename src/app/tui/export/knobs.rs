//! Knobs that are turned for one export, and stay as they are on screen.

use std::sync::Arc;

use linden::knob::Value;
use linden::preset::{Preset, PresetKnob};
use linden::recipe::Recipe;

use crate::tui::shape::nudge::{Nudge, nudged};

/// What is often turned for one export alone, in the order of the rows.
const KNOBS: [&str; 6] = ["triangles", "lods", "lod_triangles", "billboard", "wind", "season"];

/// The knobs of one export.
pub struct ExportKnobs {
    /// What is on screen.
    tree: Arc<Recipe>,
    /// The same with what is turned here.
    turned: Preset,
    /// Those of [`KNOBS`] that the tree has.
    rows: Vec<PresetKnob>,
    /// Those of the program that the files are for, which the tree has.
    suited: Vec<PresetKnob>,
    /// The names of those that are turned on screen.
    held: Vec<&'static str>,
}

impl ExportKnobs {
    /// For a tree, none of them turned yet but those that `held` has, on screen.
    pub fn new(tree: &Arc<Recipe>, held: Vec<&'static str>) -> Self {
        let all = tree.preset.knobs();
        let found = |name: &str| all.iter().find(|(row, _)| row.knob.name == name).map(|(row, _)| *row);
        let rows = KNOBS.into_iter().filter_map(found).collect();
        Self { tree: Arc::clone(tree), turned: tree.preset.clone(), rows, suited: Vec::new(), held }
    }

    /// Turns the knobs that suit a program; those of the one before are the tree's again. What was turned by hand, on
    /// screen or here, holds against it.
    pub fn suit(&mut self, knobs: &[(&'static str, &'static str)]) {
        for before in std::mem::take(&mut self.suited) {
            if let Some(text) = text_in(&self.tree.preset, &before) {
                // It is what the tree has.
                let _ = self.turned.set(before.knob.name, &text);
            }
        }
        let all = self.turned.knobs();
        for (name, value) in knobs {
            let knob = all.iter().find(|(knob, _)| knob.knob.name == *name).map(|(knob, _)| *knob);
            let knob = knob
                .filter(|knob| !self.held.contains(name) && !self.turned.differs(knob, &self.tree.preset));
            // What the tree has not is not asked of it.
            self.suited.extend(knob.filter(|_| self.turned.set(name, value).is_ok()));
        }
    }

    /// How many rows there are.
    pub fn len(&self) -> usize {
        self.rows.len()
    }

    /// A row's knob, its value here, and whether that is not the tree's.
    pub fn row(&self, row: usize) -> Option<(&PresetKnob, Value, bool)> {
        let knob = self.rows.get(row)?;
        let value = knob.read(&self.turned)?;
        let differs = self.turned.differs(knob, &self.tree.preset);
        Some((knob, value, differs))
    }

    /// Turns a row's knob; what is wrong with the text.
    pub fn set(&mut self, row: usize, text: &str) -> Result<(), String> {
        let Some(knob) = self.rows.get(row) else { return Ok(()) };
        self.turned.set(knob.knob.name, text).map_err(|error| error.to_string())
    }

    /// Turns a row's knob by one; whether that can be.
    pub fn nudge(&mut self, row: usize, up: bool) -> bool {
        let Some((knob, value, _)) = self.row(row) else { return false };
        let text = nudged(&knob.knob.kind, &value, up, Nudge::Usual);
        text.is_some_and(|text| self.set(row, &text).is_ok())
    }

    /// The names and values that are not the tree's.
    pub fn turned(&self) -> impl Iterator<Item = (&'static str, String)> {
        let differs = |knob: &&PresetKnob| self.turned.differs(knob, &self.tree.preset);
        let text = |knob: &PresetKnob| Some((knob.knob.name, text_in(&self.turned, knob)?));
        self.rows.iter().chain(&self.suited).filter(differs).filter_map(text)
    }

    /// Turns knobs by their names, as far as they can be.
    pub fn turn(&mut self, knobs: &[(&'static str, String)]) {
        for (name, text) in knobs {
            if self.rows.iter().any(|row| row.knob.name == *name) {
                // What another tree was given may not be for this one.
                let _ = self.turned.set(name, text);
            }
        }
    }

    /// The tree with what is turned here.
    pub fn preset(&self) -> &Preset {
        &self.turned
    }

    /// The levels of detail that are written.
    pub fn levels(&self) -> usize {
        self.turned.dressing.detail.levels()
    }

    /// Whether all is as on screen.
    pub fn is_idle(&self) -> bool {
        self.turned().next().is_none()
    }
}

/// A knob of a preset, as it is typed.
pub fn text_in(preset: &Preset, knob: &PresetKnob) -> Option<String> {
    preset.text_of(knob).or_else(|| knob.read(preset).map(|value| value.to_string()))
}
