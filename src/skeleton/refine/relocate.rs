//! Smaller branching angles.

use glam::Vec3;
use rayon::prelude::*;

use super::{RefineError, Refinement, Shoots, Step};
use crate::{Branching, NO_PARENT};
use linden_base::monitor::Monitor;

pub(super) const STEP: Step = Step {
    name: "relocate",
    help: "move each node towards its parent, by relocate_share: smaller branching angles",
    apply: relocate,
};

/// Moves all nodes but the feet towards their parents, all at the same time (RLP07, section 4:
/// halfway).
///
/// Each segment becomes a mean of itself and of the one before it, so that it turns towards that
/// one, and no way from a foot to a node gets longer; tips lose a share of their last segment.
fn relocate(
    shoots: &mut Shoots<'_>,
    refinement: &Refinement,
    monitor: &dyn Monitor,
) -> Result<(), RefineError> {
    let share = refinement.relocate_share as f32;
    let Branching { positions, parents, .. } = &shoots.branching;
    monitor.check()?;
    let towards = |(&here, &parent): (&Vec3, &u32)| match parent {
        NO_PARENT => here,
        parent => here + (positions[parent as usize] - here) * share,
    };
    let moved = positions.par_iter().zip(parents).map(towards).collect();
    shoots.relocate(moved);
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::super::testing::{random_tree, refined};
    use super::*;

    /// By the definition, from a copy; and ways from the foot, all of them.
    #[test]
    fn each_node_moves_as_defined_and_no_way_gets_longer() {
        let way = |b: &Branching, mut node: usize| {
            let mut length = 0.0;
            while b.parents[node] != NO_PARENT {
                let parent = b.parents[node] as usize;
                length += f64::from(b.positions[node].distance(b.positions[parent]));
                node = parent;
            }
            length
        };
        for seed in 0..20 {
            let all = random_tree(seed, 300, 0.7);
            for share in [0.25, 0.5, 1.0] {
                let refinement =
                    Refinement { steps: vec![STEP], relocate_share: share, ..Refinement::default() };
                let moved = refined(all.clone(), &refinement);
                assert_eq!((&moved.parents, &moved.births), (&all.parents, &all.births));
                for node in 0..all.parents.len() {
                    let expected = match all.parents[node] {
                        NO_PARENT => all.positions[node],
                        parent => all.positions[node].lerp(all.positions[parent as usize], share as f32),
                    };
                    assert!(moved.positions[node].distance(expected) < 1e-5);
                    assert!(way(&moved, node) <= way(&all, node) + 1e-4, "seed {seed}, node {node}");
                }
            }
        }
    }
}
