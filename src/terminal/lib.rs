//! The terminal as a device: how large it is, what colours it knows, and pictures made of characters.
//!
//! This crate knows nothing of trees. What depends on the environment is given the environment as a
//! value, so all of it can be tested; only [`size::TerminalSize::of_stdout`] asks the terminal.
//!
//! | module | is |
//! |---|---|
//! | [`cells`] | RGBA pixels → text with colours |
//! | [`color`] | how many colours, and the nearest of them |
//! | [`display`] | frames → the terminal, pictures never before text |
//! | [`graphics`] | pictures of pixels: kitty, iTerm2, sixel |
//! | [`input`] | what comes from a terminal: keys, mouse, replies |
//! | [`output`] | a thread that writes |
//! | [`pacing`] | how many bytes of pictures may be on their way |
//! | [`screen`] | what the terminal shows, and the fewest bytes that change it |
//! | [`size`] | columns and rows |

pub mod cells;
pub mod color;
pub mod display;
pub mod graphics;
pub mod input;
pub mod output;
pub mod pacing;
pub mod screen;
pub mod size;

mod grid;

pub use cells::{CellPicture, CellStyle, Glyphs, PictureCell, draw_cells};
pub use color::ColorDepth;
pub use display::{Display, Settings, Stats};
pub use graphics::{Encoded, Graphic, Protocol};
pub use grid::{Image, ImageError};
pub use output::Output;
pub use pacing::Pacer;
pub use screen::{Allowance, Composed, Frame, Screen, ScreenOptions};
pub use size::TerminalSize;
