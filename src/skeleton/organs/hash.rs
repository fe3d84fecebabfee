//! A fingerprint of organs.

use linden_base::mesh::Mesh;

use super::{LeafShape, OrganOrigins, Organs, PlacedOrgans, Polygons};
use crate::fingerprint::Fingerprint;

impl Organs {
    /// A 128-bit fingerprint of everything in it (XXH3 over little-endian bytes): equal on all machines and for
    /// any number of threads exactly when the organs are the same, bit for bit.
    pub fn hash(&self) -> u128 {
        let mut fingerprint = Fingerprint::new();
        // Whether leaves need a form says what becomes of these organs, not what they are.
        let Self { polygons, placed, shapes, need_form: _ } = self;
        let Polygons { corners, ends, headings, ups, growth } = polygons;
        fingerprint.vectors(corners);
        fingerprint.words(ends.iter().copied());
        fingerprint.vectors(headings);
        fingerprint.vectors(ups);
        add_origins(&mut fingerprint, growth);
        let PlacedOrgans { prototypes, positions, headings, ups, sizes_m, growth } = placed;
        fingerprint.words(prototypes.iter().copied().map(u32::from));
        fingerprint.vectors(positions);
        fingerprint.vectors(headings);
        fingerprint.vectors(ups);
        fingerprint.reals(sizes_m);
        add_origins(&mut fingerprint, growth);
        // The mesh has the faces; levels of detail stand for the same organs.
        for LeafShape { kind, mesh, sketch, color, is_dome, faces: _, lods: _ } in shapes.iter() {
            let [red, green, blue] = *color;
            fingerprint.words([*kind, red, green, blue, u8::from(*is_dome)].map(u32::from));
            add_mesh(&mut fingerprint, mesh);
            add_mesh(&mut fingerprint, sketch);
        }
        fingerprint.finish()
    }
}

fn add_origins(fingerprint: &mut Fingerprint, OrganOrigins { nodes, colors, births }: &OrganOrigins) {
    for list in [nodes, colors, births] {
        fingerprint.words(list.iter().copied());
    }
}

fn add_mesh(fingerprint: &mut Fingerprint, Mesh { positions, normals, uvs, triangles }: &Mesh) {
    fingerprint.vectors(positions);
    fingerprint.vectors(normals);
    fingerprint.plane_vectors(uvs);
    fingerprint.words(triangles.iter().flatten().copied());
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use glam::{Vec2, Vec3};

    use super::*;

    /// Two polygons, two organs, one shape; no two numbers alike.
    fn organs() -> Organs {
        let vectors = |from: f32| vec![Vec3::new(from, from + 0.1, from + 0.2), Vec3::splat(from + 0.3)];
        let growth = |from: u32| OrganOrigins {
            nodes: vec![from, from + 1],
            colors: vec![from + 2, from + 3],
            births: vec![from + 4, from + 5],
        };
        let mesh = |from: f32| Mesh {
            positions: vectors(from),
            normals: vectors(from + 1.0),
            uvs: vec![Vec2::splat(from + 2.0), Vec2::splat(from + 3.0)],
            triangles: vec![[0, 1, 1]],
        };
        let shape = LeafShape {
            kind: 1,
            mesh: mesh(20.0),
            sketch: mesh(30.0),
            color: [1, 2, 3],
            is_dome: false,
            faces: 1,
            lods: Vec::new(),
        };
        Organs {
            need_form: false,
            polygons: Polygons {
                corners: vectors(1.0),
                ends: vec![1, 2],
                headings: vectors(2.0),
                ups: vectors(3.0),
                growth: growth(10),
            },
            placed: PlacedOrgans {
                prototypes: vec![4, 5],
                positions: vectors(4.0),
                headings: vectors(5.0),
                ups: vectors(6.0),
                sizes_m: vec![7.0, 8.0],
                growth: growth(20),
            },
            shapes: Arc::new([shape]),
        }
    }

    fn shape(organs: &mut Organs) -> &mut LeafShape {
        &mut Arc::get_mut(&mut organs.shapes).unwrap()[0]
    }

    fn flip(real: &mut f32) {
        *real = f32::from_bits(real.to_bits() ^ 1);
    }

    #[test]
    fn one_bit_anywhere_makes_another_fingerprint() {
        let changes: [fn(&mut Organs); 24] = [
            |o| flip(&mut o.polygons.corners[1].z),
            |o| o.polygons.ends[1] ^= 1,
            |o| flip(&mut o.polygons.headings[0].x),
            |o| flip(&mut o.polygons.ups[1].y),
            |o| o.polygons.growth.nodes[0] ^= 1,
            |o| o.polygons.growth.colors[1] ^= 1,
            |o| o.polygons.growth.births[0] ^= 1,
            |o| o.placed.prototypes[1] ^= 1,
            |o| flip(&mut o.placed.positions[0].x),
            |o| flip(&mut o.placed.headings[1].y),
            |o| flip(&mut o.placed.ups[0].z),
            |o| flip(&mut o.placed.sizes_m[1]),
            |o| o.placed.growth.nodes[1] ^= 1,
            |o| o.placed.growth.colors[0] ^= 1,
            |o| o.placed.growth.births[1] ^= 1,
            |o| shape(o).kind ^= 1,
            |o| shape(o).color[2] ^= 1,
            |o| shape(o).is_dome ^= true,
            |o| flip(&mut shape(o).mesh.positions[1].x),
            |o| flip(&mut shape(o).mesh.normals[0].y),
            |o| flip(&mut shape(o).mesh.uvs[1].x),
            |o| shape(o).mesh.triangles[0][2] ^= 1,
            |o| flip(&mut shape(o).sketch.positions[0].z),
            |o| o.shapes = Arc::new([]),
        ];
        let mut seen = vec![organs().hash()];
        assert_eq!(seen[0], organs().hash());
        for (index, change) in changes.iter().enumerate() {
            let mut other = organs();
            change(&mut other);
            assert_ne!(other, organs(), "change {index}");
            assert!(!seen.contains(&other.hash()), "change {index}");
            seen.push(other.hash());
        }
    }

    /// The same numbers in a row, divided in another way.
    #[test]
    fn what_moves_from_one_array_to_the_next_is_seen() {
        let mut other = organs();
        let moved = other.polygons.ups.remove(0);
        other.polygons.headings.push(moved);
        let mut swapped = organs();
        swapped.placed.positions.swap(0, 1);
        assert!(organs().hash() != other.hash() && organs().hash() != swapped.hash());
    }
}
