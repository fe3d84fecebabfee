//! What a year begins with: the light of all buds, and its sums from the tips down.

use rayon::prelude::*;

use crate::light::Light;
use crate::tree::{APEX, DEAD, LATERAL, Nodes};

/// Nodes whose light a thread reads at once.
const CHUNK: usize = 4096;

/// Light, in parts of [`FULL_LIGHT`], and what else is counted from the tips down.
#[derive(Clone, Debug, Default)]
pub(crate) struct Sums {
    /// Light of each bud at a node: they are at one place.
    pub light: Vec<u32>,
    /// Light of the apex of the node's axis and all that is between.
    pub onward: Vec<u64>,
    /// Light of the node's lateral buds and branches.
    pub lateral: Vec<u64>,
    /// Living internodes from the one that ends in the node on.
    pub internodes: Vec<u32>,
    /// Buds from the node on.
    pub buds: Vec<u32>,
}

impl Sums {
    /// Light that a bud in the node's voxel gets. Nodes without buds are not read.
    ///
    /// Integers all along, so that any number of threads gives the same.
    pub fn new(nodes: &Nodes, sky: &Light) -> Self {
        let mut light = vec![0_u32; nodes.len()];
        light.par_chunks_mut(CHUNK).enumerate().for_each(|(chunk, part)| {
            for (node, light) in (chunk * CHUNK..).zip(part) {
                if !nodes.is(node, APEX) && nodes.buds[node] == 0 {
                    continue;
                }
                *light = sky.at(nodes, node);
            }
        });
        let count = nodes.len();
        let mut sums = Self {
            light,
            onward: vec![0; count],
            lateral: vec![0; count],
            internodes: vec![0; count],
            buds: vec![0; count],
        };
        for node in (0..count).rev() {
            let laterals = nodes.buds[node].count_ones();
            let apex = u32::from(nodes.is(node, APEX));
            let light = u64::from(sums.light[node]);
            sums.onward[node] += u64::from(apex) * light;
            sums.lateral[node] += u64::from(laterals) * light;
            sums.buds[node] += apex + laterals;
            if nodes.is_foot(node) {
                continue;
            }
            sums.internodes[node] += u32::from(!nodes.is(node, DEAD));
            let parent = nodes.parents[node] as usize;
            let all = sums.total(node);
            if nodes.is(node, LATERAL) {
                sums.lateral[parent] += all;
            } else {
                sums.onward[parent] += all;
            }
            sums.buds[parent] += sums.buds[node];
            sums.internodes[parent] += sums.internodes[node];
        }
        sums
    }

    /// Light from a node on.
    pub fn total(&self, node: usize) -> u64 {
        self.onward[node] + self.lateral[node]
    }
}
