//! Texture coordinates that lie over each other.

use glam::Vec2;

use super::{Limits, Rule, limit};
use crate::asset::{Aspect, Asset, Geometry};
use crate::finding::{Findings, Severity};

pub(super) const COLOR: Rule = Rule {
    id: "uv-overlap",
    checks: "triangles that share texels in the first set of texture coordinates",
    why: "what is painted or baked for one shows on the other. Bark that tiles and leaves from an atlas overlap on purpose, so \
          this is off unless it is asked for",
    mend: "unwrap without overlaps",
    severity: Severity::Off,
    limits: &[SHARE, TEXELS],
    needs: &[Aspect::Uvs, Aspect::Geometry],
    check: |asset, limits, found| check(asset, 0, limits, found),
};

pub(super) const LIGHTMAP: Rule = Rule {
    id: "lightmap-overlap",
    checks: "triangles that share texels in the second set of texture coordinates, or lie outside of its picture",
    why: "the second set is for baked light: what is shared gets the light of both, what is outside gets none",
    mend: "let the engine or the modeller unwrap a set for lightmaps, with a margin",
    severity: Severity::Error,
    limits: &[SHARE, TEXELS],
    needs: &[Aspect::SecondUvs, Aspect::Geometry],
    check: |asset, limits, found| check(asset, 1, limits, found),
};

const SHARE: super::Limit = limit("share", 0.1, "%", "most of the covered texels that are covered twice");
const TEXELS: super::Limit =
    limit("texels", 1024.0, "texels", "texels of a side of the picture, at most 4096");

fn check(asset: &Asset, set: usize, limits: &Limits, found: &mut Findings<'_>) {
    let texels = (limits.of("texels") as usize).clamp(1, 4096);
    for (mesh, geometry) in asset.drawn() {
        let Some(uvs) = &geometry.uvs[set] else { continue };
        if set == 1 {
            let is_outside =
                |uv: &&Vec2| !(uv.cmpge(Vec2::splat(-1e-6)).all() && uv.cmple(Vec2::splat(1.0 + 1e-6)).all());
            let outside = uvs.iter().filter(is_outside).count();
            if outside > 0 {
                let message = format!("{outside} of {} vertices lie outside of the picture", uvs.len());
                found.over(Some(&mesh.name), message, outside as f64, 0.0);
            }
        }
        let (twice, covered) = overlap(geometry, uvs, texels);
        let share = crate::mesh::percent(twice, covered);
        if share > limits.of("share") {
            let message = format!("{share:.1} % of its texels belong to two triangles or more");
            found.over(Some(&mesh.name), message, share, limits.of("share"));
        }
    }
}

/// Texels that two triangles or more cover, and those that any covers. Each triangle is taken into the first tile, as
/// pictures that repeat have it; a texel is covered where its middle is inside. What is on an edge belongs to one of
/// the two triangles there.
pub(crate) fn overlap(geometry: &Geometry, uvs: &[Vec2], texels: usize) -> (usize, usize) {
    let mut counts = vec![0_u8; texels * texels];
    for &triangle in &geometry.triangles {
        let corners = triangle.map(|vertex| uvs[vertex as usize].as_dvec2());
        if corners.iter().any(|corner| !corner.is_finite()) {
            continue;
        }
        let tile = corners[0].min(corners[1]).min(corners[2]).floor();
        let scaled = corners.map(|corner| (corner - tile) * texels as f64);
        cover(scaled, texels, |at| counts[at] = counts[at].saturating_add(1));
    }
    (counts.iter().filter(|&&count| count > 1).count(), counts.iter().filter(|&&count| count > 0).count())
}

/// Whether a point lies to the left of an edge; of points on it, whether the triangle to its left has them, which has
/// those on its left and lower edges.
fn is_left((from, to): (glam::DVec2, glam::DVec2), point: glam::DVec2) -> bool {
    let along = to - from;
    let side = along.perp_dot(point - from);
    side > 0.0 || (side == 0.0 && (along.y < 0.0 || (along.y == 0.0 && along.x > 0.0)))
}

fn cover([a, b, c]: [glam::DVec2; 3], texels: usize, mut cover: impl FnMut(usize)) {
    let area = (b - a).perp_dot(c - a);
    if area == 0.0 {
        return;
    }
    let edges = if area > 0.0 { [(a, b), (b, c), (c, a)] } else { [(a, c), (c, b), (b, a)] };
    let range = |low: f64, high: f64| {
        let first = (low - 0.5).ceil().clamp(0.0, texels as f64) as usize;
        let end = ((high - 0.5).floor() + 1.0).clamp(0.0, texels as f64) as usize;
        first..end
    };
    let columns = range(a.x.min(b.x).min(c.x), a.x.max(b.x).max(c.x));
    for y in range(a.y.min(b.y).min(c.y), a.y.max(b.y).max(c.y)) {
        let middle = |x: usize| glam::DVec2::new(x as f64 + 0.5, y as f64 + 0.5);
        // Along a row each edge is passed once at most, rounded or not: halving finds where.
        let (mut first, mut end) = (columns.start, columns.end);
        for edge in edges {
            let passed = |from: usize, to: usize, is_before: bool| {
                let (mut low, mut high) = (from, to);
                while low < high {
                    let x = usize::midpoint(low, high);
                    if is_left(edge, middle(x)) == is_before { low = x + 1 } else { high = x }
                }
                low
            };
            // What is inside lies to the right of an edge that runs down, and to the left of one that runs up.
            if edge.1.y < edge.0.y {
                first = passed(first, end, false);
            } else {
                end = passed(first, end, true);
            }
        }
        (first..end).for_each(|x| cover(y * texels + x));
    }
}

#[cfg(test)]
mod tests {
    use glam::{DVec2, Vec3};

    use super::*;

    /// A stream of numbers from 0 to 1.
    fn numbers(seed: u32) -> impl FnMut() -> f32 {
        let mut state = seed;
        move || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 8) as f32 / (1 << 24) as f32
        }
    }

    fn mesh(uvs: &[Vec2]) -> Geometry {
        let triangles = (0..uvs.len() as u32 / 3).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        Geometry { positions: vec![Vec3::ZERO; uvs.len()], triangles, ..Geometry::default() }
    }

    /// Every texel against every triangle, by barycentric coordinates.
    fn by_force(uvs: &[Vec2], texels: usize) -> (usize, usize) {
        let (mut twice, mut once) = (0, 0);
        for texel in 0..texels * texels {
            let middle =
                DVec2::new((texel % texels) as f64 + 0.5, (texel / texels) as f64 + 0.5) / texels as f64;
            let covers = |corners: &[Vec2]| {
                let [a, b, c] = [0, 1, 2].map(|i| corners[i].as_dvec2());
                let whole = (b - a).perp_dot(c - a);
                let shares = [(b, c), (c, a), (a, b)].map(|(p, q)| (p - middle).perp_dot(q - middle) / whole);
                shares.iter().all(|share| *share >= 0.0)
            };
            let count = uvs.chunks(3).filter(|corners| covers(corners)).count();
            once += usize::from(count > 0);
            twice += usize::from(count > 1);
        }
        (twice, once)
    }

    #[test]
    fn overlaps_are_those_of_every_texel_against_every_triangle() {
        for seed in 0..40 {
            let mut number = numbers(seed);
            let uvs: Vec<Vec2> =
                (0..3 * (1 + seed as usize % 9)).map(|_| Vec2::new(number(), number())).collect();
            // Middles are never on an edge here.
            assert_eq!(overlap(&mesh(&uvs), &uvs, 37), by_force(&uvs, 37), "seed {seed}");
        }
    }

    #[test]
    fn neighbours_share_no_texel_and_miss_none() {
        // Edges through the middles of texels, in both windings.
        for texels in [1, 2, 3, 8, 64] {
            let square =
                [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(Vec2::from);
            assert_eq!(overlap(&mesh(&square), &square, texels), (0, texels * texels));
            let turned =
                [[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(Vec2::from);
            assert_eq!(overlap(&mesh(&turned), &turned, texels), (0, texels * texels));
            let other =
                [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(Vec2::from);
            assert_eq!(overlap(&mesh(&other), &other, texels), (0, texels * texels));
            let twice: Vec<Vec2> =
                square.into_iter().chain(square.map(|uv| uv + Vec2::new(3.0, -2.0))).collect();
            assert_eq!(overlap(&mesh(&twice), &twice, texels), (texels * texels, texels * texels));
        }
    }
}
