//! Twigs that lead nowhere.

use super::{Left, NODES_PER_CHECK, RefineError, Refinement, Shoots, Step};
use crate::NO_PARENT;
use linden_base::monitor::Monitor;

pub(super) const STEP: Step = Step {
    name: "prune",
    help: "drop shoots that never caught an attraction point; where nobody knows, short side twigs",
    apply: prune,
};

/// Drops all shoots that captured nothing, themselves or further up, but what the tree started with
/// (13–20 % of the nodes of a large tree, all at tips: a node grows on only towards what it
/// captured).
///
/// Where it is not known what captured, drops laterals of at most `prune_nodes` nodes that bear no
/// laterals themselves.
fn prune(shoots: &mut Shoots<'_>, refinement: &Refinement, monitor: &dyn Monitor) -> Result<(), RefineError> {
    let keep = match &shoots.captured {
        Some(captured) => fertile(shoots, captured),
        None => all_but_short_laterals(shoots, refinement.prune_nodes, monitor)?,
    };
    Ok(shoots.retain(&keep, Left::Fall, monitor)?)
}

fn fertile(shoots: &Shoots<'_>, captured: &[bool]) -> Vec<bool> {
    let (parents, births) = (&shoots.branching.parents, &shoots.branching.births);
    let mut keep = captured.to_vec();
    for (node, &parent) in parents.iter().enumerate().rev() {
        keep[node] |= births[node] == 0 || parent == NO_PARENT;
        if keep[node] && parent != NO_PARENT {
            keep[parent as usize] = true;
        }
    }
    keep
}

fn all_but_short_laterals(
    shoots: &Shoots<'_>,
    longest: u32,
    monitor: &dyn Monitor,
) -> Result<Vec<bool>, RefineError> {
    let parents = &shoots.branching.parents;
    let successor = shoots.successors();
    let mut bears_lateral = vec![false; parents.len()];
    let continues = |node: u32, parent: u32| successor[parent as usize] == node;
    for (node, &parent) in (0..).zip(parents) {
        if parent != NO_PARENT && !continues(node, parent) {
            bears_lateral[parent as usize] = true;
        }
    }
    let mut keep = vec![true; parents.len()];
    for (base, &parent) in (0..).zip(parents) {
        if (base as usize).is_multiple_of(NODES_PER_CHECK) {
            monitor.check()?;
        }
        if parent == NO_PARENT || continues(base, parent) {
            continue;
        }
        let along = |&node: &u32| Some(successor[node as usize]).filter(|&next| next != NO_PARENT);
        let is_short = std::iter::successors(Some(base), along).nth(longest as usize).is_none();
        let is_bare = || {
            let nodes = || std::iter::successors(Some(base), along);
            nodes().all(|node| !bears_lateral[node as usize])
        };
        if is_short && is_bare() {
            for node in std::iter::successors(Some(base), along) {
                keep[node as usize] = false;
            }
        }
    }
    Ok(keep)
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::super::Room;
    use super::super::testing::{refined, tree};
    use super::*;
    use crate::refine::refine;
    use linden_base::monitor::Quiet;

    #[test]
    fn what_never_captured_goes_and_the_rest_stays() {
        // A stem 0-1-2-3, barren 4 at its top, barren lateral 5-6 on 1, fertile 7 beyond barren 8's side.
        let parents = [NO_PARENT, 0, 1, 2, 3, 1, 5, 2, 2];
        let captured = [false, true, true, true, false, false, false, true, false];
        let positions: Vec<Vec3> = (0..9).map(|i| Vec3::new(0.0, i as f32, 0.0)).collect();
        let all = tree(positions, &parents);
        let only = Refinement { steps: vec![STEP], ..Refinement::default() };
        let left =
            refine(all.clone(), Some(captured.to_vec()), &mut [], &only, Room::open(100), &Quiet).unwrap();
        let heights: Vec<f32> = left.positions.iter().map(|p| p.y).collect();
        assert_eq!(heights, [0.0, 1.0, 2.0, 3.0, 7.0]);
        assert_eq!(left.parents, [NO_PARENT, 0, 1, 2, 2]);
        assert_eq!(left.births, [0, 1, 2, 3, 7]);
    }

    #[test]
    fn without_captures_short_bare_laterals_go() {
        // Stem 0 to 4; on 1 a lateral 5; on 2 a lateral 6-7 that bears 8; on 3 a lateral 9-10.
        let parents = [NO_PARENT, 0, 1, 2, 3, 1, 2, 6, 6, 3, 9, 10];
        let at = |x: f32, y: f32| Vec3::new(x, y, 0.0);
        let positions = vec![
            at(0., 0.),
            at(0., 1.),
            at(0., 2.),
            at(0., 3.),
            at(0., 4.),
            at(1., 1.),
            at(1., 2.),
            at(2., 2.),
            at(1., 3.),
            at(1., 3.5),
            at(2., 3.5),
            at(3., 3.5),
        ];
        // The top of the stem is its longest child: 9-10-11 has one tip as 4 has, but 4 is straight.
        let all = tree(positions, &parents);
        let go = |nodes| {
            let refinement = Refinement { steps: vec![STEP], prune_nodes: nodes, ..Refinement::default() };
            refined(all.clone(), &refinement)
        };
        assert_eq!(go(1).births, [0, 1, 2, 3, 4, 6, 7, 9, 10, 11], "5 and 8");
        assert_eq!(go(2).births, go(1).births);
        assert_eq!(go(3).births, [0, 1, 2, 3, 4, 6, 7], "9 to 11, too");
    }
}
