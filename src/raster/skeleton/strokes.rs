//! Skeleton → strokes in the picture's plane: where, how wide, how far, what colour.

use glam::{Vec2, Vec3};
use linden::skeleton::Axis;
use linden::{Monitor, NO_PARENT, Skeleton};

use crate::camera::Projected;
use crate::color::{linear, ramp};
use crate::{Extent, Paint, RasterError, Size, Style, View};

/// Where the light comes from in the camera's axes (right, up, toward the lens): over the left
/// shoulder, turning with the camera so that every side of the tree is lit well.
const LIGHT: Vec3 = Vec3::new(-0.527, 0.685, 0.503);
/// Narrower than this, pixels, a stroke keeps its width and fades.
pub(super) const HAIR_PX: f32 = 0.85;
/// How a stroke fades below a hair: 1 keeps its share of the pixel, less lets twigs show.
const FADE: f32 = 0.72;
/// With less ink than this share of a pixel a stroke is not drawn: under one step of 8 bits.
const INVISIBLE: f32 = 1.0 / 300.0;
/// Stroke widths from which light is drawn across, pixels.
const THICK_PX: f32 = 2.5;
/// Thin internodes of one axis are joined until they look this long, pixels.
const MERGE_PX: f32 = 1.0;
/// Nodes between two looks at the monitor.
const CHECK_EVERY: usize = 1 << 14;

/// A tapered stroke.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stroke {
    /// Ends, pixels. The same point for a dot.
    pub ends: [Vec2; 2],
    /// Half widths there, pixels, at least half a hair.
    pub half_widths: [f32; 2],
    /// Whether the ends are round. The foot of a stem is cut.
    pub round: [bool; 2],
    /// From the lens, metres.
    pub depth_m: f32,
    /// How much of what is behind it hides.
    pub alpha: f32,
    /// Linear light.
    pub color: Vec3,
    /// For thick strokes: light across, on the side of [`ACROSS`] by index.
    pub across: Option<[f32; ACROSS.len()]>,
}

/// Places across a stroke, -1 left to 1 right of its direction, at which light is computed.
pub(super) const ACROSS: [f32; 7] = [-1.0, -0.8, -0.4, 0.0, 0.4, 0.8, 1.0];

/// All visible strokes, axis by axis, then the points.
pub(super) fn trace(
    skeleton: &Skeleton,
    extent: Extent,
    view: &View,
    style: &Style,
    size: Size,
    monitor: &dyn Monitor,
) -> Result<Vec<Stroke>, RasterError> {
    let colors = Colors::new(skeleton, style);
    let air = Air::new(extent, view, style);
    let frame = Vec2::new(size.width() as f32, size.height() as f32);
    let tracer = Tracer { skeleton, view, colors, air, frame };
    let mut strokes = Vec::with_capacity(skeleton.positions.len() / 2 + style.points.len());
    let mut until_check = 0;
    for axis in &skeleton.axes {
        if until_check < axis.len as usize {
            monitor.check()?;
            until_check = CHECK_EVERY;
        }
        until_check = until_check.saturating_sub(axis.len as usize + 1);
        tracer.axis(axis, &mut strokes);
    }
    if strokes.is_empty() {
        tracer.feet(&mut strokes);
    }
    for (i, &point) in style.points.iter().enumerate() {
        if i % CHECK_EVERY == 0 {
            monitor.check()?;
        }
        tracer.point(point, style, &mut strokes);
    }
    Ok(strokes)
}

struct Tracer<'a> {
    skeleton: &'a Skeleton,
    view: &'a View,
    colors: Colors,
    air: Air<'a>,
    frame: Vec2,
}

/// One end of a stroke.
#[derive(Clone, Copy)]
struct End {
    at_m: Vec3,
    radius_m: f32,
    seen: Projected,
}

impl End {
    fn width_px(&self) -> f32 {
        2.0 * self.radius_m.max(0.0) * self.seen.scale
    }
}

impl Tracer<'_> {
    fn end(&self, at_m: Vec3, radius_m: f32) -> End {
        End { at_m, radius_m, seen: self.view.project(at_m) }
    }

    fn node(&self, i: u32) -> End {
        self.end(self.skeleton.positions[i as usize], self.skeleton.radii[i as usize])
    }

    /// The strokes of one axis. Internodes that look shorter than a pixel are drawn together.
    fn axis(&self, axis: &Axis, strokes: &mut Vec<Stroke>) {
        let (Some(&first), Some(&apex)) =
            (self.skeleton.nodes_of(axis).first(), self.skeleton.nodes_of(axis).last())
        else {
            return;
        };
        let is_stem = axis.parent == NO_PARENT;
        let (mut start, rest) = if is_stem {
            (self.node(first), &self.skeleton.nodes_of(axis)[1..])
        } else {
            // A lateral leaves its parent at the bark and with its own width.
            let (parent, tip) = (self.node(axis.parent), self.node(first));
            let base = leave(parent.at_m, tip.at_m, parent.radius_m);
            (self.end(base, tip.radius_m.min(parent.radius_m)), self.skeleton.nodes_of(axis))
        };
        let mut foot = is_stem;
        for &i in rest {
            let end = self.node(i);
            let near = end.seen.at.distance_squared(start.seen.at) < MERGE_PX * MERGE_PX;
            if near && i != apex && start.width_px() < THICK_PX {
                continue;
            }
            strokes.extend(self.stroke(start, end, i as usize, !foot));
            (start, foot) = (end, false);
        }
    }

    fn stroke(&self, a: End, b: End, node: usize, round_base: bool) -> Option<Stroke> {
        let widths = [a.width_px(), b.width_px()];
        let wide = widths[0].max(widths[1]).max(HAIR_PX);
        let (p, q) = (a.seen.at, b.seen.at);
        if p.max(q).cmplt(Vec2::splat(-wide)).any() || p.min(q).cmpgt(self.frame + wide).any() {
            return None;
        }
        let mean = f32::midpoint(widths[0], widths[1]);
        let alpha = if mean < HAIR_PX { libm::powf(mean / HAIR_PX, FADE) } else { 1.0 };
        if alpha * (p.distance(q) + wide).min(1.0) < INVISIBLE {
            return None;
        }
        let depth_m = f32::midpoint(a.seen.depth_m, b.seen.depth_m);
        let direction = self.view.turn(b.at_m - a.at_m).normalize_or(Vec3::Y);
        let volume = self.air.light_at((a.at_m + b.at_m) / 2.0);
        let plain = self.colors.of(node);
        let (color, across) = if mean >= THICK_PX {
            let across = ACROSS.map(|u| volume * lambert(direction, u));
            (self.air.haze(plain, depth_m), Some(across))
        } else {
            let light = [-0.75, -0.25, 0.25, 0.75].map(|u| lambert(direction, u)).iter().sum::<f32>() / 4.0;
            (self.air.haze(plain * (volume * light), depth_m), None)
        };
        let half_widths = widths.map(|w| w.max(HAIR_PX) / 2.0);
        Some(Stroke { ends: [p, q], half_widths, round: [round_base, true], depth_m, alpha, color, across })
    }

    /// Nothing but feet: each a ball, so that the smallest tree is seen too.
    fn feet(&self, strokes: &mut Vec<Stroke>) {
        for i in (0..self.skeleton.parents.len()).filter(|&i| self.skeleton.parents[i] == NO_PARENT) {
            let foot = self.node(i as u32);
            let radius_px = (foot.width_px() / 2.0).max(HAIR_PX / 2.0);
            strokes.push(dot(foot.seen, radius_px, self.colors.of(i), 1.0));
        }
    }

    fn point(&self, point: Vec3, style: &Style, strokes: &mut Vec<Stroke>) {
        let seen = self.view.project(point);
        if point.is_finite() && seen.at.cmpge(Vec2::ZERO).all() && seen.at.cmple(self.frame).all() {
            let radius_px = (self.frame.min_element() / 400.0).clamp(0.5, 3.0);
            strokes.push(dot(seen, radius_px, self.air.haze(linear(style.point), seen.depth_m), 0.8));
        }
    }
}

/// The point where the way from `base` to `tip` leaves most of the wood around `base`.
fn leave(base: Vec3, tip: Vec3, radius_m: f32) -> Vec3 {
    let way = tip - base;
    base + way * (0.7 * radius_m / way.length().max(1e-9)).min(0.5)
}

fn dot(seen: Projected, radius_px: f32, color: Vec3, alpha: f32) -> Stroke {
    let (ends, half_widths, depth_m) = ([seen.at; 2], [radius_px; 2], seen.depth_m);
    Stroke { ends, half_widths, round: [true; 2], depth_m, alpha, color, across: None }
}

/// Light on a cylinder along `direction` (camera's axes) at `u`, -1..1 across it: a soft sky and a
/// sun whose terminator is wrapped, so that the dark side keeps its form.
fn lambert(direction: Vec3, u: f32) -> f32 {
    // Seen along its axis a cylinder is a disc that faces the lens.
    let Some(side) = direction.cross(Vec3::Z).try_normalize() else {
        return 0.4 + 0.75 * LIGHT.z;
    };
    let facing = side.cross(direction);
    let normal = side * u + facing * libm::sqrtf((1.0 - u * u).max(0.0));
    let sun = ((normal.dot(LIGHT) + 0.35) / 1.35).max(0.0);
    0.24 + 0.10 * normal.y + 1.10 * sun
}

/// The tree's volume: light falls on the crown as on a ball, is swallowed inside it, and fades
/// with distance.
struct Air<'a> {
    view: &'a View,
    middle: Vec3,
    half: Vec3,
    near_m: f32,
    depth_m: f32,
    haze: Vec3,
    haze_amount: f32,
}

impl<'a> Air<'a> {
    fn new(extent: Extent, view: &'a View, style: &Style) -> Self {
        let half_height = (extent.top - extent.bottom) / 2.0;
        let middle = Vec3::new(extent.x, extent.bottom + half_height, extent.z);
        let reach = extent.radius().max(1e-6);
        Self {
            view,
            middle,
            half: Vec3::new(reach, half_height.max(1e-6), reach),
            near_m: view.project(middle).depth_m - reach,
            depth_m: 2.0 * reach,
            haze: linear(style.haze),
            // Where colour is a quantity it must stay readable.
            haze_amount: style.haze_amount.clamp(0.0, 1.0)
                * if style.paint == Paint::Wood { 1.0 } else { 0.4 },
        }
    }

    fn light_at(&self, point: Vec3) -> f32 {
        let out = (point - self.middle) / self.half;
        let away = out.length().min(1.0);
        let sun = self.view.turn(out).dot(LIGHT);
        (0.62 + 0.38 * away) * (1.02 + 0.24 * sun)
    }

    fn haze(&self, color: Vec3, depth_m: f32) -> Vec3 {
        let t = ((depth_m - self.near_m) / self.depth_m).clamp(0.0, 1.0);
        color.lerp(self.haze, self.haze_amount * t * t)
    }
}

/// What each node is painted with, before light.
struct Colors {
    table: Vec<Vec3>,
    /// Index into the table.
    entry: Vec<u8>,
}

impl Colors {
    fn new(skeleton: &Skeleton, style: &Style) -> Self {
        let n = skeleton.positions.len();
        let mut order = vec![0; n];
        for axis in &skeleton.axes {
            for &node in skeleton.nodes_of(axis) {
                order[node as usize] = axis.order;
            }
        }
        let thickness = by_thickness(&skeleton.radii);
        let of = |values: &[u32]| -> Vec<f32> {
            let most = values.iter().copied().max().unwrap_or(0).max(1) as f32;
            values.iter().map(|&v| v as f32 / most).collect()
        };
        let (share, table): (Vec<f32>, fn(f32) -> Vec3) = match style.paint {
            Paint::Wood | Paint::Radius => (thickness, ramp),
            Paint::Order => (of(&order), ramp),
            Paint::Birth => (of(&skeleton.births), ramp),
        };
        let (trunk, twig) = (linear(style.trunk), linear(style.twig));
        let table = (0_u8..=255)
            .map(|i| {
                let t = f32::from(i) / 255.0;
                if style.paint == Paint::Wood { twig.lerp(trunk, t) } else { table(t) }
            })
            .collect();
        let entry = share.into_iter().map(|t| (t * 255.0 + 0.5) as u8).collect();
        Self { table, entry }
    }

    fn of(&self, node: usize) -> Vec3 {
        self.table[usize::from(self.entry[node])]
    }
}

/// Radii on a logarithmic scale: 0 the thinnest, 1 the thickest.
fn by_thickness(radii: &[f32]) -> Vec<f32> {
    let positive = || radii.iter().copied().filter(|&r| r > 0.0);
    let (min, max) = positive().fold((f32::INFINITY, 0.0_f32), |(a, b), r| (a.min(r), b.max(r)));
    let span = libm::logf(max / min);
    radii
        .iter()
        .map(|&r| match r {
            r if r <= min => 0.0,
            r if span > 1e-6 => (libm::logf(r / min) / span).min(1.0),
            _ => 1.0,
        })
        .collect()
}
