//! A cone: base at the bottom, straight sides to an apex of radius 0.

use std::f64::consts::PI;

use glam::{DVec3, Vec3};

use super::skin::Skin;
use super::{
    CROWN_HEIGHT, CROWN_RADIUS, Crown, CrownError, Dimensions, Shape, ShapeKnob, level, radius_squared,
    revolve, round_bounds,
};
use linden_base::knob::Value;
use linden_base::mesh::Bounds;
use linden_base::random::Key;

/// The row of the table of shapes.
pub const SHAPE: Shape = Shape {
    id: "cone",
    help: "widest at its base, straight sides to a point, like a fir",
    knobs: &[
        ShapeKnob { knob: CROWN_HEIGHT, default: || Value::Real(10.0) },
        ShapeKnob { knob: CROWN_RADIUS, default: || Value::Real(5.0) },
    ],
    build,
};

fn build(dimensions: &Dimensions) -> Result<Box<dyn Crown>, CrownError> {
    Ok(Box::new(Cone {
        height_m: dimensions.metres(CROWN_HEIGHT.name)?,
        radius_m: dimensions.metres(CROWN_RADIUS.name)?,
    }))
}

struct Cone {
    height_m: f64,
    radius_m: f64,
}

impl Cone {
    fn radius_at(&self, height: f64) -> f64 {
        self.radius_m * (1.0 - height / self.height_m)
    }
}

impl Crown for Cone {
    fn bounds(&self) -> Bounds {
        round_bounds(0.0, self.height_m, self.radius_m)
    }

    fn contains(&self, p: DVec3) -> bool {
        let radius = self.radius_at(p.y);
        p.y >= 0.0 && radius >= 0.0 && radius_squared(p) <= radius * radius
    }

    /// The part of the volume nearer to the apex than `d` is `(d / height)³`.
    fn sample(&self, key: Key) -> DVec3 {
        let height = self.height_m * (1.0 - libm::cbrt(key.child(0).unit()));
        level(height, self.radius_at(height) * key.child(1).in_disc())
    }

    fn outline(&self) -> Vec<Vec<Vec3>> {
        let ring = |height: f64| (height, self.radius_at(height));
        revolve(
            &[ring(0.0), ring(self.height_m)],
            &[ring(0.0), ring(self.height_m / 3.0), ring(self.height_m * 2.0 / 3.0)],
        )
    }

    fn skin(&self) -> Skin {
        Skin::revolved(&[(0.0, self.radius_m), (self.height_m, 0.0)])
    }

    fn volume_m3(&self) -> f64 {
        PI * self.radius_m * self.radius_m * self.height_m / 3.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::assert_uniform;

    #[test]
    fn sides_are_straight_and_the_apex_is_a_point() {
        let cone = Cone { height_m: 8.0, radius_m: 2.0 };
        for (p, inside) in [
            (DVec3::new(0.99, 4.0, 0.0), true),
            (DVec3::new(0.0, 4.0, 1.01), false),
            (DVec3::new(1.99, 0.01, 0.0), true),
            (DVec3::new(0.01, 7.99, 0.0), false),
            (DVec3::new(0.0, -0.01, 0.0), false),
            (DVec3::new(0.0, 8.01, 0.0), false),
            (DVec3::new(1.0, 12.0, 0.0), false),
        ] {
            assert_eq!(cone.contains(p), inside, "{p}");
        }
    }

    #[test]
    fn points_are_uniform_in_volume() {
        assert_uniform(&Cone { height_m: 6.0, radius_m: 4.0 });
    }
}
