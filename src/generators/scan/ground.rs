//! The ground in a cloud that does not say which of its points lie on it.
//!
//! Below a cloud hangs a cloth (`cloth`), which rough ground, grass and multiple echoes pull down, and which lies on the lowest
//! twigs where no ground was seen. Ground is more than that:
//!
//! 1. in a cell of the cloth at least half of what is near it lies in a thin layer;
//! 2. such cells hang together, over some square metres, as heights of a surface do;
//! 3. next to nothing is below them;
//! 4. most of it is open: no more points are up to some way above it than on it;
//! 5. a stem stands among them.
//!
//! Where one of these does not hold, the cloud has no ground, and nothing is taken from it. Else what lies within the spread of the
//! layer around its middle, or below, is ground. A cell whose middle stems or grass hide is like those beside it.

use std::collections::BTreeMap;

use glam::DVec3;
use linden_base::monitor::{Cancelled, Monitor};

use super::cloth::Cloth;
use super::foot::Foot;
use super::median::median;
use super::plane::Plane;

/// The layer is looked for so far above the cloth, metres, and so far below, where strays are.
const REACH_M: f64 = 1.0;
const BELOW_M: f64 = 0.5;

/// Points of a cell that show a layer, at least.
const LEAST_POINTS: usize = 5;

/// Half of a cell's points lie in a layer so thick at most, metres. (Of grass with a standard deviation of 10 cm it is 14 cm.)
const THIN_M: f64 = 0.2;

/// The middle of the layer is no higher above the cloth, metres.
const MOST_ABOVE_M: f64 = 0.75;

/// The lowest tenth of a cell's points is so far below its layer as in other cells, metres more at most, and this part of that: else
/// roots or grass are its layer, and the ground is what the lowest show.
const LOWEST_PART: usize = 10;
const RAISED_M: f64 = 0.03;
const RAISED_PART: f64 = 0.5;

/// The ground goes on from one cell to another so many cells away,
const NEXT: usize = 2;

/// if they are no farther apart in height than this, metres, and this part of their distance.
const STEP_M: f64 = 0.15;
const STEP_PER_M: f64 = 0.2;

/// Ground that hangs together, square metres at least.
const LEAST_M2: f64 = 3.0;

/// What is so far below the ground, metres,
const UNDER_M: f64 = 0.2;

/// is this part of the points on it at most.
const MOST_UNDER: f64 = 0.02;

/// Of the cells with points near it, so many are open, as a part: not more is up to so many metres above it than on it. Above the lowest boughs
/// of a crown are others.
const LEAST_OPEN: f64 = 0.75;
const OPEN_M: f64 = 1.5;

/// What stands on the ground is so high, metres, at least.
const LEAST_TREE_M: f64 = 1.0;

/// Within this distance of a stem, metres, so much ground was seen at least, square metres.
const AROUND_M: f64 = 3.0;
const LEAST_AROUND_M2: f64 = 2.0;

/// Cells without a layer are filled from those beside them, so many cells far.
const FILLED: usize = 3;

/// Points on the ground lie within so many standard deviations of its middle, metres from and to.
const SPREADS: f64 = 3.0;
const TOLERANCE_M: [f64; 2] = [0.03, 0.3];

/// Points on one line tell no slope: see [`Plane::through`].
const ON_A_LINE: f64 = 0.01;

/// While it is looked for, for each point: its place, its height and its layer.
pub(crate) const BYTES_PER_POINT: u64 = 96;

/// The ground of a cloud.
pub(crate) struct Ground {
    /// For each point whether it is on the ground or below it.
    pub marks: Vec<bool>,
    /// In the middle of its layer, one for each cell that shows it.
    pub points: Vec<DVec3>,
    /// How much it rises, 1 for 45°.
    pub rise: f64,
}

impl Ground {
    /// That of points in metres, Y up; `None` where they show none.
    pub fn find(points: &[DVec3], monitor: &dyn Monitor) -> Result<Option<Self>, Cancelled> {
        if points.len() < LEAST_POINTS {
            return Ok(None);
        }
        let cloth = Cloth::under(points, monitor)?;
        let layers = layers(points, &cloth);
        monitor.check()?;
        let Some(surface) = Surface::of(layers, &cloth) else { return Ok(None) };
        let heights_m: Vec<Option<f64>> = points.iter().map(|&p| surface.height_above_m(p)).collect();
        monitor.check()?;
        let tolerance_m = tolerance_m(&heights_m);
        let is_ground: Vec<bool> =
            heights_m.iter().map(|height| height.is_some_and(|height| height <= tolerance_m)).collect();
        let under = heights_m.iter().flatten().filter(|height| **height < -UNDER_M.max(tolerance_m)).count();
        let on = is_ground.iter().filter(|mark| **mark).count();
        let is_surface = under as f64 <= MOST_UNDER * on as f64;
        let rows = points.iter().zip(&is_ground);
        let rest: Vec<DVec3> = rows.filter(|(_, is_ground)| !**is_ground).map(|(p, _)| *p).collect();
        let is_open = surface.open_part(points, &heights_m, tolerance_m) >= LEAST_OPEN;
        let found = Self { marks: is_ground, points: surface.middles(), rise: surface.rise() };
        let cell_m2 = cloth.cell_m() * cloth.cell_m();
        Ok((is_surface && is_open && found.bears(&rest, cell_m2)).then_some(found))
    }

    /// Whether what is not on the ground stands on it; each of its points is that of a cell of so many square metres.
    fn bears(&self, rest: &[DVec3], cell_m2: f64) -> bool {
        if rest.is_empty() {
            return false;
        }
        let foot = Foot::find(rest);
        let away = |p: &&DVec3| libm::hypot(p.x - foot.root.x, p.z - foot.root.z) <= AROUND_M;
        let around = self.points.iter().filter(away).count() as f64;
        let Some(height) = ground_height(&self.points, foot.root) else { return false };
        let top = foot.root.y + foot.height_m - height;
        around * cell_m2 >= LEAST_AROUND_M2 && top >= LEAST_TREE_M
    }
}

/// What a cell shows of the ground: the middle of its layer.
type Layer = Option<DVec3>;

/// The layers of all cells of a cloth.
fn layers(points: &[DVec3], cloth: &Cloth) -> Vec<Layer> {
    let [columns, rows] = cloth.size();
    let mut low: Vec<(usize, f64, DVec3)> = Vec::new();
    for &p in points {
        // Above the slope, so that a cell is level; and not farther off the cloth.
        let height_m = p.y - cloth.height_m(p);
        if (-BELOW_M..REACH_M).contains(&height_m) {
            let [column, row] = cloth.place(p);
            low.push((row * columns + column, p.y - cloth.plane_m(p), p));
        }
    }
    let by_place = |a: &DVec3, b: &DVec3| a.x.total_cmp(&b.x).then(a.z.total_cmp(&b.z));
    low.sort_unstable_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)).then(by_place(&a.2, &b.2)));
    let mut layers = vec![None; columns * rows];
    // How far the lowest of a cell are below its layer.
    let mut deep_m = vec![0.0; layers.len()];
    for cell in low.chunk_by(|a, b| a.0 == b.0) {
        let middle = layer(cell).filter(|middle| middle.y - cloth.height_m(*middle) <= MOST_ABOVE_M);
        let lowest_m = cell[cell.len() / LOWEST_PART].1;
        deep_m[cell[0].0] = middle.map_or(0.0, |middle| middle.y - cloth.plane_m(middle) - lowest_m);
        layers[cell[0].0] = middle;
    }
    put_down(&mut layers, &deep_m);
    layers
}

/// Puts layers of roots or grass down to where the lowest of their cells say that the ground is.
fn put_down(layers: &mut [Layer], deep_m: &[f64]) {
    let known = || layers.iter().zip(deep_m).filter(|(layer, _)| layer.is_some());
    let Some(usual_m) = median(known().map(|(_, deep_m)| *deep_m)) else { return };
    for (layer, deep_m) in layers.iter_mut().zip(deep_m) {
        let raised_m = deep_m - usual_m;
        if let Some(middle) = layer.as_mut().filter(|_| raised_m > RAISED_M.max(RAISED_PART * usual_m)) {
            middle.y -= raised_m;
        }
    }
}

/// The middle of the thinnest layer that holds half of a cell's points, by height, if it is thin.
fn layer(cell: &[(usize, f64, DVec3)]) -> Layer {
    let half = cell.len() / 2 + 1;
    if cell.len() < LEAST_POINTS {
        return None;
    }
    let thick_m = |layer: &&[(usize, f64, DVec3)]| layer[half - 1].1 - layer[0].1;
    let thinnest = cell.windows(half).min_by(|a, b| thick_m(a).total_cmp(&thick_m(b)))?;
    let sum = thinnest.iter().fold(DVec3::ZERO, |sum, (_, _, p)| sum + *p);
    (thick_m(&thinnest) <= THIN_M).then_some(sum / half as f64)
}

/// Heights of the ground, where it was seen and beside that.
struct Surface<'a> {
    cloth: &'a Cloth,
    plane: Plane,
    layers: Vec<Layer>,
    /// Above the plane, in the middle of each cell.
    levels_m: Vec<Option<f64>>,
}

impl<'a> Surface<'a> {
    /// Of the layers that hang together; `None` where none do.
    fn of(mut layers: Vec<Layer>, cloth: &'a Cloth) -> Option<Self> {
        keep_wide(&mut layers, cloth);
        let seen: Vec<DVec3> = layers.iter().flatten().copied().collect();
        let plane = Plane::through(&seen, ON_A_LINE)?;
        let levels_m = layers.iter().map(|layer| layer.map(|p| p.y - plane.height_m(p))).collect();
        let mut surface = Self { cloth, plane, layers, levels_m };
        surface.smooth();
        for _ in 0..FILLED {
            surface.fill();
        }
        Some(surface)
    }

    /// The levels known around a cell, with its own.
    fn around(&self, cell: usize) -> Vec<f64> {
        let cells = window(self.cloth.size(), cell, 1);
        cells.filter_map(|cell| self.levels_m[cell]).collect()
    }

    /// Each level becomes the median of those around it, where they are the most of nine: grass in one is no bump.
    fn smooth(&mut self) {
        let new = |cell: usize| {
            let around = self.around(cell);
            let known = self.levels_m[cell]?;
            if around.len() < 5 { Some(known) } else { median(around) }
        };
        self.levels_m = (0..self.levels_m.len()).map(new).collect();
    }

    fn fill(&mut self) {
        let new = |cell: usize| {
            let mean = || {
                let around = self.around(cell);
                (!around.is_empty()).then(|| around.iter().sum::<f64>() / around.len() as f64)
            };
            self.levels_m[cell].or_else(mean)
        };
        self.levels_m = (0..self.levels_m.len()).map(new).collect();
    }

    /// How far a place is above it; `None` beyond it.
    fn height_above_m(&self, p: DVec3) -> Option<f64> {
        let [columns, _] = self.cloth.size();
        let [column, row] = self.cloth.place(p);
        let own = self.levels_m[row * columns + column]?;
        let level = self.cloth.between(p, |cell| self.levels_m[cell].unwrap_or(own));
        Some(p.y - self.plane.height_m(p) - level)
    }

    /// A place on it in each cell that was seen.
    fn middles(&self) -> Vec<DVec3> {
        let on = |p: &DVec3| Some(p.with_y(p.y - self.height_above_m(*p)?));
        self.layers.iter().flatten().filter_map(on).collect()
    }

    /// The part of the cells with points near it in which not more of them are some way above it than on it.
    fn open_part(&self, points: &[DVec3], heights_m: &[Option<f64>], tolerance_m: f64) -> f64 {
        let [columns, _] = self.cloth.size();
        let mut on_above = vec![[0_u32; 2]; self.layers.len()];
        for (p, height_m) in points.iter().zip(heights_m) {
            let [column, row] = self.cloth.place(*p);
            if let Some(height_m) = height_m.filter(|height| *height < OPEN_M) {
                on_above[row * columns + column][usize::from(height_m > tolerance_m)] += 1;
            }
        }
        let seen = || on_above.iter().filter(|[on, above]| on + above > 0);
        let open = seen().filter(|[on, above]| above <= on).count();
        open as f64 / seen().count().max(1) as f64
    }

    fn rise(&self) -> f64 {
        libm::hypot(self.plane.slope[0], self.plane.slope[1])
    }
}

/// The cells around one, itself too, up to so many away, on a grid of columns and rows.
fn window([columns, rows]: [usize; 2], cell: usize, away: usize) -> impl Iterator<Item = usize> {
    let (column, row) = (cell % columns, cell / columns);
    let near = move |at: usize, count: usize| at.saturating_sub(away)..(at + away + 1).min(count);
    near(row, rows).flat_map(move |row| near(column, columns).map(move |column| row * columns + column))
}

/// Leaves layers that hang together over enough ground.
fn keep_wide(layers: &mut [Layer], cloth: &Cloth) {
    let least = (LEAST_M2 / (cloth.cell_m() * cloth.cell_m())).ceil() as usize;
    let goes_on = |a: DVec3, b: DVec3| {
        let up_m = (a.y - cloth.plane_m(a)) - (b.y - cloth.plane_m(b));
        up_m.abs() <= STEP_M + STEP_PER_M * libm::hypot(a.x - b.x, a.z - b.z)
    };
    let mut is_met = vec![false; layers.len()];
    for first in 0..layers.len() {
        if is_met[first] || layers[first].is_none() {
            continue;
        }
        is_met[first] = true;
        let mut cells = vec![first];
        let mut next = 0;
        while let Some(&cell) = cells.get(next) {
            next += 1;
            for other in window(cloth.size(), cell, NEXT) {
                let is_next = layers[cell].zip(layers[other]).is_some_and(|(a, b)| goes_on(a, b));
                if is_next && !is_met[other] {
                    is_met[other] = true;
                    cells.push(other);
                }
            }
        }
        if cells.len() < least {
            for cell in cells {
                layers[cell] = None;
            }
        }
    }
}

/// How far above its middle points are on the ground: by the spread of those below, among which no grass is.
fn tolerance_m(heights_m: &[Option<f64>]) -> f64 {
    let below = heights_m.iter().flatten().filter(|height| (-BELOW_M..0.0).contains(*height));
    let spread_m = median(below.map(|height| -height)).map_or(0.0, |off_m| super::circle::SD_PER_MAD * off_m);
    (SPREADS * spread_m).clamp(TOLERANCE_M[0], TOLERANCE_M[1])
}

/// The fewest and the most points of the ground whose median is its height at a place.
const GROUND_POINTS: [usize; 2] = [9, 400];

/// Between these, so many are taken that the standard error of their median is no larger, metres.
const STANDARD_ERROR_M: f64 = 0.01;

/// How far around a place points tell how the ground rises there, metres.
const SLOPE_M: f64 = 2.0;

/// The side of the cells in which the roughness of the ground is compared, metres.
const ROUGH_CELL_M: f64 = 0.25;

/// A cell shows bark or roots that were taken for ground where it is rougher than so many times the median cell, and so many metres
/// more.
const ROUGH_FACTOR: f64 = 3.0;
const ROUGH_M: f64 = 0.02;

/// The height of the ground at a place: the median of the points on it (metres, Y up) that are nearest to its plumb line, carried
/// along the slope of the ground around: those beside a stem may all lie uphill of it, or high up on its bark.
pub(super) fn ground_height(ground: &[DVec3], at: DVec3) -> Option<f64> {
    let away = |p: &DVec3| (p.x - at.x) * (p.x - at.x) + (p.z - at.z) * (p.z - at.z);
    let by_place = |a: &DVec3, b: &DVec3| {
        let level = away(a).total_cmp(&away(b)).then(a.y.total_cmp(&b.y));
        level.then(a.x.total_cmp(&b.x)).then(a.z.total_cmp(&b.z))
    };
    let near: Vec<DVec3> = ground.iter().copied().filter(|p| away(p) <= SLOPE_M * SLOPE_M).collect();
    let around = if near.len() < GROUND_POINTS[0] { None } else { Around::of(&near) };
    let (plane, mut nearest, count) = match around {
        Some(Around { plane, level, sd_m }) => {
            // The median of n points has a standard error of 1.25 sd ÷ √n.
            let root = 1.25 * sd_m / STANDARD_ERROR_M;
            let nearest = if level.len() < GROUND_POINTS[0] { near } else { level };
            (Some(plane), nearest, ((root * root) as usize).clamp(GROUND_POINTS[0], GROUND_POINTS[1]))
        }
        None => (None, ground.to_vec(), GROUND_POINTS[0]),
    };
    nearest.sort_unstable_by(by_place);
    nearest.truncate(count);
    let carried =
        |p: &DVec3| p.y + plane.as_ref().map_or(0.0, |plane| plane.height_m(at) - plane.height_m(*p));
    median(nearest.iter().map(carried))
}

/// The ground around a place.
struct Around {
    plane: Plane,
    /// Points of cells that are no rougher than others.
    level: Vec<DVec3>,
    /// The standard deviation of heights in a cell, metres.
    sd_m: f64,
}

impl Around {
    fn of(near: &[DVec3]) -> Option<Self> {
        let mut near = near.to_vec();
        near.sort_unstable_by(|a, b| a.y.total_cmp(&b.y).then(a.x.total_cmp(&b.x)).then(a.z.total_cmp(&b.z)));
        let mut cells: BTreeMap<[i64; 2], Vec<DVec3>> = BTreeMap::new();
        for p in near {
            cells.entry([p.x, p.z].map(|at| (at / ROUGH_CELL_M).floor() as i64)).or_default().push(p);
        }
        // One row a cell: a stem's bark has more points than the ground around it.
        let middles: Vec<DVec3> = cells.values().map(|cell| cell[cell.len() / 2]).collect();
        let plane = Plane::through(&middles, ON_A_LINE)?;
        let off_m = |cell: &Vec<DVec3>| {
            let heights: Vec<f64> = cell.iter().map(|p| p.y - plane.height_m(*p)).collect();
            let middle_m = median(heights.iter().copied()).unwrap_or(0.0);
            median(heights.iter().map(|height| (height - middle_m).abs())).unwrap_or(0.0)
        };
        let all_off_m: Vec<f64> = cells.values().map(off_m).collect();
        let usual_m = median(all_off_m.iter().copied())?;
        let is_level = |off_m: f64| off_m <= ROUGH_FACTOR * usual_m + ROUGH_M;
        let rows = cells.into_values().zip(all_off_m);
        let level = rows.filter(|(_, off_m)| is_level(*off_m)).flat_map(|(cell, _)| cell).collect();
        Some(Self { plane, level, sd_m: super::circle::SD_PER_MAD * usual_m })
    }
}

#[cfg(test)]
mod tests {
    use linden_base::monitor::Quiet;
    use linden_base::random::Key;

    use super::*;

    fn unit(name: &str, i: u64) -> f64 {
        Key::new(4).named(name).child(i).unit()
    }

    /// From -1 to 1, more often near 0, with a standard deviation of 0.41.
    fn noise(name: &str, i: u64) -> f64 {
        unit(name, 2 * i) + unit(name, 2 * i + 1) - 1.0
    }

    /// Bark of a stem of 9 m with limbs, upright on the origin: `from_m` above it at least.
    fn tree(from_m: f64) -> Vec<DVec3> {
        let stem = (0..9000).map(|i| {
            let (sin, cos) = libm::sincos(std::f64::consts::TAU * unit("turn", i));
            let h = 9.0 * unit("up", i);
            let r = 0.16 - 0.015 * h;
            DVec3::new(r * cos, h, r * sin)
        });
        let limbs = (0..9000).map(|i| {
            let (sin, cos) = libm::sincos(2.4 * (i % 16) as f64);
            let (turn, out) = (libm::sincos(7.0 * unit("turn", i)), 2.5 * unit("out", i));
            DVec3::new(out * cos + 0.03 * turn.0, 3.0 + 0.3 * (i % 16) as f64 + 0.4 * out, out * sin)
                + DVec3::Y * 0.03 * turn.1
        });
        stem.chain(limbs).filter(|p| p.y >= from_m).collect()
    }

    /// Ground around it that rises along x by `degrees`, with noise.
    fn ground(degrees: f64, noise_m: f64) -> Vec<DVec3> {
        let rise = libm::tan(degrees.to_radians());
        let place = |i: u64| [unit("x", i), unit("z", i)].map(|at| 12.0 * at - 6.0);
        let on = |(i, [x, z]): (u64, [f64; 2])| DVec3::new(x, rise * x + noise_m * noise("rough", i), z);
        let is_free = |(_, [x, z]): &(u64, [f64; 2])| x * x + z * z > 0.03;
        (0..14_000).map(|i| (i, place(i))).filter(is_free).map(on).collect()
    }

    fn found(points: &[DVec3]) -> Option<Ground> {
        Ground::find(points, &Quiet).unwrap()
    }

    #[test]
    fn slopes_and_rough_ground_are_told_from_the_tree() {
        for (degrees, noise_m) in
            [(0.0, 0.0), (15.0, 0.01), (25.0, 0.02), (30.0, 0.05), (-20.0, 0.2), (0.0, 0.25)]
        {
            let (on, tree) = (ground(degrees, noise_m), tree(0.0));
            let found = found(&[&on[..], &tree].concat()).expect("ground");
            let taken = found.marks[..on.len()].iter().filter(|mark| **mark).count();
            assert!(taken as f64 > 0.985 * on.len() as f64, "{degrees}, {noise_m}: {taken} of {}", on.len());
            let lost = tree.iter().zip(&found.marks[on.len()..]).filter(|(p, mark)| **mark && p.y > 0.35);
            assert_eq!(lost.count(), 0, "{degrees}, {noise_m}");
            let height = ground_height(&found.points, DVec3::ZERO).unwrap();
            assert!(height.abs() < 0.01 + 0.08 * noise_m, "{degrees}, {noise_m}: {height}");
            assert!(
                (found.rise - libm::tan(degrees.to_radians()).abs()).abs() < 0.03,
                "{degrees}: {}",
                found.rise
            );
        }
    }

    #[test]
    fn roots_that_hide_most_of_the_ground_around_a_stem_are_none() {
        // Up to 1.5 m from the stem, 20 cm high there.
        let roots = (0..3000).map(|i| {
            let (sin, cos) = libm::sincos(std::f64::consts::TAU * unit("r", i));
            let out = 0.2 + 1.3 * unit("o", i);
            DVec3::new(out * cos, 0.2 * (1.5 - out) / 1.3, out * sin)
        });
        let points: Vec<DVec3> = roots.chain(ground(0.0, 0.004)).chain(tree(0.0)).collect();
        let height = ground_height(&found(&points).unwrap().points, DVec3::ZERO).unwrap();
        assert!(height.abs() < 0.015, "{height}");
    }

    #[test]
    fn what_has_no_ground_loses_nothing() {
        assert!(found(&tree(0.0)).is_none());
        assert!(found(&ground(10.0, 0.02)).is_none(), "ground without a tree");
        assert!(found(&[]).is_none());
        // Low boughs all around, at the height of a hand, and the foot of the stem below them.
        let boughs = (0..6000).map(|i| {
            let (sin, cos) = libm::sincos(2.0 * std::f64::consts::PI * unit("a", i));
            let out = 3.0 * unit("b", i).sqrt();
            DVec3::new(out * cos, 0.6 + 0.5 * unit("c", i), out * sin)
        });
        let spruce: Vec<DVec3> = boughs.chain(tree(0.0)).collect();
        assert!(found(&spruce).is_none());
    }

    #[test]
    fn boughs_that_hang_to_the_ground_are_none() {
        // Whorls one above another, each as thin as grass, the lowest at the foot of the stem.
        let boughs = (0..20_000).map(|i| {
            let (sin, cos) = libm::sincos(std::f64::consts::TAU * unit("a", i));
            let (whorl, out) = ((i % 8) as f64, unit("b", i).sqrt());
            let h = 0.05 + 0.4 * whorl + 0.05 * unit("c", i);
            DVec3::new((2.8 - 0.2 * whorl) * out * cos, h, (2.8 - 0.2 * whorl) * out * sin)
        });
        let spruce: Vec<DVec3> = boughs.chain(tree(0.0)).collect();
        assert!(found(&spruce).is_none());
    }

    #[test]
    fn the_order_of_points_changes_nothing() {
        let points = [ground(12.0, 0.05), tree(0.0)].concat();
        let backwards: Vec<DVec3> = points.iter().rev().copied().collect();
        let (one, mut other) = (found(&points).unwrap(), found(&backwards).unwrap());
        other.marks.reverse();
        assert_eq!((one.marks, one.points), (other.marks, other.points));
    }

    #[test]
    fn beside_a_stem_the_ground_is_as_high_as_below_it() {
        // Seen uphill of a thick stem only.
        let seen: Vec<DVec3> = ground(25.0, 0.0).into_iter().filter(|p| p.x > 0.5).collect();
        let height = ground_height(&seen, DVec3::ZERO).unwrap();
        assert!(height.abs() < 0.01, "{height}");
    }

    #[test]
    fn bark_and_noise_that_were_taken_for_ground_lift_no_foot() {
        // The lowest 40 cm of the stem went with the ground, as filters of surveys have it.
        let stem = || tree(0.0).into_iter().filter(|p| p.y < 0.4);
        for (degrees, noise_m) in [(0.0, 0.0), (0.0, 0.02), (20.0, 0.05)] {
            let seen: Vec<DVec3> = ground(degrees, noise_m).into_iter().chain(stem()).collect();
            for at in [[0.0, 0.0], [0.1, 0.0], [0.0, -0.15]].map(|[x, z]| DVec3::new(x, 0.0, z)) {
                let height = ground_height(&seen, at).unwrap() - libm::tan(degrees.to_radians()) * at.x;
                assert!(height.abs() < 0.02, "{degrees} {noise_m} {at}: {height}");
            }
        }
        // 10 cm of noise: nine points would be off by 4 cm.
        for seed in 0..20 {
            let off = DVec3::new(unit("off", seed), 0.0, unit("off", seed + 100)) * 3.0;
            let height = ground_height(&ground(0.0, 0.25), off).unwrap();
            assert!(height.abs() < 0.03, "{off}: {height}");
        }
    }

    #[test]
    fn a_few_points_tell_the_slope_too() {
        assert_eq!(ground_height(&[], DVec3::ZERO), None);
        assert_eq!(ground_height(&[DVec3::Y], DVec3::ZERO), Some(1.0));
        // Ten points uphill, two of them high up in one cell, as a root is.
        let rise = libm::tan(25.0_f64.to_radians());
        let mut seen: Vec<DVec3> = (0..8_u32)
            .map(|i| [0.6 + 0.12 * f64::from(i), 0.4 * f64::from(i % 3) - 0.4])
            .map(|[x, z]| DVec3::new(x, rise * x, z))
            .collect();
        seen.extend([DVec3::new(1.1, rise * 1.1, 0.3), DVec3::new(1.1, rise * 1.1 + 0.3, 0.3)]);
        let height = ground_height(&seen, DVec3::ZERO).unwrap();
        assert!(height.abs() < 0.08, "{height}, and {} without the slope", rise * 1.0);
    }
}
