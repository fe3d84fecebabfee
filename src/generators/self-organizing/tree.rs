//! The trees that grow: a list for each property of nodes, parents before children.

use glam::{DVec3, Vec3};
use linden_base::random::Key;
use linden_skeleton::NO_PARENT;

use crate::SelfOrganizing;
use crate::light::Voxel;

/// The most lateral buds at a node.
pub(crate) const MOST_BUDS: u32 = 8;

/// The apex of the node's axis is here, and alive.
pub(crate) const APEX: u8 = 1;
/// The node begins a lateral axis.
pub(crate) const LATERAL: u8 = 2;
/// The node is about to be taken out.
pub(crate) const SHED: u8 = 4;
/// The node is dead wood: it has neither leaves nor buds.
pub(crate) const DEAD: u8 = 8;

/// Declares lists of equal length, and what is done to all of them.
macro_rules! lists {
    ($(#[$about:meta])* $lists:ident { $($(#[$note:meta])* $name:ident: $kind:ty,)+ }) => {
        $(#[$about])*
        pub(crate) struct $lists {
            $($(#[$note])* pub $name: Vec<$kind>,)+
        }

        impl $lists {
            /// Bytes of an entry in all lists.
            const BYTES: u64 = 0 $(+ size_of::<$kind>() as u64)+;

            /// Makes room for just so many more.
            pub fn reserve(&mut self, more: usize) {
                $(self.$name.reserve_exact(more);)+
            }

            /// An entry is overwritten by another.
            fn overwrite(&mut self, to: usize, from: usize) {
                $(self.$name[to] = self.$name[from];)+
            }

            fn truncate(&mut self, count: usize) {
                $(self.$name.truncate(count);)+
            }
        }
    };
}

lists! {
/// A node is the end of an internode, with its leaves and their buds; the foot of a tree ends none.
/// Lengths are in internodes, the edge of a voxel.
#[derive(Clone, Debug, Default)]
Nodes {
    parents: u32,
    places: Vec3,
    /// Of the internode that ends here; of length 1.
    directions: Vec3,
    /// Across the direction, where the first lateral bud is; of length 1.
    sides: Vec3,
    /// What is drawn here and above.
    keys: Key,
    /// The year, and the part of it in [`PARTS`].
    births: u32,
    /// Of the axis: 0 for a stem.
    orders: u8,
    flags: u8,
    /// Dormant lateral buds, a bit each.
    buds: u8,
    /// Years in a row in which the branch that begins here was too dark; of one that died, since then.
    dark_years: u8,
    /// Tips that were shed from here.
    shed_tips: u32,
    /// The largest moment of what hung on the internode so far, newton metres.
    moments: f32,
    /// How far the internode rose when it grew, the height of its direction.
    rises: f32,
    /// Its pipes of the year before.
    pipes_before: u32,
}
}

/// Births in a year.
pub(crate) const PARTS: u32 = 16;

/// Bytes of a node with all that a year works out for it.
pub(crate) const NODE_BYTES: u64 = Nodes::BYTES + YEAR_BYTES;
/// Light and sums (28) with shares and the lists of children (32), later with shares (24), what is counted for lone limbs
/// (14) and pipes (4), or, later still, pipes, loads and places before (48).
const YEAR_BYTES: u64 = 28 + 24 + 14 + 4;

/// What a node is made of.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Node {
    pub parent: u32,
    pub place: DVec3,
    pub direction: DVec3,
    pub side: DVec3,
    pub key: Key,
    pub birth: u32,
    pub order: u8,
    pub flags: u8,
    pub buds: u8,
}

impl Nodes {
    pub fn len(&self) -> usize {
        self.parents.len()
    }

    pub fn push(&mut self, node: &Node) {
        self.parents.push(node.parent);
        self.places.push(node.place.as_vec3());
        self.directions.push(node.direction.as_vec3());
        self.sides.push(node.side.as_vec3());
        self.keys.push(node.key);
        self.births.push(node.birth);
        self.orders.push(node.order);
        self.flags.push(node.flags);
        self.buds.push(node.buds);
        self.dark_years.push(0);
        self.shed_tips.push(0);
        self.moments.push(0.0);
        self.rises.push(node.direction.y as f32);
        self.pipes_before.push(0);
    }

    pub fn is(&self, node: usize, flag: u8) -> bool {
        self.flags[node] & flag != 0
    }

    /// Whether it is the foot of a tree.
    pub fn is_foot(&self, node: usize) -> bool {
        self.parents[node] == NO_PARENT
    }

    /// The year in which a node grew; 0 for a foot.
    pub fn year(&self, node: usize) -> u32 {
        self.births[node] / PARTS
    }

    /// Where a node's light is read, and its shade begins.
    pub fn voxel(&self, node: usize) -> Voxel {
        // Rounded down; `floor` is a call on machines without SSE 4.1.
        self.places[node].to_array().map(|v| (v as i32).saturating_sub(i32::from(v < (v as i32) as f32)))
    }

    /// The height below which no branch grows, in internodes: that of the bole, but at most a third of the tallest
    /// tree's, as crowns of young trees are raised.
    pub fn bole(&self, settings: &SelfOrganizing) -> f32 {
        if settings.bole_m == 0.0 {
            return 0.0;
        }
        let tallest = self.places.iter().map(|place| place.y).fold(0.0, f32::max);
        ((settings.bole_m / settings.internode_m) as f32).min(tallest / 3.0)
    }

    /// Takes out what is [`SHED`], keeping the order.
    pub fn compact(&mut self) {
        let mut kept = 0_u32;
        let mut numbers = vec![NO_PARENT; self.len()];
        for node in 0..self.len() {
            if self.is(node, SHED) {
                continue;
            }
            let parent = self.parents[node];
            let parent = if parent == NO_PARENT { NO_PARENT } else { numbers[parent as usize] };
            numbers[node] = kept;
            self.overwrite(kept as usize, node);
            self.parents[kept as usize] = parent;
            kept += 1;
        }
        self.truncate(kept as usize);
    }

    /// How many tips hang on each node, those that were shed included: the pipes of the pipe model
    /// (Shinozaki et al. 1964). Wood does not get thinner when it loses branches.
    pub fn pipes(&self) -> Vec<u32> {
        let mut pipes = self.shed_tips.clone();
        for node in (0..self.len()).rev() {
            pipes[node] = pipes[node].max(1);
            if !self.is_foot(node) {
                let parent = self.parents[node] as usize;
                pipes[parent] = pipes[parent].saturating_add(pipes[node]);
            }
        }
        pipes
    }
}
