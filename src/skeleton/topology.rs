//! How a tree branches: children, tips, paths, the orders of Horton and Strahler, branching angles.
//!
//! A segment is named by the node that it ends in, as everywhere in this crate; the foot of a stem ends none.

use std::cmp::Ordering;
use std::collections::BTreeMap;

use glam::DVec3;
use linden_base::memory::bytes_of;
use rayon::prelude::*;

use super::bits::Bits;
use super::radii::by_axis;
use super::{Axis, NO_PARENT, Skeleton};

/// The children of all nodes, in one list.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Children {
    /// Where each node's children end in `nodes`.
    ends: Vec<u32>,
    nodes: Vec<u32>,
}

impl Children {
    /// The nodes that grow from a node, in ascending order.
    ///
    /// # Panics
    /// Where the tree has no such node: `node` is below the length of [`Skeleton::positions`].
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
        let bears = self.bears();
        (0..self.parents.len() as u32).filter(|&node| self.is_tip(node, &bears)).collect()
    }

    /// Whether each node has children.
    fn bears(&self) -> Bits {
        let mut bears = Bits::new(self.parents.len());
        self.parents.iter().filter(|&&parent| parent != NO_PARENT).for_each(|&parent| bears.set(parent));
        bears
    }

    fn is_tip(&self, node: u32, bears: &Bits) -> bool {
        !bears.is_set(node) && self.parents[node as usize] != NO_PARENT
    }

    /// The length of the wood from the foot to each of [`Skeleton::tips`], metres: how many there are, the sum in
    /// their order, and the greatest.
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
    /// assert_eq!(tree.paths_to_tips_m(), (2, 2.0 + 4.0, 4.0));
    /// # Ok::<(), linden_skeleton::SkeletonError>(())
    /// ```
    pub fn paths_to_tips_m(&self) -> (usize, f64, f64) {
        let (bears, paths) = (self.bears(), self.path_lengths_m());
        let tips = (0..).zip(&paths).filter(|(node, _)| self.is_tip(*node, &bears));
        tips.fold((0, 0.0, 0.0), |(count, sum, most), (_, &path)| (count + 1, sum + path, path.max(most)))
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
        self.strahler_orders().into_iter().map(u32::from).collect()
    }

    /// The same in a byte each: with every order twice as many segments are needed at least.
    fn strahler_orders(&self) -> Vec<u8> {
        /// Several children have the highest order so far.
        const MEETS: u8 = 1 << 7;
        let mut orders = vec![0_u8; self.parents.len()];
        for node in (0..self.parents.len()).rev() {
            // Children come after their parent: all of this node's are done.
            let found = orders[node];
            let order = ((found & !MEETS) + u8::from(found & MEETS != 0)).max(1);
            orders[node] = order;
            let parent = self.parents[node];
            if parent != NO_PARENT {
                let highest = &mut orders[parent as usize];
                match order.cmp(&(*highest & !MEETS)) {
                    Ordering::Greater => *highest = order,
                    Ordering::Equal => *highest |= MEETS,
                    Ordering::Less => {}
                }
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
        let orders = self.strahler_orders();
        let mut streams: Vec<Streams> = Vec::new();
        for (node, &parent) in self.parents.iter().enumerate().filter(|(_, parent)| **parent != NO_PARENT) {
            let order = usize::from(orders[node]);
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
        let known = (0..).zip(self.angles_of_axes()).filter(|(_, angle_rad)| !angle_rad.is_nan());
        known.map(|(axis, angle_rad)| BranchingAngle { axis, angle_rad }).collect()
    }

    /// The same of each of [`Skeleton::axes`]; no number for stems, and for laterals that have no angle.
    pub fn angles_of_axes(&self) -> Vec<f64> {
        let at = |node: u32| self.positions[node as usize].as_dvec3();
        // What follows each foot on its own axis.
        let stems = self.axes.iter().filter(|axis| axis.parent == NO_PARENT);
        let after_foot: BTreeMap<u32, u32> = stems
            .filter_map(|stem| match self.nodes_of(stem) {
                [foot, next, ..] => Some((*foot, *next)),
                _ => None,
            })
            .collect();
        let angle = |axis: &Axis| {
            let (node, &first) = (axis.parent, self.nodes_of(axis).first()?);
            if node == NO_PARENT {
                return None;
            }
            let before = match self.parents[node as usize] {
                NO_PARENT => at(*after_foot.get(&node)?) - at(node),
                below => at(node) - at(below),
            };
            between(before, at(first) - at(node))
        };
        self.axes.par_iter().map(|axis| angle(axis).unwrap_or(f64::NAN)).collect()
    }

    /// Bytes that the lists of this module take at once at most.
    pub fn topology_bytes(&self) -> u64 {
        bytes_of::<f64>(self.positions.len() + self.axes.len()) + 2 * Bits::bytes_for(self.positions.len())
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

#[cfg(test)]
mod tests {
    use glam::Vec3;
    use linden_base::random::Key;

    use super::*;
    use crate::{Branching, Edge, Forks, Wood};

    /// A random tree in which some nodes have all their children in brackets.
    fn bracketed(seed: u64) -> Skeleton {
        let key = Key::new(seed);
        let mut branching = Branching {
            positions: vec![Vec3::ZERO],
            parents: vec![NO_PARENT],
            births: vec![0],
            radii: None,
            edges: None,
        };
        let mut edges = vec![Edge::Succeeds];
        let mut continues = [false; 200];
        for node in 1..200_u32 {
            let key = key.child(node.into());
            let drawn = |name| key.named(name);
            let parent = if drawn("on").unit() < 0.6 {
                node - 1
            } else {
                (drawn("at").unit() * f64::from(node)) as u32
            };
            let component = |name| drawn(name).between(-1.0, 1.0) as f32;
            let step = Vec3::new(component("x"), component("y") + 0.5, component("z"));
            branching.positions.push(branching.positions[parent as usize] + step);
            branching.parents.push(parent);
            branching.births.push(0);
            let succeeds = !continues[parent as usize] && drawn("edge").unit() < 0.7;
            continues[parent as usize] |= succeeds;
            edges.push(if succeeds { Edge::Succeeds } else { Edge::Branches });
        }
        branching.edges = Some(edges);
        Skeleton::build(branching, &Wood::default()).unwrap()
    }

    #[test]
    fn forks_are_where_an_axis_ends_and_others_leave() {
        let mut found = 0;
        for seed in 0..40 {
            let skeleton = bracketed(seed);
            let (forks, children) = (Forks::new(&skeleton), skeleton.children());
            let is_last =
                |node| skeleton.axes.iter().any(|axis| skeleton.nodes_of(axis).last() == Some(&node));
            let by_definition = |node: &u32| is_last(*node) && !children.of(*node as usize).is_empty();
            let nodes: Vec<u32> = (0..200).filter(by_definition).collect();
            assert_eq!(
                (0..200).filter(|node| forks.ends_at(*node)).collect::<Vec<u32>>(),
                nodes,
                "seed {seed}"
            );
            assert_eq!(forks.len(), nodes.len());
            found += nodes.len();
        }
        assert!(found > 400, "{found} forks");
    }

    #[test]
    fn orders_paths_and_angles_are_what_their_definitions_say() {
        for seed in 0..40 {
            let skeleton = bracketed(seed);
            let children = skeleton.children();
            let orders = skeleton.strahler();
            for (node, &order) in orders.iter().enumerate() {
                let above: Vec<u32> = children.of(node).iter().map(|&child| orders[child as usize]).collect();
                let most = above.iter().copied().max().unwrap_or(0);
                let meets = above.iter().filter(|&&order| order == most).count() > 1;
                assert_eq!(order, (most + u32::from(meets)).max(1), "seed {seed}, node {node}");
            }
            let (tips, paths) = (skeleton.tips(), skeleton.path_lengths_m());
            let to_tips = || tips.iter().map(|&tip| paths[tip as usize]);
            let sums =
                (tips.len(), to_tips().fold(0.0, |sum, path| sum + path), to_tips().fold(0.0, f64::max));
            assert_eq!(skeleton.paths_to_tips_m(), sums, "seed {seed}");
            let of_axes = skeleton.angles_of_axes();
            assert_eq!(of_axes.len(), skeleton.axes.len());
            let angles = skeleton.branching_angles();
            let is_known = |axis: &&Axis| skeleton.parents[axis.parent as usize] != NO_PARENT;
            let laterals = skeleton.axes.iter().filter(|axis| axis.parent != NO_PARENT);
            assert!(angles.len() >= laterals.filter(is_known).count(), "seed {seed}");
            for BranchingAngle { axis, angle_rad } in angles {
                assert_eq!(angle_rad, of_axes[axis as usize]);
                let axis = skeleton.axes[axis as usize];
                let at = |node: u32| skeleton.positions[node as usize];
                let below = skeleton.parents[axis.parent as usize];
                if below != NO_PARENT {
                    let first = skeleton.nodes_of(&axis)[0];
                    let angle = (at(axis.parent) - at(below)).angle_between(at(first) - at(axis.parent));
                    assert!((f64::from(angle) - angle_rad).abs() < 1e-3, "seed {seed}: {angle} {angle_rad}");
                }
            }
        }
    }
}
