//! Samples of scans: a part of the points, in steps that suit them; wood is as long in any steps.

use std::borrow::Cow;
use std::sync::Arc;

use glam::DVec3;
use linden_base::input::{Geometry, Inputs};
use linden_base::monitor::Monitor;
use linden_growth::sample::{Lengthening, trunk_share};
use linden_skeleton::Skeleton;
use linden_skeleton::generator::{GeneratorError, Multiple, SampleSize, SampleStep, Sampler, Task};

use crate::settings::Segmentation;
use crate::trees::chosen;
use crate::{ScanSettings, detail_m, likely_scale, point_spacing_m};

pub(crate) struct ScanPart {
    settings: ScanSettings,
    /// With a part of the points.
    inputs: Inputs,
    lengthening: Lengthening,
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
        smaller.growth.max_nodes = settings.growth.max_nodes.min(size.nodes);
        let (mut coarser, mut longer) = (1.0, 1.0);
        let mut inputs = Inputs::new();
        if let Some(input) = input.filter(|_| share < 1.0) {
            let part = spread(given, most);
            if settings.contract {
                longer = longer_steps(&mut smaller, given, &part, monitor);
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
            share,
            coarser,
            point_times: if is_grid { 1.0 } else { (points as f64 / most as f64).max(1.0) },
        }
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
            (longer, 1.0)
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
        }))
    }
}

/// A number of the points, evenly through the list.
fn spread(points: &[DVec3], count: usize) -> Vec<DVec3> {
    let every = points.len() as f64 / count.max(1) as f64;
    (0..count).filter_map(|i| points.get((i as f64 * every) as usize)).copied().collect()
}

/// Gives a part of a scan steps that it can be seen in. How many times as long they are as those of the
/// whole.
fn longer_steps(smaller: &mut ScanSettings, points: &[DVec3], part: &[DVec3], monitor: &dyn Monitor) -> f64 {
    // Points on bark: as many a square metre as there are.
    let sparser = (points.len() as f64 / part.len().max(1) as f64).sqrt();
    let Ok(Some(spacing_m)) = point_spacing_m(part, monitor) else { return 1.0 };
    let scale = smaller.scale.unwrap_or_else(|| likely_scale(part));
    let spacing_m = spacing_m * scale;
    let low = part.iter().copied().fold(DVec3::INFINITY, DVec3::min);
    let high = part.iter().copied().fold(DVec3::NEG_INFINITY, DVec3::max);
    let height_m = (high - low).max_element() * scale;
    let whole = smaller.growth.step_m.unwrap_or_else(|| detail_m(spacing_m / sparser, height_m));
    let seen = detail_m(spacing_m, height_m).max(whole);
    if seen > whole {
        smaller.growth.step_m = Some(seen);
    }
    seen / whole
}
