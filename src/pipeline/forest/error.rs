//! Why there is no forest.

use linden_base::memory::OverMemory;
use linden_base::monitor::Cancelled;

use super::{LayoutError, MOST_PLACES};

/// Why there is no plan of a forest.
#[derive(Clone, Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ForestError {
    /// The result was no longer wanted.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// The grid of the ground.
    #[error(transparent)]
    Memory(#[from] OverMemory),
    /// No kind of trees.
    #[error("a forest needs at least one kind of trees")]
    Empty,
    /// A setting out of its knob's range.
    #[error("laying out the forest: {0}")]
    Layout(#[from] LayoutError),
    /// A share or size that is none.
    #[error("the share and the size of '{kind}' must be above 0, not {share} and {size}")]
    Kind {
        /// Its preset.
        kind: String,
        /// As it was given.
        share: f64,
        /// As it was given.
        size: f64,
    },
    /// There is no room for all.
    #[error(
        "the forest does not fit: {asked} trees at least {spacing_m} m apart on {area_m} m × {area_m} m, \
         where {fitting} find room; take a larger area, a smaller spacing or fewer trees"
    )]
    Room {
        /// How many were asked for.
        asked: u64,
        /// How many would fit.
        fitting: u64,
        /// Metres.
        spacing_m: f64,
        /// Metres.
        area_m: f64,
    },
    /// Not even two trees have room.
    #[error(
        "the forest does not fit: no two trees stand {spacing_m} m apart on {area_m} m × {area_m} m; take a \
         larger area or a smaller spacing, or trees=1"
    )]
    Alone {
        /// Metres.
        spacing_m: f64,
        /// Metres.
        area_m: f64,
    },
    /// Trees that compete are of one kind: they grow by the same rules.
    #[error("{kinds} kinds of trees do not compete: with compete, name one")]
    Mixed {
        /// How many there are.
        kinds: usize,
    },
    /// A kind that grows by itself alone.
    #[error(
        "'{kind}' does not compete: {why}; take a tree that fills a crown, like 'fir', or that grows by light, \
         like 'oak', or leave out compete"
    )]
    Loner {
        /// Its preset.
        kind: String,
        /// What keeps it from competing.
        why: Loner,
    },
    /// More trees than grow in one growth.
    #[error(
        "{stems} trees are more than the {most} that compete at most; take a smaller area or a larger spacing, or trees={most}"
    )]
    TooManyStems {
        /// How many there would be.
        stems: u64,
        /// The limit.
        most: u64,
    },
    /// Two trees with nothing that tells where they stand.
    #[error(
        "'{first}' and '{second}' would stand at the same place: give one a root, or let 'linden forest' lay them out"
    )]
    SamePlace {
        /// Its preset.
        first: String,
        /// Its preset.
        second: String,
    },
    /// Too many trees.
    #[error(
        "about {about} trees {spacing_m} m apart on {area_m} m × {area_m} m are more than {MOST_PLACES}; take \
         a smaller area or a larger spacing"
    )]
    TooMany {
        /// How many there would be, about.
        about: u64,
        /// Metres.
        spacing_m: f64,
        /// Metres.
        area_m: f64,
    },
}

/// Why a kind of trees does not compete.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Loner {
    /// It grows by rewriting.
    #[error("it grows by an L-system, which knows of no space")]
    LSystem,
    /// It is drawn by its parameters.
    #[error("it grows by Weber and Penn's parameters, which know of no space")]
    Drawn,
    /// It fills what somebody else has drawn or measured.
    #[error("it grows in a mesh or a scan, which stands where its file has it")]
    Given,
    /// It has several stems already, or parts that stand where their file has them.
    #[error("its crown is put together of trees or of meshes without a place")]
    Parts,
    /// It is a stand already.
    #[error("it is several trees already, by its [[self-organizing.tree]]")]
    Stand,
}
