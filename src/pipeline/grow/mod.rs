//! Recipe → skeleton: the one way through all generators.

mod build;
mod error;
mod grown;
mod notes;
mod shape;
#[cfg(test)]
mod tests;

use std::sync::Arc;

use linden_base::monitor::{Cancelled, Holding, Monitor};
use linden_plant::foliage::{self, FoliageError, Organs};
use linden_skeleton::generator::Measured;
use linden_skeleton::{Girth, Skeleton};

use self::build::{Built, build};
use self::grown::bytes_beside;
use self::notes::{MESH_NOTE, far_note, mesh_notes, stout_note, unregistered_note};
use self::shape::{Shaped, shape};
use crate::preset::Preset;
use crate::recipe::Recipe;

pub use self::error::GrowError;
pub use self::grown::{AsGrown, Grown};
pub use linden_skeleton::generator::{Colonized, Fit, Gaps, Obstruction, Obstructs, Scanned, Spread};

/// Grows the tree of a recipe.
///
/// ```
/// use linden_pipeline::{Quiet, grow::grow, preset::builtin, recipe::Recipe};
/// let grown = grow(&Recipe::new(builtin("abop-a")?.load()?), &Quiet)?;
/// assert_eq!(grown.skeleton.segments(), 3125); // ABOP, Fig. 1.24 a
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`GrowError`]: limits, contradictions, nothing in reach, cancelled.
pub fn grow(recipe: &Recipe, monitor: &dyn Monitor) -> Result<Grown, GrowError> {
    let girth = || whole_girth(recipe, monitor);
    grow_as(recipe, &girth, monitor)
}

/// What the thickness of a recipe's whole tree goes by, where the recipe is of a younger one whose thickness follows from
/// that: the whole one is grown to find it out.
///
/// # Errors
/// As [`grow`].
pub fn whole_girth(recipe: &Recipe, monitor: &dyn Monitor) -> Result<Option<Girth>, GrowError> {
    let Preset { generator, wood, .. } = &recipe.preset;
    let Some(whole) = generator.whole().filter(|_| wood.base_radius_m.is_some()) else { return Ok(None) };
    let monitor: &dyn Monitor = &Holding::new(monitor, recipe.inputs.bytes());
    Ok(Some(Girth::of(&whole.grow(&recipe.task(), monitor)?.branching)))
}

/// The same as [`grow`] for who knows [`whole_girth`] already, of this recipe or of the same tree at another age.
///
/// # Errors
/// As [`grow`], and those of `girth`.
pub fn grow_as(
    recipe: &Recipe,
    girth: &dyn Fn() -> Result<Option<Girth>, GrowError>,
    monitor: &dyn Monitor,
) -> Result<Grown, GrowError> {
    recipe.check_inputs()?;
    let Preset { generator, wood, .. } = &recipe.preset;
    if let (Some(base_m), Some(tip_m)) = (wood.base_radius_m, wood.tip_radius_m)
        && base_m < tip_m
    {
        return Err(GrowError::Radii { base_m, tip_m });
    }
    let monitor: &dyn Monitor = &Holding::new(monitor, recipe.inputs.bytes());
    let whole = if generator.whole().is_some() { girth()? } else { None };
    let mut branched = generator.grow(&recipe.task(), monitor)?;
    let wood = whole.map_or(*wood, |whole| wood.when_young(&whole, &Girth::of(&branched.branching)));
    let colonized = branched.colonized.take();
    let is_canopy = colonized.as_ref().is_some_and(|colonized| colonized.is_canopy);
    let measured = branched.measured.as_ref().map_or(0, |measured| measured.bytes());
    let held = branched.organs.bytes() + measured + colonized.as_ref().map_or(0, Colonized::bytes);
    let monitor: &dyn Monitor = &Holding::new(monitor, held);
    if let Some(measured) = &branched.measured {
        measured.admit(&branched.branching, monitor)?;
    }
    let Built { mut skeleton, wood, organs, measured_nodes } =
        build(&mut branched, &recipe.preset, &wood, is_canopy, monitor)?;
    let scan = match branched.measured.take() {
        Some(measured) => scanned(measured, Arc::make_mut(&mut skeleton), measured_nodes, monitor)?,
        None => None,
    };
    branched.notes.extend(scan.as_ref().and_then(|scan| far_note(&skeleton, &scan.fit)));
    branched.notes.extend(stout_note(&skeleton).filter(|_| scan.is_some()));
    let as_grown =
        AsGrown { skeleton, given: Arc::new(organs), age: branched.age, most_nodes: branched.most_nodes };
    let Shaped { skeleton, given, origins, remarks } = shape(&as_grown, &wood, &recipe.preset, monitor)?;
    let beside = bytes_beside(&as_grown, &skeleton, &given, origins.as_deref());
    let monitor = Holding::new(monitor, skeleton.bytes() + beside);
    let mut notes = branched.notes;
    notes.extend(remarks.iter().map(ToString::to_string));
    notes.extend(mesh_notes(recipe));
    notes.extend(unregistered_note(&recipe.preset));
    Ok(Grown {
        organs: sprout(recipe, &skeleton, &given, &monitor)?,
        given,
        skeleton,
        as_grown,
        origins,
        remarks,
        wood,
        symbols: branched.symbols,
        colonized: colonized.map(|colonized| Colonized { scan, ..colonized }),
        foot: branched.foot,
        notes,
    })
}

/// How a tree compares with what it was measured by, if that has points; its radii learn how far they are from these.
fn scanned(
    measured: Box<dyn Measured>,
    skeleton: &mut Skeleton,
    measured_nodes: usize,
    monitor: &dyn Monitor,
) -> Result<Option<Scanned>, Cancelled> {
    let Some(Gaps { fit, of_points_m, of_nodes_m }) = measured.gaps(skeleton, monitor)? else {
        return Ok(None);
    };
    for (fit, gap_m) in skeleton.fits.iter_mut().zip(of_nodes_m) {
        fit.gap_m = gap_m;
    }
    let leaf_points = measured.leaf_points();
    let (points, gaps_m) = (Arc::new(measured.into_points()), Arc::new(of_points_m));
    Ok(Some(Scanned { points, gaps_m, leaf_points, measured_nodes, fit }))
}

/// The tree of a recipe that differs in its edits and in what covers the wood alone from the one that `grown` grew
/// from: the same as of [`grow`], without growing it again.
///
/// ```
/// use linden_pipeline::{Quiet, grow::{grow, reedit}, preset::builtin, recipe::Recipe};
/// let mut fir = builtin("fir")?.load()?;
/// let grown = grow(&Recipe::new(fir.clone()), &Quiet)?;
/// fir.edit("cut stem 0.5")?;
/// let recipe = Recipe::new(fir);
/// assert_eq!(reedit(&grown, &recipe, &Quiet)?.hash(), grow(&recipe, &Quiet)?.hash());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// As [`grow`], as far as it has to do with edits and leaves.
pub fn reedit(grown: &Grown, recipe: &Recipe, monitor: &dyn Monitor) -> Result<Grown, GrowError> {
    recipe.check_inputs()?;
    let as_grown = grown.as_grown.clone();
    let held = recipe.inputs.bytes() + grown.bytes();
    let monitor = Holding::new(monitor, held);
    let Shaped { skeleton, given, origins, remarks } =
        shape(&as_grown, &grown.wood, &recipe.preset, &monitor)?;
    let before: Vec<String> = grown.remarks.iter().map(ToString::to_string).collect();
    let of_growth = grown.notes.iter().filter(|note| !before.contains(note) && !note.starts_with(MESH_NOTE));
    let notes = of_growth.cloned().chain(remarks.iter().map(ToString::to_string)).chain(mesh_notes(recipe));
    let notes = notes.collect();
    let monitor = Holding::new(&monitor, skeleton.bytes());
    Ok(Grown {
        organs: sprout(recipe, &skeleton, &given, &monitor)?,
        given,
        skeleton,
        as_grown,
        origins,
        remarks,
        wood: grown.wood,
        symbols: grown.symbols,
        colonized: grown.colonized.clone(),
        foot: grown.foot,
        notes,
    })
}

/// Everything that grows on a skeleton: what its generator placed, and the leaves of the recipe.
///
/// # Errors
/// [`FoliageError`]: files that are missing, too many leaves, too little memory, or cancelled.
pub fn sprout(
    recipe: &Recipe,
    skeleton: &Skeleton,
    given: &Arc<Organs>,
    monitor: &dyn Monitor,
) -> Result<Arc<Organs>, FoliageError> {
    recipe.with_specimen(|specimen| foliage::sprout(specimen, skeleton, given, monitor))
}

/// Polylines that draw what a recipe's tree grows in, metres, where the tree of [`grow`] stands: its crown,
/// obstacles, and, dashed, what is subtracted or shaded. None for what grows in nothing.
///
/// ```
/// use linden_pipeline::{Quiet, grow::outline, preset::builtin, recipe::Recipe};
/// assert!(!outline(&Recipe::new(builtin("cypress")?.load()?), &Quiet)?.is_empty());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// Those of growing that have to do with the crown: its dimensions, its mesh; cancelled.
pub fn outline(recipe: &Recipe, monitor: &dyn Monitor) -> Result<Vec<Vec<glam::Vec3>>, GrowError> {
    Ok(recipe.preset.generator.outline(&recipe.task(), monitor)?)
}

/// What stands in the way of a recipe's tree and what takes light from it, where the tree of [`grow`] stands. None
/// for what grows by itself.
///
/// ```
/// use linden_pipeline::{Quiet, grow::{Obstructs, obstructions}, preset::builtin};
/// let stone = &obstructions(&builtin("around-the-stone")?.recipe(&Quiet)?, &Quiet)?[0];
/// assert!(stone.effect == Obstructs::Branches && !stone.triangles.is_empty());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// As [`outline`].
pub fn obstructions(recipe: &Recipe, monitor: &dyn Monitor) -> Result<Vec<Obstruction>, GrowError> {
    Ok(recipe.preset.generator.obstructions(&recipe.task(), monitor)?)
}
