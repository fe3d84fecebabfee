//! Nearest neighbours among fixed points: a balanced k-d tree (Bentley 1975).

use glam::DVec3;

use linden_base::monitor::{Cancelled, Monitor};

/// Subtrees of this many points are searched one by one.
const LEAF: usize = 12;

/// Ranges that are sorted without a look at the monitor: below a millisecond.
const UNWATCHED: usize = 1 << 14;

/// The label of points of several kinds.
const MIXED: u32 = u32::MAX;

/// A k-d tree; the middle of each range is its splitting point.
pub(super) struct Neighbours {
    points: Vec<DVec3>,
    /// Each point's index in what the tree was built from.
    indices: Vec<u32>,
    /// The axis that the range around each middle is split along.
    axes: Vec<u8>,
    /// Distances that were computed.
    #[cfg(test)]
    looks: std::sync::atomic::AtomicU64,
}

/// Labels of points, and of all ranges of the tree, so that a search passes over ranges as a whole.
pub(super) struct Labels<'a> {
    of_points: &'a [u32],
    /// By the range's middle, or its first slot where it is a leaf.
    of_ranges: Vec<Range>,
}

/// What is known of a range.
#[derive(Clone, Copy)]
struct Range {
    /// The label that all its points have, [`MIXED`] where they differ.
    label: u32,
    /// The box around them.
    low: DVec3,
    high: DVec3,
}

impl Range {
    fn union(self, other: Self) -> Self {
        Self {
            label: if self.label == other.label { self.label } else { MIXED },
            low: self.low.min(other.low),
            high: self.high.max(other.high),
        }
    }

    /// Squared distance of a place from the box.
    fn squared(&self, q: DVec3) -> f64 {
        (self.low - q).max(q - self.high).max(DVec3::ZERO).length_squared()
    }
}

impl Neighbours {
    pub fn new(points: &[DVec3], monitor: &dyn Monitor) -> Result<Self, Cancelled> {
        let mut entries: Vec<(DVec3, u32)> = points.iter().copied().zip(0..).collect();
        let mut axes = vec![0; points.len()];
        split(&mut entries, &mut axes, monitor)?;
        let (points, indices) = entries.into_iter().unzip();
        Ok(Self {
            points,
            indices,
            axes,
            #[cfg(test)]
            looks: std::sync::atomic::AtomicU64::new(0),
        })
    }

    /// Distances computed since it was made.
    #[cfg(test)]
    pub fn looks(&self) -> u64 {
        self.looks.load(std::sync::atomic::Ordering::Relaxed)
    }

    /// The labels by which [`Neighbours::search_other`] passes over many points at once; `of_points` has a
    /// label below [`MIXED`] for each point.
    pub fn labels<'a>(&self, of_points: &'a [u32]) -> Labels<'a> {
        let nothing = Range { label: MIXED, low: DVec3::INFINITY, high: DVec3::NEG_INFINITY };
        let mut of_ranges = vec![nothing; self.points.len()];
        self.label(0, self.points.len(), of_points, &mut of_ranges);
        Labels { of_points, of_ranges }
    }

    /// The range between two slots and those in it; `None` without points.
    fn label(&self, low: usize, high: usize, of_points: &[u32], of_ranges: &mut [Range]) -> Option<Range> {
        let alone = |slot: usize| {
            let (label, at) = (of_points[self.indices[slot] as usize], self.points[slot]);
            Range { label, low: at, high: at }
        };
        let (slot, range) = if high - low <= LEAF {
            (low, (low..high).map(alone).reduce(Range::union))
        } else {
            let middle = low.midpoint(high);
            let below = self.label(low, middle, of_points, of_ranges);
            let above = self.label(middle + 1, high, of_points, of_ranges);
            (middle, [below, above].into_iter().flatten().chain([alone(middle)]).reduce(Range::union))
        };
        if let Some(range) = range {
            of_ranges[slot] = range;
        }
        range
    }

    /// As [`Neighbours::search`], of the points with another label than `label` alone.
    pub fn search_other(
        &self,
        q: DVec3,
        bound: f64,
        (label, labels): (u32, &Labels),
        mut see: impl FnMut(u32, f64) -> f64,
    ) {
        let mut bound = bound;
        let mut see = |index: u32, squared: f64, bound: f64| {
            if labels.of_points[index as usize] == label { bound } else { see(index, squared) }
        };
        let is_passed = |slot: usize, bound: f64| {
            let range = &labels.of_ranges[slot];
            range.label == label || range.squared(q) >= bound
        };
        self.visit(q, (0, self.points.len()), &mut bound, &is_passed, &mut see);
    }

    /// Shows `see` every point that may lie nearer to `q` than the square root of `bound`, with its
    /// squared distance; `see` returns the bound from then on.
    pub fn search(&self, q: DVec3, bound: f64, mut see: impl FnMut(u32, f64) -> f64) {
        let mut bound = bound;
        let mut see = |index: u32, squared: f64, _: f64| see(index, squared);
        self.visit(q, (0, self.points.len()), &mut bound, &|_, _| false, &mut see);
    }

    fn visit(
        &self,
        q: DVec3,
        (low, high): (usize, usize),
        bound: &mut f64,
        is_passed: &impl Fn(usize, f64) -> bool,
        see: &mut impl FnMut(u32, f64, f64) -> f64,
    ) {
        let mut look = |slot: usize, bound: &mut f64| {
            #[cfg(test)]
            self.looks.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
            let squared = self.points[slot].distance_squared(q);
            if squared < *bound {
                *bound = see(self.indices[slot], squared, *bound);
            }
        };
        if high - low <= LEAF {
            if low < high && !is_passed(low, *bound) {
                for slot in low..high {
                    look(slot, bound);
                }
            }
            return;
        }
        let middle = low.midpoint(high);
        if is_passed(middle, *bound) {
            return;
        }
        look(middle, bound);
        let axis = usize::from(self.axes[middle]);
        let across = q[axis] - self.points[middle][axis];
        let (near, far) = if across < 0.0 {
            ((low, middle), (middle + 1, high))
        } else {
            ((middle + 1, high), (low, middle))
        };
        self.visit(q, near, bound, is_passed, see);
        if across * across < *bound {
            self.visit(q, far, bound, is_passed, see);
        }
    }

    /// The squared distance to the nearest point at another place than `q`, infinite without one.
    pub fn nearest_other_squared(&self, q: DVec3) -> f64 {
        let mut best = f64::INFINITY;
        self.search(q, best, |_, squared| {
            if squared > 0.0 {
                best = best.min(squared);
            }
            best
        });
        best
    }

    /// The squared distance to the nearest point, `q` itself included, infinite without one.
    pub fn nearest_squared(&self, q: DVec3) -> f64 {
        let mut best = f64::INFINITY;
        self.search(q, best, |_, squared| {
            best = best.min(squared);
            best
        });
        best
    }

    /// The `count` points nearest to `q` and nearer than `reach`, by (squared distance, index).
    pub fn nearest(&self, q: DVec3, count: usize, reach: f64, found: &mut Vec<(f64, u32)>) {
        found.clear();
        let limit = reach * reach;
        self.search(q, limit, |index, squared| {
            let place = found.partition_point(|&(d, i)| (d, i) < (squared, index));
            found.insert(place, (squared, index));
            found.truncate(count);
            // Above the worst by a hair, so that equal distances are still seen and the lower index wins.
            if found.len() == count { found[count - 1].0.next_up().min(limit) } else { limit }
        });
    }
}

fn split(entries: &mut [(DVec3, u32)], axes: &mut [u8], monitor: &dyn Monitor) -> Result<(), Cancelled> {
    if entries.len() <= LEAF {
        return Ok(());
    }
    if entries.len() > UNWATCHED {
        monitor.check()?;
    }
    let low = entries.iter().fold(DVec3::INFINITY, |low, entry| low.min(entry.0));
    let high = entries.iter().fold(DVec3::NEG_INFINITY, |high, entry| high.max(entry.0));
    let size = (high - low).to_array();
    let axis = (0..3).max_by(|&a, &b| size[a].total_cmp(&size[b])).unwrap_or(0);
    let middle = 0_usize.midpoint(entries.len());
    entries.select_nth_unstable_by(middle, |a, b| a.0[axis].total_cmp(&b.0[axis]).then(a.1.cmp(&b.1)));
    axes[middle] = axis as u8;
    let (entries_low, entries_high) = entries.split_at_mut(middle);
    let (axes_low, axes_high) = axes.split_at_mut(middle);
    let (low, high) = rayon::join(
        || split(entries_low, axes_low, monitor),
        || split(&mut entries_high[1..], &mut axes_high[1..], monitor),
    );
    low.and(high)
}

#[cfg(test)]
mod tests {
    use super::*;
    use linden_base::monitor::Quiet;
    use linden_base::random::Key;

    /// Points on a lattice of eighths: many ties and duplicates.
    fn points(count: u64) -> Vec<DVec3> {
        let coordinate = |key: Key| (key.unit() * 12.0).floor() / 8.0;
        let point = |i| DVec3::from([0, 1, 2].map(|axis| coordinate(Key::new(5).child(i).child(axis))));
        (0..count).map(point).collect()
    }

    #[test]
    fn finds_what_a_search_through_all_finds() {
        for count in [1, 2, 12, 13, 50, 700] {
            let points = points(count);
            let tree = Neighbours::new(&points, &Quiet).unwrap();
            for &q in points.iter().step_by(7) {
                for (k, reach) in [(1, 9.0), (5, 0.3), (9, 9.0), (2000, 0.25)] {
                    let mut expected: Vec<(f64, u32)> =
                        points.iter().map(|p| p.distance_squared(q)).zip(0..).collect();
                    expected.retain(|&(squared, _)| squared < reach * reach);
                    expected.sort_by(|a, b| a.partial_cmp(b).unwrap());
                    expected.truncate(k);
                    let mut found = Vec::new();
                    tree.nearest(q, k, reach, &mut found);
                    assert_eq!(found, expected);
                }
                let others = points.iter().map(|p| p.distance_squared(q)).filter(|&squared| squared > 0.0);
                assert_eq!(tree.nearest_other_squared(q), others.fold(f64::INFINITY, f64::min));
            }
        }
    }

    #[test]
    fn the_nearest_of_another_label_is_what_a_search_through_all_finds() {
        for count in [1, 13, 50, 700] {
            let points = points(count);
            let tree = Neighbours::new(&points, &Quiet).unwrap();
            // By place, so that many ranges are of one label.
            let of_points: Vec<u32> = points.iter().map(|p| (p.x * 3.0) as u32).collect();
            let labels = tree.labels(&of_points);
            for (&q, &label) in points.iter().zip(&of_points) {
                let others = points.iter().zip(&of_points).filter(|(_, other)| **other != label);
                let expected = others.map(|(p, _)| p.distance_squared(q)).fold(f64::INFINITY, f64::min);
                let mut best = f64::INFINITY;
                tree.search_other(q, best, (label, &labels), |_, squared| {
                    best = best.min(squared);
                    best
                });
                assert_eq!(best, expected);
            }
        }
    }

    #[test]
    fn many_points_in_one_place_but_for_a_hair_take_no_longer_than_others() {
        let hair = |i: u64| DVec3::from([0, 1, 2].map(|axis| 1e-9 * Key::new(6).child(i).child(axis).unit()));
        let count = 20_000_u64;
        let points: Vec<DVec3> = (0..count).map(|i| DVec3::Y * 3.0 + hair(i)).collect();
        let tree = Neighbours::new(&points, &Quiet).unwrap();
        for &q in &points {
            assert!(tree.nearest_other_squared(q) < 1e-18);
        }
        // 20 000 each would be the square.
        assert!(tree.looks() < 300 * count, "{}", tree.looks());
    }
}
