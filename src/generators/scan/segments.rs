//! The segment of a skeleton that is nearest to a point, exactly: a bounding-volume tree.

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use linden_base::monitor::{Cancelled, Monitor};
use linden_skeleton::NO_PARENT;

/// Segments that are looked at one by one.
const LEAF: usize = 4;

/// Points that one thread takes at a time; below a millisecond.
const CHUNK: usize = 1024;

/// Points that are looked at together,
const BLOCK: usize = 8;

/// where no more segments than this may be the nearest of any of them.
const FEW: usize = 64;

/// Deeper than any tree over 2³² segments that is halved at every level.
const DEPTH: usize = 64;

/// A box found nearer than it is by rounding must still be entered.
const SLACK: f64 = 1.0 + 1e-9;

/// The segments of a skeleton.
pub(super) struct Segments {
    segments: Vec<Segment>,
    /// Each box before those in it; the first half's follows at once.
    boxes: Vec<Node>,
}

struct Segment {
    from: DVec3,
    along: DVec3,
    /// One over the squared length, 0 without length.
    inverse: f64,
    /// The node that it ends in.
    node: u32,
}

#[derive(Clone, Copy)]
struct Node {
    low: DVec3,
    high: DVec3,
    /// The box of the second half, 0 for a leaf.
    second: u32,
    first_segment: u32,
    last_segment: u32,
}

/// Where a point is nearest to the skeleton.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Nearest {
    /// The node that the nearest segment ends in; of equally near ones the lowest.
    pub node: u32,
    /// Where on it: 0 at its start, 1 at its end.
    pub t: f64,
    /// Metres.
    pub distance_m: f64,
}

impl Segment {
    fn nearest(&self, q: DVec3) -> (f64, f64) {
        let t = ((q - self.from).dot(self.along) * self.inverse).clamp(0.0, 1.0);
        ((self.from + self.along * t).distance_squared(q), t)
    }
}

impl Segments {
    /// `None` when there is no segment.
    pub fn new(positions: &[Vec3], parents: &[u32]) -> Option<Self> {
        let segment = |(node, &parent): (u32, &u32)| {
            let from = positions[parent as usize].as_dvec3();
            let along = positions[node as usize].as_dvec3() - from;
            let squared = along.length_squared();
            Segment { from, along, inverse: if squared > 0.0 { squared.recip() } else { 0.0 }, node }
        };
        let mut segments: Vec<Segment> =
            (0..).zip(parents).filter(|(_, parent)| **parent != NO_PARENT).map(segment).collect();
        if segments.is_empty() {
            return None;
        }
        let mut boxes = Vec::with_capacity(segments.len());
        arrange(&mut segments, 0, &mut boxes);
        Some(Self { segments, boxes })
    }

    /// For each point its nearest segment.
    pub fn nearest(&self, points: &[Vec3], monitor: &dyn Monitor) -> Result<Vec<Nearest>, Cancelled> {
        let parts: Vec<Vec<Nearest>> = points
            .par_chunks(CHUNK)
            .map(|points| {
                monitor.check()?;
                let mut found = Vec::with_capacity(points.len());
                let (mut guess, mut near) = (0, Vec::new());
                for block in points.chunks(BLOCK) {
                    self.nearest_of_block(block, &mut guess, &mut near, &mut found);
                }
                Ok(found)
            })
            .collect::<Result<_, Cancelled>>()?;
        Ok(parts.concat())
    }

    /// The nearest of each of some points that follow each other in a list: they are mostly neighbours in space, and so are
    /// the segments that they may be nearest to.
    fn nearest_of_block(
        &self,
        block: &[Vec3],
        guess: &mut usize,
        near: &mut Vec<u32>,
        found: &mut Vec<Nearest>,
    ) {
        let low = block.iter().copied().fold(Vec3::INFINITY, Vec3::min);
        let high = block.iter().copied().fold(Vec3::NEG_INFINITY, Vec3::max);
        let (middle, half_m) = (low.midpoint(high).as_dvec3(), 0.5 * f64::from(low.distance(high)));
        // From none of them the nearest is farther than from the middle by more than the half; seen from the middle that is
        // as much farther again. Single precision has rounded the middle.
        let play_m = 2.0 * half_m + 4.0 * f64::from(f32::EPSILON) * middle.length();
        let nearer_than = |squared: f64| (squared.sqrt() + play_m) * SLACK;
        let (of_guess, _) = self.segments[*guess].nearest(middle);
        let is_few = self.within(middle, nearer_than(of_guess), near) || {
            // After a leap in the list.
            let (slot, of_middle) = self.search(middle, *guess);
            *guess = slot;
            self.within(middle, (of_middle.distance_m + play_m) * SLACK, near)
        };
        if !is_few {
            // Points far apart from each other.
            for p in block {
                let (slot, nearest) = self.search(p.as_dvec3(), *guess);
                *guess = slot;
                found.push(nearest);
            }
            return;
        }
        for p in block {
            let mut best = (f64::INFINITY, u32::MAX, 0.0);
            for &slot in &*near {
                let segment = &self.segments[slot as usize];
                let (squared, t) = segment.nearest(p.as_dvec3());
                if (squared, segment.node) < (best.0, best.1) {
                    best = (squared, segment.node, t);
                    *guess = slot as usize;
                }
            }
            found.push(Nearest { node: best.1, t: best.2, distance_m: best.0.sqrt() });
        }
    }

    /// The slots of all segments that may be within `reach_m` of a place; whether these are few.
    fn within(&self, q: DVec3, reach_m: f64, near: &mut Vec<u32>) -> bool {
        near.clear();
        let limit = reach_m * reach_m;
        let mut stack = [0_u32; DEPTH];
        let mut depth = 1;
        while depth > 0 {
            depth -= 1;
            let index = stack[depth];
            let node = &self.boxes[index as usize];
            if node.squared(q) > limit {
                continue;
            }
            if node.second == 0 {
                near.extend(node.first_segment..node.last_segment);
                if near.len() > FEW {
                    return false;
                }
                continue;
            }
            stack[depth] = node.second;
            stack[depth + 1] = index + 1;
            depth += 2;
        }
        true
    }

    /// The slot of the nearest segment, and what it is; `guess` is any slot.
    fn search(&self, q: DVec3, guess: usize) -> (usize, Nearest) {
        let (squared, t) = self.segments[guess].nearest(q);
        let mut best = (squared, self.segments[guess].node, guess, t);
        let mut stack = [(0_u32, 0.0); DEPTH];
        let mut depth = 1;
        while depth > 0 {
            depth -= 1;
            let (index, away) = stack[depth];
            if away > best.0 * SLACK {
                continue;
            }
            let node = self.boxes[index as usize];
            if node.second == 0 {
                for slot in node.first_segment as usize..node.last_segment as usize {
                    let segment = &self.segments[slot];
                    let (squared, t) = segment.nearest(q);
                    if (squared, segment.node) < (best.0, best.1) {
                        best = (squared, segment.node, slot, t);
                    }
                }
                continue;
            }
            let [a, b] = [index + 1, node.second].map(|i| (i, self.boxes[i as usize].squared(q)));
            let (near, far) = if a.1 <= b.1 { (a, b) } else { (b, a) };
            stack[depth] = far;
            stack[depth + 1] = near;
            depth += 2;
        }
        (best.2, Nearest { node: best.1, t: best.3, distance_m: best.0.sqrt() })
    }
}

impl Node {
    /// Squared distance of a point.
    fn squared(&self, q: DVec3) -> f64 {
        (self.low - q).max(q - self.high).max(DVec3::ZERO).length_squared()
    }
}

/// Halves the segments at the middle of the widest extent until few are left; `first` is the first's slot.
fn arrange(segments: &mut [Segment], first: usize, boxes: &mut Vec<Node>) {
    let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for s in segments.iter() {
        let to = s.from + s.along;
        (low, high) = (low.min(s.from).min(to), high.max(s.from).max(to));
    }
    let node = boxes.len();
    let last_segment = (first + segments.len()) as u32;
    boxes.push(Node { low, high, second: 0, first_segment: first as u32, last_segment });
    if segments.len() <= LEAF {
        return;
    }
    let size = (high - low).to_array();
    let axis = (0..3).max_by(|&a, &b| size[a].total_cmp(&size[b])).unwrap_or(0);
    let middle = segments.len() / 2;
    let key = |s: &Segment| s.from[axis] + 0.5 * s.along[axis];
    segments.select_nth_unstable_by(middle, |a, b| key(a).total_cmp(&key(b)).then(a.node.cmp(&b.node)));
    let (before, after) = segments.split_at_mut(middle);
    arrange(before, first, boxes);
    boxes[node].second = boxes.len() as u32;
    arrange(after, first + middle, boxes);
}

#[cfg(test)]
mod tests {
    use super::*;
    use linden_base::monitor::Quiet;
    use linden_base::random::Key;

    /// Coordinates on a lattice: many ties, segments without length.
    fn place(key: Key, step: f64) -> Vec3 {
        Vec3::from([0, 1, 2].map(|axis| ((key.child(axis).unit() * 2.0 / step).floor() * step) as f32))
    }

    #[test]
    fn the_nearest_is_what_a_look_at_all_finds() {
        for (count, step) in [(2, 0.5), (7, 0.25), (300, 0.25), (900, 1e-3)] {
            let key = Key::new(9).child(count);
            let positions: Vec<Vec3> = (0..count).map(|i| place(key.child(i), step)).collect();
            let parent = |i: u64| (key.child(i).named("parent").unit() * i as f64) as u32;
            let parents: Vec<u32> =
                (0..count).map(|i| if i % 50 == 0 { NO_PARENT } else { parent(i) }).collect();
            let points: Vec<Vec3> =
                (0..2000).map(|i| place(key.named("points").child(i), step * 0.5) * 1.5).collect();
            let found = Segments::new(&positions, &parents).unwrap().nearest(&points, &Quiet).unwrap();
            for (q, found) in points.iter().zip(found) {
                let q = q.as_dvec3();
                let mut best = (f64::INFINITY, 0);
                for (node, &parent) in parents.iter().enumerate().filter(|(_, p)| **p != NO_PARENT) {
                    let (a, b) = (positions[parent as usize].as_dvec3(), positions[node].as_dvec3());
                    let squared = (b - a).length_squared();
                    let t = if squared > 0.0 { ((q - a).dot(b - a) / squared).clamp(0.0, 1.0) } else { 0.0 };
                    let d = (a + (b - a) * t).distance(q);
                    // Rounding may differ between ties.
                    if d < best.0 - 1e-12 {
                        best = (d, node);
                    }
                }
                assert!((found.distance_m - best.0).abs() < 1e-9, "{found:?} {best:?}");
                let exact_tie = |node: u32| {
                    let (a, b) = (positions[parents[node as usize] as usize], positions[node as usize]);
                    let (a, b) = (a.as_dvec3(), b.as_dvec3());
                    (a + (b - a) * found.t).distance(q)
                };
                assert!((exact_tie(found.node) - best.0).abs() < 1e-9);
            }
        }
        assert!(Segments::new(&[Vec3::ZERO], &[NO_PARENT]).is_none());
    }
}
