//! `linden export`: grow a source and write it in one or more formats.

use std::path::PathBuf;
use std::sync::Arc;

use anyhow::Context;
use clap::Args;
use linden::dress::{levels, year};
use linden::monitor::Holding;
use linden::preset::InputTrees;
use linden::recipe::Recipe;
use linden::season::Season;
use linden::texture::DrawnPictures;
use linden_exporters::{Batch, Exporter, REGISTRY};

use super::ages::aged;
use super::crew::room_for_pictures;
use super::forest::{Written, side_by_side};
use super::outputs::{Files, Outputs, commit, of_age, write_age};
use super::placing::explained;
use super::plot::{Plot, USUAL_FORMAT};
use super::scene::SceneFlags;
use super::timings::{File, Subject, Telling, Timings};
use super::{GrowArgs, complete};
use crate::cache;
use crate::exit::usage;
use crate::forecast::Outlook;
use crate::progress::Progress;
use crate::source::Source;
use crate::triangles;

/// Grow a source and write it for 3D programs
///
/// A scan whose points say which tree they belong to, or a table of cylinders of several trees, becomes one tree a file in a
/// directory (-o trees/), with a table of what was measured on them, trees.csv; --set tree=N (`table_tree=N`) takes one.
#[derive(Args)]
#[command(after_help = after_help())]
pub struct Export {
    #[command(flatten)]
    growing: GrowArgs,

    /// Further sources for the same files, each tree where its own mesh, scan or root has it; --set turns the
    /// knobs of all of them. 'linden forest' lays trees out
    #[arg(value_name = "SOURCE", add = complete::sources())]
    further: Vec<PathBuf>,

    #[command(flatten)]
    outputs: Outputs,

    #[command(flatten)]
    budget: super::Budget,

    #[command(flatten)]
    looks: super::Looks,

    /// The same wood with the leaves of several seasons: names, or names with values of the knob `season`
    /// like spring=0.05; all is all named ones, as when none is given, and one file where nothing on the plant changes with
    /// them. USD holds them as variants, every other format has a file for each
    #[arg(long, value_name = "LIST", num_args = 0..=1, default_missing_value = "all", add = complete::seasons())]
    seasons: Option<String>,

    /// The plant at several ages: names that the source has for them ('linden show'), names with a share of its growth
    /// like half=0.5, or years like 10y where it grows by them; all that it names when none is given. Each has a file;
    /// USD has one over them too, with the ages as variants
    #[arg(long, value_name = "LIST", num_args = 0..=1, default_missing_value = "all")]
    ages: Option<String>,

    #[command(flatten)]
    scene: SceneFlags,

    #[command(flatten)]
    telling: Telling,
}

/// Names and values.
type Pairs = Vec<(String, String)>;

impl Export {
    pub fn run(self) -> anyhow::Result<()> {
        let progress = Progress::new();
        let mut timings = Timings::new();
        let (settings, of_formats) = self.pairs()?;
        let seasons = match self.seasons.as_deref() {
            None => Vec::new(),
            Some(list) => Season::parse_list(list).map_err(usage)?,
        };
        if !self.further.is_empty() {
            return self.several(&settings, &of_formats, timings, &progress);
        }
        let source = self.growing.resolve_in(&settings, &seasons, &progress)?;
        if self.outputs.folder().is_some() {
            let Recipe { preset, inputs, .. } = &source.recipe;
            let trees = preset.trees(inputs, &progress).with_context(|| source.shown.clone())?;
            if let Some(trees) = trees {
                return self.plot(source, trees, &settings, &of_formats, timings, &progress);
            }
        }
        let id = &source.recipe.preset.id;
        let command = format!("linden export {0} -o {0}.glb", crate::paths::show(&self.growing.source));
        let ages = match &self.ages {
            Some(list) => {
                self.growing.without_age("name all of them with --ages")?;
                aged(&source, list, &settings)?
            }
            None => Vec::new(),
        };
        let seasons = self.distinct(
            seasons,
            std::iter::once(&source).chain(ages.iter().map(|(_, aged)| aged)),
            &progress,
        );
        let names: Vec<&str> = ages.iter().map(|(name, _)| name.as_str()).collect();
        let levels = source.recipe.preset.dressing.detail.levels();
        let files = Files { levels, seasons: &seasons, ages: &names };
        let mut batch = self.outputs.open(id, &command, &of_formats, files, source.files.clone())?;
        let streams = batch.streams();
        self.telling.ensure_free(streams)?;
        // Each age has its own triangles.
        let is_one = names.is_empty();
        timings.lap("read");
        let made = Made { settings: &settings, seasons: &seasons, scene: &self.scene };
        if ages.is_empty() {
            made.write(None, source.clone(), &mut batch, &mut timings, &progress)?;
        } else {
            // What does not change with age is drawn once.
            let drawn = Arc::new(cache::pictures(DrawnPictures::new(room_for_pictures(&progress))));
            for (name, mut source) in ages {
                source.recipe = source.recipe.drawn_into(&drawn);
                made.write(Some(&name), source, &mut batch, &mut timings, &progress)?;
            }
            batch.gather(&progress).map_err(explained)?;
            timings.lap("gather");
        }
        let has_surface = batch.formats().iter().any(|(format, _)| format.holds.surface);
        let written = commit(batch, &progress)?;
        timings.lap("commit");
        // Where some number of them was asked for.
        let is_asked = is_one && has_surface && !source.recipe.preset.dressing.detail.is_whole();
        let triangles = triangles::told(timings.triangles()).filter(|_| is_asked);
        let subject = Subject::of([source.shown]);
        self.telling.tell(&timings, &subject, &File::all(&written), streams, triangles.as_deref())
    }

    /// What knobs are turned to, then what options of formats are set to.
    fn pairs(&self) -> anyhow::Result<(Pairs, Pairs)> {
        let (settings, of_formats): (Pairs, Pairs) =
            self.growing.pairs()?.into_iter().partition(|(name, _)| !super::is_of_format(name));
        // What the program that files are for wants of the plant comes first, so that all else holds against it.
        let of_client = self.outputs.profile()?.map_or(&[][..], |profile| profile.knobs);
        let of_client = of_client.iter().map(|(name, value)| ((*name).to_owned(), (*value).to_owned()));
        let settings = of_client.chain(settings).chain(self.budget.pair()).chain(self.looks.pairs());
        Ok((settings.collect(), of_formats))
    }

    /// All sources in one file. What is for one of them is refused.
    fn several(
        &self,
        settings: &[(String, String)],
        of_formats: &[(String, String)],
        timings: Timings,
        progress: &Progress,
    ) -> anyhow::Result<()> {
        self.growing.without_defines("export each by itself")?;
        self.growing.without_edits("export each by itself")?;
        self.growing.without_age("export each by itself")?;
        if self.ages.is_some() {
            return Err(usage("--ages is for one source: export each by itself"));
        }
        if self.seasons.is_some() {
            return Err(usage(
                "--seasons is for one source: export each by itself, or turn all to one with --set season=summer",
            ));
        }
        let sources: Vec<PathBuf> =
            std::iter::once(&self.growing.source).chain(&self.further).cloned().collect();
        let named: Vec<String> = sources.iter().map(|path| crate::paths::show(path)).collect();
        let command = format!("linden export {} -o wood.glb", named.join(" "));
        let (outputs, scene, telling) = (&self.outputs, &self.scene, &self.telling);
        let subject = Subject::of(named);
        let written = Written { outputs, of_formats, command, scene, table: None, telling, timings, subject };
        side_by_side(&sources, settings, written, progress)
    }

    /// The seasons that are written: where all are asked for, and none differs on the plant at any of its ages, none,
    /// which is one file. Those that are asked for by name are written at any rate: who names them counts on the files.
    fn distinct<'s>(
        &self,
        seasons: Vec<Season>,
        mut sources: impl Iterator<Item = &'s Source>,
        progress: &Progress,
    ) -> Vec<Season> {
        let changes = |source: &Source| source.recipe.preset.dressing.foliage.changes_with_seasons();
        if self.seasons.as_deref().map(str::trim) != Some("all") || sources.any(changes) {
            return seasons;
        }
        let note = "seasons: nothing on this plant changes with them: it is written once, without a season's name; \
                    --seasons flush,summer,autumn,bare writes each";
        super::notes(&[note.to_owned()], progress);
        Vec::new()
    }

    /// Each tree of an input that tells several apart, in files of its own.
    fn plot(
        mut self,
        source: Source,
        trees: InputTrees,
        settings: &[(String, String)],
        of_formats: &[(String, String)],
        timings: Timings,
        progress: &Progress,
    ) -> anyhow::Result<()> {
        if self.seasons.is_some() || self.ages.is_some() {
            let knob = trees.knob;
            return Err(usage(format!(
                "--seasons and --ages are for one tree: say which with --set {knob}=N"
            )));
        }
        self.outputs.with_usual(USUAL_FORMAT);
        let Some(folder) = self.outputs.folder() else { return Ok(()) };
        let turned = settings.iter().map(|(name, _)| name.as_str()).collect();
        let (outputs, scene, telling) = (&self.outputs, &self.scene, &self.telling);
        Plot { source, trees, folder, outputs, of_formats, turned, scene, telling }.write(timings, progress)
    }
}

/// How a source is made into files.
struct Made<'a> {
    /// Knobs that were turned.
    settings: &'a [(String, String)],
    seasons: &'a [Season],
    scene: &'a SceneFlags,
}

impl Made<'_> {
    /// Grows a source, at one of its ages if there are several, and writes its files under temporary names.
    fn write(
        &self,
        age: Option<&str>,
        mut source: Source,
        batch: &mut Batch,
        timings: &mut Timings,
        progress: &Progress,
    ) -> anyhow::Result<()> {
        let place = age.map_or_else(|| source.shown.clone(), |age| format!("{}, {age}", source.shown));
        if let Some(outlook) = Outlook::of(&source.recipe, progress) {
            let seconds = outlook.export_s(&source.recipe, &batch.formats(), self.seasons.len());
            outlook.announce(seconds);
        }
        source.recipe = source.recipe.wanting(batch.wanted());
        let grown = super::grown_and_drawn(&source, progress)?;
        timings.lap_of("grow", age);
        let (one, several);
        let (stage, notes) = if self.seasons.is_empty() {
            one = levels(&source.recipe, &grown, progress).with_context(|| place.clone())?;
            (one.stage(), &one.notes)
        } else {
            several = year(&source.recipe, &grown, self.seasons, progress).with_context(|| place.clone())?;
            (several.stage(), &several.notes)
        };
        super::notes(&of_age(age, notes), progress);
        timings.count(age, triangles::of_levels(&stage));
        let stage = stage.turned_by(self.settings.iter().map(|(name, _)| name.as_str()));
        let stage = self.scene.around(stage, progress)?;
        // Scenes have taken what they need of it.
        drop(grown);
        timings.lap_of("dress", age);
        let holding = Holding::new(progress, source.recipe.inputs.bytes());
        write_age(batch, age, &stage, &holding, progress)?;
        timings.lap_of("write", age);
        Ok(())
    }
}

/// Formats with what they are good for and their options.
pub fn format_table(exporters: &[&'static dyn Exporter]) -> String {
    let mut text = String::new();
    for format in exporters.iter().map(|exporter| exporter.format()) {
        text.push_str(&format!("  {:14}{}\n", format.id, format.help));
        for spec in format.options {
            let name = format!("{}.{}", format.id, spec.knob.name);
            text.push_str(&format!(
                "  {:14}  {name}={}: {} ({})\n",
                "", spec.default, spec.knob.help, spec.knob.kind
            ));
        }
    }
    text
}

fn after_help() -> String {
    format!(
        "Formats, and options of formats (--set FORMAT.OPTION=VALUE):\n{}\n\
         Any other format FOO is written by the program linden-export-FOO on the search path.\n\
         Files appear whole or not at all, side files with their main file, and are on the disk when linden \
         ends (unless --no-sync). Existing files are replaced, links written through, write-protected files \
         refused.",
        format_table(REGISTRY)
    )
}
