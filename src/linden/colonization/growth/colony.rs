//! The loop: iterations from the start until nothing is left to grow for.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;

use glam::Vec3;
use rayon::prelude::*;

use super::nodes::Nodes;
use super::search::Search;
use super::{ADVICE, DOING, Growth, GrowthError, GrowthRule, Stop, bytes_at};
use crate::monitor::{Cancelled, Monitor, Stage};

/// Fewer nodes than this are asked to grow by one thread.
const WORTH_SHARING: usize = 1024;

/// Growth under way.
pub(super) struct Colony<'a> {
    pub nodes: Nodes,
    pub search: Search,
    pub rule: &'a GrowthRule,
    pub monitor: &'a dyn Monitor,
    pub points: usize,
    pub live: usize,
}

impl Colony<'_> {
    /// The iterations, after the start's nodes have settled.
    pub fn run(mut self) -> Result<Growth, GrowthError> {
        let mut iterations = 0;
        let stop = loop {
            if self.live == 0 {
                break Stop::AllReached;
            }
            let mut children = self.children()?;
            if children.is_empty() {
                children = self.rescued()?;
            }
            if children.is_empty() {
                break if self.reaches_any()? { Stop::Stalled } else { Stop::NothingInReach };
            }
            if iterations == self.rule.max_iterations {
                break Stop::MaxIterations;
            }
            let room = (self.rule.max_nodes as usize).saturating_sub(self.nodes.len());
            if room == 0 {
                break Stop::MaxNodes;
            }
            let cut = children.len() > room;
            children.truncate(room);
            self.monitor.admit(DOING, bytes_at(self.points, &self.nodes, children.len()), ADVICE)?;
            iterations += 1;
            let first = self.nodes.len();
            self.nodes.extend(&children, iterations);
            self.settle(first)?;
            if cut && self.live > 0 {
                break Stop::MaxNodes;
            }
        };
        Ok(Growth { branching: self.nodes.branching, iterations, unreached: self.live, stop })
    }

    /// Shows the nodes from `first` on to the points, and moves what they capture.
    pub fn settle(&mut self, first: usize) -> Result<(), Cancelled> {
        let Self { nodes, search, live, .. } = self;
        // The sums are written while the positions are read.
        let positions = std::mem::take(&mut nodes.branching.positions);
        let done = search.capture(first, &positions, self.monitor, |captures| {
            nodes.influences.record(captures);
            *live -= captures.iter().map(|some| some.deaths).sum::<usize>();
        });
        nodes.branching.positions = positions;
        done?;
        self.monitor.advance(Stage::Grow, (self.points - self.live) as u64, Some(self.points as u64));
        Ok(())
    }

    /// What the nodes with a changed influenced set grow.
    fn children(&mut self) -> Result<Vec<(u32, Vec3)>, Cancelled> {
        self.monitor.check()?;
        let GrowthRule { step, tropism, .. } = *self.rule;
        let dirty = self.nodes.influences.take_dirty();
        Ok(dirty
            .par_iter()
            .with_min_len(WORTH_SHARING)
            .filter_map(|&node| self.nodes.pulled(node, step, tropism).map(|child| (node, child)))
            .collect())
    }

    /// What all nodes grow when each follows only the nearest point of its influenced set.
    fn rescued(&mut self) -> Result<Vec<(u32, Vec3)>, Cancelled> {
        let mut nearest: BTreeMap<u32, (f32, Vec3)> = BTreeMap::new();
        self.search.live(self.monitor, |point, d2, node| match nearest.entry(node) {
            Entry::Vacant(entry) => {
                entry.insert((d2, point));
            }
            Entry::Occupied(mut entry) => {
                if before((d2, point), *entry.get()) {
                    entry.insert((d2, point));
                }
            }
        })?;
        let step = self.rule.step;
        Ok(nearest
            .iter()
            .filter_map(|(&node, &(_, point))| self.nodes.drawn(node, point, step).map(|child| (node, child)))
            .collect())
    }

    pub fn reaches_any(&self) -> Result<bool, Cancelled> {
        let mut any = false;
        self.search.live(self.monitor, |_, _, _| any = true)?;
        Ok(any)
    }
}

/// The order in which points are followed: by distance, then by coordinates.
fn before((a2, a): (f32, Vec3), (b2, b): (f32, Vec3)) -> bool {
    a2.total_cmp(&b2).then(a.x.total_cmp(&b.x)).then(a.y.total_cmp(&b.y)).then(a.z.total_cmp(&b.z)).is_lt()
}
