//! Which axis bears which, for shaders that look pivots up and turn what is borne with what bears it.

use std::sync::Arc;

use glam::Vec3;

use super::Field;
use linden_skeleton::NO_PARENT;

/// An axis as a piece that turns about its pivot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisPivot {
    /// The axis that bears it, an index among those of the tree: one before it, or its own of a stem.
    pub parent: u32,
    /// 0 of a stem, 1 of its branches and so on.
    pub level: u32,
    /// Where it leaves what bears it, metres.
    pub pivot: Vec3,
    /// Unit vector from there to its tip.
    pub along: Vec3,
}

impl Field<'_> {
    /// All axes of the whole tree.
    pub(super) fn hierarchy(&self) -> Arc<[AxisPivot]> {
        let whole = self.whole;
        let of_axis = |(index, axis): (usize, &linden_skeleton::Axis)| {
            let parent = match axis.parent {
                NO_PARENT => index as u32,
                node => self.axis_of[node as usize],
            };
            let pivot = self.axes[index].pivot;
            let tip = whole.nodes_of(axis).last().map_or(pivot, |&node| whole.positions[node as usize]);
            AxisPivot { parent, level: axis.order, pivot, along: (tip - pivot).normalize_or(Vec3::Y) }
        };
        whole.axes.iter().enumerate().map(of_axis).collect()
    }
}
