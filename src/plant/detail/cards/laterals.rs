//! Twigs on the cards of bare trees. Thinner than a pixel they are rows of dots; all of them as wide as a pixel are denser than
//! they are. So fewer are shown, as wide.

use std::collections::HashMap;

use linden_skeleton::Skeleton;

/// Where the axes that a piece hangs on cover too much, its twigs are drawn narrower, down to this share of their width.
const LEAST_WIDTH: f32 = 0.6;

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

    /// Of the nodes of a piece those that are shown where nothing is thinner, and how thin that is: fewer twigs, so that all
    /// cover `share` of what the nodes do that are drawn. Where the axes that the piece hangs on cover more by themselves,
    /// all of it is narrower, down to [`LEAST_WIDTH`].
    pub fn thinned_out(
        &self,
        skeleton: &Skeleton,
        piece: impl Iterator<Item = usize>,
        is_drawn: impl Fn(usize) -> bool,
        thinnest_m: f32,
        share: f32,
    ) -> (Vec<usize>, f32) {
        /// Rooms between which the right one is looked for: more than 1 where cards are to show more than there is.
        const MOST_ROOM: f32 = 4.0;
        const HALVINGS: u32 = 10;
        let nodes: Vec<usize> = piece.collect();
        let area_m2 = |nodes: &[usize], thinnest_m: f32| -> f32 {
            let drawn = nodes.iter().copied().filter(|node| is_drawn(*node));
            drawn
                .map(|node| skeleton.segment_length(node) as f32 * skeleton.radii[node].max(thinnest_m))
                .sum()
        };
        let wanted_m2 = share * area_m2(&nodes, 0.0);
        let (mut low, mut high) = (0.0, MOST_ROOM);
        let mut shown = self.with_room(skeleton, &nodes, thinnest_m, low);
        let mut found_m2 = area_m2(&shown, thinnest_m);
        for _ in 0..HALVINGS {
            let room = f32::midpoint(low, high);
            let more = self.with_room(skeleton, &nodes, thinnest_m, room);
            let more_m2 = area_m2(&more, thinnest_m);
            if (more_m2 - wanted_m2).abs() < (found_m2 - wanted_m2).abs() {
                (shown, found_m2) = (more, more_m2);
            }
            if more_m2 < wanted_m2 {
                low = room;
            } else {
                high = room;
            }
        }
        let narrower = (wanted_m2 / found_m2.max(f32::MIN_POSITIVE)).clamp(LEAST_WIDTH, 1.0);
        (shown, narrower * thinnest_m)
    }

    /// Those that are shown where laterals have so much room: with 1, of twigs half as wide as anything every other one that
    /// an axis bears. What a twig bears that is left out is left out, too.
    fn with_room(&self, skeleton: &Skeleton, nodes: &[usize], thinnest_m: f32, room: f32) -> Vec<usize> {
        /// Where counting begins on an axis, so that not all of them leave out their first twig.
        const STRIDE: f32 = 0.618_034;
        // How many of all such twigs are shown, and whether this one is.
        let mut found: HashMap<usize, (f32, bool)> = HashMap::new();
        let mut counts: HashMap<u32, f32> = HashMap::new();
        let mut shown = Vec::new();
        for &node in nodes {
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
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::Subject;

    fn area_m2(skeleton: &Skeleton, nodes: impl IntoIterator<Item = usize>, thinnest_m: f32) -> f32 {
        nodes
            .into_iter()
            .map(|node| skeleton.segment_length(node) as f32 * skeleton.radii[node].max(thinnest_m))
            .sum()
    }

    #[test]
    fn fewer_and_wider_twigs_cover_as_much_and_hang_together() {
        let skeleton = Subject::builtin("silver-birch", &[]).grow().skeleton;
        let laterals = Laterals::of(&skeleton);
        let all = || 0..skeleton.positions.len();
        let whole_m2 = area_m2(&skeleton, all(), 0.0);
        for (thinnest_m, share) in [(0.004, 1.0), (0.008, 1.0), (0.016, 1.0), (0.016, 0.8)] {
            let (shown, width_m) = laterals.thinned_out(&skeleton, all(), |_| true, thinnest_m, share);
            assert!(shown.is_sorted() && shown.len() > 100, "{thinnest_m}: {}", shown.len());
            let mut is_shown = vec![false; skeleton.positions.len()];
            for &node in &shown {
                is_shown[node] = true;
            }
            let hangs =
                |node: usize| is_shown.get(skeleton.parents[node] as usize).is_none_or(|below| *below);
            assert!(shown.iter().all(|node| hangs(*node)));
            let found_m2 = area_m2(&skeleton, shown, width_m);
            assert!(
                (found_m2 / whole_m2 / share - 1.0).abs() < 0.03,
                "{thinnest_m}: {found_m2} of {whole_m2}"
            );
            let wide_m2 = area_m2(&skeleton, all(), thinnest_m);
            assert!(wide_m2 > 1.2 * found_m2, "{thinnest_m}: all of them would cover {wide_m2}");
        }
    }

    #[test]
    fn what_a_piece_hangs_on_takes_room_from_its_laterals_and_is_narrower_where_there_is_none() {
        let skeleton = Subject::builtin("silver-birch", &[]).grow().skeleton;
        let laterals = Laterals::of(&skeleton);
        let limb = skeleton.axes.iter().filter(|axis| axis.order == 1).max_by_key(|axis| axis.len).unwrap();
        let mut is_below = vec![false; skeleton.positions.len()];
        for &node in skeleton.nodes_of(limb) {
            is_below[node as usize] = true;
        }
        for node in 0..is_below.len() {
            is_below[node] |= is_below.get(skeleton.parents[node] as usize).copied().unwrap_or(false);
        }
        let piece = || (0..is_below.len()).filter(|node| is_below[*node]);
        let of = |thinnest_m: f32, share: f32| {
            laterals.thinned_out(&skeleton, piece(), |_| true, thinnest_m, share)
        };
        let counts = [0.002, 0.01, 0.02, 0.5].map(|thinnest_m| of(thinnest_m, 1.0).0.len());
        assert!(counts.is_sorted_by(|a, b| a >= b) && counts[0] > counts[2], "{counts:?}");
        // Its axis stays.
        assert_eq!(counts[3], limb.len as usize);
        assert_eq!(of(0.5, 1.0).1, LEAST_WIDTH * 0.5);
        assert!(of(0.01, 0.7).0.len() < of(0.01, 1.0).0.len());
        // What is not drawn takes none.
        let is_twig = |node: usize| !skeleton.nodes_of(limb).contains(&(node as u32));
        let (shown, width_m) = laterals.thinned_out(&skeleton, piece(), is_twig, 0.02, 1.0);
        let [found_m2, whole_m2] = [(shown, width_m), (piece().collect(), 0.0)].map(|(nodes, width_m)| {
            area_m2(&skeleton, nodes.into_iter().filter(|node| is_twig(*node)), width_m)
        });
        assert!((found_m2 / whole_m2 - 1.0).abs() < 0.1, "{found_m2} of {whole_m2}");
    }
}
