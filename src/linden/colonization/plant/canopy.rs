//! Scans of canopies without stems, as from an aircraft.
//!
//! A few points a square metre on top of a crown show no bark. Moved onto axes, as a scanner's points on bark are,
//! they make a stub somewhere under the rim. Such points are a crown: the tree stands on the ground below their
//! middle and grows into them as they are.

use glam::{DVec3, Vec3};

use super::Plant;
use super::standing::crown_base;
use crate::colonization::growth::Stop;
use crate::colonization::scan::{girth, share_near};
use crate::grow::{GrowError, MEASURING_BYTES_PER_POINT};
use crate::monitor::Monitor;
use crate::preset::Colonization;
use crate::skeleton::Branching;

/// A point is near the tree within this part of the scan's height: stems are thinner.
const NEAR_PER_HEIGHT: f64 = 0.1;

/// A tree that fewer of its scan's points are near did not grow into the scan; nearly all are, of real ones.
const LEAST_NEAR: f64 = 0.5;

/// Fewer are worth a word.
const USUAL_NEAR: f64 = 0.8;

/// No crown is higher above ground, metres; what is, has heights above the sea.
const HIGHEST_M: f64 = 100.0;

/// What the growth into a scan has come to.
pub(super) enum Verdict {
    /// The tree is near its points.
    Tree,
    /// It is near some of them; what to say.
    Partly(String),
    /// Hardly any, and not one ring of bark was measured: the points are a canopy.
    Canopy,
}

impl Verdict {
    /// Judges a tree that grew as far as it could.
    pub fn of(plant: &Plant, settings: &Colonization, monitor: &dyn Monitor) -> Result<Self, GrowError> {
        let is_finished = matches!(plant.stop, Stop::AllReached | Stop::NothingInReach);
        let Some(bark) = plant.bark.as_deref().filter(|_| is_finished) else { return Ok(Self::Tree) };
        Self::of_branching(&plant.branching, bark, settings, monitor)
    }

    fn of_branching(
        branching: &Branching,
        bark: &[Vec3],
        settings: &Colonization,
        monitor: &dyn Monitor,
    ) -> Result<Self, GrowError> {
        let heights = || bark.iter().map(|p| f64::from(p.y));
        let height_m = heights().fold(f64::NEG_INFINITY, f64::max) - heights().fold(f64::INFINITY, f64::min);
        let near_m = NEAR_PER_HEIGHT * height_m;
        let share = share_near(branching, bark, near_m, monitor)?;
        if share >= USUAL_NEAR {
            return Ok(Self::Tree);
        }
        // The stoutest stem has points far from its axis, and rings of bark.
        let bytes = bark.len() as u64 * MEASURING_BYTES_PER_POINT + branching.bytes();
        monitor.admit("measuring the scan", bytes, "thin the points out")?;
        let is_canopy = share < LEAST_NEAR && girth(branching, bark, 2.0, monitor)?.is_none();
        if is_canopy && settings.parts.is_empty() {
            return Ok(Self::Canopy);
        }
        Ok(Self::Partly(format!(
            "only {:.0} % of the scanned points lie within {near_m:.2} m of the tree: is it all of one tree, \
             seen from its foot up? contract=false grows into the points as they are",
            100.0 * share
        )))
    }
}

/// Where a tree stands whose crown are these points (Y up, each minus `origin`): on the ground below their middle.
/// Ground is the height 0 where the file has heights above it; else so far below the lowest point as the trunk is
/// long.
pub(super) fn root_below(points: &[DVec3], origin: DVec3, settings: &Colonization) -> Option<DVec3> {
    let low = points.iter().copied().reduce(DVec3::min)?;
    let high = points.iter().copied().reduce(DVec3::max)?;
    let middle = points.iter().copied().sum::<DVec3>() / points.len() as f64;
    let (base_m, top_m) = (low.y + origin.y, high.y + origin.y);
    let ground_m = if base_m >= 0.0 && top_m < HIGHEST_M {
        0.0
    } else {
        base_m - crown_base(settings.trunk_m, high.y - low.y)
    };
    Some(DVec3::new(middle.x, ground_m - origin.y, middle.z))
}

/// What is said of it: `root` and `origin` as in the site.
pub(super) fn note(points: usize, root: DVec3, is_given: bool) -> String {
    let DVec3 { x, y, z } = root;
    let where_to = if is_given { "" } else { "; root=x,y,z says where it stands instead" };
    format!(
        "no stem was found below these {points} points: they were taken for the canopy of a tree that stands at \
         {x:.2}, {y:.2}, {z:.2} (Y up), as with contract=false{where_to}"
    )
}
