//! Chains of capsules along thick wood.

use linden_pipeline::Vec3;
use linden_pipeline::skeleton::{Axis, NO_PARENT, Skeleton};

/// How far the wood's surface may be from a capsule's, as a share of its radius.
const TOLERANCE: f32 = 0.25;
/// Wood that is thinner than this share of the thickest gives way.
const THIN: f32 = 0.1;

/// A segment and all that is nearer to it than a radius.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Capsule {
    pub from: Vec3,
    pub to: Vec3,
    pub radius_m: f32,
}

/// Capsules along the axes of orders up to `order`, thick ones first, at most so many.
pub(super) fn of(skeleton: &Skeleton, order: u32, most: usize) -> Vec<Capsule> {
    let thickest = skeleton.radii.iter().copied().fold(0.0, f32::max);
    let axes = skeleton.axes.iter().filter(|axis| axis.order <= order);
    let mut capsules: Vec<Capsule> = axes.flat_map(|axis| along(skeleton, axis, THIN * thickest)).collect();
    capsules.sort_by(|a, b| b.radius_m.total_cmp(&a.radius_m));
    capsules.truncate(most);
    capsules
}

/// Where an axis is, and how thick: from where it leaves its parent on, as thick there as itself.
fn path(skeleton: &Skeleton, axis: &Axis, thin_m: f32) -> Vec<(Vec3, f32)> {
    let at = |&node: &u32| (skeleton.positions[node as usize], skeleton.radii[node as usize]);
    let nodes = skeleton.nodes_of(axis);
    let foot = Some(axis.parent).filter(|&parent| parent != NO_PARENT);
    let foot = foot.zip(nodes.first()).map(|(foot, first)| (at(&foot).0, at(first).1));
    foot.into_iter().chain(nodes.iter().map(at)).take_while(|(_, radius)| *radius >= thin_m).collect()
}

/// The fewest that follow an axis, each as far as it is near enough.
fn along(skeleton: &Skeleton, axis: &Axis, thin_m: f32) -> Vec<Capsule> {
    let path = path(skeleton, axis, thin_m);
    let mut capsules = Vec::new();
    let mut first = 0;
    while first + 1 < path.len() {
        // Two neighbours are as near as it gets.
        let mut last = first + 1;
        while last + 1 < path.len() && is_near(&path[first..=last + 1]) {
            last += 1;
        }
        capsules.push(round(&path[first..=last]));
        first = last;
    }
    capsules
}

/// From the first to the last, with the volume of the wood between.
fn round(path: &[(Vec3, f32)]) -> Capsule {
    let (from, to) = (path[0].0, path[path.len() - 1].0);
    let (mut volume, mut length) = (0.0, 0.0);
    for pair in path.windows(2) {
        let (step, [a, b]) = (pair[0].0.distance(pair[1].0), [pair[0].1, pair[1].1]);
        // A truncated cone.
        volume += step * (a * a + a * b + b * b) / 3.0;
        length += step;
    }
    let radius_m = if length > 0.0 { libm::sqrtf(volume / length) } else { path[0].1 };
    Capsule { from, to, radius_m }
}

/// Whether the wood's surface is within the tolerance of one capsule's all along.
fn is_near(path: &[(Vec3, f32)]) -> bool {
    let Capsule { from, to, radius_m } = round(path);
    let along = to - from;
    let square = along.length_squared();
    path.iter().all(|&(point, radius)| {
        let share = if square > 0.0 { ((point - from).dot(along) / square).clamp(0.0, 1.0) } else { 0.0 };
        let off = point.distance(from + share * along);
        off + (radius - radius_m).abs() <= TOLERANCE * radius_m
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_straight_pole_is_one_capsule_and_a_bend_two() {
        let at = |x: f32, y: f32| (Vec3::new(x, y, 0.0), 0.2);
        assert!(is_near(&[at(0.0, 0.0), at(0.01, 1.0), at(0.0, 2.0)]));
        assert!(!is_near(&[at(0.0, 0.0), at(0.0, 2.0), at(2.0, 2.0)]));
    }

    #[test]
    fn a_cone_keeps_its_volume() {
        let capsule = round(&[(Vec3::ZERO, 0.3), (Vec3::Y * 4.0, 0.1)]);
        assert!((capsule.radius_m * capsule.radius_m - (0.09 + 0.03 + 0.01) / 3.0).abs() < 1e-6);
    }
}
