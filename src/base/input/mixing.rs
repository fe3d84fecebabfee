//! Whether two sets of points lie among each other, as those on the wood and the leaves of a tree do.
//!
//! Two trees meet at the rims of their crowns; a tree and the ground at its foot. Twigs have leaves all over the crown.

use std::collections::HashSet;

use foldhash::fast::FixedState;
use glam::DVec3;

/// Cubes along the longest side of what both sets fill.
const CUBES: f64 = 30.0;

/// What part of the points of one set is in cubes with points of the other, in mixed sets: of the one that is more so,
const MIXED: f64 = 0.4;

/// and of the other, which may be mostly a trunk.
const SOMEWHAT: f64 = 0.15;

/// Fewer points show nothing.
const LEAST: usize = 50;

/// Whether two sets of points are mixed.
pub(super) fn are_mixed(a: &[DVec3], b: &[DVec3]) -> bool {
    if a.len().min(b.len()) < LEAST {
        return false;
    }
    let longest = (0..3).map(|axis| span(a.iter().chain(b).map(|p| p[axis]))).fold(0.0, f64::max);
    if longest <= 0.0 {
        return false;
    }
    let cube = |p: &DVec3| (*p * (CUBES / longest)).floor().to_array().map(|x| x as i64);
    let cubes = |points: &[DVec3]| -> HashSet<[i64; 3], FixedState> {
        let mut cubes = HashSet::with_hasher(FixedState::default());
        cubes.extend(points.iter().map(cube));
        cubes
    };
    let share = |points: &[DVec3], others: &[DVec3]| {
        let others = cubes(others);
        points.iter().filter(|p| others.contains(&cube(p))).count() as f64 / points.len() as f64
    };
    let (of_a, of_b) = (share(a, b), share(b, a));
    of_a.max(of_b) >= MIXED && of_a.min(of_b) >= SOMEWHAT
}

/// From the lowest to the highest, one in a hundred aside at either end.
fn span(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.collect();
    values.sort_unstable_by(f64::total_cmp);
    let stray = values.len() / 100;
    values[values.len() - 1 - stray] - values[stray]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Key;

    /// A crown of radius 3 around a place, of so many points.
    fn crown(seed: u64, at: DVec3, count: u64) -> Vec<DVec3> {
        (0..count).map(|i| at + 3.0 * Key::new(seed).child(i).in_ball()).collect()
    }

    #[test]
    fn twigs_and_leaves_of_a_crown_are_mixed_and_neighbours_are_not() {
        let leaves = crown(1, 6.0 * DVec3::Z, 20_000);
        let trunk = (0..8000).map(|i| DVec3::new(0.1, 0.0, f64::from(i) * 6.0 / 8000.0));
        let wood: Vec<DVec3> = crown(2, 6.0 * DVec3::Z, 9000).into_iter().chain(trunk).collect();
        assert!(are_mixed(&wood, &leaves) && are_mixed(&leaves, &wood));
        // A tree whose crown grows into it, the ground, and too few to tell.
        let neighbour = crown(3, DVec3::new(4.8, 0.0, 6.0), 20_000);
        assert!(!are_mixed(&wood, &neighbour) && !are_mixed(&leaves, &neighbour));
        let ground: Vec<DVec3> =
            crown(4, DVec3::ZERO, 9000).into_iter().map(|p| p * DVec3::new(1.0, 1.0, 0.01)).collect();
        assert!(!are_mixed(&wood, &ground) && !are_mixed(&leaves[..40], &wood));
    }
}
