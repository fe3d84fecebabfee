//! Scans of canopies without stems, as from an aircraft.
//!
//! A few points a square metre on top of a crown show no bark. Moved onto axes, as a scanner's points on bark
//! are, they make a stub somewhere under the rim. Such points are a crown: the tree stands on the ground
//! below their middle and grows into them as they are.

use glam::{DVec3, Vec3};
use linden_base::monitor::{Cancelled, Monitor};
use linden_growth::site::crown_base_m;
use linden_growth::{Stand, Stop};
use linden_skeleton::Wood;

use crate::girth::MEASURING_BYTES_PER_POINT;
use crate::ground::ground_height;
use crate::settings::ScanSettings;
use crate::{ScanGrowthError, girth, share_near, shows_stem};

/// A point is near the tree within this part of the scan's height: stems are thinner.
const NEAR_PER_HEIGHT: f64 = 0.1;

/// A tree that fewer of its scan's points are near did not grow into the scan; nearly all are, of real ones.
const LEAST_NEAR: f64 = 0.5;

/// Fewer are worth a word.
const USUAL_NEAR: f64 = 0.8;

/// Fewer of a tree's nodes have a ring of bark by accident, of 1.
const FEW_RINGS: f64 = 0.05;

/// Between ground and canopy there is a layer without points, so thick as a part of the height of all.
const GAP_PER_HEIGHT: f64 = 0.15;

/// No crown is higher above ground, metres; what is, has heights above the sea.
const HIGHEST_M: f64 = 100.0;

/// What the growth into a scan has come to.
pub(crate) enum Verdict {
    /// The tree is near its points.
    Tree,
    /// It is near some of them; what to say.
    Partly(String),
    /// Hardly any, no stem stands below them, and hardly a ring of bark was measured: the points are a
    /// canopy.
    Canopy,
}

impl Verdict {
    /// Judges a tree that grew as far as it could.
    pub fn of(stand: &Stand, bark: Option<&[Vec3]>, monitor: &dyn Monitor) -> Result<Self, ScanGrowthError> {
        let is_finished = matches!(stand.stop, Stop::AllReached | Stop::NothingInReach);
        let Some(bark) = bark.filter(|_| is_finished) else { return Ok(Self::Tree) };
        let branching = &stand.branching;
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
        let few = FEW_RINGS * branching.positions.len() as f64;
        let rings = || {
            let girth = girth(&mut branching.clone(), bark, &Wood::default(), monitor)?;
            Ok::<_, Cancelled>(girth.map_or(0, |girth| girth.measured))
        };
        if share < LEAST_NEAR && !shows_stem(bark) && (rings()? as f64) < few {
            return Ok(Self::Canopy);
        }
        Ok(Self::Partly(format!(
            "only {:.0} % of the scanned points lie within {near_m:.2} m of the tree: the scan is too thin for \
             its bark, or not of one tree; contract=false grows into the points as they are",
            100.0 * share
        )))
    }
}

/// Takes the points of the ground from those of a canopy, where a layer without any lies between them; the
/// height of the ground.
pub(crate) fn drop_ground(points: &mut Vec<DVec3>) -> Option<f64> {
    let mut heights: Vec<f64> = points.iter().map(|p| p.y).collect();
    heights.sort_unstable_by(f64::total_cmp);
    let (low, high) = (*heights.first()?, *heights.last()?);
    let widest =
        heights.windows(2).enumerate().max_by(|a, b| (a.1[1] - a.1[0]).total_cmp(&(b.1[1] - b.1[0])))?;
    let (last, gap_m) = (widest.0, widest.1[1] - widest.1[0]);
    // What is thicker than the gap above it is no ground.
    if gap_m < GAP_PER_HEIGHT * (high - low) || heights[last] - low > gap_m {
        return None;
    }
    points.retain(|p| p.y > heights[last]);
    Some(heights[last / 2])
}

/// The height of the ground below the middle of a canopy, by points on it.
pub(crate) fn ground_below(points: &[DVec3], ground: &[DVec3]) -> Option<f64> {
    let middle = points.iter().copied().sum::<DVec3>() / points.len().max(1) as f64;
    ground_height(ground, middle)
}

/// Where a tree stands whose crown are these points (Y up, each minus `origin`): on the ground below their
/// middle. Where no ground was seen it is the height 0 if the file has heights above that; else so far below
/// the lowest point as the trunk is long.
pub(crate) fn root_below(
    points: &[DVec3],
    ground_m: Option<f64>,
    origin: DVec3,
    settings: &ScanSettings,
) -> Option<DVec3> {
    let low = points.iter().copied().reduce(DVec3::min)?;
    let high = points.iter().copied().reduce(DVec3::max)?;
    let middle = points.iter().copied().sum::<DVec3>() / points.len() as f64;
    let (base_m, top_m) = (low.y + origin.y, high.y + origin.y);
    let unseen = || {
        if base_m >= 0.0 && top_m < HIGHEST_M {
            -origin.y
        } else {
            low.y - crown_base_m(settings.growth.trunk_m, high.y - low.y)
        }
    };
    Some(DVec3::new(middle.x, ground_m.unwrap_or_else(unseen), middle.z))
}

/// What is said of it: `root` and `origin` as in the site.
pub(crate) fn note(points: usize, root: DVec3, is_given: bool) -> String {
    let DVec3 { x, y, z } = root;
    let where_to = if is_given { "" } else { "; root=x,y,z says where it stands instead" };
    format!(
        "no stem was found below these {points} points: they were taken for the canopy of a tree that stands at \
         {x:.2}, {y:.2}, {z:.2} (Y up), as with contract=false{where_to}"
    )
}
