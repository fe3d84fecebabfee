//! Radii and refinement on random trees, against what the rules say of each fork and axis.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

mod edits;
mod radii;
mod refinement;

use glam::Vec3;
use linden::{Branching, NO_PARENT};
use proptest::prelude::*;

/// Stems with forks of up to many children, on segments of uneven length; coinciding nodes, too.
pub fn branchings() -> impl Strategy<Value = Branching> {
    let node = (any::<u16>(), prop::array::uniform3(-1.0_f32..1.0), 0.0..1.0_f64, 0..9_u32);
    prop::collection::vec(node, 2..150).prop_map(|nodes| {
        let mut all = Branching::default();
        for (i, (parent, step, chance, birth)) in nodes.into_iter().enumerate() {
            let is_foot = i == 0 || (i > 1 && chance < 0.02);
            // Mostly on the node before, so that there are axes.
            let parent = if chance < 0.7 { i.saturating_sub(1) } else { usize::from(parent) % i.max(1) };
            let step = if chance > 0.98 { Vec3::ZERO } else { Vec3::from(step) + Vec3::Y * 0.5 };
            let from = if is_foot { Vec3::ZERO } else { all.positions[parent] };
            all.positions.push(from + step);
            all.parents.push(if is_foot { NO_PARENT } else { parent as u32 });
            all.births.push(birth);
        }
        all
    })
}
