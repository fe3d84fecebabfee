//! Why no tree grew.

use linden_base::memory::OverMemory;
use linden_base::monitor::Cancelled;
use linden_skeleton::generator::GeneratorError;

/// Why no tree grew.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum WeberPennError {
    /// The result was no longer wanted.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// There is no memory for what comes next.
    #[error(transparent)]
    Memory(#[from] OverMemory),
    /// More nodes than the settings allow, as expected before anything grows.
    #[error(
        "growing by Weber and Penn: the tree would have about {expected:.0} nodes, more than max_nodes={limit}; \
         lower branches, seg_splits, curve_res or levels, or raise max_nodes"
    )]
    TooManyNodes {
        /// As the forecast has it.
        expected: f64,
        /// [`WeberPenn::max_nodes`](crate::WeberPenn::max_nodes).
        limit: u32,
    },
    /// More nodes than the settings allow, as it turned out.
    #[error(
        "growing by Weber and Penn: level {level} has more nodes than are left of max_nodes={limit}; lower \
         branches, seg_splits or curve_res, or raise max_nodes"
    )]
    GrewPastLimit {
        /// Which level of stems.
        level: u32,
        /// [`WeberPenn::max_nodes`](crate::WeberPenn::max_nodes).
        limit: u32,
    },
    /// Too many leaves.
    #[error(
        "growing by Weber and Penn: the tree would have about {expected:.0} leaves, more than {limit}; lower \
         leaves or branches"
    )]
    TooManyLeaves {
        /// As the forecast has it.
        expected: f64,
        /// The most.
        limit: u64,
    },
}

impl From<WeberPennError> for GeneratorError {
    fn from(error: WeberPennError) -> Self {
        match error {
            WeberPennError::Cancelled(cancelled) => cancelled.into(),
            WeberPennError::Memory(over) => over.into(),
            other => Self::failed(other),
        }
    }
}
