//! Sums over all points in reach of a node, for [`Attraction::All`](super::Attraction::All).
//!
//! Only nodes that have points of their own, the frontier, are pulled; in a large tree they are few.
//! A node that joins it gathers the pulls of all live points in reach; from then on the points that
//! died take theirs back, and those of new waves add theirs. All three are one search: over the points'
//! trees, or over a tree of those that died since. Sums are integers, so that this is exact.

use glam::{DVec3, Vec3};
use multiversion::multiversion;
use rayon::prelude::*;

use super::influence::{Influences, pull};
use super::lists::reserve;
use super::search::Search;
use super::tree::{LEAF, Leaf, PointTree};
use linden_base::monitor::{Cancelled, Monitor};

/// Fewer nodes than this are worked on by one thread, between two questions to the monitor.
const WORTH_SHARING: usize = 64;

/// Pulls at one node.
#[derive(Clone, Copy, Default)]
struct Sum {
    vector: [i64; 3],
    points: u32,
}

/// The sums of the frontier.
pub(super) struct Surroundings {
    influence2: f32,
    /// By node; of those in the frontier.
    of: Vec<Sum>,
    /// Ascending.
    frontier: Vec<u32>,
    /// Points that died since the last update.
    missed: Vec<Vec3>,
    /// Waves that became active since the last update: indices into the searches.
    awakened: Vec<usize>,
}

impl Surroundings {
    pub fn new(influence2: f32) -> Self {
        Self { influence2, of: Vec::new(), frontier: Vec::new(), missed: Vec::new(), awakened: Vec::new() }
    }

    /// A point that was felt is so no more.
    pub fn miss(&mut self, point: Vec3) {
        self.missed.push(point);
    }

    /// The points of a search can be felt from now on.
    pub fn awaken(&mut self, search: usize) {
        self.awakened.push(search);
    }

    /// Whether searches may be renumbered.
    pub fn are_settled(&self) -> bool {
        self.awakened.is_empty()
    }

    /// The sum of the pulls at a node of the frontier.
    pub fn sum(&self, node: u32) -> Option<DVec3> {
        let Sum { vector: [x, y, z], points } = self.of[node as usize];
        (points > 0).then(|| DVec3::new(x as f64, y as f64, z as f64))
    }

    /// Brings all sums up to date, given the nodes whose own points changed, ascending. Those whose
    /// surroundings changed, ascending.
    pub fn update(
        &mut self,
        changed: &[u32],
        influences: &Influences,
        searches: &[Search],
        positions: &[Vec3],
        monitor: &dyn Monitor,
    ) -> Result<Vec<u32>, Cancelled> {
        let more = positions.len() - self.of.len();
        reserve(&mut self.of, more);
        self.of.resize(positions.len(), Sum::default());
        let joining: Vec<u32> = changed
            .iter()
            .copied()
            .filter(|&node| influences.any(node) && self.frontier.binary_search(&node).is_err())
            .collect();
        self.frontier.retain(|&node| influences.any(node));

        let mut marked = Vec::new();
        if !self.missed.is_empty() {
            let died = PointTree::over(&self.missed, self.influence2, monitor)?;
            self.missed.clear();
            for (node, sum) in self.gather(&died, &self.frontier, positions, monitor)? {
                self.of[node as usize].add(&sum, -1);
                marked.push(node);
            }
        }
        for search in std::mem::take(&mut self.awakened) {
            for (node, sum) in self.gather(&searches[search].tree, &self.frontier, positions, monitor)? {
                self.of[node as usize].add(&sum, 1);
                marked.push(node);
            }
        }
        for &node in &joining {
            self.of[node as usize] = Sum::default();
        }
        for search in searches {
            for (node, sum) in self.gather(&search.tree, &joining, positions, monitor)? {
                self.of[node as usize].add(&sum, 1);
            }
        }
        marked.extend(&joining);
        marked.sort_unstable();
        marked.dedup();
        self.frontier.extend(joining);
        self.frontier.sort_unstable();
        Ok(marked)
    }

    /// The pulls of the live points of `tree` at those of the `nodes` that feel any.
    fn gather(
        &self,
        tree: &PointTree,
        nodes: &[u32],
        positions: &[Vec3],
        monitor: &dyn Monitor,
    ) -> Result<Vec<(u32, Sum)>, Cancelled> {
        let some = nodes.par_chunks(WORTH_SHARING).map(|nodes| {
            monitor.check()?;
            let felt = |&node: &u32| {
                let sum = felt_at(tree, positions[node as usize], self.influence2);
                (sum.points > 0).then_some((node, sum))
            };
            Ok(nodes.iter().filter_map(felt).collect::<Vec<_>>())
        });
        Ok(some.collect::<Result<Vec<_>, Cancelled>>()?.concat())
    }
}

impl Sum {
    /// `sign`: 1, or -1 to take away.
    fn add(&mut self, other: &Self, sign: i64) {
        for (sum, part) in self.vector.iter_mut().zip(other.vector) {
            *sum += sign * part;
        }
        self.points = if sign < 0 { self.points - other.points } else { self.points + other.points };
    }
}

/// What the live points of `tree` within reach of `node` pull.
#[multiversion(targets("x86_64+avx2"))]
fn felt_at(tree: &PointTree, node: Vec3, influence2: f32) -> Sum {
    let mut sum = Sum::default();
    let mut clusters = tree.top.within(node, influence2);
    while let Some(cluster) = clusters.next() {
        let cluster = &tree.clusters[cluster];
        let mut leaves = cluster.pyramid.within(node, influence2);
        while let Some(leaf) = leaves.next() {
            feel(&cluster.leaves[leaf], node, influence2, &mut sum);
        }
    }
    sum
}

#[allow(clippy::inline_always, reason = "must be compiled with the caller's vector instructions")]
#[inline(always)]
fn feel(leaf: &Leaf, node: Vec3, influence2: f32, sum: &mut Sum) {
    let mut d2 = [0.0_f32; LEAF];
    let mut felt = 0_u32;
    for (lane, d2) in d2.iter_mut().enumerate() {
        let (x, y, z) = (leaf.x[lane] - node.x, leaf.y[lane] - node.y, leaf.z[lane] - node.z);
        *d2 = x * x + y * y + z * z;
        felt |= if *d2 <= influence2 && leaf.d2[lane] >= 0.0 { 1 << lane } else { 0 };
    }
    sum.points += felt.count_ones();
    while felt != 0 {
        let lane = felt.trailing_zeros() as usize;
        felt &= felt - 1;
        for (sum, part) in sum.vector.iter_mut().zip(pull(0, leaf.point(lane) - node, d2[lane]).vector) {
            *sum += i64::from(part);
        }
    }
}
