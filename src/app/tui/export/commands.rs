//! The commands that export, and those of the dialog.

use super::dialog::{self, ExportDialog, ExportSpot, StartState};
use super::{cancel, has_nothing, open, start};
use crate::tui::chrome::{Page, PageLine};
use crate::tui::command::Context;
use crate::tui::dialog::After;
use crate::tui::effect::Effects;
use crate::tui::model::{Command, Model, Weight, free};

/// What can be done while a question is open.
const ANSWERS: &str = "y is yes, n is no";

/// A row of the dialog.
const fn row(
    id: &'static str,
    keys: &'static [&'static str],
    title: &'static str,
    help: &'static str,
    hint: Option<u8>,
    run: fn(&mut Model, &mut Effects),
) -> Command {
    Command { id, context: dialog::CONTEXT, keys, title, help, hint, hindrance: free, run }
}

/// A row of a line in the dialog.
const fn line(
    id: &'static str,
    keys: &'static [&'static str],
    title: &'static str,
    help: &'static str,
    hint: Option<u8>,
    run: fn(&mut Model, &mut Effects),
) -> Command {
    Command { id, context: dialog::LINE, keys, title, help, hint, hindrance: free, run }
}

fn with(model: &mut Model, act: impl FnOnce(&mut ExportDialog)) {
    if let Some(dialog) = model.dialogs.top_mut() {
        act(dialog);
    }
}

/// Does something with the dialog that needs to know the model, or changes it.
fn with_model(model: &mut Model, act: impl FnOnce(&mut ExportDialog, &mut Model)) {
    model.with(|dialog, model| {
        act(dialog, model);
        After::Stays
    });
}

fn step(model: &mut Model, by: isize) {
    with(model, |dialog| dialog.step(by));
}

fn nudge(model: &mut Model, up: bool) {
    with(model, |dialog| {
        dialog.nudge(up);
    });
}

fn asks(model: &Model) -> bool {
    model.dialogs.top::<ExportDialog>().is_some_and(|dialog| dialog.start == StartState::Asking)
}

fn at_start(model: &Model) -> bool {
    model.dialogs.top::<ExportDialog>().is_some_and(|dialog| dialog.cursor == ExportSpot::Start)
}

fn asks_nothing(model: &Model) -> Option<String> {
    (!asks(model)).then(|| "nothing is asked".to_owned())
}

/// What was exported, the newest first.
fn files(model: &Model) -> Page {
    let mut lines = Vec::new();
    let text = |weight, text: String| PageLine::Text(weight, linden::knob::printable(&text));
    for report in &model.exporting.reports {
        let bytes = indicatif::BinaryBytes(report.files.iter().map(|(_, bytes)| bytes).sum());
        let count = report.files.len();
        let noun = if count == 1 { "file" } else { "files" };
        let triangles = report.triangles.as_ref().map(|triangles| format!(", {triangles}"));
        let heading = format!("{count} {noun}, {bytes}{}", triangles.unwrap_or_default());
        lines.push(PageLine::Heading(heading));
        for (path, bytes) in &report.files {
            let size = indicatif::BinaryBytes(*bytes).to_string();
            lines.push(text(Weight::Note, format!("{size:>12}  {}", path.to_string_lossy())));
        }
        for note in &report.notes {
            lines.push(text(Weight::Warning, format!("  note: {note}")));
        }
        lines.push(text(Weight::Note, String::new()));
    }
    Page { title: "Exported files", lines, scroll: 0, source: None }
}

/// The rows.
pub const COMMANDS: &[Command] = &[
    Command {
        id: "export",
        context: Context::GLOBAL,
        keys: &["e"],
        title: "Export",
        help: "Writes what is on screen for 3D programs",
        hint: Some(31),
        hindrance: has_nothing,
        run: |model, _| open(model),
    },
    Command {
        id: "export-cancel",
        context: Context::GLOBAL,
        keys: &["X"],
        title: "Cancel export",
        help: "Stops the export under way; nothing of it is left behind",
        hint: Some(41),
        hindrance: |model| (!model.exporting.is_running()).then(|| "nothing is being exported".to_owned()),
        run: cancel,
    },
    Command {
        id: "export-files",
        context: Context::GLOBAL,
        keys: &["F"],
        title: "Exported files",
        help: "Lists the files that were exported, with their sizes and notes",
        hint: None,
        hindrance: |model| model.exporting.reports.is_empty().then(|| "nothing was exported yet".to_owned()),
        run: |model, _| {
            let page = files(model);
            model.dialogs.open(page);
        },
    },
    Command {
        id: "export-yes",
        context: dialog::CONTEXT,
        keys: &["y"],
        title: "Yes",
        help: "Replaces the files that are there, makes the directory that is missing",
        hint: Some(5),
        hindrance: asks_nothing,
        run: start,
    },
    Command {
        id: "export-no",
        context: dialog::CONTEXT,
        keys: &["n"],
        title: "No",
        help: "Leaves what is there as it is, and does not export",
        hint: Some(6),
        hindrance: asks_nothing,
        run: |model, _| with(model, |dialog| dialog.start = StartState::Idle),
    },
    row("export-next", &["j", "down"], "Next row", "Goes to the row below", None, |m, _| step(m, 1)),
    row("export-previous", &["k", "up"], "Previous row", "Goes to the row above", None, |m, _| step(m, -1)),
    row("export-first", &["g", "home"], "First row", "Goes to the first format", None, |m, _| {
        step(m, isize::MIN);
    }),
    row("export-last", &["G", "end"], "Last row", "Goes to the button", None, |m, _| step(m, isize::MAX)),
    Command {
        hindrance: |model| {
            let can = model.dialogs.top().is_some_and(ExportDialog::can_toggle);
            (!can).then(|| "there is nothing to tick in this row, Enter types it".to_owned())
        },
        ..row(
            "export-toggle",
            &["space"],
            "Tick",
            "Ticks a format, turns a switch over, or goes to the next choice",
            Some(10),
            |m, _| {
                with(m, |dialog| {
                    dialog.toggle();
                });
            },
        )
    },
    row(
        "export-more",
        &["right", "l"],
        "Next choice",
        "Changes the option to its next value",
        None,
        |m, _| {
            nudge(m, true);
        },
    ),
    row(
        "export-less",
        &["left", "h"],
        "Choice before",
        "Changes the option to the value before",
        None,
        |m, _| nudge(m, false),
    ),
    Command {
        hindrance: |model| (asks(model) && at_start(model)).then(|| ANSWERS.to_owned()),
        ..row(
            "export-enter",
            &["enter"],
            "Change",
            "Ticks, turns, types or presses what the cursor is on",
            Some(12),
            |m, _| with_model(m, ExportDialog::enter),
        )
    },
    Command {
        id: "export-start",
        context: dialog::CONTEXT,
        keys: &["x", "ctrl-s"],
        title: "Export",
        help: "Starts the export, from any row",
        hint: Some(89),
        hindrance: |model| asks(model).then(|| ANSWERS.to_owned()),
        run: |m, _| with_model(m, ExportDialog::press_start),
    },
    row(
        "export-close",
        &["esc", "q"],
        "Close",
        "Closes the dialog, or takes the question back; what was set is there again when it opens on the same tree",
        Some(89),
        |m, effects| {
            if asks(m) {
                with(m, |dialog| dialog.start = StartState::Idle);
            } else {
                m.cancel(effects);
            }
        },
    ),
    line("export-line-accept", &["enter"], "Accept", "Takes what was typed", Some(10), |m, _| {
        with(m, ExportDialog::accept_line);
    }),
    Command {
        hindrance: |model| {
            let is_path = model.dialogs.top::<ExportDialog>().is_some_and(ExportDialog::types_path);
            (!is_path).then(|| "only paths are completed".to_owned())
        },
        ..line(
            "export-line-complete",
            &["tab"],
            "Complete",
            "Goes on with the name as far as it is clear, and offers the rest",
            Some(11),
            |m, _| with(m, ExportDialog::complete),
        )
    },
    line("export-line-cancel", &["esc"], "Cancel", "Leaves the line as it was", Some(90), |m, _| {
        with(m, |dialog| dialog.line = None);
    }),
];
