//! What `linden show` says of a forest.

use linden::forest::Forest;
use linden::knob::printable;
use serde::Serialize;

use super::forest::resolved;
use super::list::FORESTS;
use super::size::SizeRow;
use crate::config::presets::FOREST;
use crate::exit::usage;
use crate::forecast::ForestOutlook;
use crate::progress::Progress;
use crate::source::forest::{ForestFile, turn};

#[derive(Serialize)]
struct ShownForest {
    /// Printable.
    source: String,
    id: String,
    name: String,
    group: &'static str,
    summary: String,
    generator: &'static str,
    knobs: Vec<ForestKnobRow>,
    trees: Vec<TreeRow>,
    /// How many stand there, and how many of them are grown: the others are copies.
    places: usize,
    distinct: usize,
    /// Each different tree once.
    forecast: SizeRow,
    recipe: serde_json::Value,
}

#[derive(Serialize)]
struct ForestKnobRow {
    name: &'static str,
    value: String,
    unit: &'static str,
    range: String,
    help: &'static str,
}

#[derive(Serialize)]
struct TreeRow {
    id: String,
    name: String,
    share: f64,
    size: f64,
}

/// How it is to be shown.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum As {
    Page,
    Json,
    Document,
}

/// Shows a forest with some knobs turned.
pub(super) fn show(
    described: ForestFile,
    pairs: &[(String, String)],
    how: As,
    progress: &Progress,
) -> anyhow::Result<()> {
    if how == As::Document {
        if let Some((name, _)) = pairs.first() {
            let name = printable(name);
            return Err(usage(format!(
                "the document of a forest is shown as it stands: change {name} in it, or leave out --toml"
            )));
        }
        return super::print(&described.text);
    }
    let summary = described.document.summary.clone();
    let shown = described.shown();
    let mut forest = resolved(described, progress)?.forest;
    for (name, value) in pairs {
        turn(&mut forest, name, value)?;
    }
    let plan = forest.plan(progress)?;
    let trees = forest.kinds.iter().map(|kind| TreeRow {
        id: kind.recipe.preset.id.clone(),
        name: kind.recipe.preset.name.clone(),
        share: kind.share,
        size: kind.size,
    });
    let page = ShownForest {
        source: shown,
        name: forest.name.clone(),
        group: FORESTS,
        summary,
        generator: FOREST,
        knobs: knobs(&forest),
        trees: trees.collect(),
        places: plan.trees.iter().map(|tree| tree.stems as usize).max().unwrap_or(0).max(plan.places.len()),
        forecast: ForestOutlook::of(&plan.trees, forest.layout.triangles, progress).size(),
        distinct: plan.trees.iter().map(|tree| tree.stems as usize).sum(),
        recipe: serde_json::from_str(&forest.to_line())?,
        id: forest.id,
    };
    if how == As::Json { super::print_json(&page) } else { super::print(&page.page()) }
}

fn knobs(forest: &Forest) -> Vec<ForestKnobRow> {
    let row = |(row, value): (&linden::forest::ForestKnob, linden::knob::Value)| ForestKnobRow {
        name: row.knob.name,
        value: value.to_string(),
        unit: row.knob.unit,
        range: row.knob.kind.to_string(),
        help: row.knob.help,
    };
    forest.layout.knobs().map(row).collect()
}

impl ShownForest {
    fn page(&self) -> String {
        let mut text = format!("{} ({})\n", printable(&self.name), printable(&self.id));
        if !self.summary.is_empty() {
            text.push_str(&format!("{}\n", printable(&self.summary)));
        }
        let places = indicatif::HumanCount(self.places as u64);
        text.push_str(&format!("\na forest of {places} trees, {} of them grown\n\ntrees\n", self.distinct));
        let sum: f64 = self.trees.iter().map(|tree| tree.share).sum();
        let width = self.trees.iter().map(|tree| tree.id.chars().count()).max().unwrap_or(0);
        for tree in &self.trees {
            let size =
                if tree.size == 1.0 { String::new() } else { format!(", {} times as large", tree.size) };
            let share = 100.0 * tree.share / sum;
            text.push_str(&format!("  {:width$}  {share:2.0} %{size}\n", printable(&tree.id)));
        }
        text.push_str(&format!("\nforecast, each different tree once\n{}", self.forecast.lines()));
        text.push_str("\nforest\n");
        for row in &self.knobs {
            let value = format!("{} {}", row.value, row.unit);
            text.push_str(&format!("  {:14}{:12}{}\n", row.name, value.trim_end(), row.help));
            text.push_str(&format!("  {:26}{}\n", "", row.range));
        }
        text.push_str(&format!("\nlinden forest {} -o {}.glb\n", self.source, printable(&self.id)));
        text
    }
}
