//! The commands of shaping the crown.

use linden::preset::{Colonization, HandleMoves};

use super::{CONTEXT, CrownPick, close, hindrance, open};
use crate::tui::command::Context;
use crate::tui::dialog::After;
use crate::tui::effect::Effects;
use crate::tui::model::{Command, Model, free};
use crate::tui::picture::camera_rows;

const fn row(
    id: &'static str,
    keys: &'static [&'static str],
    [title, help]: [&'static str; 2],
    hint: u8,
    hindrance: fn(&Model) -> Option<String>,
    run: fn(&mut Model, &mut Effects),
) -> Command {
    Command { id, context: CONTEXT, keys, title, help, hint: Some(hint), hindrance, run }
}

/// Changes the pick.
fn with(model: &mut Model, act: impl FnOnce(&mut CrownPick, &mut Model)) {
    model.with(|pick: &mut CrownPick, model| {
        act(pick, model);
        After::Stays
    });
}

/// Why the handle that is picked does not move so.
fn unless(model: &Model, stuck: HandleMoves, ways: &str) -> Option<String> {
    let handle = model.dialogs.top::<CrownPick>()?.handle()?;
    (handle.moves == stuck).then(|| format!("{} moves {ways} alone", handle.knob))
}

fn is_level(model: &Model) -> Option<String> {
    unless(model, HandleMoves::Across, "left and right")
}

fn is_upright(model: &Model) -> Option<String> {
    unless(model, HandleMoves::Upright, "up and down")
}

fn has_no_pair(model: &Model, can: impl Fn(&Colonization, &CrownPick) -> bool, why: &str) -> Option<String> {
    let pick = model.dialogs.top::<CrownPick>()?;
    let settings = model.tree.as_ref()?.preset().settings::<Colonization>()?;
    (!can(settings, pick)).then(|| why.to_owned())
}

/// The rows.
pub const COMMANDS: &[Command] = &[
    Command {
        id: "crown-edit",
        context: Context::GLOBAL,
        keys: &["A"],
        title: "Shape the crown",
        help: "Drags the profile, the height, the width and the base of the crown in the picture, with the mouse or keys",
        hint: None,
        hindrance,
        run: |model, _| open(model),
    },
    row("crown-next", &["tab", "n"], ["Next handle", "Picks the next handle"], 10, free, |m, _| {
        with(m, |pick, _| pick.go(1));
    }),
    Command {
        hint: None,
        ..row(
            "crown-previous",
            &["shift-tab", "N"],
            ["Handle before", "Picks the handle before"],
            11,
            free,
            |m, _| with(m, |pick, _| pick.go(pick.draft.handles.len().saturating_sub(1))),
        )
    },
    row("crown-up", &["up", "k"], ["Up", "Moves the handle up"], 12, is_level, |m, _| {
        with(m, |pick, model| pick.step(model, 1.0, 0.0));
    }),
    row("crown-down", &["down", "j"], ["Down", "Moves the handle down"], 13, is_level, |m, _| {
        with(m, |pick, model| pick.step(model, -1.0, 0.0));
    }),
    row(
        "crown-out",
        &["right", "l"],
        ["Wider", "Moves the handle away from the axis"],
        14,
        is_upright,
        |m, _| with(m, |pick, model| pick.step(model, 0.0, 1.0)),
    ),
    row(
        "crown-in",
        &["left", "h"],
        ["Narrower", "Moves the handle towards the axis"],
        15,
        is_upright,
        |m, _| with(m, |pick, model| pick.step(model, 0.0, -1.0)),
    ),
    row(
        "crown-add",
        &["a"],
        ["Add point", "Adds a point to the profile behind the one that is picked"],
        16,
        |m| {
            let why = "only crown=revolution has a profile of any number of points, up to 64; this handle is no such point";
            has_no_pair(
                m,
                |settings, pick| pick.handle().is_some_and(|one| settings.with_pair(one).is_some()),
                why,
            )
        },
        |m, _| with(m, |pick, model| pick.change_pairs(model, true)),
    ),
    row(
        "crown-remove",
        &["x", "delete"],
        ["Remove point", "Takes the point that is picked out of the profile"],
        17,
        |m| {
            let why = "only a point of crown=revolution can go, and two must stay";
            has_no_pair(
                m,
                |settings, pick| pick.handle().is_some_and(|one| settings.without_pair(one).is_some()),
                why,
            )
        },
        |m, _| with(m, |pick, model| pick.change_pairs(model, false)),
    ),
    row(
        "crown-close",
        &["esc", "q", "enter", "A"],
        ["Done", "Leaves; the crown stays as it is now"],
        90,
        free,
        |m, _| close(m),
    ),
];

/// The rows that look from elsewhere.
pub const CAMERA: &[Command] = &camera_rows(
    CONTEXT,
    [
        "crown-orbit-left",
        "crown-orbit-right",
        "crown-orbit-up",
        "crown-orbit-down",
        "crown-closer",
        "crown-farther",
    ],
);
