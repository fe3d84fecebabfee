//! `linden show`: what a source or a forest is, its knobs, its forecast.

use std::collections::BTreeMap;

use clap::Args;
use clap::builder::ArgPredicate;
use linden::knob::{Value, printable};
use linden::preset::{Age, LSystem, Preset, PresetKnob, Section};
use linden::recipe::Recipe;
use serde::Serialize;

use super::axes::AxisList;
use super::forest_page::{self, As};
use super::size::{SizeRow, count};
use super::{GrowArgs, complete};
use crate::exit::usage;
use crate::forecast::Outlook;
use crate::progress::Progress;
use crate::source::forest::ForestFile;

/// Say what a source is, which knobs it has, and how large it would grow; or what a program reads
#[derive(Args)]
#[command(mut_arg("source", |source| {
    source.required(false).required_unless_present("client").default_value_if("client", ArgPredicate::IsPresent, "-")
}))]
#[expect(clippy::struct_excessive_bools, reason = "each is a flag of its own")]
pub struct Show {
    #[command(flatten)]
    growing: GrowArgs,

    /// Machine-readable
    #[arg(long, conflicts_with = "toml")]
    json: bool,

    /// As a preset document, to be edited and grown
    #[arg(long)]
    toml: bool,

    /// Only what differs from the defaults: of the knobs, or of the document with --toml
    #[arg(long)]
    changed: bool,

    /// Grow it, and list its axes by the paths that edits name them with (--edit), and nothing else
    #[arg(long, conflicts_with_all = ["toml", "changed", "derive"])]
    axes: bool,

    /// The string that a grammar derives in so many steps, and nothing else; with --json module by module, with the
    /// rule that wrote each, what it was one step before, and what the turtle drew for it
    #[arg(long, value_name = "STEPS", conflicts_with_all = ["toml", "changed"])]
    derive: Option<u32>,

    /// What this program reads of files, and the options that --for sets for it; without a source
    #[arg(long = "for", id = "client", value_name = "CLIENT", add = complete::clients(),
        conflicts_with_all = ["toml", "changed", "axes", "derive"])]
    client: Option<String>,
}

#[derive(Serialize)]
struct ShownPreset<'a> {
    source: &'a str,
    id: &'a str,
    name: &'a str,
    group: &'a str,
    summary: &'a str,
    origin: &'a str,
    about: &'a str,
    generator: &'static str,
    /// Those of further kinds of foliage are named by their addresses, `also.1.leaf_keep`.
    knobs: Vec<KnobRow>,
    /// The further kinds of foliage.
    kinds: Vec<KindRow>,
    /// Of a grammar's `#define` lines; empty for what is no grammar.
    constants: Vec<ConstantRow>,
    /// Those that it names, from the youngest to the oldest.
    ages: Vec<AgeRow>,
    forecast: Option<ForecastRow>,
    recipe: serde_json::Value,
}

/// A constant of a grammar.
#[derive(Serialize)]
struct ConstantRow {
    name: String,
    /// As it is written: a number, or an expression of constants before it.
    written: String,
    value: f64,
}

/// An age that has a name.
#[derive(Serialize)]
struct AgeRow {
    name: String,
    /// Knobs, and what they are turned to.
    turns: BTreeMap<String, String>,
}

impl AgeRow {
    fn of(age: &Age) -> Self {
        let turns = age.turns().map(|(knob, to)| (knob.to_owned(), to)).collect();
        Self { name: age.name.clone(), turns }
    }
}

/// A further kind of foliage.
#[derive(Serialize)]
struct KindRow {
    /// What its knobs' names begin with.
    address: String,
    /// What else they may begin with.
    label: String,
}

fn kinds(preset: &Preset) -> Vec<KindRow> {
    let row = |(i, label)| KindRow { address: format!("also.{}", i + 1), label };
    preset.kind_labels().into_iter().enumerate().map(row).collect()
}

fn constants(preset: &Preset) -> Vec<ConstantRow> {
    let all = preset.settings::<LSystem>().map_or_else(Vec::new, |settings| settings.grammar.constants());
    all.into_iter()
        .map(|(name, written, value)| ConstantRow { name: name.to_owned(), written, value })
        .collect()
}

#[derive(Serialize)]
struct KnobRow {
    name: &'static str,
    /// Without its kind of foliage.
    #[serde(skip)]
    short_name: &'static str,
    /// The number of its kind of foliage, from 0, where it is a further one.
    #[serde(skip)]
    kind: Option<usize>,
    section: &'static str,
    value: String,
    /// What each seed draws it from.
    #[serde(skip_serializing_if = "Option::is_none")]
    spread: Option<String>,
    unit: &'static str,
    range: String,
    /// Whether the unit belongs behind the value (`auto` and `17D` have none).
    #[serde(skip)]
    is_number: bool,
    help: &'static str,
    /// Whether it differs from its default.
    #[serde(rename = "changed")]
    is_changed: bool,
}

/// What is not known, or does not apply, is `null`.
#[derive(Serialize)]
struct ForecastRow {
    /// Of an L-system: length of the derived string, segments drawn, branches open at once.
    symbols: Option<f64>,
    segments: Option<f64>,
    depth: Option<u64>,
    /// Whether symbols and segments are exact; without these, nodes, leaves and triangles.
    exact: bool,
    /// Whether there may be more symbols and segments.
    at_least: bool,
    #[serde(flatten)]
    size: Option<SizeRow>,
    /// Of nodes and skeleton, without a surface.
    memory_bytes: Option<u64>,
}

impl Show {
    pub fn run(self) -> anyhow::Result<()> {
        let progress = Progress::new();
        if let Some(client) = &self.client {
            return super::client::show(client, self.json);
        }
        if let Some(named) = self.growing.source.to_str()
            && let Some(forest) = ForestFile::find(named, &progress)?
        {
            self.growing.without_defines("a forest has several trees")?;
            self.growing.without_edits("a forest has several trees")?;
            self.growing.without_age("a forest has several trees")?;
            if self.axes {
                return Err(usage("--axes is for one tree, and a forest has several"));
            }
            if self.derive.is_some() {
                return Err(usage("--derive is for one grammar, and a forest has several trees"));
            }
            let how = match (self.json, self.toml) {
                (true, _) => As::Json,
                (_, true) => As::Document,
                _ => As::Page,
            };
            if self.changed {
                return Err(usage(
                    "--changed is for one tree: a forest's page and document name what it says",
                ));
            }
            return forest_page::show(forest, &self.growing.pairs()?, how, &progress);
        }
        if let Some(steps) = self.derive {
            let source = self.growing.resolve_string(&progress)?;
            return super::derivation::show(&source.recipe.preset, steps, self.json, &progress);
        }
        let source = self.growing.resolve(&progress)?;
        let preset = &source.recipe.preset;
        if self.axes {
            let list = AxisList::of(&super::grown(&source, &progress)?);
            return if self.json { super::print_json(&list) } else { super::print(&list.text()) };
        }
        if self.toml {
            let text = if self.changed { preset.to_toml_changed()? } else { preset.to_toml()? };
            return super::print(&text);
        }
        let plain = preset.plain().all_knobs();
        // A crown's shape is what grows, no matter of defaults.
        let is_default = |knob: &PresetKnob, value: &Value| {
            knob.knob.name != "crown"
                && plain.iter().any(|(other, default)| other.knob.name == knob.knob.name && default == value)
        };
        let knobs: Vec<KnobRow> = preset
            .all_knobs()
            .into_iter()
            .map(|(knob, value): (_, Value)| KnobRow {
                is_changed: !is_default(&knob, &value),
                name: knob.knob.name,
                short_name: knob.short_name(),
                kind: if let Section::Kind(kind) = knob.section { Some(kind) } else { None },
                section: knob.section.key(),
                is_number: matches!(value, Value::Real(_) | Value::Integer(_) | Value::Vector(_)),
                value: value.to_string(),
                spread: preset.spread(&knob).map(ToString::to_string),
                unit: knob.knob.unit,
                range: knob.knob.kind.to_string(),
                help: knob.knob.help,
            })
            .filter(|row| row.is_changed || !self.changed)
            .collect();
        let forecast = forecast_of(&source.recipe, &progress)?;
        if self.json {
            return super::print_json(&ShownPreset {
                source: &source.shown,
                id: &preset.id,
                name: &preset.name,
                group: &preset.group,
                summary: &preset.summary,
                origin: &preset.source,
                about: &preset.about,
                generator: preset.grows_by().id(),
                knobs,
                kinds: kinds(preset),
                constants: constants(preset),
                ages: preset.ages().iter().map(AgeRow::of).collect(),
                forecast,
                recipe: serde_json::to_value(&source.recipe)?,
            });
        }
        super::print(&page(&source.recipe, &knobs, forecast.as_ref(), self.changed))
    }
}

/// Symbols by the growth matrix where these are few enough to be counted, the rest from a sample.
fn forecast_of(recipe: &Recipe, progress: &Progress) -> anyhow::Result<Option<ForecastRow>> {
    let outlook = Outlook::of(recipe, progress);
    let size = outlook.as_ref().map(|outlook| outlook.size(recipe));
    let is_whole = outlook.as_ref().is_some_and(|outlook| outlook.sample.is_whole());
    let sampled = outlook.as_ref().and_then(|outlook| outlook.sample.skeleton_bytes());
    let Some(lsystem) = recipe.preset.settings::<LSystem>() else {
        let row = |size| ForecastRow {
            symbols: None,
            segments: None,
            depth: None,
            exact: is_whole,
            at_least: false,
            size: Some(size),
            memory_bytes: sampled,
        };
        return Ok(size.map(row));
    };
    let counted = lsystem.forecast()?;
    let grown = outlook.as_ref().filter(|outlook| counted.at_least || outlook.sample.is_whole());
    let symbols = grown.and_then(|outlook| outlook.sample.symbols()).unwrap_or(counted.symbols as f64);
    let segments = match grown {
        Some(outlook) if counted.at_least => outlook.sample.segments(),
        _ => counted.segments as f64,
    };
    Ok(Some(ForecastRow {
        symbols: Some(symbols),
        segments: Some(segments),
        depth: Some(counted.depth),
        exact: counted.exact || grown.is_some_and(|outlook| outlook.sample.wood_times == 1.0),
        at_least: counted.at_least && grown.is_none(),
        size,
        memory_bytes: sampled.or_else(|| counted.skeleton_bytes()),
    }))
}

fn page(recipe: &Recipe, knobs: &[KnobRow], forecast: Option<&ForecastRow>, only_changed: bool) -> String {
    let preset = &recipe.preset;
    let mut text = format!("{} ({})\n", printable(&preset.name), printable(&preset.id));
    for line in [&preset.summary, &preset.source, &preset.about].into_iter().filter(|line| !line.is_empty()) {
        text.push_str(&format!("{}\n", printable(line)));
    }
    for passage in preset.generator.describe(&recipe.inputs) {
        text.push_str(&format!("\n{}\n", passage.heading));
        passage.lines.iter().for_each(|line| text.push_str(&format!("  {}\n", printable(line))));
    }
    if let Some(forecast) = forecast {
        text.push_str(&forecast.lines());
    }
    if !preset.ages().is_empty() {
        text.push_str("\nages (--ages NAME)\n");
        for age in preset.ages() {
            let turns: Vec<String> = age.turns().map(|(knob, to)| format!("{knob}={to}")).collect();
            text.push_str(&format!("  {}: {}\n", age.name, turns.join(" ")));
        }
    }
    if !preset.edits.is_empty() {
        text.push_str("\nedits of the wood\n");
        preset.edits.iter().for_each(|edit| text.push_str(&format!("  {edit}\n")));
    }
    let [name_width, value_width] = [
        knobs.iter().map(|row| row.short_name.len()).max().unwrap_or(0),
        knobs.iter().map(|row| row.value.len() + row.unit.len() + 1).max().unwrap_or(0).min(24),
    ];
    for section in Section::all() {
        let rows: Vec<&KnobRow> = knobs.iter().filter(|row| row.section == section.key()).collect();
        let is_shown = |key: &str| !only_changed || preset.file(key).is_some();
        let files: Vec<_> =
            Preset::file_keys().filter(|(of, key, _)| *of == section && is_shown(key)).collect();
        if rows.is_empty() && files.is_empty() {
            continue;
        }
        text.push_str(&format!("\n{}\n", if section.key().is_empty() { "tree" } else { section.key() }));
        for row in rows {
            let value = if row.is_number { format!("{} {}", row.value, row.unit) } else { row.value.clone() };
            text.push_str(&format!(
                "  {:name_width$}  {:value_width$}  {}\n",
                row.name,
                value.trim_end(),
                row.help
            ));
            let spread = row.spread.as_ref().map(|spread| format!("; each seed draws from {spread}"));
            text.push_str(&format!(
                "  {:name_width$}  {:value_width$}  {}{}\n",
                "",
                "",
                row.range,
                spread.unwrap_or_default()
            ));
        }
        for (_, key, help) in files {
            let value = preset.file(key).map_or_else(|| "none".to_owned(), |file| with_extent(recipe, file));
            text.push_str(&format!("  {key:name_width$}  {value:value_width$}  {help}\n"));
        }
        if section == Section::Foliage {
            text.push_str(&further_kinds(recipe, knobs, name_width, value_width));
        }
    }
    text
}

/// A file as a page names it: what is in it, too.
fn with_extent(recipe: &Recipe, file: &str) -> String {
    let extent = recipe.input(file).map(|input| format!(": {}", input.extent())).unwrap_or_default();
    printable(file) + &extent
}

/// The further kinds of foliage with their knobs. What these take stands above, with the first kind's.
fn further_kinds(recipe: &Recipe, knobs: &[KnobRow], name_width: usize, value_width: usize) -> String {
    let mut text = String::new();
    for (i, KindRow { address, label }) in kinds(&recipe.preset).iter().enumerate() {
        let called = if label == address { String::new() } else { format!(", '{label}'") };
        text.push_str(&format!("\nfoliage.also {}{called}: --set {label}.leaf_keep=0\n", i + 1));
        for row in knobs.iter().filter(|row| row.kind == Some(i)) {
            let value = if row.is_number { format!("{} {}", row.value, row.unit) } else { row.value.clone() };
            let (name, value) = (row.short_name, value.trim_end());
            text.push_str(&format!("  {name:name_width$}  {value:value_width$}  {}\n", row.help));
        }
        for (key, file) in recipe.preset.kind_files(i) {
            text.push_str(&format!("  {key:name_width$}  {}\n", with_extent(recipe, file)));
        }
    }
    text
}

impl ForecastRow {
    fn lines(&self) -> String {
        let mut text = "\nforecast\n".to_owned();
        if let (Some(symbols), Some(segments), Some(depth)) = (self.symbols, self.segments, self.depth) {
            let about = match self {
                Self { at_least: true, .. } => "at least ",
                Self { exact: true, .. } => "",
                _ => "about ",
            };
            let deep = if self.at_least { about } else { "" };
            let [symbols, segments] = [symbols, segments].map(count);
            text.push_str(&format!(
                "  {about}{symbols} symbols, {about}{segments} segments, branches nested {deep}{depth} deep\n"
            ));
        }
        if let Some(size) = &self.size {
            text.push_str(&size.lines());
        }
        if let Some(bytes) = self.memory_bytes {
            let about = if self.at_least { "at least" } else { "about" };
            text.push_str(&format!(
                "  {about} {} of memory for its skeleton\n",
                linden::memory::Bytes(bytes)
            ));
        }
        text
    }
}
