//! Twigs on the cards of bare trees: what is thinner than a pixel would be a row of dots, and as wide as one it would be denser
//! than it is. So there are fewer.

use std::collections::HashMap;

use linden_skeleton::Skeleton;

/// Which axes bear which.
pub(super) struct Laterals {
    /// The axis of each node.
    axis_of: Vec<u32>,
    /// The mean radius of an axis by the node that it begins with, metres.
    radius_m: HashMap<usize, f32>,
}

impl Laterals {
    pub fn of(skeleton: &Skeleton) -> Self {
        let mut axis_of = vec![0; skeleton.positions.len()];
        let mut radius_m = HashMap::new();
        for (number, axis) in (0..).zip(&skeleton.axes) {
            let nodes = skeleton.nodes_of(axis);
            for &node in nodes {
                axis_of[node as usize] = number;
            }
            let sum: f32 = nodes.iter().map(|&node| skeleton.radii[node as usize]).sum();
            if let Some(&first) = nodes.first() {
                radius_m.insert(first as usize, sum / nodes.len() as f32);
            }
        }
        Self { axis_of, radius_m }
    }

    /// Of the nodes of a piece those that are shown where nothing is thinner: of twigs half as wide every other one that an
    /// axis bears, so that they cover as much. What a twig bears that is left out is left out, too.
    pub fn thinned_out(
        &self,
        skeleton: &Skeleton,
        piece: impl Iterator<Item = usize>,
        thinnest_m: f32,
    ) -> Vec<usize> {
        /// Where counting begins on an axis, so that not all of them leave out their first twig.
        const STRIDE: f32 = 0.618_034;
        // How many of all such twigs are shown, and whether this one is.
        let mut found: HashMap<usize, (f32, bool)> = HashMap::new();
        let mut counts: HashMap<u32, f32> = HashMap::new();
        let mut shown = Vec::new();
        for node in piece {
            let parent = skeleton.parents[node] as usize;
            let below = found.get(&parent).copied();
            let mut share = below.unwrap_or((1.0, true));
            if let (Some((most, true)), Some(radius_m)) = (below, self.radius_m.get(&node)) {
                let wanted = (radius_m / thinnest_m).min(most);
                let bearer = self.axis_of[parent];
                let count = counts.entry(bearer).or_insert_with(|| (bearer as f32 * STRIDE).fract());
                *count += wanted / most;
                let is_shown = *count >= 1.0;
                *count -= f32::from(u8::from(is_shown));
                share = (wanted, is_shown);
            }
            found.insert(node, share);
            if share.1 {
                shown.push(node);
            }
        }
        shown
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::Subject;

    #[test]
    fn fewer_and_wider_twigs_cover_as_much_and_hang_together() {
        let skeleton = Subject::builtin("silver-birch", &[]).grow().skeleton;
        let laterals = Laterals::of(&skeleton);
        let lateral = |node: usize| skeleton.parents[node] as usize;
        let nodes = || (1..skeleton.positions.len()).filter(|&node| lateral(node) < skeleton.positions.len());
        let area = |nodes: &mut dyn Iterator<Item = usize>, thinnest_m: f32| -> f64 {
            let area = |node: usize| {
                let length_m = skeleton.positions[node].distance(skeleton.positions[lateral(node)]);
                f64::from(length_m * skeleton.radii[node].max(thinnest_m))
            };
            nodes.map(area).sum()
        };
        for thinnest_m in [0.004, 0.008, 0.016] {
            let shown = laterals.thinned_out(&skeleton, 0..skeleton.positions.len(), thinnest_m);
            assert!(shown.is_sorted() && shown.len() > 100, "{thinnest_m}: {}", shown.len());
            let mut is_shown = vec![false; skeleton.positions.len()];
            for &node in &shown {
                is_shown[node] = true;
            }
            assert!(nodes().filter(|node| is_shown[*node]).all(|node| is_shown[lateral(node)]));
            let [all, found] =
                [area(&mut nodes(), 0.0), area(&mut nodes().filter(|node| is_shown[*node]), thinnest_m)];
            let wide = area(&mut nodes(), thinnest_m);
            assert!((found / all - 1.0).abs() < 0.25, "{thinnest_m}: {found} of {all}");
            assert!(wide > 1.2 * found, "{thinnest_m}: all of them would cover {wide}");
        }
    }
}
