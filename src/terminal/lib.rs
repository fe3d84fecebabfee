//! The terminal as a device: how large it is, what colours it knows, and pictures made of characters.
//!
//! This crate knows nothing of trees. What depends on the environment is given the environment as a
//! value, so all of it can be tested; only [`size::TerminalSize::of_stdout`], and what is given a
//! [`tty::Tty`], touch the terminal.
//!
//! | module | is |
//! |---|---|
//! | [`cells`] | RGBA pixels → text with colours |
//! | [`color`] | how many colours, and the nearest of them |
//! | [`display`] | frames → the terminal, pictures never before text |
//! | [`graphics`] | pictures of pixels: kitty, iTerm2, sixel |
//! | [`input`] | what comes from a terminal: bytes → keys, mouse, replies |
//! | [`mod@listen`] | threads that wait for the terminal and for signals |
//! | [`output`] | a thread that writes |
//! | [`pacing`] | how many bytes of pictures may be on their way |
//! | [`probe`] | what a terminal can do: queries, replies, conclusions |
//! | [`screen`] | what the terminal shows, and the fewest bytes that change it |
//! | [`session`] | the terminal while it is ours: taken, and given back whatever happens |
//! | [`ascii`] | a screen for terminals that show nothing else |
//! | [`size`] | columns and rows |
//! | [`tty`] | the terminal's descriptors |
//!
//! Systems differ in one folder, `system`; the events are [`crossterm`]'s everywhere.

pub mod ascii;
pub mod cells;
pub mod color;
pub mod display;
pub mod graphics;
pub mod input;
pub mod listen;
pub mod output;
pub mod pacing;
pub mod probe;
pub mod screen;
pub mod session;
pub mod size;
pub mod tty;

mod grid;
mod sequences;
mod system;

pub use cells::{CellPicture, CellStyle, Glyphs, PictureCell, draw_cells};
pub use color::ColorDepth;
pub use display::{Display, Order, Settings, Stats};
pub use graphics::{Encoded, Graphic, Protocol};
pub use grid::{Image, ImageError};
pub use listen::{Incoming, Listener, listen};
pub use output::Output;
pub use pacing::Pacer;
pub use probe::Capabilities;
pub use screen::{Allowance, Composed, Frame, Screen, ScreenOptions};
pub use session::{Modes, Session};
pub use size::{MAX_CELLS, TerminalSize};
pub use tty::{Tty, WindowSize};
