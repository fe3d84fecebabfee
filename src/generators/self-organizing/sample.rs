//! A stand as a multiple of some of its trees.

use linden_base::input::Inputs;
use linden_skeleton::Skeleton;
use linden_skeleton::generator::{GeneratorError, Multiple, SampleStep, Sampler};

use crate::{Neighbour, SelfOrganizing};

/// Trees of a sample: one with neighbours all about it, where the first of a stand are near each other.
const TREES: usize = 9;

/// Grows the first trees of a stand, or all of a small one. They have no neighbours outside, and get somewhat larger
/// than those of the whole stand.
pub(crate) struct FirstTrees {
    settings: Option<SelfOrganizing>,
    times: f64,
}

impl FirstTrees {
    pub fn new(settings: &SelfOrganizing) -> Self {
        let years = settings.years_grown();
        let standing = |stand: &[Neighbour]| 1 + stand.iter().filter(|tree| tree.stands_after(years)).count();
        let stand: Vec<Neighbour> = settings.stand.iter().copied().take(TREES - 1).collect();
        let times = standing(&settings.stand) as f64 / standing(&stand) as f64;
        Self { settings: Some(SelfOrganizing { stand, ..settings.clone() }), times }
    }
}

impl Sampler for FirstTrees {
    fn next(&mut self, _: Option<&Skeleton>) -> Result<SampleStep, GeneratorError> {
        Ok(match self.settings.take() {
            Some(settings) => SampleStep::Grow { settings: Box::new(settings), inputs: Inputs::new() },
            None => {
                let (wood_times, leaf_times) = (self.times, self.times);
                SampleStep::Done(Multiple { wood_times, leaf_times, ..Multiple::ONE })
            }
        })
    }
}
