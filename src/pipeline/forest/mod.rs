//! Forests: several kinds of trees on a square of ground.
//!
//! A few trees of each kind are grown, and stand in many places, each turned and sized at random. They
//! know nothing of each other, unless they [compete](Layout::compete): then all are one growth.
//!
//! ```
//! use linden_pipeline::{Quiet, forest::Forest, preset::builtin, recipe::Recipe};
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let fir = Recipe::new(builtin("fir").unwrap().load()?);
//! let mut forest = Forest::of(vec![fir]);
//! forest.layout.set("area", "30")?;
//! forest.layout.set("spacing", "5")?;
//! let plan = forest.plan(&Quiet)?;
//! assert_eq!(plan.trees.len(), 3, "three distinct firs");
//! assert!(plan.places.len() > 15);
//! # Ok(())
//! # }
//! ```

mod compete;
mod document;
mod edit;
mod error;
mod grown;
mod layout;
mod library;
mod plan;
mod planned;
mod spacing;

use serde::ser::{Serialize, SerializeMap, Serializer};

use crate::grow::Grown;
use crate::provenance::document_hash;
use crate::recipe::{Hashes, Recipe, VERSION, ascii_line};
use linden_base::monitor::Monitor;
use linden_plant::detail::{DetailError, Simplifier};

pub use document::{ForestDocument, TreeLine, TreeSource};
pub use error::{ForestError, Loner};
pub use grown::{GrownForest, GrownForestError, GrownTree};
pub use layout::{FOREST_KNOBS, ForestKnob, Layout, LayoutError, Places, SCATTERING, counted};
pub use library::{BuiltinForest, builtin_forest, builtin_forests};
pub use plan::MOST_PLACES;
pub use planned::{Plan, PlannedTree};
pub use spacing::poisson_disc;

/// What `recipe` has for levels of detail where no tree of a forest is to have more than `triangles`: the
/// recipe's budget, if it has one; none for a tree that has no more anyway.
///
/// # Errors
/// [`DetailError`]: memory, or cancelled.
pub fn budgeted(
    recipe: &Recipe,
    grown: &Grown,
    triangles: u64,
    monitor: &dyn Monitor,
) -> Result<Recipe, DetailError> {
    let mut budgeted = recipe.clone();
    if triangles > 0
        && budgeted.preset.dressing.detail.finest() == 0
        && Simplifier::new(&budgeted.preset.dressing.tubes, grown.body(), monitor)?.full_triangles(monitor)?
            > triangles
    {
        budgeted.preset.dressing.detail.triangles = triangles;
    }
    Ok(budgeted)
}

/// Kinds of trees, and how they are laid out.
#[derive(Clone, Debug)]
pub struct Forest {
    /// Its name in commands and files.
    pub id: String,
    /// Its name for people.
    pub name: String,
    /// At least one.
    pub kinds: Vec<ForestKind>,
    /// How they stand.
    pub layout: Layout,
}

/// A kind of trees.
#[derive(Clone, Debug)]
pub struct ForestKind {
    /// The recipe of its trees; the seed is replaced, tree by tree.
    pub recipe: Recipe,
    /// Its part of the trees, by the sum of all shares; above 0.
    pub share: f64,
    /// How much larger it stands there than it grows.
    pub size: f64,
}

impl Forest {
    /// A forest of some kinds in equal shares, laid out by default.
    pub fn of(recipes: Vec<Recipe>) -> Self {
        let names: Vec<&str> = recipes.iter().map(|recipe| recipe.preset.id.as_str()).collect();
        let id = names.join("-") + "-forest";
        let kinds = recipes.into_iter().map(|recipe| ForestKind { recipe, share: 1.0, size: 1.0 }).collect();
        Self { name: id.clone(), id, kinds, layout: Layout::default() }
    }

    /// A 128-bit fingerprint of everything that decides the forest: as [`Recipe::hash`], of all its kinds and its
    /// layout.
    pub fn hash(&self) -> u128 {
        serde_json::to_string(&Content(self)).ok().and_then(|json| document_hash(&json)).unwrap_or_default()
    }

    /// One line of printable ASCII (JSON), with this version and the forest's hash: [`ForestDocument::parse`]
    /// reads it.
    pub fn to_line(&self) -> String {
        ascii_line(self)
    }
}

impl Serialize for Forest {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(None)?;
        map.serialize_entry("linden", VERSION)?;
        map.serialize_entry("hash", &Hashes { recipe: self.hash(), tree: None })?;
        self.serialize_into(&mut map)?;
        map.end()
    }
}

/// A forest alone.
struct Content<'a>(&'a Forest);

impl Serialize for Content<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(None)?;
        self.0.serialize_into(&mut map)?;
        map.end()
    }
}

impl Forest {
    fn serialize_into<M: SerializeMap>(&self, map: &mut M) -> Result<(), M::Error> {
        map.serialize_entry("name", &self.name)?;
        for (knob, value) in self.layout.knobs() {
            map.serialize_entry(knob.knob.name, &value.to_string())?;
        }
        map.serialize_entry("tree", &self.kinds)
    }
}

impl Serialize for ForestKind {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(None)?;
        map.serialize_entry("share", &self.share)?;
        map.serialize_entry("size", &self.size)?;
        map.serialize_entry("recipe", &self.recipe)?;
        map.end()
    }
}
