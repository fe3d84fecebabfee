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
//!   distance; of equally near nodes the one with the lowest index. `N(v)` is the set of points that
//!   have `v` as that node, and `S(v)`, the points that pull at `v`, is the same.
//! - **Growth.** In each iteration, in the order of their indices, every node whose `S(v)` is not
//!   empty and is not what it was one iteration before (before the first: empty) grows one child
//!   `v + step · n`, where `n = normalize(normalize(Σ (s−v)/|s−v|) + tropism)` over `S(v)`. Nothing
//!   grows where the sum or its sum with the tropism vanishes, where rounding makes the child equal
//!   its parent, and where the parent has a child at that very place. (An unchanged `S(v)` would only
//!   grow the same child again; without this guard two symmetric points make the rule endless.)
//! - **Sums.** `(s−v)/|s−v|` is cut to a multiple of 2⁻³⁰ per component; these are summed as
//!   integers, all after that is `f64`, and the child is rounded to `f32`.
//! - **Rescue.** When no node grows so, because pulls cancel, each node with a live `N(v)` grows
//!   towards the nearest point in it (of equally near ones, the least by x, then y, then z), without
//!   tropism; the exceptions above hold.
//! - **Kill.** After the children of an iteration are all there, and once before the first, points
//!   within the kill distance of any node die.
//! - **End.** When no point lives, when no node grows, or at a limit. [`GrowthRule::max_nodes`] can be
//!   reached amid an iteration: its children are then placed in the order of their parents until
//!   there is no more room, points die as always, and growth ends.
//!
//! # Habits
//! What [`GrowthHabit`] adds, also as defined here. A habit that is not used leaves every bit as it is.
//!
//! - **Order.** The first child of a node continues its axis, later ones begin laterals of the next
//!   order; roots begin stems of order 0. Orders stop at 255.
//! - **Direction.** In place of the tropism stands, in `f64`, `tropism + p·light/|light|` with
//!   `g − gravity·l` added to its y: `p` and `g` are the phototropism and gravitropism of the order
//!   that the child will have, `l` is the distance in metres between the node and its root, seen from above.
//! - **Attraction.** With [`Attraction::All`], `S(v)` is the set of all live points within the
//!   influence distance of `v` if `N(v)` is not empty, and empty otherwise. (Were it not for `N(v)`,
//!   every node near a live point would grow, and a branch among three points, which no step brings
//!   nearer to any of them, would go to and fro for ever.)
//! - **Apical control.** A node that has a child waits as long as it is among the topmost share
//!   `apical_control` of its axis, whose tip grows: `rank > (1 − apical_control) · rank of the tip`,
//!   where rank counts internodes from the axis' base, and the tip was placed in the iteration before
//!   (before the first iteration: always). A node that waits is asked again in each iteration, be its
//!   `S(v)` changed or not; when no node grows, all that wait are asked at once, before any rescue.
//!   At 0.5 an axis twice as long as where a lateral leaves it lets it go; at 1 laterals leave when
//!   the axis has its length: an excurrent form. (Apical control, not dominance: of which branches
//!   grow most, not which buds break. Wilson 2000, *Apical control of branch growth and angle in woody
//!   plants*, Am. J. Bot. 87.)
//! - **Children.** A node with `max_children` children grows no more. Its points wait for others.
//! - **Obstacles.** A child is in an obstacle if its place is, or the middle of its internode (so a
//!   wall thinner than half a step may be stepped through). It is then not grown if one of these
//!   obstacles is to be stopped at; otherwise the direction `n` is turned to the first of `n·cos t +
//!   (u·cos a + w·sin a)·sin t` that leads into no obstacle, if any: `t` = 15°, 30° … 90°, and for each
//!   `a` = 0°, ±45°, ±90°, ±135°, 180°, with `u` the unit vector square to `n` on the side of +y (of +x
//!   if `|n.y| > 0.99`) and `w = n × u`. A turned child must still win points of its own to grow on,
//!   so that dead ends are ends.
//! - **Waves.** Point `i` of `n` belongs to wave `⌊i·waves/n⌋`. Only the points of waves that are active
//!   influence, pull or die. The first is active before the first iteration. The next becomes active
//!   before an iteration if no active point lives, if `wave_interval` iterations (if not 0) were made
//!   since the last one, and whenever growth would end for other reasons than a limit. Its points then
//!   have the nearest of all nodes; those within the kill distance die at once.
//!
//! # How it runs
//! Nodes never move and never leave, so a point's nearest node changes only when a new node is
//! nearer. Each iteration therefore sends only the new nodes through a bounding-volume tree over
//! the points (`search`); what they capture is taken out of the old nodes' sums and added to the
//! new ones' (`influence`). A stretch of the tree is one thread's work; threads return what was
//! captured, and integer sums do not mind the order. Each wave has a tree of its own, built when it
//! becomes active; its points see the nodes that are there a few hundred at a time, so that what is noted on
//! the way is bounded. Sums over all points in reach (`surroundings`) are made when a node first has
//! a point of its own; after that a small tree over the points that died since takes pulls out again.
//!
//! # Memory
//! Beside the points that are given: 12 bytes a point while the tree is built, then 22 a point for
//! the tree and 60 a node (24 of which are the result), plus what a list takes while it moves to a
//! place larger by a quarter (twice as large while it is short). In a crown filled at half its points'
//! spacing there are 0.65 nodes a point: about 62 bytes a point; ten million points were grown in 0.72 GB,
//! those points included. Habits that ask for a node's place on its axis take 13 bytes more a node,
//! [`Attraction::All`] 32, and for a while 80 more a node that has points of its own.

mod axes;
mod colony;
mod error;
mod influence;
mod lists;
mod node_set;
mod nodes;
mod obstacle;
mod rule;
pub mod sample;
mod search;
mod settings;
pub mod site;
pub mod stand;
mod stems;
mod surroundings;
mod tree;
pub mod trunk;

use glam::Vec3;

use colony::Colony;
pub use error::{GrowthError, StandError};
use linden_base::memory::OverMemory;
use linden_base::monitor::{Cancelled, Monitor};
use linden_skeleton::{Branching, NO_PARENT};
pub use node_set::NodeSet;
pub use obstacle::{Meet, Obstacle, fan};
pub use rule::{Attraction, GrowthHabit, GrowthRule};
use search::Search;
pub use settings::{GrowthSettings, Origin, UpAxis};
pub use stand::Stand;
use tree::PointTree;

/// No node.
const NONE: u32 = u32::MAX;

/// Coordinates and steps beyond this are refused: their squares would overflow.
const FARTHEST_M: f32 = 1e9;

/// A grown tree, and why growth stopped.
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
    /// Nodes that were of use: each has had points of which it was the nearest node, or was the
    /// nearest to one that died. All others are barren tips.
    pub captured: NodeSet,
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
    /// Points are in reach, but obstacles or [`GrowthHabit::max_children`] keep nodes from growing towards
    /// them.
    Blocked,
    /// [`GrowthRule::max_iterations`] have been made.
    MaxIterations,
    /// [`GrowthRule::max_nodes`] are there.
    MaxNodes,
}

/// Grows nodes from `start` into `points` until every point is used up or a limit is reached.
///
/// The start is a root, with the nodes of a trunk if there is one, or several of these; it is kept
/// as it is, births included. The order of the points matters to waves only. Progress counts the
/// points that are used up.
///
/// ```
/// use linden_growth::{GrowthHabit, GrowthRule, Stop, grow};
/// use glam::Vec3;
/// use linden_base::monitor::Quiet;
/// use linden_skeleton::{Branching, NO_PARENT};
///
/// let root =
///     Branching { positions: vec![Vec3::ZERO], parents: vec![NO_PARENT], births: vec![0], radii: None, edges: None };
/// let rule = GrowthRule {
///     step: 0.1,
///     influence: 2.0,
///     kill: 0.2,
///     tropism: Vec3::ZERO,
///     max_iterations: 1000,
///     max_nodes: 1000,
///     habit: GrowthHabit::PLAIN,
/// };
/// let growth = grow(&[Vec3::new(0.0, 1.0, 0.0)], &root, &rule, &Quiet)?;
/// assert_eq!(growth.stop, Stop::AllReached);
/// assert_eq!(growth.branching.positions.len(), 9);
/// # Ok::<(), linden_growth::GrowthError>(())
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
    grow_among(points, start, rule, &[], monitor)
}

/// [`grow`] where there are obstacles.
///
/// # Errors
/// Those of [`grow`], and if a node of the start is inside an obstacle.
pub fn grow_among(
    points: &[Vec3],
    start: &Branching,
    rule: &GrowthRule,
    obstacles: &[Obstacle],
    monitor: &dyn Monitor,
) -> Result<Growth, GrowthError> {
    grow_with(points, start, rule, obstacles, monitor, Search::new)
}

fn grow_with(
    points: &[Vec3],
    start: &Branching,
    rule: &GrowthRule,
    obstacles: &[Obstacle],
    monitor: &dyn Monitor,
    search: impl Fn(PointTree, f32) -> Search,
) -> Result<Growth, GrowthError> {
    rule.check()?;
    check_start(start, obstacles)?;
    check_points(points, monitor)?;
    admit_points(points.len(), 0, monitor)?;
    let growth = Colony::new(points, start, rule, obstacles, monitor, search).run()?;
    if growth.iterations == 0 && growth.stop == Stop::NothingInReach {
        return Err(out_of_reach(points, start, rule, monitor)?);
    }
    Ok(growth)
}

/// For messages about memory.
const DOING: &str = "growing by space colonization";
const ADVICE: &str = "lower points or max_nodes, or lengthen step";

/// Bytes a point while the tree over the points is built, and those that the first nodes capture at once.
const BUILD_BYTES_PER_POINT: u64 = 80;
/// Bytes a point for the tree and its search.
const BYTES_PER_POINT: u64 = 24;
/// Bytes that a child takes until it is a node.
const BYTES_PER_CHILD: u64 = 40;

/// Asks for what points take before the first node grows, beside `held_bytes`.
///
/// # Errors
/// [`OverMemory`].
pub fn admit_points(points: usize, held_bytes: u64, monitor: &dyn Monitor) -> Result<(), OverMemory> {
    let bytes = (points as u64).saturating_mul(BUILD_BYTES_PER_POINT);
    monitor.admit(DOING, bytes.saturating_add(held_bytes), ADVICE)
}

/// The peak while `children` children become nodes.
fn bytes_at(points: usize, nodes: &nodes::Nodes, children: usize) -> u64 {
    points as u64 * BYTES_PER_POINT
        + nodes.bytes_with(children)
        + nodes.bytes_gathered(points)
        + children as u64 * BYTES_PER_CHILD
}

/// Whether squares of differences cannot overflow. False for NaN.
fn fit(position: Vec3) -> bool {
    position.abs().cmple(Vec3::splat(FARTHEST_M)).all()
}

fn check_start(start: &Branching, obstacles: &[Obstacle]) -> Result<(), GrowthError> {
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
        if obstacles.iter().any(|obstacle| (obstacle.contains)(positions[index].as_dvec3())) {
            return wrong(index, "is inside an obstacle; move the root, or the obstacle");
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
    search.awaken(&start.positions, monitor, |_| ())?;
    let mut nearest2 = f32::INFINITY;
    search.live(monitor, |_, d2, _| nearest2 = nearest2.min(d2))?;
    Ok(GrowthError::NothingInReach { nearest_m: nearest2.sqrt(), influence_m: rule.influence })
}

#[cfg(test)]
mod tests {
    use super::*;
    use linden_base::monitor::Quiet;
    use linden_base::random::Key;

    #[test]
    fn vector_instructions_do_not_change_a_bit() {
        let key = Key::new(5);
        let points: Vec<Vec3> = (0..20_000)
            .map(|i| Vec3::from([0, 1, 2].map(|axis| key.child(i).child(axis).between(-1.0, 1.0) as f32)))
            .collect();
        let root = Branching {
            positions: vec![Vec3::ZERO],
            parents: vec![NO_PARENT],
            births: vec![0],
            radii: None,
            edges: None,
        };
        for influence in [0.4, f32::INFINITY] {
            let rule = GrowthRule {
                step: 0.03,
                influence,
                kill: 0.06,
                tropism: Vec3::new(0.0, 0.2, 0.0),
                max_iterations: 1000,
                max_nodes: 100_000,
                habit: GrowthHabit::PLAIN,
            };
            let grown = |search: fn(PointTree, f32) -> Search| {
                grow_with(&points, &root, &rule, &[], &Quiet, search).unwrap()
            };
            let (detected, portable) = (grown(Search::new), grown(Search::portable));
            assert!(detected.branching.positions.len() > 5000);
            assert_eq!(detected, portable);
        }
    }
}
