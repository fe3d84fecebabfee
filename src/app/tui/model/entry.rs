//! Entries and rows of the list of presets.

use linden::preset::Preset;

use crate::tui::tree::TreePlace;

/// Something that can be shown.
#[derive(Clone, Debug)]
pub struct PresetEntry {
    /// Where it is.
    pub place: TreePlace,
    /// What scripts call it.
    pub id: String,
    /// What people call it.
    pub name: String,
    /// Where it is listed.
    pub group: String,
    /// One line: what it is.
    pub summary: String,
    /// Where it comes from.
    pub source: String,
    /// Why it cannot be read, if it cannot.
    pub fault: Option<String>,
}

/// A row of the list.
#[derive(Clone, Debug, PartialEq)]
pub enum ListRow {
    /// A group's heading.
    Heading(String),
    /// An entry, by its index, with the characters of its id that the filter matched.
    Entry(usize, Vec<u32>),
}

impl PresetEntry {
    /// The entry of a preset.
    pub fn of(place: TreePlace, preset: &Preset) -> Self {
        Self {
            place,
            id: preset.id.clone(),
            name: preset.name.clone(),
            group: preset.group.clone(),
            summary: preset.summary.clone(),
            source: preset.source.clone(),
            fault: None,
        }
    }
}
