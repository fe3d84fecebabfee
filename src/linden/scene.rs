//! What an exporter is given: everything that can be seen, and where it came from.

use std::sync::Arc;

use bytemuck::allocation::zeroed_vec;
use glam::{Vec2, Vec3};

use crate::foliage::Instances;
use crate::memory::bytes_of;
use crate::picture::Picture;
use crate::skeleton::Skeleton;
use crate::wind::PartWind;

/// One tree, dressed: meshes, materials, the skeleton beneath and the recipe that grew it.
///
/// Metres, Y up, counter-clockwise triangles seen from outside.
#[derive(Clone, Debug)]
pub struct Scene {
    /// The tree's name: not empty; printable characters only, but any of them (an exporter makes
    /// an identifier of it).
    pub name: String,
    /// The recipe, one line of printable ASCII (JSON): enough to grow the same tree again.
    pub recipe: String,
    /// Parts refer to these by index.
    pub materials: Vec<Material>,
    /// The parts of the surface; at least one, none of them empty.
    pub parts: Vec<Part>,
    /// The axial tree beneath.
    pub skeleton: Arc<Skeleton>,
}

impl Scene {
    /// Bytes that it takes: skeleton, meshes and pixels.
    pub fn bytes(&self) -> u64 {
        let pixels =
            |picture: &Option<Arc<Picture>>| picture.as_ref().map_or(0, |own| own.rgba().len() as u64);
        let pictures = |own: &Material| pixels(&own.base_color_picture) + pixels(&own.normal_picture);
        self.skeleton.bytes()
            + self.materials.iter().map(pictures).sum::<u64>()
            + self.parts.iter().map(Part::bytes).sum::<u64>()
            // All parts hold on to the same organs.
            + self.parts.iter().find_map(|part| part.instances.as_ref()).map_or(0, Instances::bytes)
    }
}

/// A mesh with one material: the wood, say.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    /// Lower-case ASCII identifier, unique within the scene: `wood`.
    pub name: String,
    /// Index into [`Scene::materials`].
    pub material: usize,
    /// The geometry.
    pub mesh: Mesh,
    /// How its vertices swing; `None`: they do not.
    pub wind: Option<PartWind>,
    /// What its mesh was baked from, where that is copies of few meshes.
    pub instances: Option<Instances>,
}

impl Part {
    /// Without wind, of one piece.
    pub fn new(name: impl Into<String>, material: usize, mesh: Mesh) -> Self {
        Self { name: name.into(), material, mesh, wind: None, instances: None }
    }

    /// Bytes that it takes, without what it shares with other parts.
    pub fn bytes(&self) -> u64 {
        self.mesh.bytes() + self.wind.as_ref().map_or(0, PartWind::bytes)
    }
}

/// Triangles over shared vertices. The vertex arrays are of equal length.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// Metres.
    pub positions: Vec<Vec3>,
    /// Unit vectors, pointing out.
    pub normals: Vec<Vec3>,
    /// Texture coordinates, V up (the origin is the lower left corner of the picture).
    pub uvs: Vec<Vec2>,
    /// Vertex indices, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
}

impl Mesh {
    /// All zero: memory that nobody has touched yet.
    pub(crate) fn zeroed(vertices: usize, triangles: usize) -> Self {
        Self {
            positions: zeroed_vec(vertices),
            normals: zeroed_vec(vertices),
            uvs: zeroed_vec(vertices),
            triangles: zeroed_vec(triangles),
        }
    }

    /// Bytes that so many take.
    pub const fn bytes_for(vertices: usize, triangles: usize) -> u64 {
        bytes_of::<([f32; 3], [f32; 3], [f32; 2])>(vertices) + bytes_of::<[u32; 3]>(triangles)
    }

    /// Bytes that it takes, reserved places included.
    pub fn bytes(&self) -> u64 {
        let Self { positions, normals, uvs, triangles } = self;
        bytes_of::<Vec3>(positions.capacity() + normals.capacity())
            + bytes_of::<Vec2>(uvs.capacity())
            + bytes_of::<[u32; 3]>(triangles.capacity())
    }

    /// Smallest box around the vertices, `None` for a mesh without any.
    pub fn bounds(&self) -> Option<Bounds> {
        Bounds::of(self.positions.iter().copied())
    }
}

/// An axis-aligned box, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// The corner with the smallest coordinates.
    pub min: Vec3,
    /// The corner with the largest coordinates.
    pub max: Vec3,
}

impl Bounds {
    /// Smallest box around some points, `None` when there are none.
    pub fn of(points: impl IntoIterator<Item = Vec3>) -> Option<Self> {
        let mut points = points.into_iter();
        let first = points.next()?;
        Some(
            points
                .fold(Self { min: first, max: first }, |b, p| Self { min: b.min.min(p), max: b.max.max(p) }),
        )
    }

    /// Smallest box around both.
    #[must_use]
    pub fn union(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// Edge lengths, metres.
    pub fn size(self) -> Vec3 {
        self.max - self.min
    }
}

/// How a surface looks, in the terms that glTF and `UsdPreviewSurface` share.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// Lower-case ASCII identifier, unique within the scene: `bark`.
    pub name: String,
    /// Linear RGB 0..1: the colour where there is no picture; with one, pictures are used as they are.
    pub base_color: [f32; 3],
    /// sRGB colours, tileable.
    pub base_color_picture: Option<Arc<Picture>>,
    /// Tangent-space normals (OpenGL convention: green points up), tileable.
    pub normal_picture: Option<Arc<Picture>>,
    /// 0 mirror .. 1 chalk.
    pub roughness: f32,
    /// Whether the back is drawn too.
    pub double_sided: bool,
    /// Where the base colour picture's alpha is below this (above 0, below 1), nothing is drawn: cut
    /// out, never blended. `None`: all is opaque.
    pub cutout: Option<f32>,
    /// What is beyond the pictures' edges.
    pub wrap: Wrap,
}

/// What texture coordinates outside of 0..1 show.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Wrap {
    /// The picture again: bark.
    #[default]
    Repeat,
    /// The picture's edge: leaves.
    Clamp,
}
