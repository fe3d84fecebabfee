//! A dome: the upper half of a ball.

use std::f64::consts::{FRAC_PI_2, PI};

use glam::{DVec3, Vec3};

use super::skin::Skin;
use super::{CROWN_RADIUS, Crown, CrownError, Dimensions, Shape, ShapeKnob, revolve, round_bounds};
use linden_base::knob::Value;
use linden_base::mesh::Bounds;
use linden_base::random::Key;

/// The row of the table of shapes.
pub const SHAPE: Shape = Shape {
    id: "dome",
    help: "the upper half of a ball, like an open-grown oak",
    knobs: &[ShapeKnob { knob: CROWN_RADIUS, default: || Value::Real(6.0) }],
    build,
};

fn build(dimensions: &Dimensions) -> Result<Box<dyn Crown>, CrownError> {
    Ok(Box::new(Dome { radius_m: dimensions.metres(CROWN_RADIUS.name)? }))
}

struct Dome {
    radius_m: f64,
}

impl Crown for Dome {
    fn bounds(&self) -> Bounds {
        round_bounds(0.0, self.radius_m, self.radius_m)
    }

    fn contains(&self, p: DVec3) -> bool {
        p.y >= 0.0 && p.length_squared() <= self.radius_m * self.radius_m
    }

    /// A ball's point, its lower half turned up.
    fn sample(&self, key: Key) -> DVec3 {
        let p = key.in_ball();
        self.radius_m * DVec3::new(p.x, p.y.abs(), p.z)
    }

    fn outline(&self) -> Vec<Vec<Vec3>> {
        let arc = |i: i32| {
            let (sin, cos) = libm::sincos(f64::from(i) / 16.0 * FRAC_PI_2);
            (self.radius_m * sin, self.radius_m * cos)
        };
        revolve(&(0..=16).map(arc).collect::<Vec<_>>(), &[arc(0), arc(4), arc(9)])
    }

    fn skin(&self) -> Skin {
        let arc = |i: i32| {
            let (sin, cos) = libm::sincos(f64::from(i) / 12.0 * FRAC_PI_2);
            (self.radius_m * sin, self.radius_m * cos)
        };
        Skin::revolved(&(0..=12).map(arc).collect::<Vec<_>>())
    }

    fn volume_m3(&self) -> f64 {
        PI * self.radius_m * self.radius_m * self.radius_m * 2.0 / 3.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::assert_uniform;

    #[test]
    fn it_is_half_a_ball_on_the_ground() {
        let dome = Dome { radius_m: 6.0 };
        for (p, inside) in [
            (DVec3::new(0.0, 5.99, 0.0), true),
            (DVec3::new(5.99, 0.001, 0.0), true),
            (DVec3::new(3.5, 3.5, 3.5), false),
            (DVec3::new(3.4, 3.4, 3.4), true),
            (DVec3::new(0.0, -0.001, 0.0), false),
        ] {
            assert_eq!(dome.contains(p), inside, "{p}");
        }
    }

    #[test]
    fn points_are_uniform_in_volume() {
        assert_uniform(&Dome { radius_m: 6.0 });
    }
}
