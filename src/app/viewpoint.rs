//! From where a tree is looked at when nothing else was asked for.

use linden::scene::Bounds;
use linden::{Skeleton, Vec3};

/// The yaw that shows a flat tree (the plane systems of ABOP) from its broad side.
pub fn broad_side(skeleton: &Skeleton) -> f32 {
    const FLAT: f32 = 0.01;
    let size = Bounds::of(skeleton.positions.iter().copied()).map_or(Vec3::ONE, Bounds::size);
    if size.z < FLAT * size.x {
        0.0
    } else if size.x < FLAT * size.z {
        90.0
    } else {
        30.0
    }
}
