//! How the light of all buds is shared out again: v, the internodes that each may grow this year.

use linden_skeleton::NO_PARENT;

use crate::light::FULL_LIGHT;
use crate::settings::of_order;
use crate::sums::Sums;
use crate::tree::{APEX, LATERAL, Nodes};
use crate::{SelfOrganizing, Sharing};

/// What buds get, in internodes.
#[derive(Clone, Debug, Default)]
pub(crate) struct Shares {
    /// What comes to a node from below.
    pub flow: Vec<f64>,
    /// What goes on along the node's axis: to the apex, if it is here.
    pub onward: Vec<f64>,
    /// What goes to each lateral bud of the node.
    pub bud: Vec<f64>,
}

impl Shares {
    /// Shares vigor times light among the buds of all trees.
    pub fn new(nodes: &Nodes, sums: &Sums, settings: &SelfOrganizing, year: u32) -> Self {
        let mut shares = Self {
            flow: vec![0.0; nodes.len()],
            onward: vec![0.0; nodes.len()],
            bud: vec![0.0; nodes.len()],
        };
        match settings.sharing {
            Sharing::BorchertHonda => shares.fork_by_fork(nodes, sums, settings, year),
            Sharing::Priority => shares.axis_by_axis(nodes, sums, settings, year),
        }
        shares
    }

    /// Borchert & Honda 1984 as Pałubicki et al. 2009 extend it: with the light Q of what is onward (m) and
    /// lateral (l), `v_m = v·λQ_m / (λQ_m + (1 − λ)Q_l)`, and `v_l = v − v_m`, which laterals share by their light.
    fn fork_by_fork(&mut self, nodes: &Nodes, sums: &Sums, settings: &SelfOrganizing, year: u32) {
        let mut lateral = vec![0.0; nodes.len()];
        for node in 0..nodes.len() {
            let parent = nodes.parents[node];
            let below = parent as usize;
            let flow = if parent == NO_PARENT {
                income(sums, node, settings, year)
            } else if nodes.is(node, LATERAL) {
                part(lateral[below], sums.total(node), sums.lateral[below])
            } else {
                self.onward[below]
            };
            let leader = settings.leader_in(year, nodes.orders[node]);
            let (onward, sideways) = (sums.onward[node] as f64, sums.lateral[node] as f64);
            let (onward, all) = (leader * onward, leader * onward + (1.0 - leader) * sideways);
            self.flow[node] = flow;
            self.onward[node] = if all > 0.0 { flow * (onward / all) } else { 0.0 };
            lateral[node] = if all > 0.0 { flow - self.onward[node] } else { 0.0 };
            self.bud[node] = part(lateral[node], sums.light[node].into(), sums.lateral[node]);
        }
    }

    /// The priority model (Pałubicki et al. 2009, section 4.3): along an axis the apex comes first, then laterals
    /// by the mean light of their buds; entry i of N has the weight `1 − (1 − least)·i/(κN)`, from i = κN on `least`,
    /// and shares are as light times weight. The lateral buds of a node are one entry.
    fn axis_by_axis(&mut self, nodes: &Nodes, sums: &Sums, settings: &SelfOrganizing, year: u32) {
        let children = Children::new(nodes);
        let mut entries = Vec::new();
        for first in 0..nodes.len() {
            if nodes.parents[first] == NO_PARENT {
                self.flow[first] = income(sums, first, settings, year);
            } else if !nodes.is(first, LATERAL) {
                continue;
            }
            entries.clear();
            let mut apex = None;
            let mut node = Some(first);
            while let Some(at) = node {
                if nodes.is(at, APEX) {
                    apex = Some(Entry::apex(at, sums));
                }
                if nodes.buds[at] != 0 {
                    entries.push(Entry::buds(at, nodes, sums));
                }
                node = None;
                for &child in children.of(at) {
                    if nodes.is(child as usize, LATERAL) {
                        entries.push(Entry::branch(child as usize, sums));
                    } else {
                        node = Some(child as usize);
                    }
                }
            }
            entries.sort_by(|a, b| b.mean().total_cmp(&a.mean()).then(a.node.cmp(&b.node)));
            entries.splice(0..0, apex);
            self.weigh(first, nodes, &entries, settings);
        }
    }

    fn weigh(&mut self, first: usize, nodes: &Nodes, entries: &[Entry], settings: &SelfOrganizing) {
        let falling = settings.priority_share * entries.len() as f64;
        let weight = |i: usize| {
            let i = i as f64;
            if i < falling {
                1.0 - (1.0 - settings.priority_least) * i / falling
            } else {
                settings.priority_least
            }
        };
        let weighted = |(i, entry): (usize, &Entry)| entry.light as f64 * weight(i);
        let all: f64 = entries.iter().enumerate().map(weighted).sum();
        let flow = self.flow[first];
        for (i, entry) in entries.iter().enumerate() {
            let share = if all > 0.0 { flow * (weighted((i, entry)) / all) } else { 0.0 };
            match entry.kind {
                EntryKind::Apex => self.onward[entry.node] = share,
                EntryKind::Buds => {
                    self.bud[entry.node] = share / f64::from(nodes.buds[entry.node].count_ones());
                }
                EntryKind::Branch => self.flow[entry.node] = share,
            }
        }
    }
}

/// What a whole tree gets in a year.
fn income(sums: &Sums, foot: usize, settings: &SelfOrganizing, year: u32) -> f64 {
    settings.vigor_in(year) * (sums.total(foot) as f64 / f64::from(FULL_LIGHT))
}

/// `whole·light/all`, the whole where they are equal.
fn part(whole: f64, light: u64, all: u64) -> f64 {
    if light == 0 { 0.0 } else { whole * (light as f64 / all as f64) }
}

impl SelfOrganizing {
    /// α in a year: from a certain age on, halved again and again in equal times.
    pub(crate) fn vigor_in(&self, year: u32) -> f64 {
        let old = year.saturating_sub(self.decline_from);
        let Some(half_years) = self.decline_years.filter(|_| old > 0) else { return self.vigor };
        self.vigor * libm::exp2(-f64::from(old) / half_years)
    }

    /// λ of an order in a year.
    pub(crate) fn leader_in(&self, year: u32, order: u8) -> f64 {
        let young = of_order(&self.leader, order);
        let Some(mature) = self.mature_leader else { return young };
        let (from, to) = (f64::from(self.mature_from), f64::from(self.mature_to));
        let share = if to > from {
            (f64::from(year) - from) / (to - from)
        } else {
            f64::from(u8::from(year > self.mature_from))
        };
        young + (mature - young) * share.clamp(0.0, 1.0)
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum EntryKind {
    Apex,
    Buds,
    Branch,
}

/// What an axis feeds.
#[derive(Clone, Copy, Debug)]
struct Entry {
    node: usize,
    kind: EntryKind,
    light: u64,
    buds: u32,
}

impl Entry {
    fn apex(node: usize, sums: &Sums) -> Self {
        Self { node, kind: EntryKind::Apex, light: sums.light[node].into(), buds: 1 }
    }

    fn buds(node: usize, nodes: &Nodes, sums: &Sums) -> Self {
        let buds = nodes.buds[node].count_ones();
        Self { node, kind: EntryKind::Buds, light: u64::from(sums.light[node]) * u64::from(buds), buds }
    }

    fn branch(node: usize, sums: &Sums) -> Self {
        Self { node, kind: EntryKind::Branch, light: sums.total(node), buds: sums.buds[node] }
    }

    fn mean(&self) -> f64 {
        self.light as f64 / f64::from(self.buds.max(1))
    }
}

/// The children of all nodes.
struct Children {
    ends: Vec<u32>,
    nodes: Vec<u32>,
}

impl Children {
    fn new(nodes: &Nodes) -> Self {
        // Where each list starts; filling moves it to its end.
        let mut ends = vec![0_u32; nodes.len() + 1];
        let born = |node: &usize| nodes.parents[*node] != NO_PARENT;
        (0..nodes.len()).filter(born).for_each(|node| ends[nodes.parents[node] as usize + 1] += 1);
        (1..ends.len()).for_each(|i| ends[i] += ends[i - 1]);
        let mut list = vec![0; ends.last().map_or(0, |&all| all as usize)];
        for node in (0..nodes.len()).filter(born) {
            let end = &mut ends[nodes.parents[node] as usize];
            list[*end as usize] = node as u32;
            *end += 1;
        }
        Self { ends, nodes: list }
    }

    fn of(&self, node: usize) -> &[u32] {
        let first = if node == 0 { 0 } else { self.ends[node - 1] };
        &self.nodes[first as usize..self.ends[node] as usize]
    }
}
