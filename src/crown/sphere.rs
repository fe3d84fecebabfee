//! A ball that rests on its base point.

use std::f64::consts::PI;

use glam::{DVec3, Vec3};

use super::skin::Skin;
use super::{CROWN_RADIUS, Crown, CrownError, Dimensions, Shape, ShapeKnob, revolve, round_bounds};
use linden_base::knob::Value;
use linden_base::mesh::Bounds;
use linden_base::random::Key;

/// The row of the table of shapes.
pub const SHAPE: Shape = Shape {
    id: "sphere",
    help: "a ball that rests on the top of the trunk, like a young maple",
    knobs: &[ShapeKnob { knob: CROWN_RADIUS, default: || Value::Real(4.0) }],
    build,
};

fn build(dimensions: &Dimensions) -> Result<Box<dyn Crown>, CrownError> {
    Ok(Box::new(Sphere { radius_m: dimensions.metres(CROWN_RADIUS.name)? }))
}

struct Sphere {
    radius_m: f64,
}

impl Crown for Sphere {
    fn bounds(&self) -> Bounds {
        round_bounds(0.0, 2.0 * self.radius_m, self.radius_m)
    }

    fn contains(&self, p: DVec3) -> bool {
        (p - DVec3::Y * self.radius_m).length_squared() <= self.radius_m * self.radius_m
    }

    fn sample(&self, key: Key) -> DVec3 {
        self.radius_m * (DVec3::Y + key.in_ball())
    }

    fn outline(&self) -> Vec<Vec<Vec3>> {
        let arc = |i: i32| {
            let (sin, cos) = libm::sincos(f64::from(i) / 32.0 * PI);
            (self.radius_m * (1.0 - cos), self.radius_m * sin)
        };
        revolve(&(0..=32).map(arc).collect::<Vec<_>>(), &[arc(8), arc(16), arc(24)])
    }

    fn skin(&self) -> Skin {
        let arc = |i: i32| {
            let (sin, cos) = libm::sincos(f64::from(i) / 24.0 * PI);
            (self.radius_m * (1.0 - cos), self.radius_m * sin)
        };
        Skin::revolved(&(0..=24).map(arc).collect::<Vec<_>>())
    }

    fn volume_m3(&self) -> f64 {
        PI * self.radius_m * self.radius_m * self.radius_m * 4.0 / 3.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::assert_uniform;

    #[test]
    fn it_rests_on_the_ground() {
        let sphere = Sphere { radius_m: 4.0 };
        for (p, inside) in [
            (DVec3::new(0.0, 0.001, 0.0), true),
            (DVec3::new(0.0, 7.999, 0.0), true),
            (DVec3::new(3.999, 4.0, 0.0), true),
            (DVec3::new(1.0, 0.1, 0.0), false),
            (DVec3::new(0.0, -0.001, 0.0), false),
        ] {
            assert_eq!(sphere.contains(p), inside, "{p}");
        }
    }

    #[test]
    fn points_are_uniform_in_volume() {
        assert_uniform(&Sphere { radius_m: 4.0 });
    }
}
