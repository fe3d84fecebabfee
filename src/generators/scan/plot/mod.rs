//! The trees of a plot that nobody has told apart: stems are found, and every point goes to the one from which the way to
//! it is the shortest.
//!
//! 1. The ground is found (`cloth`).
//! 2. So are stems (`boles`): circles on slices near breast height that go on above and below.
//! 3. Points are thinned and linked as in a scan of one tree; ways lead from all boles at once (Dijkstra 1959). A link counts
//!    by the square of its length, what turns aside counts more than what goes straight on as branches do, and a metre counts
//!    less in thick trees (as in Tao, Wu, Guo, Wang, Li, Xue, Hu, Li, Tian, Li & Fang 2015, *Segmenting tree crowns from
//!    terrestrial and mobile lidar data by exploring ecological theories*, ISPRS Journal of Photogrammetry and Remote
//!    Sensing 110).
//! 4. What is too low for a tree is none. Trees are numbered by their heights, the tallest is 1.

mod boles;

use glam::DVec3;
use linden_base::input::{TreeColumn, Up};
use linden_base::monitor::Monitor;
use rayon::prelude::*;

use self::boles::Bole;
use crate::cloth::Cloth;
use crate::cubes::Cubes;
use crate::graph::{Cost, Graph, Start};
use crate::{ScanError, likely_scale, spacing_m};

/// How the points of a plot are to be taken.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlotRule {
    /// The axis that points up in the file.
    pub up: Up,
    /// Metres for a unit of the file; `None`: the likely one.
    pub scale: Option<f64>,
}

/// The column's name: what was asked for.
const COLUMN: &str = "segmentation=paths";

/// What is lower is no tree, metres.
const LEAST_TREE_M: f64 = 2.0;

/// Below this height above the ground grass is not told from trees: only what is near a stem is part of it, metres.
const LOW_M: f64 = 0.3;

/// How far from a stem's bark its foot reaches there, in radii, and metres more.
const FOOT_RADII: f64 = 1.6;
const FOOT_M: f64 = 0.1;

/// Sides of the cubes that points are thinned to, metres, at least;
const CUBE_M: f64 = 0.05;

/// and times the distance between points;
const CUBE_SPACINGS: f64 = 2.0;

/// as many at most, or cubes are larger.
const MOST_CUBES: usize = 3_000_000;

/// Links reach so many cubes far.
const REACH: f64 = 3.0;

/// A metre across the way that a branch has come counts for so many more than one ahead: where crowns touch, branches go
/// straight on. Without it hardly half of the points of crowns that grow into each other are told apart, with it four in
/// five.
const TURN: f64 = 20.0;

/// A metre costs by the diameter of the stem to this power: large trees have large crowns. (Tao et al. take -2/3; chosen by
/// plots for tuning, where it makes a small difference.)
const THICKNESS_POWER: f64 = -1.0 / 3.0;

/// What is farther from everything than this is of no tree, metres.
const MOST_GAP_M: f64 = 1.5;

/// While trees are told apart, for each point: its place in metres, its height, its cube and its number.
const BYTES_PER_POINT: u64 = 64;

/// And for each cube above the ground: its links, their order, and its ways (measured).
const BYTES_PER_CUBE: u64 = 360;

/// The number of the tree that each point belongs to, 0 for none; `positions` are the file's.
///
/// # Errors
/// [`ScanError`]: too few points, positions that are not finite, memory, cancelled.
pub fn tell_apart(
    positions: &[DVec3],
    rule: &PlotRule,
    monitor: &dyn Monitor,
) -> Result<TreeColumn, ScanError> {
    let bytes = positions.len() as u64 * BYTES_PER_POINT;
    monitor.admit("telling trees apart", bytes, "thin the points out")?;
    let mut numbers = vec![0; positions.len()];
    if let Some(index) = positions.iter().position(|p| !p.is_finite()) {
        return Err(ScanError::NotFinite { index });
    }
    let mut points = positions.to_vec();
    rule.up.to_y_up(&mut points);
    let scale = rule.scale.unwrap_or_else(|| likely_scale(&points));
    for p in &mut points {
        *p *= scale;
    }
    let spacing_m = spacing_m(&points, monitor)?.ok_or(ScanError::TooFew { distinct: points.len() })?;
    let ground = Cloth::under(&points, monitor)?;
    let heights_m: Vec<f32> = points.par_iter().map(|p| (p.y - ground.height_m(*p)) as f32).collect();
    monitor.check()?;
    let boles = boles::find(&points, &heights_m, spacing_m, monitor)?;
    let (cubes, cube_m) = thinned(&points, spacing_m);
    let near = BoleIndex::new(&boles, cube_m);
    let of_cubes = of_cubes(&cubes, cube_m, &near, &ground, monitor)?;
    // From cubes to their points; what is low belongs to the stem that it is at.
    let mut first = 0;
    for (&end, &bole) in cubes.ends.iter().zip(&of_cubes) {
        for &point in &cubes.members[first as usize..end as usize] {
            let is_low = f64::from(heights_m[point as usize]) < LOW_M;
            let bole = if is_low { near.foot_at(points[point as usize]) } else { bole };
            numbers[point as usize] = bole.map_or(0, |bole| bole + 1);
        }
        first = end;
    }
    let tops_m = tops(&numbers, &heights_m, boles.len());
    let mut order: Vec<usize> =
        (0..boles.len()).filter(|&bole| tops_m[bole] >= LEAST_TREE_M as f32).collect();
    order.sort_by(|&a, &b| tops_m[b].total_cmp(&tops_m[a]).then(a.cmp(&b)));
    let mut renamed = vec![0; boles.len() + 1];
    for (number, bole) in (1..).zip(order) {
        renamed[bole + 1] = number;
    }
    for number in &mut numbers {
        *number = renamed[*number as usize];
    }
    Ok(TreeColumn { name: COLUMN.to_owned(), numbers })
}

/// How many stems stand on the ground below these points (metres, Y up), and how far apart the two are that are farthest.
///
/// # Errors
/// [`ScanError`]: memory, cancelled.
pub(crate) fn stems_of(points: &[DVec3], monitor: &dyn Monitor) -> Result<(usize, f64), ScanError> {
    let bytes = points.len() as u64 * BYTES_PER_POINT;
    monitor.admit("looking for stems", bytes, "thin the points out")?;
    let Some(spacing_m) = spacing_m(points, monitor)? else { return Ok((0, 0.0)) };
    let ground = Cloth::under(points, monitor)?;
    let heights_m: Vec<f32> = points.par_iter().map(|p| (p.y - ground.height_m(*p)) as f32).collect();
    let boles = boles::find(points, &heights_m, spacing_m, monitor)?;
    let away = |a: &Bole, b: &Bole| libm::hypot(a.centre.0 - b.centre.0, a.centre.1 - b.centre.1);
    let apart_m = boles.iter().flat_map(|a| boles.iter().map(move |b| away(a, b))).fold(0.0, f64::max);
    Ok((boles.len(), apart_m))
}

/// The cubes of all points, and their side.
fn thinned(points: &[DVec3], spacing_m: f64) -> (Cubes, f64) {
    let mut cube_m = CUBE_M.max(CUBE_SPACINGS * spacing_m);
    loop {
        let cubes = Cubes::new(points, cube_m);
        if cubes.means.len() <= MOST_CUBES {
            return (cubes, cube_m);
        }
        // They cover surfaces, about.
        cube_m *= (cubes.means.len() as f64 / MOST_CUBES as f64).sqrt().max(1.05);
    }
}

/// The bole that each cube is nearest to on its way.
fn of_cubes(
    cubes: &Cubes,
    cube_m: f64,
    near: &BoleIndex<'_>,
    ground: &Cloth,
    monitor: &dyn Monitor,
) -> Result<Vec<Option<u32>>, ScanError> {
    let mut of_cubes = vec![None; cubes.means.len()];
    let height_m = |p: DVec3| p.y - ground.height_m(p);
    let high: Vec<u32> =
        (0..).zip(&cubes.means).filter(|(_, p)| height_m(**p) >= LOW_M).map(|(cube, _)| cube).collect();
    let places = high.iter().map(|&cube| cubes.means[cube as usize]).collect();
    if near.boles.is_empty() {
        return Ok(of_cubes);
    }
    let bytes = cubes.members.len() as u64 * BYTES_PER_POINT + high.len() as u64 * BYTES_PER_CUBE;
    monitor.admit("telling trees apart", bytes, "thin the points out")?;
    let graph = Graph::new(places, REACH * cube_m, monitor)?;
    let start = |p: DVec3| {
        let height_m = height_m(p);
        let at_slice = |&(_, bole): &(u32, &Bole)| (bole.slice_m[0]..bole.slice_m[1]).contains(&height_m);
        let off_m = |bole: &Bole| bole.off_m(p) - bole.reach_m;
        let all = near.at(p).filter(at_slice);
        let (group, bole) = all.min_by(|a, b| off_m(a.1).total_cmp(&off_m(b.1)))?;
        (off_m(bole) <= cube_m).then_some(Start { length: height_m, group })
    };
    let per_metre: Vec<f64> =
        near.boles.iter().map(|bole| libm::pow(2.0 * bole.radius_m, THICKNESS_POWER)).collect();
    let cost = Cost { per_metre: &per_metre, linear_m: cube_m, turn: TURN, leaves: &[] };
    let ways = graph.ways_of(start, &cost, monitor)?;
    let gaps_m = ways.widest_gaps_m(&graph);
    // Strays are no part of the graph; the others are in the same order.
    let mut cubes_left = high.iter();
    for (node, p) in graph.points.iter().enumerate() {
        let Some(&cube) = cubes_left.find(|&&cube| cubes.means[cube as usize] == *p) else { break };
        let is_near = ways.length[node].is_finite() && gaps_m[node] <= MOST_GAP_M;
        of_cubes[cube as usize] = is_near.then(|| ways.group[node]);
    }
    Ok(of_cubes)
}

/// Boles by the squares of ground that they are near to.
struct BoleIndex<'a> {
    boles: &'a [Bole],
    /// Square and bole, sorted.
    of_squares: Vec<([i32; 2], u32)>,
}

impl<'a> BoleIndex<'a> {
    const SQUARE_M: f64 = 1.0;

    /// Boles are near to what is `beyond_m` from their feet.
    fn new(boles: &'a [Bole], beyond_m: f64) -> Self {
        let mut of_squares = Vec::new();
        for (number, bole) in (0..).zip(boles) {
            let reach_m = FOOT_RADII * bole.reach_m + FOOT_M + beyond_m;
            let [low, high] =
                [-reach_m, reach_m].map(|off| Self::square(bole.centre.0 + off, bole.centre.1 + off));
            for x in low[0]..=high[0] {
                of_squares.extend((low[1]..=high[1]).map(|z| ([x, z], number)));
            }
        }
        of_squares.sort_unstable();
        Self { boles, of_squares }
    }

    fn square(x: f64, z: f64) -> [i32; 2] {
        [x, z].map(|x| libm::floor(x / Self::SQUARE_M) as i32)
    }

    fn at(&self, p: DVec3) -> impl Iterator<Item = (u32, &'a Bole)> {
        let square = Self::square(p.x, p.z);
        let start = self.of_squares.partition_point(|(at, _)| *at < square);
        let here = self.of_squares[start..].iter().take_while(move |(at, _)| *at == square);
        here.map(|(_, bole)| (*bole, &self.boles[*bole as usize]))
    }

    /// The bole at whose foot a place near the ground is.
    fn foot_at(&self, p: DVec3) -> Option<u32> {
        let off_m = |bole: &Bole| bole.off_m(p) - FOOT_RADII * bole.reach_m - FOOT_M;
        let (number, bole) = self.at(p).min_by(|a, b| off_m(a.1).total_cmp(&off_m(b.1)))?;
        (off_m(bole) <= 0.0).then_some(number)
    }
}

/// How high the points of each bole reach, but for one in a thousand.
fn tops(numbers: &[u32], heights_m: &[f32], boles: usize) -> Vec<f32> {
    let mut of_boles: Vec<Vec<f32>> = vec![Vec::new(); boles];
    for (&number, &height) in numbers.iter().zip(heights_m) {
        if let Some(heights) = (number as usize).checked_sub(1).and_then(|bole| of_boles.get_mut(bole)) {
            heights.push(height);
        }
    }
    let top = |mut heights: Vec<f32>| {
        let at = heights.len().saturating_sub(1 + heights.len() / 1000);
        if heights.is_empty() { 0.0 } else { *heights.select_nth_unstable_by(at, f32::total_cmp).1 }
    };
    of_boles.into_iter().map(top).collect()
}

#[cfg(test)]
mod tests {
    use linden_base::monitor::Quiet;
    use linden_base::random::Key;

    use super::*;

    /// A trunk with a crown of spokes, as points on bark.
    fn tree(at: [f64; 2], height_m: f64, radius_m: f64, crown_m: f64, key: Key) -> Vec<DVec3> {
        let mut points = Vec::new();
        let mut on_bark = |key: Key, from: DVec3, along: DVec3, radius_m: f64, count: u64| {
            let (u, v) = along.normalize().any_orthonormal_pair();
            for i in 0..count {
                let turn = std::f64::consts::TAU * key.named("turn").child(i).unit();
                let (sin, cos) = libm::sincos(turn);
                points
                    .push(from + along * key.named("along").child(i).unit() + (u * cos + v * sin) * radius_m);
            }
        };
        let foot = DVec3::new(at[0], ground_m(at[0]), at[1]);
        on_bark(key.named("trunk"), foot, DVec3::Y * height_m, radius_m, 3000);
        for limb in 0..24_u64 {
            let key = key.named("limb").child(limb);
            let (sin, cos) = libm::sincos(2.4 * limb as f64);
            let from = foot + DVec3::Y * height_m * (0.4 + 0.6 * limb as f64 / 24.0);
            on_bark(key, from, DVec3::new(cos, 0.3, sin) * crown_m, 0.3 * radius_m, 300);
        }
        points
    }

    fn ground_m(x: f64) -> f64 {
        0.2 * x
    }

    /// Feet, height, radius of the trunk and of the crown, metres: crowns touch.
    const TREES: [([f64; 2], f64, f64, f64); 4] = [
        ([2.0, 2.0], 9.0, 0.10, 1.5),
        ([5.2, 2.4], 14.0, 0.20, 2.2),
        ([3.0, 6.0], 11.0, 0.14, 1.8),
        ([8.0, 7.0], 6.0, 0.06, 1.2),
    ];

    /// A plot on a slope, with ground and a bush, and the number of each point's tree: 1, 2 … by height.
    fn plot() -> (Vec<DVec3>, Vec<u32>) {
        let (mut points, mut numbers) = (Vec::new(), Vec::new());
        for (number, (at, height_m, radius_m, crown_m)) in (1_u64..).zip(TREES) {
            let by_height = TREES.iter().filter(|other| other.1 >= height_m).count() as u32;
            let of_tree = tree(at, height_m, radius_m, crown_m, Key::new(number));
            numbers.resize(numbers.len() + of_tree.len(), by_height);
            points.extend(of_tree);
        }
        let key = Key::new(9);
        for i in 0..10_000_u64 {
            let [x, z] = ["x", "z"].map(|name| 12.0 * key.named(name).child(i).unit() - 1.0);
            points.push(DVec3::new(x, ground_m(x), z));
        }
        // Not 2 m high, and no stem.
        for i in 0..800_u64 {
            let [x, y, z] = ["a", "b", "c"].map(|name| key.named(name).child(i).unit());
            points.push(DVec3::new(9.0 + x, ground_m(9.5) + 1.2 * y, 2.0 + z));
        }
        numbers.resize(points.len(), 0);
        (points, numbers)
    }

    fn told(points: &[DVec3], up: Up) -> Vec<u32> {
        tell_apart(points, &PlotRule { up, scale: None }, &Quiet).unwrap().numbers
    }

    #[test]
    fn crowns_that_touch_are_told_apart_by_their_stems() {
        let (points, truth) = plot();
        let numbers = told(&points, Up::Y);
        assert_eq!(numbers.iter().max(), Some(&4));
        let right = numbers.iter().zip(&truth).filter(|(a, b)| a == b).count();
        assert!(right as f64 > 0.96 * points.len() as f64, "{right} of {}", points.len());
        let wood = truth.iter().filter(|&&number| number != 0).count();
        let of_wood = numbers.iter().zip(&truth).filter(|(a, b)| a == b && **b != 0).count();
        assert!(of_wood as f64 > 0.96 * wood as f64, "{of_wood} of {wood}");
    }

    #[test]
    fn units_axes_and_the_order_of_points_change_nothing() {
        let (points, _) = plot();
        let numbers = told(&points, Up::Y);
        // Z up, in centimetres, in a survey's corner.
        let other: Vec<DVec3> =
            points.iter().map(|p| 100.0 * DVec3::new(p.x + 4000.0, 3000.0 - p.z, p.y)).collect();
        let same = told(&other, Up::Z).iter().zip(&numbers).filter(|(a, b)| a == b).count();
        assert!(same as f64 > 0.995 * points.len() as f64, "{same}");
        let backwards: Vec<DVec3> = points.iter().rev().copied().collect();
        let same = told(&backwards, Up::Y).iter().rev().zip(&numbers).filter(|(a, b)| a == b).count();
        assert!(same as f64 > 0.995 * points.len() as f64, "{same}");
    }

    #[test]
    fn stems_are_counted_and_told_from_one() {
        let (points, _) = plot();
        let (count, apart_m) = stems_of(&points, &Quiet).unwrap();
        assert!(count == 4 && (apart_m - libm::hypot(6.0, 5.0)).abs() < 0.1, "{count}, {apart_m}");
        let one = tree(TREES[1].0, 14.0, 0.2, 2.2, Key::new(2));
        let (count, apart_m) = stems_of(&one, &Quiet).unwrap();
        assert!(count <= 1 && apart_m == 0.0, "{count}, {apart_m}");
    }

    #[test]
    fn what_has_no_stem_has_no_tree() {
        let key = Key::new(3);
        let level = |i: u64| DVec3::new(9.0 * key.child(i).unit(), 0.0, 9.0 * key.named("z").child(i).unit());
        let ground: Vec<DVec3> = (0..4000).map(level).collect();
        assert!(told(&ground, Up::Y).iter().all(|&number| number == 0));
        let few = tell_apart(&[DVec3::ONE], &PlotRule { up: Up::Y, scale: None }, &Quiet);
        assert_eq!(few, Err(ScanError::TooFew { distinct: 1 }));
    }
}
