//! Grows the tree on screen.

use std::sync::Arc;
use std::time::{Duration, Instant};

use glam::Vec3;
use linden::Skeleton;
use linden::foliage::{FoliageError, Organs};
use linden::grow::{GrowError, Grown, grow, outline, sprout};
use linden::monitor::Holding;
use linden::recipe::Recipe;
use linden::skeleton::{Measures, SkeletonError};
use linden_raster::{Extent, RasterError};

use super::Watcher;

/// A tree's wood and what grows on it.
#[derive(Clone, Debug)]
pub struct Plant {
    /// The wood.
    pub skeleton: Arc<Skeleton>,
    /// Leaves and the like.
    pub organs: Arc<Organs>,
    /// What a grammar placed of them.
    pub given: Arc<Organs>,
}

impl Plant {
    /// What pictures frame; `None` when there is nothing.
    pub fn extent(&self) -> Option<Extent> {
        let hull: Vec<Vec3> = self.organs.hull().collect();
        Extent::of(&self.skeleton, &hull)
    }
}

impl From<&Grown> for Plant {
    fn from(grown: &Grown) -> Self {
        Self {
            skeleton: Arc::clone(&grown.skeleton),
            organs: Arc::clone(&grown.organs),
            given: Arc::clone(&grown.given),
        }
    }
}

/// A tree that grew, and what is known of it.
#[derive(Debug)]
pub struct ShownTree {
    /// What it grew from.
    pub recipe: Arc<Recipe>,
    /// The tree.
    pub grown: Grown,
    /// What a forester would measure.
    pub measures: Measures,
    /// What pictures frame: the tree.
    narrow: Extent,
    /// The tree, its attraction points and its crown.
    wide: Extent,
    /// What the tree stands on, metres.
    ground_m: f32,
    /// The crown's outline; empty for what has no crown.
    pub outline: Vec<Vec<Vec3>>,
    /// The last derivation or iteration.
    pub steps: u32,
    /// How long it took to grow.
    pub took: Duration,
}

/// Grows a recipe; `None` when it was cancelled.
pub fn grow_shown(recipe: &Arc<Recipe>, watcher: &Watcher<'_>) -> Option<Result<Arc<ShownTree>, String>> {
    let started = Instant::now();
    let grown = match grow(recipe, watcher) {
        Ok(grown) => grown,
        Err(GrowError::Cancelled(_)) => return None,
        Err(error) => return Some(Err(error.to_string())),
    };
    let took = started.elapsed();
    let points = grown.colonized.as_ref().map_or(&[][..], |colonized| &colonized.points);
    let outline = match outline(recipe, watcher) {
        Ok(outline) => outline,
        Err(GrowError::Cancelled(_)) => return None,
        // The tree grew in it a moment ago.
        Err(error) => return Some(Err(error.to_string())),
    };
    let skeleton = &grown.skeleton;
    let given = points.iter().chain(outline.iter().flatten()).copied();
    let around: Vec<Vec3> = given.chain(grown.organs.hull()).collect();
    let (Some(narrow), Some(wide)) = (Plant::from(&grown).extent(), Extent::of(skeleton, &around)) else {
        return Some(Err(RasterError::Empty.to_string()));
    };
    Some(Ok(Arc::new(ShownTree {
        recipe: Arc::clone(recipe),
        measures: skeleton.measures(),
        narrow,
        wide,
        ground_m: skeleton.positions.iter().map(|p| p.y).fold(f32::INFINITY, f32::min),
        outline,
        steps: skeleton.births.iter().copied().max().unwrap_or(0),
        grown,
        took,
    })))
}

/// A tree as it was at a step of its growth: at an iteration of colonization, or at a derivation,
/// for which the L-system is derived again (its symbols are not kept from one to the next). `None`
/// while nothing is drawn; `Err(None)` when it was cancelled.
pub fn stage(shown: &ShownTree, step: u32, watcher: &Watcher<'_>) -> Result<Option<Plant>, Option<String>> {
    let mut recipe = (*shown.recipe).clone();
    // The whole tree stays while a younger one is shown.
    let holding = Holding::new(watcher, shown.grown.bytes());
    let Some(derived) = recipe.preset.generator.derived(step) else {
        let organs_bytes = shown.grown.bytes() - shown.grown.skeleton.bytes();
        let beside = Holding::new(watcher, organs_bytes);
        shown.grown.admit_until(&beside).map_err(|over| Some(over.to_string()))?;
        let young = shown.grown.until(step, recipe.preset.wood_key());
        if young.positions.is_empty() {
            return Ok(None);
        }
        let holding = Holding::new(&holding, young.bytes());
        let organs = match sprout(&recipe, &young, &Arc::default(), &holding) {
            Ok(organs) => organs,
            Err(FoliageError::Cancelled(_)) => return Err(None),
            Err(error) => return Err(Some(error.to_string())),
        };
        return Ok(Some(Plant { skeleton: Arc::new(young), organs, given: Arc::default() }));
    };
    recipe.preset.generator = derived;
    match grow(&recipe, &holding) {
        Ok(grown) => Ok(Some(Plant::from(&grown))),
        Err(GrowError::Cancelled(_)) => Err(None),
        Err(GrowError::Skeleton(SkeletonError::Empty)) => Ok(None),
        Err(error) => Err(Some(error.to_string())),
    }
}

impl ShownTree {
    /// What pictures frame: the tree; with what it grew in when that is shown; with a person when
    /// one is to stand there and the plant is large enough.
    pub fn extent(&self, wide: bool, person: bool) -> Extent {
        let extent = if wide { self.wide } else { self.narrow };
        if person { extent.with_person(self.ground_m) } else { extent }
    }

    /// The yaw that shows a flat tree (the plane systems of ABOP) from its broad side.
    pub fn broad_side_deg(&self) -> f32 {
        crate::viewpoint::broad_side(&self.grown.skeleton)
    }
}
