//! The list of presets: built in, and the user's, grouped, with a fuzzy filter.
//!
//! To select is to show: the tree follows the cursor. A tree that was changed is put on a shelf when
//! the cursor moves on, and comes back as it was.

mod commands;
mod filter_line;
mod open_line;
mod remove_line;
mod rename_line;
mod tag_line;
pub mod view;

use std::path::PathBuf;

use crossterm::event::{MouseEvent, MouseEventKind};
use linden::recipe::Recipe;

pub use commands::COMMANDS;
pub use open_line::{dropped_path, open_path};

use self::open_line::OpenLine;
use super::effect::{Effect, Effects};
use super::forest::ForestOnScreen;
use super::layout::{Pane, Target};
use super::model::Model;
use super::model::{ListRow, Removed};
use super::picture;
use super::tree::{Changes, Tree, TreePlace};
use crate::config::Complaint;
use crate::config::presets::UserPreset;
use crate::jobs::{Findings, Inquiry};
use crate::paths::show;
use crate::source::Source;
use crate::source::forest::{AnySource, ForestSource};

/// What the list wants to know of the disk, while a path is typed.
pub fn wanted(model: &Model) -> Option<Inquiry> {
    model.dialogs.top::<OpenLine>().map(OpenLine::inquiry)
}

/// What was found out about a path that is typed; `None` when that was it.
pub fn found(model: &mut Model, findings: Findings) -> Option<Findings> {
    match model.dialogs.top_mut::<OpenLine>() {
        Some(line) => {
            line.take(findings);
            None
        }
        None => Some(findings),
    }
}

/// Sets the filter, as it is typed: the cursor is on the best match.
pub fn set_filter(model: &mut Model, text: &str, effects: &mut Effects) {
    model.library.filter_by(text);
    model.library.top = None;
    if !text.is_empty() {
        model.library.step(isize::MIN);
    }
    show_selected(model, effects);
}

/// Shows what the cursor is on.
pub fn show_selected(model: &mut Model, effects: &mut Effects) {
    if let Some(place) = model.library.entry().map(|entry| entry.place.clone()) {
        show_place(model, place, effects);
    }
}

/// Shows the tree or the forest of a place.
fn show_place(model: &mut Model, place: TreePlace, effects: &mut Effects) {
    if model.loading.as_ref() == Some(&place) {
        return;
    }
    if model.loading.is_none() && model.place() == Some(&place) {
        return;
    }
    if let Some(at) = model.library.shelf.iter().position(|tree| tree.place == place) {
        let tree = model.library.shelf.remove(at);
        model.loading = None;
        take(model, tree);
        return;
    }
    if let Some(at) = model.library.forests.iter().position(|forest| forest.place == place) {
        let forest = model.library.forests.remove(at);
        model.loading = None;
        clear(model, &place);
        model.forest = Some(forest);
        return;
    }
    model.loading = Some(place.clone());
    effects.push(Effect::Load(place));
}

/// Puts a tree on screen; the one before goes onto the shelf if it was changed.
fn take(model: &mut Model, tree: Tree) {
    clear(model, &tree.place);
    model.tree = Some(tree);
}

/// Takes what is on screen away for what comes from `next`; a tree goes onto the shelf if it was changed.
fn clear(model: &mut Model, next: &TreePlace) {
    let shown = model.place().cloned();
    model.library.passes_to(shown.as_ref(), next);
    if let Some(before) = model.tree.take().filter(Tree::is_modified) {
        model.library.shelve(before);
    }
    if let Some(before) = model.forest.take().filter(ForestOnScreen::is_modified) {
        model.library.shelve_forest(before);
    }
    model.form.reset();
    model.growth.stop();
    model.wind.stop();
    picture::reset(model);
}

/// A preset was read.
pub fn loaded(
    model: &mut Model,
    place: TreePlace,
    source: Result<AnySource, String>,
    _effects: &mut Effects,
) {
    // What is not waited for any more is dropped.
    if model.loading.as_ref() != Some(&place) {
        return;
    }
    model.loading = None;
    match source {
        Ok(AnySource::Forest(source)) => {
            for note in &source.notes {
                model.say(note.clone());
            }
            let changes = changes_of(model, &place);
            reread_forest(model, place, *source, changes);
        }
        Ok(AnySource::Tree(source)) => {
            let Source { recipe, notes, .. } = *source;
            for note in notes {
                model.say(note);
            }
            let changes = changes_of(model, &place);
            reread(model, place, recipe);
            let Some(tree) = &mut model.tree else { return };
            let complaints: Vec<String> = changes.iter().flat_map(|changes| tree.apply(changes)).collect();
            for complaint in complaints {
                model.say_error(complaint);
            }
        }
        Err(why) => {
            // With nothing else on screen the list says what was asked for, and not its first preset.
            if let TreePlace::File(path) = &place
                && model.place().is_none()
                && model.library.places().all(|(_, other)| *other != place)
            {
                model.library.add_broken(path.clone(), &why);
                model.library.select_place(&place);
            }
            model.library.mark_fault(&place, &why);
            model.say_error(why);
        }
    }
}

/// The file of a preset that was to be read is not there. A tree that was changed is kept as it is on screen, or comes
/// back whole where the last session has all of it; it can be saved anew.
pub fn gone(model: &mut Model, place: TreePlace, why: String, effects: &mut Effects) {
    let on_screen = model.tree.as_mut().filter(|tree| tree.place == place && tree.is_modified());
    if let Some(tree) = on_screen {
        tree.is_orphan = true;
        model.loading = None;
        model.library.mark_gone(&place);
        model.say_warning(format!("your changes are kept, and 'Save as' writes the file anew: {why}"));
    } else if model.loading.as_ref() == Some(&place)
        && let Some(preset) = model.library.take_whole(&place)
    {
        model.loading = None;
        model.library.mark_gone(&place);
        let mut tree = Tree::new(place, Recipe::new(preset));
        tree.is_orphan = true;
        take(model, tree);
        model.say_warning(format!("this is the tree as you left it, and 'Save as' writes it anew: {why}"));
    } else {
        loaded(model, place, Err(why), effects);
    }
}

/// The changes that are to be made to what was read: those of the last session, then those of the command line.
/// Each is a step of undo.
fn changes_of(model: &mut Model, place: &TreePlace) -> Vec<Changes> {
    // Changes for another preset are for one that the user has left.
    let asked = model.changes.take().filter(|(of, _)| of == place).map(|(_, changes)| changes);
    model.library.take_unread(place).into_iter().chain(asked).collect()
}

/// A document was read, for the first time or anew. Changes that were made to its tree stay.
fn reread(model: &mut Model, place: TreePlace, recipe: Recipe) {
    if let TreePlace::File(path) = &place {
        model.library.add_file(path.clone(), &recipe.preset);
        model.library.select_place(&place);
    }
    match &mut model.tree {
        Some(tree) if tree.place == place && tree.is_modified() => {
            // A file that was renamed, or written as it was, says nothing new.
            if tree.saved().preset != recipe.preset {
                model.say_warning(
                    "the file changed on disk; your changes are kept, and 'Revert all' takes what the file says",
                );
            }
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

/// A forest's document was read, for the first time or anew.
fn reread_forest(model: &mut Model, place: TreePlace, source: ForestSource, changes: Vec<Changes>) {
    if let TreePlace::File(path) = &place {
        model.library.add_forest(path.clone(), &source.forest, &source.summary);
        model.library.select_place(&place);
    }
    let mut forest = ForestOnScreen::new(place, source);
    let again = model.forest.take_if(|before| before.place == forest.place);
    let turned = again.as_ref().map(ForestOnScreen::overrides).unwrap_or_default();
    let turned = turned.into_iter().map(|(name, value)| (name.to_owned(), value));
    for (name, value) in turned.chain(changes.into_iter().flat_map(|changes| changes.knobs)) {
        if let Err(error) = forest.set(&name, &value) {
            model.say_error(error.to_string());
        }
    }
    match again {
        // The last one stays on screen while the new one grows.
        Some(before) => forest.shown = before.shown,
        None => clear(model, &forest.place),
    }
    model.forest = Some(forest);
}

/// The user's presets were read, and what could not be.
pub fn listed(model: &mut Model, presets: Vec<UserPreset>, complaints: Vec<Complaint>) {
    let changed_tree = model.tree.as_ref().filter(|tree| tree.is_modified()).map(|tree| &tree.place);
    let changed_forest =
        model.forest.as_ref().filter(|forest| forest.is_modified()).map(|forest| &forest.place);
    model.library.set_user(presets, changed_tree.or(changed_forest));
    if let Some(tree) = model.tree.as_mut().filter(|tree| tree.is_modified()) {
        tree.is_orphan |= model.library.is_gone(&tree.place);
    }
    for complaint in complaints {
        model.say_error(complaint.to_string());
    }
}

/// A preset's file was removed, or why not.
pub fn file_removed(
    model: &mut Model,
    result: Result<(PathBuf, Option<PathBuf>), String>,
    effects: &mut Effects,
) {
    match result {
        Ok((path, kept)) => {
            removed(model, &TreePlace::File(path.clone()), effects);
            match kept {
                Some(kept) => {
                    let key = model.config.keymap.keys_of("undo").first().map(ToString::to_string);
                    let back = key.map_or_else(|| "'Undo'".to_owned(), |key| format!("{key} (undo)"));
                    model.say(format!("removed; {back} brings it back, also {}", show(&kept)));
                    let steps = model.tree.as_ref().map_or(0, Tree::steps);
                    model.library.removed = Some(Removed { path, kept, steps });
                }
                None => model.say("removed: its file was gone already"),
            }
            effects.push(Effect::Reconfigure);
        }
        Err(why) => model.say_error(why),
    }
}

/// A preset's file was renamed, or why not. All that is remembered of it goes along.
pub fn file_renamed(model: &mut Model, result: Result<(PathBuf, PathBuf), String>, effects: &mut Effects) {
    let (from, to) = match result {
        Ok((from, to)) => (TreePlace::File(from), to),
        Err(why) => return model.say_error(why),
    };
    let id = to.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let to = TreePlace::File(to);
    model.library.renamed(&from, &to, &id);
    model.exporting.moved(Some(&from), &to);
    if let Some(tree) = model.tree.as_mut().filter(|tree| tree.place == from) {
        tree.renamed(to.clone(), &id);
    }
    if let Some(forest) = model.forest.as_mut().filter(|forest| forest.place == from) {
        forest.renamed(to.clone(), &id);
    }
    if let Some((place, _)) = model.changes.as_mut().filter(|(place, _)| *place == from) {
        place.clone_from(&to);
    }
    if model.loading.as_ref() == Some(&from) {
        model.loading = Some(to.clone());
        effects.push(Effect::Load(to));
    }
    model.say(format!("renamed to '{}'", linden::knob::excerpt(&id)));
    effects.push(Effect::Reconfigure);
}

/// The removed preset that one undo brings back: nothing was changed since.
pub fn removed_last(model: &Model) -> Option<&Removed> {
    let steps = model.tree.as_ref().map_or(0, Tree::steps);
    let has_turned = model.forest.as_ref().is_some_and(ForestOnScreen::can_undo);
    model.library.removed.as_ref().filter(|removed| steps <= removed.steps && !has_turned)
}

/// A preset's file is back, or why not.
pub fn put_back(model: &mut Model, back: Result<PathBuf, String>, effects: &mut Effects) {
    match back {
        Ok(path) => {
            model.say(format!("brought back: {}", show(&path)));
            let place = TreePlace::File(path);
            model.loading = Some(place.clone());
            effects.push(Effect::Load(place));
            effects.push(Effect::Reconfigure);
        }
        Err(why) => model.say_error(why),
    }
}

/// Takes an entry off the list, with what was changed of it, and shows the one that has the cursor then.
fn removed(model: &mut Model, place: &TreePlace, effects: &mut Effects) {
    model.library.drop_changes(place);
    if model.place() == Some(place) {
        (model.tree, model.forest) = (None, None);
    }
    model.library.forget(|other| other == place);
    show_selected(model, effects);
}

/// Files changed on disk: what is shown is read again.
pub fn changed(model: &mut Model, files: &[PathBuf], effects: &mut Effects) {
    if let Some(tree) = &model.tree
        && let TreePlace::File(path) = &tree.place
        && files.iter().any(|file| file == path)
    {
        let place = tree.place.clone();
        model.loading = Some(place.clone());
        effects.push(Effect::Load(place));
    }
    if let Some(forest) = &model.forest
        && files.iter().any(|file| forest.is_from(file))
    {
        let place = forest.place.clone();
        model.loading = Some(place.clone());
        effects.push(Effect::Load(place));
    }
    effects.push(Effect::Reconfigure);
}

/// The mouse over the list.
pub fn wheel(model: &mut Model, mouse: MouseEvent, effects: &mut Effects) {
    match mouse.kind {
        MouseEventKind::ScrollUp => go(model, -1, effects),
        MouseEventKind::ScrollDown => go(model, 1, effects),
        _ => {}
    }
}

/// The mouse on a row.
pub fn clicked(model: &mut Model, row: usize, mouse: MouseEvent, effects: &mut Effects) {
    if !matches!(mouse.kind, MouseEventKind::Down(_)) {
        return wheel(model, mouse, effects);
    }
    model.focus_on(Pane::Presets);
    // The list stands still under the pointer.
    let in_list = model.regions.iter().filter_map(|(area, target)| match target {
        Target::Preset(row) => Some((area.y, *row)),
        _ => None,
    });
    model.library.top = in_list.min().map(|(_, row)| row);
    match model.library.rows.get(row) {
        Some(ListRow::Entry(index, _)) => {
            (model.library.selected, model.library.at_group) = (*index, None);
            show_selected(model, effects);
        }
        Some(ListRow::Heading(heading)) => {
            let heading = heading.clone();
            model.library.fold(&heading.group, !heading.is_folded);
        }
        None => {}
    }
}

fn go(model: &mut Model, by: isize, effects: &mut Effects) {
    // What a folded group holds is not shown before it unfolds.
    if model.library.step(by) {
        show_selected(model, effects);
    }
}

/// Shows the preset that was on screen before this one.
fn back(model: &mut Model, effects: &mut Effects) {
    let Some(place) = model.library.before.clone() else { return };
    if model.library.select_place(&place) {
        show_selected(model, effects);
    } else {
        model.say_warning("the preset before is not in the list any more");
    }
}

/// Unfolds the group whose heading has the cursor, or moves on to the picture.
fn choose(model: &mut Model, effects: &mut Effects) {
    match model.library.at_group.clone() {
        Some(group) => {
            model.library.fold(&group, false);
            show_selected(model, effects);
        }
        None => model.focus_on(Pane::Picture),
    }
}

/// Marks the selected preset, or takes the mark off.
fn mark(model: &mut Model) {
    let name = model.library.entry().map(|entry| entry.id.clone()).unwrap_or_default();
    match model.library.toggle_favourite() {
        Some(true) => model.say(format!("{name} is a favourite now")),
        Some(false) => model.say(format!("{name} is no favourite any more")),
        None => {}
    }
}

#[cfg(test)]
mod tests;
