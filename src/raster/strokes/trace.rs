//! Skeleton → strokes in the picture's plane: where, how wide, how far, what colour.

use std::borrow::Cow;
use std::sync::LazyLock;

use glam::{Vec2, Vec3};
use linden_pipeline::memory::bytes_of;
use linden_pipeline::skeleton::{Axis, AxisKind, Forks, RadiusFit, RadiusSource, WidthSteps};
use linden_pipeline::{Monitor, NO_PARENT, Skeleton};
use rayon::prelude::*;

use super::draft::Thinned;
use super::{Cap, Kind, Runs, Stroke};
use crate::camera::Projected;
use crate::color::{linear, ramp};
use crate::light::Air;
use crate::memory::Ledger;
use crate::shade::sky_shares;
use crate::{Paint, RasterError, Size, Style, View};

/// Narrower than this, pixels, a stroke keeps its width and fades.
pub(crate) const HAIR_PX: f32 = 0.85;
/// How a stroke fades below a hair: 1 keeps its share of the pixel, less lets twigs show.
const FADE: f32 = 0.72;
/// With less ink than this share of a pixel a stroke is not drawn: under one step of 8 bits.
const INVISIBLE: f32 = 1.0 / 300.0;
/// Stroke widths from which light is drawn across, pixels.
const THICK_PX: f32 = 2.5;
/// Thin internodes of one axis are joined until they look this long, pixels.
const MERGE_PX: f32 = 1.0;
/// The same in a draft.
const MERGE_DRAFT_PX: f32 = 2.5;
/// Axes that one task traces.
const AXES_PER_TASK: usize = 256;

/// Bytes that [`Tracer::new`] takes: marks and orders of nodes, what a draft keeps of axes.
pub(crate) fn bytes(skeleton: &Skeleton, style: &Style) -> u64 {
    let marks = if style.until.is_some() { skeleton.positions.len() as u64 } else { 0 };
    let values = match style.paint {
        Paint::Order | Paint::Light | Paint::Source | Paint::Distance => {
            bytes_of::<u32>(skeleton.positions.len())
        }
        Paint::Wood | Paint::Radius | Paint::Birth => 0,
    };
    let kept = if style.draft { bytes_of::<[u32; 4]>(skeleton.positions.len()) } else { 0 };
    marks + values + kept
}

/// Traces a skeleton.
pub(crate) struct Tracer<'a> {
    skeleton: &'a Skeleton,
    forks: Forks,
    pub view: &'a View,
    pub air: &'a Air<'a>,
    colors: Colors<'a>,
    /// Of dead wood, where that differs.
    dead: Option<Vec3>,
    frame: Vec2,
    merge_px: f32,
    /// Strokes that look wider are left out: a surface shows them.
    widest_px: f32,
    present: Option<Vec<bool>>,
    thinned: Option<Thinned>,
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

impl<'a> Tracer<'a> {
    /// For a whole skeleton, or as much of it as the style asks for.
    pub fn new(
        skeleton: &'a Skeleton,
        view: &'a View,
        air: &'a Air<'a>,
        style: &'a Style,
        size: Size,
    ) -> Self {
        Self {
            skeleton,
            view,
            air,
            colors: Colors::new(skeleton, style),
            dead: None,
            frame: Vec2::new(size.width() as f32, size.height() as f32),
            merge_px: if style.draft { MERGE_DRAFT_PX } else { MERGE_PX },
            widest_px: f32::INFINITY,
            present: style.until.map(|step| skeleton.born_by(step)),
            forks: Forks::new(skeleton),
            thinned: if style.draft { Thinned::new(skeleton) } else { None },
        }
    }

    /// Only what is too thin for a surface to be seen, in one colour (linear light), dead wood in another.
    pub fn only_hairs(self, color: Vec3, dead: Option<Vec3>) -> Self {
        Self {
            widest_px: HAIR_PX,
            present: None,
            colors: Colors { plain: Some(color), ..self.colors },
            dead,
            ..self
        }
    }

    /// All strokes, axis by axis, in pieces.
    pub fn trace(&self, ledger: &Ledger<'_>, monitor: &dyn Monitor) -> Result<Vec<Runs>, RasterError> {
        let traced = self.skeleton.axes.par_chunks(AXES_PER_TASK).enumerate().map(|(chunk, axes)| {
            monitor.check()?;
            let mut runs = Runs::default();
            for (i, axis) in axes.iter().enumerate() {
                self.axis(chunk * AXES_PER_TASK + i, axis, &mut runs);
            }
            ledger.take(runs.bytes())?;
            Ok(runs)
        });
        traced.collect()
    }

    /// How many nodes there are.
    pub fn nodes_count(&self) -> usize {
        self.skeleton.positions.len()
    }

    /// Whether a node is there already.
    pub fn is_present(&self, node: u32) -> bool {
        self.present.as_ref().is_none_or(|present| present[node as usize])
    }

    /// The colour of a node, before light.
    pub fn color_of(&self, node: u32) -> Vec3 {
        self.colors.of(node)
    }

    /// Whether any of a triangle may be seen.
    pub fn is_in_frame(&self, [a, b, c]: [Vec2; 3]) -> bool {
        a.max(b).max(c).cmpgt(Vec2::ZERO).all() && a.min(b).min(c).cmplt(self.frame).all()
    }

    fn end(&self, at_m: Vec3, radius_m: f32) -> End {
        End { at_m, radius_m, seen: self.view.project(at_m) }
    }

    fn node(&self, i: u32) -> End {
        self.end(self.skeleton.positions[i as usize], self.skeleton.radii[i as usize])
    }

    /// The nodes of an axis that are there.
    fn nodes(&self, axis: &Axis) -> &[u32] {
        let all = self.skeleton.nodes_of(axis);
        match &self.present {
            Some(present) => &all[..all.iter().take_while(|&&i| present[i as usize]).count()],
            None => all,
        }
    }

    /// The strokes of one axis. Internodes that look shorter than a pixel are drawn together.
    fn axis(&self, index: usize, axis: &Axis, runs: &mut Runs) {
        let nodes = self.nodes(axis);
        let (Some(&first), Some(&apex)) = (nodes.first(), nodes.last()) else { return };
        let widen = self.thinned.as_ref().map_or(Some(1.0), |thinned| thinned.widening(index));
        let Some(widen) = widen else { return };
        let dead = self.dead.filter(|_| self.skeleton.kind_of(index) == AxisKind::Dead);
        let is_stem = axis.parent == NO_PARENT;
        let (mut start, rest) = if is_stem {
            (self.node(first), &nodes[1..])
        } else {
            let (parent, tip) = (self.node(axis.parent), self.node(first));
            if self.forks.runs_on(index as u32) {
                (parent, nodes)
            } else {
                // A lateral leaves its parent at the bark and with its own width.
                let base = leave(parent.at_m, tip.at_m, parent.radius_m);
                (self.end(base, tip.radius_m.min(parent.radius_m)), nodes)
            }
        };
        // A stem is cut at the ground; whatever follows a stroke, where that one ends in a disc.
        let mut base = if is_stem { Cap::Cut } else { Cap::Round };
        let mut joined = false;
        for &i in rest {
            let end = self.node(i);
            let near = end.seen.at.distance_squared(start.seen.at) < self.merge_px * self.merge_px;
            if near && i != apex {
                continue;
            }
            if let Some((kind, stroke)) =
                self.stroke([start, end], dead.unwrap_or_else(|| self.colors.of(i)), widen, base)
            {
                if joined {
                    runs.follow(kind, stroke, self.air.slice_m());
                } else {
                    runs.begin(kind, stroke);
                }
                joined = true;
            } else {
                joined = false;
            }
            (start, base) = (end, if joined { Cap::Cut } else { Cap::Round });
        }
        // Nothing but a foot: a ball, so that the smallest tree is seen too.
        if is_stem && rest.is_empty() && self.widest_px == f32::INFINITY {
            let radius_px = (start.width_px() / 2.0).max(HAIR_PX / 2.0);
            runs.begin(Kind::Thick, dot(start.seen, radius_px, self.colors.of(first), 1.0));
        }
    }

    fn stroke(&self, ends: [End; 2], plain: Vec3, widen: f32, base: Cap) -> Option<(Kind, Stroke)> {
        let [a, b] = ends;
        let widths = match self.skeleton.width_steps {
            WidthSteps::Taper => ends,
            WidthSteps::Cylinder => [b; 2],
        };
        let widths = widths.map(|end| end.width_px() * widen);
        let wide = widths[0].max(widths[1]).max(HAIR_PX);
        let (p, q) = (a.seen.at, b.seen.at);
        if p.max(q).cmplt(Vec2::splat(-wide)).any() || p.min(q).cmpgt(self.frame + wide).any() {
            return None;
        }
        let mean = f32::midpoint(widths[0], widths[1]);
        let alpha = FADING.of(mean / HAIR_PX);
        if mean > self.widest_px || alpha * (p.distance(q) + wide).min(1.0) < INVISIBLE {
            return None;
        }
        let depth_m = f32::midpoint(a.seen.depth_m, b.seen.depth_m);
        let bar = self.air.bar((a.at_m + b.at_m) / 2.0, (b.at_m - a.at_m).normalize_or(Vec3::Y));
        let (kind, color, bar, caps) = if mean >= THICK_PX {
            (Kind::Thick, self.air.haze(plain, depth_m), Some(bar), [base, Cap::Round])
        } else {
            (Kind::Thin, self.air.haze(bar.mean().on(plain), depth_m), None, [Cap::Cut; 2])
        };
        let half_widths = widths.map(|w| w.max(HAIR_PX) / 2.0);
        Some((kind, Stroke { ends: [p, q], half_widths, depth_m, alpha, color, bar, caps }))
    }
}

/// How opaque a stroke is, by its share of a hair: a power in a table.
struct Fading([f32; 257]);

static FADING: LazyLock<Fading> =
    LazyLock::new(|| Fading(std::array::from_fn(|i| libm::powf(i as f32 / 256.0, FADE))));

impl Fading {
    fn of(&self, share: f32) -> f32 {
        let at = share.clamp(0.0, 1.0) * 256.0;
        let below = (at as usize).min(255);
        self.0[below] + (self.0[below + 1] - self.0[below]) * (at - below as f32)
    }
}

/// The point where the way from `base` to `tip` leaves most of the wood around `base`.
fn leave(base: Vec3, tip: Vec3, radius_m: f32) -> Vec3 {
    let way = tip - base;
    base + way * (0.7 * radius_m / way.length().max(1e-9)).min(0.5)
}

/// A disc.
pub(super) fn dot(seen: Projected, radius_px: f32, color: Vec3, alpha: f32) -> Stroke {
    let (ends, half_widths, depth_m) = ([seen.at; 2], [radius_px; 2], seen.depth_m);
    Stroke { ends, half_widths, depth_m, alpha, color, bar: None, caps: [Cap::Round; 2] }
}

/// A value of each node by what bears out its radius; of wood that nobody measured, 0.
fn of_fits(skeleton: &Skeleton, value: impl Fn(&RadiusFit) -> f32) -> Vec<f32> {
    let mut values: Vec<f32> = skeleton.fits.iter().map(value).collect();
    values.resize(skeleton.positions.len(), 0.0);
    values
}

/// What each node is painted with, before light.
pub(crate) struct Colors<'a> {
    values: Values<'a>,
    /// Lowest value, and 1 ÷ (highest − lowest).
    scale: [f32; 2],
    table: Vec<Vec3>,
    /// One colour for all.
    plain: Option<Vec3>,
}

enum Values<'a> {
    /// As logarithms: a tip is as far from a twig as a bough from a trunk.
    Radii(&'a [f32]),
    Steps(Cow<'a, [u32]>),
    /// From 0 to 1.
    Shares(Vec<f32>),
}

impl<'a> Colors<'a> {
    pub fn new(skeleton: &'a Skeleton, style: &Style) -> Self {
        let values = match style.paint {
            Paint::Wood | Paint::Radius => Values::Radii(&skeleton.radii),
            Paint::Birth => Values::Steps(Cow::Borrowed(&skeleton.births)),
            Paint::Light => Values::Shares(sky_shares(skeleton, style.organs)),
            Paint::Source => Values::Shares(of_fits(skeleton, |fit| match fit.source {
                RadiusSource::Measured => 1.0,
                RadiusSource::Carried => 0.5,
                RadiusSource::Guessed => 0.0,
            })),
            Paint::Distance => Values::Shares(of_fits(skeleton, |fit| fit.gap_m / Paint::FAR_M)),
            Paint::Order => {
                let mut orders = vec![0; skeleton.positions.len()];
                for axis in &skeleton.axes {
                    for &node in skeleton.nodes_of(axis) {
                        orders[node as usize] = axis.order;
                    }
                }
                Values::Steps(Cow::Owned(orders))
            }
        };
        let scale = match &values {
            Values::Radii(radii) => {
                let positive = radii.iter().copied().filter(|&r| r > 0.0);
                let (min, max) = positive.fold((f32::INFINITY, 0.0_f32), |(a, b), r| (a.min(r), b.max(r)));
                let span = libm::logf(max / min);
                // All alike: as thick as any can be.
                if span > 1e-6 { [libm::logf(min), 1.0 / span] } else { [f32::MIN, 1.0] }
            }
            Values::Shares(_) => [0.0, 1.0],
            Values::Steps(steps) => [0.0, 1.0 / steps.iter().copied().max().unwrap_or(0).max(1) as f32],
        };
        let (trunk, twig) = (linear(style.trunk), linear(style.twig));
        let color = |t| if style.paint == Paint::Wood { twig.lerp(trunk, t) } else { ramp(t) };
        let table = (0_u8..=255).map(|i| color(f32::from(i) / 255.0)).collect();
        Self { values, scale, table, plain: None }
    }

    pub fn of(&self, node: u32) -> Vec3 {
        if let Some(plain) = self.plain {
            return plain;
        }
        let value = match &self.values {
            Values::Radii(radii) => match radii[node as usize] {
                r if r > 0.0 => libm::logf(r),
                _ => self.scale[0],
            },
            Values::Steps(steps) => steps[node as usize] as f32,
            Values::Shares(shares) => shares[node as usize],
        };
        let share = ((value - self.scale[0]) * self.scale[1]).clamp(0.0, 1.0);
        self.table[(share * 255.0 + 0.5) as usize]
    }
}
