//! The tree as it was at an earlier step.

use glam::Vec3;

use super::radii::{self, Built};
use super::{Edge, Marks, NO_PARENT, Skeleton, Wood};
use linden_base::random::Key;

impl Skeleton {
    /// Which nodes were there at a step: born by then, and so were all nodes below them. (Births
    /// need not rise along an axis: the oldest segments of `A -> AF` are at its top.)
    pub fn born_by(&self, step: u32) -> Vec<bool> {
        let mut there = vec![false; self.parents.len()];
        for (node, (&parent, &birth)) in self.parents.iter().zip(&self.births).enumerate() {
            there[node] = birth <= step && (parent == NO_PARENT || there[parent as usize]);
        }
        there
    }

    /// The tree at a step: the nodes of [`Skeleton::born_by`], in their order, with the axes that they
    /// form and radii by the same rule.
    ///
    /// `wood` and `key` must be what the whole tree was built with, [`Wood::settled`]. By the pipe
    /// model a twig of the young tree is as thick as one of the whole tree, so the trunk thickens as
    /// the tree grows; where no tip radius is given, the one that follows for the whole tree is
    /// kept. By order and taper the foot is as thick as the tree has reached of its height; what was
    /// drawn for an axis holds from its first node on. Where radii were given, the wood's area goes with
    /// the tips that it bears. The result may be a foot without a segment, or nothing at all.
    ///
    /// ```
    /// use linden_base::random::Key;
    /// use glam::Vec3;
    /// use linden_skeleton::{Branching, NO_PARENT, Skeleton, Wood};
    /// let wood = Wood { base_radius_m: Some(0.2), ..Wood::default() };
    /// let fork = Branching {
    ///     positions: vec![Vec3::ZERO, Vec3::Y, Vec3::Y * 2.0, Vec3::X + Vec3::Y],
    ///     parents: vec![NO_PARENT, 0, 1, 1],
    ///     births: vec![0, 1, 2, 2],
    ///     radii: None,
    ///     edges: None,
    /// };
    /// let tree = Skeleton::build(fork, &wood)?;
    /// let young = tree.until(1, &wood, Key::new(0));
    /// assert_eq!(young.positions.len(), 2);
    /// assert_eq!(young.radii[0], tree.radii[2]); // one tip
    /// # Ok::<(), linden_skeleton::SkeletonError>(())
    /// ```
    #[must_use]
    pub fn until(&self, step: u32, wood: &Wood, key: Key) -> Self {
        let there = self.born_by(step);
        let nodes: Vec<u32> = (0..there.len() as u32).filter(|&node| there[node as usize]).collect();
        if nodes.len() == there.len() {
            return self.clone();
        }
        let mut index = vec![NO_PARENT; there.len()];
        for (new, &old) in nodes.iter().enumerate() {
            index[old as usize] = new as u32;
        }
        let positions: Vec<Vec3> = nodes.iter().map(|&old| self.positions[old as usize]).collect();
        let births = nodes.iter().map(|&old| self.births[old as usize]).collect();
        let parent = |&old: &u32| match self.parents[old as usize] {
            NO_PARENT => NO_PARENT,
            parent => index[parent as usize],
        };
        let parents: Vec<u32> = nodes.iter().map(parent).collect();
        let Built { axes, axis_nodes, radii } =
            radii::build_young(self, &nodes, &positions, &parents, wood, key);
        let (width_steps, marks) = (self.width_steps, Marks::default());
        let (fits, trees) = (Vec::new(), self.trees_of_feet(|foot| there[foot]));
        Self { positions, parents, radii, births, axes, axis_nodes, width_steps, marks, fits, trees }
    }

    /// How each of some nodes is joined to its parent.
    pub(super) fn edges_of(&self, nodes: &[u32]) -> Vec<Edge> {
        let mut edges = vec![Edge::Succeeds; self.parents.len()];
        for axis in self.axes.iter().filter(|axis| axis.parent != NO_PARENT) {
            edges[self.axis_nodes[axis.first as usize] as usize] = Edge::Branches;
        }
        nodes.iter().map(|&node| edges[node as usize]).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Branching;

    const KEY: Key = Key::new(0);

    /// Stems that branch at random; births rise from parent to child, or are drawn freely.
    fn branching(seed: u64, births_rise: bool) -> Branching {
        let key = Key::new(seed);
        let mut all = Branching::default();
        for i in 0..400_u32 {
            let k = key.child(u64::from(i));
            let is_foot = i == 0 || k.child(9).unit() < 0.01;
            let parent = (k.child(0).unit() * f64::from(i)) as u32;
            let free = (k.child(1).unit() * 12.0) as u32;
            let step = Vec3::from([2, 3, 4].map(|n| k.child(n).unit() as f32 - 0.3));
            let (at, birth) = if is_foot {
                (step, 0)
            } else {
                let below = all.births[parent as usize];
                (all.positions[parent as usize] + step, if births_rise { below + 1 } else { free })
            };
            all.positions.push(at);
            all.parents.push(if is_foot { NO_PARENT } else { parent });
            all.births.push(birth);
        }
        all
    }

    /// By the definition: a node is there when it and all below it are born.
    fn filtered(all: &Branching, step: u32) -> Branching {
        let is_there = |mut node: u32| loop {
            if all.births[node as usize] > step {
                return false;
            }
            node = all.parents[node as usize];
            if node == NO_PARENT {
                return true;
            }
        };
        let there: Vec<u32> = (0..all.parents.len() as u32).filter(|&node| is_there(node)).collect();
        let new = |old: u32| there.iter().position(|&node| node == old).map_or(NO_PARENT, |at| at as u32);
        Branching {
            positions: there.iter().map(|&n| all.positions[n as usize]).collect(),
            parents: there.iter().map(|&n| new(all.parents[n as usize])).collect(),
            births: there.iter().map(|&n| all.births[n as usize]).collect(),
            radii: None,
            edges: None,
        }
    }

    #[test]
    fn a_young_tree_is_what_its_branching_builds() {
        for seed in 0..6 {
            for births_rise in [true, false] {
                let all = branching(seed, births_rise);
                let wood = Wood { radius_exponent: 2.3, tip_radius_m: Some(0.01), ..Wood::default() };
                let tree = Skeleton::build(all.clone(), &wood).unwrap();
                for step in [1, 2, 4, 7, 11, 100] {
                    let young = tree.until(step, &wood, KEY);
                    match Skeleton::build(filtered(&all, step), &wood) {
                        Ok(expected) => assert_eq!(young, expected, "seed {seed} step {step}"),
                        Err(_) => assert_eq!(young.segments(), 0, "seed {seed} step {step}"),
                    }
                }
            }
        }
    }

    #[test]
    fn twigs_are_as_thick_as_the_whole_trees() {
        let all = branching(3, true);
        for wood in [Wood::default(), Wood { base_radius_m: Some(0.3), ..Wood::default() }] {
            let tree = Skeleton::build(all.clone(), &wood).unwrap();
            let tip = |tree: &Skeleton| tree.radii.iter().copied().fold(f32::INFINITY, f32::min);
            // What follows for the whole tree is what is given for the young one.
            let given = Wood { tip_radius_m: Some(f64::from(tip(&tree))), base_radius_m: None, ..wood };
            let young = tree.until(3, &wood, KEY);
            let expected = Skeleton::build(filtered(&all, 3), &given).unwrap();
            assert_eq!(young.axes, expected.axes);
            for (a, b) in young.radii.iter().zip(&expected.radii) {
                assert!((a / b - 1.0).abs() < 1e-6, "{a} {b}");
            }
            let thickest = |tree: &Skeleton| tree.radii.iter().copied().fold(0.0, f32::max);
            assert!(thickest(&young) < thickest(&tree));
        }
    }

    #[test]
    fn before_and_after_everything() {
        let mut all = branching(1, true);
        for birth in &mut all.births {
            *birth += 1;
        }
        let tree = Skeleton::build(all, &Wood::default()).unwrap();
        assert_eq!(tree.until(0, &Wood::default(), KEY), Skeleton::default());
        let feet = tree.until(1, &Wood::default(), KEY);
        assert!(!feet.positions.is_empty() && feet.segments() == 0);
        assert_eq!(tree.until(u32::MAX, &Wood::default(), KEY), tree);
    }
}
