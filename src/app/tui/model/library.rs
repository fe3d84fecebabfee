//! The list of presets: entries, rows, the filter, and changed trees that are not on screen.

use std::path::PathBuf;

use linden::preset::{Heading, Preset, builtins};

use super::entry::{ListRow, PresetEntry};
use super::filter;
use crate::config::presets::UserPreset;
use crate::tui::tree::{Tree, TreePlace};

/// The list of presets.
pub struct Library {
    /// All that can be shown, listed or not.
    pub entries: Vec<PresetEntry>,
    /// What was typed into the filter.
    pub filter: String,
    pub rows: Vec<ListRow>,
    /// The selected entry's index; survives filtering and reloading by its place.
    pub selected: usize,
    /// Changed trees that are not on screen.
    pub shelf: Vec<Tree>,
}

impl Library {
    /// What is built in.
    pub fn builtin() -> Self {
        // The tests read every built-in document.
        let entries = builtins().iter().filter_map(|builtin| {
            let Heading { name, group, summary, source } = builtin.heading().ok()?;
            let (place, id) = (TreePlace::Builtin(builtin.id), builtin.id.to_owned());
            Some(PresetEntry { place, id, name, group, summary, source, fault: None })
        });
        let mut library = Self {
            entries: entries.collect(),
            filter: String::new(),
            rows: Vec::new(),
            selected: 0,
            shelf: Vec::new(),
        };
        library.arrange();
        library
    }

    /// Puts the user's presets in the list, in the place of those that were there.
    pub fn set_user(&mut self, presets: Vec<UserPreset>) {
        let selected = self.entry().map(|entry| entry.place.clone());
        self.entries.retain(|entry| matches!(entry.place, TreePlace::Builtin(_)));
        self.entries.extend(presets.into_iter().map(|preset| PresetEntry {
            place: TreePlace::File(preset.path),
            id: preset.id,
            name: preset.name,
            group: if preset.group == "own" {
                "yours".to_owned()
            } else {
                format!("yours: {}", preset.group)
            },
            summary: preset.summary,
            source: preset.source,
            fault: preset.state.err().map(|complaint| complaint.to_string()),
        }));
        self.arrange();
        if let Some(place) = selected {
            self.select_place(&place);
        }
    }

    /// Makes sure that a file is listed: one that was named when the program was started, say.
    pub fn add_file(&mut self, path: PathBuf, preset: &Preset) {
        let place = TreePlace::File(path);
        if self.entries.iter().all(|entry| entry.place != place) {
            self.entries.push(PresetEntry { group: "opened".to_owned(), ..PresetEntry::of(place, preset) });
            self.arrange();
        }
    }

    /// The rows of the list.
    pub fn rows(&self) -> &[ListRow] {
        &self.rows
    }

    /// How many entries there are, listed or not.
    pub fn len(&self) -> usize {
        self.entries.len()
    }

    /// An entry by its index.
    pub fn get(&self, index: usize) -> &PresetEntry {
        &self.entries[index]
    }

    /// The ids and places of all that is listed, whatever the filter hides.
    pub fn places(&self) -> impl Iterator<Item = (&str, &TreePlace)> {
        self.entries.iter().map(|entry| (entry.id.as_str(), &entry.place))
    }

    /// The selected entry.
    pub fn entry(&self) -> Option<&PresetEntry> {
        self.entries.get(self.selected)
    }

    /// The row of the selected entry, `None` when the filter hides it.
    pub fn selected_row(&self) -> Option<usize> {
        self.rows.iter().position(|row| matches!(row, ListRow::Entry(index, _) if *index == self.selected))
    }

    /// Whether a tree of that place waits with changes.
    pub fn is_shelved(&self, place: &TreePlace) -> bool {
        self.shelf.iter().any(|tree| tree.place == *place)
    }

    /// Selects the entry of a place, if it is listed.
    pub fn select_place(&mut self, place: &TreePlace) -> bool {
        let found = self.entries.iter().position(|entry| entry.place == *place);
        self.selected = found.unwrap_or(self.selected.min(self.entries.len().saturating_sub(1)));
        found.is_some()
    }

    /// Sets the filter.
    pub fn filter_by(&mut self, text: &str) {
        text.clone_into(&mut self.filter);
        self.arrange();
    }

    /// Filters anew. The cursor stays where it is if it can, else it goes to the best match.
    fn arrange(&mut self) {
        self.rows = filter::rows(&self.entries, &self.filter);
        if self.selected_row().is_none() {
            let first =
                self.rows.iter().find_map(|row| if let ListRow::Entry(i, _) = row { Some(*i) } else { None });
            self.selected = first.unwrap_or(self.selected);
        }
    }

    /// Moves the cursor by a number of entries.
    pub fn step(&mut self, by: isize) {
        let listed: Vec<usize> = self
            .rows
            .iter()
            .filter_map(|row| if let ListRow::Entry(i, _) = row { Some(*i) } else { None })
            .collect();
        if let Some(at) = listed.iter().position(|&i| i == self.selected) {
            let to = at.saturating_add_signed(by).min(listed.len() - 1);
            self.selected = listed[to];
        }
    }
}
