//! Files of one plant at several ages, put together.

use linden_pipeline::scene::Bounds;

use super::WindLoop;

/// Files of one plant at several ages.
#[derive(Clone, Debug, PartialEq)]
pub struct AgeSet {
    /// For people. The first prim of each file is called by it.
    pub name: String,
    /// The recipe of the age that is seen first, one line; empty where it carries none.
    pub recipe: String,
    /// From the youngest on; the last is the one that is seen first.
    pub ages: Vec<AgeFile>,
}

/// A file of a plant at an age.
#[derive(Clone, Debug, PartialEq)]
pub struct AgeFile {
    /// Lower-case ASCII identifier: `young`.
    pub age: String,
    /// As the set names it: relative to its folder, with slashes, `./` before it.
    pub file: String,
    /// A box around all that the file holds, Y up.
    pub bounds: Option<Bounds>,
    /// How long it sways, if it does.
    pub wind: Option<WindLoop>,
}
