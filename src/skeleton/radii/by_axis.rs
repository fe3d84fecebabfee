//! Radii that follow the axes: a share per branching order, and tapers that are drawn per axis.

use glam::Vec3;
use rayon::prelude::*;

use super::{Span, THINNEST_PER_BASE, Wood};
use crate::{Axis, NO_PARENT};
use linden_base::random::Key;

/// The radii at both ends, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Ends {
    base: f64,
    /// Nothing is thinner.
    thinnest: f64,
}

impl Ends {
    /// For a tree of a height, metres. The base wins where the tips would be thicker.
    pub fn new(height_m: f64, wood: &Wood) -> Self {
        let base = wood.base_radius_m.unwrap_or_else(|| {
            // A thing without extent still has wood.
            wood.base_of_height(height_m).max(f64::from(f32::MIN_POSITIVE) / THINNEST_PER_BASE)
        });
        let thinnest = wood.tip_radius_m.unwrap_or(base * THINNEST_PER_BASE).min(base);
        Self { base, thinnest }
    }

    /// When the tree had reached a share of its height: its foot was as much thinner.
    pub fn when_grown(self, share: f64) -> Self {
        Self { base: (self.base * share.min(1.0)).max(self.thinnest), ..self }
    }
}

/// `base · ratio^order`: halved per branching order at 1/2.
pub(super) fn by_order(axes: &[Axis], axis_nodes: &[u32], ratio: f64, ends: &Ends) -> Vec<f32> {
    let most = axes.iter().map(|axis| axis.order).max().unwrap_or(0);
    let mut radius = ends.base;
    let mut of_order = Vec::new();
    // Orders beyond the first that is as thin as can be are as thin.
    for _ in 0..=most {
        of_order.push(radius.max(ends.thinnest) as f32);
        if ratio >= 1.0 || radius <= ends.thinnest {
            break;
        }
        radius *= ratio;
    }
    let last = of_order.len() - 1;
    let mut radii = vec![0.0; axis_nodes.len()];
    for axis in axes {
        for &node in nodes(axis, axis_nodes) {
            radii[node as usize] = of_order[last.min(axis.order as usize)];
        }
    }
    radii
}

/// Each axis' key: its parent axis' key and which of that axis' laterals it is, by index of their
/// first nodes. What is added elsewhere changes no other axis' key.
pub(crate) fn keys(axes: &[Axis], axis_nodes: &[u32], key: Key) -> Vec<Key> {
    let axis_of = axis_of(axes, axis_nodes);
    let mut laterals = vec![0_u64; axes.len()];
    let mut stems = 0;
    let mut keys: Vec<Key> = Vec::with_capacity(axes.len());
    for axis in axes {
        let (parent, count) = if axis.parent == NO_PARENT {
            (key, &mut stems)
        } else {
            let parent = axis_of[axis.parent as usize] as usize;
            (keys[parent], &mut laterals[parent])
        };
        let axis_key = parent.child(*count);
        *count += 1;
        keys.push(axis_key);
    }
    keys
}

/// Which axis each node stands in.
pub(crate) fn axis_of(axes: &[Axis], axis_nodes: &[u32]) -> Vec<u32> {
    let mut of = vec![0; axis_nodes.len()];
    for (index, axis) in axes.iter().enumerate() {
        for &node in nodes(axis, axis_nodes) {
            of[node as usize] = index as u32;
        }
    }
    of
}

fn nodes<'a>(axis: &Axis, axis_nodes: &'a [u32]) -> &'a [u32] {
    &axis_nodes[axis.first as usize..(axis.first + axis.len) as usize]
}

/// Straight tapers, as an earlier Unity program has them: an axis starts with a share of its
/// parent's radius where it leaves, a stem with the base radius, and ends with a share of its start.
///
/// Both shares are drawn per axis, uniformly in [`Wood::taper_base`] and [`Wood::taper_tip`]. The
/// radius falls linearly with the arc length from the axis' first node to its apex; an axis of one node
/// is as thick as the middle of such a taper.
pub(super) fn tapered(
    positions: &[Vec3],
    parents: &[u32],
    (axes, axis_nodes): (&[Axis], &[u32]),
    keys: &[Key],
    wood: &Wood,
    ends: &Ends,
) -> Vec<f32> {
    let draw = |key: Key, Span { min, max }| key.between(min.min(max), max.max(min)).clamp(0.0, 1.0);
    let shares: Vec<[f64; 2]> = keys
        .par_iter()
        .map(|key| {
            [draw(key.named("taper base"), wood.taper_base), draw(key.named("taper tip"), wood.taper_tip)]
        })
        .collect();
    let length = |node: u32| {
        let parent = parents[node as usize];
        f64::from(positions[node as usize].distance(positions[parent as usize]))
    };
    let mut radii = vec![0.0_f32; positions.len()];
    for (axis, [of_parent, of_base]) in axes.iter().zip(shares) {
        let nodes = nodes(axis, axis_nodes);
        let base = match axis.parent {
            NO_PARENT => ends.base,
            parent => f64::from(radii[parent as usize]) * of_parent,
        };
        let total: f64 = nodes[1..].iter().map(|&node| length(node)).sum();
        let mut along = 0.0;
        for (i, &node) in nodes.iter().enumerate() {
            if i > 0 {
                along += length(node);
            }
            let t = if nodes.len() == 1 {
                0.5
            } else if total > 0.0 {
                along / total
            } else {
                0.0
            };
            radii[node as usize] = (base * (1.0 + t * (of_base - 1.0))).max(ends.thinnest) as f32;
        }
    }
    radii
}
