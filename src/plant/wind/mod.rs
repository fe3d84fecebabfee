//! Wind: what shaders of engines need at each vertex, and a sway loop that any viewer plays.
//!
//! A tree swings in three storeys: stems bend as a whole, each branch swings about where it leaves its
//! parent, leaves flutter. All of it is zero at the foot. Every axis and every leaf has a phase of its
//! own; since `sin(ωt + φ) = cos φ sin ωt + sin φ cos ωt`, two morph targets for each storey are enough
//! for any number of phases, and their weights are the same for the whole tree ([`Sway`]). Weights stay
//! between 0 and 1, for programs that cut off what is beyond (Blender's shape keys): each target goes
//! from one end of a motion to the other, and [`Motion::Begin`] has all of them at their begin.
//!
//! The same sway is told by [`Bones`] in a fraction of the bytes: joints along stems and branches, that look where
//! these targets move the wood. Leaves go with the twig that bears them and do not flutter by themselves.
//!
//! Everything follows from the whole tree's skeleton, so that all levels of detail swing alike. Phases
//! come from the seed and from places, not from numbers of nodes.

mod bones;
mod field;
mod hierarchy;
mod moment;
mod rig;
mod sway;

use std::sync::Arc;

use glam::Vec3;

use linden_base::memory::bytes_of;

pub use bones::{Binding, BoneSettings, Bones, INFLUENCES, Joint};
pub(crate) use field::Field;
pub use hierarchy::AxisPivot;
pub use moment::blown;
pub use rig::most_joints;
pub use sway::Sway;

linden_base::words! {
    /// How much of it a tree is given.
    #[derive(Default)]
    Wind {
        /// Nothing.
        #[default]
        Off = "off",
        /// Attributes at the vertices, for shaders.
        Attributes = "attributes",
        /// These, and a loop that viewers play.
        Sway = "sway",
        /// The loop alone, by joints that turn.
        Bones = "bones",
    }
}

/// How it blows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Blow {
    /// 0 calm to 1 storm.
    pub strength: f64,
    /// How often stems swing, Hz: branches swing some two and a half times as fast, leaves six times.
    pub frequency_hz: f64,
    /// Where it blows to, degrees about Y from +X towards -Z (counter-clockwise seen from above).
    pub direction_deg: f64,
    /// How much gusts come and go, 0 to 1.
    pub gustiness: f64,
}

impl Default for Blow {
    /// A fresh breeze.
    fn default() -> Self {
        Self { strength: 0.4, frequency_hz: 0.3, direction_deg: 0.0, gustiness: 0.5 }
    }
}

/// How the vertices of a part swing. The arrays have an entry per vertex, or none: with bones there are bindings alone.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PartWind {
    /// Level (0 for a stem, 1 for its branches and so on; a leaf has one more than its twig), phase
    /// (0 to 1 of a period), sway (0 at the pivot to 1 at the most flexible tips), flutter (0 at a
    /// leaf's foot to 1 at its tip; 0 for wood).
    pub motions: Vec<[f32; 4]>,
    /// Where the vertex's axis leaves its parent, or its leaf the twig (metres), and how far the vertex is
    /// from there.
    pub pivots: Vec<[f32; 4]>,
    /// The axis that bears the vertex, an index into `hierarchy`; of a leaf that of its twig.
    pub axes: Vec<u32>,
    /// The axes of the whole tree; the same for all parts and levels of it.
    pub hierarchy: Option<Arc<[AxisPivot]>>,
    /// The sway loop's morph targets; none where only attributes are wanted.
    pub targets: Vec<Target>,
    /// How their weights go; the same for all parts of a tree.
    pub sway: Option<Arc<Sway>>,
    /// What each vertex is bound to.
    pub bindings: Vec<Binding>,
    /// The joints of these bindings; the same for all parts and levels of a tree.
    pub bones: Option<Arc<Bones>>,
}

impl PartWind {
    /// Bytes that it takes, without what it shares with other parts.
    pub fn bytes(&self) -> u64 {
        let targets: u64 =
            self.targets.iter().map(|target| bytes_of::<Vec3>(target.offsets.capacity())).sum();
        bytes_of::<[f32; 4]>(self.motions.capacity() + self.pivots.capacity())
            + bytes_of::<u32>(self.axes.capacity())
            + bytes_of::<Binding>(self.bindings.capacity())
            + targets
    }
}

/// Where each vertex goes when this motion's weight is 1.
#[derive(Clone, Debug, PartialEq)]
pub struct Target {
    /// Which motion.
    pub motion: Motion,
    /// Metres, an entry per vertex.
    pub offsets: Vec<Vec3>,
}

/// One motion of the sway loop, with a weight for each frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Motion {
    /// To where everything is when all other weights are 0. Its weight is 1 while the loop plays.
    Begin,
    /// Stems bend with the wind, all together.
    Stem,
    /// Branches: the share that goes with the sine.
    BranchSine,
    /// The share that goes with the cosine.
    BranchCosine,
    /// Leaves: the share that goes with the sine.
    LeafSine,
    /// The share that goes with the cosine.
    LeafCosine,
}

impl Motion {
    /// In the order of all lists of them.
    pub const ALL: [Self; 6] =
        [Self::Begin, Self::Stem, Self::BranchSine, Self::BranchCosine, Self::LeafSine, Self::LeafCosine];

    /// Its name in files: an ASCII identifier.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Begin => "wind_begin",
            Self::Stem => "wind_stem",
            Self::BranchSine => "wind_branch_sin",
            Self::BranchCosine => "wind_branch_cos",
            Self::LeafSine => "wind_leaf_sin",
            Self::LeafCosine => "wind_leaf_cos",
        }
    }
}

/// The wind on a level of detail: the field of the whole tree, and which of its axes the level has.
#[derive(Clone, Copy)]
pub(crate) struct Blown<'a> {
    pub field: &'a Field<'a>,
    /// For each axis of the level its index in the whole tree; `None`: the same.
    pub axes: Option<&'a [u32]>,
}

#[cfg(test)]
mod tests;

#[cfg(test)]
mod bones_tests;
