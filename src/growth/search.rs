//! The search: which points do new nodes capture?
//!
//! A bichromatic reverse-nearest-neighbour search. All new nodes of an iteration go down the tree
//! together, level by level; a child is entered by the nodes that are nearer to its box than the
//! farthest of its points is to the node nearest to that point. What is captured comes back as
//! [`Captures`], for the owner of the nodes to add up.

use glam::Vec3;
use multiversion::multiversion;
use rayon::prelude::*;

use super::NONE;
use super::influence::{Captures, Death};
use super::tree::{Cluster, DEAD, FAN, Inner, LEAF, Leaf, PointTree, largest};
use linden_base::monitor::{Cancelled, Monitor};

/// Below this many (cluster, node) pairs handing work to other threads costs more than it saves.
const WORTH_SHARING: usize = 256;

/// Below this many new nodes one thread finds out which clusters they enter.
const WORTH_SPLITTING: usize = 1024;
/// Most shares otherwise: their findings are put together by one thread.
const MOST_SHARES: usize = 8;

/// Most nodes that are sent into one cluster between two questions to the monitor.
const BATCH: usize = 1024;

/// Most nodes that are shown at once to points that have seen none. While no point has a near node, each
/// may enter every cluster: what is noted of that is bounded by this, and later ones enter the fewer.
const TURN: usize = 256;

/// A squared kill distance that nothing is within.
const NEVER: f32 = -1.0;

/// Nodes of one level of the tree, each with the new tree nodes ("queries") that enter it.
#[derive(Default)]
struct Front {
    /// Ascending.
    boxes: Vec<u32>,
    /// Where the queries of each box end; they start where those before it end.
    ends: Vec<u32>,
    /// Indices of tree nodes, ascending within each box; what lies beyond the last end is stale.
    queries: Vec<u32>,
}

impl Front {
    /// All queries at the root.
    fn start(&mut self, queries: impl ExactSizeIterator<Item = u32>) {
        self.clear(queries.len());
        self.boxes.push(0);
        self.ends.push(queries.len() as u32);
        for (slot, query) in self.queries.iter_mut().zip(queries) {
            *slot = query;
        }
    }

    /// Empties it, with room for `room` queries.
    fn clear(&mut self, room: usize) {
        self.boxes.clear();
        self.ends.clear();
        if self.queries.len() < room {
            self.queries.resize(room, 0);
        }
    }

    /// How many queries there are, counted once for every box they enter.
    fn entries(&self) -> usize {
        self.ends.last().map_or(0, |&end| end as usize)
    }

    /// Adds a box and those of the queries whose bit is set.
    ///
    /// Whether a query enters a box is nearly random: a branch would be guessed wrong too often, so
    /// every query is written and the place advances or not.
    #[allow(clippy::inline_always, reason = "must be compiled with the caller's vector instructions")]
    #[inline(always)]
    fn enter(&mut self, index: u32, queries: &[u32], masks: &[u32], bit: u32) {
        let start = self.entries();
        let room = &mut self.queries[start..start + queries.len()];
        let mut entered = 0;
        for (&query, &mask) in queries.iter().zip(masks) {
            room[entered] = query;
            entered += (mask >> bit & 1) as usize;
        }
        self.boxes.push(index);
        self.ends.push((start + entered) as u32);
    }

    /// The boxes of several fronts, each with all its queries. The fronts' queries ascend from one
    /// front to the next.
    fn merge(&mut self, fronts: &[&Self]) {
        self.clear(fronts.iter().map(|front| front.entries()).sum());
        let mut rest: Vec<_> = fronts.iter().map(|front| front.iter().peekable()).collect();
        let mut end = 0;
        while let Some(index) =
            rest.iter_mut().filter_map(|boxes| boxes.peek().map(|&(index, _)| index)).min()
        {
            for boxes in &mut rest {
                if let Some((_, queries)) = boxes.next_if(|&(other, _)| other == index) {
                    self.queries[end..end + queries.len()].copy_from_slice(queries);
                    end += queries.len();
                }
            }
            self.boxes.push(index as u32);
            self.ends.push(end as u32);
        }
    }

    fn iter(&self) -> impl Iterator<Item = (usize, &[u32])> {
        let mut start = 0;
        self.boxes.iter().zip(&self.ends).map(move |(&index, &end)| {
            let queries = &self.queries[start..end as usize];
            start = end as usize;
            (index as usize, queries)
        })
    }
}

/// Reusable memory of one thread.
#[derive(Default)]
struct Scratch {
    /// The root's front first, then level by level; the items' last.
    fronts: Vec<Front>,
    masks: Vec<u32>,
}

impl Scratch {
    fn with_levels(&mut self, levels: usize) {
        self.fronts.resize_with(levels + 1, Front::default);
    }
}

/// Sends `queries` into one cluster.
type Visit = fn(&mut Cluster, &[u32], &[Vec3], f32, &mut Scratch, &mut Captures);

/// The point tree and the memory to search it.
pub(super) struct Search {
    pub tree: PointTree,
    kill2: f32,
    visit: Visit,
    /// How the new nodes came to the clusters: one for each share of them.
    ways: Vec<Scratch>,
    /// The clusters and the new nodes that enter them.
    entered: Front,
    scratch: Scratch,
    /// One for each cluster that is entered at the same time.
    captures: Vec<Captures>,
}

impl Search {
    /// `kill2`: the squared kill distance.
    pub fn new(tree: PointTree, kill2: f32) -> Self {
        Self {
            tree,
            kill2,
            visit: visit_detected,
            ways: Vec::new(),
            entered: Front::default(),
            scratch: Scratch::default(),
            captures: vec![Captures::default()],
        }
    }

    /// Without the vector instructions that this machine might have beyond its baseline.
    #[cfg(test)]
    pub fn portable(tree: PointTree, kill2: f32) -> Self {
        Self { visit: visit_portable, ..Self::new(tree, kill2) }
    }

    /// Shows the nodes from `first` on to the points; `record` takes what they captured, in one or
    /// more calls.
    pub fn capture(
        &mut self,
        first: usize,
        positions: &[Vec3],
        monitor: &dyn Monitor,
        mut record: impl FnMut(&[Captures]),
    ) -> Result<(), Cancelled> {
        self.distribute(first, positions);
        let entered = &self.entered;
        let mut clusters = self.tree.clusters.iter_mut().enumerate();
        let work: Vec<(&mut Cluster, &[u32])> = entered
            .iter()
            .filter_map(|(index, queries)| {
                clusters.find(|(i, _)| *i == index).map(|(_, cluster)| (cluster, queries))
            })
            .collect();

        let (visit, kill2) = (self.visit, self.kill2);
        let run = |cluster: &mut Cluster, queries: &[u32], scratch: &mut Scratch, captures: &mut Captures| {
            // Who is nearest when a point dies is known when all batches have been there.
            let many = queries.len() > BATCH;
            for batch in queries.chunks(BATCH) {
                monitor.check()?;
                visit(cluster, batch, positions, if many { NEVER } else { kill2 }, scratch, captures);
            }
            if many {
                bury(cluster, positions, kill2, captures);
            }
            Ok(())
        };
        if entered.entries() < WORTH_SHARING || work.len() < 2 || rayon::current_num_threads() == 1 {
            // One after the other, each recorded while it is still in the cache.
            for (cluster, queries) in work {
                self.captures[0].clear();
                run(cluster, queries, &mut self.scratch, &mut self.captures[0])?;
                record(&self.captures[..1]);
            }
        } else {
            let count = work.len();
            if self.captures.len() < count {
                self.captures.resize_with(count, Captures::default);
            }
            work.into_par_iter().zip(&mut self.captures).try_for_each_init(
                Scratch::default,
                |scratch, ((cluster, queries), captures)| {
                    captures.clear();
                    run(cluster, queries, scratch, captures)
                },
            )?;
            record(&self.captures[..count]);
        }
        self.refit();
        Ok(())
    }

    /// Finds the clusters that the nodes from `first` on enter.
    fn distribute(&mut self, first: usize, positions: &[Vec3]) {
        let levels = &self.tree.top.levels;
        let shares = rayon::current_num_threads().min(MOST_SHARES);
        let queries = positions.len() - first;
        let share = if queries < WORTH_SPLITTING { queries } else { queries.div_ceil(shares) };
        self.ways.resize_with(queries.div_ceil(share.max(1)), Scratch::default);
        let descend = |(turn, way): (usize, &mut Scratch)| {
            let start = first + turn * share;
            way.with_levels(levels.len());
            way.fronts[0].start(start as u32..positions.len().min(start + share) as u32);
            descend_all(levels, positions, way);
        };
        if self.ways.len() > 1 {
            self.ways.par_iter_mut().enumerate().for_each(descend);
        } else {
            self.ways.iter_mut().enumerate().for_each(descend);
        }
        let ends: Vec<&Front> = self.ways.iter().filter_map(|way| way.fronts.last()).collect();
        self.entered.merge(&ends);
    }

    /// Brings the reaches above the clusters up to date.
    fn refit(&mut self) {
        let (clusters, top) = (&self.tree.clusters, &mut self.tree.top);
        let depth = top.levels.len();
        for &index in &self.entered.boxes {
            let (parent, child) = (index as usize / FAN, index as usize % FAN);
            top.levels[0][parent].reach[child] = clusters[index as usize].pyramid.reach();
        }
        for level in 1..depth {
            for way in &self.ways {
                refit_level(&mut top.levels, level, &way.fronts[depth - level]);
            }
        }
    }

    /// Shows all nodes to points that have seen none; `record` takes what they have captured at the end,
    /// cluster by cluster.
    ///
    /// The same as [`capture`](Self::capture), but that nothing is told of points that change hands on the
    /// way, and that memory does not go with nodes × clusters.
    pub fn awaken(
        &mut self,
        positions: &[Vec3],
        monitor: &dyn Monitor,
        mut record: impl FnMut(&[Captures]),
    ) -> Result<(), Cancelled> {
        for first in (0..positions.len()).step_by(TURN) {
            monitor.check()?;
            self.show(first, &positions[..positions.len().min(first + TURN)], monitor)?;
        }
        // Who is nearest when a point dies is known when all nodes have been there.
        let captures = &mut self.captures[0];
        for (index, cluster) in self.tree.clusters.iter_mut().enumerate() {
            monitor.check()?;
            captures.clear();
            bury(cluster, positions, self.kill2, captures);
            // Nobody has felt them.
            captures.lost.made.clear();
            live_in(cluster, |point, d2, node| {
                captures.won.push(node, point - positions[node as usize], d2);
            });
            captures.won.finish();
            record(std::slice::from_ref(captures));
            self.tree.top.levels[0][index / FAN].reach[index % FAN] = cluster.pyramid.reach();
        }
        refit_all(&mut self.tree.top.levels);
        Ok(())
    }

    /// Shows the nodes from `first` on to the points; none dies.
    fn show(&mut self, first: usize, positions: &[Vec3], monitor: &dyn Monitor) -> Result<(), Cancelled> {
        self.distribute(first, positions);
        let mut clusters = self.tree.clusters.iter_mut().enumerate();
        let work: Vec<(&mut Cluster, &[u32])> = self
            .entered
            .iter()
            .filter_map(|(index, queries)| {
                clusters.find(|(i, _)| *i == index).map(|(_, cluster)| (cluster, queries))
            })
            .collect();
        let visit = self.visit;
        work.into_par_iter().try_for_each_init(
            <(Scratch, Captures)>::default,
            |(scratch, captures), (cluster, queries)| {
                monitor.check()?;
                captures.clear();
                visit(cluster, queries, positions, NEVER, scratch, captures);
                Ok(())
            },
        )?;
        self.refit();
        Ok(())
    }

    /// Whether no point lives.
    pub fn is_done(&self) -> bool {
        self.tree.top.reach() < 0.0
    }

    /// The live points that have a nearest node, in the tree's order: point, squared distance, node.
    pub fn live(&self, monitor: &dyn Monitor, mut each: impl FnMut(Vec3, f32, u32)) -> Result<(), Cancelled> {
        for cluster in self.tree.clusters.iter().filter(|cluster| cluster.pyramid.reach() >= 0.0) {
            monitor.check()?;
            live_in(cluster, &mut each);
        }
        Ok(())
    }
}

/// With AVX2 where the machine has it. Never FMA: a product and a sum round separately, everywhere.
#[multiversion(targets("x86_64+avx2"))]
fn visit_detected(
    cluster: &mut Cluster,
    queries: &[u32],
    positions: &[Vec3],
    kill2: f32,
    scratch: &mut Scratch,
    captures: &mut Captures,
) {
    visit(cluster, queries, positions, kill2, scratch, captures);
}

#[cfg(test)]
fn visit_portable(
    cluster: &mut Cluster,
    queries: &[u32],
    positions: &[Vec3],
    kill2: f32,
    scratch: &mut Scratch,
    captures: &mut Captures,
) {
    visit(cluster, queries, positions, kill2, scratch, captures);
}

#[multiversion(targets("x86_64+avx2"))]
fn descend_all(levels: &[Vec<Inner>], positions: &[Vec3], scratch: &mut Scratch) {
    descend(levels, positions, scratch);
}

#[allow(clippy::inline_always, reason = "must be compiled with the caller's vector instructions")]
#[inline(always)]
fn visit(
    cluster: &mut Cluster,
    queries: &[u32],
    positions: &[Vec3],
    kill2: f32,
    scratch: &mut Scratch,
    captures: &mut Captures,
) {
    let depth = cluster.pyramid.levels.len();
    scratch.with_levels(depth);
    scratch.fronts[0].start(queries.iter().copied());
    descend(&cluster.pyramid.levels, positions, scratch);
    let mut changed = false;
    for (index, queries) in scratch.fronts[depth].iter() {
        if let Some(reach) = contest(&mut cluster.leaves[index], queries, positions, kill2, captures) {
            cluster.pyramid.levels[0][index / FAN].reach[index % FAN] = reach;
            changed = true;
        }
    }
    captures.lost.finish();
    captures.won.finish();
    if changed {
        for level in 1..depth {
            refit_level(&mut cluster.pyramid.levels, level, &scratch.fronts[depth - level]);
        }
    }
}

/// From the root's front, which is given, to that of the items.
#[allow(clippy::inline_always, reason = "must be compiled with the caller's vector instructions")]
#[inline(always)]
fn descend(levels: &[Vec<Inner>], positions: &[Vec3], scratch: &mut Scratch) {
    let Scratch { fronts, masks } = scratch;
    for (step, level) in levels.iter().rev().enumerate() {
        let (above, below) = fronts.split_at_mut(step + 1);
        let (from, to) = (&above[step], &mut below[0]);
        to.clear(from.entries() * FAN);
        for (index, queries) in from.iter() {
            let inner = &level[index];
            masks.resize(queries.len(), 0);
            let mut children = 0;
            // A loop, not an iterator's `extend`: that would be compiled apart, without the vectors.
            for (mask, &query) in masks.iter_mut().zip(queries) {
                *mask = inner.entered_by(positions[query as usize]);
                children |= *mask;
            }
            while children != 0 {
                let child = children.trailing_zeros();
                children &= children - 1;
                to.enter((index * FAN) as u32 + child, queries, masks, child);
            }
        }
    }
}

/// Brings the reaches in `level` up to date where children in the level below changed.
#[allow(clippy::inline_always, reason = "must be compiled with the caller's vector instructions")]
#[inline(always)]
fn refit_level(levels: &mut [Vec<Inner>], level: usize, children: &Front) {
    let (below, above) = levels.split_at_mut(level);
    for &index in &children.boxes {
        let index = index as usize;
        above[0][index / FAN].reach[index % FAN] = below[level - 1][index].farthest_reach();
    }
}

/// Lets the queries compete for the points of a leaf. The new reach, if any point changed hands.
///
/// Queries come in ascending order and win only when strictly nearer: of nodes that are equally
/// near, the one with the lowest index has the point.
#[allow(clippy::inline_always, reason = "must be compiled with the caller's vector instructions")]
#[inline(always)]
fn contest(
    leaf: &mut Leaf,
    queries: &[u32],
    positions: &[Vec3],
    kill2: f32,
    captures: &mut Captures,
) -> Option<f32> {
    let (mut d2, mut nearest) = (leaf.d2, leaf.nearest);
    for &query in queries {
        let node = positions[query as usize];
        for lane in 0..LEAF {
            let (x, y, z) = (leaf.x[lane] - node.x, leaf.y[lane] - node.y, leaf.z[lane] - node.z);
            let distance2 = x * x + y * y + z * z;
            nearest[lane] = if distance2 < d2[lane] { query } else { nearest[lane] };
            // Not on the same condition: the compiler would keep the lanes in memory and store under a
            // mask. Not `min`: it asks for NaN first.
            d2[lane] = if d2[lane] < distance2 { d2[lane] } else { distance2 };
        }
    }
    let mut changed = 0;
    for (lane, (d2, before)) in d2.iter().zip(&leaf.d2).enumerate() {
        changed |= u32::from(d2 < before) << lane;
    }
    if changed == 0 {
        return None;
    }
    while changed != 0 {
        let lane = changed.trailing_zeros() as usize;
        changed &= changed - 1;
        let point = leaf.point(lane);
        let loser = leaf.nearest[lane];
        if loser != NONE {
            captures.lost.push(loser, point - positions[loser as usize], leaf.d2[lane]);
        }
        if d2[lane] <= kill2 {
            d2[lane] = DEAD;
            captures.deaths.push(Death { node: nearest[lane], point });
        } else {
            let winner = nearest[lane];
            captures.won.push(winner, point - positions[winner as usize], d2[lane]);
        }
    }
    (leaf.d2, leaf.nearest) = (d2, nearest);
    Some(largest(&d2))
}

/// Lets the points die that are within the kill distance of their nearest node.
fn bury(cluster: &mut Cluster, positions: &[Vec3], kill2: f32, captures: &mut Captures) {
    for (index, leaf) in cluster.leaves.iter_mut().enumerate() {
        for lane in 0..LEAF {
            let (d2, node) = (leaf.d2[lane], leaf.nearest[lane]);
            if (0.0..=kill2).contains(&d2) && node != NONE {
                let point = leaf.point(lane);
                captures.lost.push(node, point - positions[node as usize], d2);
                captures.deaths.push(Death { node, point });
                leaf.d2[lane] = DEAD;
            }
        }
        cluster.pyramid.levels[0][index / FAN].reach[index % FAN] = largest(&leaf.d2);
    }
    captures.lost.finish();
    refit_all(&mut cluster.pyramid.levels);
}

/// Brings all reaches above the lowest level up to date.
fn refit_all(levels: &mut [Vec<Inner>]) {
    for level in 1..levels.len() {
        let (below, above) = levels.split_at_mut(level);
        for (index, child) in below[level - 1].iter().enumerate() {
            above[0][index / FAN].reach[index % FAN] = child.farthest_reach();
        }
    }
}

/// The live points of a cluster that have a nearest node: point, squared distance, node.
fn live_in(cluster: &Cluster, mut each: impl FnMut(Vec3, f32, u32)) {
    for leaf in &cluster.leaves {
        for lane in 0..LEAF {
            if leaf.d2[lane] >= 0.0 && leaf.nearest[lane] != NONE {
                each(leaf.point(lane), leaf.d2[lane], leaf.nearest[lane]);
            }
        }
    }
}
