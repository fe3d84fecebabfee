//! From knobs and what suits the points to the rule of growth, in metres.

use glam::DVec3;

use super::site::Site;
use crate::colonization::growth::{Attraction, GrowthRule, Habit};
use crate::preset::{Colonization, Length, Pull};

/// Influence beyond this costs far more time than it changes.
const WIDE_INFLUENCE_STEPS: f64 = 20.0;

impl Site {
    /// The rule in metres, and what to say about it.
    pub(super) fn rule(&self, settings: &Colonization) -> (GrowthRule, Vec<String>) {
        let step = settings.step_m.unwrap_or(self.suggested.step);
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

impl Colonization {
    fn habit(&self) -> Habit {
        let by_order = |numbers: &[f64]| numbers.iter().map(|&x| x as f32).collect();
        Habit {
            attraction: match self.attraction {
                Pull::Nearest => Attraction::Nearest,
                Pull::All => Attraction::All,
            },
            gravitropism: by_order(&self.gravitropism),
            phototropism: by_order(&self.phototropism),
            light: DVec3::from_array(self.light).as_vec3(),
            gravity: self.gravity as f32,
            apical_control: self.apical_control as f32,
            max_children: if self.max_children == 0 { u32::MAX } else { self.max_children },
            waves: self.waves,
            wave_interval: self.wave_interval,
        }
    }
}
