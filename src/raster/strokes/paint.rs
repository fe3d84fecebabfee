//! Runs of strokes → pixels.

use glam::{Vec2, Vec3, Vec4};
use linden_pipeline::Monitor;
use rayon::prelude::*;

use super::coverage::Edge;
use super::{Cap, Facet, Kind, Run, Runs, Stroke, leaves};
use crate::RasterError;
use crate::canvas::Rows;

/// Runs between two looks at the monitor.
const CHECK_EVERY: usize = 1 << 9;
/// Less of a pixel is not worth a blend: under a quarter of a step of 8 bits.
const NOTHING: f32 = 1.0 / 1024.0;

/// Where strokes end up: pixels that know what lies behind and before.
pub(crate) trait Ground {
    /// Lays light (premultiplied) over a pixel, at a depth.
    fn lay(&mut self, pixel: usize, light: Vec3, alpha: f32, depth_m: f32);
}

/// Pixels without depth, premultiplied linear light: everything is laid over what is there.
impl Ground for [Vec4] {
    fn lay(&mut self, pixel: usize, light: Vec3, alpha: f32, _: f32) {
        let below = &mut self[pixel];
        *below = *below * (1.0 - alpha) + light.extend(alpha);
    }
}

impl Runs {
    /// Far to near; of equal depth, in the order in which they were traced.
    pub fn sort(&mut self, monitor: &dyn Monitor) -> Result<(), RasterError> {
        monitor.check()?;
        // The bits of floats that are not negative sort as the floats do.
        let far = |run: &Run| !run.depth_m.max(0.0).to_bits();
        self.sequence.par_sort_unstable_by_key(|run| (far(run), run.first));
        Ok(())
    }

    /// Paints what falls into some rows. `pixels` are theirs, as wide as the picture.
    pub fn paint<G: Ground + ?Sized>(
        &self,
        rows: Rows,
        ground: &mut G,
        monitor: &dyn Monitor,
    ) -> Result<(), RasterError> {
        let (top, bottom) = (rows.top as f32, (rows.top + rows.height) as f32);
        let mut brush = Brush::new(rows);
        for (i, run) in self.sequence.iter().enumerate() {
            if i % CHECK_EVERY == 0 {
                monitor.check()?;
            }
            if run.rows[1] <= top || run.rows[0] >= bottom {
                continue;
            }
            if run.kind == Kind::Facets {
                brush.fill(&self.facets[run.first as usize..(run.first + run.len) as usize], run.depth_m);
                brush.lay(ground);
                continue;
            }
            let strokes = &self.strokes[run.first as usize..(run.first + run.len) as usize];
            if let [only] = strokes {
                Placed::new(only, run.kind).each_pixel(rows, |pixel, coverage, light| {
                    let alpha = coverage * only.alpha;
                    ground.lay(pixel, light * alpha, alpha, only.depth_m);
                });
            } else {
                brush.gather(strokes, run.kind);
                brush.lay(ground);
            }
        }
        Ok(())
    }
}

/// Of a band while runs are painted: light, depth, the list of what was touched.
pub(crate) const BRUSH_BYTES_PER_PIXEL: u64 = 16 + 4 + 2 * 4;

/// The pixels that one run covers, while it is being drawn.
struct Brush {
    rows: Rows,
    /// Premultiplied light and alpha.
    laid: Vec<Vec4>,
    depth_m: Vec<f32>,
    touched: Vec<u32>,
}

impl Brush {
    fn new(rows: Rows) -> Self {
        let pixels = rows.width as usize * rows.height as usize;
        Self { rows, laid: vec![Vec4::ZERO; pixels], depth_m: vec![0.0; pixels], touched: Vec::new() }
    }

    fn gather(&mut self, strokes: &[Stroke], kind: Kind) {
        let Self { rows, laid, depth_m, touched } = self;
        for stroke in strokes {
            Placed::new(stroke, kind).each_pixel(*rows, |pixel, coverage, light| {
                let alpha = coverage * stroke.alpha;
                let old = laid[pixel];
                if old.w == 0.0 {
                    touched.push(pixel as u32);
                }
                match kind {
                    Kind::Thin | Kind::Facets => laid[pixel] = old + (light * alpha).extend(alpha),
                    Kind::Thick if alpha > old.w => laid[pixel] = (light * alpha).extend(alpha),
                    Kind::Thick => return,
                }
                depth_m[pixel] = stroke.depth_m;
            });
        }
    }

    fn fill(&mut self, facets: &[Facet], far_m: f32) {
        let Self { rows, laid, depth_m, touched } = self;
        for facet in facets {
            leaves::each_pixel(facet, *rows, |pixel, coverage| {
                if laid[pixel].w == 0.0 {
                    touched.push(pixel as u32);
                }
                let alpha = coverage * facet.alpha;
                laid[pixel] += (facet.color * alpha).extend(alpha);
                depth_m[pixel] = far_m;
            });
        }
    }

    fn lay<G: Ground + ?Sized>(&mut self, ground: &mut G) {
        for pixel in self.touched.drain(..) {
            let pixel = pixel as usize;
            let laid = std::mem::take(&mut self.laid[pixel]);
            // Cut ends overlap a little on the inner side of a bend.
            let laid = if laid.w > 1.0 { laid / laid.w } else { laid };
            ground.lay(pixel, laid.truncate(), laid.w, self.depth_m[pixel]);
        }
    }
}

/// How far a stroke goes on beyond a seam, pixels. In the pixel of the seam each of the two is half
/// there; with this much more of the second, both over each other hide as much as one.
fn overlap(stroke: &Stroke) -> f32 {
    stroke.alpha / (4.0 - 2.0 * stroke.alpha.min(1.0))
}

/// A stroke with its directions.
struct Placed<'a> {
    stroke: &'a Stroke,
    kind: Kind,
    start: Vec2,
    along: Vec2,
    /// Right of the direction in a picture whose y points down.
    right: Vec2,
    length: f32,
    edge: Edge,
}

impl<'a> Placed<'a> {
    fn new(stroke: &'a Stroke, kind: Kind) -> Self {
        let [mut start, end] = stroke.ends;
        let mut length = (end - start).length();
        let mut along = if length > 1e-3 { (end - start) / length } else { Vec2::X };
        if !along.is_finite() {
            along = Vec2::X;
        }
        if kind == Kind::Thin {
            // Seen along its axis a hair is a dot as wide as itself.
            let short = (stroke.half_widths[0] * 2.0 - length).max(0.0) / 2.0;
            let before = if length <= 1e-3 { short } else { 0.0 };
            let [before, after] =
                stroke.caps.map(|cap| if cap == Cap::Seam { before.max(overlap(stroke)) } else { before });
            start -= along * before;
            length += before + after;
        }
        let right = Vec2::new(-along.y, along.x);
        Self { stroke, kind, start, along, right, length, edge: Edge::new(right) }
    }

    /// Calls back with every pixel that is covered, by how much, and the light there.
    fn each_pixel(&self, rows: Rows, mut each: impl FnMut(usize, f32, Vec3)) {
        let [wa, wb] = self.stroke.half_widths;
        let reach = wa.max(wb) + self.edge.reach();
        let beyond = if self.kind == Kind::Thin { self.edge.reach() } else { reach };
        let corners = [-beyond, self.length + beyond]
            .map(|t| [-reach, reach].map(|s| self.start.y + self.along.y * t + self.right.y * s));
        let low = corners.iter().flatten().copied().fold(f32::INFINITY, f32::min);
        let high = corners.iter().flatten().copied().fold(f32::NEG_INFINITY, f32::max);
        let (top, bottom) = (rows.top as f32, (rows.top + rows.height) as f32);
        let (first, last) = ((low - 0.5).max(top), (high + 0.5).min(bottom));
        if !(first < last) {
            return;
        }
        let taper = if self.length > 0.0 { (wb - wa) / self.length } else { 0.0 };
        for y in first as u32..(last.ceil() as u32).min(rows.top + rows.height) {
            let dy = y as f32 + 0.5 - self.start.y;
            let (mut from, mut to) = (0.0, rows.width as f32);
            for (axis, low, high) in
                [(self.right, -reach, reach), (self.along, -beyond, self.length + beyond)]
            {
                // low <= axis · (dx, dy) <= high, solved for x.
                if axis.x.abs() > 1e-4 {
                    let ends = [low, high].map(|bound| self.start.x + (bound - axis.y * dy) / axis.x);
                    from = ends[0].min(ends[1]).max(from);
                    to = ends[0].max(ends[1]).min(to);
                }
            }
            if !(from < to) {
                continue;
            }
            let line = (y - rows.top) as usize * rows.width as usize;
            for x in (from - 0.5).max(0.0) as u32..((to + 0.5) as u32).min(rows.width) {
                let away = Vec2::new(x as f32 + 0.5 - self.start.x, dy);
                let (t, s) = (self.along.dot(away), self.right.dot(away));
                let half = wa + taper * t.clamp(0.0, self.length);
                let coverage = self.cover(t, s, half);
                if coverage > NOTHING {
                    each(line + x as usize, coverage, self.light(s, half));
                }
            }
        }
    }

    fn cover(&self, t: f32, s: f32, half: f32) -> f32 {
        match self.kind {
            Kind::Thin => self.edge.between(s - half, s + half) * self.edge.between(t - self.length, t),
            Kind::Thick | Kind::Facets => {
                let beyond = (-t).max(t - self.length).max(0.0);
                let away = if beyond > 0.0 { Vec2::new(beyond, s).length() } else { s.abs() };
                let across = if away + self.edge.reach() <= half {
                    1.0
                } else {
                    self.edge.between(away - half, away + half)
                };
                let cut = |cap: Cap, inside: f32| match cap {
                    Cap::Round => 1.0,
                    Cap::Cut => self.edge.before(inside),
                    Cap::Seam => self.edge.before(inside + overlap(self.stroke)),
                };
                let [start, end] = self.stroke.caps;
                across * cut(start, t) * cut(end, self.length - t)
            }
        }
    }

    fn light(&self, s: f32, half: f32) -> Vec3 {
        match &self.stroke.bar {
            Some(bar) => bar.at((s / half).clamp(-1.0, 1.0)).on(self.stroke.color),
            None => self.stroke.color,
        }
    }
}
