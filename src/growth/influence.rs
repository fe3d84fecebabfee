//! What pulls at each node.
//!
//! Pulls are summed as integers. An integer sum does not depend on the order of its terms and can
//! be taken back term by term, so keeping sums up to date while points change hands gives the same
//! bits as adding them up anew, on any number of threads.

use std::ops::Range;

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use super::lists::reserve;

/// 1 in the fixed-point numbers of a pull: sums of 2^32 of them still fit 64 bits.
const ONE: f32 = (1_u32 << 30) as f32;

/// Most pulls that a list keeps memory for: 64 KiB.
const KEPT: usize = 4096;

/// Below this many pulls handing them to other threads costs more than it saves.
const WORTH_SHARING: usize = 1 << 13;

/// The unit vector from a node towards a point, in fixed point.
#[derive(Clone, Copy)]
pub(super) struct Pull {
    node: u32,
    pub vector: [i32; 3],
}

/// Pulls that are made together, so that vector instructions do it.
const BLOCK: usize = 64;

/// Pulls, the last of which are still to be made.
pub(super) struct Pulls {
    pub made: Vec<Pull>,
    count: usize,
    node: [u32; BLOCK],
    /// From the node to the point.
    offset: [[f32; BLOCK]; 3],
    distance2: [f32; BLOCK],
}

impl Default for Pulls {
    fn default() -> Self {
        Self {
            made: Vec::new(),
            count: 0,
            node: [0; BLOCK],
            offset: [[0.0; BLOCK]; 3],
            distance2: [0.0; BLOCK],
        }
    }
}

impl Pulls {
    /// Adds what [`pull`] would make of this; made after [`finish`](Self::finish).
    #[allow(clippy::inline_always, reason = "must be compiled with the caller's vector instructions")]
    #[inline(always)]
    pub fn push(&mut self, node: u32, offset: Vec3, distance2: f32) {
        if self.count == BLOCK {
            self.finish();
        }
        let at = self.count % BLOCK;
        self.node[at] = node;
        (self.offset[0][at], self.offset[1][at], self.offset[2][at]) = (offset.x, offset.y, offset.z);
        self.distance2[at] = distance2;
        self.count = at + 1;
    }

    /// Makes all pulls.
    #[allow(clippy::inline_always, reason = "must be compiled with the caller's vector instructions")]
    #[inline(always)]
    pub fn finish(&mut self) {
        let mut scales = [0.0; BLOCK];
        for (scale, distance2) in scales.iter_mut().zip(self.distance2) {
            *scale = ONE / distance2.max(1e-30).sqrt();
        }
        let mut vector = [[0; BLOCK]; 3];
        for (parts, offsets) in vector.iter_mut().zip(&self.offset) {
            for (part, (offset, scale)) in parts.iter_mut().zip(offsets.iter().zip(scales)) {
                *part = truncated(offset * scale);
            }
        }
        let [x, y, z] = &vector;
        let of = |at: usize| Pull { node: self.node[at], vector: [x[at], y[at], z[at]] };
        self.made.extend((0..self.count.min(BLOCK)).map(of));
        self.count = 0;
    }
}

/// What a point that lies at `offset` from a node, `distance2 = |offset|²` away, adds to its sum.
#[allow(clippy::inline_always, reason = "must be compiled with the caller's vector instructions")]
#[inline(always)]
pub(super) fn pull(node: u32, offset: Vec3, distance2: f32) -> Pull {
    // The floor keeps the scale finite where a square underflowed.
    let scale = ONE / distance2.max(1e-30).sqrt();
    Pull { node, vector: [(offset.x * scale) as i32, (offset.y * scale) as i32, (offset.z * scale) as i32] }
}

/// `x as i32` for numbers that fit.
///
/// By shifts, because compilers do not make vector instructions of `as`, which saturates.
#[allow(clippy::inline_always, reason = "must be compiled with the caller's vector instructions")]
#[inline(always)]
fn truncated(x: f32) -> i32 {
    let bits = x.to_bits();
    // The exponent counts from 127; the mantissa's first bit, which is not stored, goes to bit 31.
    let exponent = bits >> 23 & 0xff;
    let mantissa = bits << 8 | 1 << 31;
    let magnitude = if exponent < 127 { 0 } else { mantissa >> (158_u32.wrapping_sub(exponent) & 31) };
    let sign = bits.cast_signed() >> 31;
    (magnitude.cast_signed() ^ sign) - sign
}

/// The influenced set of a node, as far as growth needs it.
#[derive(Clone, Copy, Default)]
struct Influence {
    sum: [i64; 3],
    points: u32,
}

/// The influenced sets of all nodes.
#[derive(Default)]
pub(super) struct Influences {
    of: Vec<Influence>,
    /// Nodes whose set changed since they were last asked to grow.
    dirty: Marks,
}

/// What changed hands.
#[derive(Default)]
pub(super) struct Captures {
    /// Pulls that nodes no longer feel.
    pub lost: Pulls,
    /// Pulls that nodes feel from now on.
    pub won: Pulls,
    /// Points that came within the kill distance.
    pub deaths: Vec<Death>,
}

/// The end of a point.
#[derive(Clone, Copy)]
pub(super) struct Death {
    /// The nearest node.
    pub node: u32,
    pub point: Vec3,
}

impl Captures {
    /// Empty; keeps a little memory, not what one great capture took.
    pub fn clear(&mut self) {
        for pulls in [&mut self.lost, &mut self.won] {
            pulls.made.clear();
            pulls.made.shrink_to(KEPT);
        }
        self.deaths.clear();
        self.deaths.shrink_to(KEPT);
    }
}

impl Influences {
    pub fn reserve(&mut self, more: usize) {
        reserve(&mut self.of, more);
    }

    /// A node that nothing pulls at.
    pub fn add_node(&mut self) {
        self.of.push(Influence::default());
    }

    /// Whether any point pulls at `node`.
    pub fn any(&self, node: u32) -> bool {
        self.of[node as usize].points > 0
    }

    /// The sum of the pulls at `node`, `None` when there are none.
    pub fn sum(&self, node: u32) -> Option<DVec3> {
        let Influence { sum: [x, y, z], points, .. } = self.of[node as usize];
        (points > 0).then(|| DVec3::new(x as f64, y as f64, z as f64))
    }

    /// Nodes whose set changed since the last call, ascending.
    pub fn take_dirty(&mut self) -> Vec<u32> {
        self.dirty.take()
    }

    /// Moves pulls from the nodes that lost them to those that won them.
    pub fn record(&mut self, captures: &[Captures]) {
        let pulls = captures.iter().map(|some| some.lost.made.len() + some.won.made.len()).sum::<usize>();
        let threads = rayon::current_num_threads();
        if pulls < WORTH_SHARING || threads == 1 {
            let dirty = &mut self.dirty;
            return record_range(&mut self.of, 0, captures, |node| dirty.add(node));
        }
        // Each thread reads all pulls and adds those at its range of nodes. Most are at the youngest
        // nodes: ranges of equal length would leave one thread with all the work.
        let mut sample: Vec<u32> = captures
            .iter()
            .flat_map(|some| [&some.lost, &some.won])
            .flat_map(|pulls| pulls.made.iter().step_by(64).map(|pull| pull.node))
            .collect();
        sample.sort_unstable();
        let mut ranges = Vec::with_capacity(threads);
        let (mut rest, mut first) = (self.of.as_mut_slice(), 0);
        for thread in 1..threads {
            let end = sample[thread * sample.len() / threads].max(first);
            let (range, after) = rest.split_at_mut((end - first) as usize);
            ranges.push((range, first));
            (rest, first) = (after, end);
        }
        ranges.push((rest, first));
        let dirty: Vec<Vec<u32>> = ranges
            .into_par_iter()
            .map(|(range, first)| {
                let mut dirty = Vec::new();
                // Most pulls are at the node of the one before.
                record_range(range, first, captures, |node| {
                    if dirty.last() != Some(&node) {
                        dirty.push(node);
                    }
                });
                dirty
            })
            .collect();
        for &node in dirty.iter().flatten() {
            self.dirty.add(node);
        }
    }
}

/// Records the pulls at the nodes from `first` on that `of` describes, and tells which these are.
fn record_range(of: &mut [Influence], first: u32, captures: &[Captures], mut mark: impl FnMut(u32)) {
    for Captures { lost, won, .. } in captures {
        for &Pull { node, vector } in &lost.made {
            if let Some(influence) = of.get_mut(node.wrapping_sub(first) as usize) {
                for (sum, part) in influence.sum.iter_mut().zip(vector) {
                    *sum -= i64::from(part);
                }
                // Of a point that changed hands more than once, what was won and lost again is first lost.
                influence.points = influence.points.wrapping_sub(1);
                mark(node);
            }
        }
        for &Pull { node, vector } in &won.made {
            if let Some(influence) = of.get_mut(node.wrapping_sub(first) as usize) {
                for (sum, part) in influence.sum.iter_mut().zip(vector) {
                    *sum += i64::from(part);
                }
                influence.points = influence.points.wrapping_add(1);
                mark(node);
            }
        }
    }
}

/// A set of nodes that is filled and emptied again and again: one bit each, in no need of sorting.
#[derive(Default)]
struct Marks {
    words: Vec<u64>,
    /// Words that may be other than zero.
    touched: Range<usize>,
}

impl Marks {
    fn add(&mut self, node: u32) {
        let word = node as usize / 64;
        if word >= self.words.len() {
            let more = word + 1 - self.words.len();
            reserve(&mut self.words, more);
            self.words.resize(word + 1, 0);
        }
        self.words[word] |= 1 << (node % 64);
        self.touched = if self.touched.is_empty() {
            word..word + 1
        } else {
            self.touched.start.min(word)..self.touched.end.max(word + 1)
        };
    }

    /// All of them, ascending; none is left.
    fn take(&mut self) -> Vec<u32> {
        let touched = std::mem::take(&mut self.touched);
        let mut all = Vec::new();
        for (index, word) in self.words[touched.clone()].iter_mut().enumerate() {
            let mut bits = std::mem::take(word);
            while bits != 0 {
                all.push((touched.start + index) as u32 * 64 + bits.trailing_zeros());
                bits &= bits - 1;
            }
        }
        all
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use linden_base::random::Key;

    #[test]
    fn truncation_is_what_as_does() {
        let key = Key::new(4);
        let mut numbers = vec![0.0, -0.0, 0.5, -0.99, 1.0, -1.0, 1.5, f32::MIN_POSITIVE, ONE, -ONE];
        numbers.extend([ONE.next_up(), -ONE.next_up(), 8_388_607.5, 16_777_216.0, 2_147_483_520.0]);
        numbers.extend((0..10_000).map(|i| {
            let scale = f32::from_bits((127 + (i % 60) as u32 - 30) << 23);
            key.child(i).between(-1.0, 1.0) as f32 * scale
        }));
        for x in numbers {
            assert_eq!(truncated(x), x as i32, "{x}");
        }
    }
}
