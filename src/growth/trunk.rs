//! The bare trunk that carries the crown.

use glam::DVec3;

use linden_base::monitor::{Cancelled, Monitor};
use linden_skeleton::{Branching, NO_PARENT};

/// Points that are looked at between two looks at the monitor: about a millisecond.
const POINTS_PER_CHECK: usize = 1 << 20;

/// A stem from `root`, straight up for `height_m`, in segments of at most `step_m`.
pub fn straight(root: DVec3, height_m: f64, step_m: f64) -> Branching {
    let segments = (height_m / step_m - 1e-6).ceil().max(0.0) as usize;
    let mut trunk = Stem::new(root);
    for i in 1..=segments {
        trunk.push(root + DVec3::Y * (height_m * i as f64 / segments as f64));
    }
    trunk.branching
}

/// A stem from `root` in steps until one of the points is within `reach_m`: straight up as long as
/// that leads nearer, then straight to the nearest point. Ends at `most_nodes` in any case.
///
/// # Errors
/// [`Cancelled`]: a far root in short steps takes steps times points.
pub fn until_in_reach(
    root: DVec3,
    points: &[DVec3],
    reach_m: f64,
    step_m: f64,
    most_nodes: usize,
    monitor: &dyn Monitor,
) -> Result<Branching, Cancelled> {
    let mut trunk = Stem::new(root);
    let mut at = root;
    let mut looked_at = 0;
    while let Some((distance, nearest)) = nearest(points, at) {
        looked_at += points.len();
        if looked_at >= POINTS_PER_CHECK {
            looked_at = 0;
            monitor.check()?;
        }
        // A hair inside, so that rounding to f32 does not take it out of reach again.
        if distance <= reach_m * 0.999 || trunk.branching.positions.len() >= most_nodes {
            break;
        }
        let up = at + DVec3::Y * step_m;
        let leads_nearer = nearest.y - at.y > 0.5 * distance;
        at = if leads_nearer { up } else { at + (nearest - at) * (step_m / distance).min(1.0) };
        trunk.push(at);
    }
    Ok(trunk.branching)
}

/// Distance and place of the point nearest to `at`.
fn nearest(points: &[DVec3], at: DVec3) -> Option<(f64, DVec3)> {
    let nearest = points.iter().min_by(|a, b| a.distance_squared(at).total_cmp(&b.distance_squared(at)))?;
    Some((nearest.distance(at), *nearest))
}

struct Stem {
    branching: Branching,
}

impl Stem {
    fn new(root: DVec3) -> Self {
        Self {
            branching: Branching {
                positions: vec![root.as_vec3()],
                parents: vec![NO_PARENT],
                births: vec![0],
                radii: None,
                edges: None,
            },
        }
    }

    fn push(&mut self, at: DVec3) {
        self.branching.parents.push(self.branching.positions.len() as u32 - 1);
        self.branching.positions.push(at.as_vec3());
        self.branching.births.push(0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use linden_base::monitor::{Phase, Quiet};

    #[test]
    fn a_given_height_is_met_exactly_in_equal_steps() {
        let trunk = straight(DVec3::new(1.0, 2.0, 3.0), 1.0, 0.3);
        let heights: Vec<f32> = trunk.positions.iter().map(|p| p.y).collect();
        assert_eq!(heights, [2.0, 2.25, 2.5, 2.75, 3.0]);
        assert_eq!(straight(DVec3::ZERO, 0.0, 0.3).positions.len(), 1);
        assert_eq!(straight(DVec3::ZERO, 0.6, 0.2).positions.len(), 4, "no sliver from rounding");
    }

    #[test]
    fn the_trunk_ends_where_the_first_point_is_in_reach() {
        for (points, reach) in [
            (vec![DVec3::new(0.5, 6.0, 0.0), DVec3::new(0.0, 9.0, 0.0)], 1.0),
            (vec![DVec3::new(8.0, 1.0, 0.0)], 0.5),
            (vec![DVec3::new(3.0, -4.0, 2.0)], 0.5),
        ] {
            let trunk = until_in_reach(DVec3::ZERO, &points, reach, 0.1, 1000, &Quiet).unwrap();
            let distance =
                |p: &glam::Vec3| points.iter().map(|q| p.as_dvec3().distance(*q)).fold(f64::MAX, f64::min);
            let (last, before) = trunk.positions.split_last().unwrap();
            assert!(distance(last) <= reach, "in reach at the end");
            assert!(before.iter().all(|p| distance(p) > reach * 0.99), "and not before");
        }
    }

    #[test]
    fn a_long_way_to_the_crown_can_be_cancelled() {
        struct Unwanted;
        impl Monitor for Unwanted {
            fn is_cancelled(&self) -> bool {
                true
            }
            fn advance(&self, _: Phase, _: u64, _: Option<u64>) {}
        }
        let far = vec![DVec3::Y * 1e8; 1000];
        assert_eq!(until_in_reach(DVec3::ZERO, &far, 1.0, 0.1, usize::MAX, &Unwanted), Err(Cancelled));
    }
}
