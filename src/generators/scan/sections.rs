//! From points on bark and leaves to points along axes.
//!
//! Points at the same distance from the root along the tree, and connected, go around one branch; their
//! centre lies on its axis (Verroust & Lazarus 1999, *Extracting skeletal curves from 3D scattered data*;
//! Xu, Gossett & Chen 2007, *Knowledge and heuristic-based modeling of laser-scanned trees*).

use glam::DVec3;
use rayon::prelude::*;

use super::bridges::Pieces;
use super::graph::{Graph, Ways};
use super::trunk::Trunk;
use super::z_order;

/// Points of one section are joined by links no longer than the wood is thick there, as far as its way beyond lets expect:
/// at least this part of the reach. Twigs that grow side by side are not tied together.
const JOINED: f64 = 0.65;

/// The weight of a centre that smoothing leaves where it is.
const FIXED: f64 = 1e9;

/// What are leaves and ends within this way is the blade of one and no twig, metres.
const BLADE_M: f64 = 0.1;

/// The median of each coordinate: unlike the mean it stays in the stem where weeds or a thin
/// twig hang on one side of it.
fn middle(points: &mut [DVec3]) -> DVec3 {
    let half = points.len() / 2;
    DVec3::from([0, 1, 2].map(|axis| {
        points.sort_unstable_by(|a, b| a[axis].total_cmp(&b[axis]));
        // Between the two in the middle, if there are two.
        0.5 * (points[half][axis] + points[(points.len() - 1) / 2][axis])
    }))
}

/// How far apart points of one cross-section are at most, where wood is so thick, metres.
fn joined_m(reach_m: f64, thick_m: f64) -> f64 {
    thick_m.clamp(JOINED * reach_m, reach_m)
}

/// Which of some sections are leaves that end soon.
fn blades(
    ways: &Ways,
    leaves: &[bool],
    mut section_of: impl FnMut(u32) -> usize,
    sections: usize,
) -> Vec<bool> {
    let mut spans_m = vec![(f64::INFINITY, 0.0_f64); sections];
    for (i, beyond_m) in ways.beyond_m().into_iter().enumerate().filter(|&(i, _)| leaves[i]) {
        let span = &mut spans_m[section_of(i as u32)];
        *span = (span.0.min(ways.length[i]), span.1.max(ways.length[i] + beyond_m));
    }
    spans_m.into_iter().map(|(from_m, to_m)| to_m > 0.0 && to_m - from_m < BLADE_M).collect()
}

/// Centres of cross-sections and the section each hangs on.
pub(super) struct Sections {
    /// The roots, then sections before those that hang on them.
    pub centres: Vec<DVec3>,
    /// [`None`] for the roots only.
    pub parents: Vec<Option<u32>>,
    /// How many points each centre stands for.
    sizes: Vec<f64>,
    /// Sections on which none hangs though there is bark beyond them: no tips, but shards of a
    /// cross-section that was reached over two bridges. And blades of leaves, which no twig leads into.
    shards: Vec<bool>,
}

impl Sections {
    /// Cuts the graph into sections `width` long along the ways from the foot; `radii_m` is how thick wood is expected to be there.
    /// On the bark of `trunks`, each of which stands on one of the roots, the axes of these stand for sections.
    /// What are `leaves` makes no section with what is wood.
    pub fn new(
        graph: &Graph,
        (ways, radii_m): (&Ways, &[f64]),
        (roots, trunks): (&[DVec3], &[Trunk]),
        leaves: &[bool],
        width: f64,
    ) -> Self {
        let count = graph.points.len() as u32;
        let place = |p: DVec3| (0..).zip(trunks).find_map(|(n, trunk)| Some((n, trunk.place(p)?.0)));
        let on_trunk: Vec<Option<(usize, usize)>> = graph.points.par_iter().map(|&p| place(p)).collect();
        let levels: Vec<u64> = ways.length.iter().map(|length| (length / width) as u64).collect();
        let level = |i: u32| levels[i as usize];
        let mut pieces = Pieces::new(graph.points.len());
        for (a, b) in graph.pairs().filter(|&(a, b)| a < b && level(a) == level(b)) {
            let is_off = on_trunk[a as usize].is_none() && on_trunk[b as usize].is_none();
            let is_same = leaves.is_empty() || leaves[a as usize] == leaves[b as usize];
            let thick_m = || 2.0 * radii_m[a as usize].max(radii_m[b as usize]);
            if is_off && is_same && graph.distance(a, b) <= joined_m(graph.reach, thick_m()) {
                pieces.join(a, b);
            }
        }
        // Sections in the order of their nearest point, so that parents come first.
        let length = |i: u32| ways.length[i as usize];
        // Bits of non-negative floats order as the floats do.
        let mut order: Vec<(u64, u32)> = (0..count).map(|i| (length(i).to_bits(), i)).collect();
        z_order::sort(&mut order);
        let mut section_of = vec![u32::MAX; graph.points.len()];
        let mut parents = vec![None; roots.len()];
        let mut members: Vec<Vec<DVec3>> = roots.iter().map(|&root| vec![root]).collect();
        // Of each section the point that is farthest from the foot.
        let mut ends = roots.to_vec();
        let mut rings: Vec<u32> = Vec::with_capacity(trunks.len());
        for trunk in trunks {
            rings.push(members.len() as u32);
            for (n, at) in trunk.axis().enumerate() {
                let below = || (0..roots.len() as u32).find(|&root| roots[root as usize] == trunk.foot());
                parents.push(if n == 0 { below() } else { Some(members.len() as u32 - 1) });
                members.push(vec![at]);
                ends.push(at);
            }
        }
        let first_section = members.len();
        for (i, place) in on_trunk.iter().enumerate() {
            if let Some((trunk, ring)) = place {
                section_of[i] = rings[*trunk] + *ring as u32;
            }
        }
        for &(_, i) in &order {
            let piece = pieces.of(i) as usize;
            if section_of[piece] == u32::MAX {
                section_of[piece] = members.len() as u32;
                let before = ways.before[i as usize];
                parents.push((before != i).then(|| section_of[pieces.of(before) as usize]));
                members.push(Vec::new());
                ends.push(DVec3::ZERO);
            }
            if on_trunk[i as usize].is_some() {
                continue;
            }
            members[section_of[piece] as usize].push(graph.points[i as usize]);
            ends[section_of[piece] as usize] = graph.points[i as usize];
        }
        let centres = members.iter_mut().map(|points| middle(points)).collect();
        let size = |(n, points): (usize, &Vec<DVec3>)| {
            let is_ring = (roots.len()..first_section).contains(&n);
            if is_ring { FIXED } else { points.len() as f64 }
        };
        let sizes = members.iter().enumerate().map(size).collect();
        // Points beyond a section, and no section that hangs on it.
        let mut shards = vec![false; members.len()];
        for (a, b) in graph.pairs() {
            if level(a) < level(b) && graph.distance(a, b) <= graph.reach {
                shards[section_of[pieces.of(a) as usize] as usize] = true;
            }
        }
        for parent in parents.iter().flatten() {
            shards[*parent as usize] = false;
        }
        if !leaves.is_empty() {
            let is_blade =
                blades(ways, leaves, |i| section_of[pieces.of(i) as usize] as usize, parents.len());
            shards.iter_mut().zip(is_blade).for_each(|(shard, is_blade)| *shard |= is_blade);
        }
        let mut sections = Self { centres, parents, sizes, shards };
        sections.hang_starts(first_section);
        sections.end_at(&ends);
        sections
    }

    /// Gives each section from `first` on that has no parent the nearest one before it: the foot is a start as a whole, some
    /// sections high, one above the other.
    fn hang_starts(&mut self, first: usize) {
        for i in first..self.centres.len() {
            if self.parents[i].is_none() {
                let centre = self.centres[i];
                let away = |j: &u32| self.centres[*j as usize].distance_squared(centre);
                let nearest = (0..i as u32).min_by(|a, b| away(a).total_cmp(&away(b)));
                self.parents[i] = nearest;
                if let Some(parent) = nearest {
                    self.shards[parent as usize] = false;
                }
            }
        }
    }

    /// Lets each section that none hangs on end where its last point is, not in its middle.
    fn end_at(&mut self, ends: &[DVec3]) {
        let mut is_last = vec![true; self.parents.len()];
        for parent in self.parents.iter().flatten() {
            is_last[*parent as usize] = false;
        }
        for (i, &end) in ends.iter().enumerate() {
            if !is_last[i] || self.shards[i] || self.parents[i].is_none() {
                continue;
            }
            self.centres.push(end);
            self.parents.push(Some(i as u32));
            self.sizes.push(1.0);
            self.shards.push(false);
        }
    }

    /// Moves each centre towards the middle of its neighbours along the way with the most sections
    /// beyond: halfway between equals, farther where it has few points (a section at the rim of a gap
    /// sees one side of the stem only). Takes out zigzag, keeps ends.
    pub fn smooth(&mut self, rounds: usize) {
        let count = self.centres.len();
        let mut beyond = vec![1_u32; count];
        for i in (0..count).rev() {
            if let Some(parent) = self.parents[i] {
                beyond[parent as usize] += beyond[i];
            }
        }
        let mut main: Vec<Option<u32>> = vec![None; count];
        for i in 0..count {
            if let Some(parent) = self.parents[i] {
                let main = &mut main[parent as usize];
                if main.is_none_or(|other| beyond[other as usize] < beyond[i]) {
                    *main = Some(i as u32);
                }
            }
        }
        for _ in 0..rounds {
            let old = self.centres.clone();
            for i in 0..count {
                if let (Some(parent), Some(child)) = (self.parents[i], main[i]) {
                    let middle = 0.5 * (old[parent as usize] + old[child as usize]);
                    let around = self.sizes[parent as usize] + self.sizes[child as usize];
                    self.centres[i] = old[i].lerp(middle, around / (around + 2.0 * self.sizes[i]));
                }
            }
        }
    }

    /// The centres, and points between those farther apart than `spacing`: at most some fifty times as
    /// many as centres, with wider spacing if that does not do. (Dust a thousand kilometres away must
    /// not take all memory.)
    pub fn points(&self, spacing: f64) -> Vec<DVec3> {
        let from = |parent: &Option<u32>| parent.map(|parent| self.centres[parent as usize]);
        let links = self.centres.iter().zip(&self.parents);
        let total: f64 =
            links.map(|(&centre, parent)| from(parent).map_or(0.0, |p| p.distance(centre))).sum();
        let spacing = spacing.max(total / (50.0 * self.centres.len() as f64 + 1000.0));
        let mut points = Vec::with_capacity(self.centres.len());
        for (i, (&centre, parent)) in self.centres.iter().zip(&self.parents).enumerate() {
            if self.shards[i] {
                continue;
            }
            if let Some(from) = from(parent) {
                let parts = (from.distance(centre) / spacing).ceil().max(1.0) as u32;
                points.extend((1..parts).map(|k| from.lerp(centre, f64::from(k) / f64::from(parts))));
            }
            points.push(centre);
        }
        points
    }
}
