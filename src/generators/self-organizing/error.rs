//! Why no tree grew.

use linden_base::memory::OverMemory;
use linden_base::monitor::Cancelled;
use linden_skeleton::generator::GeneratorError;

/// Within so many internodes of the origin trees may stand: about what single precision tells apart.
pub(crate) const FARTHEST: f32 = 100_000.0;

/// Why no tree grew.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
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

impl From<SelfOrganizingError> for GeneratorError {
    fn from(error: SelfOrganizingError) -> Self {
        match error {
            SelfOrganizingError::Cancelled(cancelled) => cancelled.into(),
            SelfOrganizingError::Memory(over) => over.into(),
            other => Self::failed(other),
        }
    }
}
