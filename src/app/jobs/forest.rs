//! Grows the forest on screen.

use std::sync::Arc;

use linden::forest::{Forest, GrownForest, GrownForestError};
use linden::monitor::Monitor;
use linden_raster::{Extent, stage_extent};

use super::Watcher;
use super::painter::{MOST_BARK_PX, MOST_LEAF_PX};

/// Triangles of all trees in a picture together, and of one: no more are seen of one among many.
const MOST_TRIANGLES: u64 = 6_000_000;
const MOST_OF_A_TREE: u64 = 150_000;
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
        let mut grown = GrownForest::grow(&drawn, plan, monitor, &mut |_| ())?;
        for tree in &mut grown.trees {
            if let Some(finest) = tree.levels.levels.first_mut() {
                finest.coverage = 0.0;
            }
        }
        let extent = stage_extent(&grown.stage());
        Ok(Self { forest: Arc::clone(forest), trees, extent, grown })
    }
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
