//! The growing nodes: where they are and what they grow next.

use glam::{DVec3, Vec3};

use super::NONE;
use super::influence::Influences;
use crate::skeleton::{Branching, NO_PARENT};

/// What is left of a unit vector when something of about the same length cancels it.
const VANISHING: f64 = 1e-9;

/// Of a node: 24 are the result, 40 serve growth.
const BYTES: u64 = 64;

/// Nodes, 60 bytes each: 24 are the result, 36 serve growth.
pub(super) struct Nodes {
    pub branching: Branching,
    pub influences: Influences,
    /// The last child of each node, or [`NONE`].
    youngest: Vec<u32>,
    /// The child that the same parent grew before, or [`NONE`].
    elder: Vec<u32>,
}

impl Nodes {
    /// Parents of `start` come before their children.
    pub fn new(start: &Branching) -> Self {
        let mut nodes = Self {
            branching: start.clone(),
            influences: Influences::default(),
            youngest: Vec::new(),
            elder: Vec::new(),
        };
        for &parent in &start.parents {
            nodes.adopt(parent);
        }
        nodes
    }

    pub fn len(&self) -> usize {
        self.branching.positions.len()
    }

    /// The peak while `more` are added.
    pub fn bytes_with(&self, more: usize) -> u64 {
        const LARGEST: u64 = 32;
        let (len, capacity) = (self.len() as u64, self.branching.positions.capacity() as u64);
        let room =
            if capacity - len < more as u64 { len + (more as u64).max(len / 4).max(64) } else { capacity };
        // The largest list moves while the others are there.
        room * BYTES + if room == capacity { 0 } else { len * LARGEST }
    }

    fn adopt(&mut self, parent: u32) {
        let index = self.youngest.len() as u32;
        self.influences.add_node();
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
        self.influences.reserve(more);
        reserve(&mut self.youngest, more);
        reserve(&mut self.elder, more);
        for &(parent, position) in children {
            self.branching.positions.push(position);
            self.branching.parents.push(parent);
            self.branching.births.push(birth);
            self.adopt(parent);
        }
    }

    /// Where the influenced set makes `node` grow, unless it is empty or pulls nowhere.
    pub fn pulled(&self, node: u32, step: f32, tropism: Vec3) -> Option<Vec3> {
        let bent = unit(self.influences.sum(node)?)? + tropism.as_dvec3();
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
pub(super) fn reserve<T>(all: &mut Vec<T>, more: usize) {
    if all.capacity() - all.len() < more {
        all.reserve_exact(more.max(all.len() / 4).max(64));
    }
}
