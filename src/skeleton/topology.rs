//! How a tree branches: children, tips, paths, the orders of Horton and Strahler, branching angles.
//!
//! A segment is named by the node that it ends in, as everywhere in this crate; the foot of a stem ends none.

use std::collections::BTreeMap;

use glam::DVec3;
use linden_base::memory::bytes_of;

use super::radii::by_axis;
use super::{NO_PARENT, Skeleton};

/// The children of all nodes, in one list.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Children {
    /// Where each node's children end in `nodes`.
    ends: Vec<u32>,
    nodes: Vec<u32>,
}

impl Children {
    /// The nodes that grow from a node, in ascending order.
    pub fn of(&self, node: usize) -> &[u32] {
        let first = if node == 0 { 0 } else { self.ends[node - 1] };
        &self.nodes[first as usize..self.ends[node] as usize]
    }
}

/// The streams of one order of Strahler: chains of segments of that order, end to end.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Streams {
    /// How many there are.
    pub count: usize,
    /// Their mean length, metres.
    pub mean_length_m: f64,
}

/// The angle at which a lateral leaves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BranchingAngle {
    /// Index of the lateral among [`Skeleton::axes`].
    pub axis: u32,
    /// 0: straight on; up to π.
    pub angle_rad: f64,
}

impl Skeleton {
    /// The children of all nodes.
    ///
    /// ```
    /// # use glam::Vec3;
    /// # use linden_skeleton::{Branching, NO_PARENT, Skeleton};
    /// # let fork = Branching {
    /// #     positions: vec![Vec3::ZERO, Vec3::Y, Vec3::Y * 2.0, Vec3::new(1.0, 2.0, 0.0)],
    /// #     parents: vec![NO_PARENT, 0, 1, 1],
    /// #     births: vec![0; 4],
    /// #     radii: None,
    /// #     edges: None,
    /// # };
    /// let tree = Skeleton::build(fork, &Default::default())?; // 0 - 1 - 2 and 1 - 3
    /// let children = tree.children();
    /// assert_eq!((children.of(0), children.of(1), children.of(2)), (&[1][..], &[2, 3][..], &[][..]));
    /// # Ok::<(), linden_skeleton::SkeletonError>(())
    /// ```
    pub fn children(&self) -> Children {
        let mut ends = vec![0_u32; self.parents.len()];
        for &parent in self.parents.iter().filter(|&&parent| parent != NO_PARENT) {
            ends[parent as usize] += 1;
        }
        let mut sum = 0;
        for end in &mut ends {
            sum += *end;
            *end = sum;
        }
        let mut nodes = vec![0; sum as usize];
        // From the back, each list's end moves to its start, where the list before it ends.
        let mut next = ends.clone();
        for (node, &parent) in
            self.parents.iter().enumerate().rev().filter(|(_, parent)| **parent != NO_PARENT)
        {
            next[parent as usize] -= 1;
            nodes[next[parent as usize] as usize] = node as u32;
        }
        Children { ends, nodes }
    }

    /// The axis of each node, as an index of [`Skeleton::axes`].
    pub fn axis_of_nodes(&self) -> Vec<u32> {
        by_axis::axis_of(&self.axes, &self.axis_nodes)
    }

    /// The order of each node's axis: 0 on stems.
    pub fn orders(&self) -> Vec<u32> {
        let mut orders = vec![0; self.positions.len()];
        for axis in &self.axes {
            self.nodes_of(axis).iter().for_each(|&node| orders[node as usize] = axis.order);
        }
        orders
    }

    /// The nodes that end a segment and have no children, in ascending order.
    ///
    /// ```
    /// # use glam::Vec3;
    /// # use linden_skeleton::{Branching, NO_PARENT, Skeleton};
    /// # let fork = Branching {
    /// #     positions: vec![Vec3::ZERO, Vec3::Y, Vec3::Y * 2.0, Vec3::new(3.0, 1.0, 0.0)],
    /// #     parents: vec![NO_PARENT, 0, 1, 1],
    /// #     births: vec![0; 4],
    /// #     radii: None,
    /// #     edges: None,
    /// # };
    /// let tree = Skeleton::build(fork, &Default::default())?; // 2 m up; at 1 m a lateral of 3 m
    /// assert_eq!(tree.tips(), [2, 3]);
    /// assert_eq!(tree.path_lengths_m(), [0.0, 1.0, 2.0, 4.0]);
    /// assert_eq!(tree.strahler(), [2, 2, 1, 1]);
    /// # Ok::<(), linden_skeleton::SkeletonError>(())
    /// ```
    pub fn tips(&self) -> Vec<u32> {
        let mut bears = vec![false; self.parents.len()];
        for &parent in self.parents.iter().filter(|&&parent| parent != NO_PARENT) {
            bears[parent as usize] = true;
        }
        let is_tip = |&node: &u32| !bears[node as usize] && self.parents[node as usize] != NO_PARENT;
        (0..self.parents.len() as u32).filter(is_tip).collect()
    }

    /// The length of the wood from the foot to each node, metres.
    pub fn path_lengths_m(&self) -> Vec<f64> {
        let mut paths = vec![0.0; self.parents.len()];
        for (node, &parent) in self.parents.iter().enumerate().filter(|(_, parent)| **parent != NO_PARENT) {
            paths[node] = paths[parent as usize] + self.segment_length(node);
        }
        paths
    }

    /// The order of Strahler of the segment that ends in each node (for a foot: that a segment below it would have).
    ///
    /// 1 for what bears nothing; otherwise the highest order among the children, and one more where two or more of
    /// them have it (Strahler 1957, *Quantitative analysis of watershed geomorphology*).
    pub fn strahler(&self) -> Vec<u32> {
        let mut orders = vec![0_u32; self.parents.len()];
        // Whether several children have the highest order so far.
        let mut meets = vec![false; self.parents.len()];
        for node in (0..self.parents.len()).rev() {
            // Children come after their parent: all of this node's are done.
            let order = (orders[node] + u32::from(meets[node])).max(1);
            orders[node] = order;
            let parent = self.parents[node];
            if parent != NO_PARENT {
                let (highest, meets) = (&mut orders[parent as usize], &mut meets[parent as usize]);
                *meets = if order > *highest { false } else { *meets || order == *highest };
                *highest = order.max(*highest);
            }
        }
        orders
    }

    /// The streams of each order of Strahler, from order 1 on: number and mean length (Horton 1945, *Erosional
    /// development of streams and their drainage basins*).
    ///
    /// ```
    /// # use glam::Vec3;
    /// # use linden_skeleton::{Branching, NO_PARENT, Skeleton};
    /// # let fork = Branching {
    /// #     positions: vec![Vec3::ZERO, Vec3::Y, Vec3::Y * 2.0, Vec3::new(3.0, 1.0, 0.0)],
    /// #     parents: vec![NO_PARENT, 0, 1, 1],
    /// #     births: vec![0; 4],
    /// #     radii: None,
    /// #     edges: None,
    /// # };
    /// let tree = Skeleton::build(fork, &Default::default())?; // 2 m up; at 1 m a lateral of 3 m
    /// let streams = tree.streams();
    /// assert_eq!((streams[0].count, streams[0].mean_length_m), (2, 2.0));
    /// assert_eq!((streams[1].count, streams[1].mean_length_m), (1, 1.0));
    /// # Ok::<(), linden_skeleton::SkeletonError>(())
    /// ```
    pub fn streams(&self) -> Vec<Streams> {
        let orders = self.strahler();
        let mut streams: Vec<Streams> = Vec::new();
        for (node, &parent) in self.parents.iter().enumerate().filter(|(_, parent)| **parent != NO_PARENT) {
            let order = orders[node] as usize;
            if streams.len() < order {
                streams.resize(order, Streams::default());
            }
            let stream = &mut streams[order - 1];
            stream.mean_length_m += self.segment_length(node);
            // It goes on down while the order stays; nothing goes on below a foot.
            let is_lowest =
                self.parents[parent as usize] == NO_PARENT || orders[parent as usize] != orders[node];
            stream.count += usize::from(is_lowest);
        }
        for stream in &mut streams {
            stream.mean_length_m /= stream.count.max(1) as f64;
        }
        streams
    }

    /// The angle of each lateral: between its first segment and the segment of its parent axis that ends where it
    /// leaves (that begins there, at the foot of a stem). Laterals without such segments of some length have none.
    ///
    /// ```
    /// # use glam::Vec3;
    /// # use linden_skeleton::{Branching, NO_PARENT, Skeleton};
    /// # let fork = Branching {
    /// #     positions: vec![Vec3::ZERO, Vec3::Y, Vec3::Y * 2.0, Vec3::new(3.0, 1.0, 0.0)],
    /// #     parents: vec![NO_PARENT, 0, 1, 1],
    /// #     births: vec![0; 4],
    /// #     radii: None,
    /// #     edges: None,
    /// # };
    /// let tree = Skeleton::build(fork, &Default::default())?; // a lateral leaves square
    /// let angles = tree.branching_angles();
    /// assert_eq!((angles[0].axis, angles[0].angle_rad.to_degrees().round()), (1, 90.0));
    /// # Ok::<(), linden_skeleton::SkeletonError>(())
    /// ```
    pub fn branching_angles(&self) -> Vec<BranchingAngle> {
        let at = |node: u32| self.positions[node as usize].as_dvec3();
        // What follows each foot on its own axis.
        let stems = self.axes.iter().filter(|axis| axis.parent == NO_PARENT);
        let after_foot: BTreeMap<u32, u32> = stems
            .filter_map(|stem| match self.nodes_of(stem) {
                [foot, next, ..] => Some((*foot, *next)),
                _ => None,
            })
            .collect();
        let laterals = (0..).zip(&self.axes).filter(|(_, axis)| axis.parent != NO_PARENT);
        let angles = laterals.filter_map(|(index, axis)| {
            let (node, &first) = (axis.parent, self.nodes_of(axis).first()?);
            let before = match self.parents[node as usize] {
                NO_PARENT => at(*after_foot.get(&node)?) - at(node),
                below => at(node) - at(below),
            };
            Some(BranchingAngle { axis: index, angle_rad: between(before, at(first) - at(node))? })
        });
        angles.collect()
    }

    /// Bytes that the lists of this module take at once at most.
    pub fn topology_bytes(&self) -> u64 {
        bytes_of::<[f64; 2]>(self.positions.len()) + bytes_of::<BranchingAngle>(self.axes.len())
    }
}

/// The angle between two directions; `None` where one of them has no length.
fn between(a: DVec3, b: DVec3) -> Option<f64> {
    let (across, along) = (a.cross(b).length(), a.dot(b));
    (a != DVec3::ZERO && b != DVec3::ZERO).then(|| libm::atan2(across, along))
}

/// The factor by which values change from one order to the next, by regression of their logarithms on the order:
/// the law of stream numbers and that of stream lengths (Horton 1945). `None` for fewer than two values, and where
/// one is not above zero.
///
/// ```
/// use linden_skeleton::ratio_of_orders;
/// assert!((ratio_of_orders(&[27.0, 9.0, 3.0, 1.0]).unwrap() - 1.0 / 3.0).abs() < 1e-12);
/// assert_eq!(ratio_of_orders(&[4.0]), None);
/// ```
pub fn ratio_of_orders(values: &[f64]) -> Option<f64> {
    if values.len() < 2 || values.iter().any(|value| !(*value > 0.0)) {
        return None;
    }
    let count = values.len() as f64;
    let logs: Vec<f64> = values.iter().map(|&value| libm::log(value)).collect();
    let (mean_order, mean_log) = ((count - 1.0) / 2.0, logs.iter().sum::<f64>() / count);
    let of_order = |order: usize| order as f64 - mean_order;
    let upper: f64 = logs.iter().enumerate().map(|(order, log)| of_order(order) * (log - mean_log)).sum();
    let lower: f64 = (0..logs.len()).map(|order| of_order(order) * of_order(order)).sum();
    Some(libm::exp(upper / lower))
}
