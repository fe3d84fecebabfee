//! Fewer nodes where an axis is all but straight.

use super::{Left, NODES_PER_CHECK, RefineError, Refinement, Shoots, Step};
use crate::{Branching, Edge, NO_PARENT};
use glam::Vec3;
use linden_base::monitor::{Cancelled, Monitor};

pub(super) const STEP: Step = Step {
    name: "decimate",
    help: "drop nodes between forks as long as the axis stays where it was, within decimate_tolerance",
    apply: decimate,
};

/// The most nodes that one segment replaces, so that time is proportional to the nodes.
const LONGEST_RUN: usize = 64;

/// Keeps feet, forks and tips, and of the chains between them what is needed to stay within the
/// tolerance: from each node that is kept, a chain goes straight to the farthest node for which no
/// node between is farther from the straight line.
///
/// The chain and what replaces it are then nowhere farther from each other than the tolerance, in
/// both directions (their Hausdorff distance): the places near a segment are a convex set, so all of
/// the chain is near when its nodes are, and the chain passes over every place of the segment.
fn decimate(
    shoots: &mut Shoots<'_>,
    refinement: &Refinement,
    monitor: &dyn Monitor,
) -> Result<(), RefineError> {
    let tolerance = refinement.decimate_tolerance * mean_segment(&shoots.branching);
    let keep = needed(&shoots.branching, tolerance as f32, monitor)?;
    Ok(shoots.retain(&keep, Left::Stay, monitor)?)
}

/// Metres.
fn mean_segment(branching: &Branching) -> f64 {
    let Branching { positions, parents, .. } = branching;
    let (mut total, mut count) = (0.0, 0_u32);
    for (at, &parent) in positions.iter().zip(parents).filter(|(_, parent)| **parent != NO_PARENT) {
        total += f64::from(at.distance(positions[parent as usize]));
        count += 1;
    }
    total / f64::from(count.max(1))
}

fn needed(branching: &Branching, tolerance: f32, monitor: &dyn Monitor) -> Result<Vec<bool>, Cancelled> {
    let Branching { positions, parents, edges, .. } = branching;
    let at = |node: u32| positions[node as usize];
    let mut only_child = only_children(parents);
    if let Some(edges) = edges {
        // An axis that ends where its one lateral leaves keeps its end.
        for child in only_child.iter_mut().filter(|child| **child != NO_PARENT) {
            if edges[*child as usize] != Edge::Succeeds {
                *child = NO_PARENT;
            }
        }
    }
    let is_end = |node: u32| parents[node as usize] == NO_PARENT || only_child[node as usize] == NO_PARENT;
    let mut keep: Vec<bool> = (0..parents.len() as u32).map(is_end).collect();
    let mut between = Vec::with_capacity(LONGEST_RUN);
    for (first, &parent) in (0..).zip(parents) {
        if (first as usize).is_multiple_of(NODES_PER_CHECK) {
            monitor.check()?;
        }
        if parent == NO_PARENT || !is_end(parent) {
            continue;
        }
        let (mut anchor, mut node) = (parent, first);
        between.clear();
        loop {
            let strays = |&skipped: &u32| distance_to_segment(at(skipped), at(anchor), at(node)) > tolerance;
            if let Some(&last) = between.last()
                && (between.len() == LONGEST_RUN || between.iter().any(strays))
            {
                keep[last as usize] = true;
                anchor = last;
                between.clear();
            }
            if is_end(node) {
                break;
            }
            between.push(node);
            node = only_child[node as usize];
        }
    }
    Ok(keep)
}

/// For each node its child when it has exactly one, else [`NO_PARENT`].
fn only_children(parents: &[u32]) -> Vec<u32> {
    /// Higher than any node that can be a child of two.
    const SEVERAL: u32 = NO_PARENT - 1;
    let mut only = vec![NO_PARENT; parents.len()];
    for (node, &parent) in (0..).zip(parents) {
        if parent != NO_PARENT {
            let known = &mut only[parent as usize];
            *known = if *known == NO_PARENT { node } else { SEVERAL };
        }
    }
    for child in &mut only {
        if *child == SEVERAL {
            *child = NO_PARENT;
        }
    }
    only
}

fn distance_to_segment(point: Vec3, from: Vec3, to: Vec3) -> f32 {
    let along = to - from;
    let length_squared = along.length_squared();
    let t =
        if length_squared > 0.0 { ((point - from).dot(along) / length_squared).clamp(0.0, 1.0) } else { 0.0 };
    point.distance(from + along * t)
}

#[cfg(test)]
mod tests {
    use super::super::testing::{random_tree, refined, topology, tree};
    use super::*;
    use crate::{AxisKind, Skeleton, Wood};

    fn decimated(all: &Branching, tolerance: f64) -> Branching {
        let refinement =
            Refinement { steps: vec![STEP], decimate_tolerance: tolerance, ..Refinement::default() };
        refined(all.clone(), &refinement)
    }

    #[test]
    fn a_straight_pole_is_a_segment_and_a_corner_stays() {
        let pole: Vec<Vec3> = (0..30).map(|i| Vec3::Y * i as f32).collect();
        let parents: Vec<u32> = (0..30).map(|i: u32| i.checked_sub(1).unwrap_or(NO_PARENT)).collect();
        assert_eq!(decimated(&tree(pole.clone(), &parents), 0.01).births, [0, 29]);
        let mut corner = pole;
        for (i, at) in corner.iter_mut().enumerate().skip(20) {
            *at = Vec3::new((i - 20) as f32, 20.0, 0.0);
        }
        assert_eq!(decimated(&tree(corner, &parents), 0.01).births, [0, 20, 29]);
    }

    /// A tip is dead where an axis on its way down is said to be.
    #[test]
    fn dead_wood_is_dead_with_all_that_it_bears_whatever_is_refined() {
        let (mut dead, mut living) = (0, 0);
        for seed in 0..20 {
            let mut all = random_tree(seed, 300, 0.8);
            let mut edges = vec![Edge::Succeeds; all.parents.len()];
            let mut is_continued = vec![false; all.parents.len()];
            for (node, &parent) in all.parents.iter().enumerate().filter(|(_, parent)| **parent != NO_PARENT)
            {
                if std::mem::replace(&mut is_continued[parent as usize], true) {
                    edges[node] = if node % 7 == 0 { Edge::Dies } else { Edge::Branches };
                }
            }
            all.edges = Some(edges.clone());
            let is_dead = |tip: u32| {
                let mut node = tip;
                while all.parents[node as usize] != NO_PARENT && edges[node as usize] != Edge::Dies {
                    node = all.parents[node as usize];
                }
                edges[node as usize] == Edge::Dies
            };
            for steps in [vec![], vec!["decimate"], vec!["decimate", "relocate", "smooth", "subdivide"]] {
                let steps = steps.into_iter().map(|name| Step::named(name).unwrap()).collect();
                let less = refined(all.clone(), &Refinement { steps, ..Refinement::default() });
                let tree = Skeleton::build(less, &Wood::default()).unwrap();
                for (index, axis) in tree.axes.iter().enumerate() {
                    // Births name nodes, and tips stay.
                    let tip = tree.births[tree.nodes_of(axis)[axis.len as usize - 1] as usize];
                    assert_eq!(tree.kind_of(index) == AxisKind::Dead, is_dead(tip), "{seed}: {tip}");
                    if is_dead(tip) { dead += 1 } else { living += 1 }
                }
            }
        }
        assert!(dead > 200 && living > 200, "{dead} {living}");
    }

    /// Both trees as soups of segments, sampled: no sample of one is farther from the other.
    #[test]
    fn nothing_moves_farther_than_the_tolerance() {
        let segments = |b: &Branching| -> Vec<[Vec3; 2]> {
            let ends = |(&at, &parent): (&Vec3, &u32)| {
                (parent != NO_PARENT).then(|| [b.positions[parent as usize], at])
            };
            b.positions.iter().zip(&b.parents).filter_map(ends).collect()
        };
        let mut fewer = 0;
        for seed in 0..30 {
            let all = random_tree(seed, 200, 0.9);
            for tolerance in [0.05, 0.3, 1.0] {
                let less = decimated(&all, tolerance);
                fewer += all.parents.len() - less.parents.len();
                assert_eq!(topology(&all), topology(&less), "feet, forks and tips");
                let (a, b) = (segments(&all), segments(&less));
                let most = (tolerance * mean_segment(&all)) as f32 + 1e-5;
                for (from, to) in [(&a, &b), (&b, &a)] {
                    for [start, end] in from {
                        for t in 0..=10 {
                            let sample = start.lerp(*end, t as f32 / 10.0);
                            let nearest = to.iter().map(|[p, q]| distance_to_segment(sample, *p, *q));
                            let distance = nearest.fold(f32::INFINITY, f32::min);
                            assert!(distance <= most, "seed {seed}: {distance} of {most}");
                        }
                    }
                }
            }
        }
        assert!(fewer > 1000, "{fewer} nodes less in all");
    }
}
