//! Functions on the unit square that continue across its edges: noise and cells.

use linden_base::random::Key;

/// Smooth noise on a lattice whose last column is followed by its first, and rows likewise.
/// Value noise with the quintic fade of Perlin 2002 ("Improving noise").
pub(super) struct Noise {
    across: usize,
    up: usize,
    values: Vec<f32>,
    /// Where the lattice begins. Noise is flattest at lattice points: without this all octaves would
    /// be flat along the square's edges, and the seam would show.
    phase: [f32; 2],
}

impl Noise {
    /// `across × up` lattice points, each at least 1.
    pub(super) fn new(across: u32, up: u32, key: Key) -> Self {
        let values =
            (0..u64::from(across) * u64::from(up)).map(|i| key.child(i).between(-1.0, 1.0) as f32).collect();
        let phase = ["u", "v"].map(|axis| key.named(axis).unit() as f32);
        Self { across: across as usize, up: up as usize, values, phase }
    }

    /// -1..1.
    pub(super) fn at(&self, u: f32, v: f32) -> f32 {
        let (x0, x1, fx) = lattice(u + self.phase[0], self.across);
        let (y0, y1, fy) = lattice(v + self.phase[1], self.up);
        let row = |y: usize| {
            let (a, b) = (self.values[y * self.across + x0], self.values[y * self.across + x1]);
            a + (b - a) * fx
        };
        let (a, b) = (row(y0), row(y1));
        a + (b - a) * fy
    }
}

/// The lattice points around a coordinate of any size, and the faded way between them.
fn lattice(t: f32, n: usize) -> (usize, usize, f32) {
    let t = wrapped(t) * n as f32;
    let below = (t as usize).min(n - 1);
    let f = (t - below as f32).clamp(0.0, 1.0);
    let above = if below + 1 == n { 0 } else { below + 1 };
    (below, above, f * f * f * (f * (f * 6.0 - 15.0) + 10.0))
}

/// The part of a coordinate behind the point, 0..1. Coordinates here stay within some units of the
/// square, so an integer holds the rest; without SSE 4.1 `floor` is a function call.
fn wrapped(t: f32) -> f32 {
    let part = t - t as i32 as f32;
    if part < 0.0 { part + 1.0 } else { part }
}

/// Octaves of noise, each twice as fine and a little more than half as strong.
pub(super) struct Octaves(Vec<(Noise, f32)>);

impl Octaves {
    pub(super) fn new(across: u32, up: u32, octaves: u32, key: Key) -> Self {
        const GAIN: f32 = 0.55;
        let strengths: Vec<f32> =
            std::iter::successors(Some(1.0), |s| Some(s * GAIN)).take(octaves as usize).collect();
        let sum: f32 = strengths.iter().sum();
        let layers = strengths
            .into_iter()
            .enumerate()
            .map(|(i, strength)| (Noise::new(across << i, up << i, key.child(i as u64)), strength / sum));
        Self(layers.collect())
    }

    /// A row of the square at places `(i + 0.5) / n`, each -1..1. Along a row only one coordinate
    /// changes, and between two lattice points nothing but the way: plain loops over pixels, several
    /// times faster than place by place.
    pub(super) fn row(&self, v: f32, n: usize) -> Vec<f32> {
        let mut row = vec![0.0; n];
        for (noise, strength) in &self.0 {
            let (y0, y1, fy) = lattice(v + noise.phase[1], noise.up);
            let line = |y: usize| &noise.values[y * noise.across..][..noise.across];
            let knots: Vec<f32> =
                line(y0).iter().zip(line(y1)).map(|(a, b)| (a + (b - a) * fy) * strength).collect();
            let per_pixel = noise.across as f32 / n as f32;
            let first = (0.5 * per_pixel + noise.phase[0] * noise.across as f32).max(0.0);
            let mut from = 0;
            for knot in first as usize.. {
                if from == n {
                    break;
                }
                // Where the next knot's part begins. Rounding may move it by a pixel, where the way is
                // all but 0 or 1: both sides agree there.
                let end = ((knot + 1) as f32 - first) / per_pixel;
                let to = (end.ceil().max(0.0) as usize).clamp(from, n);
                let (a, b) = (knots[knot % noise.across], knots[(knot + 1) % noise.across]);
                let start = first - knot as f32;
                for (i, sum) in row[from..to].iter_mut().enumerate() {
                    let f = (start + (from + i) as f32 * per_pixel).clamp(0.0, 1.0);
                    *sum += a + (b - a) * (f * f * f * (f * (f * 6.0 - 15.0) + 10.0));
                }
                from = to;
            }
        }
        row
    }
}

/// Voronoi cells of one jittered point per place of a grid (Worley 1996, "A cellular texture basis
/// function"), wrapped. Cells are as elongated as the grid's places.
pub(super) struct Cells {
    across: usize,
    up: usize,
    /// The points' coordinates in units of the grid, with a rim of [`REACH`] repeated places around,
    /// so that no neighbourhood needs to be wrapped.
    x: Vec<f32>,
    y: Vec<f32>,
    /// Where the grid begins: borders gather along its lines, which need not be the square's edges.
    phase: [f32; 2],
}

/// How many places away the nearest point and its neighbours are looked for.
const REACH: usize = 2;
/// Places along one side of a neighbourhood.
const SIDE: usize = 2 * REACH + 1;

/// A place among the cells.
pub(super) struct Cell {
    /// Which cell.
    pub index: usize,
    /// To the cell's border, in units of the square's side.
    pub border: f32,
    /// From the cell's point, in units of the grid.
    pub offset: [f32; 2],
}

impl Cells {
    /// `jitter` 0 is a regular grid, 1 takes points from all of their place.
    pub(super) fn new(across: u32, up: u32, jitter: f64, key: Key) -> Self {
        let point = |i: u64| {
            let place = key.child(i);
            ["u", "v"].map(|axis| 0.5 + jitter * (place.named(axis).unit() - 0.5))
        };
        let (across, up) = (i64::from(across), i64::from(up));
        let rim = REACH as i64;
        let places = (-rim..up + rim).flat_map(|j| (-rim..across + rim).map(move |i| (i, j)));
        let (x, y) = places
            .map(|(i, j)| {
                let [x, y] = point((j.rem_euclid(up) * across + i.rem_euclid(across)) as u64);
                ((i as f64 + x) as f32, (j as f64 + y) as f32)
            })
            .unzip();
        let phase = ["u", "v"].map(|axis| key.named(axis).unit() as f32);
        Self { across: across as usize, up: up as usize, x, y, phase }
    }

    pub(super) fn len(&self) -> usize {
        self.across * self.up
    }

    /// The cell at a place. Its border is the bisector to the neighbour, measured at right angles in
    /// the square and not in the grid: furrows are as wide beside a long cell as at its ends.
    pub(super) fn at(&self, u: f32, v: f32) -> Cell {
        let (across, up) = (self.across as f32, self.up as f32);
        let (x, y) = (wrapped(u + self.phase[0]) * across, wrapped(v + self.phase[1]) * up);
        let (column, row) = ((x as usize).min(self.across - 1), (y as usize).min(self.up - 1));
        let stride = self.across + 2 * REACH;
        // Plain arrays and no branches: these loops become vector instructions.
        let (mut dx, mut dy, mut squared) =
            ([0.0_f32; SIDE * SIDE], [0.0_f32; SIDE * SIDE], [0.0_f32; SIDE * SIDE]);
        for j in 0..SIDE {
            let start = (row + j) * stride + column;
            for (to, from) in dx[j * SIDE..][..SIDE].iter_mut().zip(&self.x[start..start + SIDE]) {
                *to = from - x;
            }
            for (to, from) in dy[j * SIDE..][..SIDE].iter_mut().zip(&self.y[start..start + SIDE]) {
                *to = from - y;
            }
        }
        for k in 0..SIDE * SIDE {
            squared[k] = dx[k] * dx[k] + dy[k] * dy[k];
        }
        let (mut nearest, mut least) = (0, f32::INFINITY);
        for (k, &d) in squared.iter().enumerate() {
            (nearest, least) = if d < least { (k, d) } else { (nearest, least) };
        }
        let to_nearest = [dx[nearest], dy[nearest]];
        let mut away = [0.0_f32; SIDE * SIDE];
        for k in 0..SIDE * SIDE {
            // Half the difference of squares is the distance to the bisector times the way between
            // the points; its gradient in the square is (across way.x, up way.y).
            let difference = 0.5 * (squared[k] - least);
            let (gx, gy) = ((dx[k] - to_nearest[0]) * across, (dy[k] - to_nearest[1]) * up);
            away[k] = difference * difference / (gx * gx + gy * gy);
        }
        // The cell's own entry is 0 / 0.
        away[nearest] = f32::INFINITY;
        let border = away.iter().fold(f32::INFINITY, |a, &b| if b < a { b } else { a });
        let (i, j) = (column + nearest % SIDE, row + nearest / SIDE);
        let wrap = |at: usize, n: usize| (at + n * REACH - REACH) % n;
        let index = wrap(j, self.up) * self.across + wrap(i, self.across);
        Cell { index, border: border.sqrt(), offset: [-to_nearest[0], -to_nearest[1]] }
    }
}

/// 0 below `from`, 1 above `to`, smooth between.
pub(super) fn smoothstep(from: f32, to: f32, x: f32) -> f32 {
    let t = ((x - from) / (to - from)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_continue_across_the_edges() {
        let key = Key::new(3);
        let (noise, cells) = (Noise::new(6, 5, key), Cells::new(5, 4, 0.8, key));
        for i in 0..200 {
            let t = i as f32 / 200.0;
            let e = 1e-4;
            for ([a, b], [c, d]) in [([e, t], [1.0 - e, t]), ([t, e], [t, 1.0 - e])] {
                assert!((noise.at(a, b) - noise.at(c, d)).abs() < 0.01, "{t}");
                assert!((cells.at(a, b).border - cells.at(c, d).border).abs() < 1e-3, "{t}");
            }
            let (here, turned) = (noise.at(t, 0.25), noise.at(t + 1.0, 1.25 - 2.0));
            assert!((here - turned).abs() < 1e-5, "{t}: {here} {turned}");
        }
    }

    #[test]
    fn a_row_is_the_octaves_place_by_place() {
        let octaves = Octaves::new(3, 2, 4, Key::new(5));
        for v in [0.0, 0.31, 0.999] {
            for (i, found) in octaves.row(v, 50).into_iter().enumerate() {
                let u = (i as f32 + 0.5) / 50.0;
                let expected: f32 = octaves.0.iter().map(|(noise, s)| noise.at(u, v) * s).sum();
                assert!((found - expected).abs() < 1e-5, "{u} {v}: {found} {expected}");
            }
        }
    }

    #[test]
    fn borders_are_where_the_nearest_point_changes() {
        // By brute force over all points and their copies: walking from a place by less than its
        // border's distance, in any direction, stays in the cell; by a little more, it can leave.
        let cells = Cells::new(4, 3, 0.7, Key::new(9));
        let nearest = |u: f32, v: f32| {
            let (u, v) = (wrapped(u + cells.phase[0]), wrapped(v + cells.phase[1]));
            let mut best = (f32::INFINITY, 0);
            for i in 0..cells.len() {
                let inner = (i / 4 + REACH) * (4 + 2 * REACH) + i % 4 + REACH;
                for (du, dv) in (-1..=1).flat_map(|a| (-1..=1).map(move |b| (a as f32, b as f32))) {
                    let x = cells.x[inner] + 4.0 * du - u * 4.0;
                    let y = cells.y[inner] + 3.0 * dv - v * 3.0;
                    best = if x * x + y * y < best.0 { (x * x + y * y, i) } else { best };
                }
            }
            best.1
        };
        for i in 0..300 {
            let (u, v) = ((i as f32 * 0.618_034).fract(), (i as f32 * 0.754_877_7).fract());
            let cell = cells.at(u, v);
            assert_eq!(cell.index, nearest(u, v));
            let leaves = |share: f32| {
                (0..90).any(|k| {
                    let (s, c) = libm::sincosf((k * 4) as f32 * std::f32::consts::PI / 180.0);
                    nearest(u + c * cell.border * share, v + s * cell.border * share) != cell.index
                })
            };
            assert!(!leaves(0.98) && leaves(1.02), "{u} {v}");
        }
    }
}
