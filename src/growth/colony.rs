//! The loop: iterations from the start until nothing is left to grow for.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::ops::Range;

use glam::Vec3;
use rayon::prelude::*;

use super::influence::Captures;
use super::nodes::{Nodes, Shoot};
use super::obstacle::Obstacle;
use super::search::Search;
use super::surroundings::Surroundings;
use super::tree::PointTree;
use super::{
    ADVICE, Attraction, BUILD_BYTES_PER_POINT, DOING, Growth, GrowthError, GrowthRule, NodeSet, Stop,
    bytes_at,
};
use linden_base::monitor::{Cancelled, Monitor, Phase};
use linden_skeleton::Branching;

/// Fewer nodes than this are asked to grow by one thread.
const WORTH_SHARING: usize = 1024;

/// Growth under way. `new_search` makes the search over a tree of points, given the squared kill
/// distance.
pub(super) struct Colony<'a, F> {
    points: &'a [Vec3],
    rule: &'a GrowthRule,
    monitor: &'a dyn Monitor,
    new_search: F,
    nodes: Nodes<'a>,
    /// One for each wave that is active and has live points.
    searches: Vec<Search>,
    /// How many waves are active or were.
    waves: u32,
    /// With [`Attraction::All`].
    surroundings: Option<Surroundings>,
    captured: NodeSet,
    /// Nodes that apical control holds back, ascending.
    waiting: Vec<u32>,
    /// Points, also of waves to come.
    live: usize,
    iterations: u32,
}

impl<'a, F: Fn(PointTree, f32) -> Search> Colony<'a, F> {
    /// All must be fit for use.
    pub fn new(
        points: &'a [Vec3],
        start: &Branching,
        rule: &'a GrowthRule,
        obstacles: &'a [Obstacle<'a>],
        monitor: &'a dyn Monitor,
        new_search: F,
    ) -> Self {
        let surroundings = match rule.habit.attraction {
            Attraction::Nearest => None,
            Attraction::All => Some(Surroundings::new(rule.influence * rule.influence)),
        };
        Self {
            points,
            rule,
            monitor,
            new_search,
            nodes: Nodes::new(start, rule, obstacles),
            searches: Vec::new(),
            waves: 0,
            surroundings,
            captured: NodeSet::default(),
            waiting: Vec::new(),
            live: points.len(),
            iterations: 0,
        }
    }

    /// The iterations.
    pub fn run(mut self) -> Result<Growth, GrowthError> {
        let mut since_wave = 0;
        let stop = loop {
            if self.live == 0 {
                break Stop::AllReached;
            }
            let interval = self.rule.habit.wave_interval;
            let due = self.searches.iter().all(Search::is_done) || interval > 0 && since_wave >= interval;
            if due && self.begin_wave()? {
                since_wave = 0;
                continue;
            }
            let mut children = self.children()?;
            if children.is_empty() {
                let rescued = self.rescued()?;
                if rescued.children.is_empty() {
                    if self.begin_wave()? {
                        since_wave = 0;
                        continue;
                    }
                    break rescued.stop;
                }
                children = rescued.children;
            }
            if self.iterations == self.rule.max_iterations {
                break Stop::MaxIterations;
            }
            let room = (self.rule.max_nodes as usize).saturating_sub(self.nodes.len());
            if room == 0 {
                break Stop::MaxNodes;
            }
            let cut = children.len() > room;
            children.truncate(room);
            self.monitor.admit(DOING, bytes_at(self.points.len(), &self.nodes, children.len()), ADVICE)?;
            self.iterations += 1;
            since_wave += 1;
            let first = self.nodes.len();
            self.nodes.extend(&children, self.iterations);
            self.settle(first)?;
            if cut && self.live > 0 {
                break Stop::MaxNodes;
            }
        };
        self.take_changed();
        Ok(Growth {
            branching: self.nodes.branching,
            iterations: self.iterations,
            unreached: self.live,
            stop,
            captured: self.captured,
        })
    }

    /// Makes the next wave's points active; whether there was one.
    fn begin_wave(&mut self) -> Result<bool, GrowthError> {
        let wave = loop {
            if self.waves == self.rule.habit.waves {
                return Ok(false);
            }
            let wave = self.wave(self.waves);
            self.waves += 1;
            if !wave.is_empty() {
                break wave;
            }
        };
        let others = bytes_at(self.points.len() - wave.len(), &self.nodes, 0);
        self.monitor.admit(DOING, others + wave.len() as u64 * BUILD_BYTES_PER_POINT, ADVICE)?;
        let GrowthRule { influence, kill, .. } = *self.rule;
        // A node is in reach when its distance is strictly below the next number.
        let beyond = (influence * influence).next_up();
        let tree = PointTree::over(&self.points[wave], beyond, self.monitor)?;
        let mut search = (self.new_search)(tree, kill * kill);
        // The sums are written while the positions are read.
        let positions = std::mem::take(&mut self.nodes.branching.positions);
        let shown = search.awaken(&positions, self.monitor, |captures| {
            self.nodes.influences.record(captures);
            self.bury(captures, false);
        });
        self.nodes.branching.positions = positions;
        shown?;
        if let Some(surroundings) = &mut self.surroundings {
            surroundings.awaken(self.searches.len());
        }
        self.searches.push(search);
        self.progress();
        Ok(true)
    }

    /// Indices of the points in a wave.
    fn wave(&self, wave: u32) -> Range<usize> {
        let start = |wave: u32| {
            let before = u128::from(wave) * self.points.len() as u128;
            before.div_ceil(u128::from(self.rule.habit.waves)) as usize
        };
        start(wave)..start(wave + 1)
    }

    /// Shows the nodes from `first` on to the points, and moves what they capture.
    fn settle(&mut self, first: usize) -> Result<(), Cancelled> {
        // The sums are written while the positions are read.
        let positions = std::mem::take(&mut self.nodes.branching.positions);
        let mut searches = std::mem::take(&mut self.searches);
        let done = searches.iter_mut().try_for_each(|search| {
            search.capture(first, &positions, self.monitor, |captures| {
                self.nodes.influences.record(captures);
                self.bury(captures, true);
            })
        });
        self.nodes.branching.positions = positions;
        self.searches = searches;
        done?;
        self.progress();
        Ok(())
    }

    /// `were_felt`: whether the points that died had been active before.
    fn bury(&mut self, captures: &[Captures], were_felt: bool) {
        for death in captures.iter().flat_map(|some| &some.deaths) {
            self.captured.insert(death.node);
            if let Some(surroundings) = self.surroundings.as_mut().filter(|_| were_felt) {
                surroundings.miss(death.point);
            }
        }
        self.live -= captures.iter().map(|some| some.deaths.len()).sum::<usize>();
    }

    fn progress(&mut self) {
        // Those that are done would only be searched in vain. Sums still ask for new ones by number.
        if self.surroundings.as_ref().is_none_or(Surroundings::are_settled) {
            self.searches.retain(|search| !search.is_done());
        }
        let total = self.points.len() as u64;
        self.monitor.advance(Phase::Grow, total - self.live as u64, Some(total));
    }

    /// Nodes whose `N(v)` changed since the last call.
    fn take_changed(&mut self) -> Vec<u32> {
        let changed = self.nodes.influences.take_dirty();
        for &node in changed.iter().filter(|&&node| self.nodes.influences.any(node)) {
            self.captured.insert(node);
        }
        changed
    }

    /// What the nodes with a changed influenced set grow, and those that waited long enough.
    fn children(&mut self) -> Result<Vec<(u32, Vec3)>, Cancelled> {
        self.monitor.check()?;
        let mut asked = self.take_changed();
        if let Some(surroundings) = &mut self.surroundings {
            let (nodes, searches) = (&self.nodes, &self.searches);
            asked = surroundings.update(
                &asked,
                &nodes.influences,
                searches,
                &nodes.branching.positions,
                self.monitor,
            )?;
            self.searches.retain(|search| !search.is_done());
        }
        if self.rule.habit.apical_control > 0.0 {
            asked.append(&mut self.waiting);
            asked.sort_unstable();
            asked.dedup();
            asked.retain(|&node| self.nodes.influences.any(node));
            (self.waiting, asked) =
                asked.into_iter().partition(|&node| self.nodes.waits(node, self.iterations));
        }
        let children = self.grown(&asked);
        if children.is_empty() && !self.waiting.is_empty() {
            let asked = std::mem::take(&mut self.waiting);
            return Ok(self.grown(&asked));
        }
        Ok(children)
    }

    /// The children of those nodes that grow one where they are pulled.
    fn grown(&self, nodes: &[u32]) -> Vec<(u32, Vec3)> {
        let Self { nodes: all, surroundings, .. } = self;
        let child = |&node: &u32| {
            let sum = match surroundings {
                None => all.influences.sum(node),
                Some(surroundings) => surroundings.sum(node),
            };
            match all.pulled(node, sum?) {
                Shoot::Child(child) => Some((node, child)),
                Shoot::Nothing | Shoot::Blocked => None,
            }
        };
        nodes.par_iter().with_min_len(WORTH_SHARING).filter_map(child).collect()
    }

    /// What all nodes grow when each follows only the nearest of the points that it is the nearest node of.
    fn rescued(&mut self) -> Result<Rescue, Cancelled> {
        let mut nearest: BTreeMap<u32, (f32, Vec3)> = BTreeMap::new();
        for search in &self.searches {
            search.live(self.monitor, |point, d2, node| match nearest.entry(node) {
                Entry::Vacant(entry) => {
                    entry.insert((d2, point));
                }
                Entry::Occupied(mut entry) => {
                    if before((d2, point), *entry.get()) {
                        entry.insert((d2, point));
                    }
                }
            })?;
        }
        let stop = if nearest.is_empty() { Stop::NothingInReach } else { Stop::Stalled };
        let mut rescue = Rescue { children: Vec::new(), stop };
        for (&node, &(_, point)) in &nearest {
            match self.nodes.drawn(node, point) {
                Shoot::Child(child) => rescue.children.push((node, child)),
                Shoot::Blocked => rescue.stop = Stop::Blocked,
                Shoot::Nothing => (),
            }
        }
        Ok(rescue)
    }
}

/// The last attempt of an iteration.
struct Rescue {
    children: Vec<(u32, Vec3)>,
    /// Why growth ends if there are none.
    stop: Stop,
}

/// The order in which points are followed: by distance, then by coordinates.
fn before((a2, a): (f32, Vec3), (b2, b): (f32, Vec3)) -> bool {
    a2.total_cmp(&b2).then(a.x.total_cmp(&b.x)).then(a.y.total_cmp(&b.y)).then(a.z.total_cmp(&b.z)).is_lt()
}
