//! `linden forest`: several kinds of trees on a square of ground, in one file.

use std::path::{Path, PathBuf};

use anyhow::Context;
use clap::{Arg, ArgMatches, Args, Command, FromArgMatches};
use linden::forest::{FOREST_KNOBS, ForestKind, GrownForest, Layout, Places, SCATTERING, builtin_forests};
use linden::monitor::Holding;
use linden::preset::builtin;

use super::outputs::{Files, Outputs, commit, write};
use super::scene::SceneFlags;
use super::timings::{File, Subject, Telling, Timings};
use crate::exit::usage;
use crate::forecast::{ForestOutlook, announce};
use crate::progress::Progress;
use crate::source;
use crate::source::forest::{ForestFile, ForestSource, turn};
use crate::triangles;

/// Lay out a forest and write it for 3D programs
///
/// A few trees of each kind are grown, and stand in many places, turned and sized at random: files hold
/// each once, where the format can. With --compete all trees are different: they grow together, each into
/// the space or the light that the others leave.
#[derive(Args)]
#[command(after_help = after_help())]
pub struct Forest {
    /// Kinds of trees, each a preset's id or a file, with its part of all trees after a colon; or one
    /// forest: its id, a .toml file, or a file of one, which carries its recipe
    #[arg(value_name = "PRESET[:SHARE]", required = true, add = super::complete::shown())]
    kinds: Vec<String>,

    #[command(flatten)]
    layout: LayoutFlags,

    /// Turn a knob of the forest, of all kinds of trees that have it, or of a format (FORMAT.OPTION)
    #[arg(long = "set", short, value_name = "KNOB=VALUE", add = super::complete::settings())]
    settings: Vec<String>,

    #[command(flatten)]
    looks: super::Looks,

    #[command(flatten)]
    outputs: Outputs,

    /// A table of where each tree stands too, CSV: x, y, z, turn, scale, source, name, mesh; what 'linden batch --places' reads
    #[arg(long, value_name = "FILE")]
    table: Option<PathBuf>,

    #[command(flatten)]
    scene: SceneFlags,

    #[command(flatten)]
    telling: Telling,
}

/// A flag for each knob of a forest.
struct LayoutFlags {
    /// Name and value.
    set: Vec<(&'static str, String)>,
}

impl Args for LayoutFlags {
    fn augment_args(command: Command) -> Command {
        FOREST_KNOBS.iter().map(|row| &row.knob).fold(command, |command, knob| {
            let mut help = knob.help.to_owned();
            if let Some(first) = help.get_mut(..1) {
                first.make_ascii_uppercase();
            }
            let unit = if knob.unit.is_empty() { "N" } else { "M" };
            let unit = if matches!(knob.kind, linden::knob::Kind::Choice(_)) { "WORD" } else { unit };
            let flag = knob.name.replace('_', "-");
            let arg = Arg::new(knob.name).long(flag).help(help);
            command.arg(match knob.kind {
                linden::knob::Kind::Switch => {
                    arg.value_name("BOOL").num_args(0..=1).require_equals(true).default_missing_value("true")
                }
                _ => arg.value_name(unit).allow_negative_numbers(true),
            })
        })
    }

    fn augment_args_for_update(command: Command) -> Command {
        Self::augment_args(command)
    }
}

impl FromArgMatches for LayoutFlags {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, clap::Error> {
        let of = |name: &'static str| Some((name, matches.get_one::<String>(name)?.clone()));
        Ok(Self { set: FOREST_KNOBS.iter().filter_map(|row| of(row.knob.name)).collect() })
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), clap::Error> {
        *self = Self::from_arg_matches(matches)?;
        Ok(())
    }
}

impl Forest {
    pub fn run(self) -> anyhow::Result<()> {
        let progress = Progress::new();
        let timings = Timings::new();
        let (of_formats, knobs): (Vec<_>, Vec<_>) =
            super::pairs(&self.settings)?.into_iter().partition(|(name, _)| super::is_of_format(name));
        let mut sources = Vec::new();
        let mut forest = self.resolve(&mut sources, &progress)?;
        let flags = self.layout.set.iter().map(|(name, value)| ((*name).to_owned(), value.clone()));
        let turned: Vec<(String, String)> =
            knobs.into_iter().chain(self.looks.pairs()).chain(flags).collect();
        for (name, value) in &turned {
            turn(&mut forest, name, value)?;
        }
        check_scattering(&forest, &turned)?;
        let command = format!("linden forest {} -o forest.glb", self.kinds.join(" "));
        let (outputs, table) = (&self.outputs, self.table.as_deref());
        let (scene, telling) = (&self.scene, &self.telling);
        let subject = Subject::of(self.kinds.iter().map(|kind| linden::knob::printable(kind)));
        let of_formats = &of_formats;
        let written = Written { outputs, of_formats, command, scene, table, telling, timings, subject };
        written.write(&forest, sources, &turned, &progress)
    }

    /// The forest as it is described, and the files that it was read from.
    fn resolve(
        &self,
        files: &mut Vec<PathBuf>,
        progress: &Progress,
    ) -> anyhow::Result<linden::forest::Forest> {
        if let [only] = self.kinds.as_slice()
            && let Some(file) = ForestFile::find(only, progress)?
        {
            let source = file.resolve(progress)?;
            super::notes(&source.notes, progress);
            files.extend(source.files);
            return Ok(source.forest);
        }
        let mut kinds = Vec::new();
        for kind in &self.kinds {
            let (name, share) = with_share(kind)?;
            let source = source::resolve(Path::new(name), &[], progress)?;
            super::notes(&source.notes, progress);
            files.extend(source.files);
            kinds.push(ForestKind { recipe: source.recipe, share, size: 1.0 });
        }
        let mut forest = linden::forest::Forest::of(kinds.iter().map(|kind| kind.recipe.clone()).collect());
        forest.kinds = kinds;
        Ok(forest)
    }
}

/// What lays trees out by chance has no effect where each has its place.
fn check_scattering(forest: &linden::forest::Forest, turned: &[(String, String)]) -> anyhow::Result<()> {
    let without_effect = |(name, _): &&(String, String)| SCATTERING.contains(&name.as_str());
    match turned.iter().find(without_effect).filter(|_| forest.layout.places == Places::Given) {
        Some((name, _)) => Err(usage(format!(
            "'{name}' has no effect where each tree stands at its own place (places=given); 'linden forest' lays trees out by chance"
        ))),
        None => Ok(()),
    }
}

/// How a forest is to be written.
pub(super) struct Written<'a> {
    pub outputs: &'a Outputs,
    /// `FORMAT.OPTION` and value.
    pub of_formats: &'a [(String, String)],
    /// A command that would have named file and format: advice where both are missing.
    pub command: String,
    /// What stands around.
    pub scene: &'a SceneFlags,
    /// Where a table of places goes.
    pub table: Option<&'a Path>,
    /// What is said of it.
    pub telling: &'a Telling,
    /// Since the command began.
    pub timings: Timings,
    /// What it is made of.
    pub subject: Subject,
}

impl Written<'_> {
    /// Grows the trees of a forest that was read from `sources` and for which knobs were `turned`, and
    /// writes it.
    pub fn write(
        mut self,
        forest: &linden::forest::Forest,
        sources: Vec<PathBuf>,
        turned: &[(String, String)],
        progress: &Progress,
    ) -> anyhow::Result<()> {
        // What one kind leaves alone another may listen to, with the budget that a large tree gets here or without.
        let mut idle = forest.kinds.iter().flat_map(|kind| {
            let mut preset = kind.recipe.preset.clone();
            let whole = super::idle(&preset, turned);
            if preset.dressing.detail.finest() == 0 {
                preset.dressing.detail.triangles = forest.layout.triangles;
            }
            [whole, super::idle(&preset, turned)]
        });
        let first = idle.next().unwrap_or_default();
        let idle =
            idle.fold(first, |all, of_one| all.into_iter().filter(|note| of_one.contains(note)).collect());
        super::notes(&idle, progress);
        let counts = forest.kinds.iter().map(|kind| kind.recipe.preset.dressing.detail.levels());
        let most = counts.max().unwrap_or(1);
        let mut batch =
            self.outputs.open(&forest.id, &self.command, self.of_formats, Files::in_levels(most), sources)?;
        let streams = batch.streams();
        self.telling.ensure_free(streams)?;
        self.timings.lap("read");
        let plan = forest.plan(progress).with_context(|| forest.id.clone())?.wanting(batch.wanted());
        let outlook = ForestOutlook::of(&plan.trees, forest.layout.triangles, progress);
        announce(outlook.export_s(&batch.formats()), &outlook.amount());
        let inputs = plan.trees.iter().map(|tree| tree.recipe.inputs.bytes()).sum::<u64>();
        let kinds: Vec<String> = plan.trees.iter().map(|tree| tree.recipe.preset.id.clone()).collect();
        let grown = GrownForest::grow(forest, plan, progress, &mut |tree| {
            super::notes(&tree.said().collect::<Vec<_>>(), progress);
        })?;
        let stage = grown.stage().turned_by(turned.iter().map(|(name, _)| name.as_str()));
        let stage = self.scene.around(stage, progress)?;
        self.timings.count(None, triangles::of_levels(&stage));
        self.timings.lap("grow");
        let holding = Holding::new(progress, inputs);
        write(&mut batch, &stage, &holding, progress)?;
        self.timings.lap("write");
        let mut files = File::all(&commit(batch, progress)?);
        if let Some(path) = self.table {
            let text = table(&grown, &kinds);
            let shown = crate::paths::show(path);
            linden_exporters::write_file(path, text.as_bytes(), 0o666, true)
                .with_context(|| format!("writing {shown}"))?;
            files.push(File { path: shown, bytes: text.len() as u64, kept: false });
        }
        self.timings.lap("commit");
        let Self { telling, timings, mut subject, .. } = self;
        (subject.places, subject.distinct) = (Some(grown.places.len()), Some(grown.trees.len()));
        telling.tell(&timings, &subject, &files, streams, None)
    }
}

/// Where each tree of a forest stands; `kinds` are the sources of its distinct trees.
fn table(grown: &GrownForest, kinds: &[String]) -> String {
    let quoted = |text: &str| {
        if text.contains([',', '"', '\n']) {
            format!("\"{}\"", text.replace('"', "\"\""))
        } else {
            text.to_owned()
        }
    };
    let mut text = "x,y,z,turn,scale,source,name,mesh\n".to_owned();
    for place in &grown.places {
        let [x, y, z] = place.position.to_array();
        let turn = f64::from(place.turn_rad).to_degrees();
        let (kind, name) = (&kinds[place.plant], &grown.trees[place.plant].name);
        let scale = place.scale;
        let (source, name, mesh) = (quoted(kind), quoted(name), place.plant);
        text.push_str(&format!("{x},{y},{z},{turn:.4},{scale},{source},{name},{mesh}\n"));
    }
    text
}

/// The forest that a file describes, once its notes are printed.
pub(super) fn resolved(file: ForestFile, progress: &Progress) -> anyhow::Result<ForestSource> {
    let source = file.resolve(progress)?;
    super::notes(&source.notes, progress);
    Ok(source)
}

/// Several sources in one file, each tree where its own file has it; `settings` are the knobs that are turned on
/// all of them.
pub(super) fn side_by_side(
    sources: &[PathBuf],
    settings: &[(String, String)],
    written: Written<'_>,
    progress: &Progress,
) -> anyhow::Result<()> {
    // Files are named source by source, and so is the seed: here it lays nothing out.
    let is_own = |(name, _): &&(String, String)| name == "seed" || linden::preset::Preset::is_file_key(name);
    let (set, shared): (Vec<_>, Vec<_>) = settings.iter().partition(is_own);
    let set: Vec<(String, String)> = set.into_iter().cloned().collect();
    let shared: Vec<(String, String)> = shared.into_iter().cloned().collect();
    let mut recipes = Vec::new();
    let mut files = Vec::new();
    for path in sources {
        let source = source::resolve(path, &set, progress)?;
        super::notes(&source.notes, progress);
        files.extend(source.files);
        recipes.push(source.recipe);
    }
    let mut forest = linden::forest::Forest::of(recipes);
    let ids: Vec<&str> = forest.kinds.iter().map(|kind| kind.recipe.preset.id.as_str()).collect();
    forest.id = ids.join("-");
    forest.name.clone_from(&forest.id);
    forest.layout.places = Places::Given;
    forest.layout.triangles = 0;
    for (name, value) in &shared {
        turn(&mut forest, name, value)?;
    }
    check_scattering(&forest, &shared)?;
    written.write(&forest, files, settings, progress)
}

/// `fir:3`: a name and its share, 1 where none is said.
fn with_share(kind: &str) -> anyhow::Result<(&str, f64)> {
    let parsed = kind.rsplit_once(':').and_then(|(name, share)| Some((name, share.parse::<f64>().ok()?)));
    if let (None, Some((name, share))) = (parsed, kind.rsplit_once(':'))
        && builtin(name).is_ok()
    {
        let [name, share] = [name, share].map(linden::knob::printable);
        return Err(usage(format!(
            "{name}:{share}: expected a share of all trees behind the colon, like {name}:3"
        )));
    }
    match parsed {
        None => Ok((kind, 1.0)),
        Some((_, share)) if share > 0.0 && share.is_finite() => Ok(parsed.unwrap_or((kind, 1.0))),
        Some((name, share)) => Err(usage(format!(
            "{}: a share is a part of all trees and must be above 0, not {share}; leave it out for an equal \
             part, or leave out the kind",
            linden::knob::printable(&format!("{name}:{share}"))
        ))),
    }
}

fn after_help() -> String {
    let mut text = "Forests in the program:\n".to_owned();
    for forest in builtin_forests() {
        let summary = forest.heading().map(|heading| heading.summary).unwrap_or_default();
        text.push_str(&format!("  {:14}{summary}\n", forest.id));
    }
    let layout = Layout::default();
    text.push_str("\nKnobs of a forest, and what they are when nobody says:\n");
    for (knob, value) in layout.knobs() {
        let unit = if knob.knob.unit.is_empty() { String::new() } else { format!(" {}", knob.knob.unit) };
        text.push_str(&format!("  {:14}{value}{unit} ({})\n", knob.knob.name, knob.knob.kind));
    }
    text + "\nA forest's file:\n  area = 70\n  spacing = 6\n  [[tree]]\n  preset = \"fir\"\n  share = 3\n  size = 1.2"
}
