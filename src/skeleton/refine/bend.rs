//! A trunk on a curve that somebody drew.

use glam::{Quat, Vec3};

use super::{RefineError, Refinement, Shoots};
use crate::{Branching, NO_PARENT, axes_by_tips};

/// Samples of the curve for its arc length.
const SAMPLES: usize = 512;

/// Bends the first stem onto the Bézier curve whose control points are its foot and those of
/// `trunk_curve`, by de Casteljau's construction. The stem is stretched to the curve's length; what hangs on
/// it keeps its shape, and turns as the stem turns where it leaves.
pub(super) fn bend(shoots: &mut Shoots<'_>, refinement: &Refinement) -> Result<(), RefineError> {
    let numbers = &refinement.trunk_curve;
    if !numbers.len().is_multiple_of(3) {
        return Err(RefineError::TrunkCurve { numbers: numbers.len() });
    }
    let mut control = vec![Vec3::ZERO];
    control.extend(numbers.chunks_exact(3).map(|p| Vec3::new(p[0] as f32, p[1] as f32, p[2] as f32)));
    let Branching { positions, parents, .. } = &shoots.branching;
    // The wood as it stands, whatever the brackets of a grammar say.
    let (axes, axis_nodes) = axes_by_tips(positions, parents, None);
    let Some(stem) = axes.first() else { return Ok(()) };
    let stem = &axis_nodes[stem.first as usize..(stem.first + stem.len) as usize];
    let foot = positions[stem[0] as usize];
    let samples: Vec<Vec3> = (0..=SAMPLES).map(|i| bezier(&control, i as f32 / SAMPLES as f32)).collect();
    let curve = lengths(&samples);
    let old: Vec<Vec3> = stem.iter().map(|&node| positions[node as usize]).collect();
    let ways = lengths(&old);
    let (Some(&whole), Some(&curved)) = (ways.last(), curve.last()) else { return Ok(()) };
    if !(whole > 0.0 && curved > 0.0) {
        return Ok(());
    }
    let new: Vec<Vec3> = ways.iter().map(|way| foot + at(&samples, &curve, way / whole * curved)).collect();
    // Where in the stem each node hangs, through whatever is between.
    let mut hangs_on = vec![NO_PARENT; parents.len()];
    for (place, &node) in (0..).zip(stem) {
        hangs_on[node as usize] = place;
    }
    let turns: Vec<Quat> =
        (0..stem.len()).map(|i| Quat::from_rotation_arc(tangent(&old, i), tangent(&new, i))).collect();
    let mut places = positions.clone();
    for node in 0..parents.len() {
        if hangs_on[node] == NO_PARENT && parents[node] != NO_PARENT {
            hangs_on[node] = hangs_on[parents[node] as usize];
        }
        if hangs_on[node] != NO_PARENT {
            let on = hangs_on[node] as usize;
            places[node] = new[on] + turns[on] * (positions[node] - old[on]);
        }
    }
    shoots.relocate(places);
    Ok(())
}

fn bezier(control: &[Vec3], t: f32) -> Vec3 {
    let mut points = control.to_vec();
    for left in (1..points.len()).rev() {
        for i in 0..left {
            points[i] = points[i].lerp(points[i + 1], t);
        }
    }
    points[0]
}

/// Arc lengths from the first point to each.
fn lengths(points: &[Vec3]) -> Vec<f32> {
    let mut along = 0.0;
    let steps = points.windows(2).map(|pair| {
        along += pair[0].distance(pair[1]);
        along
    });
    std::iter::once(0.0).chain(steps).collect()
}

/// The point of a line of samples at an arc length.
fn at(samples: &[Vec3], lengths: &[f32], along: f32) -> Vec3 {
    let next = lengths.partition_point(|&length| length < along).clamp(1, samples.len() - 1);
    let (from, to) = (lengths[next - 1], lengths[next]);
    let t = if to > from { ((along - from) / (to - from)).clamp(0.0, 1.0) } else { 0.0 };
    samples[next - 1].lerp(samples[next], t)
}

/// Along a line at one of its points.
fn tangent(points: &[Vec3], i: usize) -> Vec3 {
    let (before, after) = (points[i.saturating_sub(1)], points[(i + 1).min(points.len() - 1)]);
    (after - before).normalize_or(Vec3::Y)
}

#[cfg(test)]
mod tests {
    use super::super::testing::{refined, straight_with_lateral};
    use super::super::{Room, refine};
    use super::*;
    use linden_base::monitor::Quiet;

    fn curved(numbers: &[f64]) -> Refinement {
        Refinement { trunk_curve: numbers.to_vec(), ..Refinement::default() }
    }

    #[test]
    fn a_straight_curve_stretches_and_a_bent_one_carries_laterals() {
        let all = straight_with_lateral();
        // 9.1 m become 18.2 m, and the lateral at 4 m leaves at 8 m.
        let stretched = refined(all.clone(), &curved(&[0.0, 18.2, 0.0]));
        assert!(stretched.positions[2].distance(Vec3::Y * 8.0) < 1e-3);
        assert!(stretched.positions[8].distance(Vec3::new(4.0, 8.0, 0.0)) < 1e-3);
        // Lying along X: what leaned along X now looks down.
        let lying = refined(all, &curved(&[9.1, 0.0, 0.0]));
        assert!(lying.positions[5].distance(Vec3::X * 9.1) < 1e-3);
        assert!(lying.positions[8].distance(Vec3::new(4.0, -4.0, 0.0)) < 1e-3);
    }

    /// Points of the cubic by its Bernstein polynomials: the stem lies on it, evenly.
    #[test]
    fn the_stem_lies_on_the_cubic() {
        let control = [Vec3::ZERO, Vec3::new(0., 4., 0.), Vec3::new(3., 5., 1.), Vec3::new(3., 9., 0.)];
        let numbers: Vec<f64> = control[1..].iter().flat_map(|p| p.to_array().map(f64::from)).collect();
        let bent = refined(straight_with_lateral(), &curved(&numbers));
        let cubic = |t: f32| {
            let s = 1.0 - t;
            control[1] * (3.0 * s * s * t) + control[2] * (3.0 * s * t * t) + control[3] * (t * t * t)
        };
        for node in 0..6 {
            let off = (0..=4000).map(|i| cubic(i as f32 / 4000.0).distance(bent.positions[node]));
            assert!(off.fold(9.0, f32::min) < 2e-3, "node {node}");
        }
        assert!(bent.positions[5].distance(control[3]) < 1e-4);
    }

    #[test]
    fn numbers_that_are_no_points_are_refused() {
        let refused =
            refine(straight_with_lateral(), None, &mut [], &curved(&[1.0, 2.0]), Room::open(99), &Quiet);
        assert_eq!(refused, Err(RefineError::TrunkCurve { numbers: 2 }));
    }
}
