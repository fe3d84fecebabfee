//! The tree while it is edited: axes and nodes keep their numbers, and new ones come behind.

use std::collections::BTreeMap;

use glam::{DQuat, DVec3};
use linden_base::knob::FARTHEST;
use linden_base::memory::{OverMemory, bytes_of};
use linden_base::monitor::Monitor;

use super::{AxisOrigin, Origins};
use crate::{Axis, Forks, Marks, NO_PARENT, RadiusFit, RadiusSource, Skeleton, Tips, WidthSteps};

/// Two places along an axis that are no farther apart, in lengths of the axis, are one.
pub(super) const SAME: f64 = 1e-9;

/// A node of the tree.
#[derive(Clone, Copy, Debug)]
pub(super) struct WorkNode {
    /// Metres.
    pub at: DVec3,
    /// Metres.
    pub radius_m: f64,
    pub parent: u32,
    pub birth: u32,
    /// The node of the tree as grown whose thickening over time it follows.
    pub origin: u32,
    /// The node of the tree as grown whose organs it bears; [`NO_PARENT`] for none.
    pub bears: u32,
    /// How it was turned since then.
    pub turn: DQuat,
    /// How it was scaled since then.
    pub size: f64,
}

/// An axis of the tree.
#[derive(Clone, Debug)]
pub(super) struct WorkAxis {
    /// The node that it leaves from; [`NO_PARENT`] of a stem.
    pub parent: u32,
    pub order: u32,
    /// From its base up.
    pub nodes: Vec<u32>,
    /// Axes that leave from it, in no order.
    pub laterals: Vec<u32>,
    pub is_gone: bool,
    pub is_cut: bool,
    pub origin: AxisOrigin,
    /// What random choices for it follow from.
    pub number: u32,
}

/// The tree while it is edited.
pub(super) struct Workpiece<'a> {
    pub grown: &'a Skeleton,
    pub nodes: Vec<WorkNode>,
    pub axes: Vec<WorkAxis>,
    /// The axis of each node.
    pub axis_of: Vec<u32>,
    /// The last birth of the tree as grown.
    pub last_birth: u32,
    /// The tips as grown.
    pub tips: Tips,
    /// Whether something went too far away, or got too thick or thin for numbers.
    pub is_lost: bool,
}

impl<'a> Workpiece<'a> {
    /// Bytes that one of a skeleton takes at most, with `more` new nodes.
    pub fn bytes_for(grown: &Skeleton, more: usize) -> u64 {
        bytes_of::<(WorkNode, [u32; 6])>(grown.positions.len() + more)
            + bytes_of::<(WorkAxis, [u32; 2])>(grown.axes.len() + more / 4)
    }

    /// Asks for the memory of a skeleton's, and of the skeleton that it will become.
    pub fn admit(grown: &Skeleton, more: usize, monitor: &dyn Monitor) -> Result<(), OverMemory> {
        let bytes = 2 * grown.bytes() + Self::bytes_for(grown, more);
        monitor.admit("editing the wood", bytes, "take edits out of the recipe, or grow a smaller tree")
    }

    pub fn new(grown: &'a Skeleton) -> Self {
        let node = |node: usize| WorkNode {
            at: grown.positions[node].as_dvec3(),
            radius_m: grown.radii[node].into(),
            parent: grown.parents[node],
            birth: grown.births[node],
            origin: node as u32,
            bears: node as u32,
            turn: DQuat::IDENTITY,
            size: 1.0,
        };
        let axis_of = grown.axis_of_nodes();
        let axis = |(index, axis): (u32, &Axis)| WorkAxis {
            parent: axis.parent,
            order: axis.order,
            nodes: grown.nodes_of(axis).to_vec(),
            laterals: Vec::new(),
            is_gone: false,
            is_cut: false,
            origin: AxisOrigin::Grown(index),
            number: grown.axis_number(index as usize),
        };
        let mut axes: Vec<WorkAxis> = (0..).zip(&grown.axes).map(axis).collect();
        for (index, axis) in (0..).zip(&grown.axes).filter(|(_, axis)| axis.parent != NO_PARENT) {
            axes[axis_of[axis.parent as usize] as usize].laterals.push(index);
        }
        Self {
            nodes: (0..grown.positions.len()).map(node).collect(),
            axes,
            axis_of,
            last_birth: grown.births.iter().copied().max().unwrap_or(0),
            tips: grown.grown_tips(&Forks::new(grown)),
            is_lost: false,
            grown,
        }
    }

    /// Puts a node somewhere.
    pub fn place(&mut self, node: u32, at: DVec3) {
        self.is_lost |= !(at.abs().max_element() <= FARTHEST);
        self.nodes[node as usize].at = at;
    }

    /// Makes a node so thick.
    pub fn thicken(&mut self, node: u32, radius_m: f64) {
        self.is_lost |= !(radius_m >= f64::from(f32::MIN_POSITIVE) && radius_m <= FARTHEST);
        self.nodes[node as usize].radius_m = radius_m;
    }

    /// The nodes of an axis, with the node that it leaves from before them.
    pub fn line(&self, axis: u32) -> Vec<u32> {
        let WorkAxis { parent, nodes, .. } = &self.axes[axis as usize];
        Some(*parent).filter(|&parent| parent != NO_PARENT).into_iter().chain(nodes.iter().copied()).collect()
    }

    pub fn at(&self, node: u32) -> DVec3 {
        self.nodes[node as usize].at
    }

    /// The way from the first of some nodes to each, metres.
    pub fn ways(&self, line: &[u32]) -> Vec<f64> {
        let mut way = 0.0;
        let steps = line.windows(2).map(|pair| {
            way += self.at(pair[0]).distance(self.at(pair[1]));
            way
        });
        std::iter::once(0.0).chain(steps).collect()
    }

    /// The length of an axis from where it leaves, metres.
    pub fn length_m(&self, axis: u32) -> f64 {
        self.ways(&self.line(axis)).last().copied().unwrap_or(0.0)
    }

    /// An axis and all that it bears, itself first.
    pub fn family(&self, axis: u32) -> Vec<u32> {
        let mut all = vec![axis];
        let mut next = 0;
        while let Some(&axis) = all.get(next) {
            all.extend(self.axes[axis as usize].laterals.iter().filter(|&&l| !self.axes[l as usize].is_gone));
            next += 1;
        }
        all
    }

    /// The laterals of an axis that leave from one of its nodes.
    pub fn laterals_at(&self, axis: u32, node: u32) -> Vec<u32> {
        let leaves = |lateral: &&u32| {
            let lateral = &self.axes[**lateral as usize];
            lateral.parent == node && !lateral.is_gone
        };
        self.axes[axis as usize].laterals.iter().filter(leaves).copied().collect()
    }

    /// The node that stands this far along an axis: one that is there, within `snap_m`, or a new one, which
    /// changes neither course nor thickness. The first may be that which the axis leaves from.
    pub fn split(&mut self, axis: u32, along_m: f64, snap_m: f64) -> u32 {
        let line = self.line(axis);
        let ways = self.ways(&line);
        let length_m = ways.last().copied().unwrap_or(0.0);
        let along_m = along_m.clamp(0.0, length_m);
        let nearest =
            (0..line.len()).min_by(|&a, &b| (ways[a] - along_m).abs().total_cmp(&(ways[b] - along_m).abs()));
        if let Some(nearest) = nearest
            && (ways[nearest] - along_m).abs() <= snap_m.max(SAME * length_m)
        {
            return line[nearest];
        }
        // Between two nodes: at either end one of them would have been near enough.
        let above = ways.partition_point(|&way| way < along_m).clamp(1, line.len() - 1);
        let (from, to) = (line[above - 1], line[above]);
        let t = (along_m - ways[above - 1]) / (ways[above] - ways[above - 1]);
        let is_lateral = self.axes[axis as usize].parent != NO_PARENT;
        let (below, end) = (self.nodes[from as usize], self.nodes[to as usize]);
        let in_steps = self.grown.width_steps == WidthSteps::Cylinder;
        // A lateral is as thick where it leaves as at its first node.
        let lower_m = if in_steps || (is_lateral && above == 1) { end.radius_m } else { below.radius_m };
        let new = WorkNode {
            at: below.at.lerp(end.at, t),
            radius_m: lower_m + (end.radius_m - lower_m) * t,
            parent: from,
            bears: NO_PARENT,
            ..end
        };
        let node = self.push(new, axis);
        self.nodes[to as usize].parent = node;
        self.axes[axis as usize].nodes.insert(above - usize::from(is_lateral), node);
        node
    }

    /// Adds a node, which is yet to be put into the list of its axis.
    pub fn push(&mut self, node: WorkNode, axis: u32) -> u32 {
        self.nodes.push(node);
        self.axis_of.push(axis);
        let index = self.nodes.len() as u32 - 1;
        self.place(index, node.at);
        self.thicken(index, node.radius_m);
        index
    }

    /// Takes an axis away, with all that it bears.
    pub fn take_away(&mut self, axis: u32) {
        for axis in self.family(axis) {
            self.axes[axis as usize].is_gone = true;
        }
    }

    /// Moves whole axes; `turn` and `size` are what that does to what hangs on them.
    pub fn move_axes(&mut self, axes: &[u32], to: impl Fn(DVec3) -> DVec3, turn: DQuat, size: f64) {
        for &axis in axes {
            for i in 0..self.axes[axis as usize].nodes.len() {
                let node = self.axes[axis as usize].nodes[i];
                self.place(node, to(self.at(node)));
                self.turn(node, turn, size);
            }
        }
    }

    pub fn turn(&mut self, node: u32, turn: DQuat, size: f64) {
        let node = &mut self.nodes[node as usize];
        node.turn = (turn * node.turn).normalize();
        node.size *= size;
    }

    /// How sure radii are of some nodes, where they were measured: those that are as thick as they were keep it, and what
    /// was put between two of them was carried on.
    fn fits(&self, order: &[u32]) -> Vec<RadiusFit> {
        let grown = self.grown;
        if grown.fits.is_empty() {
            return Vec::new();
        }
        let fit = |&number: &u32| {
            let WorkNode { radius_m, origin, bears, .. } = self.nodes[number as usize];
            let is_as_grown = bears == number && radius_m as f32 == grown.radii[origin as usize];
            let axis = &self.axes[self.axis_of[number as usize] as usize];
            let is_between = bears == NO_PARENT && matches!(axis.origin, AxisOrigin::Grown(_));
            match grown.fits.get(origin as usize) {
                Some(fit) if is_as_grown => *fit,
                Some(fit) if is_between && fit.source != RadiusSource::Guessed => {
                    RadiusFit { source: RadiusSource::Carried, ..RadiusFit::GUESSED }
                }
                _ => RadiusFit::GUESSED,
            }
        };
        order.iter().map(fit).collect()
    }

    /// The skeleton that it has become. Nodes keep their order as far as parents come before children.
    pub fn finish(self) -> (Skeleton, Origins, Vec<NodeMove>) {
        let stays: Vec<bool> = self.stays();
        let count = stays.iter().filter(|&&stays| stays).count();
        let mut new = vec![NO_PARENT; self.nodes.len()];
        let mut order: Vec<u32> = Vec::with_capacity(count);
        let mut below = Vec::new();
        for node in (0..self.nodes.len() as u32).filter(|&node| stays[node as usize]) {
            // What was put between comes right before what it bears.
            let mut next = node;
            while next != NO_PARENT && new[next as usize] == NO_PARENT {
                below.push(next);
                next = self.nodes[next as usize].parent;
            }
            while let Some(node) = below.pop() {
                new[node as usize] = order.len() as u32;
                order.push(node);
            }
        }
        let renamed = |node: u32| if node == NO_PARENT { NO_PARENT } else { new[node as usize] };
        let node = |&node: &u32| &self.nodes[node as usize];
        let mut skeleton = Skeleton {
            positions: order.iter().map(|n| node(n).at.as_vec3()).collect(),
            parents: order.iter().map(|n| renamed(node(n).parent)).collect(),
            radii: order.iter().map(|n| node(n).radius_m as f32).collect(),
            births: order.iter().map(|n| node(n).birth).collect(),
            axes: Vec::new(),
            axis_nodes: Vec::with_capacity(count),
            width_steps: self.grown.width_steps,
            marks: Marks { tips: Some(self.tips), ..Marks::default() },
            fits: self.fits(&order),
            trees: self.trees(&order),
        };
        let factor = |n: &u32| {
            let WorkNode { radius_m, origin, .. } = node(n);
            (radius_m / f64::from(self.grown.radii[*origin as usize])) as f32
        };
        let mut origins = Origins {
            nodes: order.iter().map(|n| node(n).origin).collect(),
            factors: order.iter().map(factor).collect(),
            axes: Vec::new(),
        };
        let moves = order.iter().map(|n| NodeMove::of(node(n))).collect();
        for axis in self.axes.into_iter().filter(|axis| !axis.is_gone) {
            let first = skeleton.axis_nodes.len() as u32;
            let len = axis.nodes.len() as u32;
            skeleton.axis_nodes.extend(axis.nodes.iter().map(|&node| new[node as usize]));
            if let Some(&end) = axis.nodes.last().filter(|_| axis.is_cut) {
                skeleton.marks.cuts.push(new[end as usize]);
            }
            let parent = if axis.parent == NO_PARENT { NO_PARENT } else { new[axis.parent as usize] };
            skeleton.axes.push(Axis { order: axis.order, parent, first, len });
            skeleton.marks.numbers.push(axis.number);
            origins.axes.push(axis.origin);
        }
        skeleton.marks.cuts.sort_unstable();
        (skeleton, origins, moves)
    }

    /// The tree of each foot among some nodes, in their order: that of the node that it is from.
    fn trees(&self, order: &[u32]) -> Vec<u32> {
        if self.grown.trees.is_empty() {
            return Vec::new();
        }
        let feet = (0_u32..).zip(&self.grown.parents).filter(|(_, parent)| **parent == NO_PARENT);
        let of_feet: BTreeMap<u32, u32> =
            feet.map(|(foot, _)| foot).zip(self.grown.trees.iter().copied()).collect();
        let tree = |&node: &u32| {
            let mut root = self.nodes[node as usize].origin;
            while self.grown.parents[root as usize] != NO_PARENT {
                root = self.grown.parents[root as usize];
            }
            of_feet.get(&root).copied().unwrap_or_default()
        };
        order.iter().filter(|&&node| self.nodes[node as usize].parent == NO_PARENT).map(tree).collect()
    }

    fn stays(&self) -> Vec<bool> {
        let mut stays = vec![false; self.nodes.len()];
        for axis in self.axes.iter().filter(|axis| !axis.is_gone) {
            axis.nodes.iter().for_each(|&node| stays[node as usize] = true);
        }
        stays
    }
}

/// Where the organs of a node of the tree as grown went.
#[derive(Clone, Copy, Debug)]
pub(super) struct NodeMove {
    /// That node; [`NO_PARENT`] for none.
    pub bears: u32,
    pub at: DVec3,
    pub turn: DQuat,
    pub size: f64,
}

impl NodeMove {
    fn of(node: &WorkNode) -> Self {
        let WorkNode { bears, at, turn, size, .. } = *node;
        Self { bears, at, turn, size }
    }
}
