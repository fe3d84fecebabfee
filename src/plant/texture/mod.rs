//! Pictures that the program draws itself: bark, leaves of all kinds, and ground.
//!
//! Everything here uses no randomness but its key's and gives the same bytes on any machine and any
//! number of threads. Bark tiles in both directions.

mod bark;
mod drawn;
mod ground;
mod kept;
pub mod leaf;
mod periodic;

pub use bark::{Bark, BarkError, BarkPictures, BarkStyle, Moss, normals_by_lightness};
pub(crate) use bark::{Torn, opaque};
pub use drawn::DrawnPictures;
pub use ground::{GROUND_TILE_M, ground};
