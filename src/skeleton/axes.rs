//! From nodes and parents to axes with orders.

use std::cmp::Ordering;

use glam::Vec3;

use super::{Axis, NO_PARENT};

/// All axes (parents before laterals) and their nodes, axis by axis.
///
/// The greatest child by `compare` (the thicker one) continues the axis; among equals the
/// straightest, then the first. What `compare` owns is freed before the axes are laid out.
pub(super) fn decompose(
    positions: &[Vec3],
    parents: &[u32],
    compare: impl Fn(u32, u32) -> Ordering,
) -> (Vec<Axis>, Vec<u32>) {
    let mut next = successors(positions, parents, compare);
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

/// For each node the child that continues its axis, [`NO_PARENT`] at an apex.
pub(super) fn successors(
    positions: &[Vec3],
    parents: &[u32],
    compare: impl Fn(u32, u32) -> Ordering,
) -> Vec<u32> {
    let mut best = vec![NO_PARENT; parents.len()];
    for child in 0..parents.len() as u32 {
        let parent = parents[child as usize];
        if parent == NO_PARENT {
            continue;
        }
        let rival = best[parent as usize];
        let wins = rival == NO_PARENT
            || match compare(child, rival) {
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
            let (axes, nodes) = decompose(&positions, &parents, by_tips(&tips));

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
        let (axes, nodes) = decompose(&positions, &parents, by_tips(&count_tips(&parents)));
        assert_eq!(nodes, [0, 1, 3, 2]);
        assert_eq!(axes[1], Axis { order: 1, parent: 1, first: 3, len: 1 });
    }
}
