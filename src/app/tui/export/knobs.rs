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
}

impl ExportKnobs {
    /// For a tree, none of them turned yet.
    pub fn new(tree: &Arc<Recipe>) -> Self {
        let all = tree.preset.knobs();
        let found = |name: &str| all.iter().find(|(row, _)| row.knob.name == name).map(|(row, _)| *row);
        let rows = KNOBS.into_iter().filter_map(found).collect();
        Self { tree: Arc::clone(tree), turned: tree.preset.clone(), rows }
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
        let rows = (0..self.rows.len()).filter_map(|row| self.row(row));
        let text =
            |knob: &PresetKnob, value: &Value| self.turned.text_of(knob).unwrap_or_else(|| value.to_string());
        rows.filter(|(.., differs)| *differs)
            .map(move |(knob, value, _)| (knob.knob.name, text(knob, &value)))
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

    /// The levels of detail that are written.
    pub fn levels(&self) -> usize {
        self.turned.dressing.detail.levels()
    }

    /// Whether all is as on screen.
    pub fn is_idle(&self) -> bool {
        self.turned().next().is_none()
    }
}
