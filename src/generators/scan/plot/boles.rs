//! The stems of a plot, as slices near breast height show them.
//!
//! In a slice of points above the ground, bark stands upright: cells of a fine grid in which it is met at nearly all
//! levels hang together to patches, and circles are put through these. What twigs and undergrowth leave over is no circle,
//! has points inside, or does not go on above and below.

use glam::DVec3;
use linden_base::monitor::{Cancelled, Monitor};
use linden_base::random::Key;

use crate::circle::{Circle, Flat, LEAST_POINTS, consensus};

/// Slices of points above the ground, metres: at breast height first, which decides what a stem measures, then above and
/// below.
const SLICES_M: [[f64; 2]; 4] = [[1.0, 1.6], [1.6, 2.2], [0.4, 1.0], [2.2, 2.8]];

/// A stem shows in so many of them: a ring of leaves is in one by chance.
const LEAST_SLICES: u32 = 2;

/// From one to the next its radius changes by no more than this factor.
const RADIUS_RATIO: f64 = 1.6;

/// Levels of a slice.
const LEVELS: u32 = 6;

/// Upright is what is met in so many of them.
const UPRIGHT: u32 = 4;

/// And a stem's bark in so many.
const BARK_LEVELS: u32 = 5;

/// Radii of stems, metres.
const RADII_M: [f64; 2] = [0.02, 1.5];

/// How far bark may lie off its circle, metres, and as a part of the radius.
const BARK_M: f64 = 0.02;
const BARK_PART: f64 = 0.35;

/// The part of the turn that a stem shows at least, radians: 100°.
const LEAST_ARC: f64 = 100.0 / 180.0 * std::f64::consts::PI;

/// Of the points on a circle and within it, the share that is well within it, at most: stems are not filled.
const MOST_INSIDE: f64 = 0.2;

/// In a patch that is wider, circles are looked for in squares of this side, which overlap by half, metres.
const SQUARE_M: f64 = 1.6;

/// Stems that are looked for in one square.
const MOST_PER_SQUARE: usize = 6;

/// Points of a square that circles are put through, at most.
const MOST_POINTS: usize = 3000;

/// A stem goes on from the ground up to here, metres, and is met in this share of the levels between.
const GOES_ON_M: f64 = 3.0;
const GOES_ON_SHARE: f64 = 0.7;

/// The height of a level in which a stem is looked for again, metres.
const LEVEL_M: f64 = 0.3;

/// What lies off the axis by so much for each metre up or down may be the same stem, which leans.
const LEAN: f64 = 0.15;

/// Bark of two stems that are nearer to each other at breast height is of one tree, metres.
const ONE_TREE_M: f64 = 0.15;

/// A tree as it stands near breast height.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Bole {
    /// Level, metres.
    pub centre: Flat,
    /// Of its thickest stem.
    pub radius_m: f64,
    /// How far out its stems reach.
    pub reach_m: f64,
    /// The slice that shows it, above the ground.
    pub slice_m: [f64; 2],
}

impl Bole {
    pub fn off_m(&self, p: DVec3) -> f64 {
        away((p.x, p.z), self.centre)
    }
}

/// All boles, by their places. `heights_m` are those of `points` above the ground.
pub(super) fn find(
    points: &[DVec3],
    heights_m: &[f32],
    spacing_m: f64,
    monitor: &dyn Monitor,
) -> Result<Vec<Bole>, Cancelled> {
    // What shows whether stems go on: everything below, by level.
    let occupancy = Occupancy::new(points, heights_m, monitor)?;
    let mut stems: Vec<Stem> = Vec::new();
    for (slice, slice_m) in SLICES_M.into_iter().enumerate() {
        monitor.check()?;
        let points: Vec<(DVec3, f64)> = points
            .iter()
            .zip(heights_m)
            .map(|(&p, &height)| (p, f64::from(height)))
            .filter(|(_, height)| (slice_m[0]..slice_m[1]).contains(height))
            .collect();
        for patch in patches(&points, slice_m, (2.0 * spacing_m).max(0.05)) {
            monitor.check()?;
            for circle in circles(patch) {
                let new =
                    Stem { centre: circle.centre, radius_m: circle.radius_m, slice_m, slices: 1 << slice };
                match stems.iter_mut().find(|stem| stem.goes_on_in(&new)) {
                    Some(stem) => stem.slices |= new.slices,
                    None => stems.push(new),
                }
            }
        }
    }
    let mut boles: Vec<Bole> = Vec::new();
    for stem in stems.iter().filter(|stem| stem.slices.count_ones() >= LEAST_SLICES && occupancy.shows(stem))
    {
        let bark_m = |bole: &Bole| away(bole.centre, stem.centre) - bole.reach_m - stem.radius_m;
        match boles.iter_mut().find(|bole| bark_m(bole) < ONE_TREE_M) {
            Some(bole) => {
                bole.reach_m = bole.reach_m.max(away(bole.centre, stem.centre) + stem.radius_m);
                bole.radius_m = bole.radius_m.max(stem.radius_m);
            }
            None => {
                let Stem { centre, radius_m, slice_m, .. } = *stem;
                boles.push(Bole { centre, radius_m, reach_m: radius_m, slice_m });
            }
        }
    }
    boles.sort_by(|a, b| a.centre.0.total_cmp(&b.centre.0).then(a.centre.1.total_cmp(&b.centre.1)));
    Ok(boles)
}

fn away(a: Flat, b: Flat) -> f64 {
    ((a.0 - b.0) * (a.0 - b.0) + (a.1 - b.1) * (a.1 - b.1)).sqrt()
}

/// A circle that goes on from slice to slice.
struct Stem {
    centre: Flat,
    radius_m: f64,
    /// The first slice that shows it.
    slice_m: [f64; 2],
    /// A bit for each that does.
    slices: u32,
}

impl Stem {
    fn middle_m(&self) -> f64 {
        0.5 * (self.slice_m[0] + self.slice_m[1])
    }

    /// Whether a circle in another slice is the same stem.
    fn goes_on_in(&self, other: &Self) -> bool {
        let leans_m = LEAN * (self.middle_m() - other.middle_m()).abs();
        let ratio = (self.radius_m / other.radius_m).max(other.radius_m / self.radius_m);
        self.slice_m != other.slice_m
            && ratio <= RADIUS_RATIO
            && away(self.centre, other.centre) <= leans_m + 0.5 * self.radius_m.max(other.radius_m)
    }
}

/// A place seen from above, and the bit of its level in the slice.
#[derive(Clone, Copy)]
struct Placed {
    at: Flat,
    level: u32,
}

/// Points of a slice that stand upright, patch by patch, as places seen from above.
fn patches(slice: &[(DVec3, f64)], slice_m: [f64; 2], cell_m: f64) -> Vec<Vec<Placed>> {
    let low = slice.iter().map(|(p, _)| *p).fold(DVec3::INFINITY, DVec3::min);
    let level = |height: f64| {
        let part = (height - slice_m[0]) / (slice_m[1] - slice_m[0]);
        ((part * f64::from(LEVELS)) as u32).min(LEVELS - 1)
    };
    // Cells in the order of their places, with the levels that they are met at.
    let mut placed: Vec<([u32; 2], u32, u32)> = (0..)
        .zip(slice)
        .map(|(i, (p, height))| {
            let cell = [p.x - low.x, p.z - low.z].map(|x| (x / cell_m) as u32 + 1);
            (cell, i, 1 << level(*height))
        })
        .collect();
    placed.sort_unstable();
    let mut cells: Vec<([u32; 2], u32)> = Vec::new();
    let mut starts = vec![0];
    for same in placed.chunk_by(|a, b| a.0 == b.0) {
        cells.push((same[0].0, same.iter().fold(0, |levels, (_, _, level)| levels | level)));
        starts.push(starts[starts.len() - 1] + same.len());
    }
    let around = |[x, z]: [u32; 2]| {
        let beside = (0..3).flat_map(move |dz| (0..3).map(move |dx| [x + dx - 1, z + dz - 1]));
        beside.filter_map(|at| cells.binary_search_by_key(&at, |cell| cell.0).ok())
    };
    let is_upright: Vec<bool> = cells
        .iter()
        .map(|(at, _)| around(*at).fold(0, |levels, cell| levels | cells[cell].1).count_ones() >= UPRIGHT)
        .collect();
    let mut is_taken = vec![false; cells.len()];
    let mut patches = Vec::new();
    for first in 0..cells.len() {
        if is_taken[first] || !is_upright[first] {
            continue;
        }
        is_taken[first] = true;
        let mut members = vec![first];
        let mut next = 0;
        while let Some(&cell) = members.get(next) {
            next += 1;
            for other in around(cells[cell].0) {
                if !is_taken[other] && is_upright[other] {
                    is_taken[other] = true;
                    members.push(other);
                }
            }
        }
        members.sort_unstable();
        let of_cell = |&cell: &usize| placed[starts[cell]..starts[cell + 1]].iter();
        let seen = |&(_, i, level): &([u32; 2], u32, u32)| {
            let (p, _) = slice[i as usize];
            Placed { at: (p.x, p.z), level }
        };
        let patch: Vec<Placed> = members.iter().flat_map(of_cell).map(seen).collect();
        if patch.len() >= LEAST_POINTS {
            patches.push(patch);
        }
    }
    patches
}

/// The circles that the points of a patch lie on, the surest of overlapping ones.
fn circles(patch: Vec<Placed>) -> Vec<Circle> {
    let places = || patch.iter().map(|p| p.at);
    let low = places().fold([f64::INFINITY; 2], |low, p| [low[0].min(p.0), low[1].min(p.1)]);
    let high = places().fold([f64::NEG_INFINITY; 2], |high, p| [high[0].max(p.0), high[1].max(p.1)]);
    if high[0] - low[0] <= SQUARE_M && high[1] - low[1] <= SQUARE_M {
        return circles_in(patch);
    }
    let half_m = 0.5 * SQUARE_M;
    let square = |p: &Placed| [(p.at.0 - low[0]) / half_m, (p.at.1 - low[1]) / half_m].map(|x| x as u32);
    let mut placed: Vec<([u32; 2], Placed)> = patch.iter().map(|p| (square(p), *p)).collect();
    placed.sort_by_key(|(square, _)| *square);
    let mut squares: Vec<[u32; 2]> = placed.iter().map(|(square, _)| *square).collect();
    squares.dedup();
    let of = |at: [u32; 2]| {
        let start = placed.partition_point(|(square, _)| *square < at);
        placed[start..].iter().take_while(move |(square, _)| *square == at).map(|(_, p)| *p)
    };
    let mut found: Vec<Circle> = Vec::new();
    for [x, z] in squares {
        let square = [[x, z], [x, z + 1], [x + 1, z], [x + 1, z + 1]].into_iter().flat_map(of).collect();
        for new in circles_in(square) {
            let overlaps = |other: &Circle| away(other.centre, new.centre) < other.radius_m.max(new.radius_m);
            // Half of a stem shows at the border of a square: the neighbour shows more of it.
            match found.iter().position(overlaps) {
                Some(at) if new.arc_rad > found[at].arc_rad => found[at] = new,
                Some(_) => {}
                None => found.push(new),
            }
        }
    }
    found
}

/// One after the other, each without the points of those before.
fn circles_in(mut placed: Vec<Placed>) -> Vec<Circle> {
    let every = placed.len().div_ceil(MOST_POINTS).max(1);
    placed = placed.into_iter().step_by(every).collect();
    let mut circles = Vec::new();
    let key = Key::new(placed.len() as u64).named("bole");
    for number in 0..MOST_PER_SQUARE as u64 {
        let flat: Vec<Flat> = placed.iter().map(|p| p.at).collect();
        let Some(circle) = consensus(&flat, BARK_M, RADII_M, key.child(number)) else { break };
        let off = |p: &Placed| away(p.at, circle.centre) - circle.radius_m;
        let bark_m = BARK_M.min(BARK_PART * circle.radius_m);
        let on = || placed.iter().filter(|p| off(p).abs() <= bark_m);
        let inside = placed.iter().filter(|p| off(p) < -bark_m).count();
        let levels = on().fold(0, |levels, p| levels | p.level).count_ones();
        if circle.arc_rad >= LEAST_ARC
            && on().count() >= LEAST_POINTS
            && levels >= BARK_LEVELS
            && inside as f64 <= MOST_INSIDE * (on().count() + inside) as f64
        {
            circles.push(circle);
        }
        let before = placed.len();
        placed.retain(|p| off(p) > 2.0 * BARK_M);
        if placed.len() == before {
            break;
        }
    }
    circles
}

/// Which places are met at which level above the ground.
struct Occupancy {
    low: [f64; 2],
    /// Level and cell, sorted.
    met: Vec<[u32; 3]>,
}

impl Occupancy {
    const CELL_M: f64 = 0.1;

    fn new(points: &[DVec3], heights_m: &[f32], monitor: &dyn Monitor) -> Result<Self, Cancelled> {
        let low = points.iter().fold([f64::INFINITY; 2], |low, p| [low[0].min(p.x), low[1].min(p.z)]);
        let mut met: Vec<[u32; 3]> = points
            .iter()
            .zip(heights_m)
            .filter(|(_, height)| (LEVEL_M..GOES_ON_M).contains(&f64::from(**height)))
            .map(|(p, height)| {
                let cell = |x: f64, low: f64| ((x - low) / Self::CELL_M) as u32;
                [(f64::from(*height) / LEVEL_M) as u32, cell(p.x, low[0]), cell(p.z, low[1])]
            })
            .collect();
        monitor.check()?;
        met.sort_unstable();
        met.dedup();
        Ok(Self { low, met })
    }

    /// Whether there is something above and below a stem, at most levels between the ground and [`GOES_ON_M`].
    fn shows(&self, stem: &Stem) -> bool {
        let levels = 1..(GOES_ON_M / LEVEL_M) as u32;
        let count = levels.len() as f64;
        let middle_m = stem.middle_m();
        let met = levels.filter(|&level| {
            let up_m = ((f64::from(level) + 0.5) * LEVEL_M - middle_m).abs();
            let reach = (stem.radius_m + LEAN * up_m) / Self::CELL_M + 1.0;
            let (x, z) =
                ((stem.centre.0 - self.low[0]) / Self::CELL_M, (stem.centre.1 - self.low[1]) / Self::CELL_M);
            let from = |x: f64| (x - reach).max(0.0) as u32;
            (from(x)..=(x + reach) as u32).any(|column| {
                let start = self.met.partition_point(|met| *met < [level, column, from(z)]);
                self.met
                    .get(start)
                    .is_some_and(|met| met[0] == level && met[1] == column && f64::from(met[2]) <= z + reach)
            })
        });
        met.count() as f64 >= GOES_ON_SHARE * count
    }
}
