//! Samples of large growths: fewer points, farther apart, in longer steps.

use linden_base::knob::Length;
use linden_skeleton::{NO_PARENT, Skeleton};

use crate::GrowthSettings;
use crate::site::{INFLUENCE_STEPS, KILL_STEPS};

/// How much longer steps become that are too short for a sample.
const LENGTHENING: f64 = 4.0;
/// How often.
const LENGTHENINGS: usize = 6;

impl GrowthSettings {
    /// Settings for points that are `times` times as far apart: growth is similar at any scale.
    #[must_use]
    pub fn coarser(&self, times: f64) -> Self {
        let metres = |length: Length| match length {
            Length::Metres(x) => Length::Metres(x * times),
            other => other,
        };
        Self {
            step_m: self.step_m.map(|step| step * times),
            kill: metres(self.kill),
            influence: metres(self.influence),
            gravity: self.gravity / times,
            max_iterations: ((f64::from(self.max_iterations) / times) as u32).max(1),
            wave_interval: (f64::from(self.wave_interval) / times).ceil() as u32,
            ..self.clone()
        }
    }
}

/// Lengthens steps until a sample is not cut short.
pub struct Lengthening {
    /// The limit of nodes of the whole.
    max_nodes: u32,
    rounds: usize,
    /// How many times as long steps are as those of the tree.
    pub longer: f64,
}

impl Lengthening {
    /// Lengthening for a tree with a limit of nodes, whose sample has steps `longer` times as long already.
    pub const fn new(max_nodes: u32, longer: f64) -> Self {
        Self { max_nodes, rounds: 0, longer }
    }

    /// Whether the sample is to be grown again, in longer steps: `settings` grew to `grown`.
    pub fn again(&mut self, settings: &mut GrowthSettings, grown: &Skeleton) -> bool {
        let is_cut =
            grown.positions.len() >= settings.max_nodes as usize && settings.max_nodes < self.max_nodes;
        let Some(step) = settings.step_m.filter(|_| is_cut && self.rounds < LENGTHENINGS) else {
            return false;
        };
        // The same wood in fewer, longer segments; points are reached and pull as before.
        let metres = |length: Length, steps: f64| match length {
            Length::Steps(x) => x * step,
            Length::Auto => steps * step,
            Length::Metres(x) => x,
        };
        let next = step * LENGTHENING;
        settings.kill = Length::Metres(metres(settings.kill, KILL_STEPS).max(next));
        settings.influence = Length::Metres(metres(settings.influence, INFLUENCE_STEPS).max(2.0 * next));
        settings.step_m = Some(next);
        self.longer *= LENGTHENING;
        self.rounds += 1;
        true
    }

    /// Nodes of the tree ÷ nodes of the sample within the tree's limit, where it would be `times` without.
    pub fn within(&self, times: f64, grown: &Skeleton) -> f64 {
        let nodes = grown.positions.len().max(1) as f64;
        (f64::from(self.max_nodes) / nodes).max(1.0).min(times.max(1.0))
    }
}

/// The share of nodes that were there before the first point was reached: they grow with a length.
pub fn trunk_share(skeleton: &Skeleton) -> f64 {
    let feet = skeleton.parents.iter().filter(|&&parent| parent == NO_PARENT).count();
    let trunk = skeleton.births.iter().filter(|&&birth| birth == 0).count().max(feet);
    trunk as f64 / skeleton.births.len().max(1) as f64
}
