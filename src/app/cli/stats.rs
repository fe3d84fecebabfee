//! `linden stats`: grow a source and measure it.

use std::time::Instant;

use anyhow::Context;
use clap::Args;
use linden::Vec3;
use linden::dress::finest;
use linden::dress::leaf_shapes;
use linden::foliage::meshes_of;
use linden::grow::Scanned;
use linden::grow::Spread;
use linden::monitor::Holding;
use linden::scene::{Bounds, Mesh};
use linden::surface::{Junction, survey};
use serde::Serialize;

use super::GrowArgs;
use crate::forecast::{Outlook, announce};
use crate::progress::Progress;

/// Grow a source and measure it
#[derive(Args)]
pub struct Stats {
    #[command(flatten)]
    growing: GrowArgs,

    #[command(flatten)]
    budget: super::Budget,

    /// Machine-readable; what does not apply is null
    #[arg(long)]
    json: bool,
}

/// The names and meanings of `--json`: scripts rely on them.
#[derive(Serialize)]
struct StatsReport {
    source: String,
    seed: u64,
    generator: &'static str,
    nodes: usize,
    segments: usize,
    axes: usize,
    max_order: u32,
    total_length_m: f64,
    height_m: f64,
    crown_width_m: f64,
    trunk_diameter_m: f64,
    wood_volume_m3: f64,
    points: Option<usize>,
    points_unreached: Option<usize>,
    iterations: Option<u32>,
    /// Whether a scan was a crown without a stem; null for what is no scan.
    canopy: Option<bool>,
    scan: Option<Scan>,
    symbols: Option<u64>,
    triangles: usize,
    vertices: usize,
    leaves: usize,
    watertight: bool,
    /// Whether all wood is one surface.
    #[serde(skip)]
    is_solid: bool,
    bounds: Corners,
    skeleton_hash: String,
    seconds: Seconds,
}

/// How the tree compares with the scan that it grew into.
#[derive(Serialize)]
struct Scan {
    /// Scanned points of the tree, without ground, strays and noise.
    points: usize,
    /// Nodes whose radius points bear out; the others' follow by the pipe model.
    measured_nodes: usize,
    points_to_axis: Distances,
    points_to_surface: Distances,
    axis_to_points: Distances,
    surface_to_points: Distances,
}

/// The mean, and what 95 % do not exceed.
#[derive(Serialize)]
struct Distances {
    mean_m: f64,
    p95_m: f64,
}

impl Scan {
    fn of(scanned: &Scanned) -> Self {
        let Scanned { points, measured_nodes, fit } = *scanned;
        let of = |spread: Spread| Distances { mean_m: spread.mean_m, p95_m: spread.p95_m };
        Self {
            points,
            measured_nodes,
            points_to_axis: of(fit.points_to_axis),
            points_to_surface: of(fit.points_to_surface),
            axis_to_points: of(fit.axis_to_points),
            surface_to_points: of(fit.surface_to_points),
        }
    }
}

#[derive(Serialize)]
struct Corners {
    min: [f32; 3],
    max: [f32; 3],
}

#[derive(Serialize)]
struct Seconds {
    grow: f64,
    dress: f64,
}

impl Stats {
    pub fn run(self) -> anyhow::Result<()> {
        let progress = Progress::new();
        let settings: Vec<_> = self.growing.pairs()?.into_iter().chain(self.budget.pair()).collect();
        let source = self.growing.resolve_with(&settings, &progress)?;
        if let Some(outlook) = Outlook::of(&source.recipe, &progress) {
            announce(outlook.stats_s(&source.recipe), &outlook.amount());
        }
        let started = Instant::now();
        let grown = super::grown(&source, &progress)?;
        let grow_s = started.elapsed().as_secs_f64();
        let started = Instant::now();
        // The surface alone, and never the whole of it: trees can be measured that no mesh format holds.
        // The bark's pictures are not measured, and take longer than all else.
        let holding = Holding::new(&progress, grown.bytes() + source.recipe.inputs.bytes());
        let shown = finest(&source.recipe, &grown, &holding).with_context(|| source.shown.clone())?;
        let surface =
            survey(&shown.skeleton, &shown.tubes, &holding).with_context(|| source.shown.clone())?;
        let shapes =
            leaf_shapes(&source.recipe, &shown.organs, &holding).with_context(|| source.shown.clone())?;
        let foliage = meshes_of(&shown.organs, &shapes, 1, &holding).with_context(|| source.shown.clone())?;
        let dress_s = started.elapsed().as_secs_f64();

        let skeleton = &grown.skeleton;
        let measures = skeleton.measures();
        let leaf_bounds = foliage.iter().filter_map(|organ| organ.mesh.bounds());
        let bounds = surface.bounds.into_iter().chain(leaf_bounds).reduce(Bounds::union);
        let count = |of: fn(&Mesh) -> usize| foliage.iter().map(|organ| of(&organ.mesh)).sum::<usize>();
        let bounds = bounds.unwrap_or(Bounds { min: Vec3::ZERO, max: Vec3::ZERO });
        let colonized = grown.colonized.as_ref();
        let report = StatsReport {
            source: source.shown.clone(),
            seed: source.recipe.preset.seed,
            generator: source.recipe.preset.grows_by().id(),
            nodes: skeleton.positions.len(),
            segments: skeleton.segments(),
            axes: skeleton.axes.len(),
            max_order: measures.max_order,
            total_length_m: measures.total_length_m,
            height_m: measures.height_m,
            crown_width_m: measures.crown_width_m,
            trunk_diameter_m: measures.trunk_diameter_m,
            wood_volume_m3: measures.wood_volume_m3,
            points: colonized.map(|colonized| colonized.points.len()),
            points_unreached: colonized.map(|colonized| colonized.unreached),
            iterations: colonized.map(|colonized| colonized.iterations),
            canopy: colonized
                .filter(|colonized| colonized.is_canopy || colonized.scan.is_some())
                .map(|colonized| colonized.is_canopy),
            scan: colonized.and_then(|colonized| colonized.scan).as_ref().map(Scan::of),
            symbols: grown.symbols,
            triangles: surface.triangles + count(|mesh| mesh.triangles.len()),
            vertices: surface.vertices + count(|mesh| mesh.positions.len()),
            leaves: shown.organs.len(),
            watertight: surface.topology.watertight(),
            is_solid: source.recipe.preset.dressing.tubes.junction == Junction::Watertight,
            bounds: Corners { min: bounds.min.to_array(), max: bounds.max.to_array() },
            skeleton_hash: format!("{:032x}", skeleton.hash()),
            seconds: Seconds { grow: grow_s, dress: dress_s },
        };
        progress.clear();
        if self.json {
            return super::print_json(&report);
        }
        super::print(&report.table())
    }
}

impl StatsReport {
    fn table(&self) -> String {
        let count = |n: usize| indicatif::HumanCount(n as u64).to_string();
        let mut rows = vec![
            ("source", format!("{} (seed {}, {})", self.source, self.seed, self.generator)),
            ("height", format!("{:.2} m", self.height_m)),
            ("crown width", format!("{:.2} m", self.crown_width_m)),
            ("trunk diameter", format!("{:.3} m at 1.3 m", self.trunk_diameter_m)),
            ("total length", format!("{:.1} m", self.total_length_m)),
            ("wood volume", format!("{:.3} m³", self.wood_volume_m3)),
            ("nodes", count(self.nodes)),
            ("axes", format!("{}, orders 0 to {}", count(self.axes), self.max_order)),
        ];
        if let Some(symbols) = self.symbols {
            rows.push(("symbols", indicatif::HumanCount(symbols).to_string()));
        }
        if let (Some(points), Some(unreached), Some(iterations)) =
            (self.points, self.points_unreached, self.iterations)
        {
            rows.push(("points", format!("{}, {} not reached", count(points), count(unreached))));
            rows.push(("iterations", count(iterations as usize)));
        }
        if self.canopy == Some(true) {
            rows.push(("scan", "a canopy without a stem: all radii are guessed".to_owned()));
        }
        if let Some(scan) = &self.scan {
            let of = |way: &Distances| {
                format!("{:.1} mm on average, 95 % within {:.1} mm", 1e3 * way.mean_m, 1e3 * way.p95_m)
            };
            rows.push((
                "scan",
                format!(
                    "{} points; radii of {} nodes measured",
                    count(scan.points),
                    count(scan.measured_nodes)
                ),
            ));
            rows.push(("points-surface", of(&scan.points_to_surface)));
            rows.push(("surface-points", of(&scan.surface_to_points)));
            rows.push(("points-axis", of(&scan.points_to_axis)));
            rows.push(("axis-points", of(&scan.axis_to_points)));
        }
        let watertight = match (self.watertight, self.is_solid) {
            (true, true) => "yes: one solid",
            (true, false) => "yes: each axis is closed",
            (false, _) => "no",
        };
        rows.extend([
            ("surface", format!("{} triangles, {} vertices", count(self.triangles), count(self.vertices))),
            ("leaves", count(self.leaves)),
            ("watertight", watertight.to_owned()),
            ("skeleton hash", self.skeleton_hash.clone()),
            ("time", format!("{:.3} s to grow, {:.3} s to dress", self.seconds.grow, self.seconds.dress)),
        ]);
        let mut text = String::new();
        for (name, value) in rows {
            text.push_str(&format!("{name:14}  {value}\n"));
        }
        text
    }
}
