//! Where a command writes its files: shared by all that export.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use clap::Args;
use linden::Monitor;
use linden::season::Season;
use linden::stage::Stage;
use linden_exporters::{Exporter, Options, Profile, REGISTRY};

use super::placing::{Placing, as_sole_output, explained, in_folder, is_dash, is_folder, waiting};

use super::complete;
use super::timings::File;
use crate::exit::{say, usage};
use crate::formats::{find, for_path};
use crate::portrait;
use crate::progress::Progress;
use linden_exporters::{Batch, Output, Written, default_name};

/// What is written where.
#[derive(Args)]
pub struct Outputs {
    /// Write this file, in the format of its ending, or into this directory, with --format; may be given
    /// several times; - is standard output
    #[arg(short, long, value_name = "PATH")]
    output: Vec<PathBuf>,

    /// Write these formats: one for all outputs, or one for each; without -o to SOURCE.ENDING
    #[arg(long, value_name = "FORMAT", value_delimiter = ',', add = complete::formats())]
    format: Vec<String>,

    /// For a program: options that suit it, in the format that it reads best where none is named ('linden show --for
    /// CLIENT' prints them). Other options hold against it
    #[arg(long = "for", value_name = "CLIENT", add = complete::clients())]
    client: Option<String>,

    /// How levels of detail are told; the same as --set FORMAT.lods=WAY for each format that has it
    #[arg(long, value_name = "WAY", add = complete::values_of_option("lods"))]
    lods_as: Option<String>,

    /// Shapes for physics; the same as --set FORMAT.collision=SHAPES for each format that has it
    #[arg(long, value_name = "SHAPES", num_args = 0..=1, default_missing_value = "capsules", add = complete::values_of_option("collision"))]
    collision: Option<String>,

    /// Leaves, in a forest whole trees, as few meshes in many places; the same as --set FORMAT.instances=true
    /// for each format that has it
    #[arg(long)]
    instances: bool,

    /// Vertices in fewer bits; the same as --set FORMAT.quantize=true for each format that has it
    #[arg(long)]
    quantize: bool,

    /// Vertices and indices in fewer bytes (meshopt); the same as --set FORMAT.compress=METHOD for each
    /// format that has it
    #[arg(long, value_name = "METHOD", add = complete::values_of_option("compress"))]
    compress: Option<String>,

    #[command(flatten)]
    placing: Placing,
}

/// What of a plant has files of its own, in formats that hold one of it.
#[derive(Clone, Copy, Default)]
pub struct Files<'a> {
    /// Levels of detail.
    pub levels: usize,
    /// Seasons, if any are named.
    pub seasons: &'a [Season],
    /// Names of ages, if any are named.
    pub ages: &'a [&'a str],
}

impl Files<'_> {
    /// Of a plant in one season at one age.
    pub const fn in_levels(levels: usize) -> Self {
        Self { levels, seasons: &[], ages: &[] }
    }
}

impl Outputs {
    /// Tries all targets, before anything grows. `id` names files that have no name; `command` is what a
    /// user who named neither file nor format could have typed; `settings` are `FORMAT.OPTION` and
    /// value; what grows was read from the `sources`.
    pub fn open(
        &self,
        id: &str,
        command: &str,
        settings: &[(String, String)],
        files: Files<'_>,
        sources: Vec<PathBuf>,
    ) -> anyhow::Result<Batch> {
        let (batch, notes) = self.opened(id, command, settings, files, sources)?;
        super::notes(&notes, &Progress::new());
        Ok(batch)
    }

    /// The same without saying its notes, which come with it: who opens many alike says them once.
    pub fn opened(
        &self,
        id: &str,
        command: &str,
        settings: &[(String, String)],
        files: Files<'_>,
        sources: Vec<PathBuf>,
    ) -> anyhow::Result<(Batch, Vec<String>)> {
        let Files { levels, seasons, ages } = files;
        let mut notes = Vec::new();
        let targets = self.targets(id, command)?;
        let profile = self.profile()?;
        check_formats(settings, &targets)?;
        let flags = self.flags();
        check_flags(&flags, &targets)?;
        let mut outputs = Vec::new();
        for (exporter, path) in targets {
            let format = exporter.format();
            if let Some(other) = portrait::formats().misnamed(format, &path) {
                let path = crate::paths::show(&path);
                notes.push(format!(
                    "{path} is of {}, as --format says, though its ending is of {}",
                    format.id, other.id
                ));
            }
            let mut options = match profile {
                Some(profile) => profile.options(format).map_err(usage)?,
                None => Options::new(format),
            };
            for Flag { option, value, .. } in flags.iter().filter(|flag| has(exporter, flag.option)) {
                options.set(option, value).map_err(usage)?;
            }
            for (name, value) in settings {
                if let Some((_, name)) = name.split_once('.').filter(|(id, _)| *id == exporter.format().id) {
                    options.set(name, value).map_err(usage)?;
                }
            }
            if let Some(profile) = profile {
                notes.extend(profile.unread(format, &options, levels));
            }
            let output = Output::new(exporter, options, path);
            notes.extend(output.note_on_levels(levels).map(str::to_owned));
            let Some(in_ages) = output.in_ages(ages) else {
                return Err(usage("a stream holds one age: name a file, which becomes one for each age"));
            };
            outputs.extend(in_ages.into_iter().flat_map(|output| output.in_files(seasons, levels)));
        }
        let mut said = BTreeSet::new();
        notes.retain(|note| said.insert(note.clone()));
        let folders = self.placing.folders(outputs.iter().map(|output| output.path.as_path()))?;
        let bundle = |output: &Output| self.placing.bundle(&output.path);
        let batch = Batch::open(outputs, sources, bundle).map_err(explained)?.with_folders(folders);
        if batch.streams() > 1 {
            return Err(usage("only one output can be standard output: name files for the others"));
        }
        Ok((batch, notes))
    }

    /// The folder, where that is all that is named to write to.
    pub fn folder(&self) -> Option<&Path> {
        match self.output.as_slice() {
            [folder] if is_folder(folder) => Some(folder),
            _ => None,
        }
    }

    /// Writes this format where neither a format nor a program is named.
    pub fn with_usual(&mut self, format: &str) {
        if self.format.is_empty() && self.client.is_none() {
            self.format.push(format.to_owned());
        }
    }

    /// The program that files are for.
    pub fn profile(&self) -> anyhow::Result<Option<&'static Profile>> {
        self.client.as_deref().map(Profile::find).transpose().map_err(usage)
    }

    /// Options that flags turn, in all formats that have them.
    fn flags(&self) -> Vec<Flag> {
        let switch = |is_on: bool| is_on.then(|| "true".to_owned());
        let flags = [
            ("instances", "instances", switch(self.instances)),
            ("quantize", "quantize", switch(self.quantize)),
            ("compress", "compress", self.compress.clone()),
            ("lods-as", "lods", self.lods_as.clone()),
            ("collision", "collision", self.collision.clone()),
        ];
        flags
            .into_iter()
            .filter_map(|(name, option, value)| Some(Flag { name, option, value: value? }))
            .collect()
    }

    /// Which format goes where.
    fn targets(&self, id: &str, command: &str) -> anyhow::Result<Vec<(&'static dyn Exporter, PathBuf)>> {
        let formats =
            self.format.iter().map(|id| find(id.trim())).collect::<Result<Vec<_>, _>>().map_err(usage)?;
        // What the program reads best, where nothing is named.
        let formats = match self.profile()?.and_then(|profile| profile.formats.first()) {
            Some(best) if formats.is_empty() && self.output.iter().all(|path| is_folder(path)) => {
                vec![find(best).map_err(usage)?]
            }
            _ => formats,
        };
        let place = |exporter: &'static dyn Exporter, path: &PathBuf| {
            (exporter, in_folder(path, || default_name(id, exporter)))
        };
        match (self.output.as_slice(), formats.as_slice()) {
            ([], []) => Err(usage(format!("say where to write: {command}; formats: {}", ids().join(", ")))),
            ([], formats) => Ok(formats.iter().map(|&e| (e, default_name(id, e).into())).collect()),
            (paths, []) => paths
                .iter()
                .map(|path| {
                    if is_dash(path) {
                        return Err(usage(
                            "standard output has no ending: name its format, like --format obj",
                        ));
                    }
                    if is_folder(path) {
                        return Err(usage(format!(
                            "{} is a directory: name the formats of the files in it, like --format glb,obj",
                            crate::paths::show(path)
                        )));
                    }
                    Ok((for_path(path).map_err(usage)?, path.clone()))
                })
                .collect(),
            (paths, [one]) => Ok(paths.iter().map(|path| place(*one, path)).collect()),
            ([folder], formats) if is_folder(folder) => {
                Ok(formats.iter().map(|format| place(*format, folder)).collect())
            }
            (paths, formats) if paths.len() == formats.len() => {
                Ok(formats.iter().zip(paths).map(|(format, path)| place(*format, path)).collect())
            }
            (paths, formats) => Err(usage(format!(
                "{} formats for {} outputs: name one format for all outputs or one for each",
                formats.len(),
                paths.len()
            ))),
        }
    }
}

/// Writes all files, under temporary names; what the user should know goes to standard error.
pub fn write(
    batch: &mut Batch,
    stage: &Stage<'_>,
    monitor: &dyn Monitor,
    progress: &Progress,
) -> anyhow::Result<()> {
    write_age(batch, None, stage, monitor, progress)
}

/// The same with the files of one age of a plant.
pub fn write_age(
    batch: &mut Batch,
    age: Option<&str>,
    stage: &Stage<'_>,
    monitor: &dyn Monitor,
    progress: &Progress,
) -> anyhow::Result<()> {
    let is_sole = batch.is_stdout_alone();
    for pipe in batch.unread_pipes() {
        super::notes(&[waiting(&pipe)], progress);
    }
    let done = batch.write_age(age, stage, monitor, |notes| super::notes(&of_age(age, notes), progress));
    done.map_err(if is_sole { as_sole_output } else { explained })
}

/// Notes, with the age that they are about before them.
pub fn of_age(age: Option<&str>, notes: &[String]) -> Vec<String> {
    let named = |note: &String| age.map_or_else(|| note.clone(), |age| format!("{age}: {note}"));
    notes.iter().map(named).collect()
}

/// Puts all files in their places.
pub fn commit(batch: Batch, progress: &Progress) -> anyhow::Result<Vec<Written>> {
    let written = batch.commit().map_err(explained)?;
    progress.clear();
    Ok(written)
}

/// Lists files on standard output.
pub fn list(written: &[Written]) -> anyhow::Result<()> {
    list_with(&File::all(written), None)
}

/// The same with what is said of all of them behind the first. Which of them were left alone is said on standard error.
pub fn list_with(files: &[File], told: Option<&str>) -> anyhow::Result<()> {
    let mut lines = String::new();
    for (i, file) in files.iter().enumerate() {
        let size = indicatif::BinaryBytes(file.bytes);
        let told = told.filter(|_| i == 0).map(|told| format!("  {told}")).unwrap_or_default();
        lines.push_str(&format!("{}  {size}{told}\n", file.path));
    }
    say_kept(files);
    super::print(&lines)
}

/// Says on standard error which files were left alone, if any were.
pub fn say_kept(files: &[File]) {
    if let Some(note) = kept(files) {
        say(&format!("note: {note}"));
    }
}

/// Which files were left alone, if any were.
fn kept(files: &[File]) -> Option<String> {
    // More are a matter for programs, which read --json.
    const MOST: usize = 8;
    let kept: Vec<&str> = files.iter().filter(|file| file.kept).map(|file| file.path.as_str()).collect();
    let mut names = kept.iter().take(MOST).copied().collect::<Vec<_>>().join(", ");
    if kept.len() > MOST {
        names += &format!(" and {} more", kept.len() - MOST);
    }
    let had =
        if kept.len() == 1 { "had its bytes already and was" } else { "had their bytes already and were" };
    let written = files.len() - kept.len();
    (!kept.is_empty()).then(|| format!("{names} {had} left alone; {written} of {} written", files.len()))
}

/// Each `FORMAT.OPTION` must belong to a format that is written.
fn check_formats(
    settings: &[(String, String)],
    outputs: &[(&'static dyn Exporter, PathBuf)],
) -> anyhow::Result<()> {
    for (name, _) in settings {
        let id = name.split_once('.').map_or("", |(id, _)| id);
        let exporter = find(id).map_err(usage)?;
        if outputs.iter().all(|(other, _)| other.format().id != exporter.format().id) {
            return Err(usage(format!("--set {name}: no output is written as {id}")));
        }
    }
    Ok(())
}

/// A flag that turns an option of formats.
struct Flag {
    /// As it is typed, without the dashes.
    name: &'static str,
    option: &'static str,
    value: String,
}

/// Each flag must mean something to a format that is written.
fn check_flags(flags: &[Flag], outputs: &[(&'static dyn Exporter, PathBuf)]) -> anyhow::Result<()> {
    for Flag { name, option, .. } in flags {
        if !outputs.iter().any(|(exporter, _)| has(*exporter, option)) {
            let known = REGISTRY.iter().filter(|exporter| has(**exporter, option));
            let known: Vec<&str> = known.map(|exporter| exporter.format().id).collect();
            return Err(usage(format!(
                "--{name}: no output is written in a format that has it: {}",
                known.join(", ")
            )));
        }
    }
    Ok(())
}

fn has(exporter: &dyn Exporter, option: &str) -> bool {
    exporter.format().options.iter().any(|spec| spec.knob.name == option)
}

fn ids() -> Vec<&'static str> {
    REGISTRY.iter().map(|exporter| exporter.format().id).collect()
}
