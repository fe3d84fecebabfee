//! Meshes drawn on planes, without light and perspective: colours, alpha that a threshold can cut, and
//! normals in the plane's own tangent space. What billboards and branch cards are made of.

mod finish;
mod light;
mod raster;
mod texture;

use std::fmt::Debug;

use glam::{Vec2, Vec3};

use crate::scene::Material;
use linden_base::mesh::Mesh;
use linden_base::picture::{Picture, PictureKey};

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

/// A key of all that is drawn of a mesh.
pub(super) fn key_of_mesh(mesh: &Mesh) -> [u8; 16] {
    let Mesh { positions, normals, uvs, triangles } = mesh;
    let [positions, normals] = [positions, normals].map(|of| bytemuck::cast_slice(of));
    PictureKey::of(&[positions, normals, bytemuck::cast_slice(uvs), bytemuck::cast_slice(triangles)])
        .to_bytes()
}

/// All that decides how a material looks: its pictures by what they hold.
pub(super) fn look_of(material: &Material) -> impl Debug {
    let Material { base_color_picture, normal_picture, passing_picture, .. } = material;
    let pictures = [base_color_picture, normal_picture, passing_picture];
    let pictures = pictures.map(|picture| picture.as_ref().map(|picture| picture.content()));
    let plain = Material {
        base_color_picture: None,
        normal_picture: None,
        passing_picture: None,
        ..material.clone()
    };
    (plain, pictures)
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
