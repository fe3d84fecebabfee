//! Why no tree grew.

use linden_base::memory::OverMemory;
use linden_base::monitor::Cancelled;
use linden_crown::CrownError;
use linden_crown::envelope::EnvelopeError;
use linden_skeleton::generator::GeneratorError;

/// Within so many internodes of the origin trees may stand: about what single precision tells apart.
pub(crate) const FARTHEST: f64 = 100_000.0;

/// Why no tree grew.
#[derive(Clone, Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SelfOrganizingError {
    /// The result was no longer wanted.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// There is no memory for what comes next.
    #[error(transparent)]
    Memory(#[from] OverMemory),
    /// More nodes than the settings allow.
    #[error(
        "growing by light: in year {year} of {years} there would be {nodes} nodes, more than \
         max_nodes={limit}; lower years or vigor, raise shed or internode, or raise max_nodes"
    )]
    TooManyNodes {
        /// Which year, from 1.
        year: u32,
        /// [`SelfOrganizing::years`](crate::SelfOrganizing::years).
        years: u32,
        /// What stands, and what would be added.
        nodes: u64,
        /// [`SelfOrganizing::max_nodes`](crate::SelfOrganizing::max_nodes).
        limit: u32,
    },
    /// A foot that is not on the ground, or too far away for the grid of light.
    #[error(
        "growing by light: tree {number} is to stand at {x}, {y}, {z}; it needs y = 0, and x and z within \
         {FARTHEST} internodes of the origin"
    )]
    Foot {
        /// Of the tree, from 0.
        number: usize,
        /// Metres.
        x: f32,
        /// Metres.
        y: f32,
        /// Metres.
        z: f32,
    },
    /// An obstacle that cannot stand.
    #[error("placing obstacle {number} ({what}): {problem}")]
    Obstacle {
        /// Counted from 1, in the order of the document.
        number: usize,
        /// What it is, printable.
        what: String,
        /// Why, and what to do.
        #[source]
        problem: ObstacleError,
    },
    /// A foot in an obstacle.
    #[error("growing by light: tree {number} would stand in an obstacle, at {x}, {z}; move one of them")]
    FootInside {
        /// Of the tree, from 0.
        number: usize,
        /// Metres.
        x: f32,
        /// Metres.
        z: f32,
    },
    /// The seedlings stand in the dark.
    #[error(
        "growing by light: obstacles left no bud enough light to grow in {years} years; move them or make them \
         smaller"
    )]
    NoLight {
        /// [`SelfOrganizing::years`](crate::SelfOrganizing::years).
        years: u32,
    },
    /// The seedling never grew.
    #[error(
        "growing by light: no bud got enough to grow in {years} years; a bud grows from 1 on, and in full \
         light gets vigor={vigor}: raise vigor"
    )]
    NothingGrew {
        /// [`SelfOrganizing::years`](crate::SelfOrganizing::years).
        years: u32,
        /// [`SelfOrganizing::vigor`](crate::SelfOrganizing::vigor).
        vigor: f64,
    },
}

/// Why an obstacle cannot stand.
#[derive(Clone, Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ObstacleError {
    /// The result was no longer wanted.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// Its shape.
    #[error(transparent)]
    Crown(#[from] CrownError),
    /// Its mesh.
    #[error(transparent)]
    Envelope(EnvelopeError),
    /// Its file is missing or holds something else.
    #[error("the file must hold a mesh, OBJ or PLY")]
    NoMesh,
}

linden_base::from_cancellable!(ObstacleError: EnvelopeError => Envelope);

impl From<SelfOrganizingError> for GeneratorError {
    fn from(error: SelfOrganizingError) -> Self {
        match error {
            SelfOrganizingError::Cancelled(cancelled) => cancelled.into(),
            SelfOrganizingError::Memory(over) => over.into(),
            other => Self::failed(other),
        }
    }
}
