//! The axial tree: what all generators give and everything after them takes.
//!
//! A generator gives a [`Branching`] (nodes and their parents); [`Skeleton`] adds what a botanist
//! sees in it: axes with their orders, and radii. Nodes come parents before children.

mod axes;
mod bits;
mod cylinders;
pub mod edit;
mod fingerprint;
mod fits;
pub mod generator;
mod marks;
mod measure;
mod memory;
mod obstruction;
pub mod organs;
pub mod publication;
mod radii;
pub mod refine;
mod side;
mod topology;
mod trees;
mod wood;
mod young;

use fingerprint::Fingerprint;
use glam::Vec3;
use radii::Built;

use linden_base::random::Key;

pub use axes::Forks;
pub use cylinders::Cylinder;
pub use fits::{RadiusFit, RadiusSource};
pub use marks::{Marks, Tips};
pub use measure::{BREAST_HEIGHT_M, Measures};
pub use radii::axes_by_tips;
pub use radii::pipe::count_tips;
pub use radii::{AxisRule, Girth, Span, Width, WidthSteps, Wood};
pub use side::{AxisKind, SideWood};
pub use topology::{BranchingAngle, Children, Streams, ratio_of_orders};
pub use trees::TreeIndex;

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
    /// Metres, where the generator itself says how thick the wood is (a grammar's `!`, a scan's
    /// bark); `None`: the [`Wood`] decides.
    pub radii: Option<Vec<f32>>,
    /// How each node is joined to its parent, where the generator knows (a grammar's brackets);
    /// `None`: the thickest child goes on. What stands for the foot of a stem means nothing.
    pub edges: Option<Vec<Edge>>,
}

/// How a node is joined to its parent: the two relations between internodes of an axial tree (ABOP,
/// section 1.6.1), written `<` and `+` in multiscale tree graphs (Godin & Caraglio 1998).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum Edge {
    /// It continues its parent's axis.
    #[default]
    Succeeds,
    /// It begins a lateral axis.
    Branches,
    /// It begins a lateral axis of dead wood: nothing that is borne by it lives.
    Dies,
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
    /// How the radius goes from node to node.
    pub width_steps: WidthSteps,
    /// What editing left behind ([`edit`]); empty as grown.
    pub marks: Marks,
    /// What bears out each radius, of a tree that was measured and not edited since; empty for others. Nodes beyond
    /// its end were added later.
    pub fits: Vec<RadiusFit>,
    /// Of each foot, in the order of the nodes, the tree that it is of, where several grew together: feet of equal numbers
    /// are stems of one tree. Empty: all are one ([`Skeleton::tree_index`]).
    pub trees: Vec<u32>,
}

/// Why a branching is no tree. A generator that returns such a thing has a bug, but callers of the
/// library may build branchings too.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum SkeletonError {
    /// No node at all.
    #[error("a skeleton needs at least one segment, and there is none")]
    Empty,
    /// Arrays of different lengths.
    #[error(
        "the branching's arrays differ in length: {positions} positions, {parents} parents, {births} births"
    )]
    Lengths {
        /// Entries in `positions`.
        positions: usize,
        /// Entries in `parents`.
        parents: usize,
        /// Entries in `births`.
        births: usize,
    },
    /// A parent that does not come before its child.
    #[error("node {node} has the parent {parent}, which does not come before it")]
    Order {
        /// The child.
        node: usize,
        /// What it calls its parent.
        parent: u32,
    },
    /// NaN or infinity.
    #[error("node {node} stands at a place that is not finite")]
    NotFinite {
        /// The node.
        node: usize,
    },
    /// Radii of another number than nodes, or one that is not finite.
    #[error("node {node} was given a radius that is missing or not finite")]
    Radius {
        /// The node.
        node: usize,
    },
    /// Edges of another number than nodes, or a second one that continues the same axis.
    #[error(
        "node {node} was given an edge that is missing, or continues an axis that another node continues"
    )]
    Edge {
        /// The node.
        node: usize,
    },
}

/// Which nodes are dead wood; `None` where none are.
fn dead(parents: &[u32], edges: &[Edge]) -> Option<Vec<bool>> {
    edges.contains(&Edge::Dies).then(|| {
        let mut is_dead = vec![false; parents.len()];
        for (node, (&parent, &edge)) in parents.iter().zip(edges).enumerate() {
            is_dead[node] = parent != NO_PARENT && (edge == Edge::Dies || is_dead[parent as usize]);
        }
        is_dead
    })
}

/// Takes out all items that are not to be kept.
pub(crate) fn compact<T>(items: &mut Vec<T>, keep: &[bool]) {
    let mut keep = keep.iter();
    items.retain(|_| keep.next().is_some_and(|&keep| keep));
}

impl Branching {
    /// Takes out all nodes that are not to be kept, with what grows on them: that must not be kept either. `keep` says it
    /// of every node.
    ///
    /// # Panics
    /// Where `keep` is shorter than [`Branching::parents`].
    pub fn retain(&mut self, keep: &[bool]) {
        let Self { positions, parents, births, radii, edges } = self;
        let mut index = vec![NO_PARENT; parents.len()];
        let kept = (0..parents.len()).filter(|&node| keep[node]);
        for (new, node) in (0..).zip(kept) {
            index[node] = new;
        }
        compact(parents, keep);
        for parent in parents.iter_mut().filter(|parent| **parent != NO_PARENT) {
            *parent = index[*parent as usize];
        }
        compact(positions, keep);
        compact(births, keep);
        if let Some(radii) = radii {
            compact(radii, keep);
        }
        if let Some(edges) = edges {
            compact(edges, keep);
        }
    }

    /// Whether the arrays describe a tree with at least one segment.
    ///
    /// # Errors
    /// The first thing that is wrong.
    pub fn validate(&self) -> Result<(), SkeletonError> {
        let (positions, parents, births) = (self.positions.len(), self.parents.len(), self.births.len());
        if positions != parents || positions != births {
            return Err(SkeletonError::Lengths { positions, parents, births });
        }
        if let Some(node) = self.positions.iter().position(|p| !p.is_finite()) {
            return Err(SkeletonError::NotFinite { node });
        }
        if let Some(radii) = &self.radii {
            let strange = radii.iter().position(|radius| !radius.is_finite());
            if let Some(node) = strange.or((radii.len() != positions).then_some(radii.len().min(positions))) {
                return Err(SkeletonError::Radius { node });
            }
        }
        let mut segments = 0_usize;
        for (node, &parent) in self.parents.iter().enumerate() {
            if parent != NO_PARENT {
                segments += 1;
                if parent as usize >= node {
                    return Err(SkeletonError::Order { node, parent });
                }
            }
        }
        self.check_edges()?;
        if segments == 0 { Err(SkeletonError::Empty) } else { Ok(()) }
    }

    fn check_edges(&self) -> Result<(), SkeletonError> {
        let Some(edges) = &self.edges else { return Ok(()) };
        if edges.len() != self.parents.len() {
            return Err(SkeletonError::Edge { node: edges.len().min(self.parents.len()) });
        }
        let mut is_continued = vec![false; self.parents.len()];
        for (node, (&parent, &edge)) in self.parents.iter().zip(edges).enumerate() {
            if parent != NO_PARENT
                && edge == Edge::Succeeds
                && std::mem::replace(&mut is_continued[parent as usize], true)
            {
                return Err(SkeletonError::Edge { node });
            }
        }
        Ok(())
    }
}

impl Skeleton {
    /// Finds axes and radii.
    ///
    /// Where the branching has [`Edge`]s and `wood` goes by them ([`Wood::axes`]), they say which child
    /// continues its parent's axis, and an axis ends where all children branch. Otherwise the thickest
    /// child (then the straightest, then the first) continues it. All others start laterals.
    ///
    /// ```
    /// use glam::Vec3;
    /// use linden_skeleton::{Branching, NO_PARENT, Skeleton};
    /// let fork = Branching {
    ///     positions: vec![Vec3::ZERO, Vec3::Y, Vec3::new(0.0, 2.0, 0.0), Vec3::new(1.0, 2.0, 0.0)],
    ///     parents: vec![NO_PARENT, 0, 1, 1],
    ///     births: vec![0, 1, 2, 2],
    ///     radii: None,
    ///     edges: None,
    /// };
    /// let tree = Skeleton::build(fork, &Default::default())?;
    /// assert_eq!(tree.axes.len(), 2);
    /// assert_eq!(tree.nodes_of(&tree.axes[0]), [0, 1, 2]); // straight on
    /// # Ok::<(), linden_skeleton::SkeletonError>(())
    /// ```
    ///
    /// # Errors
    /// When the branching is no tree: see [`Branching::validate`].
    pub fn build(branching: Branching, wood: &Wood) -> Result<Self, SkeletonError> {
        Self::build_keyed(branching, wood, Key::new(0))
    }

    /// The same with the key of what [`Width::Taper`] draws; all other rules draw nothing.
    ///
    /// # Errors
    /// When the branching is no tree: see [`Branching::validate`].
    pub fn build_keyed(branching: Branching, wood: &Wood, key: Key) -> Result<Self, SkeletonError> {
        branching.validate()?;
        let Branching { positions, parents, births, radii: given, edges } = branching;
        let is_dead = edges.as_deref().and_then(|edges| dead(&parents, edges));
        let edges = edges.filter(|_| wood.axes != AxisRule::Thickest);
        let Built { axes, axis_nodes, radii } =
            radii::build(&positions, &parents, given, edges.as_deref(), wood, key);
        let (width_steps, marks) = (wood.width_steps, Marks::default());
        let mut tree = Self {
            positions,
            parents,
            radii,
            births,
            axes,
            axis_nodes,
            width_steps,
            marks,
            fits: Vec::new(),
            trees: Vec::new(),
        };
        if let Some(is_dead) = is_dead {
            tree.kill(|tree, axis| tree.nodes_of(axis).first().is_some_and(|&base| is_dead[base as usize]));
        }
        Ok(tree)
    }

    /// The nodes of an axis, base to apex.
    ///
    /// # Panics
    /// With an axis of another tree, which may name nodes that this one does not have.
    pub fn nodes_of(&self, axis: &Axis) -> &[u32] {
        &self.axis_nodes[axis.first as usize..(axis.first + axis.len) as usize]
    }

    /// Radius of the thickest stem at its foot, metres; 0 without any.
    pub fn foot_radius_m(&self) -> f32 {
        let stems = self.axes.iter().filter(|axis| axis.parent == NO_PARENT);
        let feet = stems.filter_map(|axis| self.nodes_of(axis).first());
        feet.map(|&foot| self.radii[foot as usize]).fold(0.0, f32::max)
    }

    /// How many segments (internodes) there are: each node but the feet of the stems ends one.
    pub fn segments(&self) -> usize {
        self.parents.iter().filter(|&&p| p != NO_PARENT).count()
    }

    /// A 128-bit fingerprint of everything in it (XXH3 over little-endian bytes): equal on all
    /// machines and for any number of threads exactly when the skeleton is the same, bit for bit.
    pub fn hash(&self) -> u128 {
        let mut fingerprint = Fingerprint::new();
        fingerprint.vectors(&self.positions);
        fingerprint.words(self.parents.iter().copied());
        fingerprint.reals(&self.radii);
        fingerprint.words(self.births.iter().copied());
        fingerprint.words(self.axes.iter().flat_map(|a| [a.order, a.parent, a.first, a.len]));
        fingerprint.words(self.axis_nodes.iter().copied());
        if self.width_steps == WidthSteps::Cylinder {
            fingerprint.words([1]);
        }
        if !self.marks.is_empty() {
            let Marks { numbers, cuts, tips } = &self.marks;
            fingerprint.words(numbers.iter().copied());
            fingerprint.words(cuts.iter().copied());
            let bits = tips.map_or(0, |tips| tips.radii_m.to_bits());
            fingerprint.words([bits as u32, (bits >> 32) as u32, tips.map_or(0, |tips| tips.count)]);
        }
        fingerprint.finish()
    }
}
