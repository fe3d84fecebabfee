//! Shapes as closed convex meshes, for engines that know them by their names.

use std::f32::consts::PI;

use linden_pipeline::Vec3;
use linden_pipeline::glam::Quat;
use linden_pipeline::hull::HullSolid;
use linden_pipeline::scene::Bounds;

use super::capsules::Capsule;

/// A closed convex mesh.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Solid {
    pub points: Vec<Vec3>,
    /// Counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
}

/// Sides of a capsule's mesh.
const SIDES: u32 = 8;

impl Solid {
    pub fn new(hull: &HullSolid) -> Self {
        let points = hull.corners.iter().map(|corner| corner.as_vec3()).collect();
        Self { points, triangles: hull.triangles.clone() }
    }

    /// A capsule with flat sides, as large as the round one on the average.
    pub fn of(capsule: &Capsule) -> Self {
        let (turn, half) = (capsule.rotation(), 0.5 * capsule.length_m());
        let step = 2.0 * PI / SIDES as f32;
        let radius = capsule.radius_m * libm::sqrtf(step / libm::sinf(step));
        let at = |x: f32, y: f32, z: f32| capsule.middle() + turn * Vec3::new(x, y, z);
        // From the lower pole to the upper one.
        let eighth = libm::sqrtf(0.5) * radius;
        let rings = [(eighth, -half - eighth), (radius, -half), (radius, half), (eighth, half + eighth)];
        let mut points = vec![at(0.0, -half - radius, 0.0)];
        for (flat, height) in rings {
            points.extend((0..SIDES).map(|side| {
                let (sin, cos) = libm::sincosf(side as f32 * step);
                at(flat * cos, height, flat * sin)
            }));
        }
        points.push(at(0.0, half + radius, 0.0));
        let last = points.len() as u32 - 1;
        let mut triangles = Vec::new();
        for side in 0..SIDES {
            let next = (side + 1) % SIDES;
            let of = |ring: u32, side: u32| 1 + ring * SIDES + side;
            triangles.push([0, of(0, side), of(0, next)]);
            for ring in 0..rings.len() as u32 - 1 {
                let [a, b] = [of(ring, side), of(ring, next)];
                let [c, d] = [of(ring + 1, side), of(ring + 1, next)];
                triangles.extend([[a, c, b], [b, c, d]]);
            }
            let upper = rings.len() as u32 - 1;
            triangles.push([of(upper, side), last, of(upper, next)]);
        }
        Self { points, triangles }
    }

    /// The box round it.
    pub fn bounds(&self) -> Option<Bounds> {
        Bounds::of(self.points.iter().copied())
    }
}

impl Capsule {
    /// Between the middles of its ends.
    pub fn length_m(&self) -> f32 {
        self.from.distance(self.to)
    }

    pub fn middle(&self) -> Vec3 {
        0.5 * (self.from + self.to)
    }

    /// Turns +Y along it.
    pub fn rotation(&self) -> Quat {
        let along = (self.to - self.from).normalize_or(Vec3::Y);
        Quat::from_rotation_arc(Vec3::Y, along).normalize()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_capsules_mesh_is_closed_convex_and_as_large() {
        let capsule = Capsule { from: Vec3::new(1.0, 2.0, 3.0), to: Vec3::new(2.0, 5.0, 3.5), radius_m: 0.4 };
        let Solid { points, triangles } = Solid::of(&capsule);
        let volume: f32 = triangles
            .iter()
            .map(|triangle| {
                let [a, b, c] = triangle.map(|corner| points[corner as usize]);
                for point in &points {
                    assert!((b - a).cross(c - a).dot(*point - a) < 1e-4, "nothing is in front of a face");
                }
                let from = points[0];
                (a - from).dot((b - from).cross(c - from)) / 6.0
            })
            .sum();
        let r = capsule.radius_m;
        let round = PI * r * r * (capsule.length_m() + 4.0 / 3.0 * r);
        assert!((volume / round - 1.0).abs() < 0.08, "{volume} of {round}");
    }
}
