//! The row of the room where wind is played.

use super::blow_or_stop;
use crate::tui::command::{Command, Context, without_tree};

/// The rows of this room.
pub const COMMANDS: &[Command] = &[Command {
    id: "wind-play",
    context: Context::Global,
    keys: &["w"],
    title: "Play wind",
    help: "Lets the wind of the knobs blow: wood and leaves sway as in exports; again ends it",
    hint: None,
    hindrance: without_tree,
    run: |model, _| blow_or_stop(model),
}];
