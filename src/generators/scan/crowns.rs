//! Trees of a grid of canopy heights: their tops, the cells of their crowns, and points that fill these.
//!
//! A top is the highest cell within half a crown's width of it, which follows from its height (Popescu & Wynne 2004,
//! Photogrammetric Engineering & Remote Sensing 70(5), equation for all species). From the tops crowns grow down over the
//! neighbouring cells, the highest first (a watershed, Meyer 1994), as far as the cells are higher than a part of the top
//! (Dalponte & Coomes 2016, Methods in Ecology and Evolution 7(10)) and no farther than a crown is wide.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use glam::{DVec3, IVec2};
use linden_base::input::TreeColumn;
use linden_base::random::Key;

/// The column's name: the numbers are by height, the tallest tree is 1.
const COLUMN: &str = "crown";

/// What is lower is no tree, metres.
const LEAST_TREE_M: f64 = 2.0;

/// A crown ends where the canopy is lower than this part of its top.
const CROWN_PER_TOP: f64 = 0.45;

/// Crowns begin at this part of a tree's height, where nothing says how long trunks are.
pub(crate) const BASE_PER_TOP: f64 = 0.4;

/// No tree is higher, metres: what is, is a height above the sea.
const HIGHEST_M: f64 = 130.0;

/// Points that fill one crown, about: as many as crowns of presets have.
const POINTS: f64 = 4000.0;

/// The width of a crown by its tree's height, metres.
fn crown_width_m(height_m: f64) -> f64 {
    2.51503 + 0.00901 * height_m * height_m
}

/// Heights by their places on a grid.
struct Grid {
    low: DVec3,
    cell: f64,
    columns: i32,
    rows: i32,
    /// The point of each cell.
    points: Vec<Option<u32>>,
}

impl Grid {
    fn new(positions: &[DVec3], cell: f64) -> Self {
        let low = positions.iter().copied().reduce(DVec3::min).unwrap_or_default();
        let high = positions.iter().copied().reduce(DVec3::max).unwrap_or_default();
        let count = |axis: usize| libm::round((high[axis] - low[axis]) / cell) as i32 + 1;
        let (columns, rows) = (count(0), count(1));
        let mut grid =
            Self { low, cell, columns, rows, points: vec![None; columns as usize * rows as usize] };
        for (point, &position) in (0..).zip(positions) {
            if let Some(index) = grid.index(grid.place(position)) {
                grid.points[index] = Some(point);
            }
        }
        grid
    }

    fn place(&self, position: DVec3) -> IVec2 {
        let at = (position - self.low) / self.cell;
        IVec2::new(libm::round(at.x) as i32, libm::round(at.y) as i32)
    }

    fn index(&self, place: IVec2) -> Option<usize> {
        let is_within = (0..self.columns).contains(&place.x) && (0..self.rows).contains(&place.y);
        is_within.then(|| place.y as usize * self.columns as usize + place.x as usize)
    }

    fn point(&self, place: IVec2) -> Option<usize> {
        self.points[self.index(place)?].map(|point| point as usize)
    }

    /// Cells within a distance of a place, itself among them.
    fn around(&self, place: IVec2, reach: f64) -> impl Iterator<Item = usize> + '_ {
        let cells = (reach as i32).min(self.columns.max(self.rows));
        let within = move |at: &IVec2| f64::from(at.length_squared()) <= reach * reach;
        let square = (-cells..=cells).flat_map(move |y| (-cells..=cells).map(move |x| IVec2::new(x, y)));
        square.filter(within).filter_map(move |at| self.point(place + at))
    }
}

/// A cell that a crown may grow to: the highest first, among equals the one that was found first.
struct Edge {
    height: f64,
    order: u32,
    point: usize,
    tree: u32,
}

impl Ord for Edge {
    fn cmp(&self, other: &Self) -> Ordering {
        self.height.total_cmp(&other.height).then(other.order.cmp(&self.order))
    }
}

impl PartialOrd for Edge {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Edge {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Edge {}

/// Tells the trees of a grid of heights (Z up, metres times `1 / scale`) apart; what is wrong with it.
pub(crate) fn tell_apart(positions: &[DVec3], cell: f64, scale: f64) -> Result<TreeColumn, String> {
    let height_m = |point: usize| positions[point].z * scale;
    let highest_m = positions.iter().map(|p| p.z * scale).fold(0.0, f64::max);
    if highest_m > HIGHEST_M {
        return Err(format!(
            "it has heights of {highest_m:.0} m, as of a surface above the sea, or of a canopy in centimetres or feet; a model of \
             the canopy has heights above ground in metres (gdal_calc.py --calc \"A/100.0\" makes them of centimetres)"
        ));
    }
    let grid = Grid::new(positions, cell);
    let cell_m = cell * scale;
    // Single cells stick out by accident: tops are looked for on the means of nine.
    let smooth: Vec<f64> = (0..positions.len())
        .map(|point| {
            let near = grid.around(grid.place(positions[point]), 1.5).map(height_m);
            let (sum, count) = near.fold((0.0, 0.0), |(sum, count), height| (sum + height, count + 1.0));
            sum / count
        })
        .collect();
    let is_below = |a: usize, b: usize| smooth[a].total_cmp(&smooth[b]).then(b.cmp(&a)) == Ordering::Less;
    let is_top = |&point: &usize| {
        let place = grid.place(positions[point]);
        let highest =
            |reach: f64| grid.around(place, reach).all(|other| other == point || is_below(other, point));
        smooth[point] >= LEAST_TREE_M && highest(1.5) && highest(0.5 * crown_width_m(smooth[point]) / cell_m)
    };
    let mut tops: Vec<usize> = (0..positions.len()).filter(is_top).collect();
    tops.sort_by(|&a, &b| smooth[b].total_cmp(&smooth[a]).then(a.cmp(&b)));
    let mut numbers = vec![0_u32; positions.len()];
    let mut edges = BinaryHeap::new();
    for (tree, &top) in (1..).zip(&tops) {
        edges.push(Edge { height: f64::INFINITY, order: tree, point: top, tree });
    }
    let mut order = tops.len() as u32;
    while let Some(Edge { point, tree, .. }) = edges.pop() {
        if numbers[point] != 0 {
            continue;
        }
        numbers[point] = tree;
        let top = tops[tree as usize - 1];
        let reach_m = crown_width_m(smooth[top]);
        for other in grid.around(grid.place(positions[point]), 1.0) {
            let away_m = (positions[other] - positions[top]).truncate().length() * scale;
            let is_crown =
                height_m(other) >= (CROWN_PER_TOP * smooth[top]).max(LEAST_TREE_M) && away_m <= reach_m;
            if numbers[other] == 0 && is_crown {
                order += 1;
                edges.push(Edge { height: smooth[other], order, point: other, tree });
            }
        }
    }
    Ok(TreeColumn { name: COLUMN.to_owned(), numbers })
}

/// Points that fill the space below some cells, from `base` up (Z up, all in the file's units).
pub(crate) fn filled(cells: &[DVec3], cell: f64, base: f64) -> Vec<DVec3> {
    let grid = Grid::new(cells, cell);
    let volume: f64 = cells.iter().map(|p| cell * cell * (p.z - base).max(0.0)).sum();
    let each = volume / POINTS;
    let steps = libm::round(cell / libm::cbrt(each)).clamp(1.0, 1000.0) as i32;
    let spacing = each / (cell / f64::from(steps)) / (cell / f64::from(steps));
    let mut points = Vec::new();
    for (at, &middle) in (0..).zip(cells) {
        let place = grid.place(middle);
        let height =
            |x: i32, y: i32| grid.point(place + IVec2::new(x, y)).map_or(middle.z, |point| cells[point].z);
        for column in 0..steps * steps {
            // No lattice: where pulls cancel nothing grows.
            let key = Key::new(at).named("crown").child(column as u64);
            let within =
                |step: i32, name| (f64::from(step) + key.named(name).unit()) / f64::from(steps) - 0.5;
            let (x, y) = (within(column % steps, "x"), within(column / steps, "y"));
            // Between the middles of the four nearest cells.
            let (beside_x, beside_y) = (if x < 0.0 { -1 } else { 1 }, if y < 0.0 { -1 } else { 1 });
            let (share_x, share_y) = (x.abs(), y.abs());
            let near = height(0, 0) * (1.0 - share_x) + height(beside_x, 0) * share_x;
            let far = height(0, beside_y) * (1.0 - share_x) + height(beside_x, beside_y) * share_x;
            let top = near * (1.0 - share_y) + far * share_y;
            let count = libm::round((top - base) / spacing).max(1.0) as u64;
            for level in (0..count).filter(|_| top > base) {
                let up = (level as f64 + key.named("z").child(level).unit()) * spacing;
                points.push(DVec3::new(middle.x + x * cell, middle.y + y * cell, (base + up).min(top)));
            }
        }
    }
    points
}

/// A canopy's cells are not all higher than this above its ground, metres, and than the canopy is deep: there are gaps and rims.
const HIGHEST_RIM_M: f64 = 10.0;

/// What is said of heights that seem to have the terrain in them.
pub(crate) fn terrain_note(positions: &[DVec3], scale: f64) -> Option<String> {
    let heights_m = || positions.iter().map(|p| p.z * scale);
    let (least_m, most_m) =
        (heights_m().fold(f64::INFINITY, f64::min), heights_m().fold(f64::NEG_INFINITY, f64::max));
    (least_m > HIGHEST_RIM_M && least_m > most_m - least_m && most_m.is_finite()).then(|| {
        format!(
            "no cell of it is lower than {least_m:.0} m and the highest is {most_m:.0} m: these seem to be heights above the sea, as of a \
             model of the surface, and trees come out too high; take the terrain off (gdal_calc.py -A surface.tif -B terrain.tif \
             --calc \"A-B\" --outfile canopy.tif)"
        )
    })
}

/// What is said of a crown that was filled.
pub(crate) fn note(top_m: f64, base_m: f64) -> String {
    format!(
        "heights of a canopy show no stem: the crown was filled from {base_m:.1} m up to {top_m:.1} m, and the tree stands \
         below its middle; trunk=M says where crowns begin"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Paraboloids of a width in metres on level ground, on cells of half a metre.
    fn canopy(trees: &[([f64; 2], f64, f64)]) -> Vec<DVec3> {
        (0..80 * 60)
            .map(|i| {
                let (x, y) = (0.5 * f64::from(i % 80), 0.5 * f64::from(i / 80));
                let height = |([at_x, at_y], height, width): &([f64; 2], f64, f64)| {
                    let r = libm::hypot(x - at_x, y - at_y) / (0.5 * width);
                    height * (1.0 - 0.5 * r * r) * f64::from(u8::from(r <= 1.0))
                };
                DVec3::new(x, y, trees.iter().map(height).fold(0.0, f64::max))
            })
            .collect()
    }

    #[test]
    fn each_dome_is_a_tree_and_the_ground_is_none() {
        let trees = [([10.0, 10.0], 20.0, 7.0), ([16.5, 10.0], 15.0, 6.0), ([30.0, 20.0], 24.0, 8.0)];
        let cells = canopy(&trees);
        let column = tell_apart(&cells, 0.5, 1.0).unwrap();
        // The tallest is the first.
        let expected = [trees[2], trees[0], trees[1]];
        assert_eq!(column.counts().len(), 3);
        for ((number, count), (at, height, width)) in column.counts().into_iter().zip(expected) {
            let own: Vec<DVec3> =
                cells.iter().zip(&column.numbers).filter(|(_, n)| **n == number).map(|(p, _)| *p).collect();
            let middle = own.iter().sum::<DVec3>() / count as f64;
            assert!(libm::hypot(middle.x - at[0], middle.y - at[1]) < 0.6, "{number}: {middle}");
            assert!((own.iter().map(|p| p.z).fold(0.0, f64::max) - height).abs() < 0.1);
            let area = 0.25 * count as f64 / (std::f64::consts::PI * 0.25 * width * width);
            assert!((0.85..1.1).contains(&area), "{number}: {area}");
        }
        // The same in centimetres.
        let centimetres: Vec<DVec3> = cells.iter().map(|p| *p * 100.0).collect();
        assert_eq!(tell_apart(&centimetres, 50.0, 0.01).unwrap(), column);
        let high: Vec<DVec3> = cells.iter().map(|p| *p + 400.0 * DVec3::Z).collect();
        assert!(tell_apart(&high, 0.5, 1.0).unwrap_err().contains("above the sea"));
        assert!(tell_apart(&canopy(&[]), 0.5, 1.0).unwrap().counts().is_empty());
    }

    #[test]
    fn terrain_in_heights_is_noticed() {
        let cells = canopy(&[([10.0, 10.0], 20.0, 7.0), ([16.5, 10.0], 15.0, 6.0)]);
        let raised = |by: f64| cells.iter().map(|p| *p + by * DVec3::Z).collect::<Vec<DVec3>>();
        assert_eq!(terrain_note(&raised(0.0), 1.0), None);
        // Below the limit of what is refused.
        assert!(terrain_note(&raised(95.0), 1.0).unwrap().contains("lower than 95 m"));
        // A crown that was cut out has a rim.
        let cut: Vec<DVec3> = cells.iter().copied().filter(|p| p.z > 9.0).collect();
        assert_eq!(terrain_note(&cut, 1.0), None);
        assert_eq!(terrain_note(&[], 1.0), None);
    }

    #[test]
    fn points_fill_the_space_between_base_and_canopy() {
        let ([x, y], height, width) = ([20.0, 15.0], 20.0, 8.0);
        let cells: Vec<DVec3> =
            canopy(&[([x, y], height, width)]).into_iter().filter(|p| p.z > 0.0).collect();
        let points = filled(&cells, 0.5, 8.0);
        assert!((3600..4400).contains(&points.len()), "{}", points.len());
        for p in &points {
            let r = libm::hypot(p.x - x, p.y - y) / (0.5 * width);
            let top = height * (1.0 - 0.5 * r * r);
            // At the rim a cell is level, where the paraboloid falls 5 m a metre over half a diagonal.
            assert!(p.z >= 8.0 && p.z <= top + 1.8 && r < 1.15, "{p} below {top}");
        }
        // As many below as above half of the space of a paraboloid over its base.
        let density = |from: f64, to: f64| {
            let radius = |z: f64| (0.5 * width) * libm::sqrt((2.0 * (1.0 - z / height)).clamp(0.0, 1.0));
            let volume: f64 = (0..100)
                .map(|i| from + (to - from) * (f64::from(i) + 0.5) / 100.0)
                .map(|z| std::f64::consts::PI * radius(z) * radius(z) * (to - from) / 100.0)
                .sum();
            points.iter().filter(|p| p.z >= from && p.z < to).count() as f64 / volume
        };
        let ratio = density(8.5, 12.0) / density(12.0, 17.0);
        assert!((0.9..1.1).contains(&ratio), "{ratio}");
    }
}
