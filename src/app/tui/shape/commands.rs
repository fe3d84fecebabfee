//! The rows of the form's room.

use super::{nudge, selected, step, turn};
use crate::tui::around::{Line, Purpose};
use crate::tui::command::{Command, Context, free};
use crate::tui::model::{Layer, Model, Pane};
use crate::tui::tree::{Nudge, Tree};

fn has_no_tree(model: &Model) -> Option<String> {
    model.tree.is_none().then(|| "no preset is chosen".to_owned())
}

fn unless(model: &Model, can: impl Fn(&Tree) -> bool, why: &str) -> Option<String> {
    has_no_tree(model).or_else(|| model.tree.as_ref().is_some_and(|tree| !can(tree)).then(|| why.to_owned()))
}

fn is_unmodified(model: &Model) -> Option<String> {
    unless(model, Tree::is_modified, "nothing differs from the saved preset")
}

const fn nudging(
    id: &'static str,
    keys: &'static [&'static str],
    title: &'static str,
    help: &'static str,
    hint: Option<u8>,
    run: fn(&mut Model, &mut crate::tui::effect::Effects),
) -> Command {
    Command { id, context: Context::Shape, keys, title, help, hint, hindrance: has_no_tree, run }
}

/// The rows of this room.
pub const COMMANDS: &[Command] = &[
    Command {
        id: "knob-next",
        context: Context::Shape,
        keys: &["j", "down"],
        title: "Next knob",
        help: "Goes to the knob below",
        hint: None,
        hindrance: has_no_tree,
        run: |model, _| step(model, 1),
    },
    Command {
        id: "knob-previous",
        context: Context::Shape,
        keys: &["k", "up"],
        title: "Previous knob",
        help: "Goes to the knob above",
        hint: None,
        hindrance: has_no_tree,
        run: |model, _| step(model, -1),
    },
    Command {
        id: "knob-first",
        context: Context::Shape,
        keys: &["g", "home"],
        title: "First knob",
        help: "Goes to the top of the form",
        hint: None,
        hindrance: has_no_tree,
        run: |model, _| step(model, isize::MIN),
    },
    Command {
        id: "knob-last",
        context: Context::Shape,
        keys: &["G", "end"],
        title: "Last knob",
        help: "Goes to the bottom of the form",
        hint: None,
        hindrance: has_no_tree,
        run: |model, _| step(model, isize::MAX),
    },
    Command {
        id: "knob-page-down",
        context: Context::Shape,
        keys: &["ctrl-d", "pagedown"],
        title: "Knobs: page down",
        help: "Goes eight knobs down",
        hint: None,
        hindrance: has_no_tree,
        run: |model, _| step(model, 8),
    },
    Command {
        id: "knob-page-up",
        context: Context::Shape,
        keys: &["ctrl-u", "pageup"],
        title: "Knobs: page up",
        help: "Goes eight knobs up",
        hint: None,
        hindrance: has_no_tree,
        run: |model, _| step(model, -8),
    },
    nudging(
        "knob-more",
        &["right", "l"],
        "More",
        "Turns the knob up a little, or to the next choice",
        Some(10),
        |m, _| nudge(m, true, Nudge::Usual),
    ),
    nudging(
        "knob-less",
        &["left", "h"],
        "Less",
        "Turns the knob down a little, or to the choice before",
        Some(11),
        |m, _| nudge(m, false, Nudge::Usual),
    ),
    nudging(
        "knob-more-coarse",
        &["shift-right", "L"],
        "Much more",
        "Turns the knob up ten times as far",
        None,
        |m, _| nudge(m, true, Nudge::Coarse),
    ),
    nudging(
        "knob-less-coarse",
        &["shift-left", "H"],
        "Much less",
        "Turns the knob down ten times as far",
        None,
        |m, _| nudge(m, false, Nudge::Coarse),
    ),
    nudging(
        "knob-more-fine",
        &["alt-right"],
        "Slightly more",
        "Turns the knob up a tenth as far",
        None,
        |m, _| nudge(m, true, Nudge::Fine),
    ),
    nudging(
        "knob-less-fine",
        &["alt-left"],
        "Slightly less",
        "Turns the knob down a tenth as far",
        None,
        |m, _| nudge(m, false, Nudge::Fine),
    ),
    Command {
        id: "knob-type",
        context: Context::Shape,
        keys: &["enter", "i"],
        title: "Type",
        help: "Types the knob's value; what is wrong with it is said at once",
        hint: Some(12),
        hindrance: has_no_tree,
        run: |model, _| {
            if let Some((row, value)) = selected(model) {
                let line = Line::new(Purpose::Knob(row.knob.name), &value.to_string());
                model.layers.push(Layer::Line(line));
            }
        },
    },
    Command {
        id: "knob-reset",
        context: Context::Shape,
        keys: &["r", "backspace"],
        title: "Reset",
        help: "Gives the knob the saved preset's value back",
        hint: Some(14),
        hindrance: |model| {
            let turned = |tree: &Tree| selected(model).is_some_and(|(row, _)| tree.is_turned(&row));
            unless(model, turned, "the knob is as saved")
        },
        run: |model, _| {
            let Some((row, _)) = selected(model) else { return };
            let saved = model.tree.as_ref().and_then(|tree| row.read(&tree.saved().preset));
            match saved {
                Some(value) => turn(model, row.knob.name, &value.to_string()),
                None => model.say_warning("the saved preset does not have this knob"),
            }
        },
    },
    Command {
        id: "undo",
        context: Context::Global,
        keys: &["u"],
        title: "Undo",
        help: "Takes the last change back; there is no limit",
        hint: Some(32),
        hindrance: |model| unless(model, Tree::can_undo, "nothing was changed"),
        run: |model, _| {
            if let Some(tree) = &mut model.tree {
                tree.undo();
            }
        },
    },
    Command {
        id: "redo",
        context: Context::Global,
        keys: &["ctrl-r"],
        title: "Redo",
        help: "Does again what was undone",
        hint: None,
        hindrance: |model| unless(model, Tree::can_redo, "nothing was undone"),
        run: |model, _| {
            if let Some(tree) = &mut model.tree {
                tree.redo();
            }
        },
    },
    Command {
        id: "compare",
        context: Context::Global,
        keys: &["b"],
        title: "Compare",
        help: "Shows the preset as saved, and your changes again (A/B)",
        hint: Some(36),
        hindrance: is_unmodified,
        run: |model, _| {
            if let Some(tree) = &mut model.tree {
                tree.compares = !tree.compares;
            }
        },
    },
    Command {
        id: "revert",
        context: Context::Global,
        keys: &["R"],
        title: "Revert all",
        help: "Gives all knobs the saved preset's values back; undo leads back",
        hint: None,
        hindrance: is_unmodified,
        run: |model, _| {
            if let Some(tree) = &mut model.tree {
                let saved = tree.saved().preset.clone();
                tree.replace(saved);
            }
        },
    },
    Command {
        id: "save-as",
        context: Context::Global,
        keys: &["s"],
        title: "Save as",
        help: "Saves the tree as a preset of your own",
        hint: Some(38),
        hindrance: |model| {
            has_no_tree(model).or_else(|| {
                model
                    .config
                    .dirs
                    .presets()
                    .is_none()
                    .then(|| "there is no folder for presets: set HOME or LINDEN_CONFIG_DIR".to_owned())
            })
        },
        run: |model, _| {
            let id = model.tree.as_ref().map(|tree| tree.preset().id.clone()).unwrap_or_default();
            model.layers.push(Layer::Line(Line::new(Purpose::SaveAs, &id)));
        },
    },
    Command {
        id: "shape",
        context: Context::Presets,
        keys: &["o"],
        title: "To its knobs",
        help: "Moves on to the knobs of the selected preset",
        hint: None,
        hindrance: free,
        run: |model, _| model.focus_on(Pane::Shape),
    },
];
