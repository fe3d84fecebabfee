//! Meshes drawn on planes, without light and perspective: colours, alpha that a threshold can cut, and
//! normals in the plane's own tangent space. What billboards and branch cards are made of.

mod finish;
mod light;
mod raster;
mod texture;

use glam::{Vec2, Vec3};

use linden_base::picture::Picture;

pub(super) use finish::{Finished, Pile, Plane, Resolved};
pub(super) use light::light_within;
pub(super) use raster::{Canvas, Drawn, View, draw};
pub(super) use texture::Texture;

/// Samples along a pixel's side.
pub(super) const SAMPLES: u32 = 2;
/// Pixels between what is drawn and the edge of its part of the picture: what neighbours and filters may mix in.
pub(super) const MARGIN_PX: u32 = 4;
/// The materials' threshold; the pictures' alpha is made to suit it.
pub(super) const CUTOUT: f32 = 0.5;

/// A place in a picture from its upper left corner, or a size.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Pixels {
    pub x: u32,
    pub y: u32,
}

impl Pixels {
    pub const fn new(x: u32, y: u32) -> Self {
        Self { x, y }
    }

    pub const fn times(self, factor: u32) -> Self {
        Self { x: self.x * factor, y: self.y * factor }
    }

    pub const fn to_vec2(self) -> Vec2 {
        Vec2::new(self.x as f32, self.y as f32)
    }

    pub const fn area(self) -> usize {
        self.x as usize * self.y as usize
    }
}

/// The mean of what is not cut out, linear.
pub(super) fn mean(picture: &Picture) -> [f32; 3] {
    let (mut sum, mut count) = (Vec3::ZERO, 0.0_f32);
    for &[r, g, b, a] in picture.rgba().as_chunks::<4>().0 {
        if f32::from(a) >= CUTOUT * 255.0 {
            sum += Vec3::from(linden_base::color::linear([r, g, b]));
            count += 1.0;
        }
    }
    (sum / count.max(1.0)).to_array()
}
