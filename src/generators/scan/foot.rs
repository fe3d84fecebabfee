//! Where a scanned stem leaves the ground.
//!
//! The lowest point is no answer: there are stray points below, ground around, and branches that hang
//! lower than the visible stem. A stem is the column that goes on upward: the way through level
//! layers, leaning by one cell per layer at most, that meets the most wood.

use glam::DVec3;

use super::ground::ground_height;
use super::median::median;

/// The stem's foot, and what is not the tree.
#[derive(Clone, Copy)]
pub(super) struct Foot {
    /// In the middle of the stem, at the height of its lowest points.
    pub root: DVec3,
    /// A radius that certainly holds the stem's foot.
    pub radius_m: f64,
    /// Height above the root up to which points away from the stem count as ground.
    pub ground_m: f64,
    /// Points below are strays.
    pub floor_m: f64,
    /// From the root to the top; strays above do not count.
    pub height_m: f64,
    /// Whether the root is on ground that was seen.
    pub is_on_ground: bool,
    /// How far above that the lowest points of the stem are, metres.
    pub hidden_m: f64,
}

/// Layers over the height of the cloud; only the lower ones are searched for the stem.
const LAYERS: usize = 50;
const SEARCHED: usize = 30;

/// The width of a cell, as a part of the height: stems are 1 % to 4 % of it thick.
const CELL: f64 = 0.03;

/// At most this many cells along either level axis, whatever the shape of the cloud.
const CELLS: f64 = 256.0;

impl Foot {
    /// `points` holds at least one point; all are finite, Y up.
    pub fn find(points: &[DVec3]) -> Self {
        let mut heights: Vec<f64> = points.iter().map(|p| p.y).collect();
        heights.sort_unstable_by(f64::total_cmp);
        // Five stray points in a thousand must not stretch the layers.
        let stray = heights.len() / 200;
        let (bottom, top) = (heights[stray.min(heights.len() / 2)], heights[heights.len() - 1 - stray]);
        let layer_m = (top - bottom).max(f64::MIN_POSITIVE) / LAYERS as f64;
        let grid = Columns::new(points, bottom - layer_m, layer_m);
        let way = grid.stem();
        // The stem starts where the way first meets as much wood as half of the median further up.
        let mut wood: Vec<f32> = way.iter().map(|&(_, wood)| wood).filter(|&wood| wood > 0.0).collect();
        wood.sort_unstable_by(f32::total_cmp);
        let enough = wood.get(wood.len() / 2).map_or(0.0, |median| 0.5 * median);
        let first = way.iter().position(|&(_, wood)| wood >= enough && wood > 0.0).unwrap_or(0);
        let centre = grid.centre(way[first].0);
        let is_near = |p: &DVec3| (p.x - centre.0).abs().max((p.z - centre.1).abs()) <= 1.5 * grid.cell_m;
        let from_layer = |n: f64| grid.bottom + layer_m * (first as f64 + n);
        let (low, high) = (from_layer(-1.0), from_layer(3.0));
        let stem: Vec<DVec3> =
            points.iter().copied().filter(|p| (low..high).contains(&p.y) && is_near(p)).collect();
        let foot_m = stem.iter().map(|p| p.y).fold(f64::INFINITY, f64::min);
        let foot_m = if foot_m.is_finite() { foot_m } else { bottom };
        let root = DVec3::new(
            median(stem.iter().map(|p| p.x)).unwrap_or(centre.0),
            foot_m,
            median(stem.iter().map(|p| p.z)).unwrap_or(centre.1),
        );
        // Above the lowest layer there is bark and no ground: the median distance is the stem's radius, a
        // little more where it leans. Twice that leaves room for roots.
        let away = |p: &DVec3| DVec3::new(p.x - root.x, 0.0, p.z - root.z).length();
        let bark = median(stem.iter().filter(|p| p.y > foot_m + layer_m).map(away));
        let widest = 1.5 * grid.cell_m;
        let radius_m = bark.map_or(widest, |radius| (2.0 * radius).clamp(0.1 * widest, widest));
        let (ground_m, floor_m, height_m) = (2.0 * layer_m, foot_m - layer_m, top - foot_m);
        Self { root, radius_m, ground_m, floor_m, height_m, is_on_ground: false, hidden_m: 0.0 }
    }

    /// The same foot on the ground that points show around it, where they do.
    pub fn on_ground(self, ground: &[DVec3]) -> Self {
        let Some(height) = ground_height(ground, self.root) else { return self };
        let by = height - self.root.y;
        let root = self.root.with_y(height);
        let (floor_m, height_m) = (self.floor_m + by, self.height_m - by);
        Self { root, floor_m, height_m, is_on_ground: true, hidden_m: (self.hidden_m - by).max(0.0), ..self }
    }

    /// The same foot as high at another place.
    pub fn moved_below(self, place: DVec3) -> Self {
        Self { root: place.with_y(self.root.y), ..self }
    }

    /// Whether a point belongs to the ground or below it rather than to the tree.
    pub fn is_ground(&self, p: DVec3) -> bool {
        let away = DVec3::new(p.x - self.root.x, 0.0, p.z - self.root.z).length() > self.radius_m;
        p.y < self.floor_m || (away && p.y < self.root.y + self.ground_m)
    }
}

/// How much wood stands in each cell of each of the lower layers.
struct Columns {
    min: (f64, f64),
    cell_m: f64,
    bottom: f64,
    across: (usize, usize),
    /// Square roots of point counts: a thick stem weighs more than a twig, and a dense crown
    /// not as much as all stems.
    wood: Vec<f32>,
}

impl Columns {
    fn new(points: &[DVec3], bottom: f64, layer_m: f64) -> Self {
        let low = points.iter().copied().fold(DVec3::INFINITY, DVec3::min);
        let high = points.iter().copied().fold(DVec3::NEG_INFINITY, DVec3::max);
        let width = (high.x - low.x).max(high.z - low.z);
        let cell_m = (CELL * layer_m * LAYERS as f64).max(width / CELLS).max(f64::MIN_POSITIVE);
        let cells = |from: f64, to: f64| ((to - from) / cell_m) as usize + 1;
        let across = (cells(low.x, high.x), cells(low.z, high.z));
        let mut wood = vec![0.0; across.0 * across.1 * SEARCHED];
        for p in points {
            let layer = (p.y - bottom) / layer_m;
            if layer >= 0.0 && layer < SEARCHED as f64 {
                let cell = (((p.x - low.x) / cell_m) as usize, ((p.z - low.z) / cell_m) as usize);
                wood[(layer as usize * across.0 + cell.0.min(across.0 - 1)) * across.1
                    + cell.1.min(across.1 - 1)] += 1.0;
            }
        }
        for count in &mut wood {
            *count = f32::sqrt(*count);
        }
        Self { min: (low.x, low.z), cell_m, bottom, across, wood }
    }

    fn layer<'a>(&self, of: &'a [f32], layer: usize) -> &'a [f32] {
        let size = self.across.0 * self.across.1;
        &of[layer * size..(layer + 1) * size]
    }

    /// The best way from the lowest layer up: its cell and wood in each layer. Dynamic programming
    /// from above.
    fn stem(&self) -> Vec<(usize, f32)> {
        let size = self.across.0 * self.across.1;
        let mut best = self.wood.clone();
        for layer in (0..SEARCHED - 1).rev() {
            let (below, above) = best.split_at_mut((layer + 1) * size);
            let below = &mut below[layer * size..];
            for (cell, total) in below.iter_mut().enumerate() {
                let over = self.around(cell).map(|next| above[next]).fold(0.0, f32::max);
                *total += over;
            }
        }
        let most = |cells: &mut dyn Iterator<Item = usize>, totals: &[f32]| {
            // The first of equals: deterministic.
            cells
                .fold((0, -1.0), |most, cell| if totals[cell] > most.1 { (cell, totals[cell]) } else { most })
                .0
        };
        let mut cell = most(&mut (0..size), self.layer(&best, 0));
        let mut way = vec![(cell, self.layer(&self.wood, 0)[cell])];
        for layer in 1..SEARCHED {
            cell = most(&mut self.around(cell), self.layer(&best, layer));
            way.push((cell, self.layer(&self.wood, layer)[cell]));
        }
        way
    }

    /// The cell itself first, then its neighbours.
    fn around(&self, cell: usize) -> impl Iterator<Item = usize> + use<> {
        let (nx, nz) = self.across;
        let (x, z) = (cell / nz, cell % nz);
        let near = |at: usize, n: usize| at.saturating_sub(1)..=(at + 1).min(n - 1);
        std::iter::once(cell).chain(near(x, nx).flat_map(move |x| near(z, nz).map(move |z| x * nz + z)))
    }

    /// The middle of a cell: x, z.
    fn centre(&self, cell: usize) -> (f64, f64) {
        let (x, z) = (cell / self.across.1, cell % self.across.1);
        (self.min.0 + (x as f64 + 0.5) * self.cell_m, self.min.1 + (z as f64 + 0.5) * self.cell_m)
    }
}
