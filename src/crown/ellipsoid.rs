//! An ellipsoid: a ball drawn out or pressed flat along the trunk.

use std::f64::consts::PI;

use glam::{DVec3, Vec3};

use super::skin::Skin;
use super::{
    CROWN_HEIGHT, CROWN_RADIUS, Crown, CrownError, Dimensions, Shape, ShapeKnob, radius_squared, revolve,
    round_bounds,
};
use linden_base::knob::Value;
use linden_base::mesh::Bounds;
use linden_base::random::Key;

/// The row of the table of shapes.
pub const SHAPE: Shape = Shape {
    id: "ellipsoid",
    help: "a ball drawn out or pressed flat, like a lime or a beech",
    knobs: &[
        ShapeKnob { knob: CROWN_HEIGHT, default: || Value::Real(9.0) },
        ShapeKnob { knob: CROWN_RADIUS, default: || Value::Real(3.0) },
    ],
    build,
};

fn build(dimensions: &Dimensions) -> Result<Box<dyn Crown>, CrownError> {
    Ok(Box::new(Ellipsoid {
        height_m: dimensions.metres(CROWN_HEIGHT.name)?,
        radius_m: dimensions.metres(CROWN_RADIUS.name)?,
    }))
}

struct Ellipsoid {
    height_m: f64,
    radius_m: f64,
}

impl Ellipsoid {
    /// Height and radius where the unit circle, from its lowest point, has turned by `angle_rad`.
    fn at(&self, angle_rad: f64) -> (f64, f64) {
        let (sin, cos) = libm::sincos(angle_rad);
        (0.5 * self.height_m * (1.0 - cos), self.radius_m * sin)
    }
}

impl Crown for Ellipsoid {
    fn bounds(&self) -> Bounds {
        round_bounds(0.0, self.height_m, self.radius_m)
    }

    fn contains(&self, p: DVec3) -> bool {
        let up = 2.0 * p.y / self.height_m - 1.0;
        up * up + radius_squared(p) / (self.radius_m * self.radius_m) <= 1.0
    }

    /// A ball's point, stretched: an affine map keeps shares of volume.
    fn sample(&self, key: Key) -> DVec3 {
        let stretch = DVec3::new(self.radius_m, 0.5 * self.height_m, self.radius_m);
        stretch * (DVec3::Y + key.in_ball())
    }

    fn outline(&self) -> Vec<Vec<Vec3>> {
        let arc = |i: i32| self.at(f64::from(i) / 32.0 * PI);
        revolve(&(0..=32).map(arc).collect::<Vec<_>>(), &[arc(8), arc(16), arc(24)])
    }

    fn skin(&self) -> Skin {
        let arc = |i: i32| self.at(f64::from(i) / 24.0 * PI);
        Skin::revolved(&(0..=24).map(arc).collect::<Vec<_>>())
    }

    fn volume_m3(&self) -> f64 {
        PI * self.radius_m * self.radius_m * self.height_m * 2.0 / 3.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::assert_uniform;

    #[test]
    fn its_axes_are_height_and_twice_the_radius() {
        let ellipsoid = Ellipsoid { height_m: 8.0, radius_m: 2.0 };
        for (p, inside) in [
            (DVec3::new(0.0, 0.001, 0.0), true),
            (DVec3::new(0.0, 7.999, 0.0), true),
            (DVec3::new(1.4, 4.0, 1.4), true),
            (DVec3::new(1.5, 4.0, 1.5), false),
            // Halfway up the upper half the radius is √3/2 of the widest.
            (DVec3::new(1.73, 6.0, 0.0), true),
            (DVec3::new(1.74, 6.0, 0.0), false),
            (DVec3::new(0.0, -0.001, 0.0), false),
        ] {
            assert_eq!(ellipsoid.contains(p), inside, "{p}");
        }
    }

    #[test]
    fn points_are_uniform_in_volume() {
        for (height_m, radius_m) in [(9.0, 2.0), (2.0, 6.0)] {
            assert_uniform(&Ellipsoid { height_m, radius_m });
        }
    }
}
