//! From where a tree is looked at when nothing else was asked for.

use glam::Vec2;
use linden::scene::Bounds;
use linden::{Skeleton, Vec3};
use linden_raster::Extent;
use linden_raster::extent::RINGS;

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

/// What holds all of some extents: pictures that frame it show their trees in one scale, on one ground.
pub fn around(all: &[Extent]) -> Extent {
    if let [one] = all {
        return *one;
    }
    let least = |of: &dyn Fn(&Extent) -> f32| all.iter().map(of).fold(f32::INFINITY, f32::min);
    let most = |of: &dyn Fn(&Extent) -> f32| all.iter().map(of).fold(f32::NEG_INFINITY, f32::max);
    let mut whole = Extent {
        x: f32::midpoint(least(&|e| e.x - e.radius()), most(&|e| e.x + e.radius())),
        z: f32::midpoint(least(&|e| e.z - e.radius()), most(&|e| e.z + e.radius())),
        bottom: least(&|e| e.bottom),
        top: most(&|e| e.top),
        radii: [0.0; RINGS],
        person: None,
    };
    let rim = |e: &Extent, ring: usize| e.bottom + e.height() * ring as f32 / RINGS as f32;
    for extent in all {
        let off = Vec2::new(extent.x - whole.x, extent.z - whole.z).length();
        for ring in 0..RINGS {
            let (low, high) = (rim(&whole, ring), rim(&whole, ring + 1));
            // What is flat lies in the rings that it touches.
            let reaches = |i: &usize| {
                let (from, to) = (rim(extent, *i), rim(extent, *i + 1));
                if from < to { from < high && to > low } else { from <= high && to >= low }
            };
            if let Some(widest) = (0..RINGS).filter(reaches).map(|i| extent.radii[i]).reduce(f32::max) {
                whole.radii[ring] = whole.radii[ring].max(widest + off);
            }
        }
    }
    whole
}
