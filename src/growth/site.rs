//! Attraction points and a root, ready to grow, and where they lie in the input's coordinates.

use std::sync::Arc;

use glam::DVec3;
use linden_base::knob::Length;
use linden_base::random::Key;
use rayon::prelude::*;

use crate::{GrowthRule, GrowthSettings, Meet};

/// Steps between neighbouring points where no step is given.
const STEPS_PER_SPACING: f64 = 3.0;
/// Kill distance where none is given: about the points' spacing.
pub const KILL_STEPS: f64 = 3.0;
/// Influence where none is given: the upper end of the range that RLP07 shows (8D to 17D).
pub const INFLUENCE_STEPS: f64 = 17.0;
/// Influence beyond this costs far more time than it changes.
const WIDE_INFLUENCE_STEPS: f64 = 20.0;
/// Height of a crown's base, in crown heights, where neither base nor trunk is given.
const BASE_PER_CROWN_HEIGHT: f64 = 0.25;

/// Height of a crown's base above the root.
pub fn crown_base_m(trunk_m: Option<f64>, crown_height_m: f64) -> f64 {
    trunk_m.unwrap_or(BASE_PER_CROWN_HEIGHT * crown_height_m)
}

/// Something that says what is inside it.
pub trait Inside: Send + Sync {
    /// Whether a place is inside.
    fn holds(&self, p: DVec3) -> bool;
}

/// Points and root in coordinates near the origin, where `f32` is precise.
pub struct Site {
    /// The attraction points.
    pub points: Vec<DVec3>,
    /// Bytes of what is held beside the points while the tree grows.
    pub held_bytes: u64,
    /// Where the first tree stands.
    pub root: DVec3,
    /// Other trees and obstacles there.
    pub grove: Grove,
    /// Where these coordinates have their origin in the input's (turned to Y up).
    pub origin: DVec3,
    /// Settings that suit these points where the user gives none.
    pub suggested: Suggested,
    /// Whether the tree is moved to stand on the origin unless the user says otherwise.
    pub moves_to_root: bool,
    /// Messages for the user.
    pub notes: Vec<String>,
}

/// Other trees and obstacles beside the first tree, in the coordinates of the [`Site`].
#[derive(Default)]
pub struct Grove {
    /// The first tree's crown, where others compete with it; `None`: all points are for the first tree.
    pub first: Option<Arc<dyn Inside>>,
    /// The other trees.
    pub others: Vec<Stem>,
    /// Obstacles, which branches do not enter.
    pub obstacles: Vec<Barrier>,
}

/// Another tree.
pub struct Stem {
    /// Where it stands.
    pub root: DVec3,
    /// Height of the bare trunk, metres; `None`: until the first point of its crown is in reach.
    pub trunk_m: Option<f64>,
    /// The crown that its trunk leads to; `None`: any point.
    pub crown: Option<Arc<dyn Inside>>,
}

/// A solid that branches do not enter.
#[derive(Clone)]
pub struct Barrier {
    /// The solid.
    pub solid: Arc<dyn Inside>,
    /// How a branch goes on there.
    pub meet: Meet,
}

/// What suits some points.
pub struct Suggested {
    /// Length of a segment, metres.
    pub step_m: f64,
    /// The kill distance.
    pub kill: Length,
    /// The influence distance.
    pub influence: Length,
    /// Height of the first tree's bare trunk, metres; `None`: until the first point is in reach.
    pub trunk_m: Option<f64>,
}

impl Suggested {
    /// For points that fill a volume.
    pub fn for_volume(spacing_m: f64) -> Self {
        Self {
            step_m: spacing_m / STEPS_PER_SPACING,
            kill: Length::Steps(KILL_STEPS),
            influence: Length::Steps(INFLUENCE_STEPS),
            trunk_m: None,
        }
    }
}

impl Site {
    /// The rule in metres, and what to say about it.
    pub(crate) fn rule(&self, settings: &GrowthSettings) -> (GrowthRule, Vec<String>) {
        let step = settings.step_m.unwrap_or(self.suggested.step_m);
        let metres = |length: Length, suggested: Length| match (length, suggested) {
            (Length::Metres(x), _) | (Length::Auto, Length::Metres(x)) => x,
            (Length::Steps(x), _) | (Length::Auto, Length::Steps(x)) => x * step,
            (Length::Auto, Length::Auto) => step,
        };
        let kill = metres(settings.kill, self.suggested.kill);
        let influence = metres(settings.influence, self.suggested.influence);
        let mut notes = Vec::new();
        if influence > WIDE_INFLUENCE_STEPS * step
            && settings.influence != Length::Auto
            && self.points.len() >= 100_000
        {
            notes.push("influence is beyond 20 steps, which costs much time and changes little".to_owned());
        }
        let rule = GrowthRule {
            step: step as f32,
            influence: influence as f32,
            kill: kill as f32,
            tropism: DVec3::from_array(settings.tropism).as_vec3(),
            max_iterations: settings.max_iterations,
            max_nodes: settings.max_nodes,
            habit: settings.habit(),
        };
        (rule, notes)
    }
}

/// Moves each point by at most `amplitude_m`, uniformly in a ball; point `i` by `key.child(i)`.
///
/// Exact symmetry (a lattice, a mirrored model) makes pulls cancel and growth stall; a
/// thousandth of the points' spacing is enough against that and cannot be seen.
pub fn jitter(points: &mut [DVec3], amplitude_m: f64, key: Key) {
    points.par_iter_mut().enumerate().for_each(|(i, point)| {
        *point += amplitude_m * key.child(i as u64).in_ball();
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn jitter_moves_every_point_a_little_and_breaks_symmetry() {
        let lattice: Vec<DVec3> = (0..1000).map(|i| DVec3::new(f64::from(i), 2.0, 3.0)).collect();
        let mut moved = lattice.clone();
        jitter(&mut moved, 1e-3, Key::new(4));
        let far = lattice.iter().zip(&moved).map(|(a, b)| a.distance(*b)).fold(0.0, f64::max);
        assert!(far < 1e-3 && far > 0.9e-3, "{far}");
        let mean: DVec3 = lattice.iter().zip(&moved).map(|(a, b)| *b - *a).sum::<DVec3>() / 1000.0;
        // The standard deviation of a coordinate in a unit ball is √(1/5), of the mean of 1000 √(1/5000).
        assert!(mean.length() < 5.0 * 1e-3 / 5000.0_f64.sqrt(), "{mean}");
        assert!(moved.iter().zip(&lattice).all(|(a, b)| a != b));
    }
}
