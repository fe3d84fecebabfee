//! The list of presets: built in, and the user's own, grouped, with a fuzzy filter.
//!
//! To select is to show: the tree follows the cursor. A tree that was changed is put on a shelf when
//! the cursor moves on, and comes back as it was.

mod filter;
pub mod view;

use std::path::PathBuf;

use linden::preset::{Heading, Preset, builtins};
use linden::recipe::Recipe;
use linden_terminal::input::{Mouse, MouseAction};

use super::around::{Line, Purpose};
use super::command::{Command, Context, free};
use super::effect::{Effect, Effects};
use super::model::{Layer, Model, Pane};
use super::picture;
use super::tree::{Place, Tree};
use crate::config::Complaint;
use crate::config::presets::UserPreset;
use crate::source::Source;

/// Something that can be shown.
#[derive(Clone, Debug)]
pub struct Entry {
    /// Where it is.
    pub place: Place,
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
pub enum Row {
    /// A group's heading.
    Heading(String),
    /// An entry, by its index, with the characters of its id that the filter matched.
    Entry(usize, Vec<u32>),
}

/// The list.
pub struct Library {
    entries: Vec<Entry>,
    /// What was typed into the filter.
    pub filter: String,
    rows: Vec<Row>,
    /// The selected entry's index; survives filtering and reloading by its place.
    selected: usize,
    /// Changed trees that are not on screen.
    shelf: Vec<Tree>,
}

impl Entry {
    fn of(place: Place, preset: &Preset) -> Self {
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

impl Library {
    /// What is built in.
    pub fn builtin() -> Self {
        // The tests read every built-in document.
        let entries = builtins().iter().filter_map(|own| {
            let Heading { name, group, summary, source } = own.heading().ok()?;
            let (place, id) = (Place::Builtin(own.id), own.id.to_owned());
            Some(Entry { place, id, name, group, summary, source, fault: None })
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

    /// Puts the user's own in the list, in the place of those that were there.
    pub fn set_user(&mut self, presets: Vec<UserPreset>) {
        let selected = self.entry().map(|entry| entry.place.clone());
        self.entries.retain(|entry| matches!(entry.place, Place::Builtin(_)));
        self.entries.extend(presets.into_iter().map(|own| Entry {
            place: Place::File(own.path),
            id: own.id,
            name: own.name,
            group: if own.group == "own" { "yours".to_owned() } else { format!("yours: {}", own.group) },
            summary: own.summary,
            source: own.source,
            fault: own.state.err().map(|complaint| complaint.to_string()),
        }));
        self.arrange();
        if let Some(place) = selected {
            self.select_place(&place);
        }
    }

    /// Makes sure that a file is listed: one that was named when the program was started, say.
    pub fn add_file(&mut self, path: PathBuf, preset: &Preset) {
        let place = Place::File(path);
        if self.entries.iter().all(|entry| entry.place != place) {
            self.entries.push(Entry { group: "opened".to_owned(), ..Entry::of(place, preset) });
            self.arrange();
        }
    }

    /// The rows of the list.
    pub fn rows(&self) -> &[Row] {
        &self.rows
    }

    /// How many entries there are, listed or not.
    pub fn len(&self) -> usize {
        self.entries.len()
    }

    /// An entry by its index.
    pub fn get(&self, index: usize) -> &Entry {
        &self.entries[index]
    }

    /// The ids and places of all that is listed, whatever the filter hides.
    pub fn places(&self) -> impl Iterator<Item = (&str, &Place)> {
        self.entries.iter().map(|entry| (entry.id.as_str(), &entry.place))
    }

    /// The selected entry.
    pub fn entry(&self) -> Option<&Entry> {
        self.entries.get(self.selected)
    }

    /// The row of the selected entry, `None` when the filter hides it.
    pub fn selected_row(&self) -> Option<usize> {
        self.rows.iter().position(|row| matches!(row, Row::Entry(index, _) if *index == self.selected))
    }

    /// Whether a tree of that place waits with changes.
    pub fn is_shelved(&self, place: &Place) -> bool {
        self.shelf.iter().any(|tree| tree.place == *place)
    }

    /// Selects the entry of a place, if it is listed.
    pub fn select_place(&mut self, place: &Place) -> bool {
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
                self.rows.iter().find_map(|row| if let Row::Entry(i, _) = row { Some(*i) } else { None });
            self.selected = first.unwrap_or(self.selected);
        }
    }

    /// Moves the cursor by so many entries.
    fn step(&mut self, by: isize) {
        let listed: Vec<usize> = self
            .rows
            .iter()
            .filter_map(|row| if let Row::Entry(i, _) = row { Some(*i) } else { None })
            .collect();
        if let Some(at) = listed.iter().position(|&i| i == self.selected) {
            let to = at.saturating_add_signed(by).min(listed.len() - 1);
            self.selected = listed[to];
        }
    }
}

/// Sets the filter, as it is typed: the cursor is on the best match.
pub fn set_filter(model: &mut Model, text: &str, effects: &mut Effects) {
    model.library.filter_by(text);
    if !text.is_empty() {
        model.library.step(isize::MIN);
    }
    show_selected(model, effects);
}

/// Shows what the cursor is on.
pub fn show_selected(model: &mut Model, effects: &mut Effects) {
    let Some(entry) = model.library.entry() else { return };
    let place = entry.place.clone();
    if model.loading.as_ref() == Some(&place) {
        return;
    }
    if model.loading.is_none() && model.tree.as_ref().is_some_and(|tree| tree.place == place) {
        return;
    }
    if let Some(at) = model.library.shelf.iter().position(|tree| tree.place == place) {
        let tree = model.library.shelf.remove(at);
        model.loading = None;
        take(model, tree);
        return;
    }
    model.loading = Some(place.clone());
    effects.push(Effect::Load(place));
}

/// Puts a tree on screen; the one before goes onto the shelf if it was changed.
fn take(model: &mut Model, tree: Tree) {
    if let Some(before) = model.tree.replace(tree)
        && before.is_modified()
    {
        model.library.shelf.retain(|other| other.place != before.place);
        model.library.shelf.push(before);
    }
    model.form.reset();
    model.growth.stop();
    model.wind.stop();
    picture::reset(model);
}

/// A preset was read.
pub fn loaded(model: &mut Model, place: Place, source: Result<Box<Source>, String>, _effects: &mut Effects) {
    // What nobody waits for any more is dropped.
    if model.loading.as_ref() != Some(&place) {
        return;
    }
    model.loading = None;
    match source {
        Ok(source) => {
            let Source { recipe, notes, .. } = *source;
            for note in notes {
                model.say(note);
            }
            // Changes for another preset are for one that the user has left.
            let changes = model.changes.take().filter(|(of, _)| *of == place);
            reread(model, place, recipe);
            if let Some((_, changes)) = changes
                && let Some(tree) = &mut model.tree
            {
                for complaint in tree.apply(&changes) {
                    model.say_error(complaint);
                }
            }
        }
        Err(why) => model.say_error(why),
    }
}

/// A document was read, for the first time or anew. Changes that were made to its tree stay.
fn reread(model: &mut Model, place: Place, recipe: Recipe) {
    if let Place::File(path) = &place {
        model.library.add_file(path.clone(), &recipe.preset);
        model.library.select_place(&place);
    }
    match &mut model.tree {
        Some(tree) if tree.place == place && tree.is_modified() => {
            model.say_warning(
                "the file changed on disk; your changes are kept, and 'Revert all' takes what the file says",
            );
            if let Some(tree) = &mut model.tree {
                tree.saved_as(place, std::sync::Arc::new(recipe));
            }
        }
        Some(tree) if tree.place == place => {
            // The last good tree stays on screen while the new one grows.
            tree.reloaded(recipe);
        }
        _ => take(model, Tree::new(place, recipe)),
    }
}

/// The user's presets were read, and what could not be.
pub fn listed(model: &mut Model, presets: Vec<UserPreset>, complaints: Vec<Complaint>) {
    model.library.set_user(presets);
    for complaint in complaints {
        model.say_error(complaint.to_string());
    }
}

/// Files changed on disk: what is shown is read again.
pub fn changed(model: &mut Model, files: &[PathBuf], effects: &mut Effects) {
    if let Some(tree) = &model.tree
        && let Place::File(path) = &tree.place
        && files.iter().any(|file| file == path)
    {
        let place = tree.place.clone();
        model.loading = Some(place.clone());
        effects.push(Effect::Load(place));
    }
    effects.push(Effect::Reconfigure);
}

/// The mouse over the list.
pub fn wheel(model: &mut Model, mouse: Mouse, effects: &mut Effects) {
    match mouse.action {
        MouseAction::WheelUp => go(model, -1, effects),
        MouseAction::WheelDown => go(model, 1, effects),
        _ => {}
    }
}

/// The mouse on a row.
pub fn clicked(model: &mut Model, row: usize, mouse: Mouse, effects: &mut Effects) {
    if !matches!(mouse.action, MouseAction::Press(_)) {
        return wheel(model, mouse, effects);
    }
    model.focus_on(Pane::Presets);
    if let Some(Row::Entry(index, _)) = model.library.rows.get(row) {
        model.library.selected = *index;
        show_selected(model, effects);
    }
}

fn go(model: &mut Model, by: isize, effects: &mut Effects) {
    model.library.step(by);
    show_selected(model, effects);
}

/// A page of the list, roughly.
const PAGE: isize = 10;

/// The rows of this room.
pub const COMMANDS: &[Command] = &[
    Command {
        id: "preset-next",
        context: Context::Presets,
        keys: &["j", "down"],
        title: "Next preset",
        help: "Shows the preset below",
        hint: Some(10),
        hindrance: free,
        run: |model, effects| go(model, 1, effects),
    },
    Command {
        id: "preset-previous",
        context: Context::Presets,
        keys: &["k", "up"],
        title: "Previous preset",
        help: "Shows the preset above",
        hint: None,
        hindrance: free,
        run: |model, effects| go(model, -1, effects),
    },
    Command {
        id: "preset-page-down",
        context: Context::Presets,
        keys: &["ctrl-d", "pagedown"],
        title: "Presets: page down",
        help: "Goes ten presets down",
        hint: None,
        hindrance: free,
        run: |model, effects| go(model, PAGE, effects),
    },
    Command {
        id: "preset-page-up",
        context: Context::Presets,
        keys: &["ctrl-u", "pageup"],
        title: "Presets: page up",
        help: "Goes ten presets up",
        hint: None,
        hindrance: free,
        run: |model, effects| go(model, -PAGE, effects),
    },
    Command {
        id: "preset-first",
        context: Context::Presets,
        keys: &["g", "home"],
        title: "First preset",
        help: "Goes to the top of the list",
        hint: None,
        hindrance: free,
        run: |model, effects| go(model, isize::MIN, effects),
    },
    Command {
        id: "preset-last",
        context: Context::Presets,
        keys: &["G", "end"],
        title: "Last preset",
        help: "Goes to the bottom of the list",
        hint: None,
        hindrance: free,
        run: |model, effects| go(model, isize::MAX, effects),
    },
    Command {
        id: "filter",
        context: Context::Global,
        keys: &["/"],
        title: "Filter presets",
        help: "Filters the list of presets as you type; Enter keeps the filter, Esc drops it",
        hint: Some(30),
        hindrance: free,
        run: |model, _| {
            model.focus_on(Pane::Presets);
            let line =
                Line::new(Purpose::Filter { before: model.library.filter.clone() }, &model.library.filter);
            model.layers.push(Layer::Line(line));
        },
    },
    Command {
        id: "preset-choose",
        context: Context::Presets,
        keys: &["enter", "l", "right"],
        title: "To its picture",
        help: "Moves on to the picture of the selected preset",
        hint: Some(20),
        hindrance: free,
        run: |model, _| model.focus_on(Pane::Picture),
    },
    Command {
        id: "filter-clear",
        context: Context::Presets,
        keys: &["esc"],
        title: "Show all presets",
        help: "Drops the filter",
        hint: None,
        hindrance: |model| model.library.filter.is_empty().then(|| "no filter is set".to_owned()),
        run: |model, effects| set_filter(model, "", effects),
    },
];
