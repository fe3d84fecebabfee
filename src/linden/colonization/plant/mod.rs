//! From a preset's `[colonization]` to a branching: where the points are, where the tree stands, how
//! far it sees, and then growth.

mod outline;
mod points;
mod rule;
mod site;
mod standing;

use glam::{DVec3, Vec3};

use super::growth::{self, Growth, GrowthRule, Stop};
use super::trunk;
use crate::grow::GrowError;
use crate::monitor::Monitor;
use crate::preset::{Colonization, Space};
use crate::random::Key;
use crate::recipe::{Geometry, Input};
use crate::skeleton::{Branching, NO_PARENT};
use points::at_points;
use standing::Standing;

pub use outline::outline;

/// What grew into the crown.
pub(crate) struct Plant {
    /// Where the tree is to stand.
    pub branching: Branching,
    /// The attraction points, at the same place as the branching.
    pub points: Vec<Vec3>,
    /// What was scanned of the tree, at the same place; `None` for what is no scan.
    pub bark: Option<Vec<Vec3>>,
    /// Points that were not reached.
    pub unreached: usize,
    /// Iterations that placed nodes.
    pub iterations: u32,
    /// What the user should know.
    pub notes: Vec<String>,
}

pub(crate) fn plant(
    settings: &Colonization,
    input: Option<&Input>,
    key: Key,
    monitor: &dyn Monitor,
) -> Result<Plant, GrowError> {
    let site = match (&settings.space, input.map(|input| (&input.geometry, input.up))) {
        (Space::Shape { shape, dimensions }, _) => {
            Standing::shape(settings, shape, dimensions)?.fill(settings, key, monitor)?
        }
        (Space::Envelope { .. }, Some((Geometry::Mesh(mesh), up))) => {
            Standing::envelope(settings, mesh, settings.up(up), monitor)?.fill(settings, key, monitor)?
        }
        (Space::Points { .. }, Some((Geometry::Points(points), up))) => {
            at_points(settings, points, up, key, monitor)?
        }
        (Space::Envelope { file }, _) => {
            return Err(GrowError::WrongInput { file: file.clone(), expected: "a mesh" });
        }
        (Space::Points { file }, _) => {
            return Err(GrowError::WrongInput { file: file.clone(), expected: "points" });
        }
    };
    let (rule, mut notes) = site.rule(settings);
    if !(rule.kill >= rule.step) {
        // Before a trunk is grown in such steps; growth itself would refuse as well.
        return Err(growth::GrowthError::KillBelowStep { kill: rule.kill, step: rule.step }.into());
    }
    let step_m = f64::from(rule.step);
    let root = site.roots.first().copied().unwrap_or_default();
    let mut start = Branching::default();
    for &root in &site.roots {
        let trunk = trunk(settings, &site.points, root, &rule, monitor)?;
        let before = start.positions.len() as u32;
        start.parents.extend(trunk.parents.iter().map(|&p| if p == NO_PARENT { p } else { p + before }));
        start.positions.extend(trunk.positions);
        start.births.extend(trunk.births);
    }
    let mut points: Vec<Vec3> = site.points.iter().map(|p| p.as_vec3()).collect();
    let Growth { mut branching, iterations, unreached, stop } =
        growth::grow(&points, &start, &rule, monitor)?;
    if iterations == 0 {
        let (points, kill_m) = (points.len(), rule.kill);
        return Err(GrowError::NothingGrew { points, reached: points - unreached, kill_m });
    }
    notes.extend(stop_note(stop, unreached, points.len(), settings));
    notes.extend(site.notes);

    let shift = settings.shift(root, site.origin, site.moves_to_root);
    if settings.moves_to_root(site.moves_to_root) && (site.origin + root).length() > 0.0 {
        let DVec3 { x, y, z } = site.origin + root;
        notes.push(format!(
            "moved to the origin: the root was at {x:.3}, {y:.3}, {z:.3} (Y up); origin=keep leaves it there"
        ));
    }
    for position in branching.positions.iter_mut().chain(&mut points) {
        *position = (position.as_dvec3() + shift).as_vec3();
    }
    let place = |p: &DVec3| (*p + shift).as_vec3();
    let bark = site.bark.map(|bark| bark.iter().map(place).collect());
    notes.extend(check_precision(root + shift, step_m)?);
    Ok(Plant { branching, points, bark, unreached, iterations, notes })
}

/// What stands before growth: the trunk of one stem.
fn trunk(
    settings: &Colonization,
    points: &[DVec3],
    root: DVec3,
    rule: &GrowthRule,
    monitor: &dyn Monitor,
) -> Result<Branching, GrowError> {
    let step_m = f64::from(rule.step);
    if let Some(height_m) = settings.trunk_m {
        check_trunk(height_m / step_m, rule.max_nodes)?;
        return Ok(trunk::straight(root, height_m, step_m));
    }
    let reach = f64::from(rule.influence);
    // The way cannot be shorter than to the nearest point.
    let way_m = points.iter().map(|p| p.distance(root)).fold(f64::INFINITY, f64::min) - reach;
    if way_m.is_finite() {
        check_trunk(way_m / step_m, rule.max_nodes)?;
    }
    Ok(trunk::until_in_reach(root, points, reach, step_m, rule.max_nodes as usize, monitor)?)
}

/// Refuses a place where single precision, which all mesh formats have, cannot hold the tree, and
/// says so where it can but shows.
fn check_precision(root: DVec3, step_m: f64) -> Result<Option<String>, GrowError> {
    let farthest_m = root.abs().max_element();
    // Between neighbouring numbers of this size.
    let gap_m = farthest_m * f64::from(f32::EPSILON);
    if !(gap_m <= step_m / 8.0) {
        return Err(GrowError::TooFar { farthest_m, gap_m, step_m });
    }
    Ok((gap_m > step_m / 100.0).then(|| {
        format!("{farthest_m:.0} m from the origin, coordinates are rounded to {gap_m:.1e} m: origin=root is more exact")
    }))
}

/// Refuses a trunk of more segments than there may be nodes, before it is built.
fn check_trunk(segments: f64, max_nodes: u32) -> Result<(), GrowError> {
    if segments >= f64::from(max_nodes) {
        return Err(GrowError::TrunkTooLong { segments: segments.ceil(), max_nodes });
    }
    Ok(())
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
        Stop::MaxIterations => {
            Some(format!("{left}: growth stopped at max_iterations={}", settings.max_iterations))
        }
        Stop::MaxNodes => Some(format!("{left}: growth stopped at max_nodes={}", settings.max_nodes)),
    }
}
