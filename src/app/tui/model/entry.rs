//! Entries and rows of the list of presets.

use linden::preset::Preset;
use unicode_width::UnicodeWidthStr;

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
    /// Words that its document is found by; those of the user's are the library's.
    pub tags: Vec<String>,
    /// Why it cannot be read, if it cannot.
    pub fault: Option<String>,
    /// Whether its file is not there any more.
    pub is_gone: bool,
}

/// A row of the list.
#[derive(Clone, Debug, PartialEq)]
pub enum ListRow {
    /// A group's heading.
    Heading(GroupHeading),
    /// An entry, by its index, with the characters of its id that the filter matched.
    Entry(usize, Vec<u32>),
}

/// The heading of a group.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct GroupHeading {
    /// The group.
    pub group: String,
    /// How many entries it has.
    pub members: usize,
    /// Whether they are hidden; the cursor can be on such a heading.
    pub is_folded: bool,
}

/// Cells of an id, behind which names begin; longer ids push them on.
pub const ID_COLUMNS: usize = 9;

impl PresetEntry {
    /// What favourites are remembered by: the id of a built-in preset, the path of a file.
    pub fn key(&self) -> String {
        match &self.place {
            TreePlace::Builtin(id) => (*id).to_owned(),
            TreePlace::File(path) => path.to_string_lossy().into_owned(),
        }
    }

    /// Cells of its row: a mark, its id and its name.
    pub fn columns(&self) -> usize {
        2 + ID_COLUMNS.max(self.id.width()) + if self.says_more() { 2 + self.name.width() } else { 0 }
    }

    /// Whether its name says more than its id.
    pub fn says_more(&self) -> bool {
        !self.name.is_empty() && !self.name.eq_ignore_ascii_case(&self.id)
    }

    /// The entry of a file that was not read: its name is all that is known.
    pub fn unread(place: TreePlace, group: &str) -> Self {
        let id = match &place {
            TreePlace::Builtin(id) => (*id).to_owned(),
            TreePlace::File(path) => path.file_stem().unwrap_or_default().to_string_lossy().into_owned(),
        };
        let [name, summary, source] = [(); 3].map(|()| String::new());
        Self {
            place,
            id,
            name,
            group: group.to_owned(),
            summary,
            source,
            tags: Vec::new(),
            fault: None,
            is_gone: false,
        }
    }

    /// The entry of a preset.
    pub fn of(place: TreePlace, preset: &Preset) -> Self {
        Self {
            place,
            id: preset.id.clone(),
            name: preset.name.clone(),
            group: preset.group.clone(),
            summary: preset.summary.clone(),
            source: preset.source.clone(),
            tags: preset.tags.clone(),
            fault: None,
            is_gone: false,
        }
    }
}
