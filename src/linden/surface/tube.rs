//! From rings to triangles: bands between rings, a pointed tip, a flat base.

use std::f32::consts::{FRAC_1_SQRT_2, PI, TAU};

use glam::{Vec2, Vec3};

use super::path::Ring;

/// Side counts that rings take. Few distinct ones, so that neighbouring rings mostly agree.
const SIDES: [u32; 14] = [3, 4, 5, 6, 8, 10, 12, 16, 20, 24, 32, 48, 64, 128];

/// How many sides a radius deserves, and the circles with so many: equal absolute deviation from the
/// circle on thick and thin wood, set by the sides of the thickest.
#[derive(Clone, Debug)]
pub(super) struct Roundness(Vec<Circle>);

#[derive(Clone, Debug)]
struct Circle {
    /// Thicker rings deviate too far from it.
    largest_radius_m: f32,
    /// Unit vectors `(cos, sin)` at equal angles, the first one again at the end: the seam.
    corners: Vec<(f32, f32)>,
}

impl Roundness {
    pub(super) fn new(sides: u32, thickest_m: f32) -> Self {
        // Between circle and polygon, in radii.
        let sagitta = |sides: u32| 1.0 - libm::cosf(PI / sides as f32);
        let circle = |n: u32| Circle {
            // The last one takes whatever is left, however it was rounded.
            largest_radius_m: if n == sides {
                f32::INFINITY
            } else {
                thickest_m * sagitta(sides) / sagitta(n)
            },
            corners: (0..=n)
                .map(|k| {
                    let (sin, cos) = libm::sincosf(TAU * (k % n) as f32 / n as f32);
                    (cos, sin)
                })
                .collect(),
        };
        Self(SIDES.into_iter().filter(|&n| n < sides).chain([sides]).map(circle).collect())
    }

    fn circle(&self, radius_m: f32) -> &[(f32, f32)] {
        let enough = self.0.iter().find(|circle| radius_m <= circle.largest_radius_m);
        enough.map_or(&[], |circle| &circle.corners)
    }
}

/// How much a piece of surface is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Amount {
    /// Vertices.
    pub vertices: usize,
    /// Triangles.
    pub triangles: usize,
}

/// Where a tube is written: slices of exactly its [`Amount`].
pub(super) struct Target<'a> {
    pub positions: &'a mut [Vec3],
    pub normals: &'a mut [Vec3],
    pub uvs: &'a mut [Vec2],
    pub triangles: &'a mut [[u32; 3]],
    /// Index of the slices' first vertex in the whole mesh.
    pub first: u32,
    pub done: Amount,
}

impl Target<'_> {
    /// Index of the next vertex.
    fn next(&self) -> u32 {
        self.first + self.done.vertices as u32
    }

    fn vertex(&mut self, position: Vec3, normal: Vec3, uv: Vec2) {
        let i = self.done.vertices;
        self.positions[i] = position;
        self.normals[i] = normal;
        self.uvs[i] = uv;
        self.done.vertices = i + 1;
    }

    fn triangle(&mut self, corners: [u32; 3]) {
        self.triangles[self.done.triangles] = corners;
        self.done.triangles += 1;
    }
}

/// A ring as it stands in the mesh.
struct Placed {
    /// Index of the vertex at angle 0; `sides + 1` vertices follow, the last one closes the seam.
    first: u32,
    sides: u32,
}

/// Pictures round the girth between two rings. They follow the radius; where their number changes,
/// the ring stands twice, with the coordinates of either side.
fn band_wraps(ring: &Ring, next: &Ring, tile_m: f32) -> f32 {
    wraps(f32::midpoint(ring.radius, next.radius), tile_m)
}

/// How much [`sweep`] writes for the same rings.
pub(super) fn amount(rings: &[Ring], roundness: &Roundness, tile_m: f32) -> Amount {
    let (Some(base), Some(apex)) = (rings.first(), rings.last()) else { return Amount::default() };
    let sides = |ring: &Ring| roundness.circle(ring.radius).len() - 1;
    // The base's disc and the tip's points have vertices of their own.
    let (base, tip) = (sides(base), sides(apex));
    let mut amount = Amount { vertices: base + tip, triangles: base - 2 + tip };
    let mut before = None;
    for pair in rings.windows(2) {
        let wraps = band_wraps(&pair[0], &pair[1], tile_m);
        let (bottom, top) = (sides(&pair[0]), sides(&pair[1]));
        if before != Some(wraps) {
            amount.vertices += bottom + 1;
        }
        amount.vertices += top + 1;
        amount.triangles += bottom + top;
        before = Some(wraps);
    }
    amount
}

/// Writes the tube over some rings (none or at least two).
pub(super) fn sweep(rings: &[Ring], roundness: &Roundness, tile_m: f32, target: &mut Target<'_>) {
    let (Some(base), Some(apex)) = (rings.first(), rings.last()) else { return };
    close_base(base, roundness.circle(base.radius), tile_m, target);
    let mut below: Option<(Placed, f32)> = None;
    for (i, pair) in rings.windows(2).enumerate() {
        let (ring, next) = (&pair[0], &pair[1]);
        let wraps = band_wraps(ring, next, tile_m);
        let bottom = match below.take() {
            Some((placed, same)) if same == wraps => placed,
            _ => place(ring, slope(rings, i), roundness.circle(ring.radius), wraps, tile_m, target),
        };
        let top = place(next, slope(rings, i + 1), roundness.circle(next.radius), wraps, tile_m, target);
        join(&bottom, &top, target);
        below = Some((top, wraps));
    }
    if let Some((rim, wraps)) = below {
        close_tip(apex, &rim, wraps, tile_m, target);
    }
}

/// Pictures round the girth: a whole number, below one a power of two.
fn wraps(radius_m: f32, tile_m: f32) -> f32 {
    let exact = TAU * radius_m / tile_m;
    if exact >= 1.0 {
        return exact.round();
    }
    let mut fraction = 1.0;
    // The geometric middle between neighbours; 2^-20 of a picture is less than a texel.
    while exact < fraction * FRAC_1_SQRT_2 && fraction > 1e-6 {
        fraction *= 0.5;
    }
    fraction
}

/// How fast the radius shrinks at a ring: metres per metre, the mean of both sides.
fn slope(rings: &[Ring], i: usize) -> f32 {
    let between = |a: &Ring, b: &Ring| (a.radius - b.radius) / (b.along - a.along);
    let before = (i > 0).then(|| between(&rings[i - 1], &rings[i]));
    let after = rings.get(i + 1).map(|next| between(&rings[i], next));
    match (before, after) {
        (Some(x), Some(y)) => f32::midpoint(x, y),
        (one, other) => one.or(other).unwrap_or(0.0),
    }
}

/// Writes a ring's vertices; normals lean toward the apex as much as the wood tapers.
fn place(
    ring: &Ring,
    slope: f32,
    circle: &[(f32, f32)],
    wraps: f32,
    tile_m: f32,
    target: &mut Target<'_>,
) -> Placed {
    let (first, sides) = (target.next(), circle.len() as u32 - 1);
    let across = ring.tangent.cross(ring.side);
    let upright = 1.0 / (1.0 + slope * slope).sqrt();
    let lean = ring.tangent * (slope * upright);
    let v = ring.along / tile_m;
    for (k, &(cos, sin)) in circle.iter().enumerate() {
        let out = ring.side * cos + across * sin;
        let u = wraps * k as f32 / sides as f32;
        target.vertex(ring.center + out * ring.radius, out * upright + lean, Vec2::new(u, v));
    }
    Placed { first, sides }
}

/// Writes the band between two rings, also when their side counts differ: walks round both and
/// always advances over the edge whose middle comes first, so that each edge meets the vertex of the
/// other ring that is nearest to it.
fn join(below: &Placed, above: &Placed, target: &mut Target<'_>) {
    let (n, m) = (below.sides, above.sides);
    let (mut i, mut j) = (0, 0);
    while i < n || j < m {
        let (a, b) = (below.first + i, above.first + j);
        // Compares the angles (i + ½)/n and (j + ½)/m; the lower ring first where they are equal.
        if j == m || (i < n && (2 * i + 1) * m <= (2 * j + 1) * n) {
            target.triangle([a, a + 1, b]);
            i += 1;
        } else {
            target.triangle([a, b + 1, b]);
            j += 1;
        }
    }
}

/// A bud: the last ring drawn together to a point one radius beyond the apex.
fn close_tip(ring: &Ring, rim: &Placed, wraps: f32, tile_m: f32, target: &mut Target<'_>) {
    let point = ring.center + ring.tangent * ring.radius;
    let v = (ring.along + ring.radius) / tile_m;
    for k in 0..rim.sides {
        // A vertex per side, so that the picture is not pinched into the point.
        let tip = target.next();
        let u = wraps * (k as f32 + 0.5) / rim.sides as f32;
        target.vertex(point, ring.tangent, Vec2::new(u, v));
        target.triangle([rim.first + k, rim.first + k + 1, tip]);
    }
}

/// A flat disc that looks back along the axis, with vertices of its own (its edge is sharp).
fn close_base(ring: &Ring, circle: &[(f32, f32)], tile_m: f32, target: &mut Target<'_>) {
    let (first, sides) = (target.next(), circle.len() as u32 - 1);
    let across = ring.tangent.cross(ring.side);
    for &(cos, sin) in &circle[..sides as usize] {
        let out = ring.side * cos + across * sin;
        let uv = Vec2::new(sin, cos) * (ring.radius / tile_m);
        target.vertex(ring.center + out * ring.radius, -ring.tangent, uv);
    }
    for k in 1..sides - 1 {
        target.triangle([first, first + k + 1, first + k]);
    }
}
