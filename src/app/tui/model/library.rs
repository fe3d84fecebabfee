//! The list of presets: entries, rows, the filter, and changed trees that are not on screen.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf, absolute};
use std::sync::OnceLock;

use linden::forest::{Forest, builtin_forests};
use linden::preset::{Heading, Preset, builtins};

use super::entry::{ListRow, PresetEntry};
use super::filter::Listing;
use crate::config::presets::UserPreset;
use crate::paths::show;
use crate::tui::forest::ForestOnScreen;
use crate::tui::tree::{Changes, Tree, TreePlace};

/// The group of files that were opened.
const OPENED: &str = "opened";
/// The group of the built-in forests.
pub const FORESTS: &str = "Forests";

/// The list of presets.
pub struct Library {
    /// All that can be shown, listed or not.
    pub entries: Vec<PresetEntry>,
    /// What was typed into the filter.
    pub filter: String,
    pub rows: Vec<ListRow>,
    /// The selected entry's index; survives filtering and reloading by its place.
    pub selected: usize,
    /// The folded group whose heading has the cursor; `None` where the selected entry has it.
    pub at_group: Option<String>,
    /// Groups whose entries are hidden.
    pub folded: BTreeSet<String>,
    /// Keys of marked entries ([`PresetEntry::key`]), which are listed first.
    pub favourites: BTreeSet<String>,
    /// Tags that the user gave, by the keys of entries.
    pub tags: BTreeMap<String, Vec<String>>,
    /// The place that was on screen before the one that is.
    pub before: Option<TreePlace>,
    /// While the filter is typed, and until what it found is read: where the user came from.
    pub passing: Option<Passing>,
    /// Changed trees that are not on screen.
    pub shelf: Vec<Tree>,
    /// Changed forests that are not on screen.
    pub forests: Vec<ForestOnScreen>,
    /// The first row that is shown, since the mouse chose one: it stays under the pointer while it is in sight.
    pub top: Option<usize>,
    /// The preset that was removed last, for as long as nothing else was done since.
    pub removed: Option<Removed>,
    /// Changes of the last session, of trees and forests whose documents were not read in this one.
    pub unread: Vec<(TreePlace, Changes)>,
}

/// A preset that was removed.
#[derive(Clone, Debug)]
pub struct Removed {
    /// Where it was.
    pub path: PathBuf,
    /// Where it is now.
    pub kept: PathBuf,
    /// How many steps could be undone of what came on screen then: those that came later are undone before.
    pub steps: usize,
}

/// Where the user was before trees passed by that nobody stays at: each key of the filter shows what it finds.
#[derive(Clone, Debug)]
pub struct Passing {
    /// What was on screen, or on its way there.
    pub from: Option<TreePlace>,
    /// The place before that one.
    before: Option<TreePlace>,
    /// Whether the next tree is the one that was found.
    ends: bool,
}

impl Library {
    /// From here on trees pass by: `shown` is on screen, `loading` on its way there.
    pub fn begin_passing(&mut self, shown: Option<&TreePlace>, loading: Option<&TreePlace>) {
        let before = shown.filter(|_| loading.is_some()).or(self.before.as_ref()).cloned();
        self.passing = Some(Passing { from: loading.or(shown).cloned(), before, ends: false });
    }

    /// What is found stays: what is on screen, or what is being read.
    pub fn end_passing(&mut self, is_being_read: bool) {
        self.passing =
            self.passing.take().filter(|_| is_being_read).map(|passing| Passing { ends: true, ..passing });
    }

    /// `next` comes on screen in the place of `shown`, which is the place before now, unless it only passed by.
    pub fn passes_to(&mut self, shown: Option<&TreePlace>, next: &TreePlace) {
        let before = match &self.passing {
            Some(Passing { from, before, .. }) if from.as_ref() == Some(next) => before.as_ref(),
            Some(Passing { from, before, .. }) => from.as_ref().or(before.as_ref()),
            None => shown.or(self.before.as_ref()),
        };
        self.before = before.cloned();
        self.passing = self.passing.take().filter(|passing| !passing.ends);
    }

    /// What is built in: read once, however many workbenches there are.
    pub fn builtin() -> Self {
        static ENTRIES: OnceLock<Vec<PresetEntry>> = OnceLock::new();
        let mut library = Self {
            entries: ENTRIES.get_or_init(builtin_entries).clone(),
            filter: String::new(),
            rows: Vec::new(),
            selected: 0,
            at_group: None,
            folded: BTreeSet::new(),
            favourites: BTreeSet::new(),
            tags: BTreeMap::new(),
            before: None,
            passing: None,
            shelf: Vec::new(),
            forests: Vec::new(),
            top: None,
            removed: None,
            unread: Vec::new(),
        };
        library.arrange();
        library
    }

    /// Puts the user's presets in the list, in the place of those that were there. Of the latter those stay that
    /// were changed, the tree at `changed` on screen too, though their files are gone.
    pub fn set_user(&mut self, presets: Vec<UserPreset>, changed: Option<&TreePlace>) {
        let selected = self.entry().map(|entry| entry.place.clone());
        let mut entries = std::mem::take(&mut self.entries);
        entries.retain_mut(|entry| {
            let TreePlace::File(path) = &entry.place else { return true };
            if presets.iter().any(|preset| preset.path == *path) {
                return false;
            }
            if entry.group != OPENED && entry.fault.is_none() {
                entry.fault = Some(gone(path));
                entry.is_gone = true;
            }
            entry.group == OPENED || changed == Some(&entry.place) || self.is_shelved(&entry.place)
        });
        self.entries = entries;
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
            tags: preset.tags,
            fault: preset.state.err().map(|complaint| complaint.to_string()),
            is_gone: false,
        }));
        let entries = &self.entries;
        let is_gone = |place: &TreePlace| entries.iter().any(|entry| entry.place == *place && entry.is_gone);
        for tree in &mut self.shelf {
            tree.is_orphan |= is_gone(&tree.place);
        }
        self.arrange();
        if let Some(place) = selected {
            self.select_place(&place);
        }
    }

    /// Whether the file of a place is not there any more.
    pub fn is_gone(&self, place: &TreePlace) -> bool {
        self.entries.iter().any(|entry| entry.place == *place && entry.is_gone)
    }

    /// The file of a place is not there any more, and what was changed of its tree is.
    pub fn mark_gone(&mut self, place: &TreePlace) {
        if let (TreePlace::File(path), Some(entry)) =
            (place, self.entries.iter_mut().find(|entry| entry.place == *place))
        {
            (entry.fault, entry.is_gone) = (Some(gone(path)), true);
        }
    }

    /// The whole preset of a tree that was changed in the last session, where the session has that; it is kept here no
    /// longer.
    pub fn take_whole(&mut self, place: &TreePlace) -> Option<Preset> {
        let at = self.unread.iter().position(|(other, _)| is_same(other, place))?;
        let preset = Preset::from_json(self.unread[at].1.whole.as_deref()?).ok()?;
        // Files beside the document may be gone with it.
        if !preset.files().is_empty() {
            return None;
        }
        self.unread.remove(at);
        Some(preset)
    }

    /// Makes sure that a file is listed: one that was named when the program was started, say.
    pub fn add_file(&mut self, path: PathBuf, preset: &Preset) {
        self.add(PresetEntry { group: OPENED.to_owned(), ..PresetEntry::of(TreePlace::File(path), preset) });
    }

    /// Lists a file that could not be read, and why.
    pub fn add_broken(&mut self, path: PathBuf, why: &str) {
        let unread = PresetEntry::unread(TreePlace::File(path), OPENED);
        self.add(PresetEntry { fault: Some(why.to_owned()), ..unread });
    }

    /// The same of a forest's file.
    pub fn add_forest(&mut self, path: PathBuf, forest: &Forest, summary: &str) {
        self.add(PresetEntry {
            id: forest.id.clone(),
            name: forest.name.clone(),
            summary: summary.to_owned(),
            ..PresetEntry::unread(TreePlace::File(path), OPENED)
        });
    }

    fn add(&mut self, entry: PresetEntry) {
        match self.entries.iter_mut().find(|other| other.place == entry.place) {
            // More is known of it now.
            Some(other) if other.group == OPENED => *other = entry,
            Some(_) => return,
            None => self.entries.push(entry),
        }
        self.arrange();
    }

    /// Keeps changes of the last session until the document at `place` is read. A file is listed.
    pub fn expect(&mut self, place: TreePlace, changes: Changes) {
        if matches!(place, TreePlace::File(_)) && self.entries.iter().all(|entry| entry.place != place) {
            self.add(PresetEntry::unread(place.clone(), OPENED));
        }
        self.unread.push((place, changes));
    }

    /// The changes of the last session to what was read from `place`, which are kept here no longer.
    pub fn take_unread(&mut self, place: &TreePlace) -> Option<Changes> {
        let at = self.unread.iter().position(|(other, _)| is_same(other, place))?;
        let (other, changes) = self.unread.remove(at);
        if other != *place {
            self.forget(|listed| *listed == other);
        }
        Some(changes)
    }

    /// Gives up what was changed of a tree or a forest that is not on screen.
    pub fn drop_changes(&mut self, place: &TreePlace) {
        self.shelf.retain(|tree| tree.place != *place);
        self.forests.retain(|forest| forest.place != *place);
        self.unread.retain(|(other, _)| !is_same(other, place));
    }

    /// What was read from `place` could not be: its entry says why.
    pub fn mark_fault(&mut self, place: &TreePlace, why: &str) {
        let unread = self.unread.iter().any(|(other, _)| is_same(other, place));
        if let Some(entry) = self.entries.iter_mut().find(|entry| entry.place == *place).filter(|_| unread) {
            entry.fault = Some(format!(
                "{why}; what you changed is kept until it can be read, but not all of the tree: put the file back \
                 (one that was removed here lies in the folder .removed beside it)"
            ));
        }
    }

    /// Puts a changed tree aside. Where its file is gone, so that it is not listed any more, it is listed again.
    pub fn shelve(&mut self, tree: Tree) {
        if let TreePlace::File(path) = &tree.place
            && self.entries.iter().all(|entry| entry.place != tree.place)
        {
            let entry = PresetEntry::of(tree.place.clone(), tree.preset());
            self.add(PresetEntry {
                group: OPENED.to_owned(),
                fault: Some(gone(path)),
                is_gone: true,
                ..entry
            });
        }
        self.shelf.retain(|other| other.place != tree.place);
        self.shelf.push(tree);
    }

    /// The same of a changed forest.
    pub fn shelve_forest(&mut self, forest: ForestOnScreen) {
        if let TreePlace::File(path) = &forest.place
            && self.entries.iter().all(|entry| entry.place != forest.place)
        {
            self.add_forest(path.clone(), forest.wanted(), "");
        }
        self.forests.retain(|other| other.place != forest.place);
        self.forests.push(forest);
    }

    /// Columns that the list would fill: its longest row with air on both sides.
    pub fn columns(&self) -> u16 {
        let longest = self.entries.iter().map(PresetEntry::columns).max().unwrap_or(0);
        u16::try_from(longest + 2).unwrap_or(u16::MAX)
    }

    /// Takes entries off the list. A cursor on one of them goes to the next that stays, or else to the one before.
    pub fn forget(&mut self, is_forgotten: impl Fn(&TreePlace) -> bool) {
        let places = |rows: &[ListRow]| -> Vec<TreePlace> {
            let indices = rows.iter().filter_map(|row| match row {
                ListRow::Entry(index, _) => Some(*index),
                ListRow::Heading(_) => None,
            });
            indices.map(|index| self.entries[index].place.clone()).collect()
        };
        let at = self.selected_row().unwrap_or(0);
        let (before, after) = self.rows.split_at(at);
        let (before, after) = (places(before), places(after));
        let selected = self.entry().map(|entry| entry.place.clone());
        let selected = selected
            .into_iter()
            .chain(after)
            .chain(before.into_iter().rev())
            .find(|place| !is_forgotten(place));
        self.entries.retain(|entry| !is_forgotten(&entry.place));
        self.arrange();
        if let Some(place) = selected {
            self.select_place(&place);
        }
    }

    /// Whether anything is known of a place: an entry, though its file may be gone, or changes.
    pub fn knows(&self, place: &TreePlace) -> bool {
        let entries = self.entries.iter().map(|entry| &entry.place);
        let shelved =
            self.shelf.iter().map(|tree| &tree.place).chain(self.forests.iter().map(|forest| &forest.place));
        let unread = self.unread.iter().map(|(place, _)| place);
        entries.chain(shelved).chain(unread).any(|known| is_same(known, place))
    }

    /// What was at `from` is at `to`, and is called `id`: what is known of it goes along, also its mark and its tags.
    /// The cursor stays on it.
    pub fn renamed(&mut self, from: &TreePlace, to: &TreePlace, id: &str) {
        let Some(entry) = self.entries.iter_mut().find(|entry| entry.place == *from) else { return };
        let before = entry.key();
        // A name that the document does not give is the file's.
        if entry.name == entry.id {
            id.clone_into(&mut entry.name);
        }
        (entry.place, entry.id) = (to.clone(), id.to_owned());
        let after = entry.key();
        if self.favourites.remove(&before) {
            self.favourites.insert(after.clone());
        }
        if let Some(tags) = self.tags.remove(&before) {
            self.tags.insert(after, tags);
        }
        for tree in self.shelf.iter_mut().filter(|tree| tree.place == *from) {
            tree.renamed(to.clone(), id);
        }
        for forest in self.forests.iter_mut().filter(|forest| forest.place == *from) {
            forest.renamed(to.clone(), id);
        }
        let unread = self.unread.iter_mut().map(|(place, _)| place);
        let passing =
            self.passing.iter_mut().flat_map(|passing| [&mut passing.from, &mut passing.before]).flatten();
        let places = unread.chain(self.before.as_mut()).chain(passing);
        for place in places.filter(|place| is_same(place, from)) {
            *place = to.clone();
        }
        self.arrange();
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

    /// The row of the cursor, `None` when the filter hides it.
    pub fn selected_row(&self) -> Option<usize> {
        self.rows.iter().position(|row| self.has_cursor(row))
    }

    fn has_cursor(&self, row: &ListRow) -> bool {
        match (row, &self.at_group) {
            (ListRow::Entry(index, _), None) => *index == self.selected,
            (ListRow::Heading(heading), Some(group)) => heading.is_folded && heading.group == *group,
            _ => false,
        }
    }

    /// The group that the cursor is in; `None` where nothing is listed.
    pub fn group(&self) -> Option<&str> {
        self.at_group.as_deref().or_else(|| Some(self.listing().group_of(self.entry()?)))
    }

    /// Whether the selected entry is marked.
    pub fn is_favourite(&self, entry: &PresetEntry) -> bool {
        self.favourites.contains(&entry.key())
    }

    /// The tags of an entry: its document's, then the user's.
    pub fn tags_of<'e>(&'e self, entry: &'e PresetEntry) -> Vec<&'e str> {
        self.listing().tags_of(entry)
    }

    /// The tags that the user gave the selected entry.
    pub fn given_tags(&self) -> &[String] {
        let tags = self.entry().and_then(|entry| self.tags.get(&entry.key()));
        tags.map_or(&[], Vec::as_slice)
    }

    /// Gives the selected entry these tags in the place of those that the user gave before. The cursor stays on it.
    pub fn tag(&mut self, tags: Vec<String>) {
        let Some(entry) = self.entry() else { return };
        let key = entry.key();
        if tags.is_empty() {
            self.tags.remove(&key);
        } else {
            self.tags.insert(key, tags);
        }
        self.arrange();
    }

    /// Marks the selected entry, or takes the mark off. The cursor stays on it. Whether it is marked now.
    pub fn toggle_favourite(&mut self) -> Option<bool> {
        let key = self.entry()?.key();
        let is_marked = !self.favourites.remove(&key);
        if is_marked {
            self.favourites.insert(key);
        }
        self.at_group = None;
        self.arrange();
        Some(is_marked)
    }

    /// Hides the entries of a group, the cursor going to its heading when it was in there; or shows them,
    /// the cursor going from the heading to the first.
    pub fn fold(&mut self, group: &str, hides: bool) {
        let had_cursor = self.group() == Some(group);
        if hides {
            self.folded.insert(group.to_owned());
        } else {
            self.folded.remove(group);
        }
        if had_cursor {
            self.at_group = hides.then(|| group.to_owned());
        }
        self.rows = self.listing().rows(&self.entries);
        if had_cursor && !hides && self.entry().is_none_or(|entry| self.listing().group_of(entry) != group) {
            let after =
                self.rows.iter().skip_while(|row| !matches!(row, ListRow::Heading(h) if h.group == group));
            let first =
                after.skip(1).find_map(|row| if let ListRow::Entry(i, _) = row { Some(*i) } else { None });
            self.selected = first.unwrap_or(self.selected);
        }
    }

    /// Hides the entries of all groups, or shows them when they are hidden already.
    pub fn fold_all(&mut self) {
        let groups: BTreeSet<String> =
            self.entries.iter().map(|entry| self.listing().group_of(entry).to_owned()).collect();
        let group = self.group().map(str::to_owned);
        if groups.is_subset(&self.folded) {
            self.folded.clear();
            self.at_group = None;
        } else {
            self.folded = groups;
            self.at_group = group;
        }
        self.arrange();
    }

    fn listing(&self) -> Listing<'_> {
        Listing { filter: &self.filter, folded: &self.folded, favourites: &self.favourites, tags: &self.tags }
    }

    /// Whether a tree or a forest of that place waits with changes.
    pub fn is_shelved(&self, place: &TreePlace) -> bool {
        self.shelf.iter().any(|tree| tree.place == *place)
            || self.forests.iter().any(|forest| forest.place == *place)
            || self.unread.iter().any(|(other, _)| is_same(other, place))
    }

    /// Selects the entry of a place, if it is listed; its group unfolds.
    pub fn select_place(&mut self, place: &TreePlace) -> bool {
        let found = self.entries.iter().position(|entry| entry.place == *place);
        self.selected = found.unwrap_or(self.selected.min(self.entries.len().saturating_sub(1)));
        self.at_group = None;
        self.unfold_selected();
        found.is_some()
    }

    fn unfold_selected(&mut self) {
        let group = self.entry().map(|entry| self.listing().group_of(entry).to_owned());
        if group.is_some_and(|group| self.folded.remove(&group)) {
            self.rows = self.listing().rows(&self.entries);
        }
    }

    /// Sets the filter.
    pub fn filter_by(&mut self, text: &str) {
        text.clone_into(&mut self.filter);
        self.arrange();
    }

    /// Sets the filter that was set before, with the cursor where it was.
    pub fn go_back(&mut self, filter: &str, place: Option<&TreePlace>, group: Option<String>) {
        let found = self.entries.iter().position(|entry| Some(&entry.place) == place);
        (self.selected, self.at_group) = (found.unwrap_or(self.selected), group);
        self.filter_by(filter);
    }

    /// Lists anew. The cursor stays where it is if it can, else it goes to the first row.
    fn arrange(&mut self) {
        if !self.filter.trim().is_empty() {
            self.at_group = None;
        }
        self.rows = self.listing().rows(&self.entries);
        if self.selected_row().is_none() {
            // Folded away: its heading has the cursor.
            self.at_group = self.entry().map(|entry| self.listing().group_of(entry).to_owned());
        }
        if self.selected_row().is_none() {
            self.at_group = None;
            let first =
                self.rows.iter().find_map(|row| if let ListRow::Entry(i, _) = row { Some(*i) } else { None });
            self.selected = first.unwrap_or(self.selected);
        }
    }

    /// Moves the cursor by a number of rows that it can be on: entries, and headings of folded groups.
    /// Whether it is on an entry now.
    pub fn step(&mut self, by: isize) -> bool {
        let stops: Vec<&ListRow> = self
            .rows
            .iter()
            .filter(|row| !matches!(row, ListRow::Heading(heading) if !heading.is_folded))
            .collect();
        if let Some(at) = stops.iter().position(|row| self.has_cursor(row)) {
            match stops[at.saturating_add_signed(by).min(stops.len() - 1)] {
                ListRow::Entry(index, _) => (self.selected, self.at_group) = (*index, None),
                ListRow::Heading(heading) => self.at_group = Some(heading.group.clone()),
            }
        }
        self.at_group.is_none()
    }
}

/// Presets and forests that are built in.
fn builtin_entries() -> Vec<PresetEntry> {
    // The tests read every built-in document.
    let entries = builtins().iter().filter_map(|builtin| {
        let Heading { name, group, summary, source, tags, .. } = builtin.heading().ok()?;
        let (place, id) = (TreePlace::Builtin(builtin.id), builtin.id.to_owned());
        Some(PresetEntry { place, id, name, group, summary, source, tags, fault: None, is_gone: false })
    });
    let forests = builtin_forests().iter().filter_map(|builtin| {
        let document = builtin.load().ok()?;
        Some(PresetEntry {
            place: TreePlace::Builtin(builtin.id),
            id: builtin.id.to_owned(),
            name: document.name,
            group: FORESTS.to_owned(),
            summary: document.summary,
            source: String::new(),
            tags: Vec::new(),
            fault: None,
            is_gone: false,
        })
    });
    entries.chain(forests).collect()
}

/// Whether two places are the same, however their paths are written.
fn is_same(a: &TreePlace, b: &TreePlace) -> bool {
    match (a, b) {
        (TreePlace::File(a), TreePlace::File(b)) if a.is_relative() != b.is_relative() => {
            absolute(a).is_ok_and(|a| absolute(b).is_ok_and(|b| a == b))
        }
        _ => a == b,
    }
}

/// What is said of a changed tree whose file is not where it was.
fn gone(path: &Path) -> String {
    format!("{} is gone; what you changed is kept here, and 'Save as' writes it anew", show(path))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What the cursor is on, in words.
    fn cursor(library: &Library) -> String {
        match &library.at_group {
            Some(group) => format!("[{group}]"),
            None => library.entry().map(|entry| entry.id.clone()).unwrap_or_default(),
        }
    }

    fn listed(library: &Library) -> usize {
        library.rows().iter().filter(|row| matches!(row, ListRow::Entry(..))).count()
    }

    #[test]
    fn a_folded_group_hides_its_entries_and_its_heading_can_be_reached() {
        let mut library = Library::builtin();
        let all = listed(&library);
        library.step(isize::MIN);
        let first = cursor(&library);
        library.fold("Plants", true);
        assert_eq!(cursor(&library), "[Plants]");
        assert!(listed(&library) < all && library.selected_row() == Some(0));
        library.step(1);
        assert!(library.at_group.is_none(), "below is the first of the next group");
        library.step(-1);
        assert_eq!(cursor(&library), "[Plants]");
        library.fold("Plants", false);
        assert_eq!(cursor(&library), first);
        assert_eq!(listed(&library), all);
    }

    #[test]
    fn all_groups_fold_and_unfold_and_the_cursor_stays() {
        let mut library = Library::builtin();
        library.step(isize::MIN);
        library.step(3);
        let (before, all) = (cursor(&library), listed(&library));
        library.fold_all();
        assert_eq!((listed(&library), cursor(&library)), (0, "[Plants]".to_owned()));
        library.step(isize::MAX);
        library.step(isize::MIN);
        assert_eq!(cursor(&library), "[Plants]");
        library.fold_all();
        assert_eq!((listed(&library), cursor(&library)), (all, before));
    }

    #[test]
    fn a_filter_finds_what_is_folded_away() {
        let mut library = Library::builtin();
        library.fold_all();
        library.filter_by("fir");
        assert_eq!(cursor(&library), "fir");
        library.filter_by("");
        assert_eq!(cursor(&library), "[crowns]", "that of what was found");
        let place = library.entry().unwrap().place.clone();
        library.select_place(&place);
        assert_eq!(cursor(&library), "fir");
    }

    #[test]
    fn favourites_stand_first_and_once() {
        let mut library = Library::builtin();
        let all = listed(&library);
        library.select_place(&TreePlace::Builtin("fir"));
        assert_eq!(library.toggle_favourite(), Some(true));
        assert_eq!(cursor(&library), "fir");
        assert_eq!(library.selected_row(), Some(1), "below the heading of favourites");
        assert_eq!(library.group(), Some("Favourites"));
        assert_eq!(listed(&library), all);
        assert_eq!(library.toggle_favourite(), Some(false));
        assert_eq!(library.group(), Some("crowns"));
    }
}
