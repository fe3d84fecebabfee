//! The commands of the list of presets.

use super::filter_line::FilterLine;
use super::{go, set_filter};
use crate::tui::command::Context;
use crate::tui::layout::Pane;
use crate::tui::model::{Command, free};
use crate::tui::shape;

/// A page of the list, roughly.
const PAGE: isize = 10;

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
        help: "Among the knobs goes to the one whose name you type, elsewhere filters the list of presets as you type; Enter keeps that, Esc drops it",
        hint: Some(30),
        hindrance: free,
        run: |model, _| {
            if model.focus == Pane::Shape && model.tree.is_some() {
                return shape::find_knob(model);
            }
            model.focus_on(Pane::Presets);
            let line = FilterLine::new(&model.library.filter);
            model.dialogs.open(line);
        },
    },
    Command {
        id: "preset-choose",
        context: Context::PRESETS,
        keys: &["enter", "l", "right"],
        title: "To its picture",
        help: "Moves on to the picture of the selected preset",
        hint: Some(20),
        hindrance: free,
        run: |model, _| model.focus_on(Pane::Picture),
    },
    Command {
        id: "filter-clear",
        context: Context::PRESETS,
        keys: &["esc"],
        title: "Show all presets",
        help: "Drops the filter",
        hint: None,
        hindrance: |model| model.library.filter.is_empty().then(|| "no filter is set".to_owned()),
        run: |model, effects| set_filter(model, "", effects),
    },
];
