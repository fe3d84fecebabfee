//! An upright cylinder.

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
    id: "cylinder",
    help: "as wide at the top as at the base, like a poplar or a clipped tree",
    knobs: &[
        ShapeKnob { knob: CROWN_HEIGHT, default: || Value::Real(8.0) },
        ShapeKnob { knob: CROWN_RADIUS, default: || Value::Real(3.0) },
    ],
    build,
};

fn build(dimensions: &Dimensions) -> Result<Box<dyn Crown>, CrownError> {
    Ok(Box::new(Cylinder {
        height_m: dimensions.metres(CROWN_HEIGHT.name)?,
        radius_m: dimensions.metres(CROWN_RADIUS.name)?,
    }))
}

struct Cylinder {
    height_m: f64,
    radius_m: f64,
}

impl Crown for Cylinder {
    fn bounds(&self) -> Bounds {
        round_bounds(0.0, self.height_m, self.radius_m)
    }

    fn contains(&self, p: DVec3) -> bool {
        (0.0..=self.height_m).contains(&p.y) && radius_squared(p) <= self.radius_m * self.radius_m
    }

    fn sample(&self, key: Key) -> DVec3 {
        level(self.height_m * key.child(0).unit(), self.radius_m * key.child(1).in_disc())
    }

    fn outline(&self) -> Vec<Vec<Vec3>> {
        let ring = |part: f64| (self.height_m * part, self.radius_m);
        revolve(&[ring(0.0), ring(1.0)], &[ring(0.0), ring(0.5), ring(1.0)])
    }

    fn skin(&self) -> Skin {
        Skin::revolved(&[(0.0, self.radius_m), (self.height_m, self.radius_m)])
    }

    fn volume_m3(&self) -> f64 {
        PI * self.radius_m * self.radius_m * self.height_m
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::assert_uniform;

    #[test]
    fn ends_are_flat_and_the_side_is_upright() {
        let cylinder = Cylinder { height_m: 5.0, radius_m: 2.0 };
        for (p, inside) in [
            (DVec3::new(1.4, 4.99, 1.4), true),
            (DVec3::new(1.5, 2.0, 1.5), false),
            (DVec3::new(0.0, 5.01, 0.0), false),
            (DVec3::new(0.0, -0.01, 0.0), false),
        ] {
            assert_eq!(cylinder.contains(p), inside, "{p}");
        }
    }

    #[test]
    fn points_are_uniform_in_volume() {
        assert_uniform(&Cylinder { height_m: 5.0, radius_m: 2.0 });
    }
}
