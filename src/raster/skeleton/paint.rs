//! Strokes → pixels: the order in which they are drawn, and what is drawn at once.

use std::f32::consts::PI;

use glam::{Vec2, Vec3};
use linden::Monitor;
use tiny_skia::{
    FillRule, GradientStop, LinearGradient, Paint, Path, PathBuilder, Point, SpreadMode, Transform,
};

use super::strokes::{ACROSS, Stroke};
use crate::RasterError;
use crate::canvas::{Tile, skia_color};
use crate::color::encoded;

/// Slices of depth in which thin strokes may change places. More for larger trees, whose strokes
/// are many per slice anyway.
const SLICES: std::ops::RangeInclusive<usize> = 16..=64;
/// Levels of opacity and of each colour channel that thin strokes of one slice are grouped by.
const ALPHA_LEVELS: f32 = 7.0;
const COLOR_LEVELS: f32 = 15.0;
/// Strokes in one path. tiny-skia keeps the edges that cross a row in a sorted list and inserts new
/// ones by walking along it, so paths with thousands of strokes take quadratic time.
const AT_ONCE: usize = 128;
/// Strokes between two looks at the monitor.
const CHECK_EVERY: usize = 1 << 11;

/// Strokes far to near; those that share a key are filled as one path.
pub(super) struct Order {
    sorted: Vec<(u64, u32)>,
}

impl Order {
    pub(super) fn new(strokes: &[Stroke], monitor: &dyn Monitor) -> Result<Self, RasterError> {
        let depths = || strokes.iter().map(|s| s.depth_m);
        let (near, far) = depths().fold((f32::INFINITY, 0.0_f32), |(a, b), d| (a.min(d), b.max(d)));
        let slices = (strokes.len() / 200).clamp(*SLICES.start(), *SLICES.end()) as f32;
        let per_metre = if far > near { (slices - 0.01) / (far - near) } else { 0.0 };
        let mut sorted = Vec::with_capacity(strokes.len());
        for (chunk, group) in strokes.chunks(CHECK_EVERY).enumerate() {
            monitor.check()?;
            for (i, stroke) in group.iter().enumerate() {
                let behind = far - stroke.depth_m;
                let slice = (behind * per_metre) as u64;
                let key = match stroke.across {
                    // The bits of floats that are not negative sort as the floats do.
                    Some(_) => slice << 40 | 1 << 39 | u64::from(behind.max(0.0).to_bits()),
                    None => slice << 40 | likeness(stroke),
                };
                sorted.push((key, (chunk * CHECK_EVERY + i) as u32));
            }
        }
        sorted.sort_unstable();
        Ok(Self { sorted })
    }

    /// Draws what of the strokes falls into a tile.
    pub(super) fn draw(
        &self,
        strokes: &[Stroke],
        tile: &mut Tile,
        monitor: &dyn Monitor,
    ) -> Result<(), RasterError> {
        let size = Vec2::new(tile.pixmap.width() as f32, tile.pixmap.height() as f32);
        let mut reused = PathBuilder::new();
        let alike = self.sorted.chunk_by(|a, b| a.0 == b.0);
        for group in alike.flat_map(|group| group.chunks(AT_ONCE)) {
            monitor.check()?;
            let mut outline = Outline::from(std::mem::take(&mut reused));
            let (mut color, mut alpha, mut count) = (Vec3::ZERO, 0.0, 0);
            for &(_, i) in group {
                let stroke = &strokes[i as usize];
                let placed = Placed::new(stroke, tile);
                if !placed.touches(size) {
                    continue;
                }
                if let Some(across) = &stroke.across {
                    let mut own = Outline::from(PathBuilder::new());
                    placed.outline(stroke.round, &mut own);
                    if let Some(path) = own.path.finish() {
                        let shader = placed.light(stroke.color, across, stroke.alpha);
                        fill(&path, shader, tile);
                    }
                } else {
                    placed.outline(stroke.round, &mut outline);
                    color += stroke.color;
                    alpha += stroke.alpha;
                    count += 1;
                }
            }
            if count > 0
                && let Some(path) = outline.path.finish()
            {
                let shader =
                    tiny_skia::Shader::SolidColor(skia_color(color / count as f32, alpha / count as f32));
                fill(&path, shader, tile);
                reused = path.clear();
            }
        }
        Ok(())
    }
}

/// Equal for strokes that look alike; below 2^39.
fn likeness(stroke: &Stroke) -> u64 {
    let [r, g, b] = (encoded(stroke.color) * COLOR_LEVELS + 0.5).to_array().map(|c| c as u64);
    let alpha = (stroke.alpha * ALPHA_LEVELS + 0.5) as u64;
    alpha << 24 | r << 16 | g << 8 | b
}

fn fill(path: &Path, shader: tiny_skia::Shader, tile: &mut Tile) {
    let paint = Paint { shader, anti_alias: true, ..Paint::default() };
    tile.pixmap.fill_path(path, &paint, FillRule::Winding, Transform::identity(), None);
}

/// A stroke in the pixels of a tile.
struct Placed {
    a: Vec2,
    b: Vec2,
    ra: f32,
    rb: f32,
}

impl Placed {
    fn new(stroke: &Stroke, tile: &Tile) -> Self {
        let [a, b] = stroke.ends.map(|p| (p - tile.origin) * tile.factor);
        let [ra, rb] = stroke.half_widths.map(|w| w * tile.factor);
        Self { a, b, ra, rb }
    }

    fn touches(&self, size: Vec2) -> bool {
        let (ra, rb) = (Vec2::splat(self.ra), Vec2::splat(self.rb));
        (self.a - ra).min(self.b - rb).cmplt(size).all()
            && (self.a + ra).max(self.b + rb).cmpgt(Vec2::ZERO).all()
    }

    /// The hull of two discs, always in the same sense of rotation: overlapping strokes of one path
    /// add up, where opposite senses would cancel out.
    fn outline(&self, round: [bool; 2], path: &mut Outline) {
        let way = self.b - self.a;
        let length = way.length();
        let wider = self.ra.max(self.rb);
        if length <= (self.ra - self.rb).abs() || length < 1e-3 {
            // One disc hides the other.
            let at = if self.ra >= self.rb { self.a } else { self.b };
            arc(at, wider, 0.0, 2.0 * PI, path);
            path.close();
            return;
        }
        // The outer tangents touch the discs at this angle from the stroke's direction.
        let direction = libm::atan2f(way.y, way.x);
        let lean = libm::acosf(((self.ra - self.rb) / length).clamp(-1.0, 1.0));
        // A hair's ends cannot be seen as round; the square end costs two points.
        let round = round.map(|r| r && wider > 1.5);
        arc_or_cut(self.b, self.rb, direction - lean, direction + lean, round[1], path);
        arc_or_cut(self.a, self.ra, direction + lean, direction - lean + 2.0 * PI, round[0], path);
        path.close();
    }

    fn light(&self, color: Vec3, across: &[f32; ACROSS.len()], alpha: f32) -> tiny_skia::Shader<'static> {
        let plain = || tiny_skia::Shader::SolidColor(skia_color(color * across[3], alpha));
        let Some(along) = (self.b - self.a).try_normalize() else { return plain() };
        // Right of the direction in a picture whose y points down.
        let right = Vec2::new(-along.y, along.x) * f32::midpoint(self.ra, self.rb);
        let middle = (self.a + self.b) / 2.0;
        let [start, end] = [middle - right, middle + right].map(|p| Point::from_xy(p.x, p.y));
        let stops = ACROSS
            .iter()
            .zip(across)
            .map(|(u, light)| GradientStop::new((u + 1.0) / 2.0, skia_color(color * *light, alpha)))
            .collect();
        LinearGradient::new(start, end, stops, SpreadMode::Pad, Transform::identity()).unwrap_or_else(plain)
    }
}

/// From `from` to `to` (radians, `to` larger) around a disc, or straight.
fn arc_or_cut(at: Vec2, radius: f32, from: f32, to: f32, round: bool, path: &mut Outline) {
    if round {
        arc(at, radius, from, to, path);
    } else {
        for angle in [from, to] {
            path.to(at + toward(angle) * radius);
        }
    }
}

/// Chords that leave the circle by less than a twentieth of a pixel.
fn arc(at: Vec2, radius: f32, from: f32, to: f32, path: &mut Outline) {
    let step = 2.0 * libm::acosf((1.0 - 0.05 / radius).clamp(0.0, 0.999_9));
    let chords = (((to - from) / step).ceil() as u32).clamp(1, 256);
    for i in 0..=chords {
        path.to(at + toward(from + (to - from) * i as f32 / chords as f32) * radius);
    }
}

fn toward(angle: f32) -> Vec2 {
    let (s, c) = libm::sincosf(angle);
    Vec2::new(c, s)
}

/// Closed contours of one path.
struct Outline {
    path: PathBuilder,
    begun: bool,
}

impl Outline {
    fn to(&mut self, p: Vec2) {
        if self.begun {
            self.path.line_to(p.x, p.y);
        } else {
            self.path.move_to(p.x, p.y);
            self.begun = true;
        }
    }

    fn close(&mut self) {
        self.path.close();
        self.begun = false;
    }
}

impl From<PathBuilder> for Outline {
    fn from(path: PathBuilder) -> Self {
        Self { path, begun: false }
    }
}
