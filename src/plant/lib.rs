//! From the axial tree to everything that is to be seen: surface, foliage, pictures, wind, levels of detail,
//! and the stage that exporters are given.
//!
//! | module | is |
//! |---|---|
//! | [`settings`] | how a plant looks, and the knobs of that |
//! | [`Specimen`], [`Body`] | what is dressed: settings with their files, and a grown tree |
//! | [`surface`] | the skin of the wood |
//! | [`foliage`] | leaves on twigs, and their meshes |
//! | [`texture`] | pictures of bark, leaves and ground |
//! | [`wind`] | how everything swings |
//! | [`canopy`](mod@canopy) | the leaves, measured |
//! | [`season`] | names for times of the year |
//! | [`dress`] | skeleton → scene |
//! | [`detail`] | budgets of triangles and levels of detail |
//! | [`scene`], [`stage`] | what exporters are given |
//!
//! Draws by keys what is left to chance (pictures, places of leaves); meshes use no randomness. Knows no
//! preset and no generator, opens no file.
//!
//! ```
//! use linden_base::monitor::Quiet;
//! use linden_plant::surface::{Tubes, sweep};
//! use linden_skeleton::{Branching, NO_PARENT, Skeleton, Wood};
//!
//! let pole = Branching {
//!     positions: vec![glam::Vec3::ZERO, glam::Vec3::Y],
//!     parents: vec![NO_PARENT, 0],
//!     births: vec![0, 1],
//!     radii: None,
//!     edges: None,
//! };
//! let skeleton = Skeleton::build(pole, &Wood::default())?;
//! assert!(!sweep(&skeleton, &Tubes::default(), &Quiet)?.triangles.is_empty());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod canopy;
pub mod detail;
pub mod dress;
pub mod foliage;
mod foot_bark;
mod moss;
pub mod scene;
pub mod season;
pub mod settings;
mod specimen;
pub mod stage;
pub mod surface;
#[cfg(test)]
mod testing;
pub mod texture;
pub mod wind;
mod wood_parts;

pub use specimen::{Body, Specimen, Wanted};
