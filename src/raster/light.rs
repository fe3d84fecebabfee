//! Light and air: what makes a form of a colour.

use glam::{Vec2, Vec3};

use crate::color::linear;
use crate::shade::Shade;
use crate::{Extent, Paint, Style, View};

/// Where the sun stands: to the right as the camera sees it, up, and toward the lens; over the left
/// shoulder, turning with the camera so that every side of the tree is lit well. The camera's height does
/// not move it.
const SUN: Vec3 = Vec3::new(-0.577, 0.700, 0.421);
/// How far the sun reaches round: 0 ends at the terminator, 1 lights the whole dark side a little.
const WRAP: f32 = 0.25;
/// The same for leaves, through which it shines.
const LEAF_WRAP: f32 = 0.6;
/// How far the normals of leaves are bent out of the crown, a share: a crown then has the light of a
/// body, and its leaves that of its surface.
const BENT: f32 = 0.55;
/// Strengths of the sun, of the sky above, and of what the ground gives back.
const SUNSHINE: f32 = 1.22;
const SKYLIGHT: f32 = 0.44;
const BOUNCE: f32 = 0.16;
/// What is left of the sun and the sky in the deepest shade: leaves scatter light.
const LEAST: Vec2 = Vec2::new(0.04, 0.26);
/// Colours of the sun and of the sky, linear light; white light is between them.
const SUN_COLOR: Vec3 = Vec3::new(1.05, 1.0, 0.90);
const SKY_COLOR: Vec3 = Vec3::new(0.88, 0.99, 1.16);

/// Light that falls on a place.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Lit {
    /// Of the sun.
    pub sun: f32,
    /// Of the sky, and from the ground.
    pub sky: f32,
}

impl Lit {
    /// What a colour looks like in it.
    pub fn on(self, color: Vec3) -> Vec3 {
        color * (SUN_COLOR * self.sun + SKY_COLOR * self.sky)
    }
}

/// A round bar's normals, seen from the lens: linear in how far across and how far toward the lens
/// a place lies.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bar {
    up: Vec2,
    sun: Vec2,
    /// Shares of the sun and the sky that reach it.
    left: Vec2,
}

impl Bar {
    /// Light at `u`, -1 left to 1 right of the direction.
    pub fn at(&self, u: f32) -> Lit {
        let normal = Vec2::new(u, libm::sqrtf((1.0 - u * u).max(0.0)));
        falling(self.up.dot(normal), self.sun.dot(normal), WRAP, self.left)
    }

    /// The mean over the width.
    pub fn mean(&self) -> Lit {
        let all = [-0.75, -0.25, 0.25, 0.75].map(|u| self.at(u));
        let mean = |of: fn(&Lit) -> f32| all.iter().map(of).sum::<f32>() / 4.0;
        Lit { sun: mean(|lit| lit.sun), sky: mean(|lit| lit.sky) }
    }
}

/// Light on a surface by how far its normal points up and toward the sun.
fn falling(up: f32, toward_sun: f32, wrap: f32, left: Vec2) -> Lit {
    let sun = SUNSHINE * ((toward_sun + wrap) / (1.0 + wrap)).max(0.0);
    let sky = SKYLIGHT * (0.72 + 0.28 * up);
    let bounce = BOUNCE * (0.5 - 0.5 * up);
    Lit { sun: sun * left.x, sky: sky * left.y + bounce * (0.4 + 0.6 * left.y) }
}

/// The direction of the sun in the world, length 1.
pub(crate) fn sun(view: &View) -> Vec3 {
    let right = view.right();
    right * SUN.x + Vec3::Y * SUN.y + right.cross(Vec3::Y) * SUN.z
}

/// The tree's volume: light is swallowed inside it, and fades with distance.
pub(crate) struct Air<'a> {
    view: &'a View,
    shade: Shade,
    /// How deep shade is: where colour is a quantity it must stay readable.
    depth: f32,
    /// In the camera's axes.
    sun: Vec3,
    up: Vec3,
    middle: Vec3,
    half: Vec3,
    near_m: f32,
    depth_m: f32,
    haze: Vec3,
    haze_amount: f32,
}

impl<'a> Air<'a> {
    /// `shown`: how deep shade is, a share.
    pub fn new(extent: &Extent, view: &'a View, style: &Style, shade: Shade, shown: f32) -> Self {
        let middle = extent.middle();
        let reach = extent.radius().max(1e-6);
        let is_wood = style.paint == Paint::Wood;
        Self {
            view,
            shade,
            depth: if is_wood { shown } else { 0.35 },
            sun: view.turn(sun(view)),
            up: view.turn(Vec3::Y),
            middle,
            half: Vec3::new(reach, (extent.height() / 2.0).max(1e-6), reach),
            near_m: view.project(middle).depth_m - reach,
            depth_m: 2.0 * reach,
            haze: linear(style.haze),
            haze_amount: style.haze_amount.clamp(0.0, 1.0) * if is_wood { 1.0 } else { 0.4 },
        }
    }

    /// Shares of the sun and the sky that reach a place.
    fn left_at(&self, place: Vec3) -> Vec2 {
        let left = LEAST + (Vec2::ONE - LEAST) * Vec2::from(self.shade.at(place));
        Vec2::ONE.lerp(left, self.depth)
    }

    /// Light on a leaf, by its normal in the world, either of the two.
    pub fn on_leaf(&self, place: Vec3, normal: Vec3) -> Lit {
        let flat = self.view.turn(normal);
        let flat = if flat.z < 0.0 { -flat } else { flat };
        let out = self.view.turn((place - self.middle) / self.half).normalize_or(Vec3::Z);
        let normal = flat.lerp(out, BENT).normalize_or(Vec3::Z);
        falling(normal.dot(self.up), normal.dot(self.sun), LEAF_WRAP, self.left_at(place))
    }

    /// Light on a closed surface, by its normal in the world.
    pub fn on_surface(&self, place: Vec3, normal: Vec3) -> Lit {
        let normal = self.view.turn(normal);
        falling(normal.dot(self.up), normal.dot(self.sun), WRAP, self.left_at(place))
    }

    /// A bar along a direction in the world, of length 1.
    pub fn bar(&self, place: Vec3, direction: Vec3) -> Bar {
        let direction = self.view.turn(direction);
        // Seen along its axis a bar is a disc that faces the lens.
        let (side, facing) = match direction.cross(Vec3::Z).try_normalize() {
            Some(side) => (side, side.cross(direction)),
            None => (Vec3::ZERO, Vec3::Z),
        };
        Bar {
            up: Vec2::new(side.dot(self.up), facing.dot(self.up)),
            sun: Vec2::new(side.dot(self.sun), facing.dot(self.sun)),
            left: self.left_at(place),
        }
    }

    /// The shade of the tree.
    pub const fn shade(&self) -> &Shade {
        &self.shade
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
    use crate::extent::RINGS;
    use crate::shade::Cells;
    use crate::{Camera, Size};

    #[test]
    fn a_bar_is_lit_as_its_surface() {
        let extent = Extent { x: 0.0, z: 0.0, bottom: 0.0, top: 2.0, radii: [1.0; RINGS], person: None };
        let view = Camera::orbit(33.0, 21.0).view(extent, Size::new(50, 50).unwrap());
        let shade = Cells::around(&extent, false).lit(sun(&view));
        let air = Air::new(&extent, &view, &Style::studio(), shade, 1.0);
        for direction in [Vec3::Y, Vec3::X, Vec3::new(0.3, -0.5, 0.2).normalize()] {
            let bar = air.bar(Vec3::Y, direction);
            let seen = view.turn(direction);
            for u in [-1.0_f32, -0.4, 0.0, 0.7, 1.0] {
                // The surface normal there: perpendicular to the bar, u of it sideways in the picture.
                let side = Vec3::new(seen.y, -seen.x, 0.0).normalize();
                let facing = side.cross(seen).normalize();
                let normal = side * u + facing * (1.0 - u * u).sqrt();
                let world = view.right() * normal.x
                    + view.turned_back(Vec3::Y) * normal.y
                    + view.turned_back(Vec3::Z) * normal.z;
                let surface = air.on_surface(Vec3::Y, world);
                let lit = bar.at(u);
                assert!(
                    (lit.sun - surface.sun).abs() + (lit.sky - surface.sky).abs() < 1e-5,
                    "{direction} {u}"
                );
            }
        }
    }
}
