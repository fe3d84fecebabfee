//! Grows the tree on screen.

use std::sync::{Arc, OnceLock};
use std::time::{Duration, Instant};

use glam::Vec3;
use linden::Skeleton;
use linden::foliage::{FoliageError, Organs};
use linden::grow::{
    Colonized, GrowError, Grown, Obstruction, grow, grow_as, obstructions, outline, reedit, sprout,
    whole_girth,
};
use linden::monitor::Holding;
use linden::recipe::Recipe;
use linden::skeleton::{Girth, Measures, SkeletonError};
use linden_raster::{Extent, Slice};

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
    /// The tree, and what stands beside it.
    beside: Extent,
    /// The tree, its attraction points, its crown and what stands beside it.
    wide: Extent,
    /// What the tree stands on, metres.
    ground_m: f32,
    /// The crown's outline; empty for what has no crown.
    pub outline: Arc<Vec<Vec<Vec3>>>,
    /// What stands in its way, and what takes light from it.
    pub obstructions: Arc<Vec<Obstruction>>,
    /// The last derivation or iteration.
    pub steps: u32,
    /// What younger trees of it are as thick as, once one was grown.
    girth: OnceLock<Option<Girth>>,
    /// How long it took to grow.
    pub took: Duration,
}

/// Grows trees, one after the other, and makes of the last one what another recipe has that differs in what is done to
/// the grown wood alone, or in what covers it.
#[derive(Default)]
pub struct Grower {
    last: Option<Arc<ShownTree>>,
}

impl Grower {
    /// Grows a recipe; `None` when it was cancelled.
    pub fn grow(
        &mut self,
        recipe: &Arc<Recipe>,
        watcher: &Watcher<'_>,
    ) -> Option<Result<Arc<ShownTree>, String>> {
        let last = self.last.take().filter(|last| grows_alike(&last.recipe, recipe));
        let grown = grown_from(last.as_deref(), recipe, watcher);
        self.last = grown.as_ref().ok().map(Arc::clone).or(last);
        match grown {
            Ok(shown) => Some(Ok(shown)),
            Err(GrowError::Cancelled(_)) => None,
            Err(error) => Some(Err(error.to_string())),
        }
    }
}

/// Whether two recipes grow the same wood, before that is edited and covered.
fn grows_alike(one: &Recipe, other: &Recipe) -> bool {
    let (a, b) = (&one.preset, &other.preset);
    let has_same_file = |file: &str| {
        let [one, other] = [one, other].map(|recipe| recipe.inputs.get(file).map(|input| input.hash));
        one.is_some() && one == other
    };
    (a.seed(), &a.generator, &a.refinement, a.wood) == (b.seed(), &b.generator, &b.refinement, b.wood)
        && a.generator.inputs().into_iter().all(has_same_file)
}

/// Grows a recipe by itself.
#[cfg(test)]
pub fn grow_shown(recipe: &Arc<Recipe>, watcher: &Watcher<'_>) -> Option<Result<Arc<ShownTree>, String>> {
    Grower::default().grow(recipe, watcher)
}

/// Grows a recipe, from the wood of `last` where there is such.
fn grown_from(
    last: Option<&ShownTree>,
    recipe: &Arc<Recipe>,
    watcher: &Watcher<'_>,
) -> Result<Arc<ShownTree>, GrowError> {
    let started = Instant::now();
    let grown = match last {
        Some(last) => reedit(&last.grown, recipe, watcher)?,
        None => grow(recipe, watcher)?,
    };
    let took = last.map_or_else(|| started.elapsed(), |last| last.took);
    let points = grown.colonized.as_ref().map_or(&[][..], Colonized::seen);
    let (outline, obstructions) = match last {
        Some(last) => (Arc::clone(&last.outline), Arc::clone(&last.obstructions)),
        None => (Arc::new(outline(recipe, watcher)?), Arc::new(obstructions(recipe, watcher)?)),
    };
    let skeleton = &grown.skeleton;
    let given = points.iter().chain(outline.iter().flatten()).copied();
    let narrow = Plant::from(&grown).extent().ok_or(SkeletonError::Empty)?;
    let near: Vec<Vec3> = narrow.in_reach(&obstructions).collect();
    let with = |more: &mut dyn Iterator<Item = Vec3>| {
        let around: Vec<Vec3> = more.chain(near.iter().copied()).chain(grown.organs.hull()).collect();
        Extent::of(skeleton, &around).unwrap_or(narrow)
    };
    let (beside, wide) = (with(&mut std::iter::empty()), with(&mut given.into_iter()));
    Ok(Arc::new(ShownTree {
        recipe: Arc::clone(recipe),
        measures: skeleton.measures(),
        narrow,
        beside,
        wide,
        ground_m: skeleton.positions.iter().map(|p| p.y).fold(f32::INFINITY, f32::min),
        outline,
        obstructions,
        steps: skeleton.births.iter().copied().max().unwrap_or(0),
        grown,
        girth: OnceLock::new(),
        took,
    }))
}

/// A tree as it was at a step of its growth: at an iteration of colonization, or at one of its generator's steps
/// (a derivation, a year), to which it is grown again (nothing is kept from one to the next). `None`
/// while nothing is drawn; `Err(None)` when it was cancelled.
pub fn stage(shown: &ShownTree, step: u32, watcher: &Watcher<'_>) -> Result<Option<Plant>, Option<String>> {
    let mut recipe = (*shown.recipe).clone();
    // The whole tree stays while a younger one is shown.
    let holding = Holding::new(watcher, shown.grown.bytes());
    let Some(derived) = recipe.preset.generator.at_step(step) else {
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
    let girth = || match shown.girth.get() {
        Some(known) => Ok(*known),
        None => {
            let found = whole_girth(&recipe, &holding)?;
            Ok(*shown.girth.get_or_init(|| found))
        }
    };
    match grow_as(&recipe, &girth, &holding) {
        Ok(grown) => Ok(Some(Plant::from(&grown))),
        Err(GrowError::Cancelled(_)) => Err(None),
        Err(GrowError::Skeleton(SkeletonError::Empty)) => Ok(None),
        Err(error) => Err(Some(error.to_string())),
    }
}

/// What a picture of a tree frames.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Framed {
    /// The tree.
    Tree,
    /// The tree, and what stands beside it.
    Beside,
    /// Those, its attraction points and its crown.
    All,
}

/// From the lower side of a slice to the upper one, metres: enough for a sparse scan, and a trunk hardly tapers along it.
const SLICE_M: f32 = 0.1;

impl ShownTree {
    /// What pictures frame: the tree; with what stands beside it and what it grew in when that is shown; with a
    /// person when one is to stand there and the plant is large enough.
    pub fn extent(&self, frame: Framed, person: bool) -> Extent {
        let extent = match frame {
            Framed::Tree => self.narrow,
            Framed::Beside => self.beside,
            Framed::All => self.wide,
        };
        if person { extent.with_person(self.ground_m) } else { extent }
    }

    /// Its slice at a height above its foot, metres.
    pub fn slice(&self, height_m: f32) -> Slice {
        Slice { height_m: self.ground_m + height_m, thickness_m: SLICE_M }
    }

    /// How high above its foot a slice is, metres.
    pub fn above_foot(&self, slice: Slice) -> f32 {
        slice.height_m - self.ground_m
    }

    /// The yaw that shows a flat tree (the plane systems of ABOP) from its broad side.
    pub fn broad_side_deg(&self) -> f32 {
        crate::viewpoint::broad_side(&self.grown.skeleton)
    }
}

#[cfg(test)]
mod tests {
    use linden::preset::{Preset, builtin};

    use super::*;

    fn grown(grower: &mut Grower, recipe: &Arc<Recipe>) -> Arc<ShownTree> {
        grower.grow(recipe, &Watcher::idle()).unwrap().unwrap()
    }

    #[test]
    fn an_edit_or_another_leaf_grows_no_new_wood_and_gives_the_tree_that_growing_gives() {
        let first = Arc::new(builtin("oak").unwrap().recipe(&linden::Quiet).unwrap());
        let with = |change: &dyn Fn(&mut Preset)| {
            let mut preset = first.preset.clone();
            change(&mut preset);
            Arc::new(first.with_preset(preset))
        };
        let edited = with(&|preset| preset.edit("cut stem/3 0.5").unwrap());
        let leafier = with(&|preset| preset.set("leaf_length", "0.2").unwrap());
        let reseeded = with(&|preset| preset.set_seed(preset.seed() + 1));
        let mut grower = Grower::default();
        let wood = Arc::clone(&grown(&mut grower, &first).grown.as_grown.skeleton);
        for (recipe, is_same_wood) in [(&edited, true), (&leafier, true), (&reseeded, false), (&first, false)]
        {
            let shown = grown(&mut grower, recipe);
            let anew = grow(recipe, &linden::Quiet).unwrap();
            assert_eq!(shown.grown.hash(), anew.hash());
            assert_eq!(shown.grown.notes, anew.notes);
            assert_eq!(Arc::ptr_eq(&shown.grown.as_grown.skeleton, &wood), is_same_wood);
            assert!(Arc::ptr_eq(&shown.recipe, recipe));
        }
    }
}
