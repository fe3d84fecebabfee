//! An edited tree as it was at an earlier step.

use linden_base::random::Key;

use super::{AxisOrigin, Origins};
use crate::{Axis, Marks, NO_PARENT, Skeleton, Wood};

impl Origins {
    /// An edited tree at a step of its growth, and where its nodes and axes are from: the nodes that were born by then,
    /// as edited, each as thick as what it is from was then. With `skeleton` what was edited, `grown` as it grew, and
    /// `wood` and `key` as for [`Skeleton::until`].
    pub fn until(
        &self,
        (skeleton, grown): (&Skeleton, &Skeleton),
        step: u32,
        wood: &Wood,
        key: Key,
    ) -> (Skeleton, Self) {
        let there = skeleton.born_by(step);
        if there.iter().all(|there| *there) {
            return (skeleton.clone(), self.clone());
        }
        let young = grown.until(step, wood, key);
        let was_there = grown.born_by(step);
        let mut young_radii = vec![None; was_there.len()];
        let nodes = (0..was_there.len()).filter(|&node| was_there[node]);
        for (node, &radius_m) in nodes.zip(&young.radii) {
            young_radii[node] = Some(radius_m);
        }
        drop(young);
        let mut new = vec![NO_PARENT; there.len()];
        let kept: Vec<usize> = (0..there.len()).filter(|&node| there[node]).collect();
        for (index, &node) in (0..).zip(&kept) {
            new[node] = index;
        }
        let renamed = |node: u32| if node == NO_PARENT { NO_PARENT } else { new[node as usize] };
        let radius = |&node: &usize| {
            let then = young_radii[self.nodes[node] as usize];
            then.map_or(skeleton.radii[node], |then| then * self.factors[node])
        };
        let mut tree = Skeleton {
            positions: kept.iter().map(|&node| skeleton.positions[node]).collect(),
            parents: kept.iter().map(|&node| renamed(skeleton.parents[node])).collect(),
            radii: kept.iter().map(radius).collect(),
            births: kept.iter().map(|&node| skeleton.births[node]).collect(),
            axes: Vec::new(),
            axis_nodes: Vec::with_capacity(kept.len()),
            width_steps: skeleton.width_steps,
            marks: Marks { tips: skeleton.marks.tips, ..Marks::default() },
            fits: Vec::new(),
            trees: skeleton.trees_of_feet(|foot| there[foot]),
        };
        let mut origins = Self {
            nodes: kept.iter().map(|&node| self.nodes[node]).collect(),
            factors: kept.iter().map(|&node| self.factors[node]).collect(),
            axes: Vec::new(),
        };
        let cuts = &skeleton.marks.cuts;
        tree.marks.cuts = cuts.iter().filter(|&&cut| there[cut as usize]).map(|&cut| renamed(cut)).collect();
        for (index, axis) in skeleton.axes.iter().enumerate() {
            let first = tree.axis_nodes.len() as u32;
            let nodes = skeleton.nodes_of(axis).iter().filter(|&&node| there[node as usize]);
            tree.axis_nodes.extend(nodes.map(|&node| renamed(node)));
            let len = tree.axis_nodes.len() as u32 - first;
            if len > 0 {
                tree.axes.push(Axis { order: axis.order, parent: renamed(axis.parent), first, len });
                tree.marks.numbers.push(skeleton.axis_number(index));
                origins.axes.push(self.axes[index].clone());
            }
        }
        (tree, origins)
    }

    /// Those of a tree at a step, of which nothing was edited.
    pub fn of_young(grown: &Skeleton, young: &Skeleton, step: u32) -> Self {
        let there = grown.born_by(step);
        let nodes: Vec<u32> = (0..there.len() as u32).filter(|&node| there[node as usize]).collect();
        let axis_of = grown.axis_of_nodes();
        let from = |axis: &Axis| {
            let base = young.nodes_of(axis).first().map_or(0, |&base| nodes[base as usize]);
            AxisOrigin::Grown(axis_of[base as usize])
        };
        let axes = young.axes.iter().map(from).collect();
        Self { factors: vec![1.0; nodes.len()], nodes, axes }
    }
}
