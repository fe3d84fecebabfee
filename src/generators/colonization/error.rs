//! Why no tree grew into a crown.

use linden_base::knob::printable;
use linden_base::memory::OverMemory;
use linden_base::monitor::Cancelled;
use linden_growth::{GrowthError, StandError};
use linden_skeleton::generator::GeneratorError;

use crate::PartError;
use crate::crown::CrownError;
use crate::crown::envelope::EnvelopeError;
use crate::scatter::ScatterError;

/// Why no tree grew into a crown.
#[derive(Clone, Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ColonizationError {
    /// The result was no longer wanted.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// There is no memory for what comes next.
    #[error(transparent)]
    Memory(#[from] OverMemory),
    /// The crown's shape.
    #[error("shaping the crown: {0}")]
    Crown(#[from] CrownError),
    /// A part of the crown.
    #[error("shaping the crown, part {number} ({what}): {problem}")]
    Part {
        /// Counted from 1, in the order of the document.
        number: usize,
        /// Its role and what it is, printable.
        what: String,
        /// Why, and what to do.
        #[source]
        problem: PartError,
    },
    /// Obstacles and shade take all points away.
    #[error(
        "all {points} attraction points lie in obstacles or shade; make these smaller, move them, or ask for \
         more points"
    )]
    NoRoom {
        /// How many were scattered.
        points: usize,
    },
    /// The crown's mesh.
    #[error("filling the envelope: {0}")]
    Envelope(#[source] EnvelopeError),
    /// The points.
    #[error(transparent)]
    Scatter(ScatterError),
    /// Growth.
    #[error(transparent)]
    Stand(StandError),
    /// A file is missing or holds something else.
    #[error("the recipe grows into '{}', which must hold {expected}", printable(.file))]
    WrongInput {
        /// As the settings name it.
        file: String,
        /// What it must hold.
        expected: &'static str,
    },
}

linden_base::from_cancellable!(
    ColonizationError: EnvelopeError => Envelope, ScatterError => Scatter, StandError => Stand
);

impl From<GrowthError> for ColonizationError {
    fn from(error: GrowthError) -> Self {
        StandError::from(error).into()
    }
}

impl From<ColonizationError> for GeneratorError {
    fn from(error: ColonizationError) -> Self {
        match error {
            ColonizationError::Cancelled(cancelled) => cancelled.into(),
            ColonizationError::Memory(over) | ColonizationError::Stand(StandError::Memory(over)) => {
                over.into()
            }
            other => Self::failed(other),
        }
    }
}
