//! Places that can be taken hold of: discs over everything, with a rim that tells them from any colour below.

use glam::Vec2;

use super::overlay::faded;
use super::trace::dot;
use super::{Kind, Runs};
use crate::camera::Projected;
use crate::color::linear;
use crate::{Handle, Size, Style, View};

/// What tells a handle from any colour below it.
const RIM: [u8; 3] = [20, 20, 24];

/// Adds the handles of the style.
pub(super) fn trace(style: &Style, view: &View, size: Size, runs: &mut Runs) {
    let shorter = size.width().min(size.height()) as f32;
    let frame = Vec2::new(size.width() as f32, size.height() as f32);
    for handle in style.handles {
        let seen = view.project(handle.at);
        if !handle.at.is_finite() || seen.at.cmplt(Vec2::ZERO).any() || seen.at.cmpgt(frame).any() {
            continue;
        }
        // The nearest of all.
        let seen = Projected { depth_m: 0.0, ..seen };
        for (color, radius_px) in discs(handle, style, shorter) {
            runs.begin(Kind::Thick, dot(seen, radius_px, linear(color), 1.0));
        }
    }
}

/// The discs that a handle is, one over the other: sRGB, and radius in pixels. `shorter`: the shorter side of the
/// picture, pixels.
pub(crate) fn discs(handle: &Handle, style: &Style, shorter: f32) -> [([u8; 3], f32); 3] {
    let (radius_px, _) = faded(shorter / 70.0, 2.2, 9.0);
    let larger = if handle.is_picked { 1.35 } else { 1.0 };
    let core = if handle.is_picked { [255; 3] } else { style.mark };
    [(RIM, 1.0), (style.mark, 0.8), (core, 0.6)].map(|(color, share)| (color, radius_px * larger * share))
}
