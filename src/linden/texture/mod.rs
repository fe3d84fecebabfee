//! Pictures that the program draws itself: bark, and leaves of all kinds.
//!
//! Everything here uses no randomness but its key's and gives the same bytes on any machine and any
//! number of threads. Bark tiles in both directions.

mod bark;
pub mod leaf;
mod own;
mod periodic;

pub use bark::{Bark, BarkError, BarkPictures, BarkStyle};
pub use own::{OwnError, OwnPicture, own_picture};
