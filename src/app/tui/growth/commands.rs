//! The commands that play growth.

use super::{go_to, last_step, play_or_pause, shown, step_by};
use crate::tui::command::Context;
use crate::tui::model::{Command, Model, without_tree};

fn cannot_play(model: &Model) -> Option<String> {
    without_tree(model).or_else(|| {
        let never_grew = shown(model).is_some_and(|shown| last_step(shown) == 0);
        never_grew.then(|| "this tree has no steps: it was there at once".to_owned())
    })
}

fn is_grown(model: &Model) -> Option<String> {
    cannot_play(model)
        .or_else(|| model.growth.step().is_none().then(|| "the grown tree is on screen".to_owned()))
}

/// The rows.
pub const COMMANDS: &[Command] = &[
    Command {
        id: "growth-play",
        context: Context::GLOBAL,
        keys: &["p"],
        title: "Play growth",
        help: "Plays the tree growing, by derivations, years or iterations; again pauses",
        hint: Some(44),
        hindrance: cannot_play,
        run: |model, _| play_or_pause(model),
    },
    Command {
        id: "growth-back",
        context: Context::GLOBAL,
        keys: &[","],
        title: "Growth: step back",
        help: "Goes one step of growth back",
        hint: None,
        hindrance: cannot_play,
        run: |model, _| step_by(model, -1),
    },
    Command {
        id: "growth-forward",
        context: Context::GLOBAL,
        keys: &["."],
        title: "Growth: step on",
        help: "Goes one step of growth on",
        hint: None,
        hindrance: is_grown,
        run: |model, _| step_by(model, 1),
    },
    Command {
        id: "growth-back-far",
        context: Context::GLOBAL,
        keys: &["<"],
        title: "Growth: far back",
        help: "Goes ten steps of growth back",
        hint: None,
        hindrance: cannot_play,
        run: |model, _| step_by(model, -10),
    },
    Command {
        id: "growth-forward-far",
        context: Context::GLOBAL,
        keys: &[">"],
        title: "Growth: far on",
        help: "Goes ten steps of growth on",
        hint: None,
        hindrance: is_grown,
        run: |model, _| step_by(model, 10),
    },
    Command {
        id: "growth-start",
        context: Context::GLOBAL,
        keys: &["("],
        title: "Growth: start",
        help: "Goes to the start of growth",
        hint: None,
        hindrance: cannot_play,
        run: |model, _| {
            model.growth.stop();
            go_to(model, 0);
        },
    },
    Command {
        id: "growth-end",
        context: Context::GLOBAL,
        keys: &[")"],
        title: "Growth: grown",
        help: "Shows the grown tree",
        hint: Some(16),
        hindrance: is_grown,
        run: |model, _| model.growth.stop(),
    },
];
