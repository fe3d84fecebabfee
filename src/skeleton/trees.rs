//! The trees of a skeleton: most skeletons are one tree, whatever the number of its stems; a stand is several.
//!
//! A generator of several trees says so ([`Skeleton::trees`]): feet alone do not tell a stool of many stems from a stand.

use std::collections::BTreeMap;

use linden_base::memory::bytes_of;

use super::{Axis, NO_PARENT, Skeleton};

/// Where the nodes and axes of a skeleton of several trees are in [`Skeleton::split`].
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TreeIndex {
    /// How many trees there are: two or more.
    pub count: usize,
    /// Of each node its tree, from 0, and its number among the nodes of that.
    pub nodes: Vec<[u32; 2]>,
    /// Of each axis its tree, from 0, and its number among the axes of that.
    pub axes: Vec<[u32; 2]>,
}

impl Skeleton {
    /// The trees of its nodes and axes, numbered in the order of their first feet; `None` where all are one tree.
    ///
    /// ```
    /// use glam::Vec3;
    /// use linden_skeleton::{Branching, NO_PARENT, Skeleton};
    /// let feet = Branching {
    ///     positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::X + Vec3::Y],
    ///     parents: vec![NO_PARENT, NO_PARENT, 0, 1],
    ///     births: vec![0, 0, 1, 1],
    ///     radii: None,
    ///     edges: None,
    /// };
    /// let mut skeleton = Skeleton::build(feet, &Default::default())?;
    /// assert_eq!(skeleton.tree_index(), None); // two stems of a stool
    /// skeleton.trees = vec![0, 1];
    /// let index = skeleton.tree_index().unwrap();
    /// assert_eq!((index.count, index.nodes[3]), (2, [1, 1]));
    /// # Ok::<(), linden_skeleton::SkeletonError>(())
    /// ```
    pub fn tree_index(&self) -> Option<TreeIndex> {
        let first = self.trees.first()?;
        if self.trees.iter().all(|tree| tree == first) {
            return None;
        }
        let mut names: BTreeMap<u32, u32> = BTreeMap::new();
        let mut sizes: Vec<[u32; 2]> = Vec::new();
        let mut labels = self.trees.iter();
        let mut nodes: Vec<[u32; 2]> = Vec::with_capacity(self.parents.len());
        for &parent in &self.parents {
            let tree = if parent == NO_PARENT {
                let next = names.len() as u32;
                // Feet that nothing is said of are the first tree's.
                *names.entry(*labels.next().unwrap_or(first)).or_insert(next)
            } else {
                nodes[parent as usize][0]
            };
            if tree as usize == sizes.len() {
                sizes.push([0; 2]);
            }
            let [size, _] = &mut sizes[tree as usize];
            nodes.push([tree, *size]);
            *size += 1;
        }
        let number = |axis: &Axis| {
            let tree = self.nodes_of(axis).first().map_or(0, |&base| nodes[base as usize][0]);
            let [_, size] = &mut sizes[tree as usize];
            *size += 1;
            [tree, *size - 1]
        };
        let axes = self.axes.iter().map(number).collect();
        Some(TreeIndex { count: names.len(), nodes, axes })
    }

    /// Each tree as a skeleton for itself: with its nodes and axes in their order, and without marks of editing.
    #[must_use]
    pub fn split(&self, index: &TreeIndex) -> Vec<Self> {
        let mut trees: Vec<Self> = Vec::new();
        trees.resize_with(index.count, || Self { width_steps: self.width_steps, ..Self::default() });
        for (node, &[tree, _]) in index.nodes.iter().enumerate() {
            let (of, parent) = (&mut trees[tree as usize], self.parents[node]);
            of.positions.push(self.positions[node]);
            of.parents.push(if parent == NO_PARENT { NO_PARENT } else { index.nodes[parent as usize][1] });
            of.radii.push(self.radii[node]);
            of.births.push(self.births[node]);
            of.fits.extend(self.fits.get(node));
        }
        for (axis, &[tree, _]) in self.axes.iter().zip(&index.axes) {
            let of = &mut trees[tree as usize];
            let first = of.axis_nodes.len() as u32;
            of.axis_nodes.extend(self.nodes_of(axis).iter().map(|&node| index.nodes[node as usize][1]));
            let parent =
                if axis.parent == NO_PARENT { NO_PARENT } else { index.nodes[axis.parent as usize][1] };
            of.axes.push(Axis { parent, first, ..*axis });
        }
        trees
    }

    /// Bytes that [`Skeleton::tree_index`] and [`Skeleton::split`] give and take; 0 where all are one tree.
    pub fn split_bytes(&self) -> u64 {
        let is_one = self.trees.first().is_none_or(|first| self.trees.iter().all(|tree| tree == first));
        if is_one {
            return 0;
        }
        // Lists that grow are reserved twice as long.
        2 * self.bytes() + bytes_of::<[u32; 2]>(self.parents.len() + self.axes.len())
    }

    /// The tree of each foot that stays, in their order, where `stays` says it of each node.
    pub fn trees_of_feet(&self, mut stays: impl FnMut(usize) -> bool) -> Vec<u32> {
        let feet = (0..self.parents.len()).filter(|&node| self.parents[node] == NO_PARENT);
        feet.zip(&self.trees).filter(|(foot, _)| stays(*foot)).map(|(_, &tree)| tree).collect()
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;
    use linden_base::random::Key;

    use super::*;
    use crate::{Branching, Wood};

    /// Stems that branch at random, and the tree of each foot.
    fn stand(seed: u64) -> Skeleton {
        let key = Key::new(seed);
        let mut all = Branching::default();
        let mut trees = Vec::new();
        for i in 0..300_u32 {
            let key = key.child(i.into());
            let is_foot = i < 3 || key.named("foot").unit() < 0.02;
            if is_foot {
                trees.push(7 - (key.named("tree").unit() * 5.0) as u32);
            }
            let parent = (key.named("parent").unit() * f64::from(i)) as u32;
            let step = Vec3::from(["x", "y", "z"].map(|name| key.named(name).unit() as f32));
            let below = if is_foot { Vec3::ZERO } else { all.positions[parent as usize] };
            all.positions.push(below + step);
            all.parents.push(if is_foot { NO_PARENT } else { parent });
            all.births.push(i);
        }
        Skeleton { trees, ..Skeleton::build(all, &Wood::default()).unwrap() }
    }

    #[test]
    fn trees_are_numbered_by_their_first_feet_and_hold_all_that_grows_on_them() {
        for seed in 0..20 {
            let whole = stand(seed);
            let Some(index) = whole.tree_index() else { continue };
            let mut seen: Vec<u32> = Vec::new();
            for &tree in &whole.trees {
                if !seen.contains(&tree) {
                    seen.push(tree);
                }
            }
            let mut feet = whole.trees.iter();
            let trees = whole.split(&index);
            assert_eq!((index.count, trees.len()), (seen.len(), seen.len()), "seed {seed}");
            for (node, &[tree, number]) in index.nodes.iter().enumerate() {
                let (of, number) = (&trees[tree as usize], number as usize);
                // Births name nodes.
                assert_eq!(of.births[number], node as u32);
                assert_eq!(
                    (of.positions[number], of.radii[number]),
                    (whole.positions[node], whole.radii[node])
                );
                if whole.parents[node] == NO_PARENT {
                    assert_eq!(of.parents[number], NO_PARENT);
                    assert_eq!(seen[tree as usize], *feet.next().unwrap(), "seed {seed}");
                } else {
                    assert_eq!(of.births[of.parents[number] as usize], whole.parents[node]);
                }
            }
            for (axis, &[tree, number]) in whole.axes.iter().zip(&index.axes) {
                let of = &trees[tree as usize];
                let there = of.axes[number as usize];
                let births: Vec<u32> = of.nodes_of(&there).iter().map(|&n| of.births[n as usize]).collect();
                assert_eq!((births.as_slice(), there.order), (whole.nodes_of(axis), axis.order));
            }
            let volume =
                |tree: &Skeleton| tree.cylinders().iter().map(crate::Cylinder::volume_m3).sum::<f64>();
            let sum: f64 = trees.iter().map(volume).sum();
            assert!((sum / volume(&whole) - 1.0).abs() < 1e-9, "seed {seed}");
            assert!(trees.iter().map(Skeleton::bytes).sum::<u64>() <= whole.split_bytes());
        }
    }

    #[test]
    fn stems_of_which_nothing_is_said_are_one_tree() {
        let mut whole = stand(1);
        for trees in [Vec::new(), vec![4; whole.trees.len()]] {
            whole.trees = trees;
            assert_eq!((whole.tree_index(), whole.split_bytes()), (None, 0));
        }
    }

    #[test]
    fn a_young_stand_keeps_its_trees() {
        let whole = stand(2);
        let young = whole.until(120, &Wood::default(), Key::new(0));
        let feet = young.parents.iter().filter(|&&parent| parent == NO_PARENT).count();
        assert!(feet < whole.trees.len());
        assert_eq!(young.trees, whole.trees[..feet]);
    }
}
