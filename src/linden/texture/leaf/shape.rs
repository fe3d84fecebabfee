//! Outlines of single blades.

use glam::Vec2;

use super::LeafLook;

/// A blade widest in its middle, foot at the origin, tip at (0, 1).
pub(super) fn simple(look: &LeafLook) -> Vec<Vec2> {
    let (foot, width) = (look.petiole.clamp(0.0, 0.9), look.width.clamp(0.01, 2.0));
    let length = 1.0 - foot;
    (0..120)
        .map(|i| {
            let (s, c) = libm::sincosf(i as f32 / 120.0 * std::f32::consts::TAU);
            Vec2::new(c * width * length / 2.0, foot + length * (0.5 + 0.5 * s))
        })
        .collect()
}
