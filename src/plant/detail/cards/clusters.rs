//! Cuts a tree's foliage into pieces that hang together: what one branch card stands for.
//!
//! From the tips down, what neighbours bear is put together as long as it fits into a box of a given size; what
//! does not fit is closed, and a new piece begins. Small sizes give twigs, larger ones branches and limbs, and
//! each piece is a part of the tree below one node.

use glam::{DMat3, DVec3, Vec3};

use super::super::forms::LevelForms;
use super::super::wood::GOLDEN;
use super::{Rod, rods};
use linden_base::memory::bytes_of;
use linden_base::monitor::{Cancelled, Monitor};
use linden_skeleton::organs::Organs;
use linden_skeleton::{NO_PARENT, Skeleton};

/// Nodes between two looks at the monitor.
const NODES_PER_CHECK: usize = 1 << 16;
/// Of nodes that are alike the last closes its piece at a size larger by this share than the first: a grammar's
/// tree would otherwise change by hundreds of pieces at once.
const SPREAD: f32 = 0.5;
/// No piece.
pub(in crate::detail) const NONE: u32 = u32::MAX;

/// Where some organs are: their moments, weighed by area, and the box round them.
#[derive(Clone, Copy, Debug)]
pub(in crate::detail) struct Mass {
    pub weight: f64,
    sum: DVec3,
    squares: DMat3,
    low: Vec3,
    high: Vec3,
}

impl Mass {
    const NOTHING: Self = Self {
        weight: 0.0,
        sum: DVec3::ZERO,
        squares: DMat3::ZERO,
        low: Vec3::INFINITY,
        high: Vec3::NEG_INFINITY,
    };

    /// A rod of even weight.
    fn rod(from: Vec3, to: Vec3, weight: f64) -> Self {
        let (middle, half) = (from.midpoint(to).as_dvec3(), (to - from).as_dvec3() / 2.0);
        // Besides its length it has some width: a leaf is no line.
        let width = 0.02 * half.length_squared();
        let squares = outer(middle) + outer(half) * (1.0 / 3.0) + DMat3::from_diagonal(DVec3::splat(width));
        Self {
            weight,
            sum: middle * weight,
            squares: squares * weight,
            low: from.min(to),
            high: from.max(to),
        }
    }

    fn with(&self, other: &Self) -> Self {
        Self {
            weight: self.weight + other.weight,
            sum: self.sum + other.sum,
            squares: self.squares + other.squares,
            low: self.low.min(other.low),
            high: self.high.max(other.high),
        }
    }

    /// The diagonal of its box, metres.
    fn extent_m(&self) -> f32 {
        if self.weight > 0.0 { self.low.distance(self.high) } else { 0.0 }
    }

    pub fn middle(&self) -> DVec3 {
        self.sum / self.weight
    }

    /// The root of the mean square distance from its middle, metres.
    pub fn radius_m(&self) -> f64 {
        let spread = self.covariance();
        (spread.x_axis.x + spread.y_axis.y + spread.z_axis.z).max(1e-12).sqrt()
    }

    /// How it is spread about its middle, square metres.
    pub fn covariance(&self) -> DMat3 {
        self.squares * (1.0 / self.weight) - outer(self.middle())
    }
}

fn outer(v: DVec3) -> DMat3 {
    DMat3::from_cols(v * v.x, v * v.y, v * v.z)
}

/// What each node of a tree bears: organs, and wood that is left out.
pub(in crate::detail) struct Burden {
    /// By node.
    borne: Vec<Mass>,
    parents: Vec<u32>,
    /// For each node where its children are in `children`.
    first_child: Vec<u32>,
    children: Vec<u32>,
}

/// Pieces of a tree.
pub(in crate::detail) struct Cut {
    /// The piece of each node; [`NONE`] where there is none.
    pub piece_of: Vec<u32>,
    /// The node that each hangs on, with what it is.
    pub pieces: Vec<(u32, Mass)>,
}

impl Cut {
    /// The piece that reaches highest.
    pub fn highest(&self) -> Option<u32> {
        let heights = (0..).zip(&self.pieces).map(|(piece, (_, mass))| (piece, mass.high.y));
        heights.max_by(|(_, a), (_, b)| a.total_cmp(b)).map(|(piece, _)| piece)
    }
}

impl Burden {
    pub fn new(skeleton: &Skeleton, organs: &Organs, forms: &LevelForms, is_thin: &[bool]) -> Self {
        let nodes = skeleton.positions.len();
        let mut borne = vec![Mass::NOTHING; nodes];
        for Rod { node, from, to, weight } in rods(skeleton, organs, forms, is_thin) {
            if let Some(there) = borne.get_mut(node as usize) {
                *there = there.with(&Mass::rod(from, to, weight.into()));
            }
        }
        let mut first_child = vec![0_u32; nodes + 1];
        for &parent in skeleton.parents.iter().filter(|parent| **parent != NO_PARENT) {
            first_child[parent as usize + 1] += 1;
        }
        for node in 0..nodes {
            first_child[node + 1] += first_child[node];
        }
        let mut next = first_child.clone();
        let mut children = vec![0; first_child[nodes] as usize];
        for (node, &parent) in skeleton.parents.iter().enumerate() {
            if parent != NO_PARENT {
                let at = &mut next[parent as usize];
                children[*at as usize] = node as u32;
                *at += 1;
            }
        }
        Self { borne, parents: skeleton.parents.clone(), first_child, children }
    }

    /// Bytes for a tree of so many nodes, while it is cut.
    pub const fn bytes_for(nodes: usize) -> u64 {
        2 * bytes_of::<Mass>(nodes) + bytes_of::<[u32; 5]>(nodes)
    }

    /// How many pieces there are of at most about `size_m`, the diagonal of a box.
    pub fn count(&self, size_m: f32, monitor: &dyn Monitor) -> Result<usize, Cancelled> {
        let (open, closed) = self.closed(size_m, monitor)?;
        Ok(open.iter().zip(closed).filter(|(mass, closed)| *closed && mass.weight > 0.0).count())
    }

    /// The pieces of at most about that size.
    pub fn cut(&self, size_m: f32, monitor: &dyn Monitor) -> Result<Cut, Cancelled> {
        let (open, closed) = self.closed(size_m, monitor)?;
        let mut cut = Cut { piece_of: vec![NONE; open.len()], pieces: Vec::new() };
        for (node, (mass, closed)) in open.into_iter().zip(closed).enumerate() {
            let parent = self.parents[node];
            cut.piece_of[node] = if closed && mass.weight > 0.0 {
                cut.pieces.push((node as u32, mass));
                cut.pieces.len() as u32 - 1
            } else if parent == NO_PARENT {
                NONE
            } else {
                cut.piece_of[parent as usize]
            };
        }
        Ok(cut)
    }

    /// For each node what hangs together at it, and whether that is a piece of its own.
    fn closed(&self, size_m: f32, monitor: &dyn Monitor) -> Result<(Vec<Mass>, Vec<bool>), Cancelled> {
        let nodes = self.borne.len();
        let (mut open, mut closed) = (self.borne.clone(), vec![false; nodes]);
        let mut rest: Vec<u32> = Vec::new();
        for node in (0..nodes).rev() {
            if node.is_multiple_of(NODES_PER_CHECK) {
                monitor.check()?;
            }
            let children = self.first_child[node] as usize..self.first_child[node + 1] as usize;
            rest.clear();
            rest.extend_from_slice(&self.children[children]);
            let limit_m = size_m * (1.0 + SPREAD * (node as f64 * GOLDEN).fract() as f32);
            let together = |rest: &[u32], open: &[Mass]| {
                rest.iter().fold(self.borne[node], |sum, &child| sum.with(&open[child as usize]))
            };
            let mut sum = together(&rest, &open);
            while sum.extent_m() > limit_m {
                let extent = |child: u32| open[child as usize].extent_m();
                let largest = (0..rest.len()).max_by(|&a, &b| extent(rest[a]).total_cmp(&extent(rest[b])));
                let Some(largest) = largest else { break };
                closed[rest.swap_remove(largest) as usize] = true;
                sum = together(&rest, &open);
            }
            open[node] = sum;
            closed[node] = self.parents[node] == NO_PARENT;
        }
        Ok((open, closed))
    }
}
