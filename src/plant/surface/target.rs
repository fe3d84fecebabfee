//! Where a surface is written, and how much of it.

use glam::{Vec2, Vec3};

/// How much a piece of surface is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Amount {
    /// Vertices.
    pub vertices: usize,
    /// Triangles.
    pub triangles: usize,
    /// Those of the vertices that are left of shed limbs: behind those of their stem.
    pub stubs: usize,
    /// Those of these vertices and triangles that are surface roots: the last ones of their stem.
    pub roots: [usize; 2],
}

impl Amount {
    /// Without roots among them.
    pub(super) const fn of(vertices: usize, triangles: usize) -> Self {
        Self { vertices, triangles, stubs: 0, roots: [0; 2] }
    }

    /// Both together.
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        Self {
            vertices: self.vertices + other.vertices,
            triangles: self.triangles + other.triangles,
            stubs: self.stubs + other.stubs,
            roots: [self.roots[0] + other.roots[0], self.roots[1] + other.roots[1]],
        }
    }
}

/// Where a tube is written: slices of exactly its [`Amount`].
pub(super) struct Target<'a> {
    pub positions: &'a mut [Vec3],
    pub normals: &'a mut [Vec3],
    pub uvs: &'a mut [Vec2],
    pub triangles: &'a mut [[u32; 3]],
    /// Index of the slices' first vertex in the whole mesh.
    pub first: u32,
    pub done: Amount,
}

impl Target<'_> {
    /// Index of the next vertex.
    pub fn next(&self) -> u32 {
        self.first + self.done.vertices as u32
    }

    pub fn vertex(&mut self, position: Vec3, normal: Vec3, uv: Vec2) {
        let i = self.done.vertices;
        self.positions[i] = position;
        self.normals[i] = normal;
        self.uvs[i] = uv;
        self.done.vertices = i + 1;
    }

    /// Of a vertex that was written.
    pub fn position(&self, index: u32) -> Vec3 {
        self.positions[(index - self.first) as usize]
    }

    /// Of a vertex that was written.
    pub fn normal(&self, index: u32) -> Vec3 {
        self.normals[(index - self.first) as usize]
    }

    /// Whether a triangle, from the given one on, faces away from its vertices' normals.
    pub fn is_folded(&self, first: usize) -> bool {
        self.triangles[first..self.done.triangles].iter().any(|&corners| {
            let [a, b, c] = corners.map(|i| self.position(i));
            let normals = corners.map(|i| self.normal(i)).iter().sum::<Vec3>();
            (b - a).cross(c - a).dot(normals) < 0.0
        })
    }

    pub fn triangle(&mut self, corners: [u32; 3]) {
        self.triangles[self.done.triangles] = corners;
        self.done.triangles += 1;
    }
}

/// A ring as it stands in the mesh.
pub(super) struct PlacedRing {
    /// Index of the vertex at angle 0; `sides + 1` vertices follow, the last one closes the seam.
    pub first: u32,
    pub sides: u32,
}
