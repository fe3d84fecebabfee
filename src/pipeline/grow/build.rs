//! Branching → skeleton, the same for all generators.

use std::sync::Arc;

use linden_base::monitor::Monitor;
use linden_plant::foliage::Organs;
use linden_skeleton::generator::Branched;
use linden_skeleton::refine::{Room, refine};
use linden_skeleton::{AxisRule, RadiusFit, RadiusSource, Skeleton, Wood};

use super::GrowError;
use super::notes::trunk_note;
use crate::preset::Preset;

/// What becomes of what a generator leaves behind.
pub(super) struct Built {
    pub skeleton: Arc<Skeleton>,
    /// With its rule settled.
    pub wood: Wood,
    /// What the generator placed, where refinement took it.
    pub organs: Organs,
    /// Nodes whose radius was measured.
    pub measured_nodes: usize,
}

/// What all generators' branchings go through: refinement, which takes the organs along, then axes
/// and radii.
pub(super) fn build(
    branched: &mut Branched,
    preset: &Preset,
    wood: &Wood,
    is_canopy: bool,
    monitor: &dyn Monitor,
) -> Result<Built, GrowError> {
    let mut branching = std::mem::take(&mut branched.branching);
    let mut organs = std::mem::take(&mut branched.organs);
    if preset.wood.axes == AxisRule::Thickest {
        branching.edges = None;
    }
    if !preset.refinement.is_idle() {
        let is_barred = |p: glam::Vec3| branched.barred.as_ref().is_some_and(|barred| barred(p));
        let room = Room {
            most_nodes: branched.most_nodes,
            is_barred: &is_barred,
            key: preset.wood_key(),
            wood: *wood,
        };
        branching.validate()?;
        let used = branched.used.take();
        let mut riders = organs.riders();
        branching = refine(branching, used, &mut riders, &preset.refinement, room, monitor)?;
        organs.follow(&riders);
    }
    let found = match &branched.measured {
        Some(measured) => measured.measure(&mut branching, wood, monitor)?,
        None => None,
    };
    let is_measured = found.is_some();
    // A scan says of each radius where it is from, also where nobody measures it.
    let is_scan = branched.measured.is_some() || is_canopy;
    let guessed = || vec![RadiusFit::GUESSED; if is_scan { branching.positions.len() } else { 0 }];
    let fits = found.unwrap_or_else(guessed);
    branching.admit_build(wood, monitor)?;
    let wood = wood.settled(branching.radii.is_some(), branching.edges.is_some());
    let mut skeleton = Skeleton::build_keyed(branching, &wood, preset.wood_key())?;
    let measured_nodes = fits.iter().filter(|fit| fit.source == RadiusSource::Measured).count();
    skeleton.fits = fits;
    // No step of refinement takes a foot away, or puts it before another.
    skeleton.trees = std::mem::take(&mut branched.trees);
    branched.notes.extend(trunk_note(&skeleton).filter(|_| is_measured));
    let side = &preset.refinement.side;
    if !side.add_to(&mut skeleton, preset.wood_key().named("side"), branched.most_nodes, monitor)? {
        branched.notes.push(
            "epicormic, dead_twigs: some are left out, for the tree has as many nodes as it may; raise max_nodes or \
             symbol_limit"
                .to_owned(),
        );
    }
    Ok(Built { skeleton: Arc::new(skeleton), wood, organs, measured_nodes })
}
