//! The commands for help, messages, focus, copying and leaving, and those of typed lines and pages.

use super::page::{self, Page};
use super::palette::Palette;
use super::{prompt, yank};
use crate::tui::command::Context;
use crate::tui::effect::{Effect, Effects};
use crate::tui::layout::Pane;
use crate::tui::model::{Command, Model, free, without_form};
use crate::tui::{export, growth};

fn focus_by(model: &mut Model, by: usize) {
    model.focus_on(model.focus.next(by));
}

fn scroll(model: &mut Model, by: isize) {
    let body = model.popup_body();
    if let Some(page) = model.dialogs.top_mut::<Page>() {
        page.scroll_by(by, body);
    }
}

/// Why a page does not scroll.
fn is_in_sight(model: &Model) -> Option<String> {
    let page = model.dialogs.top::<Page>()?;
    (page.lay(model.popup_body()).most_scroll() == 0).then(|| "all of the page is in sight".to_owned())
}

/// A page less a line, so that the eye finds where it was.
fn page_rows(model: &Model) -> isize {
    let page = model.dialogs.top::<Page>();
    page.map_or(1, |page| (page.lay(model.popup_body()).text.height as isize - 1).max(1))
}

/// The rows.
pub const COMMANDS: &[Command] = &[
    Command {
        id: "help",
        context: Context::GLOBAL,
        keys: &["?", "f1"],
        title: "Help",
        help: "Shows all commands with their keys, those of where you are first; again closes it",
        hint: Some(90),
        hindrance: free,
        run: |model, effects| {
            // On a page it is the key that opened it.
            if model.dialogs.top::<Page>().is_some() {
                return model.cancel(effects);
            }
            let page = Page::help(model);
            model.dialogs.open(page);
        },
    },
    Command {
        id: "palette",
        context: Context::GLOBAL,
        keys: &[":"],
        title: "Palette",
        help: "Finds any command, knob, preset, format or setting by its name; 'season 0.8' turns a knob, 'theme light' a setting, '~/oak.toml' opens a file",
        hint: Some(100),
        hindrance: free,
        run: |model, _| {
            let palette = Palette::new(model);
            model.dialogs.open(palette);
        },
    },
    Command {
        id: "messages",
        context: Context::GLOBAL,
        keys: &["m"],
        title: "Messages",
        help: "Shows what was said, with every complaint about files of yours",
        hint: None,
        hindrance: free,
        run: |model, _| {
            let page = Page::messages(model);
            model.dialogs.open(page);
        },
    },
    Command {
        id: "focus-next",
        context: Context::GLOBAL,
        keys: &["tab"],
        title: "Next pane",
        help: "Moves to the next pane: presets, picture, knobs",
        hint: Some(89),
        hindrance: free,
        run: |model, _| focus_by(model, 1),
    },
    Command {
        id: "focus-previous",
        context: Context::GLOBAL,
        keys: &["shift-tab"],
        title: "Previous pane",
        help: "Moves to the pane before",
        hint: None,
        hindrance: free,
        run: |model, _| focus_by(model, Pane::ALL.len() - 1),
    },
    Command {
        id: "yank-command",
        context: Context::GLOBAL,
        keys: &["y"],
        title: "Copy command",
        help: "Copies the command line that makes the files of the export dialog, with what is set there (through the terminal, so over SSH too)",
        hint: Some(50),
        hindrance: without_form,
        run: |model, effects| {
            model.end_comparison();
            let words = || export::words(model);
            let of_tree = model.tree.as_ref().map(|tree| yank::command_line(tree, words()));
            let of_forest =
                || model.forest.as_ref().and_then(|forest| yank::forest_command_line(forest, words()));
            let Some(text) = of_tree.or_else(of_forest) else {
                return model.say_warning("the forest's file has a name that no terminal should be given");
            };
            let first = text.lines().next().unwrap_or_default().to_owned();
            effects.push(Effect::Copy(text));
            match growth::warning(model) {
                Some(warning) => model.say_warning(format!("copied, {warning}: {first}")),
                None => model.say(format!("copied: {first}")),
            }
        },
    },
    Command {
        id: "yank-recipe",
        context: Context::GLOBAL,
        keys: &["Y"],
        title: "Copy recipe",
        help: "Copies the recipe: one line of JSON that grows this tree anywhere",
        hint: None,
        hindrance: without_form,
        run: |model, effects| {
            model.end_comparison();
            let of_tree = model.tree.as_ref().map(|tree| tree.recipe().to_line());
            let of_forest = || model.forest.as_ref().map(|forest| forest.wanted().to_line());
            if let Some(line) = of_tree.or_else(of_forest) {
                effects.push(Effect::Copy(line));
                model.say("copied the recipe: one line of JSON, which linden takes as a SOURCE");
            }
        },
    },
    Command {
        id: "quit",
        context: Context::GLOBAL,
        keys: &["q"],
        title: "Quit",
        help: "Leaves; what is on screen comes back next time",
        hint: Some(99),
        hindrance: free,
        run: quit,
    },
    Command {
        id: "interrupt",
        context: Context::ALWAYS,
        keys: &["ctrl-c"],
        title: "Interrupt",
        help: "Closes the dialog; without one, leaves",
        hint: None,
        hindrance: free,
        run: |model, effects| {
            if model.dialogs.is_empty() {
                quit(model, effects);
            } else {
                while !model.dialogs.is_empty() {
                    model.cancel(effects);
                }
            }
        },
    },
    Command {
        id: "suspend",
        context: Context::ALWAYS,
        keys: &["ctrl-z"],
        title: "Suspend",
        help: "Goes back to the shell; 'fg' comes back here",
        hint: None,
        hindrance: free,
        run: |_, effects| effects.push(Effect::Suspend),
    },
    Command {
        id: "redraw",
        context: Context::ALWAYS,
        keys: &["ctrl-l"],
        title: "Redraw",
        help: "Paints the whole screen anew, when something else wrote over it",
        hint: None,
        hindrance: free,
        run: |_, effects| effects.push(Effect::Redraw),
    },
    Command {
        id: "prompt-accept",
        context: prompt::CONTEXT,
        keys: &["enter"],
        title: "Accept",
        help: "Takes what was typed",
        hint: Some(10),
        hindrance: free,
        run: |model, effects| {
            model.tell(|dialog, model| dialog.accept(model, effects));
        },
    },
    Command {
        id: "prompt-cancel",
        context: prompt::CONTEXT,
        keys: &["esc"],
        title: "Cancel",
        help: "Leaves everything as it was",
        hint: Some(11),
        hindrance: free,
        run: Model::cancel,
    },
    Command {
        id: "page-down",
        context: page::CONTEXT,
        keys: &["j", "down"],
        title: "Down",
        help: "Scrolls down",
        hint: Some(10),
        hindrance: is_in_sight,
        run: |model, _| scroll(model, 1),
    },
    Command {
        id: "page-up",
        context: page::CONTEXT,
        keys: &["k", "up"],
        title: "Up",
        help: "Scrolls up",
        hint: Some(11),
        hindrance: is_in_sight,
        run: |model, _| scroll(model, -1),
    },
    Command {
        id: "page-page-down",
        context: page::CONTEXT,
        keys: &["pagedown", "ctrl-d", "space"],
        title: "Page down",
        help: "Scrolls a page down",
        hint: None,
        hindrance: free,
        run: |model, _| scroll(model, page_rows(model)),
    },
    Command {
        id: "page-page-up",
        context: page::CONTEXT,
        keys: &["pageup", "ctrl-u"],
        title: "Page up",
        help: "Scrolls a page up",
        hint: None,
        hindrance: free,
        run: |model, _| scroll(model, -page_rows(model)),
    },
    Command {
        id: "page-first",
        context: page::CONTEXT,
        keys: &["g", "home"],
        title: "Top",
        help: "Scrolls to the top",
        hint: None,
        hindrance: free,
        run: |model, _| scroll(model, isize::MIN),
    },
    Command {
        id: "page-last",
        context: page::CONTEXT,
        keys: &["G", "end"],
        title: "Bottom",
        help: "Scrolls to the bottom",
        hint: None,
        hindrance: free,
        run: |model, _| scroll(model, isize::MAX),
    },
    Command {
        id: "page-close",
        context: page::CONTEXT,
        keys: &["esc", "q", "enter", "?"],
        title: "Close",
        help: "Closes the page",
        hint: Some(20),
        hindrance: free,
        run: Model::cancel,
    },
];

/// Leaves; asks first when an export would be lost.
fn quit(model: &mut Model, effects: &mut Effects) {
    if model.exporting.may_leave(model.now) {
        effects.push(Effect::Quit);
    } else {
        model.say_warning("once more cancels the running export and leaves");
    }
}
