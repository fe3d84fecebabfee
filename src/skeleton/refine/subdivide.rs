//! Curved axes: more nodes, on the curve that the nodes control.

use super::{NODES_PER_CHECK, RefineError, Refinement, Shoots, Step, on_chord};
use crate::{Branching, Edge, NO_PARENT};
use linden_base::monitor::Monitor;

pub(super) const STEP: Step = Step {
    name: "subdivide",
    help: "halve each segment, subdivisions times, and round the axes: cubic B-splines in the limit",
    apply: subdivide,
};

/// Halves segments as cubic B-splines are subdivided (Lane & Riesenfeld 1980): a new node stands in
/// the middle of each segment as it was, and an old one goes a quarter of the way onto the straight
/// line between its neighbours along the axis, to `(a + 6 p + b) / 8` where segments are equally
/// long.
///
/// Feet and tips stay where they are, and so does a node that would go into an obstacle; a segment
/// whose middle lies in one is not halved. A fork follows the axis that runs on through it, and its
/// laterals start where it then is. A new node is born with the end of its segment. Where radii are
/// given it has their mean, on the first segment of a lateral that of the lateral.
fn subdivide(
    shoots: &mut Shoots<'_>,
    refinement: &Refinement,
    monitor: &dyn Monitor,
) -> Result<(), RefineError> {
    for _ in 0..refinement.subdivisions {
        once(shoots, monitor)?;
    }
    Ok(())
}

fn once(shoots: &mut Shoots<'_>, monitor: &dyn Monitor) -> Result<(), RefineError> {
    let old = &shoots.branching;
    let feet = old.parents.iter().filter(|&&parent| parent == NO_PARENT).count();
    let nodes = 2 * shoots.len() - feet;
    let limit = shoots.room.most_nodes.min(u64::from(NO_PARENT - 1));
    if nodes as u64 > limit {
        return Err(RefineError::TooManyNodes { nodes: nodes as u64, limit });
    }
    shoots.admit(nodes, monitor)?;
    let successor = shoots.successors();
    let is_barred = shoots.room.is_barred;
    let mut new = Branching {
        positions: Vec::with_capacity(nodes),
        parents: Vec::with_capacity(nodes),
        births: Vec::with_capacity(nodes),
        radii: old.radii.as_ref().map(|_| Vec::with_capacity(nodes)),
        edges: old.edges.as_ref().map(|_| Vec::with_capacity(nodes)),
    };
    let mut captured = shoots.captured.as_ref().map(|_| Vec::with_capacity(nodes));
    // Where each node goes; the one before it is the new one.
    let mut index = vec![0_u32; shoots.len()];
    for node in 0..shoots.len() {
        if node.is_multiple_of(NODES_PER_CHECK) {
            monitor.check()?;
        }
        let (parent, above) = (old.parents[node], successor[node]);
        let here = old.positions[node];
        let at = |node: u32| old.positions[node as usize];
        let mut below = if parent == NO_PARENT { NO_PARENT } else { index[parent as usize] };
        let middle = if parent == NO_PARENT { here } else { (here + at(parent)) * 0.5 };
        let is_halved = parent != NO_PARENT && !is_barred(middle);
        if is_halved {
            new.positions.push(middle);
            new.parents.push(below);
            below = new.positions.len() as u32 - 1;
            if let (Some(radii), Some(of)) = (&mut new.radii, &old.radii) {
                let continues = successor[parent as usize] == node as u32;
                let foot = if continues { of[parent as usize] } else { of[node] };
                radii.push(f32::midpoint(foot, of[node]));
            }
        }
        let round = match (parent, above) {
            (NO_PARENT, _) | (_, NO_PARENT) => here,
            (before, after) => here.lerp(on_chord(at(before), here, at(after)), 0.25),
        };
        new.positions.push(if round != here && is_barred(round) { here } else { round });
        index[node] = new.positions.len() as u32 - 1;
        new.parents.push(below);
        let copies = if is_halved { 2 } else { 1 };
        new.births.resize(new.positions.len(), old.births[node]);
        if let (Some(radii), Some(of)) = (&mut new.radii, &old.radii) {
            radii.push(of[node]);
        }
        if let (Some(edges), Some(of)) = (&mut new.edges, &old.edges) {
            edges.push(of[node]);
            if is_halved {
                edges.push(Edge::Succeeds);
            }
        }
        if let (Some(captured), Some(of)) = (&mut captured, &shoots.captured) {
            captured.extend(std::iter::repeat_n(of[node], copies));
        }
    }
    for rider in &mut *shoots.riders {
        let before = old.positions[rider.node as usize];
        rider.node = index[rider.node as usize];
        rider.moved += new.positions[rider.node as usize] - before;
    }
    shoots.branching = new;
    shoots.captured = captured;
    Ok(())
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::super::testing::{bending, random_tree, refined, straight_with_lateral, topology, tree};
    use super::*;
    use crate::refine::{Room, refine};
    use linden_base::monitor::Quiet;

    fn subdivided(all: Branching, times: u32) -> Branching {
        refined(all, &Refinement { steps: vec![STEP], subdivisions: times, ..Refinement::default() })
    }

    #[test]
    fn a_corner_is_rounded_as_computed_by_hand() {
        let at = |x: f32, y: f32| Vec3::new(x, y, 0.0);
        let mut corner = tree(vec![at(0., 0.), at(0., 1.), at(1., 1.)], &[NO_PARENT, 0, 1]);
        corner.radii = Some(vec![0.4, 0.2, 0.1]);
        let round = subdivided(corner, 1);
        assert_eq!(round.positions, [at(0., 0.), at(0., 0.5), at(0.125, 0.875), at(0.5, 1.), at(1., 1.)]);
        assert_eq!(round.parents, [NO_PARENT, 0, 1, 2, 3]);
        assert_eq!(round.births, [0, 1, 1, 2, 2]);
        assert_eq!(round.radii.unwrap(), [0.4, 0.3, 0.2, 0.15, 0.1]);
    }

    #[test]
    fn forks_feet_and_tips_stay_and_straight_wood_stays_straight() {
        let straight = subdivided(straight_with_lateral(), 3);
        let is_straight = |p: &Vec3| p.x.abs() < 1e-6 || (p.y - 4.0).abs() < 1e-5;
        assert!(straight.positions.iter().all(is_straight), "{:?}", straight.positions);
        let heights: Vec<f32> = straight.positions.iter().filter(|p| p.x == 0.0).map(|p| p.y).collect();
        assert!(heights.is_sorted(), "no node overtakes the next");
        for seed in 0..10 {
            let all = random_tree(seed, 200, 0.8);
            let fine = subdivided(all.clone(), 2);
            let ends = |b: &Branching| (topology(b).0.len(), topology(b).1, topology(b).2.len());
            assert_eq!(ends(&fine), ends(&all), "seed {seed}");
            assert!(bending(&fine) < bending(&all), "seed {seed}");
        }
    }

    /// The limit of the scheme is known: at a node of a uniform cubic B-spline, (a + 4 p + b) / 6.
    #[test]
    fn the_limit_is_the_cubic_b_spline() {
        let points: Vec<Vec3> =
            (0..7).map(|i| Vec3::new(i as f32, if i % 2 == 0 { 0.0 } else { 1.0 }, 0.0)).collect();
        let parents: Vec<u32> = (0..7).map(|i: u32| i.checked_sub(1).unwrap_or(NO_PARENT)).collect();
        let fine = subdivided(tree(points.clone(), &parents), 8);
        for i in 2..5 {
            let limit = (points[i - 1] + points[i] * 4.0 + points[i + 1]) / 6.0;
            let found = fine.positions[i << 8];
            assert!(found.distance(limit) < 1e-3, "{found} against {limit}");
        }
    }

    #[test]
    fn too_many_nodes_are_refused_with_the_number() {
        let all = random_tree(1, 100, 0.8);
        let refinement = Refinement { steps: vec![STEP], subdivisions: 4, ..Refinement::default() };
        let error = refine(all, None, &mut [], &refinement, Room::open(500), &Quiet).unwrap_err();
        assert!(matches!(error, RefineError::TooManyNodes { nodes: 501..=800, limit: 500 }), "{error}");
    }
}
