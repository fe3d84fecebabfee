//! Axes without wiggles, with the same nodes.

use rayon::prelude::*;

use super::{RefineError, Refinement, Shoots, Step, on_chord};
use crate::{Branching, NO_PARENT};
use linden_base::monitor::Monitor;

pub(super) const STEP: Step = Step {
    name: "smooth",
    help: "average each node with its neighbours along the axis, smooth_rounds times",
    apply: smooth,
};

/// Moves each node halfway onto the straight line between its neighbours along the axis: to
/// `(a + 2 p + b) / 4` where segments are equally long. Feet and tips stay where they are; a fork
/// follows the axis that runs on through it, and its laterals start where it then is.
fn smooth(
    shoots: &mut Shoots<'_>,
    refinement: &Refinement,
    monitor: &dyn Monitor,
) -> Result<(), RefineError> {
    let successor = shoots.successors();
    for _ in 0..refinement.smooth_rounds {
        monitor.check()?;
        let Branching { positions, parents, .. } = &shoots.branching;
        let moved = (0..parents.len())
            .into_par_iter()
            .map(|node| match (parents[node], successor[node]) {
                (NO_PARENT, _) | (_, NO_PARENT) => positions[node],
                (below, above) => {
                    let here = positions[node];
                    here.midpoint(on_chord(positions[below as usize], here, positions[above as usize]))
                }
            })
            .collect();
        shoots.relocate(moved);
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::super::testing::{bending, random_tree, refined, straight_with_lateral, tree};
    use super::*;

    fn smoothed(all: Branching, rounds: u32) -> Branching {
        refined(all, &Refinement { steps: vec![STEP], smooth_rounds: rounds, ..Refinement::default() })
    }

    #[test]
    fn a_zigzag_flattens_as_computed_by_hand() {
        let at = |x: f32, y: f32| Vec3::new(x, y, 0.0);
        let zigzag = vec![at(0., 0.), at(1., 1.), at(0., 2.), at(1., 3.), at(0., 4.)];
        let once = smoothed(tree(zigzag, &[NO_PARENT, 0, 1, 2, 3]), 1);
        assert_eq!(once.positions, [at(0., 0.), at(0.5, 1.), at(0.5, 2.), at(0.5, 3.), at(0., 4.)]);
    }

    #[test]
    fn straight_wood_stays_straight_and_crooked_wood_bends_less() {
        let straight = smoothed(straight_with_lateral(), 5);
        for (now, then) in straight.positions.iter().zip(straight_with_lateral().positions) {
            assert!(now.distance(then) < 1e-5, "{now} was {then}");
        }
        for seed in 0..10 {
            let all = random_tree(seed, 200, 0.9);
            assert!(bending(&smoothed(all.clone(), 3)) < bending(&all), "seed {seed}");
        }
    }
}
