//! Triangles, and boxes around them.

use bytemuck::allocation::zeroed_vec;
use glam::{Vec2, Vec3};

use crate::memory::bytes_of;

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
    /// All zero: memory that was not touched yet.
    pub fn zeroed(vertices: usize, triangles: usize) -> Self {
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

    /// The same mesh with the normals of smooth shading: of each vertex the mean of the triangles round it, by
    /// area; +Z where there are none.
    #[must_use]
    pub fn with_smooth_normals(mut self) -> Self {
        let mut sums = vec![Vec3::ZERO; self.positions.len()];
        for triangle in &self.triangles {
            let [a, b, c] = triangle.map(|v| self.positions[v as usize]);
            for &vertex in triangle {
                sums[vertex as usize] += (b - a).cross(c - a);
            }
        }
        self.normals = sums.into_iter().map(|sum| sum.normalize_or(Vec3::Z)).collect();
        self
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
    /// Its eight corners: x changes first, then y.
    pub fn corners(&self) -> [Vec3; 8] {
        let Self { min, max } = *self;
        std::array::from_fn(|i| {
            let pick = |bit: usize, low: f32, high: f32| if i & bit == 0 { low } else { high };
            Vec3::new(pick(1, min.x, max.x), pick(2, min.y, max.y), pick(4, min.z, max.z))
        })
    }

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
