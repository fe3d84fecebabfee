//! A tree as it grew → as it is shown: its wood edited, and as young as it is to be.

use std::sync::Arc;

use linden_base::memory::OverMemory;
use linden_base::monitor::{Holding, Monitor};
use linden_plant::foliage::Organs;
use linden_skeleton::edit::{Edited, Origins, Remark, edit};
use linden_skeleton::{NO_PARENT, Skeleton, Wood};

use super::{AsGrown, GrowError};
use crate::preset::Preset;

/// What becomes of a tree as it grew.
pub(super) struct Shaped {
    pub skeleton: Arc<Skeleton>,
    pub given: Arc<Organs>,
    pub origins: Option<Arc<Origins>>,
    pub remarks: Vec<Remark>,
}

/// Edits the wood, and then makes the tree as young as it is to be shown.
pub(super) fn shape(
    as_grown: &AsGrown,
    wood: &Wood,
    preset: &Preset,
    monitor: &dyn Monitor,
) -> Result<Shaped, GrowError> {
    let AsGrown { skeleton: grown, given, age, most_nodes } = as_grown;
    let mut shaped =
        Shaped { skeleton: Arc::clone(grown), given: Arc::clone(given), origins: None, remarks: Vec::new() };
    if !preset.edits.is_empty() {
        let Edited { skeleton, organs, origins, remarks } =
            edit(grown, given, &preset.edits, *most_nodes, monitor)?;
        shaped.remarks = remarks;
        shaped.skeleton = Arc::new(skeleton);
        shaped.given = Arc::new(organs);
        shaped.origins = Some(Arc::new(origins));
    }
    let Some(age) = *age else { return Ok(shaped) };
    let held = shaped.origins.as_ref().map_or(0, |origins| origins.bytes());
    admit_until((&shaped.skeleton, grown), wood, &Holding::new(monitor, held))?;
    let (step, key) = (step_of(grown, age), preset.wood_key());
    let (young, origins) = match &shaped.origins {
        Some(origins) => origins.until((&shaped.skeleton, grown), step, wood, key),
        None => {
            let young = grown.until(step, wood, key);
            let origins = Origins::of_young(grown, &young, step);
            (young, origins)
        }
    };
    shaped.skeleton = Arc::new(young);
    shaped.origins = Some(Arc::new(origins));
    Ok(shaped)
}

/// Asks for the memory of a tree that was edited and as it grew, and of a younger one.
pub(super) fn admit_until(
    (skeleton, grown): (&Skeleton, &Skeleton),
    wood: &Wood,
    monitor: &dyn Monitor,
) -> Result<(), OverMemory> {
    if skeleton.marks.is_empty() {
        return skeleton.admit_until(wood, monitor);
    }
    // Both trees young, and where their nodes are from.
    grown.admit_until(wood, &Holding::new(monitor, 3 * skeleton.bytes()))
}

/// The step after a share of a tree's births, at which it has its first segment at least.
fn step_of(skeleton: &Skeleton, age: f64) -> u32 {
    let last = skeleton.births.iter().copied().max().unwrap_or(0);
    let on_foot = |&node: &usize| {
        let parent = skeleton.parents[node];
        parent != NO_PARENT && skeleton.parents[parent as usize] == NO_PARENT
    };
    let first = (0..skeleton.parents.len()).filter(on_foot).map(|node| skeleton.births[node]).min();
    (libm::ceil(age * f64::from(last)) as u32).max(first.unwrap_or(0))
}
