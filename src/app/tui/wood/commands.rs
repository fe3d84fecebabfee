//! The commands of editing the wood.

use super::curve::{self, CurvePick};
use super::{CONTEXT, WoodPick, ask, go, open, remove, with};
use crate::tui::command::Context;
use crate::tui::dialog::After;
use crate::tui::effect::Effects;
use crate::tui::model::{Command, Model, free, without_tree};
use crate::tui::picture::camera_rows;

const fn row(
    id: &'static str,
    keys: &'static [&'static str],
    title: &'static str,
    help: &'static str,
    hint: Option<u8>,
    run: fn(&mut Model, &mut Effects),
) -> Command {
    Command { id, context: CONTEXT, keys, title, help, hint, hindrance: free, run }
}

/// A row that needs somewhere to go.
const fn moving(
    id: &'static str,
    keys: &'static [&'static str],
    title: &'static str,
    help: &'static str,
    hint: Option<u8>,
    hindrance: fn(&Model) -> Option<String>,
    run: fn(&mut Model, &mut Effects),
) -> Command {
    Command { id, context: CONTEXT, keys, title, help, hint, hindrance, run }
}

/// Why there is nowhere to go.
fn unless(model: &Model, can: impl Fn(&WoodPick) -> bool, why: &str) -> Option<String> {
    model.dialogs.top::<WoodPick>().is_none_or(|pick| !can(pick)).then(|| why.to_owned())
}

/// The rows.
pub const COMMANDS: &[Command] = &[
    Command {
        id: "wood-edit",
        context: Context::GLOBAL,
        keys: &["a"],
        title: "Edit the wood",
        help: "Picks an axis, to take it away, cut, bend, scale it, or add one; edits are saved with the preset",
        hint: None,
        hindrance: |model| {
            let is_busy = !model.dialogs.is_empty();
            is_busy.then(|| "a dialog is open".to_owned()).or_else(|| without_tree(model))
        },
        run: |model, _| open(model),
    },
    moving(
        "wood-up",
        &["k", "up"],
        "Next axis",
        "To the axis that leaves above this one",
        Some(10),
        |m| unless(m, |pick| pick.beside(true).is_some(), "no axis leaves above this one"),
        |m, _| {
            go(m, |pick| pick.beside(true));
        },
    ),
    moving(
        "wood-down",
        &["j", "down"],
        "Axis before",
        "To the axis that leaves below this one",
        None,
        |m| unless(m, |pick| pick.beside(false).is_some(), "no axis leaves below this one"),
        |m, _| {
            go(m, |pick| pick.beside(false));
        },
    ),
    moving(
        "wood-in",
        &["l", "right"],
        "Its branches",
        "To the longest axis that this one bears",
        Some(11),
        |m| unless(m, |pick| pick.longest().is_some(), "this axis bears no other"),
        |m, _| {
            go(m, WoodPick::longest);
        },
    ),
    moving(
        "wood-out",
        &["h", "left"],
        "What bears it",
        "To the axis that bears this one",
        Some(12),
        |m| unless(m, |pick| pick.parent().is_some(), "nothing bears a stem"),
        |m, _| {
            go(m, WoodPick::parent);
        },
    ),
    row(
        "wood-remove",
        &["x", "delete"],
        "Remove",
        "Takes the axis away with all that it bears, and goes to the next one",
        Some(13),
        |m, _| {
            remove(m);
        },
    ),
    row("wood-cut", &["c"], "Cut", "Cuts the axis at a share of its length", Some(14), |m, _| ask(m, "cut")),
    row("wood-bend", &["b"], "Bend", "Bends the axis towards a direction", Some(15), |m, _| ask(m, "bend")),
    row(
        "wood-scale",
        &["s"],
        "Scale",
        "Makes the axis and what it bears longer or shorter, thicker or thinner",
        Some(16),
        |m, _| {
            ask(m, "scale");
        },
    ),
    row("wood-add", &["a"], "Add", "Adds an axis that this one bears", Some(17), |m, _| ask(m, "add")),
    row(
        "wood-curve",
        &["w"],
        "Curve",
        "Leads the axis along control points, which are dragged in the picture or moved by keys",
        Some(18),
        |m, _| curve::open(m),
    ),
    row("wood-leaves", &["v"], "Leaves", "Shows leaves, or wood alone", None, |m, _| {
        with(m, |pick| pick.leaves = !pick.leaves);
    }),
    row("wood-close", &["esc", "q", "enter"], "Done", "Leaves; the edits stay", Some(90), |m, _| {
        m.dialogs.close::<WoodPick>();
    }),
];

/// A row of drawing a curve.
const fn curve_row(
    id: &'static str,
    keys: &'static [&'static str],
    [title, help]: [&'static str; 2],
    hint: Option<u8>,
    hindrance: fn(&Model) -> Option<String>,
    run: fn(&mut Model, &mut Effects),
) -> Command {
    Command { id, context: curve::CONTEXT, keys, title, help, hint, hindrance, run }
}

fn with_curve(model: &mut Model, act: impl FnOnce(&mut CurvePick, &mut Model)) {
    model.with(|pick: &mut CurvePick, model| {
        act(pick, model);
        After::Stays
    });
}

/// The rows of drawing a curve.
pub const CURVE: &[Command] = &[
    curve_row(
        "curve-next",
        &["tab", "n"],
        ["Next point", "Picks the next control point"],
        Some(10),
        free,
        |m, _| {
            with_curve(m, |pick, _| pick.go(1));
        },
    ),
    curve_row(
        "curve-previous",
        &["shift-tab", "N"],
        ["Point before", "Picks the control point before"],
        None,
        free,
        |m, _| with_curve(m, |pick, _| pick.go(-1)),
    ),
    curve_row(
        "curve-up",
        &["up", "k"],
        ["Up", "Moves the point up in the picture"],
        Some(12),
        free,
        |m, _| {
            with_curve(m, |pick, model| pick.step(model, 0.0, 1.0));
        },
    ),
    curve_row(
        "curve-down",
        &["down", "j"],
        ["Down", "Moves the point down in the picture"],
        None,
        free,
        |m, _| {
            with_curve(m, |pick, model| pick.step(model, 0.0, -1.0));
        },
    ),
    curve_row(
        "curve-left",
        &["left", "h"],
        ["Left", "Moves the point to the left in the picture"],
        Some(13),
        free,
        |m, _| {
            with_curve(m, |pick, model| pick.step(model, -1.0, 0.0));
        },
    ),
    curve_row(
        "curve-right",
        &["right", "l"],
        ["Right", "Moves the point to the right in the picture"],
        None,
        free,
        |m, _| {
            with_curve(m, |pick, model| pick.step(model, 1.0, 0.0));
        },
    ),
    curve_row(
        "curve-add",
        &["a"],
        ["Add point", "Adds a control point behind the one that is picked"],
        Some(14),
        |m| {
            let is_full = m.dialogs.top::<CurvePick>().is_some_and(CurvePick::is_full);
            is_full.then(|| "a curve has 64 points at most".to_owned())
        },
        |m, _| with_curve(m, CurvePick::add_point),
    ),
    curve_row(
        "curve-remove",
        &["x", "delete"],
        ["Remove point", "Takes the control point away"],
        Some(15),
        |m| {
            let is_last = m.dialogs.top::<CurvePick>().is_some_and(CurvePick::has_one_point);
            is_last.then(|| "a curve needs a point; Esc leaves the axis as it was".to_owned())
        },
        |m, _| with_curve(m, CurvePick::remove_point),
    ),
    curve_row(
        "curve-type",
        &["i"],
        ["Type", "Types the points, metres from the base of the axis"],
        Some(16),
        free,
        |m, _| {
            curve::type_points(m);
        },
    ),
    curve_row("curve-accept", &["enter"], ["Done", "Leaves; the curve stays"], Some(89), free, |m, _| {
        curve::accept(m);
    }),
    curve_row(
        "curve-cancel",
        &["esc", "q"],
        ["Cancel", "Leaves the wood as it was before"],
        Some(90),
        free,
        |m, effects| {
            m.cancel(effects);
        },
    ),
];

/// The rows that look from elsewhere while a curve is drawn.
pub const CURVE_CAMERA: &[Command] = &camera_rows(
    curve::CONTEXT,
    [
        "curve-orbit-left",
        "curve-orbit-right",
        "curve-orbit-up",
        "curve-orbit-down",
        "curve-closer",
        "curve-farther",
    ],
);

/// The rows that look from elsewhere.
pub const CAMERA: &[Command] = &camera_rows(
    CONTEXT,
    [
        "wood-orbit-left",
        "wood-orbit-right",
        "wood-orbit-up",
        "wood-orbit-down",
        "wood-closer",
        "wood-farther",
    ],
);
