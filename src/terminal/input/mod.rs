//! What comes from a terminal: keys, the mouse, pasted text, and its replies to queries.
//!
//! Keys, the mouse and the rest are [`crossterm::event::Event`]s, which the widgets of others take too.
//! [`Parser`] makes them of bytes where crossterm's reader cannot serve: it drops replies, or takes one
//! that comes late for keys (`docs/ssh.md`, "Who reads the terminal"). It has no clock and reads
//! nothing: [`mod@crate::listen`] does.

mod csi;
mod parser;
mod reply;
mod shortcut;

use crossterm::event::Event;

pub use parser::{PASTE_LIMIT, Parser, STRING_LIMIT};
pub use shortcut::{Shortcut, ShortcutError};

/// One thing that a terminal said.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Said {
    /// A key, the mouse, a paste, the focus.
    Event(Event),
    /// The answer to a query of ours.
    Reply(Reply),
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
    /// The answer to a command of kitty's graphics protocol.
    KittyGraphics {
        /// The picture's number; 0 where none is said.
        id: u32,
        /// Whether it was done.
        ok: bool,
    },
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
