//! The tree as a generator grows it, and what it knows of it.

use glam::{DVec3, Vec3};
use linden_base::memory::{OverMemory, bytes_of};
use linden_base::monitor::{Cancelled, Monitor};

use super::scanned::{Gaps, Scanned};
use crate::organs::Organs;
use crate::{Branching, RadiusFit, Skeleton, Wood};

/// The tree as a generator grows it, before refinement, and notes about it.
pub struct Branched {
    /// Nodes and their parents.
    pub branching: Branching,
    /// Leaves and other organs that it placed on the nodes.
    pub organs: Organs,
    /// The nodes that were of use, where there is such a thing; else the lengths of twigs decide what is
    /// pruned.
    pub used: Option<Vec<bool>>,
    /// The generator's limit of nodes, which holds for the refined tree too; [`Branched::default`] has no limit
    /// (`u64::MAX`).
    pub most_nodes: u64,
    /// Whether no branch is to be moved to a place.
    pub barred: Option<Barred>,
    /// Measurements that the generator made of the tree.
    pub measured: Option<Box<dyn Measured>>,
    /// The share of its births that is to be shown; `None`: all.
    pub age: Option<f64>,
    /// Length of the derived string, for L-systems.
    pub symbols: Option<u64>,
    /// The attraction points, and how many were reached.
    pub colonized: Option<Colonized>,
    /// The place of its foot in the file that it was grown from, points or cylinders, in the file's axes and units; `None` of what
    /// has no place in a file.
    pub foot: Option<DVec3>,
    /// Of each foot, in the order of the nodes, the tree that it is of, where several grew: [`Skeleton::trees`].
    pub trees: Vec<u32>,
    /// Messages for the user: limits that were hit, meshes that are open.
    pub notes: Vec<String>,
}

impl Default for Branched {
    /// No nodes, nothing known of them, and no limit of how many there may be.
    fn default() -> Self {
        Self {
            branching: Branching::default(),
            organs: Organs::default(),
            used: None,
            most_nodes: u64::MAX,
            barred: None,
            measured: None,
            age: None,
            symbols: None,
            colonized: None,
            foot: None,
            trees: Vec::new(),
            notes: Vec::new(),
        }
    }
}

/// Whether a place, metres, is not to be entered.
pub type Barred = Box<dyn Fn(Vec3) -> bool + Send + Sync>;

/// Measurements of a real tree, where the tree of a generator stands.
pub trait Measured: Send + Sync {
    /// How many points beside them were taken for leaves, and measure nothing.
    fn leaf_points(&self) -> usize {
        0
    }

    /// Bytes that they take.
    fn bytes(&self) -> u64;

    /// Asks for the memory of [`Measured::measure`] and [`Measured::gaps`].
    ///
    /// # Errors
    /// [`OverMemory`].
    fn admit(&self, branching: &Branching, monitor: &dyn Monitor) -> Result<(), OverMemory>;

    /// Gives all nodes radii, metres, and moves them where the wood was measured to be; strands that lie in thicker
    /// wood may go. What bears out the radius of each node that stays; `None` where radii are to follow the wood's
    /// rule.
    ///
    /// # Errors
    /// [`Cancelled`].
    fn measure(
        &self,
        branching: &mut Branching,
        wood: &Wood,
        monitor: &dyn Monitor,
    ) -> Result<Option<Vec<RadiusFit>>, Cancelled>;

    /// How far the tree and the measurements are apart; `None` where there is nothing to measure from or to.
    ///
    /// # Errors
    /// [`Cancelled`].
    fn gaps(&self, skeleton: &Skeleton, monitor: &dyn Monitor) -> Result<Option<Gaps>, Cancelled>;

    /// The points.
    fn into_points(self: Box<Self>) -> Vec<Vec3>;
}

/// How space colonization went.
#[derive(Clone, Debug)]
pub struct Colonized {
    /// The attraction points, where the tree stands.
    pub points: Vec<Vec3>,
    /// How many of them were not reached.
    pub unreached: usize,
    /// Iterations that placed nodes.
    pub iterations: u32,
    /// Whether the points of a scan showed a crown without a stem, and were grown into as they are.
    pub is_canopy: bool,
    /// How the tree compares with the scan that it grew into; `None` for what is no scan.
    pub scan: Option<Scanned>,
}

impl Colonized {
    /// The points that people want to see: those of the scan, where it grew into one, else the attraction points.
    pub fn seen(&self) -> &[Vec3] {
        self.scan.as_ref().map_or(&self.points, |scan| &scan.points)
    }

    /// Bytes that it takes.
    pub fn bytes(&self) -> u64 {
        bytes_of::<Vec3>(self.points.capacity()) + self.scan.as_ref().map_or(0, Scanned::bytes)
    }
}

/// Trees that an input tells apart.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct InputTrees {
    /// The knob that picks one by its number.
    pub knob: &'static str,
    /// What tells them apart, as a message names it: a column, a file.
    pub told_by: String,
    /// What they are made of: `points`.
    pub made_of: &'static str,
    /// The numbers in rising order, with how much of that each tree has.
    pub numbers: Vec<(u32, usize)>,
}
