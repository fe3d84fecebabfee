//! From points and a root to the branching of a tree, or of several that compete.

use glam::{DVec3, Vec3};
use linden_base::memory::bytes_of;
use linden_base::monitor::{Holding, Monitor};
use linden_skeleton::Branching;
use linden_skeleton::generator::{Barred, Branched, Colonized};

use crate::error::StandError;
use crate::site::{Barrier, Site};
use crate::{Growth, GrowthError, GrowthSettings, NodeSet, Obstacle, Stop, grow_among, stems};

/// The trees that grew into the points of a [`Site`].
pub struct Stand {
    /// Where the tree is to stand.
    pub branching: Branching,
    /// The nodes that were of use.
    pub captured: NodeSet,
    /// The attraction points, at the same place as the branching.
    pub points: Vec<Vec3>,
    /// From the coordinates of the [`Site`] to that place.
    pub shift: DVec3,
    /// The root's place in the file that the points are from, Y up, metres.
    pub foot: DVec3,
    /// Solids that no branch is to enter, in the coordinates of the [`Site`].
    pub barriers: Vec<Barrier>,
    /// Points that were not reached.
    pub unreached: usize,
    /// Iterations that placed nodes.
    pub iterations: u32,
    /// Why growth ended.
    pub stop: Stop,
    /// Messages for the user.
    pub notes: Vec<String>,
}

impl Stand {
    /// As a generator leaves it behind.
    pub fn branched(self, settings: &GrowthSettings) -> Branched {
        let Self { branching, captured, points, shift, barriers, unreached, iterations, notes, .. } = self;
        let used = (0..branching.parents.len()).map(|node| captured.contains(node)).collect();
        let is_in = move |p: Vec3| {
            let p = p.as_dvec3() - shift;
            barriers.iter().any(|barrier| barrier.solid.holds(p))
        };
        let barred: Barred = Box::new(is_in);
        Branched {
            branching,
            used: Some(used),
            most_nodes: settings.max_nodes.into(),
            barred: Some(barred),
            age: (settings.age < 1.0).then_some(settings.age),
            colonized: Some(Colonized { points, unreached, iterations, is_canopy: false, scan: None }),
            notes,
            ..Branched::default()
        }
    }
}

/// Grows from the root of a site into its points.
///
/// # Errors
/// [`StandError`]: contradictions, limits, nothing in reach, cancelled.
pub fn grow_at(site: Site, settings: &GrowthSettings, monitor: &dyn Monitor) -> Result<Stand, StandError> {
    let (rule, mut notes) = site.rule(settings);
    if !(rule.kill >= rule.step) {
        // Before a trunk is grown in such steps; growth itself would refuse as well.
        return Err(GrowthError::KillBelowStep { kill: rule.kill, step: rule.step }.into());
    }
    // Before anything grows there: a place that is too far for coordinates is too far for steps, too.
    let shift = settings.shift(site.root, site.origin, site.moves_to_root);
    notes.extend(check_precision(farthest_m(&site, shift), f64::from(rule.step))?);
    let start = stems::start(&site, settings, &rule, monitor)?;
    let mut points: Vec<Vec3> = site.points.iter().map(|p| p.as_vec3()).collect();
    let held =
        site.held_bytes + bytes_of::<DVec3>(site.points.capacity()) + bytes_of::<Vec3>(points.capacity());
    let solids: Vec<_> =
        site.grove.obstacles.iter().map(|barrier| (|p| barrier.solid.holds(p), barrier.meet)).collect();
    let obstacles: Vec<Obstacle> =
        solids.iter().map(|(contains, meet)| Obstacle { contains, meet: *meet }).collect();
    let Growth { mut branching, iterations, unreached, stop, captured } =
        grow_among(&points, &start, &rule, &obstacles, &Holding::new(monitor, held))?;
    if iterations == 0 && stop == Stop::Blocked {
        return Err(StandError::WalledIn);
    }
    if iterations == 0 {
        let (points, kill_m) = (points.len(), rule.kill);
        return Err(StandError::NothingGrew { points, reached: points - unreached, kill_m });
    }
    let is_moved = settings.moves_to_root(site.moves_to_root) && (site.origin + site.root).length() > 0.0;
    let moved = is_moved.then(|| moved_note(&site, rule.step));
    notes.extend(stop_note(stop, unreached, points.len(), settings));
    notes.extend(site.notes);
    notes.extend(moved);
    for position in branching.positions.iter_mut().chain(&mut points) {
        *position = (position.as_dvec3() + shift).as_vec3();
    }
    let (barriers, foot) = (site.grove.obstacles, site.origin + site.root);
    Ok(Stand { branching, captured, points, shift, foot, barriers, unreached, iterations, stop, notes })
}

/// The largest coordinate of a root before and after all are moved.
fn farthest_m(site: &Site, shift: DVec3) -> f64 {
    let others = site.grove.others.iter().flat_map(|stem| [stem.root, stem.root + shift]);
    others.chain([site.root + shift]).map(|at| at.abs().max_element()).fold(0.0, f64::max)
}

/// What is said of a tree that was moved: that it may stay, where it may.
fn moved_note(site: &Site, step_m: f32) -> String {
    let DVec3 { x, y, z } = site.origin + site.root;
    let may_stay = check_precision(farthest_m(site, site.origin), f64::from(step_m)).is_ok();
    let keep = if may_stay {
        "origin=keep leaves it there"
    } else {
        "coordinates in single precision are too coarse to leave it there"
    };
    format!("moved to the origin: the root was at {x:.3}, {y:.3}, {z:.3} (Y up); {keep}")
}

/// Refuses a place where single precision, which all mesh formats have, cannot hold the tree, and
/// says so where it can but shows.
fn check_precision(farthest_m: f64, step_m: f64) -> Result<Option<String>, StandError> {
    // Between neighbouring numbers of this size.
    let gap_m = farthest_m * f64::from(f32::EPSILON);
    if !(gap_m <= step_m / 8.0) {
        return Err(StandError::TooFar { farthest_m, gap_m, step_m });
    }
    Ok((gap_m > step_m / 100.0).then(|| {
        format!("{farthest_m:.0} m from the origin, coordinates are rounded to {gap_m:.1e} m: origin=root is more exact")
    }))
}

fn stop_note(stop: Stop, unreached: usize, points: usize, settings: &GrowthSettings) -> Option<String> {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::site::{Grove, Suggested};

    #[test]
    fn staying_is_offered_where_coordinates_allow_it() {
        let at = |origin| Site {
            points: Vec::new(),
            held_bytes: 0,
            root: DVec3::ZERO,
            grove: Grove::default(),
            origin,
            suggested: Suggested::for_volume(1.0),
            moves_to_root: true,
            notes: Vec::new(),
        };
        // 2^20 steps of 5 cm are 52.4 km.
        for (x, may_stay) in [(1000.0, true), (52_000.0, true), (53_000.0, false), (446_000.0, false)] {
            let site = at(DVec3::new(x, 300.0, -x));
            let note = moved_note(&site, 0.05);
            assert_eq!(note.contains("origin=keep"), may_stay, "{note}");
            let shift = site.origin;
            assert_eq!(check_precision(farthest_m(&site, shift), f64::from(0.05_f32)).is_ok(), may_stay);
        }
    }
}
