//! What comes from a terminal: keys, the mouse, pasted text, and its replies to queries.
//!
//! [`Parser`] makes [`Event`]s of bytes. It has no clock and reads nothing: [`mod@crate::listen`] does.

mod csi;
mod key;
mod parser;
mod reply;

pub use key::{Key, KeyCode, KeyError};
pub use parser::{PASTE_LIMIT, Parser, STRING_LIMIT};

/// One thing that a terminal said.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Event {
    /// A key was pressed.
    Key(Key),
    /// The mouse.
    Mouse(Mouse),
    /// Text that was pasted, as it came: nothing in it is a key.
    Paste(String),
    /// The terminal's window got (`true`) or lost the focus.
    Focus(bool),
    /// The answer to a query of ours.
    Reply(Reply),
}

/// Something done with the mouse. Cells count from 0, from the upper left.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Mouse {
    /// The action.
    pub action: MouseAction,
    /// The column of the cell.
    pub column: u16,
    /// The row of the cell.
    pub row: u16,
    /// Whether Shift was held.
    pub shift: bool,
    /// Whether Alt was held.
    pub alt: bool,
    /// Whether Ctrl was held.
    pub ctrl: bool,
}

/// An action of the mouse.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MouseAction {
    /// A button went down.
    Press(Button),
    /// The mouse moved with a button down.
    Drag(Button),
    /// The button went up.
    Release(Button),
    /// The wheel turned away from the user.
    WheelUp,
    /// The wheel turned towards the user.
    WheelDown,
}

/// A button of the mouse.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Button {
    /// The first.
    Left,
    /// The wheel.
    Middle,
    /// The second.
    Right,
}

/// A terminal's answer to a query.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Reply {
    /// DSR 5: everything that was sent before the query has been read.
    Status,
    /// DA1: what the terminal can do; 4 is sixel. The end of a round of queries.
    Attributes(Vec<u16>),
    /// XTVERSION: its name and version, as it says (not yet safe to show).
    Version(String),
    /// OSC 11: its background, sRGB.
    Background([u8; 3]),
    /// The answer to a kitty graphics query: whether it has them.
    KittyGraphics(bool),
    /// DECRPM: a private mode, and whether the terminal knows it and can set it.
    Mode {
        /// Its number: 2026 is synchronized output.
        number: u16,
        /// Whether the terminal knows it and can set it.
        known: bool,
    },
    /// DECRQSS: the rendition in force, as it says, without the `m`: tells whether 24-bit colours are
    /// kept.
    Rendition(String),
    /// Pixels of a cell.
    CellPixels {
        /// Across.
        width: u16,
        /// Down.
        height: u16,
    },
}
