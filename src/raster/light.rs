//! Light and air: what makes a form of a colour.

use glam::{Vec2, Vec3};

use crate::color::linear;
use crate::{Extent, Paint, Style, View};

/// Where the light comes from in the camera's axes (right, up, toward the lens): over the left
/// shoulder, turning with the camera so that every side of the tree is lit well.
const LIGHT: Vec3 = Vec3::new(-0.527, 0.685, 0.503);
/// How far the sun reaches round: 0 ends at the terminator, 1 lights the whole dark side a little.
const WRAP: f32 = 0.35;

/// Light on a surface whose normal is given in the camera's axes: a soft sky, and a sun whose
/// terminator is wrapped, so that the dark side keeps its form.
pub(crate) fn on_surface(normal: Vec3) -> f32 {
    brightness(normal.y, normal.dot(LIGHT))
}

fn brightness(up: f32, toward_sun: f32) -> f32 {
    0.24 + 0.10 * up + 1.10 * ((toward_sun + WRAP) / (1.0 + WRAP)).max(0.0)
}

/// A round bar's normals, seen from the lens: linear in how far across and how far toward the lens
/// a place lies.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bar {
    up: Vec2,
    sun: Vec2,
}

impl Bar {
    /// Along a direction of length 1 in the camera's axes.
    pub fn along(direction: Vec3) -> Self {
        // Seen along its axis a bar is a disc that faces the lens.
        let (side, facing) = match direction.cross(Vec3::Z).try_normalize() {
            Some(side) => (side, side.cross(direction)),
            None => (Vec3::ZERO, Vec3::Z),
        };
        Self { up: Vec2::new(side.y, facing.y), sun: Vec2::new(side.dot(LIGHT), facing.dot(LIGHT)) }
    }

    /// Light at `u`, -1 left to 1 right of the direction.
    pub fn at(&self, u: f32) -> f32 {
        let normal = Vec2::new(u, libm::sqrtf((1.0 - u * u).max(0.0)));
        brightness(self.up.dot(normal), self.sun.dot(normal))
    }

    /// The mean over the width.
    pub fn mean(&self) -> f32 {
        [-0.75, -0.25, 0.25, 0.75].map(|u| self.at(u)).iter().sum::<f32>() / 4.0
    }
}

/// The tree's volume: light falls on the crown as on a ball, is swallowed inside it, and fades
/// with distance.
pub(crate) struct Air<'a> {
    view: &'a View,
    middle: Vec3,
    half: Vec3,
    near_m: f32,
    depth_m: f32,
    haze: Vec3,
    haze_amount: f32,
}

impl<'a> Air<'a> {
    pub fn new(extent: &Extent, view: &'a View, style: &Style) -> Self {
        let middle = extent.middle();
        let reach = extent.radius().max(1e-6);
        Self {
            view,
            middle,
            half: Vec3::new(reach, (extent.height() / 2.0).max(1e-6), reach),
            near_m: view.project(middle).depth_m - reach,
            depth_m: 2.0 * reach,
            haze: linear(style.haze),
            // Where colour is a quantity it must stay readable.
            haze_amount: style.haze_amount.clamp(0.0, 1.0)
                * if style.paint == Paint::Wood { 1.0 } else { 0.4 },
        }
    }

    /// How much light there is at a place of the crown.
    pub fn light_at(&self, point: Vec3) -> f32 {
        let out = (point - self.middle) / self.half;
        let away = out.length().min(1.0);
        let sun = self.view.turn(out).dot(LIGHT);
        (0.62 + 0.38 * away) * (1.02 + 0.24 * sun)
    }

    /// The haze's share of what is seen at a depth.
    pub fn thickness(&self, depth_m: f32) -> f32 {
        let t = self.way(depth_m);
        self.haze_amount * t * t
    }

    /// The colour that distance fades to, linear light.
    pub const fn color(&self) -> Vec3 {
        self.haze
    }

    /// A colour at a depth.
    pub fn haze(&self, color: Vec3, depth_m: f32) -> Vec3 {
        color.lerp(self.haze, self.thickness(depth_m))
    }

    /// From the nearest place of the tree, 0, to the farthest, 1.
    pub fn way(&self, depth_m: f32) -> f32 {
        ((depth_m - self.near_m) / self.depth_m).clamp(0.0, 1.0)
    }

    /// Depths that are this near to each other look alike, metres.
    pub fn slice_m(&self) -> f32 {
        self.depth_m / 32.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bar_is_lit_as_its_surface() {
        for direction in [Vec3::Y, Vec3::X, Vec3::new(0.3, -0.5, 0.2).normalize()] {
            let bar = Bar::along(direction);
            for u in [-1.0_f32, -0.4, 0.0, 0.7, 1.0] {
                // The surface normal there: perpendicular to the bar, u of it sideways in the picture.
                let side = Vec3::new(direction.y, -direction.x, 0.0).normalize();
                let facing = side.cross(direction).normalize();
                let normal = side * u + facing * (1.0 - u * u).sqrt();
                assert!((bar.at(u) - on_surface(normal)).abs() < 1e-5, "{direction} {u}");
            }
        }
    }
}
