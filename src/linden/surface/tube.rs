//! From rings to triangles: bands between rings, a pointed tip, a flat base.

use std::f32::consts::TAU;

use glam::{Vec2, Vec3};

use super::path::Ring;
use crate::scene::Mesh;

/// Side counts that rings take. Few distinct ones, so that neighbouring rings mostly agree.
const SIDES: [u32; 14] = [3, 4, 5, 6, 8, 10, 12, 16, 20, 24, 32, 48, 64, 128];

/// How many sides a radius deserves: equal absolute deviation from the circle on thick and thin
/// wood, set by the sides of the thickest.
#[derive(Clone, Copy, Debug)]
pub(super) struct Roundness {
    /// Largest distance between circle and polygon, metres.
    sagitta_m: f32,
    most: u32,
}

impl Roundness {
    pub(super) fn new(sides: u32, thickest_m: f32) -> Self {
        let sagitta = 1.0 - libm::cosf(std::f32::consts::PI / sides as f32);
        Self { sagitta_m: thickest_m * sagitta, most: sides }
    }

    pub(super) fn sides(self, radius_m: f32) -> u32 {
        let cosine = (1.0 - self.sagitta_m / radius_m).max(-1.0);
        let exact = std::f32::consts::PI / libm::acosf(cosine);
        // A hair below, so that rounding cannot lift the thickest ring over its own count.
        let enough = SIDES.into_iter().find(|&n| n as f32 >= exact * 0.999).unwrap_or(self.most);
        enough.min(self.most)
    }
}

/// A ring as it stands in the mesh.
struct Placed {
    /// Index of the vertex at angle 0; `sides + 1` vertices follow, the last one closes the seam.
    first: u32,
    sides: u32,
}

/// Appends the tube over some rings (none or at least two).
pub(super) fn sweep(rings: &[Ring], roundness: Roundness, tile_m: f32, mesh: &mut Mesh) {
    let (Some(base), Some(apex)) = (rings.first(), rings.last()) else { return };
    close_base(base, roundness.sides(base.radius), tile_m, mesh);
    let mut below: Option<(Placed, f32)> = None;
    for (i, pair) in rings.windows(2).enumerate() {
        let (ring, next) = (&pair[0], &pair[1]);
        // Pictures round the girth follow the radius; where their number changes, the ring stands
        // twice, with the coordinates of either side.
        let wraps = wraps(f32::midpoint(ring.radius, next.radius), tile_m);
        let bottom = match below.take() {
            Some((placed, same)) if same == wraps => placed,
            _ => place(ring, slope(rings, i), roundness.sides(ring.radius), wraps, tile_m, mesh),
        };
        let top = place(next, slope(rings, i + 1), roundness.sides(next.radius), wraps, tile_m, mesh);
        join(&bottom, &top, mesh);
        below = Some((top, wraps));
    }
    let Some((rim, wraps)) = below else { return };
    close_tip(apex, &rim, wraps, tile_m, mesh);
}

/// Pictures round the girth: a whole number, below one a power of two.
fn wraps(radius_m: f32, tile_m: f32) -> f32 {
    let exact = TAU * radius_m / tile_m;
    if exact >= 1.0 {
        return exact.round();
    }
    let mut fraction = 1.0;
    // The geometric middle between neighbours; 2^-20 of a picture is less than a texel.
    while exact < fraction * std::f32::consts::FRAC_1_SQRT_2 && fraction > 1e-6 {
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

/// Unit vector from a ring's centre to its vertex `k` of `sides`.
fn spoke(ring: &Ring, k: u32, sides: u32) -> Vec3 {
    let (sin, cos) = libm::sincosf(TAU * k as f32 / sides as f32);
    ring.side * cos + ring.tangent.cross(ring.side) * sin
}

/// Appends a ring's vertices; normals lean toward the apex as much as the wood tapers.
fn place(ring: &Ring, slope: f32, sides: u32, wraps: f32, tile_m: f32, mesh: &mut Mesh) -> Placed {
    let first = mesh.positions.len() as u32;
    let v = ring.along / tile_m;
    for k in 0..=sides {
        let out = spoke(ring, k % sides, sides);
        mesh.positions.push(ring.center + out * ring.radius);
        mesh.normals.push((out + ring.tangent * slope).normalize());
        mesh.uvs.push(Vec2::new(wraps * k as f32 / sides as f32, v));
    }
    Placed { first, sides }
}

/// Appends the band between two rings, also when their side counts differ: walks round both and
/// always advances over the edge whose middle comes first, so that each edge meets the vertex of the
/// other ring that is nearest to it.
fn join(below: &Placed, above: &Placed, mesh: &mut Mesh) {
    let (n, m) = (below.sides, above.sides);
    let (mut i, mut j) = (0, 0);
    while i < n || j < m {
        let (a, b) = (below.first + i, above.first + j);
        // Compares the angles (i + ½)/n and (j + ½)/m; the lower ring first where they are equal.
        if j == m || (i < n && (2 * i + 1) * m <= (2 * j + 1) * n) {
            mesh.triangles.push([a, a + 1, b]);
            i += 1;
        } else {
            mesh.triangles.push([a, b + 1, b]);
            j += 1;
        }
    }
}

/// A bud: the last ring drawn together to a point one radius beyond the apex.
fn close_tip(ring: &Ring, rim: &Placed, wraps: f32, tile_m: f32, mesh: &mut Mesh) {
    let point = ring.center + ring.tangent * ring.radius;
    let v = (ring.along + ring.radius) / tile_m;
    for k in 0..rim.sides {
        // A vertex per side, so that the picture is not pinched into the point.
        let tip = mesh.positions.len() as u32;
        mesh.positions.push(point);
        mesh.normals.push(ring.tangent);
        mesh.uvs.push(Vec2::new(wraps * (k as f32 + 0.5) / rim.sides as f32, v));
        mesh.triangles.push([rim.first + k, rim.first + k + 1, tip]);
    }
}

/// A flat disc that looks back along the axis, with vertices of its own (its edge is sharp).
fn close_base(ring: &Ring, sides: u32, tile_m: f32, mesh: &mut Mesh) {
    let first = mesh.positions.len() as u32;
    for k in 0..sides {
        let out = spoke(ring, k, sides);
        let (sin, cos) = libm::sincosf(TAU * k as f32 / sides as f32);
        mesh.positions.push(ring.center + out * ring.radius);
        mesh.normals.push(-ring.tangent);
        mesh.uvs.push(Vec2::new(sin, cos) * (ring.radius / tile_m));
    }
    for k in 1..sides - 1 {
        mesh.triangles.push([first, first + k + 1, first + k]);
    }
}
