//! Unix: descriptors, signals, job control.

mod ask;
mod jobs;
mod listen;
mod tty;

pub use ask::ask;
pub(crate) use jobs::{discard_input, drain, is_ours, may_be_written, stop, stops};
pub use listen::{Listener, listen};
pub use tty::Tty;

/// What a variable that is not set stands for: nothing, since every terminal sets what there is to say.
pub(crate) const fn stands_for(_name: &str) -> Option<&'static str> {
    None
}

/// Columns and rows of the terminal that the process has.
pub(crate) fn asked_size() -> Option<(u16, u16)> {
    // Not `size`: without a terminal it would start a program that looks for one.
    crossterm::terminal::window_size().ok().map(|size| (size.columns, size.rows))
}

/// Whether the terminal takes control sequences: all do.
pub const fn takes_sequences() -> bool {
    true
}

/// Whether replies of the terminal reach us.
pub const ANSWERS: bool = true;
