//! A crown that stands somewhere else, turned and scaled.

use glam::{DVec3, Vec3};

use super::Crown;
use super::skin::Skin;
use linden_base::mesh::Bounds;
use linden_base::random::Key;

/// A crown under a similarity: scaled, turned about the upright through its base centre, moved.
pub struct PlacedCrown {
    crown: Box<dyn Crown>,
    scale: f64,
    /// Of the turn.
    sin: f64,
    cos: f64,
    at: DVec3,
}

impl PlacedCrown {
    /// `at` is where the crown's base centre comes to stand, metres; `scale` is above zero. Turning by
    /// +90° takes Z to X.
    pub fn new(crown: Box<dyn Crown>, at: DVec3, turn_deg: f64, scale: f64) -> Self {
        let (sin, cos) = libm::sincos(turn_deg.to_radians());
        Self { crown, scale, sin, cos, at }
    }

    fn out(&self, p: DVec3) -> DVec3 {
        let turned = DVec3::new(self.cos * p.x + self.sin * p.z, p.y, self.cos * p.z - self.sin * p.x);
        turned * self.scale + self.at
    }

    fn back(&self, p: DVec3) -> DVec3 {
        let p = (p - self.at) / self.scale;
        DVec3::new(self.cos * p.x - self.sin * p.z, p.y, self.cos * p.z + self.sin * p.x)
    }
}

impl Crown for PlacedCrown {
    fn bounds(&self) -> Bounds {
        let bounds = self.crown.bounds();
        let corners = bounds.corners().map(|corner| self.out(corner.as_dvec3()).as_vec3());
        Bounds::of(corners).unwrap_or(bounds)
    }

    fn contains(&self, p: DVec3) -> bool {
        self.crown.contains(self.back(p))
    }

    fn sample(&self, key: Key) -> DVec3 {
        self.out(self.crown.sample(key))
    }

    fn outline(&self) -> Vec<Vec<Vec3>> {
        let mut lines = self.crown.outline();
        for place in lines.iter_mut().flatten() {
            *place = self.out(place.as_dvec3()).as_vec3();
        }
        lines
    }

    fn skin(&self) -> Skin {
        self.crown.skin().moved(|place| self.out(place.as_dvec3()).as_vec3())
    }

    fn volume_m3(&self) -> f64 {
        self.crown.volume_m3() * self.scale * self.scale * self.scale
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::{assert_uniform, volume_by_probes};
    use crate::{cylinder, sphere};
    use linden_base::knob::Value;

    #[test]
    fn it_stands_where_it_was_put() {
        let ball = sphere::SHAPE.of(&[("crown_radius", Value::Real(1.0))]).unwrap();
        let inner = PlacedCrown::new(ball, DVec3::new(3.0, 0.0, 0.0), 0.0, 1.0);
        // The ball beside the base centre tells which way it was turned.
        let placed = PlacedCrown::new(Box::new(inner), DVec3::new(10.0, 5.0, 0.0), 90.0, 2.0);
        assert!(placed.contains(DVec3::new(10.0, 7.0, -6.0)), "X was taken to -Z");
        for outside in [DVec3::new(10.0, 7.0, 6.0), DVec3::new(16.0, 7.0, 0.0), DVec3::new(10.0, 4.9, -6.0)] {
            assert!(!placed.contains(outside));
        }
        let centre = placed.bounds().min.midpoint(placed.bounds().max);
        assert!((centre - Vec3::new(10.0, 7.0, -6.0)).length() < 1e-5);
        for p in placed.outline().iter().flatten() {
            assert!((p.distance(Vec3::new(10.0, 7.0, -6.0)) - 2.0).abs() < 1e-4);
        }
    }

    #[test]
    fn points_stay_uniform_and_the_volume_is_scaled() {
        let placed =
            PlacedCrown::new(cylinder::SHAPE.of(&[]).unwrap(), DVec3::new(1.0, -2.0, 3.0), 33.0, 0.5);
        assert_uniform(&placed);
        assert!((volume_by_probes(&placed) / placed.volume_m3() - 1.0).abs() < 0.02);
    }
}
