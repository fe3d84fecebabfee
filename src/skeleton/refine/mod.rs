//! Refinement: what is done to a branching between growth and radii, step by step.
//!
//! RLP07, section 4, decimates the nodes, moves each halfway towards its parent and subdivides the
//! result. Each step here takes a [`Branching`] and gives one: parents before children, stems on
//! their feet, radii and births carried along. Steps draw nothing and take time in proportion to
//! the nodes. A new step is a file and a line in [`STEPS`]. After them the trunk is bent onto a curve
//! (`bend`), and axes wander (`wander`), as far as is asked for.

mod bend;
mod decimate;
mod prune;
mod relocate;
mod smooth;
mod subdivide;
mod wander;

use std::fmt;

use glam::Vec3;
use rayon::prelude::*;

use super::axes::successors;
use super::radii::pipe::count_tips;
use super::{Branching, Edge, NO_PARENT, SideWood, Wood, compact};
use linden_base::memory::{OverMemory, bytes_of};
use linden_base::monitor::{Cancelled, Monitor, Phase};
use linden_base::random::Key;

/// One way to change a branching.
#[derive(Clone, Copy)]
pub struct Step {
    /// The name that recipes give it: `relocate`.
    pub name: &'static str,
    /// One line: what it does.
    pub help: &'static str,
    apply: fn(&mut Shoots<'_>, &Refinement, &dyn Monitor) -> Result<(), RefineError>,
}

/// All steps, in the order in which RLP07 takes them.
pub static STEPS: [Step; 5] = [prune::STEP, decimate::STEP, relocate::STEP, smooth::STEP, subdivide::STEP];

impl Step {
    /// The step of a name.
    pub fn named(name: &str) -> Option<Self> {
        STEPS.iter().copied().find(|step| step.name == name)
    }
}

impl PartialEq for Step {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
    }
}

impl fmt::Debug for Step {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name)
    }
}

/// Which steps, in their order, and how far each goes.
#[derive(Clone, Debug, PartialEq)]
pub struct Refinement {
    /// The steps, in this order; none by default.
    pub steps: Vec<Step>,
    /// For `prune`, where it is unknown which nodes caught a point: the longest twig that goes, nodes.
    pub prune_nodes: u32,
    /// For `decimate`: how far the axes may move, in mean segment lengths.
    pub decimate_tolerance: f64,
    /// For `relocate`: how far each node goes towards its parent, 0 to 1.
    pub relocate_share: f64,
    /// For `smooth`: how often each node is averaged with its neighbours.
    pub smooth_rounds: u32,
    /// For `subdivide`: how often each segment is halved.
    pub subdivisions: u32,
    /// x, y, z of the control points of a Bézier curve that starts at the first stem's foot, metres from
    /// there: the stem is bent onto it. As grown where there is nothing but zeros.
    pub trunk_curve: Vec<f64>,
    /// How far axes swing to the side, as a share of their length, about.
    pub sway: f64,
    /// How far axes bend to and fro over a few times their thickness, as a share of it, about.
    pub gnarl: f64,
    /// What a stem has of that below its lowest limb, 0 to 1.
    pub trunk_gnarl: f64,
    /// Epicormic shoots and dead twigs; they are no refinement of what grew, and stand on the finished tree.
    pub side: SideWood,
}

impl Refinement {
    /// Whether it leaves everything as it is.
    pub fn is_idle(&self) -> bool {
        self.steps.is_empty() && !self.bends() && !self.wanders()
    }

    fn bends(&self) -> bool {
        self.trunk_curve.iter().any(|&x| x != 0.0)
    }

    /// Whether axes are displaced at random.
    pub fn wanders(&self) -> bool {
        self.sway > 0.0 || self.gnarl > 0.0
    }
}

impl Default for Refinement {
    /// No step; relocation goes halfway, as in RLP07.
    fn default() -> Self {
        Self {
            steps: Vec::new(),
            prune_nodes: 1,
            decimate_tolerance: 0.25,
            relocate_share: 0.5,
            smooth_rounds: 2,
            subdivisions: 1,
            trunk_curve: vec![0.0],
            sway: 0.0,
            gnarl: 0.0,
            trunk_gnarl: 1.0,
            side: SideWood::default(),
        }
    }
}

/// Why a branching was not refined.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum RefineError {
    /// Nobody wanted the result any more.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// It would take more memory than there may be.
    #[error(transparent)]
    Memory(#[from] OverMemory),
    /// Subdivision makes more nodes than are allowed.
    #[error(
        "'subdivide' would give {nodes} nodes, more than the limit of {limit}; lower subdivisions, take \
         subdivide out of refine, or raise max_nodes or symbol_limit"
    )]
    TooManyNodes {
        /// How many there would be.
        nodes: u64,
        /// The limit.
        limit: u64,
    },
    /// The numbers are no points.
    #[error(
        "trunk_curve has {numbers} numbers, and each control point needs three: x y z, metres from the foot, like 0 3 0 1 6 0"
    )]
    TrunkCurve {
        /// How many there are.
        numbers: usize,
    },
}

/// A thing that hangs on a node, an organ say, and is to stay with it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rider {
    /// The node.
    pub node: u32,
    /// How far refinement has moved it, metres.
    pub moved: Vec3,
}

/// The limits of refinement, and what its random steps follow from.
#[derive(Clone, Copy)]
pub struct Room<'a> {
    /// Most nodes of the result, which may have as many as before in any case.
    pub most_nodes: u64,
    /// Where no node may go: in an obstacle. A node that would go there stays where it is.
    pub is_barred: &'a (dyn Fn(Vec3) -> bool + Sync),
    /// The key of the random numbers of sway and gnarl.
    pub key: Key,
    /// How thick the wood will be, by which gnarl bends it.
    pub wood: Wood,
}

impl Room<'_> {
    /// Room for `most_nodes` nodes, anywhere, for wood of the usual thickness.
    pub fn open(most_nodes: u64) -> Self {
        Self { most_nodes, is_barred: &|_| false, key: Key::new(0), wood: Wood::default() }
    }
}

/// Takes all steps of a refinement.
///
/// `riders` are moved with their nodes. Where a node is decimated, they stay where they are and hang
/// on the node below; where a twig is pruned, they go to where it left.
///
/// `captured` says for each node whether it ever was the nearest to an attraction point, where the
/// generator knows.
///
/// ```
/// use linden_skeleton::refine::{Refinement, Room, Step, refine};
/// use glam::Vec3;
/// use linden_base::monitor::Quiet;
/// use linden_skeleton::{Branching, NO_PARENT};
/// let elbow = Branching {
///     positions: vec![Vec3::ZERO, Vec3::Y, Vec3::Y + Vec3::X],
///     parents: vec![NO_PARENT, 0, 1],
///     births: vec![0, 1, 2],
///     radii: None,
///     edges: None,
/// };
/// let steps = Step::named("relocate").into_iter().collect();
/// let relocate = Refinement { steps, ..Refinement::default() };
/// let softer = refine(elbow, None, &mut [], &relocate, Room::open(1000), &Quiet)?;
/// assert_eq!(softer.positions, [Vec3::ZERO, Vec3::Y * 0.5, Vec3::new(0.5, 1.0, 0.0)]);
/// # Ok::<(), linden_skeleton::refine::RefineError>(())
/// ```
///
/// # Errors
/// [`RefineError`]: too many nodes, too much memory, numbers that are no points, or cancelled.
///
/// # Panics
/// Where the branching does not pass [`Branching::validate`] (a tree of one node may), or `captured`
/// is of another length, or a rider's node does not exist.
pub fn refine(
    branching: Branching,
    captured: Option<Vec<bool>>,
    riders: &mut [Rider],
    refinement: &Refinement,
    room: Room<'_>,
    monitor: &dyn Monitor,
) -> Result<Branching, RefineError> {
    let mut shoots = Shoots { branching, captured, riders, room };
    let steps = refinement.steps.len() as u64;
    for (done, step) in (0..).zip(&refinement.steps) {
        monitor.check()?;
        shoots.admit(0, monitor)?;
        monitor.advance(Phase::Refine, done, Some(steps));
        (step.apply)(&mut shoots, refinement, monitor)?;
    }
    if refinement.bends() {
        shoots.admit(shoots.len(), monitor)?;
        bend::bend(&mut shoots, refinement)?;
    }
    if refinement.wanders() {
        // Axes, their keys and nodes, and places.
        shoots.admit(2 * shoots.len(), monitor)?;
        shoots.branching.admit_build(&room.wood, monitor)?;
        wander::wander(&mut shoots, refinement, monitor)?;
    }
    monitor.advance(Phase::Refine, steps, Some(steps));
    Ok(shoots.branching)
}

/// A branching on its way.
struct Shoots<'a> {
    branching: Branching,
    captured: Option<Vec<bool>>,
    riders: &'a mut [Rider],
    room: Room<'a>,
}

/// What becomes of the riders of nodes that are dropped.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Left {
    /// They stay where they are: the wood there stays, too.
    Stay,
    /// They go to the node below that is kept.
    Fall,
}

/// Nodes between two looks at the monitor.
const NODES_PER_CHECK: usize = 1 << 16;

impl Shoots<'_> {
    fn len(&self) -> usize {
        self.branching.parents.len()
    }

    /// Moves all nodes that have room there, and the riders with them.
    fn relocate(&mut self, mut positions: Vec<Vec3>) {
        let is_barred = self.room.is_barred;
        positions.par_iter_mut().zip(&self.branching.positions).for_each(|(new, &old)| {
            if *new != old && is_barred(*new) {
                *new = old;
            }
        });
        for rider in &mut *self.riders {
            let node = rider.node as usize;
            rider.moved += positions[node] - self.branching.positions[node];
        }
        self.branching.positions = positions;
    }

    /// Asks for what a step holds: the branching, room for `new` nodes beside it, and scratch memory,
    /// at most a position and two indices a node.
    fn admit(&self, new: usize, monitor: &dyn Monitor) -> Result<(), OverMemory> {
        let captured = usize::from(self.captured.is_some());
        let made = Branching::bytes_for(new)
            + bytes_of::<f32>(if self.branching.radii.is_some() { new } else { 0 })
            + bytes_of::<Edge>(if self.branching.edges.is_some() { new } else { 0 })
            + bytes_of::<bool>(new * captured);
        let scratch = bytes_of::<([f32; 3], [u32; 2], [bool; 2])>(self.len());
        let held = self.branching.bytes()
            + bytes_of::<bool>(self.len() * captured)
            + bytes_of::<Rider>(self.riders.len());
        monitor.admit("refining the branches", held + made + scratch, "take steps out of refine")
    }

    /// For each node the child that continues its axis as far as can be told without radii: the one
    /// with the most tips, then the straightest, then the first.
    fn successors(&self) -> Vec<u32> {
        let Branching { positions, parents, edges, .. } = &self.branching;
        let tips = count_tips(parents);
        successors(positions, parents, edges.as_deref(), move |a, b| tips[a as usize].cmp(&tips[b as usize]))
    }

    /// Drops all nodes that are not to be kept; the children of such a node become its parent's, and
    /// what it captured counts for them. Feet must be kept.
    fn retain(&mut self, keep: &[bool], left: Left, monitor: &dyn Monitor) -> Result<(), Cancelled> {
        let Branching { positions, parents, births, radii, edges } = &mut self.branching;
        if let Some(captured) = &mut self.captured {
            monitor.check()?;
            for (node, &parent) in parents.iter().enumerate() {
                if parent != NO_PARENT && !keep[parent as usize] {
                    captured[node] |= captured[parent as usize];
                }
            }
            compact(captured, keep);
        }
        monitor.check()?;
        // Where a node goes, or, of one that is dropped, where the next one below it goes.
        let mut index = vec![NO_PARENT; parents.len()];
        let mut kept = 0;
        if left == Left::Fall {
            for rider in &mut *self.riders {
                let place = positions[rider.node as usize];
                let mut node = rider.node as usize;
                while !keep[node] {
                    node = parents[node] as usize;
                }
                rider.moved += positions[node] - place;
            }
        }
        for old in 0..parents.len() {
            if old.is_multiple_of(NODES_PER_CHECK) {
                monitor.check()?;
            }
            let below = match parents[old] {
                NO_PARENT => NO_PARENT,
                parent => {
                    // What hung on the dropped first node of a lateral begins it now.
                    if let Some(edges) = edges.as_mut()
                        && !keep[parent as usize]
                    {
                        edges[old] = edges[old].max(edges[parent as usize]);
                    }
                    index[parent as usize]
                }
            };
            index[old] = if keep[old] { kept } else { below };
            if keep[old] {
                parents[kept as usize] = below;
                kept += 1;
            }
        }
        parents.truncate(kept as usize);
        for rider in &mut *self.riders {
            rider.node = index[rider.node as usize];
        }
        drop(index);
        monitor.check()?;
        compact(positions, keep);
        compact(births, keep);
        if let Some(edges) = edges {
            compact(edges, keep);
        }
        if let Some(radii) = radii {
            compact(radii, keep);
        }
        Ok(())
    }
}

/// Where the straight line between a node's neighbours is divided as the node divides the way between
/// them. Averaging with this point instead of with the middle moves no node of a straight axis, so
/// that laterals are not dragged along stems of uneven segments.
fn on_chord(below: Vec3, here: Vec3, above: Vec3) -> Vec3 {
    let (before, after) = (below.distance(here), here.distance(above));
    let whole = before + after;
    if whole > 0.0 { below + (above - below) * (before / whole) } else { here }
}

#[cfg(test)]
mod testing;
