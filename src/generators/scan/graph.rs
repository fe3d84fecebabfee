//! Points on bark and leaves, linked with their nearest, and the ways along them from the foot.
//!
//! Occlusion leaves gaps, so the graph falls into pieces. The shortest links that connect
//! everything (a minimum spanning tree of the pieces) make sure that no part of the crown is cut off, but
//! alone they hang limbs on each other's tips; so each point of a piece also gets links to the nearest
//! of several other pieces, and the shortest way from the foot, on which a gap counts by the square of its
//! length, chooses among them.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use glam::DVec3;
use rayon::prelude::*;

use super::bridges::bridges;
use super::links::{LinkedTo, by_point, links_within, strays, without};
use super::retain_unmarked;
use linden_base::monitor::{Cancelled, Monitor};

/// A metre over leaves counts for so many.
const LEAF_METRE: f64 = 3.0;

/// Where a way came from is told so many links back.
const BACK: usize = 10;

/// Points and the links along which distances are measured.
pub(super) struct Graph {
    pub points: Vec<DVec3>,
    /// Links longer than this are bridges.
    pub reach: f64,
    /// Where each point's links go, point after point, each once.
    links: Vec<u32>,
    /// Where the links of each point begin, and behind those of the last.
    starts: Vec<usize>,
    /// Points left out as strays.
    pub strays: usize,
}

/// The shortest way from the foot to each point.
pub(super) struct Ways {
    /// Its length, metres; infinite where no way leads.
    pub length: Vec<f64>,
    /// The point before; itself at the foot.
    pub before: Vec<u32>,
    /// The group of the place where it starts.
    pub group: Vec<u32>,
}

/// A place where ways start.
pub(super) struct Start {
    /// Metres that they have come already.
    pub length: f64,
    /// Ways of different groups need not cost the same.
    pub group: u32,
}

/// What ways cost.
pub(super) struct Cost<'a> {
    /// A metre of each group.
    pub per_metre: &'a [f64],
    /// What counts for more metres counts by the square.
    pub linear_m: f64,
    /// Across where a way came from a metre counts for so many more.
    pub turn: f64,
    /// Points that ways are to avoid where there are others: leaves. Empty: none.
    pub leaves: &'a [bool],
}

impl Cost<'_> {
    fn bends(&self) -> bool {
        self.turn != 0.0
    }
}

impl Ways {
    /// The length of the longest way beyond each point, metres; 0 where no way leads.
    pub fn beyond_m(&self) -> Vec<f64> {
        let mut order: Vec<u32> = (0..self.length.len() as u32).collect();
        let length = |i: u32| self.length[i as usize];
        order.par_sort_unstable_by(|&a, &b| length(b).total_cmp(&length(a)).then(a.cmp(&b)));
        let mut ends_m = self.length.clone();
        for at in order {
            let before = self.before[at as usize] as usize;
            ends_m[before] = ends_m[before].max(ends_m[at as usize]);
        }
        let beyond = |(end_m, &length_m): (f64, &f64)| if end_m.is_finite() { end_m - length_m } else { 0.0 };
        ends_m.into_iter().zip(&self.length).map(beyond).collect()
    }

    /// The longest link on the way to each point, metres.
    pub fn widest_gaps_m(&self, graph: &Graph) -> Vec<f64> {
        let mut order: Vec<u32> = (0..self.before.len() as u32).collect();
        let length = |i: u32| self.length[i as usize];
        order.sort_unstable_by(|&a, &b| length(a).total_cmp(&length(b)).then(a.cmp(&b)));
        let mut widest = vec![0.0; self.before.len()];
        for at in order {
            let before = self.before[at as usize];
            widest[at as usize] = f64::max(widest[before as usize], graph.distance(before, at));
        }
        widest
    }
}

impl Graph {
    /// Links each point with its nearest within `reach`, drops strays, bridges the gaps.
    pub fn new(points: Vec<DVec3>, reach: f64, monitor: &dyn Monitor) -> Result<Self, Cancelled> {
        let (nearest, _) = links_within(&points, reach, |_| 0, monitor)?;
        Self::linked(points, nearest, reach, monitor)
    }

    /// The same of points whose nearest are known.
    pub fn linked(
        mut points: Vec<DVec3>,
        mut nearest: Vec<LinkedTo>,
        reach: f64,
        monitor: &dyn Monitor,
    ) -> Result<Self, Cancelled> {
        let before = points.len();
        if let Some(is_stray) = strays(&points, &nearest, reach, monitor)? {
            retain_unmarked(&mut points, &is_stray);
            nearest = without(nearest, &is_stray);
        }
        let strays = before - points.len();
        let bridges = bridges(&points, &nearest, reach, monitor)?;
        let (links, starts) = by_point(&nearest, &bridges);
        Ok(Self { points, reach, links, starts, strays })
    }

    /// Between two points, metres.
    pub fn distance(&self, a: u32, b: u32) -> f64 {
        self.points[a as usize].distance(self.points[b as usize])
    }

    /// For each point what most of it and those linked to it are; what stands even stays.
    pub fn of_most(&self, is_so: &[bool]) -> Vec<bool> {
        let mut votes: Vec<i32> = is_so.iter().map(|&so| if so { 1 } else { -1 }).collect();
        for (from, votes) in (0..).zip(&mut votes) {
            for &to in self.links_of(from) {
                *votes += if is_so[to as usize] { 1 } else { -1 };
            }
        }
        votes.iter().zip(is_so).map(|(&votes, &so)| if votes == 0 { so } else { votes > 0 }).collect()
    }

    /// The bridges on the ways from the foot, metres.
    pub fn bridges_m(&self, ways: &Ways) -> Vec<f64> {
        let lengths = (0..).zip(&ways.before).map(|(to, &from)| self.distance(from, to));
        lengths.filter(|&length| length > self.reach).collect()
    }

    /// Both directions of each link: (from, to), point after point.
    pub fn pairs(&self) -> impl Iterator<Item = (u32, u32)> {
        let froms = 0..self.points.len() as u32;
        froms.flat_map(|from| self.links_of(from).iter().map(move |&to| (from, to)))
    }

    fn links_of(&self, from: u32) -> &[u32] {
        let from = from as usize;
        &self.links[self.starts[from]..self.starts[from + 1]]
    }

    /// The shortest ways from the places where `start` gives a length to begin with; a gap counts by the square of its length.
    /// They keep to what are no `leaves`, where that is told.
    pub fn ways(
        &self,
        start: impl Fn(DVec3) -> Option<f64>,
        leaves: &[bool],
        monitor: &dyn Monitor,
    ) -> Result<Ways, Cancelled> {
        let cost = Cost { per_metre: &[1.0], linear_m: self.reach, turn: 0.0, leaves };
        self.ways_of(|p| start(p).map(|length| Start { length, group: 0 }), &cost, monitor)
    }

    /// The cheapest ways from several groups of places (Dijkstra 1959).
    pub fn ways_of(
        &self,
        start: impl Fn(DVec3) -> Option<Start>,
        cost_of: &Cost<'_>,
        monitor: &dyn Monitor,
    ) -> Result<Ways, Cancelled> {
        let mut cost = vec![f64::INFINITY; self.points.len()];
        let mut length = cost.clone();
        let mut group = vec![0; self.points.len()];
        let mut before: Vec<u32> = (0..self.points.len() as u32).collect();
        let mut queue = BinaryHeap::new();
        for (i, &p) in (0..).zip(&self.points) {
            if let Some(at) = start(p) {
                let begins = at.length * cost_of.per_metre[at.group as usize];
                (cost[i as usize], length[i as usize], group[i as usize]) = (begins, at.length, at.group);
                // Bits of non-negative floats order as the floats do.
                queue.push(Reverse((begins.to_bits(), i)));
            }
        }
        let mut taken = 0_u32;
        while let Some(Reverse((bits, at))) = queue.pop() {
            if taken.is_multiple_of(4096) {
                monitor.check()?;
            }
            taken = taken.wrapping_add(1);
            let so_far = f64::from_bits(bits);
            if so_far > cost[at as usize] {
                continue;
            }
            let came = cost_of.bends().then(|| {
                let back = (0..BACK).fold(at, |node, _| before[node as usize]);
                (self.points[at as usize] - self.points[back as usize]).normalize_or_zero()
            });
            let per_metre = cost_of.per_metre[group[at as usize] as usize];
            for &to in self.links_of(at) {
                let step = self.distance(at, to);
                let bend = came.map_or(1.0, |came| {
                    let goes = (self.points[to as usize] - self.points[at as usize]).normalize_or_zero();
                    1.0 + cost_of.turn * (1.0 - came.dot(goes)).max(0.0)
                });
                let leaf = if cost_of.leaves.get(to as usize) == Some(&true) { LEAF_METRE } else { 1.0 };
                let costs = bend * step * leaf;
                let beyond = so_far + per_metre * costs * (costs / cost_of.linear_m).max(1.0);
                if beyond < cost[to as usize] {
                    cost[to as usize] = beyond;
                    length[to as usize] = length[at as usize] + step;
                    before[to as usize] = at;
                    group[to as usize] = group[at as usize];
                    queue.push(Reverse((beyond.to_bits(), to)));
                }
            }
        }
        Ok(Ways { length, before, group })
    }
}
