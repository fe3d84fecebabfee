//! A procedural tree to look at, independent of the generators.

use glam::Vec3;
use linden_pipeline::random::Key;
use linden_pipeline::skeleton::Axis;
use linden_pipeline::{NO_PARENT, Skeleton};

/// One axis through these places, with these radii.
pub fn stem(nodes: &[(Vec3, f32)]) -> Skeleton {
    let n = nodes.len() as u32;
    Skeleton {
        positions: nodes.iter().map(|n| n.0).collect(),
        parents: (0..n).map(|i| i.checked_sub(1).unwrap_or(NO_PARENT)).collect(),
        radii: nodes.iter().map(|n| n.1).collect(),
        births: (0..n).collect(),
        axes: vec![Axis { order: 0, parent: NO_PARENT, first: 0, len: n }],
        axis_nodes: (0..n).collect(),
        ..Skeleton::default()
    }
}

/// A tree about 8 m high; each level of `depth` adds a branching order.
pub fn tree(seed: u64, depth: u32) -> Skeleton {
    let mut tree = Skeleton::default();
    let key = Key::new(seed).named("sample");
    let trunk = Shoot { base: Vec3::ZERO, direction: Vec3::Y, length_m: 8.0, radius_m: 0.17, order: 0 };
    grow(&mut tree, NO_PARENT, trunk, depth, key);
    tree
}

#[derive(Clone, Copy)]
struct Shoot {
    base: Vec3,
    direction: Vec3,
    length_m: f32,
    radius_m: f32,
    order: u32,
}

fn grow(tree: &mut Skeleton, parent: u32, shoot: Shoot, depth: u32, key: Key) {
    let Shoot { base, direction, length_m, radius_m, order } = shoot;
    let internodes = [26, 16, 11, 8, 6, 5][order.min(5) as usize];
    let axis = tree.axes.len();
    tree.axes.push(Axis { order, parent, first: 0, len: 0 });
    let mut nodes = Vec::new();
    let (mut at, mut heading, mut last) = (base, direction, parent);
    let start_birth = if parent == NO_PARENT { 0 } else { tree.births[parent as usize] };
    for i in 0..=internodes {
        if i > 0 {
            let jitter = |name: &str| key.named(name).child(u64::from(i)).between(-1.0, 1.0) as f32;
            let wander =
                Vec3::new(jitter("x"), jitter("y"), jitter("z")) * if order == 0 { 0.07 } else { 0.2 };
            heading = (heading + wander + Vec3::Y * if order == 0 { 0.05 } else { 0.06 }).normalize();
            at += heading * length_m / internodes as f32;
        } else if parent != NO_PARENT {
            continue;
        }
        let t = i as f32 / internodes as f32;
        tree.positions.push(at);
        tree.parents.push(last);
        tree.radii.push((radius_m * (1.0 - 0.93 * t)).max(0.002));
        tree.births.push(start_birth + i);
        last = tree.positions.len() as u32 - 1;
        nodes.push((last, heading, t));
    }
    tree.axes[axis].first = tree.axis_nodes.len() as u32;
    tree.axes[axis].len = nodes.len() as u32;
    tree.axis_nodes.extend(nodes.iter().map(|n| n.0));
    if order >= depth {
        return;
    }
    let bare = if order == 0 { 0.22 } else { 0.12 };
    for (k, (node, heading, t)) in nodes.into_iter().filter(|n| n.2 > bare).enumerate() {
        let branch_key = key.child(k as u64);
        let azimuth = k as f32 * 2.399_963 + branch_key.named("azimuth").between(-0.4, 0.4) as f32;
        let (side, other) = heading.any_orthonormal_pair();
        let (s, c) = libm::sincosf(azimuth);
        let angle = (branch_key.named("angle").between(0.75, 1.15) as f32) * (1.0 - 0.35 * t);
        let (sa, ca) = libm::sincosf(angle);
        let direction = heading * ca + (side * c + other * s) * sa;
        // A round crown: the longest branches a third of the way up it.
        let shape = libm::sinf(std::f32::consts::PI * (0.25 + 0.72 * t)).max(0.1);
        let vigour = branch_key.named("vigour").between(0.7, 1.1) as f32;
        let length_m = length_m * shape * vigour * if order == 0 { 0.52 } else { 0.48 };
        let radius_m = tree.radii[node as usize] * if order == 0 { 0.5 } else { 0.55 };
        let base = tree.positions[node as usize];
        grow(tree, node, Shoot { base, direction, length_m, radius_m, order: order + 1 }, depth, branch_key);
    }
}
