//! A forest as it is planned: its distinct trees, and where they stand.

use linden_plant::Wanted;
use linden_plant::stage::Place;

use crate::recipe::Recipe;

/// The trees to grow, and the places where they will stand.
#[derive(Clone, Debug)]
pub struct Plan {
    /// The distinct trees, kind by kind.
    pub trees: Vec<PlannedTree>,
    /// Where they stand; `plant` is an index into `trees`.
    pub places: Vec<Place>,
}

impl Plan {
    /// The same trees, dressed only as far as files or pictures hold them: see [`Recipe::wanting`].
    #[must_use]
    pub fn wanting(mut self, wanted: Wanted) -> Self {
        for tree in &mut self.trees {
            tree.recipe = tree.recipe.clone().wanting(wanted);
        }
        self
    }
}

/// A distinct tree.
#[derive(Clone, Debug)]
pub struct PlannedTree {
    /// Unique in the forest: `Fir 2`.
    pub name: String,
    /// Index into [`Forest::kinds`](super::Forest::kinds).
    pub kind: usize,
    /// What grows, with the seed of this tree.
    pub recipe: Recipe,
    /// How many stems it has: more than one where trees compete.
    pub stems: u64,
    /// What the user should know about how it was planned.
    pub notes: Vec<String>,
}
