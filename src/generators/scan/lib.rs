//! Real trees: from a laser scan to attraction points, a root and the lengths that growth needs.
//!
//! A scanner sees surfaces. Grown as they are, the points of a thick stem pull up many parallel
//! strands, and the gaps behind branches cut the crown off. [`prepare`] therefore moves points
//! onto axes first, in this order:
//!
//! 1. without rows that are no points of it (`clean`): places that stand there twice, `0 0 0`, single far
//!    points; then the spacing of the cloud: the median distance of a point to its nearest neighbour;
//! 2. the feet of the stems (`foot`, `stems`), and without them ground and strays;
//! 3. the trunk: circles through slices of its bark, from the foot up; their centres are its axis (`trunk`);
//! 4. thinning: one point, the mean, per cube of the detail's size (twice the spacing, or 1/1000 of the
//!    height if that is more), and without noise: cubes that hardly any points are near;
//! 5. wood and leaves told apart, where that is asked for or known (`leaves`): leaves are no bark, and ways keep to wood;
//! 6. ways from the feet (`graph`), bridges over gaps (`bridges`), sections along the ways (`sections`), smoothing;
//! 7. points along the links of the sections, so that growth finds its next point within a few steps.
//!
//! What the cloud says of its units and its upward axis stands in `frame`. After growth radii are measured
//! on the points (`girth`), and [`gaps`] says how far skeleton and points are apart.
//!
//! Everything is deterministic and takes O(n log n).
//!
//! Measured on scans of two trees that linden grew, points on their bark 12 mm apart, as parts of what there
//! was (`tests/inputs/scan_back.rs` holds the figures within bounds; "leaves" are 4 discs at each tip, "all"
//! is leaves seen by three sensors through gaps; the last column is the mean distance from a point to the
//! surface, and what 95 % do not exceed):
//!
//! | tree, scan | length | order 1 | limbs | breast diameter | volume | surface, mm |
//! |---|---|---|---|---|---|---|
//! | broad, 3 mm error | 0.99 | 0.93 | 13 of 13 | 0.98 | 0.99 | 6, 19 |
//! | broad, 10 mm | 1.04 | 1.06 | 13 | 0.97 | 0.96 | 14, 41 |
//! | broad, gaps | 0.95 | 1.01 | 13 | 0.96 | 0.97 | 6, 19 |
//! | broad, three sensors | 1.03 | 0.94 | 12 | 0.98 | 0.99 | 7, 27 |
//! | broad, leaves | 1.33 | 0.98 | 13 | 0.98 | 0.99 | 6, 24 |
//! | broad, all | 1.28 | 1.00 | 13 | 0.96 | 0.94 | 10, 38 |
//! | tall, 3 mm | 0.99 | 0.95 | 15 of 16 | 0.97 | 0.99 | 6, 19 |
//! | tall, 10 mm | 1.07 | 1.11 | 16 | 0.97 | 0.96 | 15, 47 |
//! | tall, gaps | 0.96 | 0.92 | 15 | 0.96 | 0.98 | 6, 19 |
//! | tall, three sensors | 1.02 | 0.95 | 14 | 0.97 | 1.00 | 7, 22 |
//!
//! Clumps of twigs that hide each other lose a part of their length.

mod allometry;
mod bridges;
mod canopy;
mod cells;
mod circle;
mod clean;
mod cloth;
mod crowns;
mod cubes;
mod cylinder;
mod error;
mod fit;
mod foot;
mod frame;
mod generator;
mod girth;
mod graph;
mod ground;
mod leaves;
mod links;
mod looks;
mod median;
mod neighbours;
mod oval;
mod plane;
pub mod plot;
mod points;
mod profile;
mod publications;
mod sample;
mod sections;
mod segments;
mod settings;
mod starts;
mod stems;
mod stretch;
mod surface;
mod taper;
mod trees;
mod trunk;
mod z_order;

use glam::DVec3;
use rayon::prelude::*;

use self::cells::Near;
use self::cubes::{Cubes, thin};
use self::foot::Foot;
use self::graph::Graph;
use self::links::{LinkedTo, links_within, without};
use self::neighbours::Neighbours;
use self::sections::Sections;
use self::starts::Starts;
use self::trunk::Trunk;
use linden_base::memory::OverMemory;
use linden_base::monitor::{Cancelled, Monitor};

pub use clean::{Distinct, distinct, drop_far};
pub use error::ScanGrowthError;
pub use fit::gaps;
pub use fit::share_near;
pub use frame::shows_stem;
pub use frame::{UpGuess, guess_up, likely_scale};
pub use generator::GENERATOR;
pub use girth::{Girth, girth};
pub use settings::{LeafPoints, ScanRadius, ScanSettings, Segmentation};

/// A scan made ready for growth; lengths in metres, Y up.
#[derive(Clone, Debug, PartialEq)]
pub struct Scan {
    /// Attraction points along the axes.
    pub points: Vec<DVec3>,
    /// The scanned points without ground, strays and leaves: what the wood was seen by.
    pub bark: Vec<DVec3>,
    /// The feet of the stems, the thickest first: where growth starts.
    pub roots: Vec<DVec3>,
    /// Suggested length of an internode.
    pub step_m: f64,
    /// Suggested distance within which a point attracts.
    pub influence_m: f64,
    /// Suggested distance at which a point is reached.
    pub kill_m: f64,
    /// Findings about the scan.
    pub report: ScanReport,
}

/// Findings about a scan: spacing, noise, ground, what was left out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScanReport {
    /// Rows whose place stood there before.
    pub repeated_points: usize,
    /// Rows `0 0 0`, which scanners write where no pulse came back.
    pub no_returns: usize,
    /// Single points far from everything.
    pub far_points: usize,
    /// Median distance to the nearest neighbour.
    pub spacing_m: f64,
    /// Points taken for ground, grass or strays below it.
    pub ground_points: usize,
    /// Points that the noise filter dropped: hardly any others are near them.
    pub noise_points: usize,
    /// Thinned points left out because hardly anything is near them.
    pub stray_points: usize,
    /// Points that were told to lie on leaves.
    pub leaf_points: usize,
    /// Gaps that were bridged.
    pub bridges: usize,
    /// The longest of them, 0 without one.
    pub longest_bridge_m: f64,
    /// How much of the first stem, from the ground up, shows no circles; `None` where the ground is not known, or no circle.
    pub unseen_stem_m: Option<f64>,
}

/// Why a scan cannot be grown.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ScanError {
    /// Too few points to see a tree in.
    #[error("the scan has only {}; at least {LEAST_POINTS} are needed to see a tree in it", few(*.distinct))]
    TooFew {
        /// Points at different places, and that are clear of each other if these are enough.
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

fn few(points: usize) -> String {
    match points {
        1 => "1 point".to_owned(),
        points => format!("{points} points that are clear of each other"),
    }
}

/// Points whose nearest neighbour is looked for, for the median.
const SPACING_SAMPLE: usize = 25_000;

/// The median distance of a point to its nearest neighbour at another place, over at most 25 000 points
/// taken evenly through the places; `None` for fewer than two.
///
/// # Errors
/// [`ScanError`]: memory, cancelled.
pub fn point_spacing_m(points: &[DVec3], monitor: &dyn Monitor) -> Result<Option<f64>, ScanError> {
    Ok(spacing_m(&distinct(points, false, monitor)?.points, monitor)?)
}

/// The same, of points that are all at different places.
fn spacing_m(points: &[DVec3], monitor: &dyn Monitor) -> Result<Option<f64>, Cancelled> {
    let tree = Neighbours::new(points, monitor)?;
    let stride = points.len().div_ceil(SPACING_SAMPLE).max(1);
    let sample: Vec<DVec3> = points.iter().copied().step_by(stride).collect();
    let nearest = |&p: &DVec3| monitor.check().map(|()| tree.nearest_other_squared(p));
    let mut squared: Vec<f64> = sample.par_iter().map(nearest).collect::<Result<_, Cancelled>>()?;
    squared.sort_unstable_by(f64::total_cmp);
    let median = squared.get(squared.len() / 2).map(|squared| squared.sqrt());
    Ok(median.filter(|spacing| spacing.is_finite()))
}

/// The foot of the stem: where a tree among these points stands. `None` without points.
pub fn foot(points: &[DVec3]) -> Option<DVec3> {
    (!points.is_empty()).then(|| Foot::find(points).root)
}

/// Details in the height of a tree, at most: finer ones cost time and show no more wood.
const DETAILS_PER_HEIGHT: f64 = 1000.0;

/// The length of an internode that a scan of a tree `height_m` high shows, metres.
pub fn detail_m(spacing_m: f64, height_m: f64) -> f64 {
    (2.0 * spacing_m).max(height_m / DETAILS_PER_HEIGHT)
}

/// How a scan is made ready.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScanRule {
    /// Length of an internode if the user chose one, metres.
    pub step_m: Option<f64>,
    /// Whether points that hardly any others are near are left out.
    pub noise_filter: bool,
    /// How many stems there are; `None` leaves it to the cloud.
    pub stems: Option<usize>,
    /// Which points lie on leaves.
    pub leaf_points: LeafPoints,
}

impl Default for ScanRule {
    fn default() -> Self {
        Self { step_m: None, noise_filter: true, stems: None, leaf_points: LeafPoints::Auto }
    }
}

/// Makes a scan ready for growth. `points` are metres, Y up, near the origin; rows that are no points of the
/// tree are left out ([`distinct`], [`drop_far`]).
///
/// # Errors
/// [`ScanError`]: too few points, positions that are not finite, cancelled.
pub fn prepare(points: &[DVec3], rule: &ScanRule, monitor: &dyn Monitor) -> Result<Scan, ScanError> {
    if let Some(index) = points.iter().position(|p| !p.is_finite()) {
        return Err(ScanError::NotFinite { index });
    }
    let Distinct { mut points, repeated, no_returns } = distinct(points, true, monitor)?;
    let far_points = drop_far(&mut points, monitor)?;
    let mut scan = prepare_distinct(&points, None, &[], rule, monitor)?;
    scan.report = ScanReport { repeated_points: repeated, no_returns, far_points, ..scan.report };
    Ok(scan)
}

/// The same of finite points that are all at different places, and of which it may be known whether each lies on a leaf.
/// `ground` are points of the ground that are known as such and not among them: the tree stands on it.
///
/// # Errors
/// [`ScanError`].
pub fn prepare_distinct(
    points: &[DVec3],
    is_leaf: Option<&[bool]>,
    ground: &[DVec3],
    rule: &ScanRule,
    monitor: &dyn Monitor,
) -> Result<Scan, ScanError> {
    let bytes = points.len() as u64 * BYTES_PER_POINT;
    monitor.admit("preparing the scan", bytes, "thin the points out")?;
    let spacing_m = spacing_m(points, monitor)?.ok_or(ScanError::TooFew { distinct: points.len() })?;
    monitor.check()?;
    let feet = stems::feet(points, rule.stems, monitor)?;
    let mut feet: Vec<Foot> = feet.into_iter().map(|foot| foot.on_ground(ground)).collect();
    let foot = &feet[0];
    let mut bark: Vec<DVec3> = points.iter().copied().filter(|&p| !is_ground(&feet, p)).collect();
    let ground_points = points.len() - bark.len();
    let mut is_leaf: Option<Vec<bool>> = is_leaf.map(|is_leaf| {
        let rows = points.iter().zip(is_leaf);
        rows.filter(|(p, _)| !is_ground(&feet, **p)).map(|(_, leaf)| *leaf).collect()
    });
    let chosen_m = rule.step_m.filter(|step| step.is_finite() && *step > 0.0);
    let detail_m = chosen_m.unwrap_or_else(|| detail_m(spacing_m, foot.height_m));
    monitor.check()?;
    let mut cubes = Cubes::new(&bark, detail_m);
    // Neighbours in space are neighbours in memory from here on.
    cubes.order(&mut bark, is_leaf.as_mut());
    let (nearest, noise_points) =
        without_noise(&mut cubes, &mut bark, is_leaf.as_mut(), (rule.noise_filter, detail_m), monitor)?;
    if cubes.means.len() < LEAST_POINTS {
        let clear = if points.len() < LEAST_POINTS { points.len() } else { cubes.means.len() };
        return Err(ScanError::TooFew { distinct: clear });
    }
    let thinned = cubes.means.clone();
    // Which points are in which cube takes memory, and is for leaves alone.
    let cubes = rule.leaf_points.are_told(is_leaf.is_some()).then_some(cubes);
    let trunks = standing(&mut feet, &bark, ground, spacing_m, monitor)?;
    let foot = &feet[0];
    let graph = Graph::linked(thinned, nearest, REACH * detail_m, monitor)?;
    let starts = Starts::new(&feet, &trunks, &graph.points);
    let start = |p: DVec3| starts.along_m(p);
    let mut ways = graph.ways(start, &[], monitor)?;
    let scanned = bark.len();
    let mut leaf_nodes = Vec::new();
    if let Some(cubes) = cubes {
        match is_leaf.filter(|_| rule.leaf_points == LeafPoints::Auto) {
            Some(is_leaf) => {
                leaf_nodes = cubes.most(&graph.points, &is_leaf);
                retain_unmarked(&mut bark, &is_leaf);
            }
            None => {
                leaf_nodes = leaves::told(&graph, &ways, foot, &trunks, detail_m, monitor)?;
                cubes.keep_wood(&mut bark, &graph.points, &leaf_nodes);
            }
        }
        ways = graph.ways(start, &leaf_nodes, monitor)?;
    }
    let leaf_points = scanned - bark.len();
    let bridges_m = graph.bridges_m(&ways);
    let foot_of = |foot: &Foot| {
        let trunk = trunks.iter().find(|(root, _)| *root == foot.root);
        trunk.map_or(foot.root, |(_, trunk)| trunk.foot())
    };
    let roots: Vec<DVec3> = feet.iter().map(foot_of).collect();
    let thickest_first = by_thickness(&roots, &feet, &trunks);
    let is_first = |trunk: &&(DVec3, Trunk)| Some(&trunk.1.foot()) == thickest_first.first();
    let unseen_stem_m =
        trunks.iter().find(is_first).filter(|_| foot.is_on_ground).map(|(_, trunk)| trunk.unseen_m());
    let trunks: Vec<Trunk> = trunks.into_iter().map(|(_, trunk)| trunk).collect();
    let radii_m = leaves::radii_m(&ways, foot, trunks.iter().map(Trunk::radius_m), monitor)?;
    let mut sections =
        Sections::new(&graph, (&ways, &radii_m), (&roots, &trunks), &leaf_nodes, SECTION * detail_m);
    sections.smooth(SMOOTHING);
    let points = sections.points(detail_m);
    Ok(Scan {
        points,
        bark,
        roots: thickest_first,
        step_m: detail_m,
        influence_m: INFLUENCE * detail_m,
        kill_m: KILL * detail_m,
        report: ScanReport {
            repeated_points: 0,
            no_returns: 0,
            far_points: 0,
            spacing_m,
            ground_points,
            noise_points,
            stray_points: graph.strays,
            leaf_points,
            bridges: bridges_m.len(),
            longest_bridge_m: bridges_m.iter().copied().fold(0.0, f64::max),
            unseen_stem_m,
        },
    })
}

/// By so much the ground below a trunk is higher or lower than below what was seen of its foot first, metres, where that counts.
const MOVED_M: f64 = 0.01;

/// The trunks that stand on feet, and the feet below them: on a slope the lowest points of a stem are on one side of it.
fn standing(
    feet: &mut [Foot],
    bark: &[DVec3],
    ground: &[DVec3],
    spacing_m: f64,
    monitor: &dyn Monitor,
) -> Result<Vec<(DVec3, Trunk)>, Cancelled> {
    let mut trunks = Vec::new();
    for foot in feet {
        let Some(mut trunk) = Trunk::follow(bark, foot, spacing_m, monitor)? else { continue };
        let below = foot.moved_below(trunk.foot()).on_ground(ground);
        if (below.root.y - foot.root.y).abs() > MOVED_M
            && let Some(again) = Trunk::follow(bark, &below, spacing_m, monitor)?
        {
            (*foot, trunk) = (below, again);
        }
        trunks.push((foot.root, trunk));
    }
    Ok(trunks)
}

/// The roots of these feet, that of the thickest trunk first: it is the one whose diameter is told, and stands on the origin.
fn by_thickness(roots: &[DVec3], feet: &[Foot], trunks: &[(DVec3, Trunk)]) -> Vec<DVec3> {
    let radius_m = |foot: &Foot| {
        let trunk = trunks.iter().find(|(root, _)| *root == foot.root);
        trunk.map_or(0.0, |(_, trunk)| trunk.radius_m())
    };
    let mut found: Vec<(f64, DVec3)> = feet.iter().map(radius_m).zip(roots.iter().copied()).collect();
    found.sort_by(|a, b| b.0.total_cmp(&a.0));
    found.into_iter().map(|(_, root)| root).collect()
}

/// The peak with the points given: the tree for their spacing while it is built (measured).
const BYTES_PER_POINT: u64 = 96;

/// The nearest cubes of each cube within the reach of links, after cubes that hardly any points are near, and their points, were taken
/// out if `filters` says so; how many points these were.
fn without_noise(
    cubes: &mut Cubes,
    bark: &mut Vec<DVec3>,
    is_leaf: Option<&mut Vec<bool>>,
    (filters, detail_m): (bool, f64),
    monitor: &dyn Monitor,
) -> Result<(Vec<LinkedTo>, usize), Cancelled> {
    let squared_m = (NOISE_REACH * detail_m * NOISE_REACH * detail_m) as f32;
    let count = |near: &[Near]| {
        let near = near.iter().filter(|near| near.squared_m() < squared_m);
        near.map(|near| cubes.count(near.index() as usize)).sum()
    };
    let (nearest, near) = links_within(&cubes.means, REACH * detail_m, count, monitor)?;
    let Some(is_noise) = cubes.noise(&near).filter(|_| filters) else { return Ok((nearest, 0)) };
    let before = bark.len();
    cubes.drop_marked(&is_noise, bark, is_leaf);
    Ok((without(nearest, &is_noise), before - bark.len()))
}

/// Whether a point belongs to the ground by all feet.
fn is_ground(feet: &[Foot], p: DVec3) -> bool {
    feet.iter().all(|foot| foot.is_ground(p))
}

/// Takes out what is marked; what has no mark stays.
fn retain_unmarked<T>(list: &mut Vec<T>, marks: &[bool]) {
    let mut marks = marks.iter();
    list.retain(|_| !marks.next().is_some_and(|&marked| marked));
}

/// Within this many details the noise filter counts points: no farther than links reach.
const NOISE_REACH: f64 = 2.5;

/// Links reach this many details far.
const REACH: f64 = 3.0;

/// Sections are this many details long.
const SECTION: f64 = 3.0;

/// Rounds of smoothing the sections' centres.
const SMOOTHING: usize = 6;

/// The suggested influence distance, in steps.
const INFLUENCE: f64 = 6.0;

/// The suggested kill distance, in steps: twigs end that far short of their last point.
const KILL: f64 = 1.01;

#[cfg(test)]
mod tests {
    use linden_base::monitor::Quiet;

    use super::*;

    /// A stem and a pole, of which either is more thickly scanned.
    #[test]
    fn the_thickest_stem_is_the_first_root() {
        let around = |x: f64, radius_m: f64, count: u32| {
            (0..count).map(move |i| {
                let (sin, cos) = libm::sincos(f64::from(i) * 2.4);
                DVec3::new(x + radius_m * cos, 6.0 * f64::from(i) / f64::from(count), radius_m * sin)
            })
        };
        for (x, counts) in
            [(0.0, [9000, 3000]), (0.0, [3000, 9000]), (2.0, [9000, 3000]), (2.0, [3000, 9000])]
        {
            let stems = around(x, 0.15, counts[0]).chain(around(2.0 - x, 0.06, counts[1]));
            let scan = prepare(&stems.collect::<Vec<_>>(), &ScanRule::default(), &Quiet).unwrap();
            let off_m: Vec<f64> = scan.roots.iter().map(|root| (root.x - x).abs()).collect();
            assert!(off_m.len() == 2 && off_m[0] < 0.1 && off_m[1] > 1.8, "{x}, {counts:?}: {off_m:?}");
        }
    }
}
