//! What grows on the wood: leaves, blossoms, fruit.
//!
//! A generator leaves [`Organs`] behind beside the wood: polygons, which are shapes of their own, and
//! places where an organ of the table [`PROTOTYPES`] grows. [`sprout`] adds the leaves of the preset:
//! it walks the twigs (`axis`), turns each leaf as its arrangement has it (`pose`) and gives it a
//! variant of what its kind is made of (`form`), which shows a cell of the kind's picture (`look`).
//! [`meshes`] makes triangles of all. Like the surface of the wood, that uses no randomness and gives
//! the same bits on any number of threads.

mod axis;
mod bare;
mod calendar;
mod cluster;
mod dressed;
#[cfg(test)]
mod faces_tests;
mod fallen;
mod form;
mod instances;
mod look;
mod mesh;
mod opaque;
mod outline;
mod pose;
mod sprout;
mod sunlight;
#[cfg(test)]
mod tests;

pub use calendar::Calendar;
pub(crate) use dressed::DressedKind;
pub use dressed::{DressedOrgan, DressedOrgans, MeasuredOrgans};
pub use fallen::FallenLeaf;
pub(crate) use fallen::ShedLeaf;
pub use form::mesh_note;
pub use instances::{Copies, Instances, Placement};
pub use linden_skeleton::organs::{
    Hanging, LeafShape, MAX_CORNERS, OrganClass, OrganOrigins, Organs, PROTOTYPES, PlacedOrgans, Polygons,
    Prototype, prototype,
};
pub(crate) use look::needle_width;
pub use look::{Cover, RIM, cover};
pub use mesh::{Foliage, FoliageError, Look, Shaper, meshes, meshes_of};
pub(crate) use opaque::opaque_shares;
pub use sprout::GROWING;
pub(crate) use sprout::kind_shapes;
pub use sprout::sprout;
