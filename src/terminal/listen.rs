//! What a terminal and the system say, passed on as it comes.
//!
//! The threads sleep until something comes: nothing is looked at from time to time.

use crate::input::Said;

pub use crate::system::{Listener, listen};

/// An event from the terminal or a signal.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Incoming {
    /// Keys, the mouse, replies: never empty.
    Input(Vec<Said>),
    /// The window has another size.
    Resized,
    /// The process was stopped and goes on: the terminal has to be taken again.
    Continued,
    /// The process is asked to stop, as by Ctrl-Z.
    Suspend,
    /// The process is asked to end, by this signal; it should give the terminal back and raise the
    /// signal again.
    Terminate(i32),
    /// The terminal is gone. Nothing more comes from it.
    Hangup,
}
