//! The commands of looking at a derivation.

use linden::lsystem::LSystem;

use super::{CONTEXT, Debugger, close, edit_rule, go, open, with};
use crate::tui::command::Context;
use crate::tui::effect::Effects;
use crate::tui::layout::Pane;
use crate::tui::model::{Command, Model, free, without_preset};
use crate::tui::picture::camera_rows;

const fn row(
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

/// Why not, unless the cursor can do something.
fn unless(model: &Model, can: impl Fn(&Debugger) -> bool, why: &str) -> Option<String> {
    let debugger = model.dialogs.top::<Debugger>();
    if debugger.is_some_and(|debugger| debugger.word.is_none()) {
        return Some("the word is on its way".to_owned());
    }
    debugger.is_none_or(|debugger| !can(debugger)).then(|| why.to_owned())
}

fn is_first(model: &Model) -> Option<String> {
    unless(model, |debugger| debugger.cursor > 0, "this is the first module")
}

fn is_last(model: &Model) -> Option<String> {
    unless(model, |debugger| debugger.cursor + 1 < debugger.modules().len(), "this is the last module")
}

fn is_axiom(model: &Model) -> Option<String> {
    let step = model.dialogs.top::<Debugger>().map_or(0, |debugger| debugger.step);
    (step == 0).then(|| "this is the axiom".to_owned())
}

/// Why no further step is taken: the last one led to no word.
fn is_at_end(model: &Model) -> Option<String> {
    let fault = model.dialogs.top::<Debugger>().and_then(|debugger| debugger.fault.clone());
    fault.map(|_| "the word would be too long, or is none".to_owned())
}

/// Goes to another step.
fn step_to(model: &mut Model, to: impl FnOnce(u32) -> u32) {
    with(model, |debugger| {
        debugger.step = to(debugger.step);
        debugger.fault = None;
    });
}

/// A page of the word.
fn page(model: &mut Model, down: bool) {
    let rows = model.layout().text(Pane::Shape).map_or(1, |area| area.height / 2).max(1);
    let by = rows as isize;
    with(model, |debugger| debugger.move_lines(if down { by } else { -by }));
}

/// The derivations of the tree itself.
pub(super) fn last_step(model: &Model) -> Option<u32> {
    Some(model.tree.as_ref()?.wanted().preset.settings::<LSystem>()?.derivations_grown())
}

/// The rows.
pub const COMMANDS: &[Command] = &[
    Command {
        id: "derivation",
        context: Context::GLOBAL,
        keys: &["d"],
        title: "Derivation",
        help: "Shows the grammar's word module by module, with what wrote each and what the turtle draws for it",
        hint: None,
        hindrance: |model| {
            let is_busy = !model.dialogs.is_empty();
            let why = || "this tree grows without a grammar".to_owned();
            is_busy
                .then(|| "a dialog is open".to_owned())
                .or_else(|| without_preset(model))
                .or_else(|| last_step(model).is_none().then(why))
        },
        run: |model, _| open(model),
    },
    row(
        "derivation-next",
        &["l", "right"],
        "Next module",
        "To the next module",
        Some(10),
        is_last,
        |m, _| {
            go(m, |debugger| Some(debugger.cursor + 1));
        },
    ),
    row(
        "derivation-previous",
        &["h", "left"],
        "Module before",
        "To the module before",
        None,
        is_first,
        |m, _| go(m, |debugger| debugger.cursor.checked_sub(1)),
    ),
    row("derivation-down", &["j", "down"], "Line below", "To the line below", None, is_last, |m, _| {
        with(m, |debugger| debugger.move_lines(1));
    }),
    row("derivation-up", &["k", "up"], "Line above", "To the line above", None, is_first, |m, _| {
        with(m, |debugger| debugger.move_lines(-1));
    }),
    row("derivation-page-down", &["pagedown"], "Page down", "Half a page on", None, is_last, |m, _| {
        page(m, true);
    }),
    row("derivation-page-up", &["pageup"], "Page up", "Half a page back", None, is_first, |m, _| {
        page(m, false);
    }),
    row("derivation-first", &["home", "g"], "First module", "To the first module", None, is_first, |m, _| {
        go(m, |_| Some(0));
    }),
    row("derivation-last", &["end", "G"], "Last module", "To the last module", None, is_last, |m, _| {
        go(m, |debugger| debugger.modules().len().checked_sub(1));
    }),
    row(
        "derivation-step",
        &["."],
        "One step on",
        "Derives one step more; the cursor goes to the first module that its own becomes",
        Some(11),
        is_at_end,
        |m, _| step_to(m, |step| step.saturating_add(1)),
    ),
    row(
        "derivation-back",
        &[","],
        "One step back",
        "Takes a step back; the cursor goes to the module that its own comes from",
        Some(12),
        is_axiom,
        |m, _| step_to(m, |step| step.saturating_sub(1)),
    ),
    row("derivation-axiom", &["("], "Axiom", "To the axiom", None, is_axiom, |m, _| step_to(m, |_| 0)),
    row(
        "derivation-tree",
        &[")"],
        "The tree's step",
        "To the word that the tree itself is drawn from",
        None,
        |model| {
            let step = model.dialogs.top::<Debugger>().map(|debugger| debugger.step);
            (step == last_step(model)).then(|| "the tree itself is drawn from this word".to_owned())
        },
        |m, _| {
            let last = last_step(m);
            step_to(m, |step| last.unwrap_or(step));
        },
    ),
    row(
        "derivation-bracket",
        &["b", "%"],
        "Other bracket",
        "To the other bracket of the branch; from elsewhere to the one that begins it",
        Some(14),
        |m| unless(m, |debugger| debugger.bracket().is_some(), "this module is in no branch"),
        |m, _| go(m, Debugger::bracket),
    ),
    row(
        "derivation-same",
        &["n"],
        "Next of its kind",
        "To the next module with the same symbol",
        Some(15),
        |m| unless(m, |debugger| debugger.same(true).is_some(), "no such symbol follows"),
        |m, _| go(m, |debugger| debugger.same(true)),
    ),
    row(
        "derivation-same-before",
        &["N"],
        "One of its kind before",
        "To the module before with the same symbol",
        None,
        |m| unless(m, |debugger| debugger.same(false).is_some(), "no such symbol comes before"),
        |m, _| go(m, |debugger| debugger.same(false)),
    ),
    row(
        "derivation-edit",
        &["e", "enter"],
        "Edit its rule",
        "Edits the rule that wrote the module, or else the one that rewrites it next",
        Some(13),
        |m| unless(m, |_| true, "the word is on its way"),
        |m, _| edit_rule(m),
    ),
    row(
        "derivation-leaves",
        &["v"],
        "Organs",
        "Shows what the grammar places, or wood alone",
        None,
        free,
        |m, _| {
            with(m, |debugger| debugger.leaves = !debugger.leaves);
        },
    ),
    row("derivation-close", &["esc", "q", "d"], "Done", "Leaves the derivation", Some(90), free, |m, _| {
        close(m);
    }),
];

/// The rows that look from elsewhere.
pub const CAMERA: &[Command] = &camera_rows(
    CONTEXT,
    [
        "derivation-orbit-left",
        "derivation-orbit-right",
        "derivation-orbit-up",
        "derivation-orbit-down",
        "derivation-closer",
        "derivation-farther",
    ],
);
