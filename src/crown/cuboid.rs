//! An upright box: a wall, a house, a hedge. It is no crown shape of [`SHAPES`](super::SHAPES), whose profiles are
//! turned about an axis.

use glam::{DVec3, Vec3};

use super::skin::Skin;
use super::{Crown, units};
use linden_base::mesh::Bounds;
use linden_base::random::Key;

/// A box, the centre of its base at the origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cuboid {
    /// Along x, y and z, metres; all above zero.
    pub size: DVec3,
}

impl Cuboid {
    /// The place at shares of the box's edges.
    fn at(&self, share: DVec3) -> DVec3 {
        (share - DVec3::new(0.5, 0.0, 0.5)) * self.size
    }

    /// The corner with the upper end of the edges along x, y and z by the bits 1, 2 and 4 of its number.
    fn corner(&self, number: u32) -> Vec3 {
        self.at(DVec3::from([0, 1, 2].map(|axis| f64::from(number >> axis & 1)))).as_vec3()
    }
}

impl Crown for Cuboid {
    fn bounds(&self) -> Bounds {
        Bounds { min: self.corner(0), max: self.corner(7) }
    }

    fn contains(&self, p: DVec3) -> bool {
        p.cmpge(self.at(DVec3::ZERO)).all() && p.cmple(self.at(DVec3::ONE)).all()
    }

    fn sample(&self, key: Key) -> DVec3 {
        self.at(DVec3::from(units(key)))
    }

    fn outline(&self) -> Vec<Vec<Vec3>> {
        let line = |corners: &[u32]| corners.iter().map(|&corner| self.corner(corner)).collect();
        let rings = [[0, 1, 5, 4, 0], [2, 3, 7, 6, 2]];
        let uprights = [[0, 2], [1, 3], [5, 7], [4, 6]];
        rings.iter().map(|ring| line(ring)).chain(uprights.iter().map(|upright| line(upright))).collect()
    }

    fn skin(&self) -> Skin {
        let faces = [[0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6], [0, 4, 6, 2], [1, 3, 7, 5]];
        Skin {
            positions: (0..8).map(|corner| self.corner(corner)).collect(),
            triangles: faces.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect(),
        }
    }

    fn volume_m3(&self) -> f64 {
        self.size.element_product()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::{assert_uniform, volume_by_probes};

    const WALL: Cuboid = Cuboid { size: DVec3::new(0.5, 3.0, 8.0) };

    #[test]
    fn it_is_what_its_edges_say() {
        assert_uniform(&WALL);
        assert!((volume_by_probes(&WALL) / 12.0 - 1.0).abs() < 1e-9);
        for (p, inside) in [([0.24, 0.01, 3.9], true), ([0.26, 1.0, 0.0], false), ([0.0, -0.01, 0.0], false)]
        {
            assert_eq!(WALL.contains(DVec3::from(p)), inside, "{p:?}");
        }
    }

    #[test]
    fn its_faces_look_outwards_and_close_it() {
        let skin = WALL.skin();
        let volume: f64 = skin
            .triangles
            .iter()
            .map(|t| {
                let [a, b, c] = t.map(|corner| skin.positions[corner as usize].as_dvec3());
                a.dot(b.cross(c)) / 6.0
            })
            .sum();
        assert!((volume - 12.0).abs() < 1e-5, "{volume}");
        let on_it =
            |p: &Vec3| (p.abs().as_dvec3() - WALL.size * DVec3::new(0.5, 1.0, 0.5)).max_element() < 1e-6;
        assert!(WALL.outline().iter().flatten().all(on_it));
    }
}
