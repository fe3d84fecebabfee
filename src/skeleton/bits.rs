//! Whether something holds of each node: a bit a node.

use linden_base::memory::bytes_of;

/// A bit for each node; none is set at first.
pub(super) struct Bits(Vec<u64>);

impl Bits {
    pub fn new(nodes: usize) -> Self {
        Self(vec![0; nodes.div_ceil(64)])
    }

    pub fn set(&mut self, node: u32) {
        self.0[node as usize / 64] |= 1 << (node % 64);
    }

    pub fn is_set(&self, node: u32) -> bool {
        self.0[node as usize / 64] >> (node % 64) & 1 == 1
    }

    pub const fn bytes_for(nodes: usize) -> u64 {
        bytes_of::<u64>(nodes.div_ceil(64))
    }
}
