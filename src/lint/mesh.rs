//! Measures of meshes that several rules share.

use glam::Vec3;

use crate::asset::{Asset, Geometry, Piece};

/// For each vertex the first one at the same place: seams of texture coordinates and of normals are closed.
pub fn welded(geometry: &Geometry) -> Vec<u32> {
    // Minus zero is zero.
    let bits = |at: Vec3| (at + Vec3::ZERO).to_array().map(f32::to_bits);
    let mut order: Vec<u32> = (0..geometry.positions.len() as u32).collect();
    order.sort_unstable_by_key(|&vertex| (bits(geometry.positions[vertex as usize]), vertex));
    let mut first = vec![0; order.len()];
    for run in
        order.chunk_by(|&a, &b| bits(geometry.positions[a as usize]) == bits(geometry.positions[b as usize]))
    {
        for &vertex in run {
            first[vertex as usize] = run[0];
        }
    }
    first
}

/// Triangles by welded vertices, without those that have become lines, and each once whatever its winding.
pub fn distinct_triangles(geometry: &Geometry, welded: &[u32]) -> Vec<[u32; 3]> {
    let mut seen: Vec<([u32; 3], [u32; 3])> = geometry
        .triangles
        .iter()
        .map(|triangle| triangle.map(|vertex| welded[vertex as usize]))
        .filter(|[a, b, c]| a != b && b != c && a != c)
        .map(|triangle| (sorted(triangle), triangle))
        .collect();
    seen.sort_unstable();
    seen.dedup_by_key(|(key, _)| *key);
    seen.into_iter().map(|(_, triangle)| triangle).collect()
}

pub fn sorted(mut triangle: [u32; 3]) -> [u32; 3] {
    triangle.sort_unstable();
    triangle
}

/// An edge of a triangle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Edge {
    /// The lower vertex first.
    pub ends: [u32; 2],
    /// Whether the triangle goes from the lower to the higher.
    pub is_rising: bool,
}

/// All edges of all triangles, those between the same vertices together.
pub fn edges(triangles: &[[u32; 3]]) -> Vec<Edge> {
    let of = |[a, b, c]: [u32; 3]| {
        [[a, b], [b, c], [c, a]].map(|[a, b]| Edge { ends: [a.min(b), a.max(b)], is_rising: a < b })
    };
    let mut edges: Vec<Edge> = triangles.iter().flat_map(|&triangle| of(triangle)).collect();
    edges.sort_unstable();
    edges
}

/// Six times the volume that triangles enclose, if they are closed; of an open mesh nothing.
pub fn six_volumes(geometry: &Geometry) -> f64 {
    let of = |&triangle: &[u32; 3]| {
        let [a, b, c] = geometry.corners(triangle).map(glam::Vec3::as_dvec3);
        a.dot(b.cross(c))
    };
    geometry.triangles.iter().map(of).sum()
}

/// Vertices in their places that are looked at one by one.
const MOST: usize = 50_000_000;

/// The lowest and the highest corner of pieces in their places; of meshes with a very great many, of their boxes.
pub fn bounds(asset: &Asset, pieces: &[Piece]) -> Option<[Vec3; 2]> {
    let mut bounds: Option<[Vec3; 2]> = None;
    for piece in pieces {
        let Some(geometry) = &asset.meshes[piece.mesh].geometry else { continue };
        let corners;
        let positions = if geometry.positions.len().saturating_mul(piece.places.len()) <= MOST {
            &geometry.positions
        } else {
            corners = box_of(&geometry.positions);
            &corners
        };
        for place in &piece.places {
            for &at in positions {
                let at = place.transform_point3(at);
                let [low, high] = bounds.unwrap_or([at, at]);
                bounds = Some([low.min(at), high.max(at)]);
            }
        }
    }
    bounds
}

/// The eight corners around positions.
fn box_of(positions: &[Vec3]) -> Vec<Vec3> {
    let low = positions.iter().copied().fold(Vec3::MAX, Vec3::min);
    let high = positions.iter().copied().fold(Vec3::MIN, Vec3::max);
    let pick = |corner: u32| {
        Vec3::select(glam::BVec3::new(corner & 1 > 0, corner & 2 > 0, corner & 4 > 0), high, low)
    };
    (0..8).map(pick).collect()
}

/// Twice the area of a triangle, as a vector along its normal.
pub fn twice_area(corners: [Vec3; 3]) -> Vec3 {
    let [a, b, c] = corners;
    (b - a).cross(c - a)
}

/// The share of a whole in percent.
pub fn percent(part: usize, whole: usize) -> f64 {
    if whole == 0 { 0.0 } else { 100.0 * part as f64 / whole as f64 }
}
