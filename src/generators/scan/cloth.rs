//! A cloth that hangs below a cloud, where the ground is.
//!
//! It is found as if the cloud were upside down, a cloth that falls onto it (Zhang, Qi, Wan, Wang, Xie, Wang &
//! Yan 2016, *An easy-to-use airborne lidar data filtering method based on cloth simulation*, Remote Sensing 8(6):501).
//! Here the place where the cloth comes to rest is computed at once, without the fall: of all surfaces that no point is below
//! and that sag no more than [`SAG`], the highest. It lies on the ground where ground was seen, and spans what stems and
//! crowns hide.

use glam::DVec3;
use linden_base::monitor::{Cancelled, Monitor};

use super::plane::Plane;

/// Sides of cells, metres, where there are not too many of them.
const CELL_M: f64 = 0.5;

/// Cells at most, about.
const MOST_CELLS: f64 = 500_000.0;

/// How much the cloth bends where nothing holds it, 1/m: over a gap of 2 m it rises by 4 cm in the middle, and it follows
/// ridges and steps of about the width of a road.
const SAG: f64 = 0.3;

/// A cell whose lowest point is so far below those beside it may hold a stray, metres:
const STRAY_M: f64 = 1.0;

/// if it is one of fewer than this.
const COMPANY: u32 = 3;

/// The cloth is at rest when no cell moves farther in a round, metres.
const REST_M: f64 = 1e-4;

/// Rounds at most: each cell hears of what is so many cells away.
const ROUNDS: usize = 4000;

/// Cells that the slope of the whole is told by are so many times as wide: in each of them some ground is seen.
const COARSER: usize = 10;

/// Lowest points on one line tell no slope: see [`Plane::through`].
const ON_A_LINE: f64 = 1e-6;

/// Its heights on a grid.
pub(crate) struct Cloth {
    low: [f64; 2],
    cell_m: f64,
    columns: usize,
    rows: usize,
    /// Above the slope.
    heights_m: Vec<f64>,
    /// The slope of the whole along columns and rows, so that the cloth at the rim lies as level as elsewhere.
    slope: [f64; 2],
}

impl Cloth {
    /// Under points in metres, Y up; at least one.
    pub fn under(points: &[DVec3], monitor: &dyn Monitor) -> Result<Self, Cancelled> {
        let low = points.iter().copied().fold(DVec3::INFINITY, DVec3::min);
        let size = points.iter().copied().fold(DVec3::NEG_INFINITY, DVec3::max) - low;
        let cell_m = CELL_M.max((size.x * size.z / MOST_CELLS).sqrt()).max(size.x.max(size.z) / MOST_CELLS);
        let cells = |length_m: f64| (length_m / cell_m) as usize + 1;
        let (columns, rows) = (cells(size.x), cells(size.z));
        let mut cloth = Self {
            low: [low.x, low.z],
            cell_m,
            columns,
            rows,
            heights_m: vec![f64::INFINITY; columns * rows],
            slope: [0.0; 2],
        };
        // The lowest point of each cell, and the slope from those of wider cells.
        let mut lowest: Vec<Option<DVec3>> = vec![None; columns * rows];
        for &p in points {
            let lowest = &mut lowest[cloth.cell(p)];
            *lowest = Some(lowest.filter(|lowest| lowest.y <= p.y).unwrap_or(p));
        }
        monitor.check()?;
        cloth.take_heights(&lowest);
        cloth.drop_strays(points, &mut lowest);
        cloth.slope = cloth.slope_of(&lowest);
        cloth.take_heights(&lowest);
        cloth.come_to_rest(monitor)?;
        Ok(cloth)
    }

    /// The side of a cell, metres.
    pub fn cell_m(&self) -> f64 {
        self.cell_m
    }

    /// Columns and rows of cells.
    pub fn size(&self) -> [usize; 2] {
        [self.columns, self.rows]
    }

    /// The cell below a place: column and row.
    pub fn place(&self, p: DVec3) -> [usize; 2] {
        let at = |x: f64, low: f64, count: usize| (((x - low) / self.cell_m) as usize).min(count - 1);
        [at(p.x, self.low[0], self.columns), at(p.z, self.low[1], self.rows)]
    }

    /// Its height at a place, between the middles of cells.
    pub fn height_m(&self, p: DVec3) -> f64 {
        self.between(p, |cell| self.heights_m[cell]) + self.plane_m(p)
    }

    /// At a place, what cells have in their middles.
    pub fn between(&self, p: DVec3, value: impl Fn(usize) -> f64) -> f64 {
        let at = |x: f64, low: f64, count: usize| {
            let cells = ((x - low) / self.cell_m - 0.5).clamp(0.0, (count - 1) as f64);
            let first = (cells as usize).min(count.saturating_sub(2));
            (first, (first + 1).min(count - 1), cells - first as f64)
        };
        let (left, right, x) = at(p.x, self.low[0], self.columns);
        let (front, back, z) = at(p.z, self.low[1], self.rows);
        let along = |row: usize| {
            let [left, right] = [left, right].map(|column| value(row * self.columns + column));
            left * (1.0 - x) + right * x
        };
        along(front) * (1.0 - z) + along(back) * z
    }

    /// The height of the slope of the whole at a place: the cloth rises and falls about it.
    pub fn plane_m(&self, p: DVec3) -> f64 {
        self.slope[0] * (p.x - self.low[0]) + self.slope[1] * (p.z - self.low[1])
    }

    fn cell(&self, p: DVec3) -> usize {
        let [column, row] = self.place(p);
        row * self.columns + column
    }

    fn take_heights(&mut self, lowest: &[Option<DVec3>]) {
        for (cell, lowest) in lowest.iter().enumerate() {
            self.heights_m[cell] = lowest.map_or(f64::INFINITY, |p| p.y - self.plane_m(p));
        }
    }

    /// The cells beside one that are on the grid.
    fn beside(&self, column: usize, row: usize) -> impl Iterator<Item = usize> {
        let (columns, rows) = (self.columns, self.rows);
        let of = move |(x, y): (isize, isize)| {
            let column = column.checked_add_signed(x).filter(|&column| column < columns)?;
            let row = row.checked_add_signed(y).filter(|&row| row < rows)?;
            Some(row * columns + column)
        };
        [(1, 0), (-1, 0), (0, 1), (0, -1)].into_iter().filter_map(of)
    }

    /// Leaves out single points that are far below all that is beside them: ground that is seen through a gap is more.
    fn drop_strays(&self, points: &[DVec3], lowest: &mut [Option<DVec3>]) {
        let mut company = vec![0_u32; lowest.len()];
        for p in points {
            let cell = self.cell(*p);
            let is_near = lowest[cell].is_some_and(|lowest| p.y < lowest.y + STRAY_M);
            company[cell] += u32::from(is_near);
        }
        for row in 0..self.rows {
            for column in 0..self.columns {
                let cell = row * self.columns + column;
                let beside = self.beside(column, row).map(|cell| self.heights_m[cell]);
                let is_below = self.heights_m[cell] + STRAY_M < beside.fold(f64::INFINITY, f64::min);
                if is_below && company[cell] < COMPANY {
                    lowest[cell] = None;
                }
            }
        }
    }

    /// Of the plane through the lowest points of wide cells (least squares).
    fn slope_of(&self, lowest: &[Option<DVec3>]) -> [f64; 2] {
        let across = self.columns.div_ceil(COARSER);
        let mut wide: Vec<Option<DVec3>> = vec![None; across * self.rows.div_ceil(COARSER)];
        for (cell, p) in lowest.iter().enumerate() {
            let Some(p) = *p else { continue };
            let (column, row) = (cell % self.columns / COARSER, cell / self.columns / COARSER);
            let wide = &mut wide[row * across + column];
            *wide = Some(wide.filter(|wide| wide.y <= p.y).unwrap_or(p));
        }
        let places: Vec<DVec3> = wide.into_iter().flatten().collect();
        Plane::through(&places, ON_A_LINE).map_or([0.0; 2], |plane| plane.slope)
    }

    /// From the lowest points to the cloth that hangs below them.
    fn come_to_rest(&mut self, monitor: &dyn Monitor) -> Result<(), Cancelled> {
        // Where nothing was seen the cloth begins high, and is pulled down by what is around.
        let seen = self.heights_m.iter().copied().filter(|height| height.is_finite());
        let highest = seen.reduce(f64::max).unwrap_or(0.0);
        for height in &mut self.heights_m {
            *height = height.min(highest);
        }
        let sag_m = 0.25 * SAG * self.cell_m * self.cell_m;
        for _ in 0..ROUNDS {
            monitor.check()?;
            let mut moved_m: f64 = 0.0;
            for row in 0..self.rows {
                for column in 0..self.columns {
                    let beside = self.beside(column, row).map(|cell| self.heights_m[cell]);
                    let (sum, count) = beside.fold((0.0, 0.0), |(sum, n), height| (sum + height, n + 1.0));
                    let height = &mut self.heights_m[row * self.columns + column];
                    let hung = if count > 0.0 { sum / count + sag_m } else { *height };
                    moved_m = moved_m.max(*height - hung);
                    *height = height.min(hung);
                }
            }
            if moved_m < REST_M {
                break;
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use linden_base::monitor::Quiet;

    use super::*;

    /// A hill on a slope, in points 0.2 m apart, without those where `hidden` is.
    fn hill(hidden: impl Fn(f64, f64) -> bool) -> Vec<DVec3> {
        let places = (0..200 * 150).map(|i| (0.2 * f64::from(i % 200), 0.2 * f64::from(i / 200)));
        let seen = places.filter(|&(x, z)| !hidden(x, z));
        seen.map(|(x, z)| DVec3::new(x, height(x, z), z)).collect()
    }

    fn height(x: f64, z: f64) -> f64 {
        let off = (x - 25.0) * (x - 25.0) + (z - 12.0) * (z - 12.0);
        100.0 + 0.35 * x - 0.1 * z + 2.0 * libm::exp(-off / 40.0)
    }

    fn farthest_off(cloth: &Cloth, points: &[DVec3]) -> f64 {
        points.iter().map(|p| (cloth.height_m(*p) - p.y).abs()).fold(0.0, f64::max)
    }

    #[test]
    fn the_cloth_lies_on_hills_and_slopes() {
        let points = hill(|_, _| false);
        let cloth = Cloth::under(&points, &Quiet).unwrap();
        // A cell's height is that of its lowest point.
        let off = farthest_off(&cloth, &points);
        assert!(off < 0.5 * CELL_M * 0.8 + 0.1, "{off}");
    }

    #[test]
    fn crowns_and_strays_are_no_ground() {
        // Crowns of 4 m over holes, 3 m up; one point below.
        let is_under = |x: f64, z: f64| {
            let (x, z) = (x % 10.0 - 5.0, z % 10.0 - 5.0);
            x * x + z * z < 4.0
        };
        let mut points = hill(is_under);
        let seen = points.clone();
        points.extend(hill(|x, z| !is_under(x, z)).into_iter().map(|p| p + DVec3::Y * 3.0));
        points.push(DVec3::new(33.0, 80.0, 21.0));
        let cloth = Cloth::under(&points, &Quiet).unwrap();
        let off = farthest_off(&cloth, &seen);
        assert!(off < 0.4, "{off}");
        let hidden = hill(|x, z| !is_under(x, z));
        let off = farthest_off(&cloth, &hidden);
        assert!(off < 0.6, "{off}");
    }

    #[test]
    fn few_points_have_ground() {
        // Too few to be sure of.
        let p = DVec3::new(3.0, 4.0, 5.0);
        assert!(Cloth::under(&[p], &Quiet).unwrap().height_m(p).is_finite());
        let cloth = Cloth::under(&[p, p + 0.1 * DVec3::X, p + 0.1 * DVec3::Z], &Quiet).unwrap();
        assert!((cloth.height_m(p) - 4.0).abs() < 1e-9);
    }
}
