//! The command of the page of numbers.

use super::{TITLE, page};
use crate::tui::chrome::Page;
use crate::tui::command::Context;
use crate::tui::model::{Command, without_preset};

/// The rows.
pub const COMMANDS: &[Command] = &[Command {
    id: "statistics",
    context: Context::GLOBAL,
    keys: &["S"],
    title: "Statistics",
    help: "Measures the tree: height, wood, leaves, triangles, memory, seconds, and what its files would take",
    hint: None,
    hindrance: without_preset,
    run: |model, _| {
        let page = Page::live(TITLE, page::lines, model);
        model.dialogs.open(page);
    },
}];
