//! How near trees come to the scans that they grew into.

use std::sync::Arc;

use glam::Vec3;
use linden_base::memory::bytes_of;

/// A scan, and how near the tree that grew into it came.
#[derive(Clone, Debug, PartialEq)]
pub struct Scanned {
    /// Points of the tree, metres, where it stands: those on wood, without ground, strays, noise
    /// and leaves.
    pub points: Arc<Vec<Vec3>>,
    /// How far each of them is from the bark, metres.
    pub gaps_m: Arc<Vec<f32>>,
    /// Points that were taken for leaves.
    pub leaf_points: usize,
    /// Nodes whose radius was measured on points; the others' are carried on or guessed.
    pub measured_nodes: usize,
    /// Distances both ways.
    pub fit: Fit,
}

impl Scanned {
    /// Bytes that its points take.
    pub fn bytes(&self) -> u64 {
        bytes_of::<Vec3>(self.points.capacity()) + bytes_of::<f32>(self.gaps_m.capacity())
    }
}

/// How far measured points and a skeleton are apart, one by one and in all.
#[derive(Clone, Debug, PartialEq)]
pub struct Gaps {
    /// In all.
    pub fit: Fit,
    /// From each point to the bark, metres.
    pub of_points_m: Vec<f32>,
    /// From the bark of the segment below each node to the nearest point, metres; 0 at nodes that have none below.
    pub of_nodes_m: Vec<f32>,
}

/// Distances between measured points and a skeleton, both ways. All are exact: to the nearest point of the
/// nearest segment, not to the nearest node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fit {
    /// From each scanned point to the nearest axis.
    pub points_to_axis: Spread,
    /// From each scanned point to the bark around the nearest axis: how far the distance to the axis is
    /// from the radius there.
    pub points_to_surface: Spread,
    /// From the middle of each segment to the nearest scanned point.
    pub axis_to_points: Spread,
    /// From places on the bark, evenly by area, to the nearest scanned point: wood that no point bears out.
    pub surface_to_points: Spread,
}

/// Many distances in two numbers, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spread {
    /// The mean.
    pub mean_m: f64,
    /// 95 % are not above it.
    pub p95_m: f64,
}

impl Spread {
    /// Of some distances, metres; `None` without any.
    pub fn of(mut distances: Vec<f64>) -> Option<Self> {
        // One after the other: the sum is the same on any number of threads.
        let mean_m = distances.iter().sum::<f64>() / distances.len() as f64;
        let rank = (distances.len() * 95).div_ceil(100).checked_sub(1)?;
        let (_, &mut p95_m, _) = distances.select_nth_unstable_by(rank, f64::total_cmp);
        Some(Self { mean_m, p95_m })
    }
}
