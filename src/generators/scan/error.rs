//! Why no tree grew into given points.

use linden_base::input::ThinError;
use linden_base::knob::printable;
use linden_base::memory::OverMemory;
use linden_base::monitor::Cancelled;
use linden_growth::{GrowthError, StandError};
use linden_skeleton::generator::GeneratorError;

use crate::ScanError;

/// Why no tree grew into given points.
#[derive(Clone, Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ScanGrowthError {
    /// The result was no longer wanted.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// There is no memory for what comes next.
    #[error(transparent)]
    Memory(#[from] OverMemory),
    /// The scan.
    #[error("preparing the points: {0}")]
    Scan(#[source] ScanError),
    /// Growth.
    #[error(transparent)]
    Stand(StandError),
    /// The tree that is asked for is not in the file.
    #[error("{0}")]
    Trees(String),
    /// The points were thinned while they were read, and other ones are wanted by now.
    #[error(
        "thin={wanted}: the points of {} were read with thin={read}, and the others are not there any more; open the \
         file again with --set thin={wanted}",
        printable(.file)
    )]
    Thinned {
        /// As the settings name it.
        file: String,
        /// The sides of the cubes that they were thinned to.
        read: f64,
        /// Those that are wanted; 0: all points.
        wanted: f64,
    },
    /// The file is missing or holds something else.
    #[error("the recipe grows into '{}', which must hold {expected}", printable(.file))]
    WrongInput {
        /// As the settings name it.
        file: String,
        /// What it must hold.
        expected: &'static str,
    },
}

linden_base::from_cancellable!(ScanGrowthError: ScanError => Scan, StandError => Stand);

impl From<ThinError> for ScanGrowthError {
    fn from(error: ThinError) -> Self {
        match error {
            ThinError::Memory(over) => over.into(),
            ThinError::Cancelled(cancelled) => cancelled.into(),
        }
    }
}

impl From<GrowthError> for ScanGrowthError {
    fn from(error: GrowthError) -> Self {
        StandError::from(error).into()
    }
}

impl From<ScanGrowthError> for GeneratorError {
    fn from(error: ScanGrowthError) -> Self {
        match error {
            ScanGrowthError::Cancelled(cancelled) => cancelled.into(),
            ScanGrowthError::Memory(over) | ScanGrowthError::Stand(StandError::Memory(over)) => over.into(),
            other => Self::failed(other),
        }
    }
}
