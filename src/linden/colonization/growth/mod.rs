//! Growth by space colonization, exact and fast.
//!
//! # The rule
//! After Runions, Lane & Prusinkiewicz 2007, *Modeling Trees with a Space Colonization Algorithm*
//! (RLP07), section 3. This is the definition; results equal it bit for bit, in any order of the
//! points, on any machine and any number of threads.
//!
//! - **Distance.** `d² = x·x + y·y + z·z` of the coordinate differences, each operation rounded to
//!   `f32`, in this order; it is compared with the rounded squares of the distances in the rule.
//! - **Influence.** A live point influences the nearest node, if that is not beyond the influence
//!   distance; of equally near nodes the one with the lowest index. `S(v)` is the set of points that
//!   influence the node `v`.
//! - **Growth.** In each iteration, in the order of their indices, every node whose `S(v)` is not
//!   empty and is not what it was one iteration before (before the first: empty) grows one child
//!   `v + step · n`, where `n = normalize(normalize(Σ (s−v)/|s−v|) + tropism)` over `S(v)`. Nothing
//!   grows where the sum or its sum with the tropism vanishes, where rounding makes the child equal
//!   its parent, and where the parent has a child at that very place. (An unchanged `S(v)` would only
//!   grow the same child again; without this guard two symmetric points make the rule endless.)
//! - **Sums.** `(s−v)/|s−v|` is cut to a multiple of 2⁻³⁰ per component; these are summed as
//!   integers, all after that is `f64`, and the child is rounded to `f32`.
//! - **Rescue.** When no node grows so, because pulls cancel, each node with a live `S(v)` grows
//!   towards the nearest point in it (of equally near ones, the least by x, then y, then z), without
//!   tropism; the exceptions above hold.
//! - **Kill.** After the children of an iteration are all there, and once before the first, points
//!   within the kill distance of any node die.
//! - **End.** When no point lives, when no node grows, or at a limit. [`GrowthRule::max_nodes`] can be
//!   reached amid an iteration: its children are then placed in the order of their parents until
//!   there is no more room, points die as always, and growth ends.
//!
//! # How it runs
//! Nodes never move and never leave, so a point's nearest node changes only when a new node is
//! nearer. Each iteration therefore sends only the new nodes through a bounding-volume tree over
//! the points (`search`); what they capture is taken out of the old nodes' sums and added to the
//! new ones' (`influence`). A stretch of the tree is one thread's work; threads return what was
//! captured, and integer sums do not mind the order.
//!
//! # Memory
//! Beside the points that are given: 12 bytes a point while the tree is built, then 22 a point for
//! the tree and 60 a node (24 of which are the result), plus what a list takes while it moves to a
//! place larger by a quarter. In a crown filled at half its points' spacing there are 0.65 nodes a
//! point: about 62 bytes a point; ten million points were grown in 0.75 GB, those points included.

mod colony;
mod influence;
mod nodes;
mod search;
mod tree;

use glam::Vec3;

use crate::monitor::{Cancelled, Monitor};
use crate::skeleton::{Branching, NO_PARENT};
use colony::Colony;
use nodes::Nodes;
use search::Search;
use tree::PointTree;

/// No node.
const NONE: u32 = u32::MAX;

/// Coordinates and steps beyond this are refused: their squares would overflow.
const FARTHEST_M: f32 = 1e9;

/// How nodes follow points. Lengths in metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GrowthRule {
    /// Length of an internode, `D` in RLP07; above zero.
    pub step: f32,
    /// How far a point makes itself felt, `d_i`; above `kill`, may be infinite. Beyond about 20 steps
    /// it costs far more time than it changes.
    pub influence: f32,
    /// How near a node must come to a point to use it up, `d_k`; not below `step`, or growth would
    /// step over points for ever.
    pub kill: f32,
    /// Added to each unit direction of growth: `(0, 0.2, 0)` bends branches up a little.
    pub tropism: Vec3,
    /// The most iterations.
    pub max_iterations: u32,
    /// The most nodes, those at the start included.
    pub max_nodes: u32,
}

/// What has grown, and why it stopped.
#[derive(Clone, Debug, PartialEq)]
pub struct Growth {
    /// The nodes of the start, unchanged, and those grown after them in the order of iterations and
    /// of their parents; a grown node's birth is its iteration, from 1.
    pub branching: Branching,
    /// How many iterations placed nodes.
    pub iterations: u32,
    /// Points that are still alive.
    pub unreached: usize,
    /// Why growth ended.
    pub stop: Stop,
}

/// Why growth ended. A limit is named only if it kept something from growing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stop {
    /// Every point came within the kill distance of a node.
    AllReached,
    /// All points that live lie beyond the influence distance of every node.
    NothingInReach,
    /// Points are in reach, but rounding loses every step towards them: the step is too short for
    /// coordinates of this size.
    Stalled,
    /// [`GrowthRule::max_iterations`] have been made.
    MaxIterations,
    /// [`GrowthRule::max_nodes`] are there.
    MaxNodes,
}

/// Why nothing can grow.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum GrowthError {
    /// A length of the rule is zero, negative, not a number, or too long.
    #[error(
        "cannot grow: {knob} is {value} m, but must be above zero and at most {FARTHEST_M:e} m \
         (only influence may be infinite)"
    )]
    Length {
        /// `step`, `influence` or `kill`.
        knob: &'static str,
        /// Metres.
        value: f32,
    },
    /// A component of the tropism is not finite.
    #[error("cannot grow: tropism is ({}, {}, {}), but must be finite", .0.x, .0.y, .0.z)]
    Tropism(Vec3),
    /// Growth would step over points for ever.
    #[error(
        "cannot grow: the kill distance, {kill} m, is shorter than the step, {step} m, so nodes would step \
         over points without using them up; raise kill to at least {step} m or shorten step"
    )]
    KillBelowStep {
        /// Metres.
        kill: f32,
        /// Metres.
        step: f32,
    },
    /// Every point would die before it could be felt.
    #[error(
        "cannot grow: the influence distance, {influence} m, is not above the kill distance, {kill} m, so \
         points would be used up before they are felt; raise influence or lower kill"
    )]
    InfluenceWithinKill {
        /// Metres.
        influence: f32,
        /// Metres.
        kill: f32,
    },
    /// There is nothing to grow towards.
    #[error("cannot grow: there are no attraction points; ask for at least one")]
    NoPoints,
    /// Points are counted in 32 bits.
    #[error("cannot grow: {0} attraction points are more than the {max} that can be counted", max = u32::MAX)]
    TooManyPoints(usize),
    /// A point has a coordinate that is not finite or too large.
    #[error(
        "cannot grow: attraction point {index} lies at ({}, {}, {}), but coordinates must be finite and within \
         ±{FARTHEST_M:e} m; remove or move it", .at.x, .at.y, .at.z
    )]
    Point {
        /// Index into the points given.
        index: usize,
        /// Metres.
        at: Vec3,
    },
    /// There is nothing to grow from.
    #[error("cannot grow: there is no node to grow from; give at least a root")]
    NoStart,
    /// The nodes to grow from are not a branching structure.
    #[error("cannot grow: node {index} of the start {problem}")]
    Start {
        /// Index of the node.
        index: usize,
        /// What is wrong with it.
        problem: &'static str,
    },
    /// No live point is within the influence distance of a node at the start.
    #[error(
        "cannot grow: nothing is in reach; the nearest attraction point is {nearest_m} m away and the influence \
         distance is {influence_m} m; raise influence, or let a trunk lead to the crown"
    )]
    NothingInReach {
        /// Distance of the nearest live point from the nearest node, metres.
        nearest_m: f32,
        /// Metres.
        influence_m: f32,
    },
    /// Nobody wants the result any more.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// Grows nodes from `start` into `points` until every point is used up or a limit is reached.
///
/// The start is a root, with the nodes of a trunk if there is one, or several of these; it is kept
/// as it is, births included. The order of the points does not matter. Progress counts the points
/// that are used up.
///
/// ```
/// use linden::colonization::growth::{GrowthRule, Stop, grow};
/// use linden::{Branching, NO_PARENT, Quiet, Vec3};
///
/// let root = Branching { positions: vec![Vec3::ZERO], parents: vec![NO_PARENT], births: vec![0], radii: None };
/// let rule = GrowthRule {
///     step: 0.1,
///     influence: 2.0,
///     kill: 0.2,
///     tropism: Vec3::ZERO,
///     max_iterations: 1000,
///     max_nodes: 1000,
/// };
/// let growth = grow(&[Vec3::new(0.0, 1.0, 0.0)], &root, &rule, &Quiet)?;
/// assert_eq!(growth.stop, Stop::AllReached);
/// assert_eq!(growth.branching.positions.len(), 9);
/// # Ok::<(), linden::colonization::growth::GrowthError>(())
/// ```
///
/// # Errors
/// [`GrowthError`]: the rule contradicts itself, a point or node is not fit for use, nothing is in
/// reach of the start, or the monitor cancelled.
pub fn grow(
    points: &[Vec3],
    start: &Branching,
    rule: &GrowthRule,
    monitor: &dyn Monitor,
) -> Result<Growth, GrowthError> {
    grow_with(points, start, rule, monitor, Search::new)
}

fn grow_with(
    points: &[Vec3],
    start: &Branching,
    rule: &GrowthRule,
    monitor: &dyn Monitor,
    search: impl FnOnce(PointTree, f32) -> Search,
) -> Result<Growth, GrowthError> {
    rule.check()?;
    check_start(start)?;
    check_points(points, monitor)?;

    // A node is in reach when its distance is strictly below the next number.
    let beyond = (rule.influence * rule.influence).next_up();
    let tree = PointTree::over(points, beyond, monitor)?;
    let mut colony = Colony {
        nodes: Nodes::new(start),
        search: search(tree, rule.kill * rule.kill),
        rule,
        monitor,
        points: points.len(),
        live: points.len(),
    };
    colony.settle(0)?;
    if colony.live > 0 && !colony.reaches_any()? {
        return Err(out_of_reach(points, start, rule, monitor)?);
    }
    colony.run()
}

impl GrowthRule {
    fn check(&self) -> Result<(), GrowthError> {
        let &Self { step, influence, kill, tropism, .. } = self;
        for (knob, value, most) in
            [("step", step, FARTHEST_M), ("kill", kill, FARTHEST_M), ("influence", influence, f32::INFINITY)]
        {
            // Written so that NaN fails.
            if !(value > 0.0 && value <= most) {
                return Err(GrowthError::Length { knob, value });
            }
        }
        if !tropism.is_finite() {
            return Err(GrowthError::Tropism(tropism));
        }
        if kill < step {
            return Err(GrowthError::KillBelowStep { kill, step });
        }
        if influence <= kill {
            return Err(GrowthError::InfluenceWithinKill { influence, kill });
        }
        Ok(())
    }
}

/// Whether squares of differences cannot overflow. False for NaN.
fn fit(position: Vec3) -> bool {
    position.abs().cmple(Vec3::splat(FARTHEST_M)).all()
}

fn check_start(start: &Branching) -> Result<(), GrowthError> {
    let Branching { positions, parents, births, .. } = start;
    let nodes = positions.len();
    if nodes == 0 {
        return Err(GrowthError::NoStart);
    }
    let wrong = |index, problem| Err(GrowthError::Start { index, problem });
    if parents.len() != nodes || births.len() != nodes {
        return wrong(parents.len().min(births.len()).min(nodes), "lacks a position, parent or birth");
    }
    if nodes >= NONE as usize {
        return wrong(NONE as usize, "is one more than can be counted");
    }
    for index in 0..nodes {
        if !fit(positions[index]) {
            return wrong(index, "has a coordinate that is not finite or beyond ±1e9 m");
        }
        if parents[index] != NO_PARENT && parents[index] as usize >= index {
            return wrong(index, "does not come after its parent");
        }
    }
    Ok(())
}

fn check_points(points: &[Vec3], monitor: &dyn Monitor) -> Result<(), GrowthError> {
    if points.is_empty() {
        return Err(GrowthError::NoPoints);
    }
    if points.len() > u32::MAX as usize {
        return Err(GrowthError::TooManyPoints(points.len()));
    }
    for (slice, some) in points.chunks(tree::SLICE).enumerate() {
        monitor.check()?;
        if let Some(index) = some.iter().position(|&point| !fit(point)) {
            return Err(GrowthError::Point { index: slice * tree::SLICE + index, at: some[index] });
        }
    }
    Ok(())
}

/// The error that says how far away the nearest live point is.
fn out_of_reach(
    points: &[Vec3],
    start: &Branching,
    rule: &GrowthRule,
    monitor: &dyn Monitor,
) -> Result<GrowthError, Cancelled> {
    let mut search = Search::new(PointTree::over(points, f32::INFINITY, monitor)?, rule.kill * rule.kill);
    search.capture(0, &start.positions, monitor, |_| ())?;
    let mut nearest2 = f32::INFINITY;
    search.live(monitor, |_, d2, _| nearest2 = nearest2.min(d2))?;
    Ok(GrowthError::NothingInReach { nearest_m: nearest2.sqrt(), influence_m: rule.influence })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::monitor::Quiet;
    use crate::random::Key;

    #[test]
    fn vector_instructions_do_not_change_a_bit() {
        let key = Key::new(5);
        let points: Vec<Vec3> = (0..20_000)
            .map(|i| Vec3::from([0, 1, 2].map(|axis| key.child(i).child(axis).between(-1.0, 1.0) as f32)))
            .collect();
        let root =
            Branching { positions: vec![Vec3::ZERO], parents: vec![NO_PARENT], births: vec![0], radii: None };
        for influence in [0.4, f32::INFINITY] {
            let rule = GrowthRule {
                step: 0.03,
                influence,
                kill: 0.06,
                tropism: Vec3::new(0.0, 0.2, 0.0),
                max_iterations: 1000,
                max_nodes: 100_000,
            };
            let detected = grow_with(&points, &root, &rule, &Quiet, Search::new).unwrap();
            let portable = grow_with(&points, &root, &rule, &Quiet, Search::portable).unwrap();
            assert!(detected.branching.positions.len() > 5000);
            assert_eq!(detected, portable);
        }
    }
}
