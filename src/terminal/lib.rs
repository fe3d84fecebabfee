//! The terminal as a device: how large it is, what colours it knows, and pictures made of characters.
//!
//! This crate knows nothing of trees. What depends on the environment is given the environment as a
//! value, so all of it can be tested; only [`size::TerminalSize::of_stdout`] asks the terminal.
//!
//! | module | is |
//! |---|---|
//! | [`cells`] | RGBA pixels → text with colours |
//! | [`color`] | how many colours, and the nearest of them |
//! | [`input`] | what comes from a terminal: keys, mouse, replies |
//! | [`size`] | columns and rows |

pub mod cells;
pub mod color;
pub mod input;
pub mod size;

mod grid;

pub use cells::{CellStyle, Glyphs, draw_cells};
pub use color::ColorDepth;
pub use grid::{Image, ImageError};
pub use size::TerminalSize;
