//! From points on bark and leaves to points along axes.
//!
//! Points at the same distance from the root along the tree, and connected, go around one branch; their
//! centre lies on its axis (Verroust & Lazarus 1999, *Extracting skeletal curves from 3D scattered data*;
//! Xu, Gossett & Chen 2007, *Knowledge and heuristic-based modeling of laser-scanned trees*).
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

use super::cells::{Cells, Near};
use super::neighbours::Neighbours;
use super::retain_unmarked;
use super::trunk::Trunk;
use super::z_order;
use linden_base::monitor::{Cancelled, Monitor};

/// Links per point: enough to close a ring of points around a stem.
const LINKS: usize = 12;

/// Points of one section are joined by links no longer than the wood is thick there, as far as its way beyond lets expect:
/// at least this part of the reach. Twigs that grow side by side are not tied together.
const JOINED: f64 = 0.65;

/// The weight of a centre that smoothing leaves where it is.
const FIXED: f64 = 1e9;

/// Other pieces that a point is linked to at most.
const BRIDGES: usize = 6;

/// Bridges beyond the spanning tree's are looked for within this many reaches.
const BRIDGE_REACH: f64 = 10.0;

/// What are leaves and ends within this way is the blade of one and no twig, metres.
const BLADE_M: f64 = 0.1;

/// A metre over leaves counts for so many.
const LEAF_METRE: f64 = 3.0;

/// Where a way came from is told so many links back.
const BACK: usize = 10;

/// Points between two looks at the monitor.
const POINTS_PER_CHECK: usize = 1024;

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
        let mut pieces = Pieces::new(points.len());
        for (from, nearest) in (0..).zip(&nearest) {
            for &to in nearest {
                pieces.join(from, to);
            }
        }
        let mut bridges = Vec::new();
        if !pieces.is_one() {
            let tree = Neighbours::new(&points, monitor)?;
            other_bridges(&points, &tree, &mut pieces, reach, &mut bridges, monitor)?;
            loop {
                let shortest = shortest_bridges(&points, &tree, &mut pieces, monitor)?;
                if shortest.is_empty() {
                    break;
                }
                for (_, from, to) in shortest {
                    if pieces.join(from, to) {
                        bridges.extend([(from, to), (to, from)]);
                    }
                }
            }
            bridges.sort_unstable();
            bridges.dedup();
        }
        let (links, starts) = by_point(&nearest, &bridges);
        Ok(Self { points, reach, links, starts, strays })
    }

    fn distance(&self, a: u32, b: u32) -> f64 {
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
    fn pairs(&self) -> impl Iterator<Item = (u32, u32)> {
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

/// Of each point the nearest others, then itself in what is left.
pub(super) type LinkedTo = [u32; LINKS];

/// Within this part of the reach there mostly are as many as links are made to.
const FULL: f32 = 0.65;

/// The nearest points of each within `reach`, and what `weigh` makes of all that are so near, itself among them.
pub(super) fn links_within(
    points: &[DVec3],
    reach: f64,
    weigh: impl Fn(&[Near]) -> u32 + Sync,
    monitor: &dyn Monitor,
) -> Result<(Vec<LinkedTo>, Vec<u32>), Cancelled> {
    let full = (FULL * reach as f32) * (FULL * reach as f32);
    let of_point = |from: u32, near: &mut Vec<Near>| {
        let weight = weigh(near);
        let mut nearest = [from; LINKS];
        if near.iter().filter(|near| near.squared_m() < full).count() > LINKS {
            near.retain(|near| near.squared_m() < full);
        }
        near.retain(|near| near.index() != from);
        if near.len() > LINKS {
            near.select_nth_unstable(LINKS);
        }
        for (nearest, near) in nearest.iter_mut().zip(&*near) {
            *nearest = near.index();
        }
        (nearest, weight)
    };
    Ok(Cells::new(points, reach).map(of_point, monitor)?.into_iter().unzip())
}

/// The same without the points that are marked, counted anew.
pub(super) fn without(mut nearest: Vec<LinkedTo>, is_marked: &[bool]) -> Vec<LinkedTo> {
    let mut left = 0;
    let places: Vec<u32> = is_marked
        .iter()
        .map(|&is_marked| {
            let place = left;
            left += u32::from(!is_marked);
            if is_marked { u32::MAX } else { place }
        })
        .collect();
    let mut from = 0;
    nearest.retain_mut(|nearest| {
        let place = places[from];
        for to in &mut *nearest {
            let left = places[*to as usize];
            *to = if left == u32::MAX { place } else { left };
        }
        from += 1;
        place != u32::MAX
    });
    nearest
}

/// Links of each point with its nearest, in both directions, and others: where those of each go, and where they begin.
fn by_point(nearest: &[LinkedTo], others: &[(u32, u32)]) -> (Vec<u32>, Vec<usize>) {
    let of_nearest = || {
        let links = (0..).zip(nearest).flat_map(|(from, list)| list.iter().map(move |&to| (from, to)));
        links.filter(|&(from, to)| to != from)
    };
    // Those that are mutual stand in both lists.
    let is_one_way = |&(from, to): &(u32, u32)| !nearest[to as usize].contains(&from);
    let back: Vec<(u32, u32)> = of_nearest().filter(is_one_way).map(|(from, to)| (to, from)).collect();
    let all = || of_nearest().chain(back.iter().copied()).chain(others.iter().copied());
    let mut starts = vec![0; nearest.len() + 1];
    for (from, _) in all() {
        starts[from as usize + 1] += 1;
    }
    for point in 0..nearest.len() {
        starts[point + 1] += starts[point];
    }
    let mut next = starts.clone();
    let mut links = vec![0; starts[nearest.len()]];
    for (from, to) in all() {
        let slot = &mut next[from as usize];
        links[*slot] = to;
        *slot += 1;
    }
    (links, starts)
}

/// Which points have no two others nearby: dust, birds, scattered pulses. `None` for a cloud so thin that all of it looks
/// like that: it is meant to be so.
fn strays(
    points: &[DVec3],
    nearest: &[LinkedTo],
    reach: f64,
    monitor: &dyn Monitor,
) -> Result<Option<Vec<bool>>, Cancelled> {
    // The few that have no two within reach are searched for farther off.
    let is_lonely = |(from, nearest): (u32, &LinkedTo)| nearest.iter().filter(|&&to| to != from).count() < 2;
    let lonely = (0..).zip(nearest).filter(|&one| is_lonely(one)).map(|(from, _)| from);
    let lonely: Vec<u32> = lonely.collect();
    if lonely.is_empty() {
        return Ok(None);
    }
    let tree = Neighbours::new(points, monitor)?;
    let of_some = |some: &[u32]| {
        monitor.check()?;
        let mut found = Vec::new();
        let mut is_stray = |from: &u32| {
            tree.nearest(points[*from as usize], 3, 2.0 * reach, &mut found);
            found.len() < 3
        };
        Ok(some.iter().copied().filter(&mut is_stray).collect())
    };
    let strays: Vec<Vec<u32>> =
        lonely.par_chunks(POINTS_PER_CHECK).map(of_some).collect::<Result<_, Cancelled>>()?;
    let strays = strays.concat();
    if strays.is_empty() || strays.len() * 2 > points.len() {
        return Ok(None);
    }
    let mut is_stray = vec![false; points.len()];
    for stray in strays {
        is_stray[stray as usize] = true;
    }
    Ok(Some(is_stray))
}

/// Links each point outside the largest piece to the nearest point of several other pieces.
fn other_bridges(
    points: &[DVec3],
    tree: &Neighbours,
    pieces: &mut Pieces,
    reach: f64,
    links: &mut Vec<(u32, u32)>,
    monitor: &dyn Monitor,
) -> Result<(), Cancelled> {
    let (labels, largest) = pieces.labels();
    let of_ranges = tree.labels(&labels);
    let limit = (BRIDGE_REACH * reach) * (BRIDGE_REACH * reach);
    let mut nearest: Vec<(f64, u32, u32)> = Vec::new();
    for (from, &p) in (0..).zip(points) {
        if from % 256 == 0 {
            monitor.check()?;
        }
        if labels[from as usize] == largest {
            continue;
        }
        nearest.clear();
        tree.search_other(p, limit, (labels[from as usize], &of_ranges), |to, squared| {
            let label = labels[to as usize];
            match nearest.iter_mut().find(|other| other.2 == label) {
                Some(other) if (squared, to) < (other.0, other.1) => *other = (squared, to, label),
                Some(_) => {}
                None => nearest.push((squared, to, label)),
            }
            nearest.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            nearest.truncate(BRIDGES);
            if nearest.len() == BRIDGES { nearest[BRIDGES - 1].0.next_up().min(limit) } else { limit }
        });
        links.extend(nearest.iter().flat_map(|&(_, to, _)| [(from, to), (to, from)]));
    }
    Ok(())
}

/// For each piece but the largest, its shortest link to another (one round of Borůvka 1926).
fn shortest_bridges(
    points: &[DVec3],
    tree: &Neighbours,
    pieces: &mut Pieces,
    monitor: &dyn Monitor,
) -> Result<Vec<(f64, u32, u32)>, Cancelled> {
    let (labels, largest) = pieces.labels();
    // A piece's points lie together: without passing over its ranges at once, each of them would look at all.
    let of_ranges = tree.labels(&labels);
    let mut best = vec![(f64::INFINITY, 0, 0); points.len()];
    for (from, &p) in (0..).zip(points) {
        if from % 1024 == 0 {
            monitor.check()?;
        }
        let label = labels[from as usize];
        if label == largest {
            continue;
        }
        let best = &mut best[label as usize];
        tree.search_other(p, best.0, (label, &of_ranges), |to, squared| {
            if (squared, from, to) < *best {
                *best = (squared, from, to);
            }
            best.0
        });
    }
    best.retain(|bridge| bridge.0.is_finite());
    best.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then((a.1, a.2).cmp(&(b.1, b.2))));
    Ok(best)
}

/// Which points hang together (disjoint sets, Tarjan 1975).
struct Pieces(Vec<u32>);

impl Pieces {
    fn new(count: usize) -> Self {
        Self((0..count as u32).collect())
    }

    fn is_one(&mut self) -> bool {
        (0..self.0.len() as u32).all(|i| self.of(i) == 0)
    }

    fn of(&mut self, mut i: u32) -> u32 {
        while self.0[i as usize] != i {
            self.0[i as usize] = self.0[self.0[i as usize] as usize];
            i = self.0[i as usize];
        }
        i
    }

    /// The piece of each point, and the largest piece (the first of equals).
    fn labels(&mut self) -> (Vec<u32>, u32) {
        let labels: Vec<u32> = (0..self.0.len() as u32).map(|i| self.of(i)).collect();
        let mut sizes = vec![0_u32; labels.len()];
        for &label in &labels {
            sizes[label as usize] += 1;
        }
        let largest = (0..labels.len() as u32).max_by_key(|&i| (sizes[i as usize], Reverse(i)));
        (labels, largest.unwrap_or(0))
    }

    /// Whether they hung apart. The lower index names the piece.
    fn join(&mut self, a: u32, b: u32) -> bool {
        let (a, b) = (self.of(a), self.of(b));
        self.0[a.max(b) as usize] = a.min(b);
        a != b
    }
}

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
            if is_off && is_same && {
                let thick_m = 2.0 * radii_m[a as usize].max(radii_m[b as usize]);
                graph.distance(a, b) <= thick_m.clamp(JOINED * graph.reach, graph.reach)
            } {
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
            let mut spans_m = vec![(f64::INFINITY, 0.0_f64); parents.len()];
            for (i, beyond_m) in ways.beyond_m().into_iter().enumerate().filter(|&(i, _)| leaves[i]) {
                let span = &mut spans_m[section_of[pieces.of(i as u32) as usize] as usize];
                *span = (span.0.min(ways.length[i]), span.1.max(ways.length[i] + beyond_m));
            }
            for (shard, (from_m, to_m)) in shards.iter_mut().zip(spans_m) {
                *shard |= to_m > 0.0 && to_m - from_m < BLADE_M;
            }
        }
        let mut sections = Self { centres, parents, sizes, shards };
        // The foot is a start as a whole, some sections high: one above the other.
        for i in first_section..sections.centres.len() {
            if sections.parents[i].is_none() {
                let centre = sections.centres[i];
                let away = |j: &u32| sections.centres[*j as usize].distance_squared(centre);
                let nearest = (0..i as u32).min_by(|a, b| away(a).total_cmp(&away(b)));
                sections.parents[i] = nearest;
                if let Some(parent) = nearest {
                    sections.shards[parent as usize] = false;
                }
            }
        }
        sections.end_at(&ends);
        sections
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

#[cfg(test)]
mod tests {
    use super::*;
    use linden_base::monitor::Quiet;
    use linden_base::random::Key;

    fn scattered(count: u64) -> Vec<DVec3> {
        let point = |i| DVec3::from([0, 1, 2].map(|axis| Key::new(3).child(i).child(axis).unit()));
        (0..count).map(point).collect()
    }

    fn links_of(points: &[DVec3], from: usize, reach: f64) -> Vec<u32> {
        let mut all: Vec<(f64, u32)> = points.iter().map(|p| p.distance(points[from])).zip(0..).collect();
        all.retain(|&(away, to)| away < reach && to as usize != from);
        all.sort_by(|a, b| a.0.total_cmp(&b.0));
        all.truncate(LINKS);
        let mut nearest: Vec<u32> = all.iter().map(|&(_, to)| to).collect();
        nearest.sort_unstable();
        nearest
    }

    #[test]
    fn links_lead_to_the_nearest_and_back() {
        let points = scattered(700);
        for reach in [0.05, 0.12, 0.3] {
            let (nearest, near) = links_within(&points, reach, |near| near.len() as u32, &Quiet).unwrap();
            let mut pairs: Vec<(u32, u32)> = Vec::new();
            for (from, found) in nearest.iter().enumerate() {
                let mut found: Vec<u32> = found.iter().copied().filter(|&to| to as usize != from).collect();
                found.sort_unstable();
                assert_eq!(found, links_of(&points, from, reach));
                let around = points.iter().filter(|p| p.distance(points[from]) < reach).count();
                assert_eq!(near[from] as usize, around);
                pairs.extend(found.iter().flat_map(|&to| [(from as u32, to), (to, from as u32)]));
            }
            pairs.extend([(0, 1), (1, 0)]);
            pairs.sort_unstable();
            pairs.dedup();
            let bridge = if pairs.contains(&(0, 1)) && nearest[0].contains(&1) {
                vec![]
            } else {
                vec![(0, 1), (1, 0)]
            };
            let (links, starts) = by_point(&nearest, &bridge);
            let mut found: Vec<(u32, u32)> = (0..points.len())
                .flat_map(|from| {
                    links[starts[from]..starts[from + 1]].iter().map(move |&to| (from as u32, to))
                })
                .collect();
            found.sort_unstable();
            found.dedup();
            assert_eq!(found, pairs);
        }
    }

    #[test]
    fn what_is_taken_out_is_linked_no_more_and_all_else_is() {
        let points = scattered(400);
        let (nearest, _) = links_within(&points, 0.2, |_| 0, &Quiet).unwrap();
        let is_out: Vec<bool> = (0..points.len()).map(|i| i % 7 == 3).collect();
        let kept: Vec<usize> = (0..points.len()).filter(|&i| !is_out[i]).collect();
        let left = without(nearest.clone(), &is_out);
        assert_eq!(left.len(), kept.len());
        for (place, (&from, left)) in kept.iter().zip(&left).enumerate() {
            let given = nearest[from].iter().filter(|&&to| to as usize != from && !is_out[to as usize]);
            let found = left.iter().filter(|&&to| to as usize != place).map(|&to| kept[to as usize] as u32);
            assert_eq!(found.collect::<Vec<u32>>(), given.copied().collect::<Vec<u32>>());
        }
    }

    #[test]
    fn pieces_far_apart_are_bridged_without_looking_at_all_pairs() {
        // Two walls of 60 by 60 points, 50 m apart.
        let wall = |x: f64| {
            (0..3600_u16).map(move |i| DVec3::new(x, 0.1 * f64::from(i / 60), 0.1 * f64::from(i % 60)))
        };
        let points: Vec<DVec3> = wall(0.0).chain(wall(50.0)).collect();
        let tree = Neighbours::new(&points, &Quiet).unwrap();
        let mut pieces = Pieces::new(points.len());
        for i in 1..3600 {
            pieces.join(0, i);
            pieces.join(3600, 3600 + i);
        }
        let bridges = shortest_bridges(&points, &tree, &mut pieces, &Quiet).unwrap();
        assert_eq!(bridges, [(2500.0, 3600, 0)]);
        // 3600 times 7200 are 26 million.
        assert!(tree.looks() < 400_000, "{}", tree.looks());
    }
}
