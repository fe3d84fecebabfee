//! Where each node stands on the axes of the growing tree.

use super::lists::reserve;

/// What habits ask of nodes; 13 bytes a node, and 4 an axis.
#[derive(Default)]
pub(super) struct Axes {
    /// 0 on a stem, one more on a lateral than on the axis that it leaves; stays at 255.
    order: Vec<u8>,
    root: Vec<u32>,
    axis: Vec<u32>,
    /// Internodes from the base of the axis: 0 for a root, 1 for the first node of a lateral.
    rank: Vec<u32>,
    /// The last node of each axis.
    tips: Vec<u32>,
}

impl Axes {
    pub fn reserve(&mut self, more: usize) {
        reserve(&mut self.order, more);
        reserve(&mut self.root, more);
        reserve(&mut self.axis, more);
        reserve(&mut self.rank, more);
    }

    /// Adds a node that begins a stem.
    pub fn add_root(&mut self) {
        let node = self.order.len() as u32;
        self.add(0, node, self.tips.len() as u32, 0);
        self.tips.push(node);
    }

    /// Adds a child: the `first` of its parent continues its axis, others begin laterals.
    pub fn add_child(&mut self, parent: u32, first: bool) {
        let (node, parent) = (self.order.len() as u32, parent as usize);
        let (order, root) = (self.order[parent], self.root[parent]);
        if first {
            let axis = self.axis[parent];
            self.tips[axis as usize] = node;
            self.add(order, root, axis, self.rank[parent] + 1);
        } else {
            self.add(order.saturating_add(1), root, self.tips.len() as u32, 1);
            self.tips.push(node);
        }
    }

    fn add(&mut self, order: u8, root: u32, axis: u32, rank: u32) {
        self.order.push(order);
        self.root.push(root);
        self.axis.push(axis);
        self.rank.push(rank);
    }

    pub fn order(&self, node: u32) -> u8 {
        self.order[node as usize]
    }

    pub fn root(&self, node: u32) -> u32 {
        self.root[node as usize]
    }

    /// The last node of the axis on which `node` is.
    pub fn tip(&self, node: u32) -> u32 {
        self.tips[self.axis[node as usize] as usize]
    }

    /// Whether `node` is within the `share` of its axis next to the tip.
    pub fn is_near_tip(&self, node: u32, share: f32) -> bool {
        let rank = |node: u32| f64::from(self.rank[node as usize]);
        rank(node) > (1.0 - f64::from(share)) * rank(self.tip(node))
    }
}
