//! What pulls at each node.
//!
//! Pulls are summed as integers. An integer sum does not depend on the order of its terms and can
//! be taken back term by term, so keeping sums up to date while points change hands gives the same
//! bits as adding them up anew, on any number of threads.

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use super::nodes::reserve;
use super::search::Captures;

/// 1 in the fixed-point numbers of a pull: sums of 2^32 of them still fit 64 bits.
const ONE: f32 = (1_u32 << 30) as f32;

/// Below this many pulls handing them to other threads costs more than it saves.
const WORTH_SHARING: usize = 1 << 13;

/// The unit vector from a node towards a point, in fixed point.
#[derive(Clone, Copy)]
pub(super) struct Pull {
    node: u32,
    pub vector: [i32; 3],
}

/// What a point that lies at `offset` from a node, `distance2 = |offset|²` away, adds to its sum.
#[allow(clippy::inline_always, reason = "must be compiled with the caller's vector instructions")]
#[inline(always)]
pub(super) fn pull(node: u32, offset: Vec3, distance2: f32) -> Pull {
    // The floor keeps the scale finite where a square underflowed.
    let scale = ONE / distance2.max(1e-30).sqrt();
    Pull { node, vector: [(offset.x * scale) as i32, (offset.y * scale) as i32, (offset.z * scale) as i32] }
}

/// The influenced set of a node, as far as growth needs it.
#[derive(Clone, Copy, Default)]
struct Influence {
    sum: [i64; 3],
    points: u32,
    /// Whether the set changed since the node was last asked to grow.
    dirty: bool,
}

/// The influenced sets of all nodes.
#[derive(Default)]
pub(super) struct Influences {
    of: Vec<Influence>,
    /// Nodes whose set changed, in any order.
    dirty: Vec<u32>,
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
        let mut dirty = std::mem::take(&mut self.dirty);
        dirty.par_sort_unstable();
        for &node in &dirty {
            self.of[node as usize].dirty = false;
        }
        dirty
    }

    /// Moves pulls from the nodes that lost them to those that won them.
    pub fn record(&mut self, captures: &[Captures]) {
        let pulls = captures.iter().map(|some| some.lost.len() + some.won.len()).sum::<usize>();
        let threads = rayon::current_num_threads();
        if pulls < WORTH_SHARING || threads == 1 {
            return record_range(&mut self.of, 0, captures, &mut self.dirty);
        }
        // Each thread reads all pulls and adds those at its range of nodes. Most are at the youngest
        // nodes: ranges of equal length would leave one thread with all the work.
        let mut sample: Vec<u32> = captures
            .iter()
            .flat_map(|some| [&some.lost, &some.won])
            .flat_map(|pulls| pulls.iter().step_by(64).map(|pull| pull.node))
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
                record_range(range, first, captures, &mut dirty);
                dirty
            })
            .collect();
        self.dirty.extend(dirty.iter().flatten());
    }
}

/// Records the pulls at the nodes from `first` on that `of` describes.
fn record_range(of: &mut [Influence], first: u32, captures: &[Captures], dirty: &mut Vec<u32>) {
    let mut mark = |influence: &mut Influence, node| {
        if !influence.dirty {
            influence.dirty = true;
            dirty.push(node);
        }
    };
    for Captures { lost, won, .. } in captures {
        for &Pull { node, vector } in lost {
            if let Some(influence) = of.get_mut(node.wrapping_sub(first) as usize) {
                for (sum, part) in influence.sum.iter_mut().zip(vector) {
                    *sum -= i64::from(part);
                }
                influence.points -= 1;
                mark(influence, node);
            }
        }
        for &Pull { node, vector } in won {
            if let Some(influence) = of.get_mut(node.wrapping_sub(first) as usize) {
                for (sum, part) in influence.sum.iter_mut().zip(vector) {
                    *sum += i64::from(part);
                }
                influence.points += 1;
                mark(influence, node);
            }
        }
    }
}
