//! How far a grown skeleton is from the scan that it grew into.

use std::borrow::Cow;

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use super::girth::Placed;
use super::neighbours::Neighbours;
use super::segments::Segments;
use linden_base::monitor::{Cancelled, Monitor};
use linden_skeleton::generator::{Fit, Gaps, Spread};
use linden_skeleton::{Branching, NO_PARENT, Skeleton};

/// Measures how far `points` (metres, where the skeleton stands) are from the skeleton, and back. `None`
/// without points or segments. A million points take about a second on two cores.
///
/// # Errors
/// [`Cancelled`].
pub fn gaps(points: &[Vec3], skeleton: &Skeleton, monitor: &dyn Monitor) -> Result<Option<Gaps>, Cancelled> {
    gaps_of_placed(points, None, skeleton, monitor)
}

/// The same of points that may have been given to segments already.
pub(crate) fn gaps_of_placed(
    points: &[Vec3],
    placed: Option<&Placed>,
    skeleton: &Skeleton,
    monitor: &dyn Monitor,
) -> Result<Option<Gaps>, Cancelled> {
    let Skeleton { positions, parents, radii, .. } = skeleton;
    let Some(segments) = Segments::new(positions, parents).filter(|_| !points.is_empty()) else {
        return Ok(None);
    };
    let bases = lateral_bases(skeleton);
    let radius_m = |node: u32, t: f64| {
        let upper = f64::from(radii[node as usize]);
        let below = if bases[node as usize] { node } else { parents[node as usize] };
        let lower = f64::from(radii[below as usize]);
        lower + (upper - lower) * t
    };
    let nearest = match placed.and_then(|placed| placed.nearest(positions, parents)) {
        Some(nearest) => Cow::Borrowed(nearest),
        None => Cow::Owned(segments.nearest(points, monitor)?),
    };
    let to_axis: Vec<f64> = nearest.iter().map(|n| n.distance_m).collect();
    let to_surface: Vec<f64> = nearest.iter().map(|n| (n.distance_m - radius_m(n.node, n.t)).abs()).collect();
    let of_points_m = to_surface.iter().map(|&gap| gap as f32).collect();
    // Large, and not needed any more.
    drop(nearest);

    monitor.check()?;
    let scanned: Vec<DVec3> = points.iter().map(|p| p.as_dvec3()).collect();
    let tree = Neighbours::new(&scanned, monitor)?;
    let nodes: Vec<u32> =
        (0..).zip(parents).filter(|(_, parent)| **parent != NO_PARENT).map(|(n, _)| n).collect();
    let ends = |node: u32| [parents[node as usize], node].map(|n| positions[n as usize].as_dvec3());
    let away = |places: &[DVec3]| -> Result<Vec<f64>, Cancelled> {
        let one = |&p: &DVec3| monitor.check().map(|()| tree.nearest_squared(p).sqrt());
        places.par_iter().map(one).collect()
    };
    let middles: Vec<DVec3> = nodes.iter().map(|&node| ends(node)[0].midpoint(ends(node)[1])).collect();
    let back = away(&middles)?;
    let mut of_nodes_m = vec![0.0; positions.len()];
    for (&node, &to_axis_m) in nodes.iter().zip(&back) {
        of_nodes_m[node as usize] = (to_axis_m - radius_m(node, 0.5)).abs() as f32;
    }
    let back_to_surface = away(&on_surface(&nodes, ends, &radius_m))?;
    let spreads =
        [Spread::of(to_axis), Spread::of(to_surface), Spread::of(back), Spread::of(back_to_surface)];
    let [Some(points_to_axis), Some(points_to_surface), Some(axis_to_points), Some(surface_to_points)] =
        spreads
    else {
        return Ok(None);
    };
    let fit = Fit { points_to_axis, points_to_surface, axis_to_points, surface_to_points };
    Ok(Some(Gaps { fit, of_points_m, of_nodes_m }))
}

/// Places on the bark, about as many, for the way from there to the points.
const SURFACE_SAMPLE: f64 = 40_000.0;

/// Places on the bark, evenly by area: thick wood has as many as it has bark.
fn on_surface(
    nodes: &[u32],
    ends: impl Fn(u32) -> [DVec3; 2],
    radius_m: &impl Fn(u32, f64) -> f64,
) -> Vec<DVec3> {
    /// The golden angle: turns that never repeat.
    const TURN_RAD: f64 = 2.399_963_229_728_653;
    let area = |&node: &u32| ends(node)[0].distance(ends(node)[1]) * radius_m(node, 0.5);
    let total: f64 = nodes.iter().map(area).sum();
    let mut places = Vec::new();
    let mut owed = 0.5;
    for &node in nodes {
        let [from, to] = ends(node);
        let share = area(&node) / total.max(f64::MIN_POSITIVE) * SURFACE_SAMPLE;
        let Some(along) = (to - from).try_normalize().filter(|_| share > 0.0) else { continue };
        let (u, v) = along.any_orthonormal_pair();
        let mut next = 1.0 - owed;
        owed += share;
        while owed >= 1.0 {
            owed -= 1.0;
            let t = (next / share).clamp(0.0, 1.0);
            next += 1.0;
            let turn = TURN_RAD * places.len() as f64;
            let out = u * libm::cos(turn) + v * libm::sin(turn);
            places.push(from.lerp(to, t) + out * radius_m(node, t));
        }
    }
    places
}

/// Points that [`share_near`] looks at.
const SHARE_SAMPLE: usize = 20_000;

/// How many of `points` lie within `within_m` of a branching's axes, of 1; of at most 20 000 taken evenly.
///
/// # Errors
/// [`Cancelled`].
pub fn share_near(
    branching: &Branching,
    points: &[Vec3],
    within_m: f64,
    monitor: &dyn Monitor,
) -> Result<f64, Cancelled> {
    let sample: Vec<Vec3> =
        points.iter().copied().step_by(points.len().div_ceil(SHARE_SAMPLE).max(1)).collect();
    let Some(segments) = Segments::new(&branching.positions, &branching.parents) else { return Ok(0.0) };
    let nearest = segments.nearest(&sample, monitor)?;
    let near = nearest.iter().filter(|n| n.distance_m <= within_m).count();
    Ok(near as f64 / sample.len().max(1) as f64)
}

/// Which nodes are the first of a lateral: its wood starts as thick as they are.
fn lateral_bases(skeleton: &Skeleton) -> Vec<bool> {
    let mut bases = vec![false; skeleton.positions.len()];
    for axis in skeleton.axes.iter().filter(|axis| axis.parent != NO_PARENT) {
        if let Some(&base) = skeleton.nodes_of(axis).first() {
            bases[base as usize] = true;
        }
    }
    bases
}

#[cfg(test)]
mod tests {
    use super::*;
    use linden_base::monitor::Quiet;
    use linden_base::random::Key;
    use linden_skeleton::{Branching, Wood};

    #[test]
    fn a_spread_is_mean_and_rank() {
        let spread = Spread::of((1..=100).rev().map(f64::from).collect()).unwrap();
        assert_eq!((spread.mean_m, spread.p95_m), (50.5, 95.0));
        assert_eq!(Spread::of(vec![3.0]).unwrap().p95_m, 3.0);
        assert!(Spread::of(Vec::new()).is_none());
    }

    /// A pole of 2 m and 0.1 m radius, points around it: 0.3 m from the axis, beyond the top too.
    #[test]
    fn distances_are_those_of_the_nearest_segment() {
        let branching = Branching {
            positions: vec![Vec3::ZERO, Vec3::Y * 2.0],
            parents: vec![NO_PARENT, 0],
            births: vec![0, 1],
            radii: None,
            edges: None,
        };
        let wood = Wood { base_radius_m: Some(0.1), ..Wood::default() };
        let skeleton = Skeleton::build(branching, &wood).unwrap();
        let mut points: Vec<Vec3> =
            (0..100).map(|i| Vec3::new(0.3, Key::new(1).child(i).unit() as f32 * 2.0, 0.0)).collect();
        points[7] = Vec3::new(0.0, 2.5, 0.0);
        points[8] = Vec3::new(-0.3, 1.0, 0.0);
        let Gaps { fit, of_points_m, of_nodes_m } = gaps(&points, &skeleton, &Quiet).unwrap().unwrap();
        assert!(
            (of_points_m[7] - 0.4).abs() < 1e-5 && (of_points_m[0] - 0.2).abs() < 1e-5,
            "{of_points_m:?}"
        );
        assert!(of_nodes_m[0] == 0.0 && (of_nodes_m[1] - 0.2).abs() < 1e-5, "{of_nodes_m:?}");
        let near = |a: f64, b: f64| (a - b).abs() < 1e-6;
        assert!(
            near(fit.points_to_axis.mean_m, (99.0 * 0.3 + 0.5) / 100.0)
                && near(fit.points_to_axis.p95_m, 0.3)
        );
        assert!(near(fit.points_to_surface.mean_m, (99.0 * 0.2 + 0.4) / 100.0));
        assert!(near(fit.axis_to_points.mean_m, 0.3));
        // From bark all around to points on one side, about: between 0.2 and 0.4 m, as much of each by area.
        let back = fit.surface_to_points;
        assert!((0.29..0.32).contains(&back.mean_m) && (0.38..0.42).contains(&back.p95_m), "{back:?}");
        assert_eq!(super::gaps(&[], &skeleton, &Quiet), Ok(None));
    }
}
