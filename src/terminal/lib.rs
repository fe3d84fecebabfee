//! The terminal as a device: how large it is, what colours it knows, and pictures made of characters.
//!
//! This crate knows nothing of trees. What depends on the environment is given the environment as a
//! value, so all of it can be tested; only [`size::TerminalSize::of_stdout`] and [`tty::Tty`] touch the terminal.
//!
//! | module | is |
//! |---|---|
//! | [`cells`] | RGBA pixels → text with colours |
//! | [`color`] | how many colours, and the nearest of them |
//! | [`input`] | what comes from a terminal: bytes → keys, mouse, replies |
//! | [`listen`] | threads that wait for the terminal and for signals |
//! | [`probe`] | what a terminal can do: queries, replies, conclusions |
//! | [`session`] | the terminal while it is ours: taken, and given back whatever happens |
//! | [`size`] | columns and rows |
//! | [`tty`] | the terminal's descriptors |

pub mod cells;
pub mod color;
pub mod input;
pub mod listen;
pub mod probe;
pub mod session;
pub mod size;
pub mod tty;

mod grid;
mod sequences;

pub use cells::{CellStyle, Glyphs, draw_cells};
pub use color::ColorDepth;
pub use grid::{Image, ImageError};
pub use listen::{Incoming, Listener, listen};
pub use session::{Modes, Session};
pub use size::TerminalSize;
pub use tty::{Tty, WindowSize};
