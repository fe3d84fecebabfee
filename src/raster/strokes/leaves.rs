//! What grows on a skeleton: triangles in the picture's plane, one run for each organ.

use glam::{Vec2, Vec3};
use linden_pipeline::Monitor;
use linden_pipeline::foliage::{Organs, Shaper};
use linden_pipeline::scene::Mesh;
use rayon::prelude::*;

use super::trace::Tracer;
use super::{Facet, Runs};
use crate::canvas::Rows;
use crate::color::linear;
use crate::memory::Ledger;
use crate::{Paint, RasterError, Style};

/// Organs that one task traces.
const PER_TASK: usize = 256;
/// About as many organs as a draft shows.
const DRAFT_ORGANS: usize = 20_000;
/// A pixel is not worth a blend below this coverage.
const NOTHING: f32 = 1.0 / 1024.0;

/// Traces the organs of a style.
pub(crate) fn trace(
    tracer: &Tracer,
    style: &Style,
    ledger: &Ledger<'_>,
    monitor: &dyn Monitor,
) -> Result<Vec<Runs>, RasterError> {
    let Some(organs) = style.organs.filter(|organs| !organs.is_empty()) else { return Ok(Vec::new()) };
    let nodes = tracer.nodes_count();
    let fault = (0..organs.len()).find(|&i| organs.growth(i).node as usize >= nodes);
    if let Some(organ) = fault {
        return Err(RasterError::Inconsistent(organs.growth(organ).node as usize));
    }
    // Evenly over the crown: organs come in the order of the branches.
    let every = if style.draft { organs.len().div_ceil(DRAFT_ORGANS).max(1) } else { 1 };
    let shown = organs.len().div_ceil(every);
    let traced = (0..shown.div_ceil(PER_TASK)).into_par_iter().map(|task| {
        monitor.check()?;
        let mut runs = Runs::default();
        let mut leaf =
            Leaf { tracer, organs, shaper: Shaper::default(), mesh: Mesh::default(), facets: Vec::new() };
        for at in task * PER_TASK..shown.min((task + 1) * PER_TASK) {
            let organ = at * every;
            let hanging = organs.growth(organ);
            if style.until.is_some_and(|step| hanging.birth > step) || !tracer.is_present(hanging.node) {
                continue;
            }
            let color = match style.organ_color(organs, organ) {
                Some(color) if style.paint == Paint::Wood => linear(color) * style.exposure,
                _ => tracer.color_of(hanging.node),
            };
            leaf.trace(organ, color, &mut runs);
        }
        ledger.take(runs.bytes())?;
        Ok(runs)
    });
    traced.collect()
}

/// One organ after the other.
struct Leaf<'a> {
    tracer: &'a Tracer<'a>,
    organs: &'a Organs,
    shaper: Shaper,
    mesh: Mesh,
    facets: Vec<Facet>,
}

impl Leaf<'_> {
    fn trace(&mut self, organ: usize, color: Vec3, runs: &mut Runs) {
        let Self { tracer, organs, shaper, mesh, facets } = self;
        mesh.positions.clear();
        mesh.normals.clear();
        mesh.uvs.clear();
        mesh.triangles.clear();
        facets.clear();
        shaper.add(organs, organ, mesh);
        let (mut far_m, mut seen) = (0.0, 0.0);
        for triangle in &mesh.triangles {
            let corners = triangle.map(|v| mesh.positions[v as usize]);
            let placed = corners.map(|p| tracer.view.project(p));
            let at = placed.map(|p| p.at);
            if !tracer.is_in_frame(at) {
                continue;
            }
            let depth_m = placed.iter().map(|p| p.depth_m).sum::<f32>() / 3.0;
            let middle = (corners[0] + corners[1] + corners[2]) / 3.0;
            let normal: Vec3 = triangle.iter().map(|&v| mesh.normals[v as usize]).sum();
            let lit = tracer.air.on_leaf(middle, normal.normalize_or(Vec3::Y));
            let color = tracer.air.haze(lit.on(color), depth_m);
            facets.push(Facet { corners: at, color, alpha: 1.0 });
            far_m += depth_m;
            seen += 1.0;
        }
        if !facets.is_empty() {
            runs.facets(facets, far_m / seen);
        }
    }
}

/// Calls back with every pixel that a facet covers, and the exact share of it that it covers.
pub(super) fn each_pixel(facet: &Facet, rows: Rows, mut each: impl FnMut(usize, f32)) {
    let [a, b, c] = facet.corners;
    let area = (b - a).perp_dot(c - a);
    if area == 0.0 || !area.is_finite() {
        return;
    }
    let corners = if area > 0.0 { [a, b, c] } else { [a, c, b] };
    let [b, c] = [corners[1], corners[2]];
    // Inside is where all three are positive: normal, place on the edge, and how far a pixel reaches.
    let edges = [(a, b), (b, c), (c, a)].map(|(from, to)| {
        let normal = (to - from).perp();
        (normal, from, f32::midpoint(normal.x.abs(), normal.y.abs()))
    });
    let (low, high) = (a.min(b).min(c), a.max(b).max(c));
    let (top, bottom) = (rows.top as f32, (rows.top + rows.height) as f32);
    let (first_y, last_y) = (low.y.max(top).floor(), high.y.min(bottom).ceil());
    let (first_x, last_x) = (low.x.max(0.0).floor(), high.x.min(rows.width as f32).ceil());
    if !(first_y < last_y && first_x < last_x) {
        return;
    }
    for y in first_y as u32..last_y as u32 {
        let line = (y - rows.top) as usize * rows.width as usize;
        for x in first_x as u32..last_x as u32 {
            let middle = Vec2::new(x as f32 + 0.5, y as f32 + 0.5);
            let inside = edges.map(|(normal, from, reach)| (normal.dot(middle - from), reach));
            if inside.iter().any(|(d, reach)| d <= &-reach) {
                continue;
            }
            let coverage =
                if inside.iter().all(|(d, reach)| d >= reach) { 1.0 } else { covered(corners, middle) };
            if coverage > NOTHING {
                each(line + x as usize, coverage);
            }
        }
    }
}

/// The area of a triangle within the unit square round a place: clipped at one side after the other
/// (Sutherland & Hodgman 1974).
fn covered(triangle: [Vec2; 3], middle: Vec2) -> f32 {
    // Each side may add a corner to the three.
    let mut polygon = [Vec2::ZERO; 8];
    for (shifted, corner) in polygon.iter_mut().zip(triangle) {
        *shifted = corner - middle;
    }
    let mut count = 3;
    for side in [Vec2::X, Vec2::Y, Vec2::NEG_X, Vec2::NEG_Y] {
        let (before, n) = (polygon, count);
        count = 0;
        for i in 0..n {
            let (from, to) = (before[i], before[(i + 1) % n]);
            let (from_in, to_in) = (0.5 - side.dot(from), 0.5 - side.dot(to));
            if from_in >= 0.0 && count < polygon.len() {
                polygon[count] = from;
                count += 1;
            }
            if (from_in > 0.0) != (to_in > 0.0) && from_in != to_in && count < polygon.len() {
                polygon[count] = from + (to - from) * (from_in / (from_in - to_in)).clamp(0.0, 1.0);
                count += 1;
            }
        }
    }
    let ring = (0..count).map(|i| polygon[i].perp_dot(polygon[(i + 1) % count]));
    (ring.sum::<f32>() / 2.0).clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use linden_pipeline::random::Key;

    use super::*;

    #[test]
    fn facets_cover_their_area_wherever_they_lie() {
        let rows = Rows { top: 0, height: 64, width: 64 };
        for seed in 0..500 {
            let key = Key::new(seed);
            // From specks to most of the picture.
            let size = libm::powf(60.0, key.child(9).unit() as f32);
            let at = |i: u64| key.child(i).between(0.0, 1.0) as f32;
            let base = Vec2::new(at(7), at(8)) * (63.0 - size.min(62.0));
            let corners = [0, 2, 4].map(|i| base + Vec2::new(at(i), at(i + 1)) * size);
            let area = (corners[1] - corners[0]).perp_dot(corners[2] - corners[0]).abs() / 2.0;
            let mut sum = 0.0;
            each_pixel(&Facet { corners, color: Vec3::ONE, alpha: 1.0 }, rows, |_, coverage| sum += coverage);
            assert!((sum - area).abs() < 0.01 + 0.002 * area, "seed {seed}: {sum} is not {area}");
        }
    }

    #[test]
    fn neighbours_leave_no_seam() {
        let rows = Rows { top: 0, height: 20, width: 20 };
        let [a, b, c, d] = [(2.3, 1.1), (17.7, 3.9), (16.2, 18.4), (1.9, 15.5)].map(Vec2::from);
        let mut sums = [0.0_f32; 400];
        for corners in [[a, b, c], [a, d, c]] {
            each_pixel(&Facet { corners, color: Vec3::ONE, alpha: 1.0 }, rows, |pixel, coverage| {
                sums[pixel] += coverage;
            });
        }
        for y in 5..14 {
            for x in 5..14 {
                assert!((sums[y * 20 + x] - 1.0).abs() < 1e-4, "{x} {y}: {}", sums[y * 20 + x]);
            }
        }
    }
}
