//! What a picture shows.

use std::sync::Arc;

use linden_raster::Extent;

use super::{DerivedWord, Framed, ShownForest, ShownTree};

/// What a picture shows.
#[derive(Clone, Debug)]
pub enum Subject {
    /// A tree.
    Tree(Arc<ShownTree>),
    /// Many, at their places.
    Forest(Arc<ShownForest>),
    /// What the turtle draws for a word.
    Word(Arc<DerivedWord>),
}

impl Subject {
    /// Whether it is the same grown thing.
    pub fn is(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Tree(a), Self::Tree(b)) => Arc::ptr_eq(a, b),
            (Self::Forest(a), Self::Forest(b)) => Arc::ptr_eq(a, b),
            (Self::Word(a), Self::Word(b)) => Arc::ptr_eq(a, b),
            _ => false,
        }
    }

    /// What pictures frame that show all of it; `None` when there is nothing.
    pub fn extent(&self) -> Option<Extent> {
        match self {
            Self::Tree(shown) => Some(shown.extent(Framed::All, false)),
            Self::Forest(shown) => shown.extent,
            Self::Word(word) => word.extent,
        }
    }

    /// The tree, where it is one.
    pub fn tree(&self) -> Option<&Arc<ShownTree>> {
        match self {
            Self::Tree(shown) => Some(shown),
            Self::Forest(_) | Self::Word(_) => None,
        }
    }
}
