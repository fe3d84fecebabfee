//! Scans as a generator.

use std::sync::{Arc, OnceLock};

use glam::{DVec3, Vec3};
use linden_base::document::{Fault, Table};
use linden_base::input::{Cloud, Geometry, Inputs, MapUnits, Thinned, Up};
use linden_base::knob::{Knob, Value, excerpt};
use linden_base::memory::{OverMemory, bytes_of};
use linden_base::monitor::{Cancelled, Monitor, Quiet};
use linden_growth::stand::grow_at;
use linden_growth::{Origin, Stand, StandError};
use linden_skeleton::generator::{
    Branched, Gaps, Generator, GeneratorError, InputTrees, KeyContent, Measured, Passage, RadiiFrom,
    SampleSize, Sampler, Settings, TableKey, Task, Traits, Written,
};
use linden_skeleton::publication::{Publication, SPACE_COLONIZATION};
use linden_skeleton::{Branching, RadiusFit, Skeleton, Wood};

use crate::canopy::Verdict;
use crate::fit::gaps_of_placed;
use crate::girth::{MEASURING_BYTES_PER_POINT, Placed};
use crate::points::{As, Given, Prepared, at_points};
use crate::publications::{DU, TAO, VERROUST_LAZARUS, VICARI, XU_GOSSETT_CHEN, ZHANG};
use crate::sample::ScanPart;
use crate::{Girth, LeafPoints, ScanGrowthError, ScanSettings, Segmentation, crowns, girth, trees};

/// Trees that were scanned, or points that are given otherwise.
pub const GENERATOR: &dyn Generator = &Scans;

struct Scans;

/// The key of the file with the points.
const FILE: &str = "file";

/// The key of the column that tells trees apart.
const INSTANCE: &str = "instance";

impl Generator for Scans {
    fn id(&self) -> &'static str {
        "scan"
    }

    fn name(&self) -> &'static str {
        "Scan"
    }

    fn help(&self) -> &'static str {
        "branches grow into given points: a laser scan of a tree, or attraction points"
    }

    fn publications(&self) -> &'static [Publication] {
        &[SPACE_COLONIZATION, VERROUST_LAZARUS, XU_GOSSETT_CHEN]
    }

    fn knobs(&self) -> Vec<Knob> {
        ScanSettings::all_knobs()
    }

    fn keys(&self) -> &'static [TableKey] {
        &[
            TableKey {
                name: FILE,
                help: "the points (LAS, LAZ, E57, PLY, PCD, PTX, XYZ, CSV) or heights of a canopy (ASC, GeoTIFF), relative to the preset",
                content: KeyContent::File,
            },
            TableKey {
                name: INSTANCE,
                help: "the file's column that tells trees apart, for the knob 'tree'; without, the likeliest by its name; none: all points are one tree",
                content: KeyContent::Text,
            },
        ]
    }

    /// Those of crowns, from when both stood in one table.
    fn former_knobs(&self) -> &'static [&'static str] {
        &["crown_base", "points", "shell_density", "top_density", "clumps", "clump_size"]
    }

    fn key_hint(&self, key: &str) -> Option<&'static str> {
        (key == "part").then_some("parts need a 'crown' or an 'envelope'; a scan has neither")
    }

    fn read(&self, table: &Table<'_>) -> Result<Box<dyn Settings>, Fault> {
        match table.text(FILE)? {
            Some(file) => {
                let instance = table.text(INSTANCE)?.map(str::to_owned);
                Ok(Box::new(ScanSettings { instance, ..ScanSettings::of(file) }))
            }
            None => Err(Fault::new(
                table.place,
                "[scan] has no 'file': name the points, like file = \"tree.ply\"",
            )),
        }
    }
}

impl ScanSettings {
    /// Metres for a unit of the points, where the settings or the file say it.
    pub(crate) fn scale_of(&self, cloud: &Cloud) -> Option<f64> {
        self.scale.or_else(|| cloud.units.and_then(|units| units.scale()))
    }

    /// The points, thinned as the settings say, and the axis that usually points up in such files.
    pub(crate) fn cloud(
        &self,
        inputs: &Inputs,
        monitor: &dyn Monitor,
    ) -> Result<(Arc<Cloud>, Up), ScanGrowthError> {
        let wrong = || ScanGrowthError::WrongInput { file: self.file.clone(), expected: "points" };
        let input = inputs.get(&self.file).ok_or_else(wrong)?;
        let Geometry::Points(cloud) = &input.geometry else { return Err(wrong()) };
        let cloud = match (cloud.thinned, self.thinning()) {
            // A grid of heights has a point a cell.
            _ if cloud.cell.is_some() => cloud.clone(),
            (None, None) => cloud.clone(),
            (None, Some(cube)) => cloud.thinning_cache.get(cube, || cloud.thin(cube, monitor))?,
            (Some(Thinned { cube, .. }), _) if cube == self.thin => cloud.clone(),
            (Some(Thinned { cube, .. }), _) => {
                return Err(ScanGrowthError::Thinned {
                    file: self.file.clone(),
                    read: cube,
                    wanted: self.thin,
                });
            }
        };
        Ok((cloud, input.up))
    }
}

impl Settings for ScanSettings {
    fn generator(&self) -> &'static dyn Generator {
        GENERATOR
    }

    fn publications(&self) -> Vec<Publication> {
        let of_plots = if self.segmentation == Segmentation::Paths { &[ZHANG, TAO][..] } else { &[] };
        let of_leaves = if self.leaf_points == LeafPoints::Paths { &[VICARI, DU][..] } else { &[] };
        [GENERATOR.publications(), of_plots, of_leaves].concat()
    }

    fn knobs(&self) -> Vec<(Knob, Value)> {
        self.turned()
    }

    fn set(&mut self, knob: &str, value: Value) -> bool {
        self.turn(knob, value)
    }

    fn written(&self) -> Vec<(&'static str, Written)> {
        let instance = self.instance.clone().map(|name| (INSTANCE, Written::Text(name)));
        std::iter::once((FILE, Written::Text(self.file.clone()))).chain(instance).collect()
    }

    fn plain(&self) -> Box<dyn Settings> {
        Box::new(Self { instance: self.instance.clone(), ..Self::of(self.file.clone()) })
    }

    fn inputs(&self) -> Vec<&str> {
        vec![&self.file]
    }

    fn thinning(&self) -> Option<f64> {
        Some(self.thin).filter(|&cube| cube > 0.0)
    }

    fn rename_inputs(&mut self, renamed: &dyn Fn(&str) -> Option<String>) {
        if let Some(name) = renamed(&self.file) {
            self.file = name;
        }
    }

    fn describe(&self, inputs: &Inputs) -> Vec<Passage> {
        let extent = inputs.get(&self.file).map(|input| format!(": {}", input.extent()));
        let line = format!("{}{}", self.file, extent.unwrap_or_default());
        let points = Passage { heading: "attraction points", lines: vec![line] };
        let cloud = self.cloud(inputs, &Quiet).ok();
        let lines: Vec<String> =
            match cloud.as_ref().map(|(cloud, up)| trees::columns(self, cloud, *up, &Quiet)) {
                Some(Ok(columns)) => columns.all().iter().map(trees::line).collect(),
                Some(Err(problem)) => vec![problem.to_string()],
                None => Vec::new(),
            };
        let trees = (!lines.is_empty()).then_some(Passage { heading: "trees that are told apart", lines });
        let leaves = cloud
            .as_ref()
            .and_then(|(cloud, _)| cloud.leaves.as_ref())
            .map(|column| Passage { heading: "points on leaves", lines: vec![trees::leaf_line(column)] });
        std::iter::once(points).chain(trees).chain(leaves).collect()
    }

    fn trees(&self, inputs: &Inputs, monitor: &dyn Monitor) -> Result<Option<InputTrees>, GeneratorError> {
        if self.tree.is_some() {
            return Ok(None);
        }
        let (cloud, up) = match self.cloud(inputs, monitor) {
            // Who grows them says so.
            Err(ScanGrowthError::WrongInput { .. }) => return Ok(None),
            found => found?,
        };
        let columns = trees::columns(self, &cloud, up, monitor)?;
        let column = trees::column(self, &cloud, &columns)?;
        let trees = column.map(|column| {
            let told_by = format!("'{}'", excerpt(&column.name));
            InputTrees { knob: "tree", told_by, made_of: "points", numbers: column.counts() }
        });
        // Who asks for stems to be looked for means those that are found, if it is one; and one number beside points of no
        // tree picks a tree out of a plot.
        let picks_one = cloud.cell.is_none() && column.is_some_and(|column| column.unnumbered_points() > 0);
        let is_asked = self.segmentation == Segmentation::Paths || picks_one;
        Ok(trees.filter(|trees| is_asked || trees.numbers.len() > 1))
    }

    fn set_text(&mut self, key: &str, text: &str) -> bool {
        let is_it = key == INSTANCE;
        if is_it {
            self.instance = Some(text.to_owned());
        }
        is_it
    }

    fn idle(&self, knob: &str, wood: &Wood) -> Option<&'static str> {
        self.why_idle(knob, wood)
    }

    fn traits(&self, wood: &Wood) -> Traits {
        let radii = if self.measures(wood) { RadiiFrom::Measured } else { RadiiFrom::Rule };
        Traits { radii, knows_use: true, ..Traits::default() }
    }

    /// A scan that is moved onto axes is taken as it is; other points are jittered.
    fn draws(&self) -> bool {
        !self.contract
    }

    fn stay(&mut self) -> Option<[f64; 3]> {
        self.growth.stay();
        (self.growth.origin == Origin::Root).then_some([0.0; 3])
    }

    fn limit(&mut self, inputs: &Inputs, size: &SampleSize) -> Result<bool, String> {
        let points = self.cloud(inputs, &Quiet).map_or(0, |(cloud, up)| match self.segmentation {
            // Only for their number a plot is not segmented: there are no more of a tree than of all.
            Segmentation::Paths => cloud.positions.len(),
            Segmentation::Column => {
                trees::chosen(self, &cloud, up, &Quiet).map_or(0, |chosen| chosen.points.len())
            }
        });
        self.growth.limit(points, size)
    }

    fn grow(&self, task: &Task<'_>, monitor: &dyn Monitor) -> Result<Branched, GeneratorError> {
        let Planted { stand, bark, leaf_points, foot, is_canopy } = planted(self, task, monitor)?;
        let mut branched = stand.branched(&self.growth);
        if let Some(colonized) = &mut branched.colonized {
            colonized.is_canopy = is_canopy;
        }
        branched.foot = Some(foot);
        let measures = self.measures(&task.wood);
        branched.measured = bark.map(|bark| {
            Box::new(Bark { points: bark, leaf_points, measures, placed: OnceLock::new() })
                as Box<dyn Measured>
        });
        Ok(branched)
    }

    fn sampler<'a>(
        &'a self,
        task: &Task<'a>,
        size: SampleSize,
        monitor: &'a dyn Monitor,
    ) -> Result<Box<dyn Sampler + 'a>, GeneratorError> {
        Ok(Box::new(ScanPart::new(self, task, size, monitor)))
    }
}

/// What grew into the points.
struct Planted {
    stand: Stand,
    /// The points on bark, where the tree stands; `None` where the points are no scan.
    bark: Option<Vec<Vec3>>,
    /// Points that were taken for leaves.
    leaf_points: usize,
    /// Where its foot is in the file.
    foot: DVec3,
    is_canopy: bool,
}

fn planted(
    settings: &ScanSettings,
    task: &Task<'_>,
    monitor: &dyn Monitor,
) -> Result<Planted, ScanGrowthError> {
    let (cloud, up) = settings.cloud(task.inputs, monitor)?;
    let trees::Chosen { points, is_leaf, ground, others, notes: of_trees } =
        trees::chosen(settings, &cloud, up, monitor)?;
    let first_notes = || {
        let of_file =
            thinning_note(settings, &cloud).into_iter().chain(file_notes(settings, &cloud, &points));
        of_file.chain(of_trees.clone()).collect::<Vec<String>>()
    };
    let scale = settings.scale_of(&cloud);
    // Who says which tree it is, where it stands or how many stems it has knows what there is.
    let may_be_plot = settings.segmentation == Segmentation::Column
        && trees::wanted(settings).is_none()
        && cloud.trees.is_empty()
        && settings.stems.is_none()
        && settings.growth.given_root(up).is_none();
    let grow = |points: &[DVec3], what: As| -> Result<Planted, ScanGrowthError> {
        let is_leaf = is_leaf.as_deref().filter(|_| what == As::Settings);
        let given = Given {
            points,
            is_leaf,
            ground: &ground,
            others: &others,
            up,
            is_up_sure: cloud.is_z_up,
            scale,
            may_be_plot,
        };
        let Prepared { site, bark, leaf_points, axes } =
            at_points(settings, &given, task.key(), what, monitor)?;
        let mut stand = grow_at(site, &settings.growth, monitor)?;
        stand.notes.splice(0..0, first_notes());
        let place = |p: &DVec3| (*p + stand.shift).as_vec3();
        let bark = bark.map(|bark| bark.iter().map(place).collect());
        let foot = axes.of(stand.foot);
        Ok(Planted { stand, bark, leaf_points, foot, is_canopy: what != As::Settings })
    };
    if let Some(cell) = cloud.cell {
        let scale = scale.unwrap_or(1.0);
        let top = points.iter().map(|p| p.z).fold(0.0, f64::max);
        let base = settings.growth.trunk_m.map_or(crowns::BASE_PER_TOP * top, |trunk_m| trunk_m / scale);
        let mut planted = grow(&crowns::filled(&points, cell, base), As::Grid)?;
        planted.stand.notes.push(crowns::note(top * scale, base * scale));
        planted.stand.notes.extend(crowns::terrain_note(&cloud.positions, scale));
        return Ok(planted);
    }
    if !settings.contract {
        return grow(&points, As::Settings);
    }
    match grow(&points, As::Settings) {
        Ok(mut planted) => match Verdict::of(&planted.stand, planted.bark.as_deref(), monitor)? {
            Verdict::Tree => return Ok(planted),
            Verdict::Partly(note) => {
                planted.stand.notes.push(note);
                return Ok(planted);
            }
            Verdict::Canopy => {}
        },
        Err(ScanGrowthError::Stand(StandError::NothingGrew { .. })) => {}
        Err(error) => return Err(error),
    }
    grow(&points, As::Canopy)
}

/// What is said of points that were left out while they were read.
fn thinning_note(settings: &ScanSettings, cloud: &Cloud) -> Option<String> {
    let thin = settings.thinning()?;
    let Some(Thinned { of, .. }) = cloud.thinned else {
        return Some("a grid of heights has a point a cell: thin leaves it as it is".to_owned());
    };
    let kept = cloud.positions.len();
    Some(format!("thin={thin}: {kept} of {of} points were kept, the first in each cube"))
}

/// What is said of how a file was read: columns, rows, units and digits.
fn file_notes(settings: &ScanSettings, cloud: &Cloud, points: &[DVec3]) -> Vec<String> {
    let mut notes = Vec::new();
    if let Some([x, y, z]) = &cloud.unnamed {
        notes.push(format!(
            "the header names no x, y and z: the first three columns, '{x}', '{y}' and '{z}', were taken for them"
        ));
    }
    if cloud.has_row_numbers {
        notes.push(
            "the first of four columns counts rows: the other three were taken for x, y and z; a header like \
             'x y z intensity' says otherwise"
                .to_owned(),
        );
    }
    match cloud.placeless_rows {
        0 => {}
        1 => notes.push("1 row without a coordinate (empty, NA or NaN) was left out".to_owned()),
        rows => notes.push(format!("{rows} rows without a coordinate (empty, NA or NaN) were left out")),
    }
    notes.extend(units_note(settings, cloud));
    notes.extend(steps_note(points).filter(|_| cloud.cell.is_none()));
    notes
}

/// What is said of a map that is not in metres.
fn units_note(settings: &ScanSettings, cloud: &Cloud) -> Option<String> {
    let units = cloud.units.filter(|_| settings.scale.is_none())?;
    let [places, heights] = [units.places_m, units.heights_m].map(MapUnits::name);
    Some(match units.scale() {
        Some(scale) => format!(
            "the file's coordinate system is in {places}: coordinates were taken for these, heights too (scale={scale}); \
             scale=1 takes them for metres"
        ),
        None => format!(
            "the file's coordinate system has places in {places} and heights in {heights}, which no scale makes metres of: \
             nothing was converted; reproject it to metres first (pdal translate … filters.reprojection, gdalwarp)"
        ),
    })
}

/// Steps of single precision are coarse where a cloud has fewer of them along its longest side;
const FEW_STEPS: f64 = 20_000.0;

/// and those of any type where it has fewer than details of a tree are looked for along its height.
const FEW_VALUES: usize = crate::DETAILS_PER_HEIGHT as usize;

/// Fewer points may have few values by chance.
const MANY_POINTS: usize = 1000;

/// What is said of coordinates that stand on a grid: so far from 0 that single precision, in which all of them are, is coarse
/// there, or with few values along an axis, however they were written.
fn steps_note(points: &[DVec3]) -> Option<String> {
    let is_single = |p: &DVec3| p.to_array().iter().all(|&x| f64::from(x as f32) == x);
    let low = points.iter().copied().reduce(DVec3::min)?;
    let high = points.iter().copied().reduce(DVec3::max)?;
    let farthest = low.abs().max_element().max(high.abs().max_element());
    let step = f64::from((farthest as f32).next_up() - farthest as f32);
    let is_coarse = (high - low).max_element() < FEW_STEPS * step && high != low;
    if is_coarse && points.iter().all(is_single) {
        return Some(format!(
            "all coordinates are numbers of single precision, which {farthest:.0} from 0 lie {step} apart: the points stand on a \
             grid; export them with double precision, or moved near 0 (a global shift)"
        ));
    }
    let longest = (high - low).max_element();
    let axes = ["x", "y", "z"].into_iter().enumerate();
    let (axis, step) = axes
        .filter_map(|(at, axis)| Some((axis, coarse_step(points, at, longest)?)))
        .reduce(|widest, other| if other.1 > widest.1 { other } else { widest })?;
    let step = format!("{step:.6}");
    Some(format!(
        "coordinates along {axis} lie {} and more apart, as those do that were single precision far from 0 once, or are rounded: the \
         points stand on a grid; export them from the source with double precision and more digits",
        step.trim_end_matches('0').trim_end_matches('.')
    ))
}

/// How far apart the values along an axis are, where they are few for so many points, and coarse beside the cloud's longest side.
fn coarse_step(points: &[DVec3], axis: usize, longest: f64) -> Option<f64> {
    let sample = crate::frame::sample(points);
    let mut values: Vec<f64> = sample.iter().map(|p| p[axis]).collect();
    values.sort_unstable_by(f64::total_cmp);
    let extent = values.last()? - values.first()?;
    let count = values.len();
    // Rounding of what is written, and of feet that became metres, makes no other value.
    values.dedup_by(|b, a| *b - *a <= 1e-9 * extent);
    let is_few = count >= MANY_POINTS && values.len() > 2 && values.len() < FEW_VALUES.min(count / 4);
    let gaps = values.windows(2).map(|pair| pair[1] - pair[0]);
    let step = gaps.fold(f64::INFINITY, f64::min);
    (is_few && step * FEW_VALUES as f64 > longest).then_some(step)
}

/// Points on the bark of the tree, where it stands.
struct Bark {
    points: Vec<Vec3>,
    leaf_points: usize,
    /// Whether they say how thick the wood is.
    measures: bool,
    /// The segments that they are nearest to, from when they were measured.
    placed: OnceLock<Placed>,
}

impl Measured for Bark {
    fn leaf_points(&self) -> usize {
        self.leaf_points
    }

    fn bytes(&self) -> u64 {
        bytes_of::<Vec3>(self.points.capacity()) + self.placed.get().map_or(0, Placed::bytes)
    }

    fn admit(&self, branching: &Branching, monitor: &dyn Monitor) -> Result<(), OverMemory> {
        let bytes = self.points.len() as u64 * MEASURING_BYTES_PER_POINT;
        monitor.admit("measuring the scan", bytes + branching.bytes(), "thin the points out")
    }

    fn measure(
        &self,
        branching: &mut Branching,
        wood: &Wood,
        monitor: &dyn Monitor,
    ) -> Result<Option<Vec<RadiusFit>>, Cancelled> {
        if !self.measures {
            return Ok(None);
        }
        let Some(Girth { radii, fits, placed, .. }) = girth(branching, &self.points, wood, monitor)? else {
            // They were looked for: the rule for radii decides.
            return Ok(Some(vec![RadiusFit::GUESSED; branching.positions.len()]));
        };
        branching.radii = Some(radii);
        // Measured again, the first stands: it is looked at only where the wood is the same.
        let _ = self.placed.set(placed);
        Ok(Some(fits))
    }

    fn gaps(&self, skeleton: &Skeleton, monitor: &dyn Monitor) -> Result<Option<Gaps>, Cancelled> {
        gaps_of_placed(&self.points, self.placed.get(), skeleton, monitor)
    }

    fn into_points(self: Box<Self>) -> Vec<Vec3> {
        self.points
    }
}

#[cfg(test)]
mod tests {
    use linden_base::random::Key;

    use super::*;

    /// A pole of 8 m, its coordinates rounded to steps, in a survey's corner.
    fn pole(steps: [f64; 3]) -> Vec<DVec3> {
        let key = Key::new(2);
        let corner = DVec3::new(448_123.0, 5_428_000.0, 300.0);
        let point = |i: u64| {
            let (sin, cos) = libm::sincos(7.0 * key.child(i).named("turn").unit());
            let p = DVec3::new(0.4 * cos, 0.4 * sin, 8.0 * key.child(i).named("up").unit());
            DVec3::from_array([0, 1, 2].map(|axis| libm::round(p[axis] / steps[axis]) * steps[axis])) + corner
        };
        (0..6000).map(point).collect()
    }

    #[test]
    fn coordinates_on_a_grid_are_noticed_whatever_their_type() {
        let said = |steps| steps_note(&pole(steps)).unwrap_or_default();
        assert_eq!(said([1e-4; 3]), "");
        // A scanner's millimetres are no grid, though few fit across a stem.
        assert_eq!(said([1e-3; 3]), "");
        assert!(said([0.1; 3]).contains("lie 0.1 and more apart"), "{}", said([0.1; 3]));
        // As single precision has northings, printed with three digits.
        let northing = said([0.031, 0.5, 3.1e-5]);
        assert!(northing.contains("along y") && northing.contains("0.5 and more"), "{northing}");
        assert!(steps_note(&pole([0.1; 3])[..900]).is_none());
    }
}
