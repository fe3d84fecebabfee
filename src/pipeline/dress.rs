//! Recipe and grown tree → scene.

use linden_base::monitor::{Holding, Monitor};
use linden_plant::foliage::{FoliageError, LeafShape, Organs};
use linden_plant::scene::Scene;
use linden_plant::season::Season;
use linden_plant::{detail, dress};

use crate::grow::Grown;
use crate::recipe::Recipe;

pub use linden_plant::detail::{DetailError, Finest, Level, Levels, Year};
pub use linden_plant::dress::DressError;

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
