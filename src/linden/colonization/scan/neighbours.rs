//! Nearest neighbours among fixed points: a balanced k-d tree (Bentley 1975).

use glam::DVec3;

/// Subtrees of this many points are searched one by one.
const LEAF: usize = 12;

/// A k-d tree; the middle of each range is its splitting point.
pub(super) struct Neighbours {
    points: Vec<DVec3>,
    /// Each point's index in what the tree was built from.
    indices: Vec<u32>,
    /// The axis that the range around each middle is split along.
    axes: Vec<u8>,
}

impl Neighbours {
    pub fn new(points: &[DVec3]) -> Self {
        let mut entries: Vec<(DVec3, u32)> = points.iter().copied().zip(0..).collect();
        let mut axes = vec![0; points.len()];
        split(&mut entries, &mut axes);
        let (points, indices) = entries.into_iter().unzip();
        Self { points, indices, axes }
    }

    /// Shows `see` every point that may lie nearer to `q` than the square root of `bound`, with its
    /// squared distance; `see` returns the bound from then on.
    pub fn search(&self, q: DVec3, bound: f64, mut see: impl FnMut(u32, f64) -> f64) {
        let mut bound = bound;
        self.visit(q, 0, self.points.len(), &mut bound, &mut see);
    }

    fn visit(
        &self,
        q: DVec3,
        low: usize,
        high: usize,
        bound: &mut f64,
        see: &mut impl FnMut(u32, f64) -> f64,
    ) {
        let mut look = |slot: usize, bound: &mut f64| {
            let squared = self.points[slot].distance_squared(q);
            if squared < *bound {
                *bound = see(self.indices[slot], squared);
            }
        };
        if high - low <= LEAF {
            for slot in low..high {
                look(slot, bound);
            }
            return;
        }
        let middle = low.midpoint(high);
        look(middle, bound);
        let axis = usize::from(self.axes[middle]);
        let across = q[axis] - self.points[middle][axis];
        let (near, far) = if across < 0.0 {
            ((low, middle), (middle + 1, high))
        } else {
            ((middle + 1, high), (low, middle))
        };
        self.visit(q, near.0, near.1, bound, see);
        if across * across < *bound {
            self.visit(q, far.0, far.1, bound, see);
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

fn split(entries: &mut [(DVec3, u32)], axes: &mut [u8]) {
    if entries.len() <= LEAF {
        return;
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
    rayon::join(|| split(entries_low, axes_low), || split(&mut entries_high[1..], &mut axes_high[1..]));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Key;

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
            let tree = Neighbours::new(&points);
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
}
