//! Grows the forest on screen.

use std::sync::Arc;

use linden::Skeleton;
use linden::forest::{Forest, GrownForest, GrownForestError, Plan};
use linden::grow::{Obstruction, obstructions};
use linden::monitor::Monitor;
use linden_raster::{Extent, stage_extent};

use super::Watcher;
use super::painter::{MOST_BARK_PX, MOST_LEAF_PX};

/// Triangles of all trees in a picture together, and of one: no more are seen of one among many.
const MOST_TRIANGLES: u64 = 6_000_000;
const MOST_OF_A_TREE: u64 = 150_000;
/// Of all that stands in the way of trees: a hundred stones and more.
const MOST_BESIDE: usize = 200_000;
/// A tree of fewer has lost its twigs.
const LEAST_OF_A_TREE: u64 = 10_000;
/// Levels of detail of a tree in a picture: the coarser one is for drafts.
const LEVELS: u32 = 2;
/// From where forests are looked at: from a hill, so that those behind are seen as well.
pub const FOREST_PITCH_DEG: f32 = 22.0;
/// And from which side, degrees: along neither side of the square.
pub const FOREST_YAW_DEG: f32 = 30.0;

/// A forest that grew, and what is known of it.
#[derive(Debug)]
pub struct ShownForest {
    /// What it grew from.
    pub forest: Arc<Forest>,
    /// Its trees, as pictures show them.
    pub grown: GrownForest,
    /// How many trees stand there.
    pub trees: u64,
    /// What pictures frame; `None` when there is nothing.
    pub extent: Option<Extent>,
    /// What stands in the way of each tree, and what takes light from it, where the tree stands.
    pub obstructions: Vec<Obstruction>,
    /// What pictures frame that show these too.
    pub beside: Option<Extent>,
}

impl ShownForest {
    /// Grows a forest as pictures show it: bark and leaves no finer than a screen has them, in levels of detail.
    ///
    /// # Errors
    /// [`GrownForestError`].
    pub fn grow(forest: &Arc<Forest>, monitor: &dyn Monitor) -> Result<Self, GrownForestError> {
        let mut drawn = (**forest).clone();
        for kind in &mut drawn.kinds {
            let dressing = &mut kind.recipe.preset.dressing;
            dressing.bark.size_px = dressing.bark.size_px.min(MOST_BARK_PX);
            dressing.foliage.size_px = dressing.foliage.size_px.min(MOST_LEAF_PX);
            let detail = &mut dressing.detail;
            (detail.lods, detail.billboard) = (LEVELS, 0);
            detail.lod_triangles.clear();
        }
        let plan = drawn.plan(monitor)?;
        // Those that compete are one growth at one place.
        let stems = plan.places.iter().filter_map(|place| plan.trees.get(place.plant)).map(|tree| tree.stems);
        let trees: u64 = stems.sum();
        let most = (MOST_TRIANGLES / trees.max(1)).clamp(LEAST_OF_A_TREE, MOST_OF_A_TREE);
        let given = Some(drawn.layout.triangles).filter(|&triangles| triangles > 0);
        drawn.layout.triangles = given.map_or(most, |given| given.min(most));
        let obstructions = obstructions_of(&plan, monitor)?;
        let mut grown = GrownForest::grow(&drawn, plan, monitor, &mut |_| ())?;
        for tree in &mut grown.trees {
            if let Some(finest) = tree.levels.levels.first_mut() {
                finest.coverage = 0.0;
            }
        }
        let extent = stage_extent(&grown.stage());
        let beside = extent.and_then(|extent| {
            let mut all = grown.stage().outermost();
            all.extend(extent.in_reach(&obstructions));
            Extent::of(&Skeleton::default(), &all)
        });
        Ok(Self { forest: Arc::clone(forest), trees, extent, obstructions, beside, grown })
    }
}

/// What stands beside the trees of a plan, where they stand; no more of it than a picture shows.
fn obstructions_of(plan: &Plan, monitor: &dyn Monitor) -> Result<Vec<Obstruction>, GrownForestError> {
    let (mut all, mut drawn) = (Vec::new(), 0);
    for (plant, tree) in plan.trees.iter().enumerate() {
        if !tree.recipe.preset.has_obstructions() {
            continue;
        }
        let beside = obstructions(&tree.recipe, monitor)
            .map_err(|error| GrownForestError::Grow { tree: tree.name.clone(), error })?;
        let triangles: usize = beside.iter().map(|solid| solid.triangles.len()).sum();
        for place in plan.places.iter().filter(|place| place.plant == plant) {
            if (drawn + triangles) > MOST_BESIDE {
                break;
            }
            drawn += triangles;
            let motion = place.motion();
            all.extend(beside.iter().map(|solid| {
                let mut solid = solid.clone();
                if let Some(motion) = &motion {
                    for at in &mut solid.positions {
                        *at = motion.point(*at);
                    }
                }
                solid
            }));
        }
    }
    Ok(all)
}

/// Grows a forest for the screen; `None` when it was cancelled.
pub fn grow_shown_forest(
    forest: &Arc<Forest>,
    watcher: &Watcher<'_>,
) -> Option<Result<Arc<ShownForest>, String>> {
    match ShownForest::grow(forest, watcher) {
        Ok(shown) => Some(Ok(Arc::new(shown))),
        Err(error) if error.is_cancelled() => None,
        Err(error) => Some(Err(error.to_string())),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_stands_beside_a_tree_stands_beside_each_of_a_forest() {
        let mut recipe = linden::preset::builtin("around-the-stone").unwrap().recipe(&linden::Quiet).unwrap();
        recipe.preset.set("points", "300").unwrap();
        let mut forest = Forest::of(vec![recipe]);
        (forest.layout.area_m, forest.layout.spacing_m) = (22.0, 9.0);
        let shown = ShownForest::grow(&Arc::new(forest), &linden::Quiet).unwrap();
        let stage = shown.grown.stage();
        assert!(stage.places.len() > 1);
        assert_eq!(shown.obstructions.len(), stage.places.len());
        for place in stage.places {
            // The stone is 1.6 m from the foot of its tree, which may be larger or smaller in a forest.
            let is_near = |solid: &Obstruction| {
                let middle = solid.positions.iter().sum::<glam::Vec3>() / solid.positions.len() as f32;
                let away_m =
                    glam::Vec2::new(middle.x - place.position.x, middle.z - place.position.z).length();
                (away_m / place.scale - 1.58).abs() < 0.5
            };
            assert!(shown.obstructions.iter().any(is_near), "{place:?}");
        }
        assert!(shown.beside.unwrap().radius() >= shown.extent.unwrap().radius());
    }
}
