//! What editing leaves behind in a skeleton.

use linden_base::memory::bytes_of;

use super::{Forks, Skeleton};

/// What a skeleton that was edited is to keep of the tree as it grew; empty for one that was not.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Marks {
    /// For each axis the number that random choices for what grows on it follow from, so that taking away one
    /// branch changes no leaf of another; empty: its index.
    pub numbers: Vec<u32>,
    /// Nodes where an axis was cut off, ascending: wood that ends there is old, and ends in no bud.
    pub cuts: Vec<u32>,
    /// The tips before wood was cut: what counts as a twig goes by them.
    pub tips: Option<Tips>,
}

/// The tips of a tree.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tips {
    /// The sum of their radii, metres.
    pub radii_m: f64,
    /// How many there are; 1 for none.
    pub count: u32,
}

impl Marks {
    /// Whether there is nothing in it.
    pub fn is_empty(&self) -> bool {
        self.numbers.is_empty() && self.cuts.is_empty() && self.tips.is_none()
    }

    /// Bytes that they take.
    pub(super) fn bytes(&self) -> u64 {
        bytes_of::<u32>(self.numbers.capacity() + self.cuts.capacity())
    }
}

impl Skeleton {
    /// The number that random choices for what grows on an axis follow from: its index, as grown.
    pub fn axis_number(&self, axis: usize) -> u32 {
        self.marks.numbers.get(axis).copied().unwrap_or(axis as u32)
    }

    /// The tips of the tree: as it grew, where it was edited since.
    pub fn grown_tips(&self, forks: &Forks) -> Tips {
        self.marks.tips.unwrap_or_else(|| {
            let apices = self.axes.iter().filter_map(|axis| self.nodes_of(axis).last());
            let tips = apices.filter(|apex| !forks.ends_at(**apex));
            let radii_m = tips.map(|&tip| f64::from(self.radii[tip as usize])).sum();
            Tips { radii_m, count: (self.axes.len() - forks.len()).max(1) as u32 }
        })
    }

    /// Whether an axis was cut off at a node.
    pub fn is_cut_at(&self, node: u32) -> bool {
        self.marks.cuts.binary_search(&node).is_ok()
    }
}
