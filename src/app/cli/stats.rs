//! `linden stats`: grow a source and measure it.

use std::time::Instant;

use anyhow::Context;
use clap::Args;
use linden::grow::{Grown, Scanned, Spread};
use linden::report::{Group, NUMBERS, Report};
use linden::surface::Junction;
use serde::Serialize;

use super::GrowArgs;
use super::ages::aged;
use crate::forecast::Outlook;
use crate::numbers::line;
use crate::progress::Progress;
use crate::source::Source;

/// Grow a source and measure it
#[derive(Args)]
pub struct Stats {
    #[command(flatten)]
    growing: GrowArgs,

    #[command(flatten)]
    budget: super::Budget,

    /// The plant at several ages, a column each: names that the source has for them ('linden show'), names with a share of
    /// its growth like half=0.5, or years like 10y where it grows by them; all that it names when none is given
    #[arg(long, value_name = "LIST", num_args = 0..=1, default_missing_value = "all")]
    ages: Option<String>,

    /// Machine-readable; what does not apply is null. With --ages a list
    #[arg(long)]
    json: bool,
}

/// The names and meanings of `--json`: scripts rely on them.
#[derive(Serialize)]
struct StatsReport {
    source: String,
    /// The age that it is shown at, where several are.
    #[serde(skip_serializing_if = "Option::is_none")]
    age: Option<String>,
    seed: u64,
    generator: &'static str,
    #[serde(flatten)]
    report: Report,
    scan: Option<Scan>,
    /// What is said of source and tree on standard error: what was guessed, left out or not found.
    notes: Vec<String>,
    /// Whether all wood is one surface.
    #[serde(skip)]
    is_solid: bool,
    seconds: Seconds,
}

/// How the tree compares with the scan that it grew into.
#[derive(Serialize)]
struct Scan {
    /// Scanned points on wood of the tree, without ground, strays, noise and leaves.
    points: usize,
    /// Points that were taken for leaves.
    leaf_points: usize,
    /// Nodes whose radius points bear out; the others' follow by the pipe model.
    measured_nodes: usize,
    points_to_axis: Distances,
    points_to_surface: Distances,
    axis_to_points: Distances,
    surface_to_points: Distances,
    /// Where the tree's foot is in the scan, in its axes and units.
    foot: Option<[f64; 3]>,
}

/// The mean, and what 95 % do not exceed.
#[derive(Serialize)]
struct Distances {
    mean_m: f64,
    p95_m: f64,
}

impl Scan {
    fn of(grown: &Grown) -> Option<Self> {
        let foot = grown.foot.map(|foot| foot.to_array());
        let scanned = grown.colonized.as_ref()?.scan.as_ref()?;
        Some(Self { foot, ..Self::of_scanned(scanned) })
    }

    fn of_scanned(scanned: &Scanned) -> Self {
        let Scanned { leaf_points, measured_nodes, fit, .. } = *scanned;
        let of = |spread: Spread| Distances { mean_m: spread.mean_m, p95_m: spread.p95_m };
        Self {
            points: scanned.points.len(),
            leaf_points,
            measured_nodes,
            points_to_axis: of(fit.points_to_axis),
            points_to_surface: of(fit.points_to_surface),
            axis_to_points: of(fit.axis_to_points),
            surface_to_points: of(fit.surface_to_points),
            foot: None,
        }
    }
}

#[derive(Serialize)]
struct Seconds {
    grow: f64,
    /// Surface, leaves and all numbers, without the bark's pictures.
    dress: f64,
}

impl Stats {
    pub fn run(self) -> anyhow::Result<()> {
        let progress = Progress::new();
        let settings: Vec<_> = self.growing.pairs()?.into_iter().chain(self.budget.pair()).collect();
        let source = self.growing.resolve_with(&settings, &progress)?;
        let Some(list) = &self.ages else {
            let stats = StatsReport::of(&source, None, &progress)?;
            progress.clear();
            return if self.json { super::print_json(&stats) } else { super::print(&stats.table()) };
        };
        self.growing.without_age("name all of them with --ages")?;
        let ages = aged(&source, list, &settings)?;
        let all = ages
            .iter()
            .map(|(age, source)| StatsReport::of(source, Some(age.clone()), &progress))
            .collect::<anyhow::Result<Vec<StatsReport>>>()?;
        progress.clear();
        if self.json { super::print_json(&all) } else { super::print(&columns(&all)) }
    }
}

impl StatsReport {
    /// Grows and measures.
    fn of(source: &Source, age: Option<String>, progress: &Progress) -> anyhow::Result<Self> {
        if let Some(outlook) = Outlook::of(&source.recipe, progress) {
            outlook.announce(outlook.stats_s(&source.recipe));
        }
        let started = Instant::now();
        let grown = super::grown(source, progress)?;
        let grow_s = started.elapsed().as_secs_f64();
        let started = Instant::now();
        // Of the surface a piece at a time, and never the whole: trees can be measured that no mesh format holds.
        // The bark's pictures are not measured, and take longer than all else.
        let report = Report::of(&source.recipe, &grown, progress).with_context(|| source.shown.clone())?;
        Ok(Self {
            source: source.shown.clone(),
            age,
            seed: source.recipe.preset.seed(),
            generator: source.recipe.preset.grows_by().id(),
            report,
            scan: Scan::of(&grown),
            notes: source.notes.iter().chain(&grown.notes).cloned().chain(source.tree_note(&grown)).collect(),
            is_solid: source.recipe.preset.dressing.tubes.junction == Junction::Watertight,
            seconds: Seconds { grow: grow_s, dress: started.elapsed().as_secs_f64() },
        })
    }

    /// A block of lines for each group.
    fn table(&self) -> String {
        let mut text = format!("{} (seed {}, {})\n", self.source, self.seed, self.generator);
        for group in Group::ALL {
            let rows = NUMBERS.iter().filter(|number| number.group == group);
            let mut lines: Vec<(&str, String)> =
                rows.filter_map(|number| line(number, &self.report, self.is_solid)).collect();
            match group {
                Group::Growth => lines.extend(self.scan.as_ref().map_or_else(Vec::new, Scan::lines)),
                Group::Surface => {
                    let Seconds { grow, dress } = self.seconds;
                    lines.push(("time", format!("{grow:.3} s to grow, {dress:.3} s to measure")));
                }
                _ => {}
            }
            if !lines.is_empty() {
                text.push_str(&format!("\n{}\n", group.name()));
            }
            for (label, value) in lines {
                text.push_str(&format!("  {label:26}  {value}\n"));
            }
        }
        text
    }
}

/// Numbers of several ages side by side: those that are one number each.
const SIDE_BY_SIDE: [&str; 13] = [
    "height_m",
    "dbh_m",
    "base_diameter_m",
    "crown_width_with_leaves_m",
    "crown_base_m",
    "wood_volume_m3",
    "total_length_m",
    "nodes",
    "max_order",
    "leaf_count",
    "leaf_area_m2",
    "leaf_area_index",
    "triangles",
];

/// A line for each number, a column for each age.
fn columns(all: &[StatsReport]) -> String {
    let Some(first) = all.first() else { return String::new() };
    let mut text = format!("{} (seed {}, {})\n\n", first.source, first.seed, first.generator);
    let ages = all.iter().map(|stats| stats.age.clone().unwrap_or_default());
    let mut rows: Vec<(String, Vec<String>)> = vec![(String::new(), ages.collect())];
    for number in SIDE_BY_SIDE.iter().filter_map(|name| NUMBERS.iter().find(|number| number.name == *name)) {
        let value = |stats: &StatsReport| line(number, &stats.report, false).map(|(_, value)| value);
        let values: Vec<Option<String>> = all.iter().map(value).collect();
        if values.iter().any(Option::is_some) {
            let label = format!("{} {}", number.group.name(), number.label);
            rows.push((
                label,
                values.into_iter().map(|value| value.unwrap_or_else(|| "-".to_owned())).collect(),
            ));
        }
    }
    let seconds = |stats: &StatsReport| format!("{:.3} s", stats.seconds.grow);
    rows.push(("time to grow".to_owned(), all.iter().map(seconds).collect()));
    let width =
        |column: usize| rows.iter().map(|(_, values)| values[column].chars().count()).max().unwrap_or(0);
    let widths: Vec<usize> = (0..all.len()).map(width).collect();
    let label_width = rows.iter().map(|(label, _)| label.chars().count()).max().unwrap_or(0);
    for (label, values) in &rows {
        let cells = values.iter().zip(&widths).map(|(value, width)| format!("  {value:>width$}"));
        text.push_str(&format!("  {label:label_width$}{}\n", cells.collect::<String>()));
    }
    text
}

impl Scan {
    fn lines(&self) -> Vec<(&'static str, String)> {
        let count = |n: usize| indicatif::HumanCount(n as u64);
        let of = |way: &Distances| {
            format!("{:.1} mm on average, 95 % within {:.1} mm", 1e3 * way.mean_m, 1e3 * way.p95_m)
        };
        let leaves = match self.leaf_points {
            0 => String::new(),
            leaves => format!(" on wood, {} on leaves", count(leaves)),
        };
        let radii = format!(
            "{} points{leaves}; radii of {} nodes measured",
            count(self.points),
            count(self.measured_nodes)
        );
        vec![
            ("scan", radii),
            ("points-surface", of(&self.points_to_surface)),
            ("surface-points", of(&self.surface_to_points)),
            ("points-axis", of(&self.points_to_axis)),
            ("axis-points", of(&self.axis_to_points)),
        ]
    }
}
