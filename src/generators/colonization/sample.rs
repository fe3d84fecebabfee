//! Samples of crowns: fewer points in the same crown.

use linden_base::input::Inputs;
use linden_base::knob::Length;
use linden_base::monitor::Monitor;
use linden_growth::sample::{Lengthening, trunk_share};
use linden_growth::site::KILL_STEPS;
use linden_skeleton::Skeleton;
use linden_skeleton::generator::{GeneratorError, Multiple, SampleSize, SampleStep, Sampler, Task};

use crate::Colonization;
use crate::ColonizationError;
use crate::standing::Standing;

/// Points that a sample has for each part of the crown.
const POINTS_PER_PART: usize = 100;

pub(crate) struct Smaller {
    settings: Colonization,
    lengthening: Lengthening,
    /// The sample's points ÷ those that make the tree larger.
    share: f64,
    coarser: f64,
    point_times: f64,
}

impl Smaller {
    pub fn new(
        settings: &Colonization,
        task: &Task<'_>,
        size: SampleSize,
        monitor: &dyn Monitor,
    ) -> Result<Self, GeneratorError> {
        let points = settings.points as usize;
        // Each stem of a grove has its crown; refinement may multiply nodes.
        let most = size.points.max(settings.parts.len() * POINTS_PER_PART) >> size.halvings.min(4);
        // Points that are far nearer to each other than a node reaches are reached together: more make no
        // larger tree.
        let saturation = saturation(settings, task, monitor)?;
        let counting = saturation.min(points as f64).max((most as f64).min(points as f64));
        let share = (most as f64 / counting).min(1.0);
        let mut smaller = settings.clone();
        let mut coarser = 1.0;
        smaller.growth.max_nodes = settings.growth.max_nodes.min(size.nodes);
        if points > most {
            smaller.points = most as u32;
            // With fewer points, a step that follows from their distance is what it would have been.
            coarser = libm::cbrt(1.0 / share);
        }
        if coarser > 1.0 {
            smaller.growth = smaller.growth.coarser(coarser);
        }
        Ok(Self {
            settings: smaller,
            lengthening: Lengthening::new(settings.growth.max_nodes, 1.0),
            share,
            coarser,
            point_times: (points as f64 / most as f64).max(1.0),
        })
    }

    fn grow(&self) -> SampleStep {
        SampleStep::Grow { settings: Box::new(self.settings.clone()), inputs: Inputs::new() }
    }
}

impl Sampler for Smaller {
    fn next(&mut self, grown: Option<&Skeleton>) -> Result<SampleStep, GeneratorError> {
        let Some(grown) = grown else { return Ok(self.grow()) };
        if self.lengthening.again(&mut self.settings.growth, grown) {
            return Ok(self.grow());
        }
        let trunk = trunk_share(grown);
        let per_node = (1.0 - trunk) / self.share + trunk * self.coarser;
        let wood_times = self.lengthening.longer * per_node;
        let within = self.lengthening.within(wood_times, grown);
        Ok(SampleStep::Done(Multiple {
            wood_times: within,
            leaf_times: per_node * (within / wood_times.max(1.0)),
            point_times: self.point_times,
            crowding: 1.0 / self.share,
            coarser: self.coarser,
            ..Multiple::ONE
        }))
    }
}

/// How many points of a crown there must be for a tree as large as any number would make: with a node's
/// reach, the kill distance, they lie at half of it. Infinite where the step follows from the points.
fn saturation(
    settings: &Colonization,
    task: &Task<'_>,
    monitor: &dyn Monitor,
) -> Result<f64, ColonizationError> {
    let kill_m = match (settings.growth.kill, settings.growth.step_m) {
        (Length::Metres(kill_m), _) => kill_m,
        (Length::Steps(steps), Some(step_m)) => steps * step_m,
        (Length::Auto, Some(step_m)) => KILL_STEPS * step_m,
        (_, None) => return Ok(f64::INFINITY),
    };
    let standing = Standing::new(settings, task.seed, task.inputs, monitor)?;
    let apart_m = 0.5 * kill_m;
    Ok(standing.crown.volume_m3() / (apart_m * apart_m * apart_m))
}
