//! What a forester would measure.

use std::collections::BTreeMap;

use super::{Axis, Forks, NO_PARENT, Skeleton, WidthSteps};
use glam::{DVec2, Vec3};
use linden_base::hull::HullPolygon;
use linden_base::mesh::Bounds;
use rayon::prelude::*;

/// Breast height, where trunks are measured by convention.
pub const BREAST_HEIGHT_M: f64 = 1.3;

/// Nodes whose hull is taken at once.
const NODES_PER_PIECE: usize = 1 << 13;

/// Lengths in metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measures {
    /// Sum of all segments.
    pub total_length_m: f64,
    /// Highest node above the lowest one.
    pub height_m: f64,
    /// Seen from above, the distance of two parallel lines that enclose all nodes, averaged over all directions.
    pub crown_width_m: f64,
    /// Of the thickest stem, [`Measures::trunk_diameter_at_m`] above its foot; of the skeleton, without a flare.
    pub trunk_diameter_m: f64,
    /// Where that is measured: 1.3 along the stem, 0 for a stem that is shorter.
    pub trunk_diameter_at_m: f64,
    /// Of the thickest stem at its foot.
    pub base_diameter_m: f64,
    /// Of all wood, segment by segment, cubic metres: [`super::Cylinder`]s, overlaps at forks counted twice.
    pub wood_volume_m3: f64,
    /// Highest axis order.
    pub max_order: u32,
}

impl Skeleton {
    /// Measures the tree.
    pub fn measures(&self) -> Measures {
        self.measures_by(&self.seen_from_above(), &Forks::new(self))
    }

    /// The same where what is [seen from above](Skeleton::seen_from_above) and the [`Forks`] are known.
    pub fn measures_by(&self, plan: &HullPolygon, forks: &Forks) -> Measures {
        let size = Bounds::of(self.positions.iter().copied()).map_or(Vec3::ZERO, Bounds::size);
        let (trunk_diameter_at_m, trunk_diameter_m) = self.trunk_diameter(forks);
        Measures {
            total_length_m: (0..self.parents.len()).map(|node| self.segment_length(node)).sum(),
            height_m: f64::from(size.y),
            crown_width_m: plan.mean_width(),
            trunk_diameter_m,
            trunk_diameter_at_m,
            base_diameter_m: self.base_diameter_m(),
            wood_volume_m3: self.wood_volume_m3(forks),
            max_order: self.axes.iter().map(|a| a.order).max().unwrap_or(0),
        }
    }

    /// The convex hull of all nodes, seen from above: X and Z.
    pub fn seen_from_above(&self) -> HullPolygon {
        // A piece at a time: a list of all nodes once more would have to be asked for.
        let pieces = self.positions.par_chunks(NODES_PER_PIECE).map(|nodes| {
            if let Some(ends) = ends_of_row(nodes) {
                return ends;
            }
            let plan: Vec<DVec2> = nodes.iter().map(|at| DVec2::new(at.x.into(), at.z.into())).collect();
            HullPolygon::of(&plan).corners
        });
        HullPolygon::of(&pieces.collect::<Vec<_>>().concat())
    }

    /// Whether all nodes have the same Z, as those of grammars that are drawn on paper.
    pub fn lies_in_a_plane(&self) -> bool {
        self.positions.par_windows(2).all(|pair| pair[0].z == pair[1].z)
    }

    /// Length of the segment that ends in a node, metres; 0 for the foot of a stem.
    ///
    /// # Panics
    /// Where the tree has no such node: `node` is below the length of [`Skeleton::positions`].
    pub fn segment_length(&self, node: usize) -> f64 {
        match self.parents[node] {
            NO_PARENT => 0.0,
            parent => f64::from(self.positions[node].distance(self.positions[parent as usize])),
        }
    }

    /// The stem that is thickest at its foot, and that foot's radius.
    fn thickest_stem(&self) -> Option<(u32, f64)> {
        let foot_radius = |axis: &Axis| {
            let nodes = self.nodes_of(axis);
            let steps = self.width_steps == WidthSteps::Cylinder;
            let node = nodes.get(1).filter(|_| steps).unwrap_or(&nodes[0]);
            f64::from(self.radii[*node as usize])
        };
        let stems = self.stems().map(|stem| (stem, foot_radius(&self.axes[stem as usize])));
        stems.max_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// Axes that nothing bears: indices into [`Skeleton::axes`].
    pub fn stems(&self) -> impl Iterator<Item = u32> {
        (0..).zip(&self.axes).filter(|(_, axis)| axis.parent == NO_PARENT).map(|(index, _)| index)
    }

    /// The stem that is thickest at its foot, and the axes that its wood runs on into, from the foot up: indices
    /// into [`Skeleton::axes`].
    pub fn trunk(&self) -> Vec<u32> {
        self.trunk_by(&Forks::new(self))
    }

    /// The same where the [`Forks`] are known.
    pub fn trunk_by(&self, forks: &Forks) -> Vec<u32> {
        let thickest = self.thickest_stem().map(|(stem, _)| stem);
        self.trunks_of(thickest, forks).pop().unwrap_or_default()
    }

    /// The same of these stems, in their order.
    fn trunks_of(&self, stems: impl IntoIterator<Item = u32>, forks: &Forks) -> Vec<Vec<u32>> {
        let mut trunks: Vec<Vec<u32>> = stems.into_iter().map(|stem| vec![stem]).collect();
        if forks.is_empty() {
            return trunks;
        }
        let apex = |axis: u32| self.nodes_of(&self.axes[axis as usize]).last().copied();
        let tops = trunks.iter().enumerate().filter_map(|(trunk, axes)| Some((apex(axes[0])?, trunk)));
        let mut tops: BTreeMap<u32, usize> = tops.collect();
        // Laterals come after what bears them.
        for (index, axis) in (0..).zip(&self.axes) {
            if let Some(&trunk) = tops.get(&axis.parent)
                && forks.runs_on(index)
            {
                tops.remove(&axis.parent);
                trunks[trunk].push(index);
                tops.extend(apex(index).map(|top| (top, trunk)));
            }
        }
        trunks
    }

    fn base_diameter_m(&self) -> f64 {
        self.thickest_stem().map_or(0.0, |(_, radius)| 2.0 * radius)
    }

    /// Where the trunk's diameter is measured, and the diameter.
    fn trunk_diameter(&self, forks: &Forks) -> (f64, f64) {
        match self.breast_diameter_m(&self.trunk_by(forks)) {
            Some(diameter_m) => (BREAST_HEIGHT_M, diameter_m),
            None => (0.0, self.base_diameter_m()),
        }
    }

    /// The diameters at breast height of all stems that reach it, metres, from the thickest to the thinnest: of the skeleton,
    /// without a flare.
    pub fn stem_diameters_m(&self, forks: &Forks) -> Vec<f64> {
        let trunks = self.trunks_of(self.stems(), forks);
        let mut found: Vec<f64> = trunks.iter().filter_map(|trunk| self.breast_diameter_m(trunk)).collect();
        found.sort_unstable_by(|a, b| b.total_cmp(a));
        found
    }

    /// The diameter at breast height of a trunk, whose axes are given from the foot up; `None` of a shorter one.
    fn breast_diameter_m(&self, trunk: &[u32]) -> Option<f64> {
        let nodes = trunk.iter().flat_map(|&axis| self.nodes_of(&self.axes[axis as usize]));
        let nodes: Vec<u32> = nodes.copied().collect();
        let along_m = self.climbed_m(&nodes);
        let mut pairs = nodes.windows(2).zip(along_m.windows(2));
        let (pair, along_m) = pairs.find(|(_, m)| m[1] >= BREAST_HEIGHT_M && m[1] > m[0])?;
        let t = (BREAST_HEIGHT_M - along_m[0]) / (along_m[1] - along_m[0]);
        let [below, above] = [pair[0], pair[1]].map(|n| f64::from(self.radii[n as usize]));
        let below = if self.width_steps == WidthSteps::Cylinder { above } else { below };
        Some(2.0 * (below + (above - below) * t))
    }

    /// How far from the foot each node of a stem is, from the foot up: along the stem. Between the buttresses of a scanned
    /// foot the axis goes to and fro, and a tape is held from the foot straight: so the way is measured there.
    pub fn climbed_m(&self, stem: &[u32]) -> Vec<f64> {
        let Some(&foot) = stem.first() else { return Vec::new() };
        let place = |node: u32| self.positions[node as usize].as_dvec3();
        let mut climbed_m = 0.0_f64;
        stem.iter()
            .map(|&node| {
                climbed_m = if self.fits.is_empty() {
                    climbed_m + if node == foot { 0.0 } else { self.segment_length(node as usize) }
                } else {
                    climbed_m.max(place(node).distance(place(foot)))
                };
                climbed_m
            })
            .collect()
    }
}

/// The ends of nodes that are in a row along X when seen from above, without a list of them: their hull.
fn ends_of_row(nodes: &[Vec3]) -> Option<Vec<DVec2>> {
    let first = nodes.first()?;
    if nodes.iter().any(|at| at.z.to_bits() != first.z.to_bits()) {
        return None;
    }
    let (mut least, mut most) = (first.x, first.x);
    for at in nodes {
        least = if at.x.total_cmp(&least).is_lt() { at.x } else { least };
        most = if at.x.total_cmp(&most).is_gt() { at.x } else { most };
    }
    let mut ends = [least, most].map(|x| DVec2::new(x.into(), first.z.into())).to_vec();
    ends.dedup();
    Some(ends)
}

#[cfg(test)]
mod tests {
    use glam::{DVec2, Vec3};
    use linden_base::hull::HullPolygon;
    use linden_base::random::Key;

    use super::ends_of_row;
    use crate::{Branching, Edge, Forks, NO_PARENT, RadiusFit, Skeleton, Wood};

    #[test]
    fn a_trunk_is_measured_beyond_the_end_of_its_axis() {
        let branching = Branching {
            positions: vec![Vec3::ZERO, Vec3::Y, Vec3::new(0.0, 2.0, 0.0), Vec3::new(1.0, 1.0, 0.0)],
            parents: vec![NO_PARENT, 0, 1, 1],
            births: vec![0; 4],
            radii: Some(vec![0.2, 0.2, 0.1, 0.05]),
            edges: Some(vec![Edge::Succeeds, Edge::Succeeds, Edge::Branches, Edge::Branches]),
        };
        let skeleton = Skeleton::build(branching, &Wood::default()).unwrap();
        assert_eq!(skeleton.axes.len(), 3);
        let measures = skeleton.measures();
        assert_eq!(measures.trunk_diameter_at_m, 1.3);
        assert!((measures.trunk_diameter_m - 0.34).abs() < 1e-6, "{measures:?}");
        let stems = skeleton.stem_diameters_m(&Forks::new(&skeleton));
        assert_eq!(stems, [measures.trunk_diameter_m], "laterals are no stems");
    }

    /// Poles of 1, 2 and 2 m; the last ends at 1 m, and its wood runs on.
    #[test]
    fn stems_are_measured_one_by_one() {
        let up = |x: f32, y: f32| Vec3::new(x, y, 0.0);
        let branching = Branching {
            positions: vec![
                up(0.0, 0.0),
                up(0.0, 1.0),
                up(5.0, 0.0),
                up(5.0, 1.0),
                up(5.0, 2.0),
                up(9.0, 0.0),
                up(9.0, 1.0),
                up(9.5, 2.0),
                up(8.5, 2.0),
            ],
            parents: vec![NO_PARENT, 0, NO_PARENT, 2, 3, NO_PARENT, 5, 6, 6],
            births: vec![0; 9],
            radii: Some(vec![0.4, 0.3, 0.1, 0.1, 0.08, 0.2, 0.2, 0.15, 0.05]),
            edges: Some(vec![
                Edge::Succeeds,
                Edge::Succeeds,
                Edge::Succeeds,
                Edge::Succeeds,
                Edge::Succeeds,
                Edge::Succeeds,
                Edge::Succeeds,
                Edge::Branches,
                Edge::Branches,
            ]),
        };
        let skeleton = Skeleton::build(branching, &Wood::default()).unwrap();
        let found = skeleton.stem_diameters_m(&Forks::new(&skeleton));
        // 0.3 m beyond 1 m: of 1.118 m along the fork, and of 1 m.
        let expected = [2.0 * (0.2 - 0.05 * 0.3 / 1.118_034), 2.0 * (0.1 - 0.02 * 0.3)];
        assert_eq!(found.len(), 2, "{found:?}");
        assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-6), "{found:?} {expected:?}");
        assert_eq!(skeleton.measures().trunk_diameter_at_m, 0.0, "the thickest is too short");
    }

    /// A stem that goes aside and back below 1 m, and loses a centimetre of radius every metre above.
    #[test]
    fn breast_height_is_along_a_stem_and_straight_up_a_scanned_one() {
        let places = [[0.0, 0.0], [0.3, 0.4], [0.0, 0.8], [0.0, 1.8], [0.0, 2.8]];
        let branching = Branching {
            positions: places.map(|[x, y]| Vec3::new(x, y, 0.0)).to_vec(),
            parents: vec![NO_PARENT, 0, 1, 2, 3],
            births: vec![0; 5],
            radii: Some(vec![0.2, 0.2, 0.2, 0.19, 0.18]),
            edges: None,
        };
        let mut skeleton = Skeleton::build(branching, &Wood::default()).unwrap();
        // A metre along the stem is 0.8 m up.
        assert!((skeleton.measures().trunk_diameter_m - 2.0 * 0.197).abs() < 1e-6);
        skeleton.fits = vec![RadiusFit::GUESSED; 5];
        assert!((skeleton.measures().trunk_diameter_m - 2.0 * 0.195).abs() < 1e-6);
        let climbed_m = skeleton.climbed_m(&[0, 1, 2]);
        assert!(climbed_m.iter().zip([0.0, 0.5, 0.8]).all(|(a, b)| (a - b).abs() < 1e-6), "{climbed_m:?}");
    }

    #[test]
    fn a_pole_with_one_branch() {
        let branching = Branching {
            positions: vec![Vec3::ZERO, Vec3::Y, Vec3::Y * 2.0, Vec3::new(3.0, 1.0, 0.0)],
            parents: vec![NO_PARENT, 0, 1, 1],
            births: vec![0; 4],
            radii: None,
            edges: None,
        };
        let wood = Wood { radius_exponent: 1.0, tip_radius_m: Some(0.1), ..Wood::default() };
        let skeleton = Skeleton::build(branching, &wood).unwrap();
        let m = skeleton.measures();
        assert_eq!((m.total_length_m, m.height_m, m.max_order), (5.0, 2.0, 1));
        // A line of 3 m seen from above is 3 |cos| wide.
        assert!((m.crown_width_m - 6.0 / std::f64::consts::PI).abs() < 1e-12);
        assert!(m.trunk_diameter_at_m == 1.3 && (m.base_diameter_m - 0.4).abs() < 1e-6);
        // Radius 0.2 up to 1 m, 0.1 at 2 m: 0.17 at 1.3 m.
        assert!((m.trunk_diameter_m - 0.34).abs() < 1e-6);
    }

    #[test]
    fn nodes_in_a_row_have_the_hull_of_any_points() {
        for seed in 0..100 {
            let key = Key::new(seed);
            let x = |i| (key.child(i).between(-3.0, 3.0)).round() as f32 * 0.5;
            let nodes: Vec<Vec3> = (0..seed / 10).map(|i| Vec3::new(x(i), x(i + 100), 0.25)).collect();
            let plan: Vec<DVec2> = nodes.iter().map(|at| DVec2::new(at.x.into(), at.z.into())).collect();
            let ends = ends_of_row(&nodes).unwrap_or_default();
            assert_eq!(format!("{ends:?}"), format!("{:?}", HullPolygon::of(&plan).corners), "seed {seed}");
        }
        assert_eq!(ends_of_row(&[Vec3::ZERO, Vec3::new(1.0, 0.0, -0.0)]), None, "of other bits");
    }
}
