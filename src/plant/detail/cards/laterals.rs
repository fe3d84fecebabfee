//! Twigs on the cards of bare trees. Thinner than a pixel they are rows of dots; all of them as wide as a pixel are denser than
//! they are. So fewer are shown, as wide.

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
    /// axis bears, and fewer yet where the axes that the piece hangs on are widened as well, so that all cover as much. What a
    /// twig bears that is left out is left out, too.
    pub fn thinned_out(
        &self,
        skeleton: &Skeleton,
        piece: impl Iterator<Item = usize>,
        thinnest_m: f32,
    ) -> Vec<usize> {
        /// Where counting begins on an axis, so that not all of them leave out their first twig.
        const STRIDE: f32 = 0.618_034;
        let nodes: Vec<usize> = piece.collect();
        let room = self.room(skeleton, &nodes, thinnest_m);
        // How many of all such twigs are shown, and whether this one is.
        let mut found: HashMap<usize, (f32, bool)> = HashMap::new();
        let mut counts: HashMap<u32, f32> = HashMap::new();
        let mut shown = Vec::new();
        for node in nodes {
            let parent = skeleton.parents[node] as usize;
            let below = found.get(&parent).copied();
            let mut share = below.unwrap_or((1.0, true));
            if let (Some((most, true)), Some(radius_m)) = (below, self.radius_m.get(&node)) {
                let wanted = (room * radius_m / thinnest_m).min(most);
                let bearer = self.axis_of[parent];
                let count = counts.entry(bearer).or_insert_with(|| (bearer as f32 * STRIDE).fract());
                *count += wanted / most.max(f32::MIN_POSITIVE);
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

    /// The share of what the laterals of a piece cover that is left for them beside the axes that it hangs on, where these are
    /// as wide as anything.
    fn room(&self, skeleton: &Skeleton, nodes: &[usize], thinnest_m: f32) -> f32 {
        // Whether a lateral that is borne within the piece bears a node.
        let mut is_lateral: HashMap<usize, bool> = HashMap::new();
        let (mut laterals_m2, mut excess_m2) = (0.0, 0.0);
        for &node in nodes {
            let parent = skeleton.parents[node] as usize;
            let below = is_lateral.get(&parent).copied();
            let is_borne = below.is_some_and(|below| below || self.radius_m.contains_key(&node));
            is_lateral.insert(node, is_borne);
            let Some(&from) = skeleton.positions.get(parent) else { continue };
            let (length_m, radius_m) = (from.distance(skeleton.positions[node]), skeleton.radii[node]);
            if is_borne {
                laterals_m2 += length_m * radius_m;
            } else {
                excess_m2 += length_m * (thinnest_m - radius_m).max(0.0);
            }
        }
        if laterals_m2 > 0.0 { (1.0 - excess_m2 / laterals_m2).max(0.0) } else { 0.0 }
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
        let below = |node: usize| skeleton.parents[node] as usize;
        let nodes = || (1..skeleton.positions.len()).filter(|&node| below(node) < skeleton.positions.len());
        let area = |nodes: &mut dyn Iterator<Item = usize>, thinnest_m: f32| -> f64 {
            let area = |node: usize| {
                let length_m = skeleton.positions[node].distance(skeleton.positions[below(node)]);
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
            assert!(nodes().filter(|node| is_shown[*node]).all(|node| is_shown[below(node)]));
            let [all, found] =
                [area(&mut nodes(), 0.0), area(&mut nodes().filter(|node| is_shown[*node]), thinnest_m)];
            let wide = area(&mut nodes(), thinnest_m);
            assert!((found / all - 1.0).abs() < 0.25, "{thinnest_m}: {found} of {all}");
            assert!(wide > 1.2 * found, "{thinnest_m}: all of them would cover {wide}");
        }
    }

    #[test]
    fn what_a_piece_hangs_on_takes_room_from_its_laterals() {
        let skeleton = Subject::builtin("silver-birch", &[]).grow().skeleton;
        let laterals = Laterals::of(&skeleton);
        let all: Vec<usize> = (0..skeleton.positions.len()).collect();
        // A trunk is thicker than any pixel, but for its tip.
        assert!(laterals.room(&skeleton, &all, 0.002) > 0.999);
        // Of a limb with its twigs the limb itself is widened, and by more than they cover if a pixel is wide.
        let limb = skeleton.axes.iter().filter(|axis| axis.order == 1).max_by_key(|axis| axis.len).unwrap();
        let mut is_below = vec![false; all.len()];
        for &node in skeleton.nodes_of(limb) {
            is_below[node as usize] = true;
        }
        for node in 0..all.len() {
            is_below[node] |= is_below.get(skeleton.parents[node] as usize).copied().unwrap_or(false);
        }
        let piece: Vec<usize> = all.into_iter().filter(|node| is_below[*node]).collect();
        let rooms = [0.002, 0.01, 0.02, 0.5].map(|thinnest_m| laterals.room(&skeleton, &piece, thinnest_m));
        assert!(rooms.is_sorted_by(|a, b| a >= b) && rooms[0] > 0.9, "{rooms:?}");
        assert_eq!(rooms[3], 0.0);
        // Its axis stays.
        let shown = laterals.thinned_out(&skeleton, piece.into_iter(), 0.5);
        assert_eq!(shown.len(), limb.len as usize);
    }
}
