//! What is drawn beside the wood: attraction points, the crown's outline, what stands in the way, a person.

use glam::{Vec2, Vec3};
use linden_pipeline::Monitor;
use linden_pipeline::memory::bytes_grown;

use super::trace::dot;
use super::{Cap, Kind, Run, Runs, Stroke, handles, obstructions};
use crate::color::linear;
use crate::light::Air;
use crate::person::{LIMBS, Person};
use crate::{Extent, RasterError, Size, Style, View};

/// Points between two looks at the monitor.
const CHECK_EVERY: usize = 1 << 14;
/// Opacity of the outline before the tree and behind it.
const LINE_ALPHA: [f32; 2] = [0.75, 0.3];

/// Bytes that [`trace`] takes at most for the points: a stroke and a run each, in lists that grow.
pub(crate) fn bytes(style: &Style) -> u64 {
    let points = bytes_grown::<Stroke>(style.points.len()) + bytes_grown::<Run>(style.points.len());
    points + obstructions::bytes(style)
}

/// Everything that the style lays over the tree.
pub(crate) fn trace(
    style: &Style,
    framed: &Extent,
    view: &View,
    air: &Air,
    size: Size,
    monitor: &dyn Monitor,
) -> Result<Runs, RasterError> {
    let mut runs = Runs::default();
    obstructions::trace(style, framed, view, air, size, &mut runs, monitor)?;
    let frame = Vec2::new(size.width() as f32, size.height() as f32);
    let color = style.point_colors();
    let (radius_px, alpha) = faded(frame.min_element() / 400.0, 0.5, 3.0);
    for (i, &point) in style.points.iter().enumerate() {
        if i % CHECK_EVERY == 0 {
            monitor.check()?;
        }
        let seen = view.project(point);
        if point.is_finite() && seen.at.cmpge(Vec2::ZERO).all() && seen.at.cmple(frame).all() {
            runs.begin(
                Kind::Thick,
                dot(seen, radius_px, air.haze(color(i), seen.depth_m), 0.85 * alpha * alpha),
            );
        }
    }
    let (width_px, alpha) = faded(frame.min_element() / 500.0, 0.7, 2.0);
    let pen = Pen { half_px: width_px / 2.0, alpha, color: linear(style.line), is_over: false };
    for (i, line) in style.outline.iter().enumerate() {
        if i % 1024 == 0 {
            monitor.check()?;
        }
        outline(line, &pen, framed, view, air, frame, &mut runs);
    }
    let (width_px, alpha) = faded(frame.min_element() / 130.0, 1.2, 7.0);
    let pen = Pen { half_px: width_px / 2.0, alpha, color: linear(style.mark), is_over: true };
    for line in style.marked {
        monitor.check()?;
        outline(line, &pen, framed, view, air, frame, &mut runs);
    }
    handles::trace(style, view, size, &mut runs);
    if style.person
        && let Some(person) = framed.person
    {
        draw_person(person, linear(style.person_color), framed, view, &mut runs);
    }
    Ok(runs)
}

/// What an outline is drawn with.
pub(super) struct Pen {
    pub half_px: f32,
    pub alpha: f32,
    pub color: Vec3,
    /// Whether it lies over everything, however far away.
    pub is_over: bool,
}

/// A width between two, and how opaque it is: in a small picture, what should be thinner still must
/// not bury the tree.
pub(super) fn faded(ideal_px: f32, least_px: f32, most_px: f32) -> (f32, f32) {
    (ideal_px.clamp(least_px, most_px), libm::sqrtf((ideal_px / least_px).min(1.0)))
}

/// One polyline, in pieces that are short enough to be sorted among the branches.
pub(super) fn outline(
    line: &[Vec3],
    pen: &Pen,
    framed: &Extent,
    view: &View,
    air: &Air,
    frame: Vec2,
    runs: &mut Runs,
) {
    let longest_m = (framed.height().max(2.0 * framed.radius()) / 24.0).max(1e-6);
    for (i, pair) in line.windows(2).enumerate() {
        let [from, to] = [pair[0], pair[1]];
        if !from.is_finite() || !to.is_finite() {
            continue;
        }
        let pieces = (from.distance(to) / longest_m).ceil().clamp(1.0, 64.0);
        for k in 0..pieces as u32 {
            let at = |n: u32| view.project(from.lerp(to, n as f32 / pieces));
            let (a, b) = (at(k), at(k + 1));
            let margin = Vec2::splat(2.0);
            if a.at.max(b.at).cmplt(-margin).any() || a.at.min(b.at).cmpgt(frame + margin).any() {
                continue;
            }
            let depth_m = if pen.is_over { 0.0 } else { f32::midpoint(a.depth_m, b.depth_m) };
            let [before, behind] = if pen.is_over { [0.9; 2] } else { LINE_ALPHA };
            let stroke = Stroke {
                ends: [a.at, b.at],
                half_widths: [pen.half_px; 2],
                depth_m,
                alpha: pen.alpha * (before + (behind - before) * air.way(depth_m)),
                color: if pen.is_over { pen.color } else { air.haze(pen.color, depth_m) },
                bar: None,
                caps: [if pen.is_over { Cap::Round } else { Cap::Cut }; 2],
            };
            let is_first = i == 0 && k == 0;
            if is_first {
                runs.begin(Kind::Thin, stroke);
            } else {
                runs.follow(Kind::Thin, stroke, air.slice_m());
            }
        }
    }
}

/// Turned to the lens, upright as seen.
fn draw_person(person: Person, color: Vec3, framed: &Extent, view: &View, runs: &mut Runs) {
    let place = person.place(framed, view);
    let seen = view.project(place);
    for limb in &LIMBS {
        let at = limb.ends.map(|p| view.project(place + view.right() * p.x + Vec3::Y * p.y).at);
        let stroke = Stroke {
            ends: at,
            half_widths: limb.radii.map(|r| r * seen.scale),
            depth_m: seen.depth_m,
            alpha: 1.0,
            color,
            bar: None,
            caps: [Cap::Round; 2],
        };
        runs.begin(Kind::Thick, stroke);
    }
}
