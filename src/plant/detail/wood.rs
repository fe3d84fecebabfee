//! The wood with less of it: which axes stay, and which nodes shape them.

use glam::Vec3;

use super::Detail;
use super::exposure::Exposure;
use linden_base::monitor::{Cancelled, Monitor};
use linden_skeleton::{Axis, Marks, NO_PARENT, Skeleton};

/// Fractional part of the golden ratio: its multiples fill the unit interval evenly at every moment
/// (Weyl's sequence with the least discrepancy).
pub(super) const GOLDEN: f64 = 0.618_033_988_749_894_9;
/// Of things that matter equally, the last goes when this share more is given up than for the first. In
/// a grammar's tree hundreds are equal, and a rule that took all at once could not meet a budget.
const SPREAD: f32 = 0.5;
/// What a node counts that lies straight between its neighbours, as a share of their distance: long
/// straight pieces keep a node or two when there is room.
const STRAIGHT: f32 = 0.004;
/// An axis that is seen whole past the foliage counts as thicker by this many times its radius than one that is hidden
/// in it: without the first, what hangs on it would float.
const SEEN: f32 = 6.0;
/// The course of the thickest axis counts this many times more than that of a twig, that of others by how thick they are:
/// a stem that jumps by its own thickness is seen from far away, from level to level as well.
const STEM: f32 = 5.0;
/// Axes between two looks at the monitor.
const AXES_PER_CHECK: usize = 1024;

/// When the `index`-th of equal things goes, as a multiple of when the first does.
fn later(index: u32) -> f32 {
    1.0 + SPREAD * (f64::from(index) * GOLDEN).fract() as f32
}

/// A skeleton, and what matters of it.
pub(super) struct Wood<'a> {
    skeleton: &'a Skeleton,
    /// For each axis the [`Detail::smallest_radius_m`] up to which it stays: never more than its parent's.
    stays: Vec<f32>,
    /// For each node the [`Detail::tolerance_m`] up to which it is needed; infinite at both ends of an axis.
    needed: Vec<f32>,
    /// The axis of each node.
    axis_of: Vec<u32>,
}

impl<'a> Wood<'a> {
    pub fn new(
        skeleton: &'a Skeleton,
        exposure: &Exposure,
        monitor: &dyn Monitor,
    ) -> Result<Self, Cancelled> {
        let mut axis_of = vec![0; skeleton.positions.len()];
        let mut needed = vec![f32::INFINITY; skeleton.positions.len()];
        let mut stays = Vec::with_capacity(skeleton.axes.len());
        let mut splitter = Splitter::default();
        let thickest_m = thickest_m(skeleton).max(f32::MIN_POSITIVE);
        for (index, axis) in skeleton.axes.iter().enumerate() {
            if index.is_multiple_of(AXES_PER_CHECK) {
                monitor.check()?;
            }
            let nodes = skeleton.nodes_of(axis);
            for &node in nodes {
                axis_of[node as usize] = index as u32;
            }
            let base_m = nodes.first().map_or(0.0, |&node| skeleton.radii[node as usize]);
            let limit_m = base_m * later(index as u32) * (1.0 + SEEN * exposure.at(index));
            let parent_m = match axis.parent {
                NO_PARENT => f32::INFINITY,
                node => stays[axis_of[node as usize] as usize],
            };
            stays.push(limit_m.min(parent_m));
            splitter.rank(skeleton, axis, 1.0 + STEM * base_m / thickest_m, &mut needed);
        }
        // Something must stay: the thickest stem, the first of those. Of one that forks where it begins there is nothing to
        // be seen: then the thickest that leaves there, too.
        let leaves_from = |axis: usize| skeleton.axes[axis].parent;
        let thicker = |a: &usize, b: &usize| stays[*a].total_cmp(&stays[*b]).then(b.cmp(a));
        let is_stem = |axis: &usize| leaves_from(*axis) == NO_PARENT;
        let mut next = (0..stays.len()).filter(is_stem).max_by(thicker);
        let mut kept = Vec::new();
        while let Some(axis) = next {
            kept.push(axis);
            let is_on = |lateral: &usize| {
                !is_stem(lateral) && axis_of[leaves_from(*lateral) as usize] as usize == axis
            };
            let laterals = (axis + 1..stays.len()).filter(is_on);
            next = if has_length(skeleton, axis) { None } else { laterals.max_by(thicker) };
        }
        for axis in kept {
            stays[axis] = f32::INFINITY;
        }
        Ok(Self { skeleton, stays, needed, axis_of })
    }

    /// For each node whether its axis is left out.
    pub fn thin_nodes(&self, detail: &Detail) -> Vec<bool> {
        self.axis_of.iter().map(|&axis| self.stays[axis as usize] < detail.smallest_radius_m).collect()
    }

    pub const fn skeleton(&self) -> &Skeleton {
        self.skeleton
    }

    /// The thickest that the tree has, metres.
    pub fn thickest_m(&self) -> f32 {
        thickest_m(self.skeleton)
    }

    /// How many stems are at their feet no thinner than a share of the thickest; at least one.
    pub fn stems(&self, share: f32) -> usize {
        let skeleton = self.skeleton;
        let stems = skeleton.axes.iter().filter(|axis| axis.parent == NO_PARENT);
        let feet = stems.filter_map(|axis| skeleton.nodes_of(axis).first());
        let least_m = share * self.thickest_m();
        feet.filter(|&&foot| skeleton.radii[foot as usize] >= least_m).count().max(1)
    }

    /// The longest edge of the box round it, metres.
    pub fn size_m(&self) -> f32 {
        let bounds = linden_base::mesh::Bounds::of(self.skeleton.positions.iter().copied());
        bounds.map_or(0.0, |bounds| bounds.size().max_element())
    }

    /// What stays of it, and for each axis its index in the whole.
    ///
    /// The foot and the tip of an axis stay, and each node that an axis which stays leaves from: so
    /// no branch hangs beside the wood that bears it.
    pub fn thinned(&self, detail: &Detail) -> (Skeleton, Vec<u32>) {
        let Self { skeleton: whole, stays, needed, axis_of } = self;
        let axis_stays = |axis: usize| stays[axis] >= detail.smallest_radius_m;
        let mut keep: Vec<bool> = needed
            .iter()
            .zip(axis_of)
            .map(|(&needed, &axis)| needed >= detail.tolerance_m && axis_stays(axis as usize))
            .collect();
        for (index, axis) in whole.axes.iter().enumerate() {
            if axis.parent != NO_PARENT && axis_stays(index) {
                keep[axis.parent as usize] = true;
            }
        }
        let kept = keep.iter().filter(|&&kept| kept).count();
        let mut thin = Skeleton {
            positions: Vec::with_capacity(kept),
            radii: Vec::with_capacity(kept),
            births: Vec::with_capacity(kept),
            parents: Vec::with_capacity(kept),
            axes: Vec::new(),
            axis_nodes: Vec::with_capacity(kept),
            width_steps: whole.width_steps,
            marks: Marks { tips: whole.marks.tips, ..Marks::default() },
            fits: Vec::new(),
            trees: whole.trees_of_feet(|foot| keep[foot]),
        };
        // Where a node is in the thinner tree, or else the nearest node below it that stays.
        let mut new = vec![NO_PARENT; keep.len()];
        for (node, &kept) in keep.iter().enumerate() {
            let parent = whole.parents[node];
            let below = if parent == NO_PARENT { NO_PARENT } else { new[parent as usize] };
            if !kept {
                new[node] = below;
                continue;
            }
            new[node] = thin.positions.len() as u32;
            thin.positions.push(whole.positions[node]);
            thin.radii.push(whole.radii[node]);
            thin.births.push(whole.births[node]);
            thin.parents.push(below);
        }
        let mut axes = Vec::new();
        for (index, axis) in whole.axes.iter().enumerate().filter(|(index, _)| axis_stays(*index)) {
            let first = thin.axis_nodes.len() as u32;
            let nodes = whole.nodes_of(axis).iter().filter(|&&node| keep[node as usize]);
            thin.axis_nodes.extend(nodes.map(|&node| new[node as usize]));
            let parent = if axis.parent == NO_PARENT { NO_PARENT } else { new[axis.parent as usize] };
            let len = thin.axis_nodes.len() as u32 - first;
            thin.axes.push(Axis { order: axis.order, parent, first, len });
            axes.push(index as u32);
            // Tips stay with their axes, and so do those that were cut.
            if let Some(&tip) = whole.nodes_of(axis).last().filter(|tip| whole.is_cut_at(**tip)) {
                thin.marks.cuts.push(new[tip as usize]);
            }
            if !whole.marks.is_empty() {
                thin.marks.numbers.push(whole.axis_number(index));
            }
        }
        thin.marks.cuts.sort_unstable();
        (thin, axes)
    }
}

/// Whether an axis leads anywhere.
fn has_length(skeleton: &Skeleton, axis: usize) -> bool {
    let axis = &skeleton.axes[axis];
    let root = Some(axis.parent).filter(|&node| node != NO_PARENT);
    let mut places =
        root.iter().chain(skeleton.nodes_of(axis)).map(|&node| skeleton.positions[node as usize]);
    places.next().is_some_and(|first| places.any(|place| place != first))
}

fn thickest_m(skeleton: &Skeleton) -> f32 {
    skeleton.radii.iter().copied().fold(0.0, f32::max)
}

/// Ranks the nodes of axes by how much each of them shapes its axis.
#[derive(Default)]
struct Splitter {
    /// Place and radius along the axis, from the node that it leaves from.
    line: Vec<(Vec3, f32)>,
    /// Pieces whose inside is to be ranked, with what the node that made them counts.
    open: Vec<(usize, usize, f32)>,
}

impl Splitter {
    /// After Douglas & Peucker 1973: a piece of an axis is as far from the straight line between its
    /// ends as its farthest node, which then splits it. It is looked for in the middle half, so that
    /// any axis takes time in proportion to n log n; no node counts more than the one that split
    /// its piece. The change of the radius counts like the change of place; both `times` as much.
    fn rank(&mut self, skeleton: &Skeleton, axis: &Axis, times: f32, needed: &mut [f32]) {
        let nodes = skeleton.nodes_of(axis);
        let station =
            |node: u32, thick: u32| (skeleton.positions[node as usize], skeleton.radii[thick as usize]);
        self.line.clear();
        let laterals = usize::from(axis.parent != NO_PARENT);
        if let (1, Some(&first)) = (laterals, nodes.first()) {
            self.line.push(station(axis.parent, first));
        }
        self.line.extend(nodes.iter().map(|&node| station(node, node)));
        self.open.clear();
        if self.line.len() > 2 {
            self.open.push((0, self.line.len() - 1, f32::INFINITY));
        }
        while let Some((from, to, above)) = self.open.pop() {
            let (split, error) = self.farthest(from, to);
            let node = nodes[split - laterals];
            let alone = error + STRAIGHT * self.line[from].0.distance(self.line[to].0);
            let counts = (times * alone * later(node)).min(above);
            needed[node as usize] = counts;
            for (from, to) in [(from, split), (split, to)] {
                if to - from > 1 {
                    self.open.push((from, to, counts));
                }
            }
        }
    }

    /// Where a piece is split, and how far its farthest node is from the straight line, metres.
    fn farthest(&self, from: usize, to: usize) -> (usize, f32) {
        let ((a, ra), (b, rb)) = (self.line[from], self.line[to]);
        let along = b - a;
        let over = 1.0 / along.length_squared().max(f32::MIN_POSITIVE);
        let quarter = (to - from) / 4;
        let (mut split, mut farthest, mut most) = (usize::midpoint(from, to), 0.0, 0.0);
        for at in from + 1..to {
            let (place, radius) = self.line[at];
            let t = ((place - a).dot(along) * over).clamp(0.0, 1.0);
            let error = place.distance(a + along * t).max((radius - (ra + (rb - ra) * t)).abs());
            most = f32::max(most, error);
            if error > farthest && (from + quarter..=to - quarter).contains(&at) {
                (split, farthest) = (at, error);
            }
        }
        (split, most)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::Tubes;
    use crate::testing::{Subject, body, skeleton};
    use linden_base::monitor::Quiet;

    fn with(tolerance_m: f32, smallest_radius_m: f32) -> Detail {
        Detail { tolerance_m, smallest_radius_m, ..Detail::full(&Tubes::default()) }
    }

    #[test]
    fn nothing_is_left_out_where_nothing_is_to_be() {
        for id in ["fir", "abop-b", "older-shrub"] {
            let whole = skeleton(id);
            let (thin, axes) =
                Wood::new(&whole, &Exposure::default(), &Quiet).unwrap().thinned(&with(0.0, 0.0));
            assert_eq!(thin, *whole, "{id}");
            assert!(axes.into_iter().eq(0..whole.axes.len() as u32));
        }
    }

    #[test]
    fn what_stays_is_a_tree_of_nodes_that_were_there() {
        for id in ["fir", "abop-b", "sphere"] {
            let whole = skeleton(id);
            let wood = Wood::new(&whole, &Exposure::default(), &Quiet).unwrap();
            for (tolerance_m, smallest_m) in [(0.01, 0.0), (0.0, 0.004), (0.05, 0.01), (1e3, 1e3)] {
                let (thin, axes) = wood.thinned(&with(tolerance_m, smallest_m));
                let place = |p: &Vec3| p.to_array().map(f32::to_bits);
                let there: std::collections::BTreeSet<_> = whole.positions.iter().map(place).collect();
                assert!(thin.positions.iter().all(|p| there.contains(&place(p))));
                assert_eq!(thin.axis_nodes.len(), thin.positions.len(), "each stands in one axis");
                for (axis, &whole_axis) in thin.axes.iter().zip(&axes) {
                    let before = &whole.axes[whole_axis as usize];
                    assert_eq!(axis.order, before.order);
                    // Each begins and ends where it did.
                    let (kept, all) = (thin.nodes_of(axis), whole.nodes_of(before));
                    let same = |a: u32, b: u32| {
                        assert_eq!(thin.positions[a as usize], whole.positions[b as usize], "{id}");
                    };
                    same(kept[kept.len() - 1], all[all.len() - 1]);
                    if before.parent != NO_PARENT {
                        same(axis.parent, before.parent);
                        assert_eq!(thin.parents[kept[0] as usize], axis.parent);
                    }
                    for pair in kept.windows(2) {
                        assert_eq!(thin.parents[pair[1] as usize], pair[0]);
                        assert!(pair[0] < pair[1], "parents come first");
                    }
                }
            }
            let (stem, axes) = wood.thinned(&with(1e3, 1e3));
            assert_eq!(
                (stem.axes.len(), axes.len(), stem.positions.len()),
                (1, 1, 2),
                "foot and tip of the stem"
            );
        }
    }

    #[test]
    fn of_a_tree_that_forks_where_it_begins_a_limb_stays() {
        let whole = skeleton("abop-bush");
        // Its stem is a node.
        assert_eq!(whole.axes[0].len, 1);
        let wood = Wood::new(&whole, &Exposure::default(), &Quiet).unwrap();
        let (thin, axes) = wood.thinned(&with(1e3, 1e3));
        let length = |axis: &Axis| {
            let tip = thin.nodes_of(axis).last().map(|&tip| thin.positions[tip as usize]);
            tip.map_or(0.0, |tip| tip.distance(thin.positions[axis.parent as usize]))
        };
        assert_eq!((axes.len(), thin.axes[1].parent), (2, 0));
        assert!(length(&thin.axes[1]) > 0.0);
    }

    #[test]
    fn what_is_seen_past_the_foliage_stays_longer() {
        let grown = Subject::builtin("olive", &[]).grow();
        let exposure = Exposure::of(body(&grown), &Quiet).unwrap();
        let by_sight = Wood::new(&grown.skeleton, &exposure, &Quiet).unwrap();
        let by_thickness = Wood::new(&grown.skeleton, &Exposure::default(), &Quiet).unwrap();
        let stay = |wood: &Wood<'_>| -> Vec<u32> { wood.thinned(&with(0.0, 0.06)).1 };
        let (with_sight, without) = (stay(&by_sight), stay(&by_thickness));
        assert!(without.iter().all(|axis| with_sight.contains(axis)), "none goes earlier");
        let more: Vec<u32> = with_sight.into_iter().filter(|axis| !without.contains(axis)).collect();
        let seen = |axis: u32| exposure.at(axis as usize);
        let mean = |axes: &mut dyn Iterator<Item = u32>| {
            let (sum, count) = axes.fold((0.0, 0.0), |(sum, count), axis| (sum + seen(axis), count + 1.0));
            sum / count
        };
        let all = mean(&mut (0..grown.skeleton.axes.len() as u32));
        let (count, more) = (more.len(), mean(&mut more.into_iter()));
        assert!(count > 10 && more > 1.5 * all, "{count}: {more} of {all}");
    }

    #[test]
    fn axes_stay_within_the_tolerance() {
        let whole = skeleton("sphere");
        let wood = Wood::new(&whole, &Exposure::default(), &Quiet).unwrap();
        for tolerance_m in [0.003, 0.02, 0.1] {
            let (thin, axes) = wood.thinned(&with(tolerance_m, 0.0));
            for (axis, &before) in thin.axes.iter().zip(&axes) {
                let line: Vec<Vec3> = (axis.parent != NO_PARENT)
                    .then_some(axis.parent)
                    .iter()
                    .chain(thin.nodes_of(axis))
                    .map(|&node| thin.positions[node as usize])
                    .collect();
                for &node in whole.nodes_of(&whole.axes[before as usize]) {
                    let place = whole.positions[node as usize];
                    let nearest = line
                        .windows(2)
                        .map(|pair| {
                            let along = pair[1] - pair[0];
                            let t = (place - pair[0]).dot(along) / along.length_squared();
                            place.distance(pair[0] + along * t.clamp(0.0, 1.0))
                        })
                        .fold(f32::INFINITY, f32::min);
                    assert!(nearest <= tolerance_m, "{nearest} of {tolerance_m}");
                }
            }
            assert!(thin.positions.len() < whole.positions.len());
        }
    }

    /// A crooked bole that jumped by half of its thickness from level to level.
    #[test]
    fn a_stem_keeps_its_course_longer_than_a_twig() {
        let grown = Subject::builtin("oak", &[]).grow();
        let wood = Wood::new(&grown.skeleton, &Exposure::default(), &Quiet).unwrap();
        let tolerance_m = 0.6;
        let (thin, axes) = wood.thinned(&with(tolerance_m, 0.01));
        let off_m = |axis: usize| {
            let line: Vec<Vec3> =
                thin.nodes_of(&thin.axes[axis]).iter().map(|&node| thin.positions[node as usize]).collect();
            let whole = grown.skeleton.nodes_of(&grown.skeleton.axes[axes[axis] as usize]);
            let nearest = |p: Vec3| {
                let pieces = line.windows(2).map(|pair| {
                    let along = pair[1] - pair[0];
                    let t = (p - pair[0]).dot(along) / along.length_squared();
                    p.distance(pair[0] + along * t.clamp(0.0, 1.0))
                });
                pieces.fold(f32::INFINITY, f32::min)
            };
            whole.iter().map(|&node| nearest(grown.skeleton.positions[node as usize])).fold(0.0, f32::max)
        };
        let stem = thin.trunk()[0] as usize;
        let others = (0..thin.axes.len()).filter(|&axis| axis != stem && thin.axes[axis].len > 1);
        let farthest_m = others.map(off_m).fold(0.0, f32::max);
        assert!(farthest_m > 0.2, "{farthest_m}");
        assert!(off_m(stem) <= tolerance_m / (1.0 + STEM), "{}", off_m(stem));
    }

    #[test]
    fn thin_wood_goes_first_and_takes_what_it_bears() {
        let whole = skeleton("fir");
        let wood = Wood::new(&whole, &Exposure::default(), &Quiet).unwrap();
        let base = |axis: &Axis| whole.radii[whole.nodes_of(axis)[0] as usize];
        let mut bases: Vec<f32> = whole.axes.iter().map(base).collect();
        bases.sort_unstable_by(f32::total_cmp);
        let mut before = whole.axes.len();
        for share in [0.5, 0.9, 0.99] {
            let smallest_m = bases[(share * bases.len() as f64) as usize] * 1.25;
            let (_, axes) = wood.thinned(&with(0.0, smallest_m));
            assert!(axes.len() < before);
            before = axes.len();
            for &axis in &axes {
                let kept = whole.axes[axis as usize];
                assert!(base(&kept) * (1.0 + SPREAD) >= smallest_m);
                if kept.parent != NO_PARENT {
                    assert!(axes.contains(&wood.axis_of[kept.parent as usize]), "its parent is there");
                }
            }
        }
    }
}
