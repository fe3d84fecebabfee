//! Recipe and grown tree → scene.

use linden_base::monitor::{Holding, Monitor, Phase};
use linden_plant::foliage::{FoliageError, LeafShape, Organs};
use linden_plant::scene::Scene;
use linden_plant::season::Season;
use linden_plant::{detail, dress};

use crate::grow::{GrowError, Grown, grow};
use crate::recipe::Recipe;

pub use linden_plant::detail::{DetailError, Finest, Level, Levels, Year};
pub use linden_plant::dress::{DressError, thinnest_barks};

/// Gives a grown tree its surface, its foliage and its materials: all of it, one level, in the recipe's
/// season.
///
/// Budgets and levels of detail (`triangles`, `lods`, `billboard`) are left out: [`levels`] has them.
///
/// # Errors
/// [`DressError`]: too large, or cancelled.
pub fn dress(recipe: &Recipe, grown: &Grown, monitor: &dyn Monitor) -> Result<Scene, DressError> {
    let monitor = holding_points(grown, monitor);
    recipe.with_specimen_of(&grown.skeleton, |specimen| dress::dress(specimen, grown.body(), &monitor))
}

/// The levels of detail that a recipe asks for, the finest first, within its budgets; one where it asks for
/// none.
///
/// # Errors
/// [`DetailError`].
pub fn levels(recipe: &Recipe, grown: &Grown, monitor: &dyn Monitor) -> Result<Levels, DetailError> {
    let monitor = holding_points(grown, monitor);
    recipe.with_specimen_of(&grown.skeleton, |specimen| detail::levels(specimen, grown.body(), &monitor))
}

/// The same wood with the leaves of several seasons, each with the levels of [`levels`].
///
/// # Errors
/// [`DetailError`].
pub fn year(
    recipe: &Recipe,
    grown: &Grown,
    seasons: &[Season],
    monitor: &dyn Monitor,
) -> Result<Year, DetailError> {
    let monitor = holding_points(grown, monitor);
    recipe
        .with_specimen_of(&grown.skeleton, |specimen| detail::year(specimen, grown.body(), seasons, &monitor))
}

/// Wood and leaves of the finest level, without their meshes.
///
/// # Errors
/// [`DetailError`].
pub fn finest(recipe: &Recipe, grown: &Grown, monitor: &dyn Monitor) -> Result<Finest, DetailError> {
    detail::finest(&recipe.preset.dressing, grown.body(), &holding_points(grown, monitor))
}

/// A monitor for what is done while a grown tree is held: the points that it reached for are in memory too, and
/// what dresses its body knows nothing of them.
fn holding_points<'a>(grown: &Grown, monitor: &'a dyn Monitor) -> Holding<'a> {
    Holding::new(monitor, grown.bytes().saturating_sub(grown.body().bytes()))
}

/// Grows a tree, and draws meanwhile what does not depend on how it grows ([`dress::draw_ahead`]), where there is
/// memory for both.
///
/// # Errors
/// Those of growth; what could not be drawn is said by dressing.
pub fn grow_and_draw(recipe: &Recipe, monitor: &dyn Monitor) -> Result<Grown, GrowError> {
    if monitor.memory_limit() < 16 * AHEAD_BYTES {
        return grow(recipe, monitor);
    }
    let growing = Holding::new(monitor, AHEAD_BYTES);
    let ahead = || recipe.with_specimen(|specimen| dress::draw_ahead(specimen, &Unseen(monitor)));
    let (grown, _) = rayon::join(|| grow(recipe, &growing), ahead);
    grown
}

/// What may be drawn beside growth.
const AHEAD_BYTES: u64 = 64 << 20;

/// Work beside other work: cancelled with it and within its memory, but its progress is not shown.
struct Unseen<'a>(&'a dyn Monitor);

impl Monitor for Unseen<'_> {
    fn is_cancelled(&self) -> bool {
        self.0.is_cancelled()
    }

    fn advance(&self, _: Phase, _: u64, _: Option<u64>) {}

    fn memory_limit(&self) -> u64 {
        AHEAD_BYTES
    }
}

/// The shapes of leaves as they are dressed: they follow the pictures' outlines, which are finer than those
/// that the organs grew with ([`Organs::shapes`]).
///
/// # Errors
/// [`FoliageError`].
pub fn leaf_shapes(
    recipe: &Recipe,
    organs: &Organs,
    monitor: &dyn Monitor,
) -> Result<Vec<LeafShape>, FoliageError> {
    recipe.with_specimen(|specimen| dress::leaf_shapes(specimen, organs, monitor))
}
