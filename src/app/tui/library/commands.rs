//! The commands of the list of presets.

use super::filter_line::FilterLine;
use super::open_line::OpenLine;
use super::remove_line::RemoveLine;
use super::rename_line::RenameLine;
use super::tag_line::TagLine;
use super::{back, choose, go, mark, set_filter};
use crate::tui::command::Context;
use crate::tui::layout::Pane;
use crate::tui::model::{Command, Model, free};
use crate::tui::shape;

/// A page of the list, roughly.
const PAGE: isize = 10;

fn without_entry(model: &Model) -> Option<String> {
    let is_on_entry = model.library.at_group.is_none() && model.library.selected_row().is_some();
    (!is_on_entry).then(|| "the cursor is on no preset".to_owned())
}

/// The rows.
pub const COMMANDS: &[Command] = &[
    Command {
        id: "preset-next",
        context: Context::PRESETS,
        keys: &["j", "down"],
        title: "Next preset",
        help: "Shows the preset below",
        hint: Some(10),
        hindrance: free,
        run: |model, effects| go(model, 1, effects),
    },
    Command {
        id: "preset-previous",
        context: Context::PRESETS,
        keys: &["k", "up"],
        title: "Previous preset",
        help: "Shows the preset above",
        hint: None,
        hindrance: free,
        run: |model, effects| go(model, -1, effects),
    },
    Command {
        id: "preset-page-down",
        context: Context::PRESETS,
        keys: &["ctrl-d", "pagedown"],
        title: "Presets: page down",
        help: "Goes ten presets down",
        hint: None,
        hindrance: free,
        run: |model, effects| go(model, PAGE, effects),
    },
    Command {
        id: "preset-page-up",
        context: Context::PRESETS,
        keys: &["ctrl-u", "pageup"],
        title: "Presets: page up",
        help: "Goes ten presets up",
        hint: None,
        hindrance: free,
        run: |model, effects| go(model, -PAGE, effects),
    },
    Command {
        id: "preset-first",
        context: Context::PRESETS,
        keys: &["g", "home"],
        title: "First preset",
        help: "Goes to the top of the list",
        hint: None,
        hindrance: free,
        run: |model, effects| go(model, isize::MIN, effects),
    },
    Command {
        id: "preset-last",
        context: Context::PRESETS,
        keys: &["G", "end"],
        title: "Last preset",
        help: "Goes to the bottom of the list",
        hint: None,
        hindrance: free,
        run: |model, effects| go(model, isize::MAX, effects),
    },
    Command {
        id: "filter",
        context: Context::GLOBAL,
        keys: &["/"],
        title: "Find",
        help: "Among the knobs goes to the one whose name you type, elsewhere filters the list of presets as you type; Enter keeps that, Esc gives the list and the tree back as they were",
        hint: Some(30),
        hindrance: free,
        run: |model, _| {
            if model.focus == Pane::Shape && model.tree.is_some() {
                return shape::find_knob(model);
            }
            model.focus_on(Pane::Presets);
            let line = FilterLine::new(model);
            model.dialogs.open(line);
        },
    },
    Command {
        id: "preset-choose",
        context: Context::PRESETS,
        keys: &["enter", "l", "right"],
        title: "To its picture",
        help: "Moves on to the picture of the selected preset; unfolds a folded group",
        hint: Some(31),
        hindrance: free,
        run: choose,
    },
    Command {
        id: "favourite",
        context: Context::PRESETS,
        keys: &["*"],
        title: "Favourite",
        help: "Lists the selected preset among the favourites, above all others, or no more",
        hint: None,
        hindrance: without_entry,
        run: |model, _| mark(model),
    },
    Command {
        id: "tags",
        context: Context::PRESETS,
        keys: &["#"],
        title: "Tags",
        help: "Types the tags of the selected preset, by which it is found: #hedge in the filter and the palette",
        hint: None,
        hindrance: without_entry,
        run: |model, _| {
            let line = TagLine::new(model);
            model.dialogs.open(line);
        },
    },
    Command {
        id: "preset-remove",
        context: Context::PRESETS,
        keys: &["delete"],
        title: "Remove",
        help: "Removes the selected preset of yours, whose file goes into a folder beside it, or takes an opened file off the list; asks first",
        hint: None,
        hindrance: |model| {
            without_entry(model).or_else(|| {
                let is_builtin = RemoveLine::new(model).is_none();
                is_builtin.then(|| "what is built in cannot be removed".to_owned())
            })
        },
        run: |model, _| {
            if let Some(line) = RemoveLine::new(model) {
                model.dialogs.open(line);
            }
        },
    },
    Command {
        id: "preset-rename",
        context: Context::PRESETS,
        keys: &["r", "f2"],
        title: "Rename",
        help: "Gives the selected preset of yours another name: its file is renamed, and favourites, tags, changes and the settings of its export go along",
        hint: None,
        hindrance: |model| {
            without_entry(model).or_else(|| {
                let is_other = RenameLine::new(model).is_none();
                is_other.then(|| {
                    "only presets of yours are renamed; 'Save as' makes a copy of any other".to_owned()
                })
            })
        },
        run: |model, _| {
            if let Some(line) = RenameLine::new(model) {
                model.dialogs.open(line);
            }
        },
    },
    Command {
        id: "group-fold",
        context: Context::PRESETS,
        keys: &["h", "left"],
        title: "Fold group",
        help: "Hides the presets of the group below its heading, which Enter unfolds",
        hint: None,
        hindrance: |model| {
            if !model.library.filter.trim().is_empty() {
                return Some("a filter is set, and what it finds has no groups".to_owned());
            }
            model.library.at_group.as_ref().map(|group| format!("{group} is folded"))
        },
        run: |model, _| {
            if let Some(group) = model.library.group().map(str::to_owned) {
                model.library.fold(&group, true);
            }
        },
    },
    Command {
        id: "groups-fold",
        context: Context::PRESETS,
        keys: &["z"],
        title: "Fold all groups",
        help: "Hides the presets of all groups, or shows them again",
        hint: None,
        hindrance: |model| {
            let filters = !model.library.filter.trim().is_empty();
            filters.then(|| "a filter is set, and what it finds has no groups".to_owned())
        },
        run: |model, _| model.library.fold_all(),
    },
    Command {
        id: "open-file",
        context: Context::GLOBAL,
        keys: &["ctrl-o"],
        title: "Open file",
        help: "Opens a preset, a grammar, a mesh, a scan or an export: type its path, Tab completes, up and down go through the files and show each; a file that is dropped on the terminal opens, too",
        hint: None,
        hindrance: free,
        run: |model, _| {
            let line = OpenLine::new(model);
            model.dialogs.open(line);
        },
    },
    Command {
        id: "preset-back",
        context: Context::GLOBAL,
        keys: &[";"],
        title: "Preset before",
        help: "Shows the preset that was on screen before this one, and the other way round",
        hint: None,
        hindrance: |model| model.library.before.is_none().then(|| "no other preset was shown yet".to_owned()),
        run: back,
    },
    Command {
        id: "filter-clear",
        context: Context::PRESETS,
        keys: &["esc"],
        title: "Show all presets",
        help: "Drops the filter",
        hint: Some(22),
        hindrance: |model| model.library.filter.is_empty().then(|| "no filter is set".to_owned()),
        run: |model, effects| set_filter(model, "", effects),
    },
];
