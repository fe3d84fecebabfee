//! Blades without lobes: a half width over the way from foot to tip.

use glam::Vec2;

use super::BladeLook;
use crate::texture::leaf::outline::Outline;
use linden_base::random::Key;

/// Points along one side.
const STEPS: usize = 96;

/// Half of an outline: below and above its widest place the half width is
/// (1 - (1 - s)^`power`)^`point`, where s runs from the end to the widest place. With the power 2 and
/// the point 0.5 that is an ellipse; 1 is an acute end, more a drawn-out one.
struct Profile {
    /// Where it is widest, 0..1.
    widest: f32,
    /// Power and point at the foot.
    foot: [f32; 2],
    /// Power and point at the tip.
    tip: [f32; 2],
}

/// Half a heart: x in half widths, y in lengths. After leaves of Tilia cordata and T. platyphyllos.
const HEART: [[f32; 2]; 14] = [
    [0.0, 0.0],
    [0.13, -0.05],
    [0.33, -0.092],
    [0.56, -0.078],
    [0.79, 0.0],
    [0.94, 0.125],
    [1.0, 0.27],
    [0.955, 0.42],
    [0.82, 0.575],
    [0.59, 0.715],
    [0.33, 0.825],
    [0.14, 0.893],
    [0.05, 0.945],
    [0.0, 1.0],
];

/// The outline, foot to tip and back.
pub(super) fn outline(look: &BladeLook, key: Key) -> Vec<Vec2> {
    let width = look.width.clamp(0.01, 2.0);
    // The two sides of a blade are never quite alike; a lime's least of all.
    let oblique = if look.outline == Outline::Cordate { 0.3 } else { 0.05 } * look.variation;
    let side = |name: &str, sign: f32| -> Vec<Vec2> {
        let uneven = key.named(name).between(-1.0, 1.0) as f32 * oblique;
        let points: Vec<Vec2> = if look.outline == Outline::Cordate {
            let knots: Vec<Vec2> = HEART
                .iter()
                .map(|&[x, y]| {
                    Vec2::new(x * (1.0 + 0.25 * uneven), if y < 0.0 { y * (1.0 + 2.0 * uneven) } else { y })
                })
                .collect();
            super::curve(&knots, STEPS / 12)
        } else {
            let profile = profile(look.outline);
            (0..=STEPS)
                .map(|i| {
                    // Closer together at both ends, where the outline turns.
                    let t = 0.5 - 0.5 * libm::cosf(i as f32 / STEPS as f32 * std::f32::consts::PI);
                    Vec2::new(profile.at(t) * (1.0 + uneven), t)
                })
                .collect()
        };
        points
            .into_iter()
            .map(|p| Vec2::new(sign * p.x * width / 2.0 * drawn_out(p.y, look.tip), p.y))
            .collect()
    };
    let mut outline = side("right", 1.0);
    let left = side("left", -1.0);
    // Both sides have the foot and the tip in common.
    outline.extend(left.into_iter().rev().skip(1));
    outline.pop();
    outline
}

/// Narrows or rounds the last two fifths of a blade.
pub(super) fn drawn_out(y: f32, tip: f32) -> f32 {
    let s = ((1.0 - y) / 0.4).clamp(0.0, 1.0);
    let power = (tip.clamp(0.0, 1.0) - 0.5) * if tip > 0.5 { 1.6 } else { 0.8 };
    if power == 0.0 || s == 0.0 { 1.0 } else { libm::powf(s * (2.0 - s), power) }
}

impl Profile {
    /// The half width as a share of the largest.
    fn at(&self, t: f32) -> f32 {
        let (s, [power, point]) = if t < self.widest {
            (t / self.widest, self.foot)
        } else {
            ((1.0 - t) / (1.0 - self.widest), self.tip)
        };
        let away = (1.0 - s).clamp(0.0, 1.0);
        libm::powf((1.0 - libm::powf(away, power)).max(0.0), point)
    }
}

fn profile(outline: Outline) -> Profile {
    let (widest, foot, tip) = match outline {
        Outline::Ovate => (0.4, [2.0, 0.6], [2.0, 0.9]),
        Outline::Obovate => (0.62, [1.8, 0.85], [2.2, 0.5]),
        Outline::Lanceolate => (0.32, [2.0, 0.85], [1.7, 1.15]),
        Outline::Linear => (0.35, [4.0, 0.4], [3.0, 0.8]),
        Outline::Orbicular => (0.47, [2.0, 0.46], [2.0, 0.52]),
        Outline::Rhombic => (0.32, [1.5, 0.82], [1.28, 1.28]),
        Outline::Deltoid => (0.21, [2.1, 0.5], [1.35, 1.24]),
        _ => (0.5, [2.0, 0.5], [2.0, 0.5]),
    };
    Profile { widest, foot, tip }
}
