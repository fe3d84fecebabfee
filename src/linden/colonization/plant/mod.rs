//! From a preset's `[colonization]` to a branching: where the points are, where the tree stands, how
//! far it sees, and then growth.

mod canopy;
mod outline;
mod parts;
mod points;
mod rule;
mod site;
mod standing;
mod stems;

use glam::{DVec3, Vec3};

use super::crown::placed::Placed;
use super::growth::{self, Growth, NodeSet, Stop};
use crate::grow::GrowError;
use crate::memory::{Holding, bytes_of};
use crate::monitor::Monitor;
use crate::preset::{Colonization, Length, Space};
use crate::random::Key;
use crate::recipe::{Geometry, Recipe};
use crate::skeleton::Branching;
use canopy::Verdict;
use points::{As, at_points};
use site::Site;
use standing::Standing;

pub use outline::outline;
pub use parts::PartError;
pub(crate) use site::{INFLUENCE_STEPS, KILL_STEPS};

/// What grew into the crown.
pub(crate) struct Plant {
    /// Where the tree is to stand.
    pub branching: Branching,
    /// The nodes that were of use.
    pub captured: NodeSet,
    /// The attraction points, at the same place as the branching.
    pub points: Vec<Vec3>,
    /// What was scanned of the tree, at the same place; `None` for what is no scan.
    pub bark: Option<Vec<Vec3>>,
    /// Whether the points of a scan were a crown without a stem.
    pub is_canopy: bool,
    /// What no branch is to enter, at the same place.
    pub solids: Vec<Placed>,
    /// Points that were not reached.
    pub unreached: usize,
    /// Iterations that placed nodes.
    pub iterations: u32,
    /// Why growth ended.
    pub stop: Stop,
    /// What the user should know.
    pub notes: Vec<String>,
}

/// How many points of a crown's there must be for a tree as large as any number would make: with a node's
/// reach, the kill distance, they lie at half of it. Infinite where the step follows from the points.
pub(crate) fn saturation(
    settings: &Colonization,
    recipe: &Recipe,
    monitor: &dyn Monitor,
) -> Result<f64, GrowError> {
    let kill_m = match (settings.kill, settings.step_m) {
        (Length::Metres(kill_m), _) => kill_m,
        (Length::Steps(steps), Some(step_m)) => steps * step_m,
        (Length::Auto, Some(step_m)) => KILL_STEPS * step_m,
        (_, None) => return Ok(f64::INFINITY),
    };
    let standing = Standing::new(settings, recipe, monitor)?;
    let apart_m = 0.5 * kill_m;
    Ok(standing.map_or(f64::INFINITY, |own| own.crown.volume_m3() / (apart_m * apart_m * apart_m)))
}

pub(crate) fn plant(
    settings: &Colonization,
    recipe: &Recipe,
    key: Key,
    monitor: &dyn Monitor,
) -> Result<Plant, GrowError> {
    let file = match &settings.space {
        Space::Points { file } => file,
        Space::Shape { .. } | Space::Envelope { .. } => {
            let standing = Standing::new(settings, recipe, monitor)?;
            let standing = standing.ok_or(growth::GrowthError::NoPoints)?;
            return grow_at(standing.fill(settings, key, monitor)?, settings, monitor);
        }
    };
    let Some((Geometry::Points(points), up)) = recipe.input(file).map(|input| (&input.geometry, input.up))
    else {
        return Err(GrowError::WrongInput { file: file.clone(), expected: "points" });
    };
    let site = at_points(settings, points, up, key, As::Settings, monitor)?;
    if !settings.contract {
        return grow_at(site, settings, monitor);
    }
    match grow_at(site, settings, monitor) {
        Ok(mut plant) => match Verdict::of(&plant, monitor)? {
            Verdict::Tree => return Ok(plant),
            Verdict::Partly(note) => {
                plant.notes.push(note);
                return Ok(plant);
            }
            Verdict::Canopy => {}
        },
        Err(GrowError::NothingGrew { .. }) => {}
        Err(error) => return Err(error),
    }
    let site = at_points(settings, points, up, key, As::Canopy, monitor)?;
    Ok(Plant { is_canopy: true, ..grow_at(site, settings, monitor)? })
}

/// Grows from the root of a site into its points.
fn grow_at(site: Site, settings: &Colonization, monitor: &dyn Monitor) -> Result<Plant, GrowError> {
    let (rule, mut notes) = site.rule(settings);
    if !(rule.kill >= rule.step) {
        // Before a trunk is grown in such steps; growth itself would refuse as well.
        return Err(growth::GrowthError::KillBelowStep { kill: rule.kill, step: rule.step }.into());
    }
    // Before anything grows there: a place that is too far for coordinates is too far for steps, too.
    let shift = settings.shift(site.root, site.origin, site.moves_to_root);
    let others = site.grove.others.iter().flat_map(|stem| [stem.root, stem.root + shift]);
    let farthest_m = others.chain([site.root + shift]).map(|at| at.abs().max_element());
    notes.extend(check_precision(farthest_m.fold(0.0, f64::max), f64::from(rule.step))?);
    let start = stems::start(&site, settings, &rule, monitor)?;
    let mut points: Vec<Vec3> = site.points.iter().map(|p| p.as_vec3()).collect();
    let bark = site.bark.as_ref().map_or(0, Vec::capacity);
    let held = bytes_of::<DVec3>(site.points.capacity() + bark) + bytes_of::<Vec3>(points.capacity());
    let solids: Vec<_> =
        site.grove.obstacles.iter().map(|own| (|p| own.solid.contains(p), own.meet)).collect();
    let obstacles: Vec<growth::Obstacle> =
        solids.iter().map(|(contains, meet)| growth::Obstacle { contains, meet: *meet }).collect();
    let Growth { mut branching, iterations, unreached, stop, captured } =
        growth::grow_among(&points, &start, &rule, &obstacles, &Holding::new(monitor, held))?;
    if iterations == 0 && stop == Stop::Blocked {
        return Err(GrowError::WalledIn);
    }
    if iterations == 0 {
        let (points, kill_m) = (points.len(), rule.kill);
        return Err(GrowError::NothingGrew { points, reached: points - unreached, kill_m });
    }
    notes.extend(stop_note(stop, unreached, points.len(), settings));
    notes.extend(site.notes);

    if settings.moves_to_root(site.moves_to_root) && (site.origin + site.root).length() > 0.0 {
        let DVec3 { x, y, z } = site.origin + site.root;
        notes.push(format!(
            "moved to the origin: the root was at {x:.3}, {y:.3}, {z:.3} (Y up); origin=keep leaves it there"
        ));
    }
    for position in branching.positions.iter_mut().chain(&mut points) {
        *position = (position.as_dvec3() + shift).as_vec3();
    }
    let place = |p: &DVec3| (*p + shift).as_vec3();
    let bark = site.bark.map(|bark| bark.iter().map(place).collect());
    let solids = site.grove.obstacles.into_iter();
    let solids = solids.map(|own| Placed::new(own.solid, shift, 0.0, 1.0)).collect();
    let is_canopy = false;
    Ok(Plant { branching, captured, points, bark, is_canopy, solids, unreached, iterations, stop, notes })
}

/// Refuses a place where single precision, which all mesh formats have, cannot hold the tree, and
/// says so where it can but shows.
fn check_precision(farthest_m: f64, step_m: f64) -> Result<Option<String>, GrowError> {
    // Between neighbouring numbers of this size.
    let gap_m = farthest_m * f64::from(f32::EPSILON);
    if !(gap_m <= step_m / 8.0) {
        return Err(GrowError::TooFar { farthest_m, gap_m, step_m });
    }
    Ok((gap_m > step_m / 100.0).then(|| {
        format!("{farthest_m:.0} m from the origin, coordinates are rounded to {gap_m:.1e} m: origin=root is more exact")
    }))
}

fn stop_note(stop: Stop, unreached: usize, points: usize, settings: &Colonization) -> Option<String> {
    let left = format!("{unreached} of {points} points were not reached");
    match stop {
        Stop::AllReached => None,
        Stop::NothingInReach => {
            // A few stragglers are usual; many mean that the crown is in pieces.
            (unreached * 20 > points)
                .then(|| format!("{left}: they lie beyond the influence distance; raise influence"))
        }
        Stop::Stalled => Some(format!("{left}: the step is too short for coordinates of this size")),
        Stop::Blocked => Some(format!("{left}: obstacles or max_children were in the way")),
        Stop::MaxIterations => {
            Some(format!("{left}: growth stopped at max_iterations={}", settings.max_iterations))
        }
        Stop::MaxNodes => Some(format!("{left}: growth stopped at max_nodes={}", settings.max_nodes)),
    }
}
