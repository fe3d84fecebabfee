//! The crown as one convex solid.

use std::collections::BTreeSet;

use linden_pipeline::DVec3;
use linden_pipeline::hull::HullSolid;
use linden_pipeline::scene::Scene;

use super::solid::Solid;

/// Corners at most: physics engines take up to 255, and are the faster the fewer.
const MOST_CORNERS: usize = 64;

/// The hull of what grows on the trunk: leaves, and branches where there are some.
pub(super) fn of(scene: &Scene) -> Option<Solid> {
    let skeleton = &scene.skeleton;
    let leaves = scene.parts.iter().filter(|part| !part.name.starts_with("wood"));
    let leaves = leaves.flat_map(|part| &part.mesh.positions);
    let branches = skeleton.axes.iter().filter(|axis| axis.order > 0);
    let branches = branches.flat_map(|axis| skeleton.nodes_of(axis));
    let branches = branches.map(|&node| &skeleton.positions[node as usize]);
    let exact = HullSolid::of_all(leaves.chain(branches).map(|point| point.as_dvec3()));
    if exact.triangles.is_empty() {
        return None;
    }
    Some(Solid::new(&with_few_corners(exact)))
}

/// The hull of the farthest corners in directions all round, grown to the volume of the whole.
fn with_few_corners(exact: HullSolid) -> HullSolid {
    if exact.corners.len() <= MOST_CORNERS {
        return exact;
    }
    let farthest = |way: DVec3| {
        let of = |i: &usize| way.dot(exact.corners[*i]);
        (0..exact.corners.len()).max_by(|a, b| of(a).total_cmp(&of(b)))
    };
    let chosen: BTreeSet<usize> = (0..MOST_CORNERS).filter_map(|i| farthest(direction(i))).collect();
    let corners: Vec<DVec3> = chosen.into_iter().map(|i| exact.corners[i]).collect();
    let mut few = HullSolid::of(&corners);
    if few.triangles.is_empty() {
        return exact;
    }
    let middle = few.corners.iter().sum::<DVec3>() / few.corners.len() as f64;
    let growth = libm::cbrt(exact.volume() / few.volume());
    for corner in &mut few.corners {
        *corner = middle + (*corner - middle) * growth;
    }
    few
}

/// Evenly all round: along a spiral that turns by the golden angle (Vogel 1979), on a sphere.
fn direction(i: usize) -> DVec3 {
    let height = 1.0 - (2 * i + 1) as f64 / MOST_CORNERS as f64;
    let flat = libm::sqrt(1.0 - height * height);
    let (sin, cos) = libm::sincos(i as f64 * std::f64::consts::PI * (3.0 - libm::sqrt(5.0)));
    DVec3::new(flat * cos, height, flat * sin)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_corners_have_the_volume_of_all() {
        let points: Vec<DVec3> = (0..3000_usize)
            .map(|i| {
                let way = direction(i % MOST_CORNERS);
                way * (3.0 + (i % 7) as f64 * 0.1) + DVec3::new(0.0, (i / 64) as f64 * 0.02, 0.0)
            })
            .collect();
        let exact = HullSolid::of(&points);
        let few = with_few_corners(exact.clone());
        assert!(few.corners.len() <= MOST_CORNERS);
        assert!((few.volume() / exact.volume() - 1.0).abs() < 1e-9);
    }
}
