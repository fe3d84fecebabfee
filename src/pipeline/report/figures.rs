//! What the numbers of a tree are read from, each computed once.

use std::f64::consts::TAU;
use std::sync::Arc;

use glam::{DVec2, DVec3, Vec3};
use linden_base::hull::{HullPolygon, HullSolid};
use linden_base::mesh::Bounds;
use linden_base::monitor::{Holding, Monitor};
use linden_plant::canopy::{Canopy, canopy, projection};
use linden_plant::detail::{DetailError, Finest};
use linden_plant::surface::{Stretch, SurfaceError, Survey, Tubes, survey_by};
use linden_skeleton::{
    Axis, BREAST_HEIGHT_M, Forks, Measures, RadiusFit, RadiusSource, Skeleton, Streams, ratio_of_orders,
};

use super::{Corners, ReportError};
use crate::dress::finest;
use crate::grow::Grown;
use crate::recipe::Recipe;

/// Where the classes of wood by diameter end, metres; the last has no end. Wood of 7 cm and more is what foresters
/// call merchantable (Derbholz).
pub const DIAMETERS_M: [f64; 7] = [0.01, 0.02, 0.04, 0.07, 0.1, 0.2, 0.5];

/// Laterals this long, as a share of the height, begin a crown.
const LONG_LATERAL: f64 = 0.05;

/// The wood of one order.
#[derive(Clone, Copy, Default)]
pub(super) struct WoodOfOrder {
    pub length_m: f64,
    pub volume_m3: f64,
    pub area_m2: f64,
}

/// The wood as its tubes have it: with flare, collars, smoothing and taper.
#[derive(Default)]
pub(super) struct WoodOfTubes {
    /// By order, from 0 on.
    pub by_order: Vec<WoodOfOrder>,
    /// By the classes of [`DIAMETERS_M`].
    pub by_diameter_m3: Vec<f64>,
    /// Of the trunk at its foot.
    pub base_diameter_m: f64,
    /// Of the trunk at breast height, where it gets there.
    pub dbh_m: Option<f64>,
    /// Of the trunk, from its foot to its top.
    pub stem_volume_m3: f64,
}

/// Mean and standard deviation of angles, degrees.
#[derive(Clone, Default)]
pub(super) struct Angles {
    pub count: usize,
    pub mean: Option<f64>,
    /// Of the sample: divided by one less than the count.
    pub sd: Option<f64>,
    /// Their sum.
    sum: f64,
    /// The sum of the squares of what they differ from the mean.
    squares: f64,
}

impl Angles {
    /// Of some angles, all of them first, then those of each order from 1 to `most`: sums run in their order. `of` gives
    /// order and angle of each, twice.
    fn of<I: Iterator<Item = (u32, f64)>>(most: u32, of: impl Fn() -> I) -> (Self, Vec<Self>) {
        let (mut all, mut by_order) = (Self::default(), vec![Self::default(); most as usize]);
        for (order, degrees) in of() {
            for angles in [&mut all, &mut by_order[order as usize - 1]] {
                angles.count += 1;
                angles.sum += degrees;
            }
        }
        for angles in std::iter::once(&mut all).chain(&mut by_order) {
            angles.mean = (angles.count > 0).then(|| angles.sum / angles.count as f64);
        }
        for (order, degrees) in of() {
            for angles in [&mut all, &mut by_order[order as usize - 1]] {
                let off = degrees - angles.mean.unwrap_or(degrees);
                angles.squares += off * off;
            }
        }
        for angles in std::iter::once(&mut all).chain(&mut by_order) {
            let Self { count, squares, .. } = *angles;
            angles.sd = (count > 1).then(|| (squares / (count - 1) as f64).sqrt());
        }
        (all, by_order)
    }
}

/// Of everything, seen from above; of the crown, in space.
pub(super) struct Hulls {
    pub plan: HullPolygon,
    pub solid: HullSolid,
}

impl Hulls {
    /// Of wood; in space of what `is_crown` tells of it.
    fn of_wood(skeleton: &Skeleton, is_bare: bool, is_crown: impl Fn(&DVec3) -> bool) -> Self {
        // Flat wood encloses nothing, and without leaves nothing lies beside its plane.
        let is_flat = is_bare && skeleton.lies_in_a_plane();
        let crown = skeleton.positions.iter().map(|at| at.as_dvec3()).filter(is_crown);
        let solid = if is_flat { HullSolid::default() } else { HullSolid::of_all(crown) };
        Self { plan: skeleton.seen_from_above(), solid }
    }

    /// The same around some more points.
    fn around(&self, points: &[DVec3]) -> Self {
        let above = points.iter().map(|at| DVec2::new(at.x, at.z));
        let ground: Vec<DVec2> = self.plan.corners.iter().copied().chain(above).collect();
        let all: Vec<DVec3> = self.solid.corners.iter().chain(points).copied().collect();
        Self { plan: HullPolygon::of(&ground), solid: HullSolid::of(&all) }
    }
}

pub(super) struct Figures<'a> {
    pub grown: &'a Grown,
    pub recipe_hash: u128,
    pub is_reduced: bool,
    pub skeleton: Arc<Skeleton>,
    pub organs: usize,
    pub measures: Measures,
    /// At breast height, from the thickest to the thinnest.
    pub stem_diameters_m: Vec<f64>,
    pub wood: Hulls,
    pub all: Hulls,
    pub canopy: Canopy,
    pub survey: Survey,
    pub tips: usize,
    pub path_mean_m: f64,
    pub path_longest_m: f64,
    pub streams: Vec<Streams>,
    pub tubes: WoodOfTubes,
    pub angles: Angles,
    /// By the order of the lateral, from 1 on.
    pub angles_by_order: Vec<Angles>,
    /// The circle around the node of the trunk that is nearest to breast height.
    pub breast_fit: Option<RadiusFit>,
    pub breast_source: Option<RadiusSource>,
    /// Nodes of the thickest stem, from its foot up.
    trunk: Vec<u32>,
    floor_m: f64,
    crown_base_m: Option<f64>,
}

impl<'a> Figures<'a> {
    pub fn new(recipe: &Recipe, grown: &'a Grown, monitor: &dyn Monitor) -> Result<Self, ReportError> {
        let holding = Holding::new(monitor, grown.bytes() + recipe.inputs.bytes());
        let Finest { skeleton, organs, cards, tubes } = finest(recipe, grown, &holding)?;
        let forks = Forks::new(&skeleton);
        let holding = Holding::new(&holding, forks.bytes());
        let trunk = skeleton.trunk_by(&forks);
        let (survey, mut wood_of_tubes) = WoodOfTubes::survey(&skeleton, &trunk, &tubes, &holding)?;
        // A budget may be as large as the tree.
        let is_whole =
            organs.len() == grown.organs.len() && cards.is_none() && tubes == recipe.preset.dressing.tubes;
        let is_reduced = !is_whole || !Arc::ptr_eq(&skeleton, &grown.skeleton) && skeleton != grown.skeleton;
        // Lists of nodes and of axes.
        let bytes = skeleton.topology_bytes();
        let admitted = holding.admit("measuring the tree", bytes, "grow a smaller tree");
        admitted.map_err(DetailError::from)?;
        let heights = skeleton.positions.iter().map(|at| f64::from(at.y));
        let floor_m = heights.reduce(f64::min).unwrap_or(0.0);
        let mut canopy = recipe.with_specimen(|specimen| canopy(specimen, &organs, floor_m, &holding))?;
        if let Some([vertices, triangles]) = cards {
            (canopy.vertices, canopy.triangles) = (vertices as usize, triangles as usize);
        }
        monitor.check()?;
        let crown_base_m = canopy.lowest_leaf_m.or_else(|| lowest_lateral_m(&skeleton, floor_m));
        let is_crown = |at: &DVec3| crown_base_m.is_some_and(|base| at.y >= base);
        let ((measures, stem_diameters_m, wood), branching) = rayon::join(
            || {
                let wood = Hulls::of_wood(&skeleton, canopy.corners.is_empty(), is_crown);
                for (axis, length_m, _) in skeleton.cylinder_sizes(&forks) {
                    wood_of_tubes.by_order[axis.order as usize].length_m += f64::from(length_m);
                }
                (skeleton.measures_by(&wood.plan, &forks), skeleton.stem_diameters_m(&forks), wood)
            },
            || BranchFigures::of(&skeleton),
        );
        let all = wood.around(&canopy.corners);
        let BranchFigures { tips, path_mean_m, path_longest_m, streams, angles, angles_by_order } = branching;
        let trunk: Vec<u32> = trunk
            .iter()
            .flat_map(|&axis| skeleton.nodes_of(&skeleton.axes[axis as usize]))
            .copied()
            .collect();
        let breast = breast_fit(&skeleton, &trunk).filter(|_| wood_of_tubes.dbh_m.is_some());
        Ok(Self {
            grown,
            recipe_hash: recipe.hash(),
            is_reduced,
            organs: organs.len(),
            measures,
            stem_diameters_m,
            wood,
            all,
            survey,
            path_mean_m,
            path_longest_m,
            tips,
            streams,
            tubes: wood_of_tubes,
            angles,
            angles_by_order,
            breast_fit: breast.filter(|fit| fit.source == RadiusSource::Measured),
            breast_source: breast.map(|fit| fit.source),
            trunk,
            floor_m,
            crown_base_m,
            canopy,
            skeleton,
        })
    }

    /// Of the thickest stem at breast height, where it gets there: as it was measured on a scan, else as its tube is.
    pub fn dbh_m(&self) -> Option<f64> {
        let dbh_m = self.tubes.dbh_m?;
        Some(if self.skeleton.fits.is_empty() { dbh_m } else { self.measures.trunk_diameter_m })
    }

    /// Axes that nothing bears.
    pub fn stem_count(&self) -> usize {
        self.skeleton.stems().count()
    }

    /// Of wood and everything on it, above the lowest node, metres.
    pub fn height_with_leaves_m(&self) -> f64 {
        let top = self.canopy.corners.iter().map(|at| at.y - self.floor_m).fold(0.0, f64::max);
        top.max(self.measures.height_m)
    }

    /// Of the thickest stem up to half of the tree's height, from the upright, degrees. Which of its ends in the crown a stem
    /// is followed to is as good as chance.
    pub fn stem_lean_deg(&self) -> f64 {
        let mut places = self.trunk.iter().map(|node| self.skeleton.positions[*node as usize].as_dvec3());
        let Some(foot) = places.next() else { return 0.0 };
        let half_m = foot.y + 0.5 * self.measures.height_m;
        let mut end = foot;
        for at in places {
            if at.y >= half_m {
                end = end.lerp(at, (half_m - end.y) / (at.y - end.y).max(f64::MIN_POSITIVE));
                break;
            }
            end = at;
        }
        (end - foot).try_normalize().map_or(0.0, |along| libm::acos(along.y.clamp(-1.0, 1.0)).to_degrees())
    }

    /// `None` where nothing was measured.
    pub fn measured_volume_share(&self) -> Option<f64> {
        let fits = &self.skeleton.fits;
        if fits.is_empty() {
            return None;
        }
        let is_measured =
            |node: u32| fits.get(node as usize).is_some_and(|f| f.source == RadiusSource::Measured);
        let (mut measured, mut all) = (0.0, 0.0);
        for cylinder in self.skeleton.cylinders() {
            all += cylinder.volume_m3();
            measured += if is_measured(cylinder.node) { cylinder.volume_m3() } else { 0.0 };
        }
        (all > 0.0).then(|| measured / all)
    }

    pub fn sum_of_orders(&self, of: impl Fn(&WoodOfOrder) -> f64) -> f64 {
        self.tubes.by_order.iter().fold(0.0, |sum, order| sum + of(order))
    }

    pub fn crown_base_m(&self) -> Option<f64> {
        Some(self.crown_base_m? - self.floor_m)
    }

    /// Factors from order to order of Strahler: of numbers (fewer by), of lengths (longer by).
    pub fn stream_ratios(&self) -> [Option<f64>; 2] {
        let numbers: Vec<f64> = self.streams.iter().map(|stream| stream.count as f64).collect();
        let lengths: Vec<f64> = self.streams.iter().map(|stream| stream.mean_length_m).collect();
        [ratio_of_orders(&numbers).map(f64::recip), ratio_of_orders(&lengths)]
    }

    pub fn leaf_area_index(&self) -> Option<f64> {
        let (area, ground) = (self.canopy.leaf_area_once_m2(), self.all.plan.area());
        (area > 0.0 && ground > 0.0).then(|| area / ground)
    }

    /// Shares of the leaf area in nine classes of ten degrees.
    pub fn inclination_shares(&self) -> Option<Vec<f64>> {
        let classes = &self.canopy.inclinations_m2;
        let total: f64 = classes.iter().sum();
        let share = |part: &[f64]| part.iter().sum::<f64>() / total;
        (total > 0.0).then(|| classes.chunks(classes.len() / 9).map(share).collect())
    }

    /// By area, degrees.
    pub fn inclination_mean_deg(&self) -> Option<f64> {
        let classes = &self.canopy.inclinations_m2;
        let total: f64 = classes.iter().sum();
        let width = 90.0 / classes.len() as f64;
        let sum: f64 = classes.iter().enumerate().map(|(i, area)| (i as f64 + 0.5) * width * area).sum();
        (total > 0.0).then(|| sum / total)
    }

    /// G at zenith angles of 0, 10, … 90 degrees.
    pub fn projections(&self) -> Option<Vec<f64>> {
        let at = |tens: u32| projection(&self.canopy.inclinations_m2, f64::from(10 * tens).to_radians());
        (0..10).map(at).collect()
    }

    pub fn layer_m(&self) -> Option<f64> {
        let (floor, top) = (self.canopy.floor_m, self.canopy.top_m);
        (self.canopy.leaf_area_m2() > 0.0 && top > floor)
            .then(|| (top - floor) / self.canopy.layers_m2.len() as f64)
    }

    pub fn leaf_area_density(&self) -> Option<Vec<f64>> {
        let volume = self.layer_m()? * self.all.plan.area();
        (volume > 0.0).then(|| self.canopy.layers_m2.iter().map(|area| area / volume).collect())
    }

    pub fn bounds(&self) -> Corners {
        let leaves = Bounds::of(self.canopy.corners.iter().map(|at| at.as_vec3()));
        let all = self.survey.bounds.into_iter().chain(leaves).reduce(Bounds::union);
        all.unwrap_or(Bounds { min: Vec3::ZERO, max: Vec3::ZERO }).into()
    }
}

/// Where the lowest lateral of a stem leaves, as high as the axes have it: of those that are long beside the tree, as crowns
/// have shoots below them, and scans what points beside a stem were taken for. Of all, where none is.
fn lowest_lateral_m(skeleton: &Skeleton, floor_m: f64) -> Option<f64> {
    let height = |node: u32| f64::from(skeleton.positions[node as usize].y);
    let top = (0..skeleton.positions.len() as u32).map(height).fold(floor_m, f64::max);
    let least_m = LONG_LATERAL * (top - floor_m);
    let length_m = |axis: &Axis| -> f64 {
        skeleton.nodes_of(axis).iter().map(|&node| skeleton.segment_length(node as usize)).sum()
    };
    let laterals = || skeleton.axes.iter().filter(|axis| axis.order == 1);
    let lowest =
        |laterals: &mut dyn Iterator<Item = &Axis>| laterals.map(|axis| height(axis.parent)).reduce(f64::min);
    lowest(&mut laterals().filter(|axis| length_m(axis) >= least_m)).or_else(|| lowest(&mut laterals()))
}

/// What bears out the radius at breast height.
pub(crate) fn breast_fit(skeleton: &Skeleton, trunk: &[u32]) -> Option<RadiusFit> {
    let off_m = |climbed_m: &f64| (climbed_m - BREAST_HEIGHT_M).abs();
    let climbed_m = skeleton.climbed_m(trunk);
    let nearest = trunk.iter().zip(&climbed_m).min_by(|a, b| off_m(a.1).total_cmp(&off_m(b.1)))?;
    skeleton.fits.get(*nearest.0 as usize).copied()
}

/// How the wood branches.
struct BranchFigures {
    tips: usize,
    path_mean_m: f64,
    path_longest_m: f64,
    streams: Vec<Streams>,
    angles: Angles,
    /// By the order of the lateral, from 1 on.
    angles_by_order: Vec<Angles>,
}

impl BranchFigures {
    fn of(skeleton: &Skeleton) -> Self {
        // One list of all nodes after another.
        let (tips, path_sum_m, path_longest_m) = skeleton.paths_to_tips_m();
        let path_mean_m = path_sum_m / tips.max(1) as f64;
        let (angles, angles_by_order) = {
            let of_axes = skeleton.angles_of_axes();
            let most = skeleton.axes.iter().map(|axis| axis.order).max().unwrap_or(0);
            let known = || skeleton.axes.iter().zip(&of_axes).filter(|(_, angle_rad)| !angle_rad.is_nan());
            Angles::of(most, || known().map(|(axis, angle_rad)| (axis.order, angle_rad.to_degrees())))
        };
        Self { tips, path_mean_m, path_longest_m, streams: skeleton.streams(), angles, angles_by_order }
    }
}

impl WoodOfTubes {
    /// All but the lengths.
    fn survey(
        skeleton: &Skeleton,
        trunk: &[u32],
        tubes: &Tubes,
        monitor: &dyn Monitor,
    ) -> Result<(Survey, Self), SurfaceError> {
        let orders = skeleton.axes.iter().map(|axis| axis.order + 1).max().unwrap_or(0);
        let mut wood = Self {
            by_order: vec![WoodOfOrder::default(); orders as usize],
            by_diameter_m3: vec![0.0; DIAMETERS_M.len() + 1],
            ..Self::default()
        };
        let mut climbed_m = 0.0;
        let mut visit = |piece: WoodPiece| {
            let WoodPiece { order, class, volume_m3, area_m2, on_trunk } = piece;
            let order = &mut wood.by_order[order as usize];
            order.volume_m3 += volume_m3;
            order.area_m2 += area_m2;
            wood.by_diameter_m3[usize::from(class)] += volume_m3;
            // Axes come in order, and so do those of the trunk.
            let Some(stretch) = on_trunk else { return };
            wood.stem_volume_m3 += volume_m3;
            if !stretch.is_end {
                let [lower, upper] = stretch.radii_m;
                if climbed_m == 0.0 && wood.base_diameter_m == 0.0 {
                    wood.base_diameter_m = 2.0 * lower;
                }
                if (climbed_m..climbed_m + stretch.length_m).contains(&BREAST_HEIGHT_M) {
                    let share = (BREAST_HEIGHT_M - climbed_m) / stretch.length_m;
                    wood.dbh_m = Some(2.0 * (lower + (upper - lower) * share));
                }
                climbed_m += stretch.length_m;
            }
        };
        let survey = survey_by(
            skeleton,
            tubes,
            &|stretch| WoodPiece::of(stretch, skeleton, trunk),
            &mut visit,
            monitor,
        )?;
        Ok((survey, wood))
    }
}

/// What a stretch of a tube adds.
struct WoodPiece {
    order: u32,
    /// Of [`DIAMETERS_M`].
    class: u8,
    volume_m3: f64,
    area_m2: f64,
    /// Itself, where it is of the trunk.
    on_trunk: Option<Box<Stretch>>,
}

impl WoodPiece {
    fn of(stretch: Stretch, skeleton: &Skeleton, trunk: &[u32]) -> Self {
        let (volume_m3, radius_m) = (stretch.volume_m3(), stretch.radius_m());
        Self {
            order: skeleton.axes[stretch.axis as usize].order,
            class: DIAMETERS_M.partition_point(|&end| end <= 2.0 * radius_m) as u8,
            volume_m3,
            area_m2: TAU * radius_m * stretch.length_m,
            on_trunk: trunk.binary_search(&stretch.axis).is_ok().then(|| Box::new(stretch)),
        }
    }
}
