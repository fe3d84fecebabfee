//! What branches do not grow into.

use std::f64::consts::PI;
use std::fmt;

use glam::{DVec3, Vec3};

/// How far branches turn, degrees. Beyond a right angle they would grow away from all that pulls them.
const TILTS_DEG: [i32; 6] = [15, 30, 45, 60, 75, 90];
/// How branches turn, degrees about the direction that they leave: upwards first.
const AZIMUTHS_DEG: [i32; 8] = [0, 45, -45, 90, -90, 135, -135, 180];
/// Vertical component of a unit direction from which on no side of it is the upper one.
const STEEP: f64 = 0.99;

/// A solid that nothing grows into.
#[derive(Clone, Copy)]
pub struct Obstacle<'a> {
    /// Whether a place, metres, is inside. Must always say the same of the same place, on any thread.
    pub contains: &'a (dyn Fn(DVec3) -> bool + Sync),
    /// How a branch goes on that would grow into it.
    pub meet: Meet,
}

impl fmt::Debug for Obstacle<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Obstacle").field("meet", &self.meet).finish_non_exhaustive()
    }
}

linden_base::words! {
    /// What a branch does that meets an obstacle.
    Meet {
        /// It turns aside, as little as it can.
        Around = "around",
        /// It ends.
        Stop = "stop"
    }
}

/// Whether the internode from `from` to `to` is free of `obstacle`: looked at in its middle and at
/// its end.
fn is_free(obstacle: &Obstacle, from: Vec3, to: Vec3) -> bool {
    let (from, to) = (from.as_dvec3(), to.as_dvec3());
    !(obstacle.contains)(to) && !(obstacle.contains)((from + to) * 0.5)
}

/// Where an internode from `from` ends that would lead `straight` in the unit `direction`; `place`
/// gives the end for other directions. `None` if it cannot be.
pub(super) fn turned(
    obstacles: &[Obstacle],
    from: Vec3,
    direction: DVec3,
    straight: Vec3,
    place: impl Fn(DVec3) -> Vec3,
) -> Option<Vec3> {
    let mut met = None;
    for obstacle in obstacles.iter().filter(|some| !is_free(some, from, straight)) {
        met = if met == Some(Meet::Stop) { met } else { Some(obstacle.meet) };
    }
    let Some(met) = met else { return Some(straight) };
    if met == Meet::Stop {
        return None;
    }
    fan(direction).map(place).find(|&to| obstacles.iter().all(|some| is_free(some, from, to)))
}

/// Directions away from the unit `direction`, the least tilted first, and of those the upper ones.
pub fn fan(direction: DVec3) -> impl Iterator<Item = DVec3> {
    let side = if direction.y.abs() > STEEP { DVec3::X } else { DVec3::Y };
    let upper = (side - direction * direction.dot(side)).normalize();
    let across = direction.cross(upper);
    let sincos = |degrees: i32| libm::sincos(f64::from(degrees) * PI / 180.0);
    TILTS_DEG.into_iter().flat_map(move |tilt| {
        let (sin, cos) = sincos(tilt);
        AZIMUTHS_DEG.into_iter().map(move |azimuth| {
            let (aside, up) = sincos(azimuth);
            direction * cos + (upper * up + across * aside) * sin
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_fan_is_of_unit_directions_ever_farther_away_that_begin_upwards() {
        for direction in [DVec3::X, DVec3::Y, DVec3::NEG_Y, DVec3::new(0.48, -0.6, 0.64)] {
            let fan: Vec<DVec3> = fan(direction).collect();
            assert_eq!(fan.len(), 6 * 8);
            assert!(fan.iter().all(|d| (d.length() - 1.0).abs() < 1e-12));
            assert!(fan.windows(2).all(|two| two[1].dot(direction) <= two[0].dot(direction) + 1e-12));
            let first_deg = libm::acos(fan[0].dot(direction)).to_degrees();
            assert!((first_deg - 15.0).abs() < 1e-9, "{first_deg}");
            if direction.y.abs() < STEEP {
                assert!(fan[..8].iter().all(|d| d.y <= fan[0].y));
            }
        }
    }
}
