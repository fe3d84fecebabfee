//! Pictures that the program draws itself: bark.
//!
//! Everything here tiles in both directions, uses no randomness but its key's, and gives the same
//! bytes on any machine.

mod bark;
mod periodic;

pub use bark::{Bark, BarkError, BarkPictures, BarkStyle};
