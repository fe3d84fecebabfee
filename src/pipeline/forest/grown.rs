//! A forest whose trees have grown.

use linden_base::monitor::{Holding, Monitor};
use linden_plant::Wanted;
use linden_plant::detail::{DetailError, Levels};
use linden_plant::scene::Wrap;
use linden_plant::stage::{Level, Place, Plant, Stage};

use super::{Forest, ForestError, Plan, PlannedTree, budgeted};
use crate::dress::levels;
use crate::grow::{GrowError, grow};

/// A forest, each distinct tree grown and dressed once.
#[derive(Debug)]
pub struct GrownForest {
    /// Its name for people.
    pub name: String,
    /// Enough to make it again, one line of printable ASCII (JSON).
    pub recipe: String,
    /// The distinct trees.
    pub trees: Vec<GrownTree>,
    /// Where they stand; `plant` is an index into `trees`.
    pub places: Vec<Place>,
}

/// A distinct tree of a forest.
#[derive(Debug)]
pub struct GrownTree {
    /// Unique in the forest: `Fir 2`.
    pub name: String,
    /// How it looks; [`Levels::notes`] tells of that.
    pub levels: Levels,
    /// What the user should know about its growth.
    pub notes: Vec<String>,
}

impl GrownTree {
    /// All that the user should know about it, with its name where it is about this tree alone.
    pub fn said(&self) -> impl Iterator<Item = String> {
        let about = self.notes.iter().map(|note| format!("{}: {note}", self.name));
        about.chain(self.levels.notes.iter().cloned())
    }
}

/// Why a forest did not grow.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum GrownForestError {
    /// It cannot be laid out.
    #[error(transparent)]
    Plan(#[from] ForestError),
    /// A tree did not grow.
    #[error("{tree}: {error}")]
    Grow {
        /// Which one.
        tree: String,
        /// Why.
        #[source]
        error: GrowError,
    },
    /// A tree could not be dressed.
    #[error("{tree}: {error}")]
    Dress {
        /// Which one.
        tree: String,
        /// Why.
        #[source]
        error: DetailError,
    },
}

impl GrownForestError {
    /// Whether the result was no longer wanted.
    pub fn is_cancelled(&self) -> bool {
        matches!(
            self,
            Self::Plan(ForestError::Cancelled(_))
                | Self::Grow { error: GrowError::Cancelled(_), .. }
                | Self::Dress { error: DetailError::Cancelled(_), .. }
        )
    }
}

impl GrownForest {
    /// Grows the trees of a plan, each in its levels of detail; `tell` sees each as soon as it
    /// is there.
    ///
    /// # Errors
    /// [`GrownForestError`], which names the tree.
    pub fn grow(
        forest: &Forest,
        plan: Plan,
        monitor: &dyn Monitor,
        tell: &mut dyn FnMut(&GrownTree),
    ) -> Result<Self, GrownForestError> {
        let mut trees: Vec<GrownTree> = Vec::with_capacity(plan.trees.len());
        let mut held = inputs_bytes(&plan.trees);
        // The recipe of a tree that stands alone tells of its budget, whatever is made of it.
        let is_single = plan.trees.len() == 1 && plan.places.len() == 1;
        for (index, tree) in plan.trees.iter().enumerate() {
            monitor.among("tree", index + 1, plan.trees.len());
            let holding = Holding::new(monitor, held);
            let failed = |error| GrownForestError::Dress { tree: tree.name.clone(), error };
            let wood = grow(&tree.recipe, &holding)
                .map_err(|error| GrownForestError::Grow { tree: tree.name.clone(), error })?;
            let triangles = forest.layout.triangles * tree.stems;
            let has_budget = is_single || tree.recipe.wanted() != Wanted::SKELETON;
            let triangles = if has_budget { triangles } else { 0 };
            let recipe = budgeted(&tree.recipe, &wood, triangles, &holding).map_err(failed)?;
            let mut dressed = levels(&recipe, &wood, &holding).map_err(failed)?;
            let first = plan.trees.iter().position(|first| first.kind == tree.kind);
            if let Some(first) = first.and_then(|first| trees.get(first)) {
                share_tiles(&first.levels, &mut dressed);
            }
            held += bytes(&dressed);
            let notes = tree.notes.iter().cloned().chain(wood.notes).collect();
            let grown = GrownTree { name: tree.name.clone(), levels: dressed, notes };
            tell(&grown);
            trees.push(grown);
        }
        monitor.among("tree", 1, 1);
        Ok(Self { name: forest.name.clone(), recipe: forest.to_line(), trees, places: plan.places })
    }

    /// Bytes of its scenes.
    pub fn bytes(&self) -> u64 {
        self.trees.iter().map(|tree| bytes(&tree.levels)).sum()
    }

    /// What exporters take.
    pub fn stage(&self) -> Stage<'_> {
        let plants = self.trees.iter().map(|tree| {
            let levels = tree.levels.levels.iter();
            let levels = levels.map(|level| Level { scene: &level.scene, coverage: level.coverage });
            Plant::in_levels(tree.name.clone(), levels.collect())
        });
        Stage {
            name: self.name.clone(),
            recipe: self.recipe.clone(),
            plants: plants.collect(),
            places: self.places.clone(),
            setting: None,
            turned: Vec::new(),
        }
    }
}

/// Bytes of the meshes, scans and pictures that trees grow from.
fn inputs_bytes(trees: &[PlannedTree]) -> u64 {
    trees.iter().map(|tree| tree.recipe.inputs.bytes()).sum()
}

fn bytes(levels: &Levels) -> u64 {
    levels.levels.iter().map(|level| level.scene.bytes()).sum()
}

/// Trees of a kind have the same bark: the pictures that tile, which fit any tree.
fn share_tiles(first: &Levels, other: &mut Levels) {
    let Some(first) = first.levels.first() else { return };
    for material in other.levels.iter_mut().flat_map(|level| &mut level.scene.materials) {
        let same = first.scene.materials.iter().find(|first| first.name == material.name);
        if let Some(same) = same.filter(|first| first.wrap == Wrap::Repeat && material.wrap == first.wrap) {
            material.base_color_picture.clone_from(&same.base_color_picture);
            material.normal_picture.clone_from(&same.normal_picture);
        }
    }
}
