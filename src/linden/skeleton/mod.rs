//! The axial tree: what both generators give and everything after them takes.
//!
//! A generator gives a [`Branching`] (nodes and their parents); [`Skeleton`] adds what a botanist
//! sees in it: axes with their orders, and radii. Nodes come parents before children.

use glam::Vec3;

/// The parent of a node that stands at the foot of a stem.
pub const NO_PARENT: u32 = u32::MAX;

/// The bare branching structure that a generator gives: no axes, no radii.
///
/// All arrays have one entry per node; a parent's index is below its children's.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Branching {
    /// Metres, Y up.
    pub positions: Vec<Vec3>,
    /// Index of the node that this one grew from, or [`NO_PARENT`].
    pub parents: Vec<u32>,
    /// The derivation step or iteration in which the node appeared, 0 for what was there at first.
    pub births: Vec<u32>,
}

/// One axis: a chain of internodes from its base to its apex.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Axis {
    /// 0 for a stem, one more than the parent axis for a lateral.
    pub order: u32,
    /// The node that the axis leaves from; [`NO_PARENT`] for a stem.
    pub parent: u32,
    /// Where the axis' nodes start in [`Skeleton::axis_nodes`].
    pub first: u32,
    /// How many nodes the axis owns (the node it leaves from belongs to its parent axis).
    pub len: u32,
}

/// The axial tree with radii.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Skeleton {
    /// Metres, Y up.
    pub positions: Vec<Vec3>,
    /// Index of the parent node, or [`NO_PARENT`].
    pub parents: Vec<u32>,
    /// Metres, above zero.
    pub radii: Vec<f32>,
    /// Birth step per node.
    pub births: Vec<u32>,
    /// All axes: parents before laterals.
    pub axes: Vec<Axis>,
    /// Node indices, axis by axis, base to apex. Each node stands here once.
    pub axis_nodes: Vec<u32>,
}

impl Skeleton {
    /// The nodes of an axis, base to apex.
    pub fn nodes_of(&self, axis: &Axis) -> &[u32] {
        &self.axis_nodes[axis.first as usize..(axis.first + axis.len) as usize]
    }
}
