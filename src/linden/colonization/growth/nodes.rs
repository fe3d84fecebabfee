//! The growing nodes: where they are, what pulls them, what they grew.
//!
//! Pulls are summed as integers. An integer sum does not depend on the order of its terms and can
//! be taken back term by term, so keeping sums up to date while points change hands gives the same
//! bits as adding them up anew, on any number of threads.

use glam::{DVec3, Vec3};

use super::NONE;
use crate::skeleton::{Branching, NO_PARENT};

/// 1 in the fixed-point numbers of a pull: sums of 2^32 of them still fit 64 bits.
const ONE: f32 = (1_u32 << 30) as f32;

/// What is left of a unit vector when something of about the same length cancels it.
const VANISHING: f64 = 1e-9;

/// The unit vector from a node towards a point, in fixed point.
#[derive(Clone, Copy)]
pub(super) struct Pull {
    pub node: u32,
    vector: [i32; 3],
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

/// Nodes, 60 bytes each: 24 are the result, 36 serve growth.
pub(super) struct Nodes {
    pub branching: Branching,
    influences: Vec<Influence>,
    /// The last child of each node, or [`NONE`].
    youngest: Vec<u32>,
    /// The child that the same parent grew before, or [`NONE`].
    elder: Vec<u32>,
    /// Nodes whose influenced set changed, in any order.
    dirty: Vec<u32>,
}

impl Nodes {
    /// Parents of `start` come before their children.
    pub fn new(start: &Branching) -> Self {
        let mut nodes = Self {
            branching: start.clone(),
            influences: Vec::new(),
            youngest: Vec::new(),
            elder: Vec::new(),
            dirty: Vec::new(),
        };
        for &parent in &start.parents {
            nodes.adopt(parent);
        }
        nodes
    }

    pub fn len(&self) -> usize {
        self.branching.positions.len()
    }

    fn adopt(&mut self, parent: u32) {
        let index = self.influences.len() as u32;
        self.influences.push(Influence::default());
        self.youngest.push(NONE);
        self.elder.push(if parent == NO_PARENT {
            NONE
        } else {
            std::mem::replace(&mut self.youngest[parent as usize], index)
        });
    }

    /// Adds children, each with its parent.
    pub fn extend(&mut self, children: &[(u32, Vec3)], birth: u32) {
        let more = children.len();
        reserve(&mut self.branching.positions, more);
        reserve(&mut self.branching.parents, more);
        reserve(&mut self.branching.births, more);
        reserve(&mut self.influences, more);
        reserve(&mut self.youngest, more);
        reserve(&mut self.elder, more);
        for &(parent, position) in children {
            self.branching.positions.push(position);
            self.branching.parents.push(parent);
            self.branching.births.push(birth);
            self.adopt(parent);
        }
    }

    pub fn lose(&mut self, pull: &Pull) {
        let influence = &mut self.influences[pull.node as usize];
        for (sum, part) in influence.sum.iter_mut().zip(pull.vector) {
            *sum -= i64::from(part);
        }
        influence.points -= 1;
        if !influence.dirty {
            influence.dirty = true;
            self.dirty.push(pull.node);
        }
    }

    pub fn win(&mut self, pull: &Pull) {
        let influence = &mut self.influences[pull.node as usize];
        for (sum, part) in influence.sum.iter_mut().zip(pull.vector) {
            *sum += i64::from(part);
        }
        influence.points += 1;
        if !influence.dirty {
            influence.dirty = true;
            self.dirty.push(pull.node);
        }
    }

    /// Nodes whose influenced set changed since the last call, ascending.
    pub fn take_dirty(&mut self) -> Vec<u32> {
        let mut dirty = std::mem::take(&mut self.dirty);
        dirty.sort_unstable();
        for &node in &dirty {
            self.influences[node as usize].dirty = false;
        }
        dirty
    }

    /// Where the influenced set makes `node` grow, unless it is empty or pulls nowhere.
    pub fn pulled(&self, node: u32, step: f32, tropism: Vec3) -> Option<Vec3> {
        let Influence { sum: [x, y, z], points, .. } = self.influences[node as usize];
        if points == 0 {
            return None;
        }
        let bent = unit(DVec3::new(x as f64, y as f64, z as f64))? + tropism.as_dvec3();
        // Tropism that cancels the pull leaves rounding, which points nowhere.
        (bent.abs().max_element() > VANISHING).then(|| unit(bent))?.and_then(|n| self.child(node, n, step))
    }

    /// Where `node` grows towards `point`.
    pub fn drawn(&self, node: u32, point: Vec3, step: f32) -> Option<Vec3> {
        let offset = point.as_dvec3() - self.branching.positions[node as usize].as_dvec3();
        self.child(node, unit(offset)?, step)
    }

    /// One step from `node`, unless rounding loses it or that child exists.
    fn child(&self, node: u32, direction: DVec3, step: f32) -> Option<Vec3> {
        let positions = &self.branching.positions;
        let from = positions[node as usize];
        let child = (from.as_dvec3() + f64::from(step) * direction).as_vec3();
        let mut sibling = self.youngest[node as usize];
        while sibling != NONE {
            if positions[sibling as usize] == child {
                return None;
            }
            sibling = self.elder[sibling as usize];
        }
        (child != from).then_some(child)
    }
}

/// `None` for the zero vector.
fn unit(vector: DVec3) -> Option<DVec3> {
    let length = (vector.x * vector.x + vector.y * vector.y + vector.z * vector.z).sqrt();
    (length > 0.0).then(|| vector / length)
}

/// Room for `more`, growing by a quarter: at millions of nodes a doubling would be the peak of memory.
fn reserve<T>(all: &mut Vec<T>, more: usize) {
    if all.capacity() - all.len() < more {
        all.reserve_exact(more.max(all.len() / 4).max(64));
    }
}
