//! Trunks that bear no leaves, thin as they may be.
//!
//! What is thinner than three tips is a twig, and bears leaves; of a young tree the trunk is one by that measure.
//! It is told by its branches: leaves begin at the lowest that leaves it. One below that which runs up along the
//! stem, as space colonization draws them towards a crown, is bare as far up.

use std::collections::BTreeMap;

use linden_skeleton::{Axis, AxisKind, NO_PARENT, Skeleton};

use crate::settings::LeafKind;

/// A branch has left its stem at this distance from its axis, in the stem's radii.
const CLEAR: f32 = 3.0;
/// It runs along its stem where it takes this many times as long to get there.
const ALONG: f32 = 3.0;

/// Up to which height (Y, metres) axes bear nothing of a kind, by their indices; others have no such height.
pub(super) fn bare_below(kind: &LeafKind, skeleton: &Skeleton) -> BTreeMap<usize, f32> {
    let mut bare = bare_wood(kind, skeleton);
    let dead = (0..skeleton.axes.len()).filter(|&axis| skeleton.kind_of(axis) == AxisKind::Dead);
    bare.extend(dead.map(|axis| (axis, f32::INFINITY)));
    bare
}

/// The same but for dead twigs. Shoots out of old wood are no branches that a crown begins with.
fn bare_wood(kind: &LeafKind, skeleton: &Skeleton) -> BTreeMap<usize, f32> {
    let stems = skeleton.axes.iter().enumerate().filter(|(_, axis)| axis.parent == NO_PARENT);
    if let Some(from_m) = kind.from_m {
        let foot = |axis| skeleton.nodes_of(axis).first().map(|&node| skeleton.positions[node as usize].y);
        return stems.filter_map(|(index, axis)| Some((index, foot(axis)? + from_m as f32))).collect();
    }
    let axis_of = skeleton.axis_of_nodes();
    let grown =
        skeleton.axes.iter().enumerate().filter(|(index, _)| skeleton.kind_of(*index) == AxisKind::Grown);
    let of_stems = grown.filter_map(|(index, axis)| {
        let stem = (axis.parent != NO_PARENT).then(|| axis_of[axis.parent as usize] as usize)?;
        (skeleton.axes[stem].parent == NO_PARENT).then_some((index, stem))
    });
    let (mut bare, mut along) = (BTreeMap::new(), Vec::new());
    for (index, stem) in of_stems {
        let branch = &skeleton.axes[index];
        let fork = skeleton.positions[branch.parent as usize].y;
        if bare.get(&stem).is_some_and(|&lowest| fork >= lowest) {
            continue;
        }
        match left_at(branch, &skeleton.axes[stem], skeleton) {
            Some(height) => along.push((index, stem, height)),
            None => {
                bare.insert(stem, fork);
            }
        }
    }
    for (index, stem, height) in along {
        if let Some(&lowest) = bare.get(&stem) {
            bare.insert(index, height.min(lowest));
        }
    }
    bare
}

/// The height at which a branch that runs along its stem leaves it; `None`: it does not.
fn left_at(branch: &Axis, stem: &Axis, skeleton: &Skeleton) -> Option<f32> {
    let at = |node: u32| skeleton.positions[node as usize];
    let stem = skeleton.nodes_of(stem);
    let mut near = stem.iter().position(|&node| node == branch.parent)?;
    let clear = CLEAR * skeleton.radii[branch.parent as usize];
    let (mut last, mut last_off, mut along) = (at(branch.parent), 0.0, 0.0);
    for &node in skeleton.nodes_of(branch) {
        let here = at(node);
        while stem.get(near + 1).is_some_and(|&next| at(next).distance(here) < at(stem[near]).distance(here))
        {
            near += 1;
        }
        let beside = [near.saturating_sub(1), near + 1];
        let ends = beside.map(|other| stem.get(other).map_or(at(stem[near]), |&node| at(node)));
        let off = ends.map(|end| off_segment(here, at(stem[near]), end)).into_iter().fold(f32::MAX, f32::min);
        if off > clear {
            // However long the segment is, as far along it as it takes.
            let share = ((clear - last_off) / (off - last_off)).clamp(0.0, 1.0);
            along += share * here.distance(last);
            return (along > ALONG * clear).then_some(last.y + share * (here.y - last.y));
        }
        along += here.distance(last);
        (last, last_off) = (here, off);
    }
    (along > ALONG * clear).then_some(f32::INFINITY)
}

fn off_segment(point: glam::Vec3, from: glam::Vec3, to: glam::Vec3) -> f32 {
    let way = to - from;
    let share = ((point - from).dot(way) / way.length_squared().max(f32::MIN_POSITIVE)).clamp(0.0, 1.0);
    point.distance(from + way * share)
}
