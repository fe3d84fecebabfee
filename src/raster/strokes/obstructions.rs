//! What stands beside the tree: solids that can be seen through, with their outlines.
//!
//! Facets are small, so that branches lie before, in and behind a solid as they do. Those of a side that are about as
//! far away are drawn as one: where they meet each by itself would show its seam.

use std::collections::BTreeMap;

use glam::{Vec2, Vec3};
use linden_pipeline::Monitor;
use linden_pipeline::grow::{Obstruction, Obstructs};
use linden_pipeline::memory::bytes_grown;

use super::overlay::{Pen, faded, outline};
use super::{Facet, Run, Runs, Stroke};
use crate::color::linear;
use crate::light::Air;
use crate::{Extent, RasterError, Size, Style, View};

/// Facets of a solid along its longest side, at most: what is large is cut, to be sorted among branches.
const FACETS: f32 = 40.0;
/// No facet needs to be smaller than this share of what is framed.
const FINEST: f32 = 1.0 / 20.0;
/// How much a face of a solid hides, and of a place in shade; most rays pass two.
const SOLID: f32 = 0.3;
const SHADE: f32 = 0.11;
/// Cosine of the angle between two faces from which their edge is drawn.
const CREASE: f32 = 0.6;
/// Dashes round what takes light away, in shares of what is framed.
const DASH: f32 = 1.0 / 40.0;
/// Triangles between two looks at the monitor.
const CHECK_EVERY: usize = 1 << 10;

/// Bytes that [`trace`] takes at most.
pub(crate) fn bytes(style: &Style) -> u64 {
    let pieces = |solid: &Obstruction| {
        // Cut facets of a smooth solid are about as many as squares on it.
        let facets = solid.triangles.len() + (2.0 * FACETS * FACETS) as usize;
        let edges = solid.edges.len() * 4;
        bytes_grown::<Facet>(facets) + bytes_grown::<Stroke>(edges) + bytes_grown::<Run>(facets + edges)
    };
    style.obstructions.iter().map(pieces).sum()
}

/// Adds all obstructions of the style.
pub(super) fn trace(
    style: &Style,
    framed: &Extent,
    view: &View,
    air: &Air,
    size: Size,
    runs: &mut Runs,
    monitor: &dyn Monitor,
) -> Result<(), RasterError> {
    let frame = Vec2::new(size.width() as f32, size.height() as f32);
    let framed_m = framed.height().max(2.0 * framed.radius()).max(1e-6);
    let (width_px, faded_alpha) = faded(frame.min_element() / 420.0, 0.9, 2.5);
    let slice_m = air.slice_m().max(framed_m * 1e-3);
    for solid in style.obstructions {
        let color = linear(match solid.effect {
            Obstructs::Branches => style.obstacle,
            Obstructs::Light => style.shade,
        });
        let alpha = if solid.effect == Obstructs::Branches { SOLID } else { SHADE };
        let tracer = Tracer { solid, view, air, frame, color, alpha };
        let longest_m = longest_m(solid, framed_m);
        let mut slices = Slices::new();
        for triangle in 0..solid.triangles.len() {
            if triangle % CHECK_EVERY == 0 {
                monitor.check()?;
            }
            let corners = solid.corners(triangle as u32);
            let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalize_or(Vec3::Y);
            // The far side is seen from within.
            let is_near = is_facing(solid, triangle as u32, view);
            tracer.cut(corners, if is_near { normal } else { -normal }, longest_m, &mut |facet, depth_m| {
                let slice = slices.entry((is_near, (depth_m / slice_m) as u32)).or_default();
                slice.0.push(facet);
                slice.1 += depth_m;
            });
        }
        for (facets, depths_m) in slices.values() {
            runs.facets(facets, depths_m / facets.len() as f32);
        }
        let pen = Pen { half_px: width_px / 2.0, alpha: faded_alpha, color: color * 0.7, is_over: false };
        for (i, line) in lines(solid, view).enumerate() {
            if i % CHECK_EVERY == 0 {
                monitor.check()?;
            }
            match solid.effect {
                Obstructs::Branches => outline(&line, &pen, framed, view, air, frame, runs),
                Obstructs::Light => {
                    for dash in dashes(line, framed_m * DASH) {
                        outline(&dash, &pen, framed, view, air, frame, runs);
                    }
                }
            }
        }
    }
    Ok(())
}

/// Facets of the near and of the far side of a solid, by how far away they are, and the sum of their depths.
type Slices = BTreeMap<(bool, u32), (Vec<Facet>, f32)>;

/// The longest side of a facet, metres.
fn longest_m(solid: &Obstruction, framed_m: f32) -> f32 {
    let ends = |of: fn(Vec3, Vec3) -> Vec3| solid.positions.iter().copied().reduce(of).unwrap_or(Vec3::ZERO);
    let size_m = (ends(Vec3::max) - ends(Vec3::min)).max_element();
    (size_m / FACETS).max(framed_m * FINEST).max(1e-6)
}

/// The edges of a solid that draw it from here: where it turns away, where it is open, and where it is sharp.
pub(crate) fn lines<'a>(solid: &'a Obstruction, view: &'a View) -> impl Iterator<Item = [Vec3; 2]> + 'a {
    let facing: Vec<bool> =
        (0..solid.triangles.len()).map(|triangle| is_facing(solid, triangle as u32, view)).collect();
    let normal = |triangle: u32| {
        let [a, b, c] = solid.corners(triangle);
        (b - a).cross(c - a).normalize_or(Vec3::ZERO)
    };
    solid.edges.iter().filter_map(move |edge| {
        let [one, other] = edge.sides;
        let turns = one == other || facing[one as usize] != facing[other as usize];
        let is_sharp = || facing[one as usize] && normal(one).dot(normal(other)) < CREASE;
        (turns || is_sharp()).then(|| edge.ends.map(|end| solid.positions[end as usize]))
    })
}

/// Whether a triangle shows its outer side.
pub(crate) fn is_facing(solid: &Obstruction, triangle: u32, view: &View) -> bool {
    let [a, b, c] = solid.corners(triangle);
    (b - a).cross(c - a).dot(view.eye() - a) > 0.0
}

/// Every other piece of a line.
pub(crate) fn dashes([from, to]: [Vec3; 2], dash_m: f32) -> impl Iterator<Item = [Vec3; 2]> {
    let pieces = (from.distance(to) / dash_m).ceil().clamp(1.0, 256.0) as u32;
    let at = move |share: f32| from.lerp(to, share / pieces as f32);
    (0..pieces).map(move |i| [at(i as f32), at(i as f32 + 0.55)])
}

struct Tracer<'a> {
    solid: &'a Obstruction,
    view: &'a View,
    air: &'a Air<'a>,
    frame: Vec2,
    color: Vec3,
    alpha: f32,
}

impl Tracer<'_> {
    /// A triangle in pieces none of which is longer than `longest_m`.
    fn cut(&self, [a, b, c]: [Vec3; 3], normal: Vec3, longest_m: f32, each: &mut impl FnMut(Facet, f32)) {
        let sides = [a.distance(b), b.distance(c), c.distance(a)];
        let longest = sides.iter().copied().fold(0.0, f32::max);
        if longest > longest_m {
            let (p, q, r) = if longest == sides[0] {
                (a, b, c)
            } else if longest == sides[1] {
                (b, c, a)
            } else {
                (c, a, b)
            };
            let middle = p.midpoint(q);
            self.cut([p, middle, r], normal, longest_m, each);
            self.cut([middle, q, r], normal, longest_m, each);
            return;
        }
        let placed = [a, b, c].map(|p| self.view.project(p));
        let corners = placed.map(|p| p.at);
        let [low, high] = [Vec2::min, Vec2::max].map(|of| of(of(corners[0], corners[1]), corners[2]));
        if high.cmplt(Vec2::ZERO).any() || low.cmpgt(self.frame).any() {
            return;
        }
        let depth_m = placed.iter().map(|p| p.depth_m).sum::<f32>() / 3.0;
        let color = match self.solid.effect {
            Obstructs::Branches => self.air.on_surface((a + b + c) / 3.0, normal).on(self.color),
            Obstructs::Light => self.color,
        };
        let facet = Facet { corners, color: self.air.haze(color, depth_m), alpha: self.alpha };
        each(facet, depth_m);
    }
}
