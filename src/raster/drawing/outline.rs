//! A tapered polyline → rings.

use glam::Vec2;

use super::Drawing;

/// Cosine of the bend from which a join is a disc: below, the sides meet.
const SMOOTH: f32 = 0.94;
/// How far a chord of a disc may lie from it, pixels.
const FLATNESS_PX: f32 = 0.08;

/// A place of a tapered line.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    /// Pixels.
    pub at: Vec2,
    /// Half of the width there, pixels.
    pub half: f32,
}

/// Adds the rings of a line with round joins and a round end; it begins in a disc too where `round_start`.
/// All run the same way round, so that they may overlap.
pub(super) fn tapered(drawing: &mut Drawing, line: &[Place], round_start: bool) {
    let (Some(first), Some(last)) = (line.first(), line.last()) else { return };
    let way = |i: usize| (line[i + 1].at - line[i].at).normalize_or(Vec2::Y);
    let mut from = 0;
    for i in 1..line.len() {
        let bends = i + 1 < line.len() && way(i - 1).dot(way(i)) < SMOOTH;
        if i + 1 == line.len() || bends {
            side_by_side(drawing, &line[from..=i]);
            if bends {
                disc(drawing, line[i]);
            }
            from = i;
        }
    }
    if round_start || line.len() == 1 {
        disc(drawing, *first);
    }
    if line.len() > 1 {
        disc(drawing, *last);
    }
}

/// The ring of a part that bends little: along its one side and back along the other.
fn side_by_side(drawing: &mut Drawing, part: &[Place]) {
    let normal = |i: usize| {
        let before = i.checked_sub(1).map(|j| part[i].at - part[j].at);
        let after = part.get(i + 1).map(|next| next.at - part[i].at);
        let way = before.map_or(Vec2::ZERO, |way| way.normalize_or(Vec2::ZERO))
            + after.map_or(Vec2::ZERO, |way| way.normalize_or(Vec2::ZERO));
        way.normalize_or(Vec2::Y).perp()
    };
    let side = |i: usize, sign: f32| part[i].at + normal(i) * (sign * part[i].half);
    drawing.points.extend((0..part.len()).map(|i| side(i, 1.0)));
    drawing.points.extend((0..part.len()).rev().map(|i| side(i, -1.0)));
    drawing.end_line();
}

/// A disc as a ring, the same way round as [`side_by_side`].
pub(super) fn disc(drawing: &mut Drawing, place: Place) {
    if !(place.half > 0.0) {
        return;
    }
    // The sagitta of a chord over an angle a is r (1 - cos(a/2)).
    let half_angle = libm::acosf((1.0 - FLATNESS_PX / place.half).clamp(0.0, 0.92));
    let count = (std::f32::consts::PI / half_angle).ceil().clamp(6.0, 128.0) as usize;
    drawing.points.extend((0..count).map(|i| {
        let (sin, cos) = libm::sincosf(-(i as f32) * std::f32::consts::TAU / count as f32);
        place.at + Vec2::new(cos, sin) * place.half
    }));
    drawing.end_line();
}
