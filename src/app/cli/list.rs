//! `linden list`: the presets, and the forests of them; formats; knobs.

use clap::Args;
use linden::forest::{BuiltinForest, builtin_forest, builtin_forests};
use linden::knob::printable;
use linden::preset::{Heading, builtin, builtins, check_tag};
use serde::Serialize;

use super::{complete, knob};
use crate::config::dirs::Dirs;
use crate::config::presets::{self, FOREST, UserPreset};
use crate::config::session::SessionFile;
use crate::paths::show;
use crate::progress::Progress;
use crate::{exit, source};

/// List the presets with what they grow to, and the forests; or the export formats; or the knobs
#[derive(Args)]
pub struct List {
    /// Machine-readable
    #[arg(long)]
    json: bool,

    /// List the export formats instead
    #[arg(long)]
    exporters: bool,

    /// Only what has this tag, in its document or from the workbench (key #); may be given several times
    #[arg(long = "tag", value_name = "TAG", conflicts_with_all = ["exporters", "knobs"])]
    tags: Vec<String>,

    /// List the knobs instead; with a name, say at length what that one does
    #[arg(long, value_name = "KNOB", num_args = 0..=1, default_missing_value = "")]
    #[arg(conflicts_with = "exporters", add = complete::knobs())]
    knobs: Option<String>,
}

/// The group of forests.
pub(super) const FORESTS: &str = "forests";

#[derive(Serialize)]
struct PresetRow {
    id: String,
    name: String,
    group: String,
    generator: &'static str,
    /// What was measured of a built-in preset; `null` for what must be grown to be measured.
    height_m: Option<f64>,
    leaves: Option<u64>,
    summary: String,
    source: String,
    /// Those of its document, then those that the user gave it in the workbench.
    tags: Vec<String>,
    /// The file of a preset of the user's.
    path: Option<String>,
    /// Why it cannot be grown.
    problem: Option<String>,
    /// What SOURCE is, where that is not the id.
    #[serde(skip)]
    named: Option<String>,
    /// The path as the workbench remembers it.
    #[serde(skip)]
    file: Option<String>,
}

impl List {
    pub fn run(self) -> anyhow::Result<()> {
        if self.exporters {
            return exporters(self.json);
        }
        match self.knobs.as_deref() {
            Some("") => return knob::all(self.json),
            Some(name) => return knob::one(name, self.json),
            None => {}
        }
        let forest = |forest: &'static BuiltinForest| {
            let Heading { name, summary, .. } =
                forest.heading().map_err(|fault| source::locate(forest.id, &fault))?;
            Ok(PresetRow {
                id: forest.id.to_owned(),
                name,
                group: FORESTS.to_owned(),
                generator: FOREST,
                height_m: None,
                leaves: None,
                summary,
                source: String::new(),
                tags: Vec::new(),
                path: None,
                problem: None,
                named: None,
                file: None,
            })
        };
        let rows = builtins()
            .iter()
            .map(|builtin| {
                let Heading { name, group, summary, source, tags, generator } = builtin.heading()?;
                let (height_m, leaves) = builtin.size.map(|size| (size.height_m, size.leaves)).unzip();
                Ok(PresetRow {
                    id: builtin.id.to_owned(),
                    name,
                    group,
                    generator: generator.unwrap_or_default(),
                    height_m,
                    leaves,
                    summary,
                    source,
                    tags,
                    path: None,
                    problem: None,
                    named: None,
                    file: None,
                })
            })
            .chain(builtin_forests().iter().map(forest))
            .chain(users().into_iter().map(Ok))
            .collect::<anyhow::Result<Vec<PresetRow>>>()?;
        let rows = tagged(rows, &self.tags)?;
        if self.json {
            return super::print_json(&rows);
        }
        let ids = rows.iter().filter(|row| row.named.is_none());
        let width = ids.map(|row| row.id.chars().count()).max().unwrap_or(0);
        // Columns by `format!`: rows stand in groups, and crates of tables draw frames that scripts would have to cut.
        let mut text = format!("  {:width$}  {:12}  {:>7}  {:>7}\n\n", "", "generator", "height", "organs");
        let mut group = "";
        for row in &rows {
            if row.group != group {
                text.push_str(if group.is_empty() { "" } else { "\n" });
                text.push_str(&printable(&row.group));
                text.push_str(if row.generator == FOREST && row.path.is_none() {
                    ", for 'linden forest'\n"
                } else {
                    "\n"
                });
                group = &row.group;
            }
            let height = row.height_m.map_or_else(String::new, |height| format!("{height:.2} m"));
            let leaves = match row.leaves {
                None => String::new(),
                Some(0) => "none".to_owned(),
                Some(leaves) => indicatif::HumanCount(leaves).to_string(),
            };
            let id = printable(row.named.as_deref().unwrap_or(&row.id));
            let summary = printable(row.problem.as_deref().unwrap_or(&row.summary));
            let mut line =
                format!("  {id:width$}  {:12}  {height:>7}  {leaves:>7}  {summary}", row.generator);
            for tag in &row.tags {
                line.push_str("  #");
                line.push_str(&printable(tag));
            }
            text.push_str(line.trim_end());
            text.push('\n');
        }
        super::print(&text)
    }
}

/// The rows with the user's tags; those alone that have all of the wanted ones, where any are wanted.
fn tagged(mut rows: Vec<PresetRow>, wanted: &[String]) -> anyhow::Result<Vec<PresetRow>> {
    let wanted: Vec<&str> = wanted.iter().map(|tag| tag.trim_start_matches('#')).collect();
    for tag in &wanted {
        check_tag(tag).map_err(exit::usage)?;
    }
    let given = SessionFile::load(Dirs::of_environment().session()).1.tags;
    for row in &mut rows {
        let key = row.file.as_deref().unwrap_or(&row.id);
        let more = given.get(key).into_iter().flatten().filter(|tag| !row.tags.contains(tag));
        let more: Vec<String> = more.cloned().collect();
        row.tags.extend(more);
    }
    let has = |row: &PresetRow| wanted.iter().all(|tag| row.tags.iter().any(|known| known == tag));
    rows.retain(has);
    Ok(rows)
}

/// The user's presets. An id that a built-in preset or another file has means that one, or neither: such
/// a preset is named by its file.
fn users() -> Vec<PresetRow> {
    let Some(dir) = Dirs::of_environment().presets() else { return Vec::new() };
    let (found, complaints) = presets::list(&dir, &Progress::new());
    for complaint in complaints {
        exit::say(&format!("note: {complaint}"));
    }
    let is_alone = |id: &str| found.iter().filter(|preset| preset.id == id).count() == 1;
    let row = |preset: &UserPreset| PresetRow {
        id: preset.id.clone(),
        name: preset.name.clone(),
        group: preset.group.clone(),
        generator: preset.generator,
        height_m: None,
        leaves: None,
        summary: preset.summary.clone(),
        source: preset.source.clone(),
        tags: preset.tags.clone(),
        path: Some(show(&preset.path)),
        problem: preset.state.as_ref().err().map(|complaint| format!("cannot be grown: {complaint}")),
        named: (builtin(&preset.id).is_ok() || builtin_forest(&preset.id).is_ok() || !is_alone(&preset.id))
            .then(|| show(&preset.path)),
        file: Some(preset.path.to_string_lossy().into_owned()),
    };
    found.iter().map(row).collect()
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
    let exporters = crate::formats::exporters();
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
