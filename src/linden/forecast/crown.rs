//! Samples of space colonization: fewer points, farther apart.

use std::sync::Arc;

use glam::DVec3;

use super::{NODES, POINTS, Small, feet};
use crate::colonization::plant::{self, INFLUENCE_STEPS, KILL_STEPS};
use crate::colonization::scan;
use crate::grow::{GrowError, Grown, grow};
use crate::monitor::Monitor;
use crate::preset::{Colonization, Generator, Length, Space};
use crate::recipe::{Geometry, Recipe};

/// How much longer steps become that are too short for a sample.
const LENGTHENING: f64 = 4.0;
/// How often.
const LENGTHENINGS: usize = 6;

pub(super) fn sample(own: &Colonization, bare: &Recipe, monitor: &dyn Monitor) -> Result<Small, GrowError> {
    let points = match &own.space {
        Space::Shape { .. } | Space::Envelope { .. } => own.points as usize,
        Space::Points { file } => match recipe_points(bare, file) {
            Some(points) => points.len(),
            None => 0,
        },
    };
    // Each stem of a grove has its crown; refinement may multiply nodes.
    let most = POINTS.max(own.parts.len() * 100) >> super::halvings(&bare.preset.refinement).min(4);
    // Points that are far nearer to each other than a node reaches are reached together: more make no
    // larger tree.
    let counting = match &own.space {
        Space::Points { .. } => points as f64,
        _ => plant::saturation(own, bare, monitor)?.min(points as f64).max((most as f64).min(points as f64)),
    };
    let share = (most as f64 / counting).min(1.0);
    let mut recipe = bare.clone();
    let mut small = own.clone();
    small.max_nodes = own.max_nodes.min(NODES);
    let (mut coarser, mut longer) = (1.0, 1.0);
    if let Space::Points { file } = &own.space {
        if let Some(points) = recipe_points(bare, file).filter(|_| share < 1.0) {
            let part = spread(points, most);
            if own.contract {
                longer = scan_steps(&mut small, points, &part, monitor);
            } else {
                coarser = libm::cbrt(1.0 / share);
            }
            put_points(&mut recipe, file, part);
        }
    } else if points > most {
        small.points = most as u32;
        // With fewer points, a step that follows from their distance is what it would have been.
        coarser = libm::cbrt(1.0 / share);
    }
    if coarser > 1.0 {
        let metres = |length: Length| match length {
            Length::Metres(x) => Length::Metres(x * coarser),
            other => other,
        };
        small.step_m = own.step_m.map(|step| step * coarser);
        (small.kill, small.influence) = (metres(own.kill), metres(own.influence));
        small.gravity = own.gravity / coarser;
        small.max_iterations = ((f64::from(own.max_iterations) / coarser) as u32).max(1);
        small.wave_interval = (f64::from(own.wave_interval) / coarser).ceil() as u32;
    }
    for round in 0.. {
        recipe.preset.generator = Generator::Colonization(small.clone());
        let grown = grow(&recipe, monitor)?;
        let is_cut = is_cut_short(&grown, small.max_nodes) && small.max_nodes < own.max_nodes;
        let Some(step) = small.step_m.filter(|_| is_cut && round < LENGTHENINGS) else {
            let scanned = matches!(own.space, Space::Points { .. }) && own.contract;
            let crown = if scanned { 1.0 } else { 1.0 / share };
            let (wood_times, leaf_times) = if scanned {
                (longer, 1.0)
            } else {
                let trunk = trunk_share(&grown);
                let per_node = (1.0 - trunk) * crown + trunk * coarser;
                (longer * per_node, per_node)
            };
            let nodes = grown.skeleton.positions.len().max(1) as f64;
            let within = (f64::from(own.max_nodes) / nodes).max(1.0).min(wood_times.max(1.0));
            let leaf_times = leaf_times * (within / wood_times.max(1.0));
            let point_times = (points as f64 / most as f64).max(1.0);
            return Ok(Small {
                recipe,
                grown,
                wood_times: within,
                leaf_times,
                point_times,
                crowding: crown,
                coarser,
            });
        };
        // The same wood in fewer, longer segments; points are reached and pull as before.
        let metres = |length: Length, steps: f64| match length {
            Length::Steps(x) => x * step,
            Length::Auto => steps * step,
            Length::Metres(x) => x,
        };
        let next = step * LENGTHENING;
        small.kill = Length::Metres(metres(small.kill, KILL_STEPS).max(next));
        small.influence = Length::Metres(metres(small.influence, INFLUENCE_STEPS).max(2.0 * next));
        small.step_m = Some(next);
        longer *= LENGTHENING;
    }
    // The loop ends by returning: it lengthens a limited number of times.
    Err(crate::colonization::growth::GrowthError::NoPoints.into())
}

/// Whether growth stopped at the limit.
fn is_cut_short(grown: &Grown, max_nodes: u32) -> bool {
    grown.skeleton.positions.len() >= max_nodes as usize
}

/// The share of nodes that were there before the first point was reached: they grow with a length.
fn trunk_share(grown: &Grown) -> f64 {
    let skeleton = &grown.skeleton;
    let trunk = skeleton.births.iter().filter(|&&birth| birth == 0).count().max(feet(skeleton));
    trunk as f64 / skeleton.births.len().max(1) as f64
}

/// So many of the points, evenly through the list.
fn spread(points: &[DVec3], count: usize) -> Vec<DVec3> {
    let every = points.len() as f64 / count.max(1) as f64;
    (0..count).filter_map(|i| points.get((i as f64 * every) as usize)).copied().collect()
}

/// Gives a part of a scan steps that it can be seen in. How many times as long they are as those of the
/// whole.
fn scan_steps(small: &mut Colonization, points: &[DVec3], part: &[DVec3], monitor: &dyn Monitor) -> f64 {
    // Points on bark: as many a square metre as there are.
    let sparser = (points.len() as f64 / part.len().max(1) as f64).sqrt();
    let Ok(Some(spacing_m)) = scan::point_spacing_m(part, monitor) else { return 1.0 };
    let scale = small.scale.unwrap_or_else(|| scan::likely_scale(part));
    let spacing_m = spacing_m * scale;
    let low = part.iter().copied().fold(DVec3::INFINITY, DVec3::min);
    let high = part.iter().copied().fold(DVec3::NEG_INFINITY, DVec3::max);
    let height_m = (high - low).max_element() * scale;
    let whole = small.step_m.unwrap_or_else(|| scan::detail_m(spacing_m / sparser, height_m));
    let seen = scan::detail_m(spacing_m, height_m).max(whole);
    if seen > whole {
        small.step_m = Some(seen);
    }
    seen / whole
}

fn recipe_points<'a>(recipe: &'a Recipe, file: &str) -> Option<&'a [DVec3]> {
    match &recipe.input(file)?.geometry {
        Geometry::Points(points) => Some(points),
        _ => None,
    }
}

fn put_points(recipe: &mut Recipe, file: &str, points: Vec<DVec3>) {
    if let Some(mut input) = recipe.input(file).cloned() {
        input.geometry = Geometry::Points(Arc::new(points));
        recipe.inputs.insert(file, input);
    }
}
