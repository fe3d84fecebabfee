//! Measures whether a surface is closed, from its triangles alone.

use std::cmp::Ordering;

use glam::Vec3;
use rayon::prelude::*;

use crate::scene::Mesh;

/// What the triangles say about the surface, after vertices at the same place are made one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Topology {
    /// Directed edges without a triangle on the other side: holes, or neighbours wound differently.
    pub open_edges: usize,
    /// Triangles without area.
    pub degenerate: usize,
    /// Triangles that look the other way than their vertices' normals.
    pub flipped: usize,
    /// Positions, normals or coordinates that are not finite.
    pub not_finite: usize,
}

impl Topology {
    /// Closed and consistently wound: each tube keeps water in. Tubes may overlap one another.
    pub fn watertight(&self) -> bool {
        self.open_edges == 0 && self.degenerate == 0
    }
}

/// Measures a mesh.
pub fn topology(mesh: &Mesh) -> Topology {
    let welded = weld(&mesh.positions);
    let sums = mesh.triangles.par_iter().map(|triangle| {
        let [a, b, c] = triangle.map(|i| welded[i as usize]);
        let [p, q, r] = triangle.map(|i| mesh.positions[i as usize].as_dvec3());
        let normal = (q - p).cross(r - p);
        let leaning: Vec3 = triangle.iter().map(|&i| mesh.normals[i as usize]).sum();
        let degenerate = a == b || b == c || c == a || normal.length_squared() == 0.0;
        let flipped = !degenerate && normal.dot(leaning.as_dvec3()) <= 0.0;
        (usize::from(degenerate), usize::from(flipped))
    });
    let (degenerate, flipped) = sums.reduce(|| (0, 0), |a, b| (a.0 + b.0, a.1 + b.1));
    let not_finite = mesh.positions.iter().chain(&mesh.normals).filter(|v| !v.is_finite()).count()
        + mesh.uvs.iter().filter(|v| !v.is_finite()).count();
    Topology { open_edges: open_edges(&mesh.triangles, &welded), degenerate, flipped, not_finite }
}

/// Edges that are not run as often one way as the other.
fn open_edges(triangles: &[[u32; 3]], welded: &[u32]) -> usize {
    let (mut rising, mut falling) = (Vec::new(), Vec::new());
    for triangle in triangles {
        let [a, b, c] = triangle.map(|i| u64::from(welded[i as usize]));
        for (from, to) in [(a, b), (b, c), (c, a)] {
            if from < to { rising.push(from << 32 | to) } else { falling.push(to << 32 | from) }
        }
    }
    rayon::join(|| rising.par_sort_unstable(), || falling.par_sort_unstable());
    // The two lists are merged; what one has more often than the other is open.
    let (mut i, mut j, mut open) = (0, 0, 0);
    while i < rising.len() && j < falling.len() {
        match rising[i].cmp(&falling[j]) {
            Ordering::Equal => (i, j) = (i + 1, j + 1),
            Ordering::Less => (i, open) = (i + 1, open + 1),
            Ordering::Greater => (j, open) = (j + 1, open + 1),
        }
    }
    open + (rising.len() - i) + (falling.len() - j)
}

/// For each vertex the lowest index of a vertex at exactly the same place.
fn weld(positions: &[Vec3]) -> Vec<u32> {
    // Adding zero makes -0.0 and 0.0 one place.
    let key = |i: u32| (positions[i as usize] + Vec3::ZERO).to_array().map(f32::to_bits);
    let mut order: Vec<u32> = (0..positions.len() as u32).collect();
    order.par_sort_unstable_by_key(|&i| (key(i), i));
    let mut welded = vec![0; positions.len()];
    for same in order.chunk_by(|&a, &b| key(a) == key(b)) {
        for &i in same {
            welded[i as usize] = same[0];
        }
    }
    welded
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec2;

    /// A tetrahedron with vertices of its own for each face.
    fn tetrahedron() -> Mesh {
        let corners = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
        let mut mesh = Mesh::default();
        for face in [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]] {
            let [a, b, c] = face.map(|i: usize| corners[i]);
            let first = mesh.positions.len() as u32;
            mesh.positions.extend([a, b, c]);
            mesh.normals.extend([(b - a).cross(c - a).normalize(); 3]);
            mesh.uvs.extend([Vec2::ZERO; 3]);
            mesh.triangles.push([first, first + 1, first + 2]);
        }
        mesh
    }

    #[test]
    fn a_tetrahedron_is_closed_and_each_damage_is_seen() {
        assert_eq!(topology(&tetrahedron()), Topology::default());

        let mut hole = tetrahedron();
        hole.triangles.pop();
        assert_eq!(topology(&hole).open_edges, 3);

        let mut turned = tetrahedron();
        turned.triangles[0].swap(0, 1);
        assert_eq!((topology(&turned).open_edges, topology(&turned).flipped), (6, 1));

        let mut flat = tetrahedron();
        flat.positions[0] = flat.positions[1];
        assert_eq!(topology(&flat).degenerate, 1);

        let mut broken = tetrahedron();
        broken.normals[2].y = f32::NAN;
        assert_eq!(topology(&broken).not_finite, 1);
    }
}
