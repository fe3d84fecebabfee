//! Which points of a scan lie on leaves.
//!
//! Ways from the foot run along wood: what bears much of a crown has long ways beyond it, a leaf has none (the frequency of
//! paths of Vicari, Disney, Wilkes, Burt, Calders & Woodgate 2019, *Leaf and wood classification framework for terrestrial
//! `LiDAR` point clouds*, in metres). Wood that bears a crown of some length is about as thick as that length lets expect,
//! *r* = *r* of the trunk · (*w* ÷ *w* of the trunk)^1.1 for the longest way *w* to a tip (Du, Lindenbergh, Ledoux,
//! Stoter & Nan 2019, *`AdTree`*). A point is wood where a way of thick wood is near, by the expected radius, and the
//! sooner the more the points around it are a surface and the more upright that is: bark is smooth, leaves scatter and face the
//! sky. Then each point is what most of its neighbours are, and what lies on the trunk's circles is wood.
//!
//! Twigs thinner than the spacing of the points are not told from leaves.

use std::sync::atomic::{AtomicU32, Ordering};

use glam::DVec3;
use rayon::prelude::*;

use super::ScanError;
use super::cubes::Cubes;
use super::foot::Foot;
use super::graph::{Graph, Ways};
use super::neighbours::Neighbours;
use super::surface::Patch;
use super::trunk::Trunk;
use linden_base::monitor::{Cancelled, Monitor};

/// Radius by the longest way to a tip: the exponent.
const TAPER: f64 = 1.1;

/// Ways are looked for within so many details of a point;
const REACH: f64 = 8.0;

/// and are nearer by half a detail than they seem: points are means of cubes.
const PLAY: f64 = 0.5;

/// The surface around a point is made of points within so many details, thinned to cubes of so many.
const SURFACE_REACH: f64 = 5.0;
const SURFACE_CUBE: f64 = 1.5;

/// A point is wood where ln(expected radius ÷ distance of the way) is above this,
const LEAST: f64 = -1.95;

/// and more by so much for scatter, λ₃ ÷ λ₁ of the points around it,
const SCATTER: f64 = 3.5;

/// and for how level the surface is, from 0 for an upright one to 1. (The three by logistic regression on scans of an
/// apple, an ash and a horse chestnut in leaf.)
const LEVEL: f64 = 0.85;

/// For each point while leaves are told from wood: two trees of neighbours, thinned points, marks (by addition).
const BYTES_PER_POINT: u64 = 220;

/// Rounds in which each point becomes what most of its neighbours are.
const ROUNDS: usize = 2;

/// For each point of a graph whether it lies on a leaf, in a scan of a tree in leaf.
pub(super) fn told(
    graph: &Graph,
    ways: &Ways,
    foot: &Foot,
    trunks: &[(DVec3, Trunk)],
    detail_m: f64,
    monitor: &dyn Monitor,
) -> Result<Vec<bool>, ScanError> {
    let bytes = graph.points.len() as u64 * BYTES_PER_POINT;
    monitor.admit("telling leaves from wood", bytes, "thin the points out")?;
    let on_trunk: Vec<bool> =
        graph.points.par_iter().map(|p| trunks.iter().any(|(_, trunk)| trunk.place(*p).is_some())).collect();
    let all = Neighbours::new(&graph.points, monitor)?;
    let radii_m = radii_m(ways, foot, trunks.iter().map(|(_, trunk)| trunk.radius_m()), monitor)?;
    let nearness = nearness((&all, &graph.points), &radii_m, &on_trunk, detail_m, monitor)?;
    let cubes = Cubes::new(&graph.points, SURFACE_CUBE * detail_m);
    let tree = Neighbours::new(&cubes.means, monitor)?;
    let mut is_wood: Vec<bool> = graph
        .points
        .par_iter()
        .zip(&nearness)
        .zip(&on_trunk)
        .map(|((&p, &near), &on_trunk)| {
            monitor.check()?;
            // Farther from all ways even a smooth upright surface is none.
            Ok(on_trunk
                || near > libm::exp(LEAST) && {
                    let count = |cube: usize| f64::from(cubes.count(cube));
                    let patch = Patch::around(p, SURFACE_REACH * detail_m, (&tree, &cubes.means), count);
                    libm::log(near) > LEAST + SCATTER * patch.scatter + LEVEL * patch.normal.y.abs()
                })
        })
        .collect::<Result<_, Cancelled>>()?;
    for _ in 0..ROUNDS {
        let of_most = graph.of_most(&is_wood);
        is_wood = of_most.into_iter().zip(&on_trunk).map(|(wood, &on_trunk)| wood || on_trunk).collect();
    }
    Ok(is_wood.into_iter().map(|wood| !wood).collect())
}

/// How thick wood is expected to be along the way through each point, metres.
pub(super) fn radii_m(
    ways: &Ways,
    foot: &Foot,
    trunks_m: impl Iterator<Item = f64>,
    monitor: &dyn Monitor,
) -> Result<Vec<f64>, Cancelled> {
    let beyond_m = ways.beyond_m();
    monitor.check()?;
    let longest_m = beyond_m.iter().copied().fold(0.0, f64::max).max(f64::MIN_POSITIVE);
    let seen_m = trunks_m.fold(0.0, f64::max);
    let trunk_m = if seen_m > 0.0 { seen_m } else { 0.5 * foot.radius_m };
    Ok(beyond_m.into_par_iter().map(|beyond_m| trunk_m * libm::pow(beyond_m / longest_m, TAPER)).collect())
}

/// For each point the most of expected radius ÷ distance of all ways near it, 0 where none is near enough to matter.
fn nearness(
    (tree, points): (&Neighbours, &[DVec3]),
    radii_m: &[f64],
    on_trunk: &[bool],
    detail_m: f64,
    monitor: &dyn Monitor,
) -> Result<Vec<f64>, Cancelled> {
    let play_m = PLAY * detail_m;
    // The most does not depend on the order; bits of non-negative floats order as the floats do.
    let most: Vec<AtomicU32> = points.iter().map(|_| AtomicU32::new(0)).collect();
    let spread = |((&p, &radius_m), &on_trunk): ((&DVec3, &f64), &bool)| {
        monitor.check()?;
        let reach_m = (radius_m / libm::exp(LEAST) - play_m).min(REACH * detail_m);
        if reach_m > 0.0 && !on_trunk {
            let squared = reach_m * reach_m;
            tree.search(p, squared, |other, away| {
                let near = (radius_m / (away.sqrt() + play_m)) as f32;
                most[other as usize].fetch_max(near.to_bits(), Ordering::Relaxed);
                squared
            });
        }
        Ok(())
    };
    points.par_iter().zip(radii_m).zip(on_trunk).try_for_each(spread)?;
    Ok(most.into_iter().map(|bits| f64::from(f32::from_bits(bits.into_inner()))).collect())
}
