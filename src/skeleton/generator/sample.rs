//! Small trees from which the size of large ones follows.

use linden_base::input::Inputs;

use super::{GeneratorError, Settings};
use crate::Skeleton;

/// How large a sample may be.
#[derive(Clone, Copy, Debug)]
pub struct SampleSize {
    /// Attraction points, or points of a scan.
    pub points: usize,
    /// Nodes at which growth stops.
    pub nodes: u32,
    /// Symbols of a derived string.
    pub symbols: u64,
    /// How often refinement will halve all segments.
    pub halvings: u32,
}

/// Plans a sample, growing as often as it needs to.
pub trait Sampler {
    /// What to do next; `grown` is what the last [`SampleStep::Grow`] came to.
    ///
    /// # Errors
    /// As growing.
    fn next(&mut self, grown: Option<&Skeleton>) -> Result<SampleStep, GeneratorError>;
}

/// A step of a [`Sampler`].
pub enum SampleStep {
    /// Grow these.
    Grow {
        /// Smaller settings.
        settings: Box<dyn Settings>,
        /// What stands in place of some inputs.
        inputs: Inputs,
    },
    /// What grew last is the sample.
    Done(Multiple),
}

/// The tree as a multiple of its sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Multiple {
    /// Nodes of the tree ÷ nodes of the sample.
    pub wood_times: f64,
    /// Leaves of the tree ÷ leaves of the sample.
    pub leaf_times: f64,
    /// Points that the tree grows into ÷ those of the sample.
    pub point_times: f64,
    /// Tips of the tree on each of its stems ÷ tips of the sample.
    pub crowding: f64,
    /// Distances of the sample ÷ those of the tree.
    pub coarser: f64,
    /// How many times as much work the tree is, planning of the sample included; `None` where that goes with the
    /// largest of the first three.
    pub work_times: Option<f64>,
}

impl Multiple {
    /// Where the sample is the whole tree.
    pub const ONE: Self = Self {
        wood_times: 1.0,
        leaf_times: 1.0,
        point_times: 1.0,
        crowding: 1.0,
        coarser: 1.0,
        work_times: None,
    };
}

/// Grows the whole tree.
pub(super) struct Whole {
    settings: Option<Box<dyn Settings>>,
}

impl Whole {
    pub fn new(settings: Box<dyn Settings>) -> Self {
        Self { settings: Some(settings) }
    }
}

impl Sampler for Whole {
    fn next(&mut self, _: Option<&Skeleton>) -> Result<SampleStep, GeneratorError> {
        Ok(match self.settings.take() {
            Some(settings) => SampleStep::Grow { settings, inputs: Inputs::new() },
            None => SampleStep::Done(Multiple::ONE),
        })
    }
}
