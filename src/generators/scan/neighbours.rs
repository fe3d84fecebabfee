//! Nearest neighbours among fixed points: a tree of boxes over their Z-order (Morton 1966; Lauterbach et al. 2009, *Fast
//! BVH construction on GPUs*). It takes one sort of whole numbers to build, and neighbours in space are neighbours in memory.

use glam::DVec3;
use rayon::prelude::*;

use super::z_order;
use linden_base::monitor::{Cancelled, Monitor};

/// Boxes of this many points are searched one by one.
const LEAF: usize = 16;

/// Points that are numbered or boxed without a look at the monitor: below a millisecond.
const UNWATCHED: usize = 1 << 14;

/// How often points that share a number are numbered anew: what is then left lies within 2⁻⁶³ of the cloud's extent.
const NUMBERINGS: usize = 3;

/// Deeper than any search goes: a level for each bit of each numbering.
const DEPTH: usize = NUMBERINGS * 64 + 2;

/// The label of points of several kinds.
const MIXED: u32 = u32::MAX;

/// A search tree over points.
pub(super) struct Neighbours {
    points: Vec<DVec3>,
    /// Each point's index in what the tree was built from.
    indices: Vec<u32>,
    /// Each box before those in it; the first half's follows at once.
    boxes: Vec<Box3>,
    /// Distances that were computed.
    #[cfg(test)]
    looks: std::sync::atomic::AtomicU64,
}

/// A box around points that follow each other.
#[derive(Clone, Copy)]
struct Box3 {
    low: DVec3,
    high: DVec3,
    first: u32,
    last: u32,
    /// The box of the second half, 0 for one without halves.
    second: u32,
}

impl Box3 {
    /// Squared distance of a place from the box.
    fn squared(&self, q: DVec3) -> f64 {
        (self.low - q).max(q - self.high).max(DVec3::ZERO).length_squared()
    }
}

/// Labels of points, and of all boxes of the tree, so that a search passes over boxes as a whole.
pub(super) struct Labels<'a> {
    of_points: &'a [u32],
    /// The label that all points of a box have, [`MIXED`] where they differ.
    of_boxes: Vec<u32>,
}

impl Neighbours {
    pub fn new(points: &[DVec3], monitor: &dyn Monitor) -> Result<Self, Cancelled> {
        let mut order: Vec<(u64, u32)> = Vec::with_capacity(points.len());
        order.extend((0..points.len() as u32).map(|index| (0, index)));
        let mut boxes = Vec::with_capacity(points.len() / 2);
        if !points.is_empty() {
            arrange(points, &mut order, (0, 0), &mut boxes, monitor)?;
        }
        Ok(Self {
            points: order.iter().map(|&(_, index)| points[index as usize]).collect(),
            indices: order.iter().map(|&(_, index)| index).collect(),
            boxes,
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
        let mut of_boxes = vec![MIXED; self.boxes.len()];
        for (at, found) in self.boxes.iter().enumerate().rev() {
            let of_both = |a: u32, b: u32| if a == b { a } else { MIXED };
            of_boxes[at] = if found.second == 0 {
                let slots = found.first as usize..found.last as usize;
                let labels = self.indices[slots].iter().map(|&index| of_points[index as usize]);
                labels.reduce(of_both).unwrap_or(MIXED)
            } else {
                of_both(of_boxes[at + 1], of_boxes[found.second as usize])
            };
        }
        Labels { of_points, of_boxes }
    }

    /// As [`Neighbours::search`], of the points with another label than `label` alone.
    pub fn search_other(
        &self,
        q: DVec3,
        bound: f64,
        (label, labels): (u32, &Labels),
        mut see: impl FnMut(u32, f64) -> f64,
    ) {
        let see = |index: u32, squared: f64, bound: f64| {
            if labels.of_points[index as usize] == label { bound } else { see(index, squared) }
        };
        self.visit(q, bound, |at| labels.of_boxes[at] == label, see);
    }

    /// Shows `see` every point that may lie nearer to `q` than the square root of `bound`, with its
    /// squared distance; `see` returns the bound from then on.
    pub fn search(&self, q: DVec3, bound: f64, mut see: impl FnMut(u32, f64) -> f64) {
        self.visit(q, bound, |_| false, |index, squared, _| see(index, squared));
    }

    fn visit(
        &self,
        q: DVec3,
        mut bound: f64,
        is_passed: impl Fn(usize) -> bool,
        mut see: impl FnMut(u32, f64, f64) -> f64,
    ) {
        let Some(root) = self.boxes.first() else { return };
        let mut stack = [(0_u32, 0.0_f64); DEPTH];
        stack[0].1 = root.squared(q);
        let mut depth = 1;
        while depth > 0 {
            depth -= 1;
            let (at, away) = stack[depth];
            if away >= bound || is_passed(at as usize) {
                continue;
            }
            let found = &self.boxes[at as usize];
            if found.second == 0 {
                for slot in found.first as usize..found.last as usize {
                    #[cfg(test)]
                    self.looks.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
                    let squared = self.points[slot].distance_squared(q);
                    if squared < bound {
                        bound = see(self.indices[slot], squared, bound);
                    }
                }
                continue;
            }
            let [a, b] = [at + 1, found.second].map(|i| (i, self.boxes[i as usize].squared(q)));
            let (near, far) = if a.1 <= b.1 { (a, b) } else { (b, a) };
            stack[depth] = far;
            stack[depth + 1] = near;
            depth += 2;
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

/// Numbers points in their Z-order, sorts them by that, and boxes them. `first` is where they stand in the whole,
/// `numbered` how often they were numbered.
fn arrange(
    points: &[DVec3],
    order: &mut [(u64, u32)],
    (first, numbered): (usize, usize),
    boxes: &mut Vec<Box3>,
    monitor: &dyn Monitor,
) -> Result<(), Cancelled> {
    let at = |entry: &(u64, u32)| points[entry.1 as usize];
    let low = order.iter().map(at).fold(DVec3::INFINITY, DVec3::min);
    let high = order.iter().map(at).fold(DVec3::NEG_INFINITY, DVec3::max);
    let per_m = z_order::MOST / (high - low).max_element();
    if !(per_m.is_finite() && order.len() > LEAF && numbered < NUMBERINGS) {
        // Few, or all in one place (or so near each other that numbers do not part them).
        boxes.push(Box3 { low, high, first: first as u32, last: (first + order.len()) as u32, second: 0 });
        return Ok(());
    }
    order.par_chunks_mut(UNWATCHED).try_for_each(|part| {
        monitor.check()?;
        for entry in part {
            entry.0 = z_order::number((points[entry.1 as usize] - low) * per_m);
        }
        Ok(())
    })?;
    z_order::sort(order);
    halve(points, order, (first, numbered + 1), boxes, monitor)
}

/// Boxes sorted points, and both halves of them: those with and without the first bit that not all have.
fn halve(
    points: &[DVec3],
    order: &mut [(u64, u32)],
    (first, numbered): (usize, usize),
    boxes: &mut Vec<Box3>,
    monitor: &dyn Monitor,
) -> Result<(), Cancelled> {
    let count = order.len();
    if count > UNWATCHED {
        monitor.check()?;
    }
    let whole = boxes.len();
    if count <= LEAF {
        let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for &(_, index) in &*order {
            (low, high) = (low.min(points[index as usize]), high.max(points[index as usize]));
        }
        boxes.push(Box3 { low, high, first: first as u32, last: (first + count) as u32, second: 0 });
        return Ok(());
    }
    let differing = order[0].0 ^ order[count - 1].0;
    if differing == 0 {
        return arrange(points, order, (first, numbered), boxes, monitor);
    }
    let bit = 1 << (u64::BITS - 1 - differing.leading_zeros());
    let middle = order.partition_point(|entry| entry.0 & bit == 0);
    boxes.push(Box3 { low: DVec3::ZERO, high: DVec3::ZERO, first: first as u32, last: 0, second: 0 });
    let (below, above) = order.split_at_mut(middle);
    halve(points, below, (first, numbered), boxes, monitor)?;
    let second = boxes.len();
    halve(points, above, (first + middle, numbered), boxes, monitor)?;
    let [a, b] = [boxes[whole + 1], boxes[second]];
    boxes[whole] = Box3 {
        low: a.low.min(b.low),
        high: a.high.max(b.high),
        last: (first + count) as u32,
        second: second as u32,
        ..boxes[whole]
    };
    Ok(())
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
