//! What a forester would measure.

use super::{NO_PARENT, Skeleton};
use linden_base::mesh::Bounds;

/// Breast height, where trunks are measured by convention.
const BREAST_HEIGHT_M: f64 = 1.3;

/// Lengths in metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measures {
    /// Sum of all segments.
    pub total_length_m: f64,
    /// Highest node above the lowest one.
    pub height_m: f64,
    /// Mean of the extents along X and Z.
    pub crown_width_m: f64,
    /// Of the thickest stem, 1.3 m above its foot along the stem (at its foot when it is shorter).
    pub trunk_diameter_m: f64,
    /// Of all wood, segment by segment, cubic metres: [`super::Cylinder`]s, overlaps at forks counted twice.
    pub wood_volume_m3: f64,
    /// Highest axis order.
    pub max_order: u32,
}

impl Skeleton {
    /// Measures the tree.
    pub fn measures(&self) -> Measures {
        let size = Bounds::of(self.positions.iter().copied()).map_or(glam::Vec3::ZERO, Bounds::size);
        Measures {
            total_length_m: (0..self.parents.len()).map(|node| self.segment_length(node)).sum(),
            height_m: f64::from(size.y),
            crown_width_m: f64::midpoint(f64::from(size.x), f64::from(size.z)),
            trunk_diameter_m: self.trunk_diameter(),
            wood_volume_m3: self.wood_volume_m3(),
            max_order: self.axes.iter().map(|a| a.order).max().unwrap_or(0),
        }
    }

    /// Length of the segment that ends in a node, 0 for the foot of a stem.
    fn segment_length(&self, node: usize) -> f64 {
        match self.parents[node] {
            NO_PARENT => 0.0,
            parent => f64::from(self.positions[node].distance(self.positions[parent as usize])),
        }
    }

    fn trunk_diameter(&self) -> f64 {
        let foot_radius = |axis: &super::Axis| self.radii[self.nodes_of(axis)[0] as usize];
        let Some(stem) = self
            .axes
            .iter()
            .filter(|a| a.parent == NO_PARENT)
            .max_by(|a, b| foot_radius(a).total_cmp(&foot_radius(b)))
        else {
            return 0.0;
        };
        let mut along = 0.0;
        for pair in self.nodes_of(stem).windows(2) {
            let length = self.segment_length(pair[1] as usize);
            if along + length >= BREAST_HEIGHT_M && length > 0.0 {
                let t = (BREAST_HEIGHT_M - along) / length;
                let [below, above] = [pair[0], pair[1]].map(|n| f64::from(self.radii[n as usize]));
                return 2.0 * (below + (above - below) * t);
            }
            along += length;
        }
        2.0 * f64::from(foot_radius(stem))
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use crate::{Branching, NO_PARENT, Skeleton, Wood};

    #[test]
    fn a_pole_with_one_branch() {
        let branching = Branching {
            positions: vec![Vec3::ZERO, Vec3::Y, Vec3::Y * 2.0, Vec3::new(3.0, 1.0, 0.0)],
            parents: vec![NO_PARENT, 0, 1, 1],
            births: vec![0; 4],
            radii: None,
            edges: None,
        };
        let wood = Wood { radius_exponent: 1.0, tip_radius_m: Some(0.1), ..Wood::default() };
        let skeleton = Skeleton::build(branching, &wood).unwrap();
        let m = skeleton.measures();
        assert_eq!((m.total_length_m, m.height_m, m.crown_width_m, m.max_order), (5.0, 2.0, 1.5, 1));
        // Radius 0.2 up to 1 m, 0.1 at 2 m: 0.17 at 1.3 m.
        assert!((m.trunk_diameter_m - 0.34).abs() < 1e-6);
    }
}
