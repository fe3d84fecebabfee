//! The command that plays the wind.

use super::blow_or_stop;
use crate::tui::command::Context;
use crate::tui::model::{Command, without_tree};

/// The row.
pub const COMMANDS: &[Command] = &[Command {
    id: "wind-play",
    context: Context::GLOBAL,
    keys: &["w"],
    title: "Play wind",
    help: "Lets the wind of the knobs blow: wood and leaves sway as in exports; again ends it",
    hint: None,
    hindrance: without_tree,
    run: |model, _| blow_or_stop(model),
}];
