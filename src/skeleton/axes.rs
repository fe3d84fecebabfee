//! From nodes and parents to axes with orders.

use std::cmp::Ordering;

use glam::Vec3;

use super::bits::Bits;
use super::{Axis, Edge, NO_PARENT, Skeleton};
use linden_base::memory::bytes_of;

/// All axes (parents before laterals) and their nodes, axis by axis.
///
/// The child that succeeds its parent continues the axis. Without edges it is the greatest by `compare`
/// (the thicker one), among equals the straightest, then the first. What `compare` owns is freed before
/// the axes are laid out.
pub(super) fn decompose(
    positions: &[Vec3],
    parents: &[u32],
    edges: Option<&[Edge]>,
    compare: impl Fn(u32, u32) -> Ordering,
) -> (Vec<Axis>, Vec<u32>) {
    let mut next = match edges {
        Some(edges) => {
            drop(compare);
            said(parents, edges)
        }
        None => successors(positions, parents, None, compare),
    };
    let apexes = next.iter().filter(|&&successor| successor == NO_PARENT).count();
    let mut axes: Vec<Axis> = Vec::with_capacity(apexes);
    let mut axis_nodes: Vec<u32> = Vec::with_capacity(parents.len());
    // Bases come in index order, so that a lateral always comes after the axis it leaves from.
    for base in 0..parents.len() as u32 {
        // An entry holds the successor, a higher index, until its node stands in an axis, and the
        // axis' order from then on. An order is at most the number of nodes below, so never higher.
        if next[base as usize] <= base {
            continue;
        }
        let parent = parents[base as usize];
        let order = if parent == NO_PARENT { 0 } else { next[parent as usize] + 1 };
        let first = axis_nodes.len() as u32;
        let mut node = base;
        while node != NO_PARENT {
            axis_nodes.push(node);
            node = std::mem::replace(&mut next[node as usize], order);
        }
        axes.push(Axis { order, parent, first, len: axis_nodes.len() as u32 - first });
    }
    (axes, axis_nodes)
}

/// Where axes end though wood goes on: at nodes whose children a grammar brackets, all of them. Where axes go
/// by thickness there are none.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Forks {
    /// Nodes, in order.
    apices: Vec<u32>,
    /// Axes, in order.
    onward: Vec<u32>,
}

impl Forks {
    /// Finds those of a skeleton.
    pub fn new(skeleton: &Skeleton) -> Self {
        let Skeleton { parents, axes, .. } = skeleton;
        // Within an axis, each node but its last is succeeded: what leaves from a last one leaves from a fork.
        let mut ends = Bits::new(parents.len());
        let last = |axis: &Axis| skeleton.nodes_of(axis).last().copied();
        axes.iter().filter_map(last).for_each(|apex| ends.set(apex));
        let leave = |axis: &&Axis| axis.parent != NO_PARENT && ends.is_set(axis.parent);
        let mut apices: Vec<u32> = axes.iter().filter(leave).map(|axis| axis.parent).collect();
        if apices.is_empty() {
            return Self::default();
        }
        apices.sort_unstable();
        apices.dedup();
        Self { onward: onward(skeleton, &apices), apices }
    }

    /// Whether an axis ends at a node from where others leave.
    pub fn ends_at(&self, node: u32) -> bool {
        self.apices.binary_search(&node).is_ok()
    }

    /// Whether the wood of an axis that ended runs on into this one: the thickest that leaves there, among
    /// equals the straightest, then the first. It is as thick at its root as the other one at its end.
    pub fn runs_on(&self, axis: u32) -> bool {
        self.onward.binary_search(&axis).is_ok()
    }

    /// How many nodes [`Forks::ends_at`] holds for.
    pub fn len(&self) -> usize {
        self.apices.len()
    }

    /// Whether there is no such node.
    pub fn is_empty(&self) -> bool {
        self.apices.is_empty()
    }

    /// Bytes that they take.
    pub fn bytes(&self) -> u64 {
        bytes_of::<u32>(self.apices.capacity() + self.onward.capacity())
    }

    /// Bytes that those of a skeleton take at most while they are found.
    pub fn bytes_for(skeleton: &Skeleton) -> u64 {
        Bits::bytes_for(skeleton.parents.len()) + bytes_of::<[u32; 4]>(skeleton.axes.len())
    }
}

fn onward(skeleton: &Skeleton, apices: &[u32]) -> Vec<u32> {
    let Skeleton { positions, parents, axes, radii, .. } = skeleton;
    let base = |axis: u32| skeleton.nodes_of(&axes[axis as usize]).first().copied();
    let radius = |axis: u32| base(axis).map_or(0.0, |node| radii[node as usize]);
    let straight = |axis: u32| base(axis).map_or(-1.0, |node| straightness(positions, parents, node));
    let mut best: Vec<Option<u32>> = vec![None; apices.len()];
    for (index, axis) in (0..).zip(axes) {
        let Ok(place) = apices.binary_search(&axis.parent) else { continue };
        let wins = best[place].is_none_or(|rival| match radius(index).total_cmp(&radius(rival)) {
            Ordering::Greater => true,
            Ordering::Less => false,
            Ordering::Equal => straight(index) > straight(rival) + STRAIGHTER,
        });
        if wins {
            best[place] = Some(index);
        }
    }
    let mut onward: Vec<u32> = best.into_iter().flatten().collect();
    onward.sort_unstable();
    onward
}

/// For each node the child that succeeds it, [`NO_PARENT`] where there is none.
fn said(parents: &[u32], edges: &[Edge]) -> Vec<u32> {
    let mut next = vec![NO_PARENT; parents.len()];
    for (child, (&parent, &edge)) in (0..).zip(parents.iter().zip(edges)) {
        if parent != NO_PARENT && edge == Edge::Succeeds {
            next[parent as usize] = child;
        }
    }
    next
}

/// For each node the child to which its wood runs on, [`NO_PARENT`] at a tip: the one that succeeds it;
/// without edges, and where all children branch, the greatest by `compare`.
pub(super) fn successors(
    positions: &[Vec3],
    parents: &[u32],
    edges: Option<&[Edge]>,
    compare: impl Fn(u32, u32) -> Ordering,
) -> Vec<u32> {
    let succeeds = |node: u32| edges.is_some_and(|edges| edges[node as usize] == Edge::Succeeds);
    let mut best = vec![NO_PARENT; parents.len()];
    for child in 0..parents.len() as u32 {
        let parent = parents[child as usize];
        if parent == NO_PARENT {
            continue;
        }
        let rival = best[parent as usize];
        let wins = rival == NO_PARENT
            || match succeeds(child).cmp(&succeeds(rival)).then_with(|| compare(child, rival)) {
                Ordering::Greater => true,
                Ordering::Less => false,
                Ordering::Equal => {
                    straightness(positions, parents, child)
                        > straightness(positions, parents, rival) + STRAIGHTER
                }
            };
        if wins {
            best[parent as usize] = child;
        }
    }
    best
}

/// Two children that mirror each other differ by rounding only: the first of them is to win.
const STRAIGHTER: f32 = 1e-4;

/// Cosine of the angle between the segment that ends in a child and the one before it (straight up
/// below the first).
pub(super) fn straightness(positions: &[Vec3], parents: &[u32], child: u32) -> f32 {
    let parent = parents[child as usize];
    let grandparent = parents[parent as usize];
    let before = if grandparent == NO_PARENT {
        Vec3::Y
    } else {
        (positions[parent as usize] - positions[grandparent as usize]).normalize_or(Vec3::Y)
    };
    let after = (positions[child as usize] - positions[parent as usize]).normalize_or_zero();
    before.dot(after)
}

#[cfg(test)]
mod tests {
    use super::super::radii::pipe::count_tips;
    use super::*;
    use linden_base::random::Key;

    fn by_tips(tips: &[u32]) -> impl Fn(u32, u32) -> Ordering {
        |a, b| tips[a as usize].cmp(&tips[b as usize])
    }

    /// A random tree: each node hangs below an earlier one, some stand as roots of their own.
    fn random_tree(seed: u64, len: usize) -> (Vec<Vec3>, Vec<u32>) {
        let key = Key::new(seed);
        let mut positions = vec![Vec3::ZERO];
        let mut parents = vec![NO_PARENT];
        for i in 1..len {
            let k = key.child(i as u64);
            let parent = (k.child(0).unit() * i as f64) as u32;
            let step = Vec3::new(
                k.child(1).unit() as f32 - 0.5,
                k.child(2).unit() as f32,
                k.child(3).unit() as f32 - 0.5,
            );
            let is_root = k.child(4).unit() < 0.02;
            parents.push(if is_root { NO_PARENT } else { parent });
            positions.push(if is_root { step } else { positions[parent as usize] + step });
        }
        (positions, parents)
    }

    #[test]
    fn axes_partition_the_nodes_and_follow_the_definition() {
        for seed in 0..20 {
            let (positions, parents) = random_tree(seed, 300);
            let tips = count_tips(&parents);
            let (axes, nodes) = decompose(&positions, &parents, None, by_tips(&tips));

            let mut sorted = nodes.clone();
            sorted.sort_unstable();
            assert_eq!(sorted, (0..300).collect::<Vec<u32>>(), "each node stands in one axis");
            assert_eq!(axes.len(), parents.iter().filter(|&&p| p == NO_PARENT).count() + laterals(&parents));
            let mut order_of = vec![0; 300];
            for axis in &axes {
                let axis_nodes = &nodes[axis.first as usize..(axis.first + axis.len) as usize];
                assert_eq!(parents[axis_nodes[0] as usize], axis.parent);
                let expected = if axis.parent == NO_PARENT { 0 } else { order_of[axis.parent as usize] + 1 };
                assert_eq!(axis.order, expected);
                for pair in axis_nodes.windows(2) {
                    assert_eq!(parents[pair[1] as usize], pair[0]);
                    let siblings = (0..300_u32).filter(|&c| parents[c as usize] == pair[0]);
                    assert!(
                        siblings.map(|c| tips[c as usize]).max() <= Some(tips[pair[1] as usize]),
                        "the thickest continues"
                    );
                }
                for &node in axis_nodes {
                    order_of[node as usize] = axis.order;
                }
            }
        }
    }

    /// Children beyond the first of each node.
    fn laterals(parents: &[u32]) -> usize {
        let inner: std::collections::BTreeSet<u32> =
            parents.iter().copied().filter(|&p| p != NO_PARENT).collect();
        parents.iter().filter(|&&p| p != NO_PARENT).count() - inner.len()
    }

    #[test]
    fn among_equals_the_straightest_continues() {
        let positions = [(0., 0.), (0., 1.), (0.7, 1.7), (0.1, 2.)].map(|(x, y)| Vec3::new(x, y, 0.0));
        let parents = [NO_PARENT, 0, 1, 1];
        let (axes, nodes) = decompose(&positions, &parents, None, by_tips(&count_tips(&parents)));
        assert_eq!(nodes, [0, 1, 3, 2]);
        assert_eq!(axes[1], Axis { order: 1, parent: 1, first: 3, len: 1 });
    }
}
