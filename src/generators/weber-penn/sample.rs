//! Samples of large trees: all of the trunk and of the first levels, of one level every n-th stem alone.

use linden_base::input::Inputs;
use linden_skeleton::Skeleton;
use linden_skeleton::generator::{GeneratorError, Multiple, SampleSize, SampleStep, Sampler};

use crate::WeberPenn;
use crate::forecast::forecast;
use crate::settings::Thinned;

/// Leaves of a sample.
const LEAVES: f64 = 50_000.0;

pub(crate) struct Sparse {
    settings: Option<WeberPenn>,
    multiple: Multiple,
}

impl Sparse {
    pub fn new(settings: &WeberPenn, size: SampleSize) -> Self {
        let expected = forecast(settings);
        let most = f64::from(size.nodes >> size.halvings.min(12));
        let (nodes, leaves) = (expected.nodes(), expected.leaves());
        let mut sample = settings.clone();
        if nodes <= most && leaves <= LEAVES {
            return Self { settings: Some(sample), multiple: Multiple::ONE };
        }
        let before = |level: usize| expected.levels[..level].iter().map(|level| level.nodes).sum::<f64>();
        // As deep as it can be for the levels above it to be small.
        let last = settings.levels as usize - 1;
        let level = (1..=last).rev().find(|&level| before(level) <= 0.5 * most).unwrap_or(last.min(1));
        let (above, below) = (before(level), nodes - before(level));
        let wanted = (below / (most - above).max(1.0)).max(leaves / LEAVES);
        let every = libm::ceil(wanted).clamp(1.0, expected.levels[level].stems.max(1.0));
        sample.thinned = Thinned { level, every: every as usize };
        let wood_times = nodes / (above + below / every);
        let multiple = Multiple { wood_times, leaf_times: every, ..Multiple::ONE };
        Self { settings: Some(sample), multiple }
    }
}

impl Sampler for Sparse {
    fn next(&mut self, _: Option<&Skeleton>) -> Result<SampleStep, GeneratorError> {
        Ok(match self.settings.take() {
            Some(settings) => SampleStep::Grow { settings: Box::new(settings), inputs: Inputs::new() },
            None => SampleStep::Done(self.multiple),
        })
    }
}
