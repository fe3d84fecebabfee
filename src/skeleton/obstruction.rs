//! What stands beside a tree, as pictures show it.

use glam::Vec3;
use linden_base::memory::bytes_of;

/// Something beside a tree that it grows round, or in the shade of which it grows less.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Obstruction {
    /// What it does to the tree.
    pub effect: Obstructs,
    /// Corners of its surface, metres.
    pub positions: Vec<Vec3>,
    /// Indices of `positions`, each in range; of a closed surface, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
    /// The edges between triangles: the two of those, by their indices; a rim has the same one twice.
    pub edges: Vec<FaceEdge>,
}

/// An edge of an [`Obstruction`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FaceEdge {
    /// Its ends, indices of positions.
    pub ends: [u32; 2],
    /// The triangles on its sides; the same one twice where it has one alone.
    pub sides: [u32; 2],
}

/// What an [`Obstruction`] does to a tree.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Obstructs {
    /// No branch enters it.
    Branches,
    /// The tree grows less in it.
    Light,
}

impl Obstruction {
    /// Of triangles that share corners with their neighbours. Triangles with a corner that is not there or nowhere
    /// are left out; a surface that was turned inside out is turned back.
    pub fn new(effect: Obstructs, positions: Vec<Vec3>, mut triangles: Vec<[u32; 3]>) -> Self {
        triangles.retain(|t| {
            t.iter().all(|&corner| positions.get(corner as usize).is_some_and(|place| place.is_finite()))
        });
        let six_volumes: f64 = triangles
            .iter()
            .map(|t| {
                let [a, b, c] = t.map(|corner| positions[corner as usize].as_dvec3());
                a.dot(b.cross(c))
            })
            .sum();
        if six_volumes < 0.0 {
            for triangle in &mut triangles {
                triangle.swap(1, 2);
            }
        }
        let edges = edges(&triangles);
        Self { effect, positions, triangles, edges }
    }

    /// Bytes that it takes.
    pub fn bytes(&self) -> u64 {
        bytes_of::<Vec3>(self.positions.capacity())
            + bytes_of::<[u32; 3]>(self.triangles.capacity())
            + bytes_of::<FaceEdge>(self.edges.capacity())
    }

    /// The corners of a triangle, metres.
    pub fn corners(&self, triangle: u32) -> [Vec3; 3] {
        self.triangles[triangle as usize].map(|corner| self.positions[corner as usize])
    }
}

fn edges(triangles: &[[u32; 3]]) -> Vec<FaceEdge> {
    let mut uses: Vec<([u32; 2], u32)> = Vec::with_capacity(3 * triangles.len());
    for (&[a, b, c], i) in triangles.iter().zip(0..) {
        uses.extend([(a, b), (b, c), (c, a)].map(|(from, to)| ([from.min(to), from.max(to)], i)));
    }
    uses.sort_unstable();
    let edge = |uses: &[([u32; 2], u32)]| {
        let (ends, first) = uses[0];
        FaceEdge { ends, sides: [first, uses.get(1).map_or(first, |(_, second)| *second)] }
    };
    uses.chunk_by(|a, b| a.0 == b.0).map(edge).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A tetrahedron, inside out where `turned`.
    fn tetrahedron(turned: bool) -> Obstruction {
        let positions = vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
        let mut triangles = vec![[0, 2, 1], [0, 3, 2], [0, 1, 3], [1, 2, 3]];
        if turned {
            for triangle in &mut triangles {
                triangle.swap(0, 1);
            }
        }
        Obstruction::new(Obstructs::Branches, positions, triangles)
    }

    #[test]
    fn faces_look_outwards_whichever_way_they_were_given() {
        for turned in [false, true] {
            let solid = tetrahedron(turned);
            for triangle in 0..4 {
                let [a, b, c] = solid.corners(triangle);
                let outwards = (a + b + c) / 3.0 - Vec3::splat(0.25);
                assert!((b - a).cross(c - a).dot(outwards) > 0.0, "{turned} {triangle}");
            }
        }
    }

    #[test]
    fn an_edge_lies_between_two_triangles_and_a_rim_at_one() {
        let solid = tetrahedron(false);
        assert_eq!(solid.edges.len(), 6);
        assert!(solid.edges.iter().all(|edge| edge.sides[0] != edge.sides[1]));
        let open = Obstruction::new(Obstructs::Light, solid.positions.clone(), vec![[0, 1, 2], [0, 1, 99]]);
        assert_eq!(open.triangles.len(), 1, "a corner that is not there");
        assert!(open.edges.len() == 3 && open.edges.iter().all(|edge| edge.sides == [0, 0]));
    }
}
