//! How leaves turn to the light.

use std::f64::consts::{PI, TAU};

use glam::{DQuat, DVec3};

/// The frame of a leaf, z along it and y off its upper side, turned out of the crown and up to the sky by a
/// share of the way: about the vertical until its upper side looks away from the trunk, then about the level
/// line across it until it looks up.
pub(crate) fn bent(leaf: DQuat, place: DVec3, share: f64) -> DQuat {
    if share == 0.0 {
        return leaf;
    }
    let normal = leaf * DVec3::Y;
    let away = libm::atan2(place.y, place.x) - libm::atan2(normal.y, normal.x);
    // The shorter way round.
    let away = away - TAU * libm::round(away / TAU);
    let out = DQuat::from_rotation_z(share * away.clamp(-PI, PI)) * leaf;
    let normal = out * DVec3::Y;
    let slope = libm::atan2(libm::hypot(normal.x, normal.y), normal.z);
    let Some(across) = normal.cross(DVec3::Z).try_normalize() else { return out };
    DQuat::from_axis_angle(across, share * slope) * out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_of_the_way_is_up_and_none_is_none() {
        let leaf = DQuat::from_rotation_z(2.0) * DQuat::from_rotation_x(1.9);
        let place = DVec3::new(-3.0, 1.0, 5.0);
        assert_eq!(bent(leaf, place, 0.0), leaf);
        assert!((bent(leaf, place, 1.0) * DVec3::Y).distance(DVec3::Z) < 1e-9);
        let half = bent(leaf, place, 0.5) * DVec3::Y;
        let before = (leaf * DVec3::Y).angle_between(DVec3::Z);
        assert!((half.angle_between(DVec3::Z) / before - 0.5).abs() < 1e-9);
    }
}
