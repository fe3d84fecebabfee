//! How much of what is seen of a tree is wood, and how much is leaves.

use super::Detail;
use super::cards::organ_rods;
use super::exposure::COVERED;
use super::forms::LevelForms;
use super::wood::Wood;
use linden_skeleton::Skeleton;
use linden_skeleton::organs::Organs;

/// What a tree covers to who looks at it from the side, square metres, hidden or not.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Silhouette {
    pub leaves_m2: f64,
    pub wood_m2: f64,
}

impl Silhouette {
    /// Of a tree with these organs, in any season.
    pub fn of(skeleton: &Skeleton, organs: &Organs) -> Self {
        let forms = LevelForms::plain(organs);
        let squares_m2: f64 = organ_rods(organs, &forms).map(|rod| f64::from(rod.weight)).sum();
        Self {
            leaves_m2: f64::from(COVERED) * squares_m2,
            wood_m2: (0..skeleton.positions.len()).map(|node| silhouette_m2(skeleton, node)).sum(),
        }
    }

    /// Whether it is bare, or nearly: more is seen of the wood than of leaves and fruit.
    pub fn is_mostly_wood(&self) -> bool {
        self.wood_m2 > self.leaves_m2
    }

    /// The share of it that is left where wood is left out, and leaves or what stands for them are not.
    pub fn share_with(&self, wood: &Wood<'_>, detail: &Detail) -> f64 {
        let left_out = wood.thin_nodes(detail).into_iter().enumerate().filter(|(_, is_thin)| *is_thin);
        let lost_m2: f64 = left_out.map(|(node, _)| silhouette_m2(wood.skeleton(), node)).sum();
        1.0 - lost_m2 / (self.leaves_m2 + self.wood_m2).max(f64::MIN_POSITIVE)
    }
}

/// Of the wood between a node and the one below it, seen from the side.
fn silhouette_m2(skeleton: &Skeleton, node: usize) -> f64 {
    2.0 * f64::from(skeleton.radii[node]) * skeleton.segment_length(node)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::detail::exposure::Exposure;
    use crate::surface::Tubes;
    use crate::testing::Subject;
    use linden_base::monitor::Quiet;

    #[test]
    fn a_tree_is_mostly_wood_when_few_leaves_are_left() {
        let silhouette = |season: &str| {
            let grown = Subject::builtin("hazel", &[("season", season)]).grow();
            Silhouette::of(&grown.skeleton, &grown.organs)
        };
        let [summer, late, bare] = ["0.35", "0.995", "1"].map(silhouette);
        assert!(!summer.is_mostly_wood() && late.is_mostly_wood() && bare.is_mostly_wood());
        assert!(late.leaves_m2 > 0.0 && bare.leaves_m2 == 0.0 && bare.wood_m2 == summer.wood_m2);
    }

    #[test]
    fn what_is_left_out_is_missed_less_beside_leaves() {
        let shares = |season: &str| {
            let grown = Subject::builtin("hazel", &[("season", season)]).grow();
            let silhouette = Silhouette::of(&grown.skeleton, &grown.organs);
            let wood = Wood::new(&grown.skeleton, &Exposure::default(), &Quiet).unwrap();
            [0.0, 0.002, 0.004, 0.02].map(|smallest_radius_m| {
                let detail = Detail { smallest_radius_m, ..Detail::full(&Tubes::default()) };
                silhouette.share_with(&wood, &detail)
            })
        };
        let (summer, bare) = (shares("0.35"), shares("1"));
        assert_eq!((summer[0], bare[0]), (1.0, 1.0));
        assert!(bare.is_sorted_by(|a, b| a > b) && bare[3] < 0.3, "{bare:?}");
        assert!(summer.iter().zip(&bare).skip(1).all(|(summer, bare)| summer > bare), "{summer:?} {bare:?}");
    }
}
