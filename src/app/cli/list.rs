//! `linden list`: the presets.

use clap::Args;
use linden::preset::{Preset, builtins};
use serde::Serialize;

/// List the presets, or the export formats
#[derive(Args)]
pub struct List {
    /// Machine-readable
    #[arg(long)]
    json: bool,

    /// List the export formats instead
    #[arg(long)]
    exporters: bool,
}

#[derive(Serialize)]
struct Row {
    id: String,
    name: String,
    group: String,
    generator: &'static str,
    summary: String,
    source: String,
}

impl List {
    pub fn run(self) -> anyhow::Result<()> {
        if self.exporters {
            return exporters(self.json);
        }
        let rows = builtins()
            .iter()
            .map(|builtin| {
                let Preset { id, name, group, summary, source, generator, .. } = builtin.load()?;
                Ok(Row { id, name, group, generator: generator.id(), summary, source })
            })
            .collect::<anyhow::Result<Vec<Row>>>()?;
        if self.json {
            return super::print_json(&rows);
        }
        let width = rows.iter().map(|row| row.id.len()).max().unwrap_or(0);
        let mut text = String::new();
        let mut group = "";
        for row in &rows {
            if row.group != group {
                text.push_str(if group.is_empty() { "" } else { "\n" });
                text.push_str(&row.group);
                text.push('\n');
                group = &row.group;
            }
            text.push_str(&format!("  {:width$}  {}\n", row.id, row.summary));
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
