//! `linden list`: the presets, and the forests of them.

use clap::Args;
use linden::forest::{BuiltinForest, ForestDocument, builtin_forests};
use linden::preset::{Preset, builtins};
use serde::Serialize;

use crate::source;

/// List the presets with what they grow to, and the forests; or the export formats
#[derive(Args)]
pub struct List {
    /// Machine-readable
    #[arg(long)]
    json: bool,

    /// List the export formats instead
    #[arg(long)]
    exporters: bool,
}

/// The group of forests.
pub(super) const FORESTS: &str = "forests";
/// What makes a forest, where a preset names its generator.
pub(super) const FOREST: &str = "forest";

#[derive(Serialize)]
struct Row {
    id: String,
    name: String,
    group: String,
    generator: &'static str,
    /// What was measured of a built-in preset; `null` for what must be grown to be measured.
    height_m: Option<f64>,
    leaves: Option<u64>,
    summary: String,
    source: String,
}

impl List {
    pub fn run(self) -> anyhow::Result<()> {
        if self.exporters {
            return exporters(self.json);
        }
        let forest = |own: &'static BuiltinForest| {
            let ForestDocument { name, summary, .. } =
                own.load().map_err(|fault| source::locate(own.id, &fault))?;
            Ok(Row {
                id: own.id.to_owned(),
                name,
                group: FORESTS.to_owned(),
                generator: FOREST,
                height_m: None,
                leaves: None,
                summary,
                source: String::new(),
            })
        };
        let rows = builtins()
            .iter()
            .map(|builtin| {
                let Preset { id, name, group, summary, source, generator, .. } = builtin.load()?;
                let (height_m, leaves) = builtin.size.map(|size| (size.height_m, size.leaves)).unzip();
                Ok(Row { id, name, group, generator: generator.id(), height_m, leaves, summary, source })
            })
            .chain(builtin_forests().iter().map(forest))
            .collect::<anyhow::Result<Vec<Row>>>()?;
        if self.json {
            return super::print_json(&rows);
        }
        let width = rows.iter().map(|row| row.id.len()).max().unwrap_or(0);
        let mut text = format!("  {:width$}  {:12}  {:>7}  {:>7}\n\n", "", "generator", "height", "leaves");
        let mut group = "";
        for row in &rows {
            if row.group != group {
                text.push_str(if group.is_empty() { "" } else { "\n" });
                text.push_str(&row.group);
                text.push_str(if row.generator == FOREST { ", for 'linden forest'\n" } else { "\n" });
                group = &row.group;
            }
            let height = row.height_m.map_or_else(String::new, |height| format!("{height:.2} m"));
            let leaves = match row.leaves {
                None => String::new(),
                Some(0) => "none".to_owned(),
                Some(leaves) => indicatif::HumanCount(leaves).to_string(),
            };
            text.push_str(&format!(
                "  {:width$}  {:12}  {height:>7}  {leaves:>7}  {}\n",
                row.id, row.generator, row.summary
            ));
        }
        super::print(&text)
    }
}

#[derive(Serialize)]
struct FormatRow {
    id: &'static str,
    name: &'static str,
    extensions: &'static [&'static str],
    media_type: &'static str,
    summary: &'static str,
}

fn exporters(json: bool) -> anyhow::Result<()> {
    let exporters = linden_exporters::exporters();
    let formats = || exporters.iter().map(|exporter| exporter.format());
    if json {
        let row = |f: &'static linden_exporters::Format| FormatRow {
            id: f.id,
            name: f.name,
            extensions: f.extensions,
            media_type: f.media_type,
            summary: f.help,
        };
        return super::print_json(&formats().map(row).collect::<Vec<_>>());
    }
    super::print(&super::export::format_table(&exporters))
}
