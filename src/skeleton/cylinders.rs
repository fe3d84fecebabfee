//! The tree as cylinders, one per segment: what forestry calls a quantitative structure model.
//!
//! After the tables of `TreeQSM` (Raumonen et al. 2013, *Fast automatic precision tree models from
//! terrestrial laser scanner data*): each cylinder knows the one below it, its branch and its place
//! there.

use glam::Vec3;

use super::{Axis, Forks, NO_PARENT, Skeleton, WidthSteps};

/// One segment as a cylinder; metres, Y up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cylinder {
    /// The node that the segment ends in.
    pub node: u32,
    /// The node that it begins at: known also where no cylinder ends, at the foot of a stem.
    pub parent_node: u32,
    /// Index of the cylinder below among all of the tree; `None` at the foot of a stem.
    pub parent: Option<u32>,
    /// Index of the axis.
    pub axis: u32,
    /// How many cylinders of the axis come before.
    pub place: u32,
    /// Centre of the lower end.
    pub start: Vec3,
    /// Unit vector from the lower end to the upper; up for a segment without length.
    pub direction: Vec3,
    /// Above or equal to zero.
    pub length_m: f32,
    /// Of the cylinder that holds as much wood as the frustum between the nodes' radii. A lateral
    /// starts as thick as its first node, not as its parent, unless it goes on where that axis ended.
    pub radius_m: f32,
    /// Of that frustum, at its lower end and at its upper one.
    pub end_radii_m: [f32; 2],
}

impl Cylinder {
    /// Its volume.
    pub fn volume_m3(&self) -> f64 {
        volume_m3(self.length_m, self.radius_m)
    }
}

fn volume_m3(length_m: f32, radius_m: f32) -> f64 {
    let radius_m = f64::from(radius_m);
    std::f64::consts::PI * radius_m * radius_m * f64::from(length_m)
}

impl Skeleton {
    /// All segments as cylinders, axis by axis from base to apex: parents before children.
    ///
    /// ```
    /// use glam::Vec3;
    /// use linden_skeleton::{Branching, NO_PARENT, Skeleton, Wood};
    /// let pole = Branching {
    ///     positions: vec![Vec3::ZERO, Vec3::Y * 2.0],
    ///     parents: vec![NO_PARENT, 0],
    ///     births: vec![0, 1],
    ///     radii: None,
    ///     edges: None,
    /// };
    /// let wood = Wood { base_radius_m: Some(0.5), ..Wood::default() };
    /// let cylinders = Skeleton::build(pole, &wood)?.cylinders();
    /// assert_eq!((cylinders[0].length_m, cylinders[0].radius_m), (2.0, 0.5));
    /// # Ok::<(), linden_skeleton::SkeletonError>(())
    /// ```
    pub fn cylinders(&self) -> Vec<Cylinder> {
        let mut cylinders: Vec<Cylinder> = Vec::with_capacity(self.positions.len());
        let forks = Forks::new(self);
        // The cylinder that ends in each node.
        let mut ends_in = vec![None; self.positions.len()];
        for (index, axis) in (0..).zip(&self.axes) {
            let runs_on = forks.runs_on(index);
            for (place, [from, to]) in (0..).zip(self.segments_of(axis)) {
                let (start, end) = (self.positions[from as usize], self.positions[to as usize]);
                let (length_m, radius_m) = self.cylinder_size((axis, runs_on), [from, to]);
                ends_in[to as usize] = Some(cylinders.len() as u32);
                cylinders.push(Cylinder {
                    node: to,
                    parent_node: from,
                    parent: ends_in[from as usize],
                    axis: index,
                    place,
                    start,
                    direction: (end - start).normalize_or(Vec3::Y),
                    length_m,
                    radius_m,
                    end_radii_m: [self.lower_radius((axis, runs_on), [from, to]), self.radii[to as usize]],
                });
            }
        }
        cylinders
    }

    /// Axis, length and radius of all [`cylinders`](Self::cylinders), in their order, without making a list of them.
    pub fn cylinder_sizes<'a>(&'a self, forks: &'a Forks) -> impl Iterator<Item = (&'a Axis, f32, f32)> {
        let axes = (0..).zip(&self.axes).map(move |(index, axis)| (axis, forks.runs_on(index)));
        let segments = axes.flat_map(|axis| self.segments_of(axis.0).map(move |ends| (axis, ends)));
        segments.map(|(axis, ends)| {
            let (length_m, radius_m) = self.cylinder_size(axis, ends);
            (axis.0, length_m, radius_m)
        })
    }

    /// What all [`cylinders`](Self::cylinders) hold.
    pub(super) fn wood_volume_m3(&self, forks: &Forks) -> f64 {
        self.cylinder_sizes(forks).map(|(_, length_m, radius_m)| volume_m3(length_m, radius_m)).sum()
    }

    /// Length and radius of the cylinder for a segment of an axis.
    fn cylinder_size(&self, axis: (&Axis, bool), [from, to]: [u32; 2]) -> (f32, f32) {
        let upper = f64::from(self.radii[to as usize]);
        let lower = f64::from(self.lower_radius(axis, [from, to]));
        let squared = (lower * lower + lower * upper + upper * upper) / 3.0;
        (self.positions[from as usize].distance(self.positions[to as usize]), squared.sqrt() as f32)
    }

    /// A lateral is as thick where it begins as at its first node, but where the wood of an axis that ended
    /// [runs on](Forks::runs_on) into it; where radii go in steps, all segments are.
    fn lower_radius(&self, (axis, runs_on): (&Axis, bool), [from, to]: [u32; 2]) -> f32 {
        let is_even = self.width_steps == WidthSteps::Cylinder || (from == axis.parent && !runs_on);
        self.radii[if is_even { to } else { from } as usize]
    }

    /// The two nodes of each segment of an axis, base to apex, from the node that the axis leaves from.
    fn segments_of<'a>(&'a self, axis: &'a Axis) -> impl Iterator<Item = [u32; 2]> + 'a {
        let nodes = self.nodes_of(axis);
        let first = nodes.first().filter(|_| axis.parent != NO_PARENT).map(|&first| [axis.parent, first]);
        first.into_iter().chain(nodes.windows(2).map(|pair| [pair[0], pair[1]]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Branching, Wood};

    /// A pole of 2 m, a lateral from its middle with one from its foot.
    fn skeleton() -> Skeleton {
        let branching = Branching {
            positions: vec![Vec3::ZERO, Vec3::Y, Vec3::Y * 2.0, Vec3::new(3.0, 1.0, 0.0), Vec3::X],
            parents: vec![NO_PARENT, 0, 1, 1, 0],
            births: vec![0; 5],
            radii: None,
            edges: None,
        };
        let wood = Wood { radius_exponent: 1.0, tip_radius_m: Some(0.1), ..Wood::default() };
        Skeleton::build(branching, &wood).unwrap()
    }

    #[test]
    fn each_segment_is_one_cylinder_on_the_one_below() {
        let skeleton = skeleton();
        let cylinders = skeleton.cylinders();
        let rows: Vec<_> = cylinders.iter().map(|c| (c.node, c.parent, c.axis, c.place)).collect();
        assert_eq!(rows, [(1, None, 0, 0), (2, Some(0), 0, 1), (3, Some(0), 1, 0), (4, None, 2, 0)]);
        assert_eq!(cylinders.len(), skeleton.segments());
        for c in &cylinders {
            let end = c.start + c.direction * c.length_m;
            assert!(end.distance(skeleton.positions[c.node as usize]) < 1e-6);
        }
    }

    #[test]
    fn cylinders_hold_what_the_frusta_hold() {
        let skeleton = skeleton();
        let cylinders = skeleton.cylinders();
        let sum: f64 = cylinders.iter().map(Cylinder::volume_m3).sum();
        assert_eq!(skeleton.measures().wood_volume_m3, sum);
        // One pipe a tip: radii 0.3 at the foot, 0.2 in the middle, 0.1 at the tips.
        let frustum = |a: f64, b: f64, h: f64| std::f64::consts::PI * h * (a * a + a * b + b * b) / 3.0;
        let expected =
            [frustum(0.3, 0.2, 1.0), frustum(0.2, 0.1, 1.0), frustum(0.1, 0.1, 3.0), frustum(0.1, 0.1, 1.0)];
        for (c, expected) in cylinders.iter().zip(expected) {
            assert!((c.volume_m3() / expected - 1.0).abs() < 1e-5, "{c:?}: {expected}");
        }
    }
}
