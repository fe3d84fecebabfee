//! Samples of scans: a part of the points, in steps that suit them; wood is as long in any steps.

use std::borrow::Cow;
use std::sync::Arc;

use glam::DVec3;
use linden_base::input::{Geometry, Inputs};
use linden_base::monitor::Monitor;
use linden_growth::sample::{Lengthening, trunk_share};
use linden_skeleton::Skeleton;
use linden_skeleton::generator::{GeneratorError, Multiple, SampleSize, SampleStep, Sampler, Task};

use crate::cubes::thin;
use crate::settings::Segmentation;
use crate::trees::chosen;
use crate::{ScanSettings, detail_m, likely_scale, point_spacing_m};

// What work takes beside other work: microseconds on two shared cores (Xeon, 2.0 GHz), one thread.

/// Planning, a point of the scan.
const PLANNED_POINT: f64 = 1.2;
/// Growing, a point and a node.
const POINT: f64 = 2.5;
const NODE: f64 = 11.0;

pub(crate) struct ScanPart {
    settings: ScanSettings,
    /// With a part of the points.
    inputs: Inputs,
    lengthening: Lengthening,
    /// How many nodes the tree of all points has, where these lie on bark.
    whole_nodes: Option<f64>,
    points: usize,
    /// The sample's points ÷ all.
    share: f64,
    coarser: f64,
    point_times: f64,
}

impl ScanPart {
    pub fn new(settings: &ScanSettings, task: &Task<'_>, size: SampleSize, monitor: &dyn Monitor) -> Self {
        let input = task.inputs.get(&settings.file);
        // What is wrong with them is said by who grows.
        let read = settings.cloud(task.inputs, monitor).ok();
        let given =
            read.as_ref().and_then(|(cloud, up)| Some(chosen(settings, cloud, *up, monitor).ok()?.points));
        let given = given.unwrap_or(Cow::Borrowed(&[]));
        let given = &given[..];
        let points = given.len();
        let most = size.points >> size.halvings.min(4);
        let is_grid = matches!(input.map(|input| &input.geometry), Some(Geometry::Points(cloud)) if cloud.cell.is_some());
        // A crown that is filled has as many points whatever it was filled from.
        let share = if is_grid { 1.0 } else { (most as f64 / points as f64).min(1.0) };
        let mut smaller = settings.clone();
        if share < 1.0 {
            smaller.tree = None;
            smaller.instance = None;
            smaller.segmentation = Segmentation::Column;
            smaller.thin = 0.0;
        }
        smaller.scale = read.as_ref().map_or(settings.scale, |(cloud, _)| settings.scale_of(cloud));
        smaller.growth.max_nodes = settings.growth.max_nodes.min(size.nodes);
        let (mut coarser, mut longer, mut whole_nodes) = (1.0, 1.0, None);
        let mut inputs = Inputs::new();
        if let Some(input) = input.filter(|_| share < 1.0) {
            let part = spread(given, most);
            if settings.contract {
                if let Some(steps) = Steps::of(&smaller, given, &part, monitor) {
                    smaller.growth.step_m = Some(steps.seen_m);
                    longer = steps.seen_m / steps.whole_m;
                    whole_nodes = Some(nodes_along(given, steps.whole_m / steps.scale));
                }
            } else {
                coarser = libm::cbrt(1.0 / share);
            }
            let mut input = input.clone();
            input.geometry = Geometry::Points(Arc::new(part.into()));
            inputs.insert(settings.file.clone(), input);
        }
        if coarser > 1.0 {
            smaller.growth = smaller.growth.coarser(coarser);
        }
        Self {
            settings: smaller,
            inputs,
            lengthening: Lengthening::new(settings.growth.max_nodes, longer),
            whole_nodes,
            points,
            share,
            coarser,
            point_times: if is_grid { 1.0 } else { (points as f64 / most as f64).max(1.0) },
        }
    }

    /// How many times as much work the tree is, with so many times the nodes: planning looks at all points.
    fn work_times(&self, wood_times: f64, nodes: usize) -> f64 {
        let (points, nodes) = (self.points as f64, nodes as f64);
        let grown = |points: f64, nodes: f64| points * POINT + nodes * NODE;
        grown(points, nodes * wood_times) / (points * PLANNED_POINT + grown(points * self.share, nodes))
    }

    fn grow(&self) -> SampleStep {
        SampleStep::Grow { settings: Box::new(self.settings.clone()), inputs: self.inputs.clone() }
    }
}

impl Sampler for ScanPart {
    fn next(&mut self, grown: Option<&Skeleton>) -> Result<SampleStep, GeneratorError> {
        let Some(grown) = grown else { return Ok(self.grow()) };
        if self.lengthening.again(&mut self.settings.growth, grown) {
            return Ok(self.grow());
        }
        let longer = self.lengthening.longer;
        let crowding = if self.settings.contract { 1.0 } else { 1.0 / self.share };
        let (wood_times, leaf_times) = if self.settings.contract {
            // Few points show no twigs.
            let wood_times =
                self.whole_nodes.map_or(longer, |nodes| nodes / grown.positions.len().max(1) as f64);
            (wood_times, wood_times / longer)
        } else {
            let trunk = trunk_share(grown);
            let per_node = (1.0 - trunk) * crowding + trunk * self.coarser;
            (longer * per_node, per_node)
        };
        let within = self.lengthening.within(wood_times, grown);
        Ok(SampleStep::Done(Multiple {
            wood_times: within,
            leaf_times: leaf_times * (within / wood_times.max(1.0)),
            point_times: self.point_times,
            crowding,
            coarser: self.coarser,
            work_times: self.whole_nodes.map(|_| self.work_times(within, grown.positions.len())),
        }))
    }
}

/// A number of the points, evenly through the list.
fn spread(points: &[DVec3], count: usize) -> Vec<DVec3> {
    let every = points.len() as f64 / count.max(1) as f64;
    (0..count).filter_map(|i| points.get((i as f64 * every) as usize)).copied().collect()
}

/// The steps of a tree that grows into a scan.
struct Steps {
    /// Of all points, metres.
    whole_m: f64,
    /// Which a part of them can be seen in.
    seen_m: f64,
    /// Metres for a unit of the points.
    scale: f64,
}

impl Steps {
    fn of(settings: &ScanSettings, points: &[DVec3], part: &[DVec3], monitor: &dyn Monitor) -> Option<Self> {
        let scale = settings.scale.unwrap_or_else(|| likely_scale(part));
        let low = part.iter().copied().fold(DVec3::INFINITY, DVec3::min);
        let high = part.iter().copied().fold(DVec3::NEG_INFINITY, DVec3::max);
        let height_m = (high - low).max_element() * scale;
        let detail_of = |points: &[DVec3]| {
            let spacing = point_spacing_m(points, monitor).ok()??;
            Some(detail_m(scale * spacing, height_m))
        };
        // How far apart the points of the part are does not tell it: along twigs they thin out faster than on a stem.
        let whole_m = settings.growth.step_m.or_else(|| detail_of(points))?;
        Some(Self { whole_m, seen_m: detail_of(part)?.max(whole_m), scale })
    }
}

/// Nodes of a tree by the cubes of a grid that hold points of its bark, with sides of one, two and four steps: fitted on ten
/// scans of eight species, dense and sparse ones, of which each comes out within a quarter.
const NODES_PER_CUBE: f64 = 5.3;

/// About how many nodes a tree has that grows into points on its bark in such steps. Cubes of four steps go by the length of
/// wood; where cubes of one step are many for those of two, limbs are thicker than steps, and fewer nodes run through them.
fn nodes_along(points: &[DVec3], step: f64) -> f64 {
    let [one, two, four] = [1.0, 2.0, 4.0].map(|steps| thin(points, steps * step).len() as f64);
    NODES_PER_CUBE * four * two / one.max(1.0)
}
