//! Pictures that the program draws itself: bark and ground.
//!
//! Everything here tiles in both directions, uses no randomness but its key's, and gives the same
//! bytes on any machine.

mod bark;
mod ground;
mod periodic;

pub use bark::{Bark, BarkError, BarkPictures, BarkStyle};
pub use ground::{GROUND_TILE_M, ground};
