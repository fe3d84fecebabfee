//! Real trees: from a laser scan to attraction points, a root and the lengths that growth needs.
//!
//! A scanner sees surfaces. Grown as they are, the points of a thick stem pull up many parallel
//! strands, and the gaps behind branches cut the crown off. [`prepare`] therefore moves points
//! onto axes first, in this order:
//!
//! 1. the spacing of the cloud: the median distance of a point to its nearest neighbour at another place;
//! 2. the foot of the stem, and without it ground and strays (`foot`);
//! 3. thinning: one point, the mean, per cube of the detail's size (twice the spacing, or 1/250 of the
//!    height if that is more);
//! 4. sections along the distance from the foot, bridges over gaps (`contract`), smoothing;
//! 5. points along the links of the sections, so that growth finds its next point within a few steps.
//!
//! Everything is deterministic and takes O(n log n): a million points 1.3 s on two cores.
//!
//! Measured with the suggested lengths on two laser scans of leafy real trees (6 992 points, 10 m high,
//! 5 cm apart, 0.7 m of the stem missing; 15 130 points, 5 m high, 1.4 cm apart): no point unreached, one
//! stem; from a scanned point to the nearest node 0.24 and 0.05 m on average, 0.47 and 0.12 m at the 95th
//! percentile (leaves and bark are off the axis); from a node to the nearest scanned point 0.17 and
//! 0.04 m, 0.33 and 0.09 m. The points as scanned, with the same lengths, left 6 770 and 2 781 unreached,
//! the second with five strands in the stem.

mod contract;
mod foot;
mod neighbours;

use glam::DVec3;
use rayon::prelude::*;

use self::contract::{Graph, Sections};
use self::foot::Foot;
use self::neighbours::Neighbours;
use crate::memory::OverMemory;
use crate::monitor::{Cancelled, Monitor};

/// A scan made ready for growth; lengths in metres, Y up.
#[derive(Clone, Debug, PartialEq)]
pub struct Scan {
    /// Attraction points along the axes.
    pub points: Vec<DVec3>,
    /// The foot of the stem: where growth starts.
    pub root: DVec3,
    /// Suggested length of an internode.
    pub step_m: f64,
    /// Suggested distance within which a point attracts.
    pub influence_m: f64,
    /// Suggested distance at which a point is reached.
    pub kill_m: f64,
    /// What was found on the way.
    pub report: ScanReport,
}

/// What a scan is like.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScanReport {
    /// Median distance to the nearest neighbour at another place.
    pub spacing_m: f64,
    /// Points taken for ground, grass or strays below it.
    pub ground_points: usize,
    /// Thinned points left out because hardly anything is near them.
    pub stray_points: usize,
    /// Gaps that were bridged.
    pub bridges: usize,
    /// The longest of them, 0 without one.
    pub longest_bridge_m: f64,
}

/// Why a scan cannot be grown.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ScanError {
    /// Too few points to see a tree in.
    #[error(
        "the scan has {distinct} points at different places; at least {LEAST_POINTS} are needed to see a tree in it"
    )]
    TooFew {
        /// Points at different places.
        distinct: usize,
    },
    /// No position.
    #[error("point {index} of the scan has no finite position")]
    NotFinite {
        /// Counted from 0.
        index: usize,
    },
    /// It would take more memory than there may be.
    #[error(transparent)]
    Memory(#[from] OverMemory),
    /// Nobody wants it any more.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// Fewer show no stem.
const LEAST_POINTS: usize = 8;

/// Points whose nearest neighbour is looked for, for the median.
const SPACING_SAMPLE: usize = 100_000;

/// The median distance of a point to its nearest neighbour at another place (duplicates do not
/// count as neighbours), over at most 100 000 points taken evenly through the list; `None` for fewer than
/// two places.
pub fn point_spacing_m(points: &[DVec3]) -> Option<f64> {
    let tree = Neighbours::new(points);
    let stride = points.len().div_ceil(SPACING_SAMPLE).max(1);
    let sample: Vec<DVec3> = points.iter().copied().step_by(stride).collect();
    let mut squared: Vec<f64> = sample.par_iter().map(|&p| tree.nearest_other_squared(p)).collect();
    squared.sort_unstable_by(f64::total_cmp);
    squared.get(squared.len() / 2).map(|squared| squared.sqrt()).filter(|spacing| spacing.is_finite())
}

/// The foot of the stem: where a tree among these points stands. `None` without points.
pub fn foot(points: &[DVec3]) -> Option<DVec3> {
    (!points.is_empty()).then(|| Foot::find(points).root)
}

/// Makes a scan ready for growth. `points` are metres, Y up, near the origin; `step_m` is the length of
/// an internode if the user chose one.
///
/// # Errors
/// [`ScanError`]: too few points, positions that are not finite, cancelled.
pub fn prepare(points: &[DVec3], step_m: Option<f64>, monitor: &dyn Monitor) -> Result<Scan, ScanError> {
    let bytes = points.len() as u64 * BYTES_PER_POINT;
    monitor.admit("preparing the scan", bytes, "thin the points out")?;
    if let Some(index) = points.iter().position(|p| !p.is_finite()) {
        return Err(ScanError::NotFinite { index });
    }
    monitor.check()?;
    let spacing_m = point_spacing_m(points).ok_or(ScanError::TooFew { distinct: points.len().min(1) })?;
    monitor.check()?;
    let foot = Foot::find(points);
    let tree: Vec<DVec3> = points.iter().copied().filter(|&p| !foot.is_ground(p)).collect();
    let ground_points = points.len() - tree.len();
    let chosen_m = step_m.filter(|step| step.is_finite() && *step > 0.0);
    let detail_m = chosen_m.unwrap_or_else(|| (2.0 * spacing_m).max(foot.height_m / 250.0));
    monitor.check()?;
    let thinned = thin(&tree, detail_m);
    if thinned.len() < LEAST_POINTS {
        return Err(ScanError::TooFew { distinct: thinned.len() });
    }
    let graph = Graph::new(thinned, REACH * detail_m, monitor)?;
    // All around the stem, so that sections lie across it from the start.
    let nearest = graph
        .points
        .iter()
        .copied()
        .min_by(|a, b| a.distance_squared(foot.root).total_cmp(&b.distance_squared(foot.root)));
    let start = |p: DVec3| {
        let up = (p.y - foot.root.y).max(0.0);
        let away = DVec3::new(p.x - foot.root.x, 0.0, p.z - foot.root.z).length();
        let is_foot = away <= foot.radius_m && up <= foot.ground_m;
        (is_foot || Some(p) == nearest).then_some(up)
    };
    let ways = graph.ways(start);
    let bridges_m = graph.bridges_m(&ways);
    let mut sections = Sections::new(&graph, &ways, foot.root, SECTION * detail_m);
    sections.smooth(SMOOTHING);
    let points = sections.points(detail_m);
    Ok(Scan {
        points,
        root: foot.root,
        step_m: detail_m,
        influence_m: INFLUENCE * detail_m,
        kill_m: KILL * detail_m,
        report: ScanReport {
            spacing_m,
            ground_points,
            stray_points: graph.strays,
            bridges: bridges_m.len(),
            longest_bridge_m: bridges_m.iter().copied().fold(0.0, f64::max),
        },
    })
}

/// The peak with the points given: the tree for their spacing while it is built (measured).
const BYTES_PER_POINT: u64 = 96;

/// Links reach this many details far.
const REACH: f64 = 3.0;

/// Sections are this many details long.
const SECTION: f64 = 3.0;

/// Rounds of smoothing the sections' centres.
const SMOOTHING: usize = 6;

/// The suggested influence distance, in steps.
const INFLUENCE: f64 = 6.0;

/// The suggested kill distance, in steps.
const KILL: f64 = 2.0;

/// The mean of the points in each cube of a grid, in the grid's order.
fn thin(points: &[DVec3], cube_m: f64) -> Vec<DVec3> {
    let low = points.iter().copied().fold(DVec3::INFINITY, DVec3::min);
    let cube = |p: DVec3| ((p - low) / cube_m).to_array().map(|x| x as u32);
    let mut order: Vec<([u32; 3], u32)> = points.iter().map(|&p| cube(p)).zip(0..).collect();
    order.par_sort_unstable();
    let mean = |same: &[([u32; 3], u32)]| {
        same.iter().map(|&(_, i)| points[i as usize]).sum::<DVec3>() / same.len() as f64
    };
    order.chunk_by(|a, b| a.0 == b.0).map(mean).collect()
}
