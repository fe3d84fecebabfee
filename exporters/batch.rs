//! What is exported where: all that is written together, by the command line, the workbench or a library's caller.
//!
//! All targets are tried before anything grows, all files are written under temporary names, and all
//! of them come into their places together or none does.

use std::collections::BTreeSet;
use std::ffi::OsString;
use std::fmt;
use std::path::{Path, PathBuf};

use crate::writing::ONE_LEVEL;
use crate::{
    AgeFile, AgeSet, Bundle, Existing, ExportError, Exporter, Format, LooksIn, MadeFolders, MemoryFile,
    Options, Pictures, WindLoop, Written, commit_all, ensure_distinct, ensure_spared, examine,
};
use linden_pipeline::scene::Bounds;
use linden_pipeline::season::Season;
use linden_pipeline::stage::Stage;
use linden_pipeline::{Monitor, Wanted};

/// One output: who writes it, with which options, where.
#[derive(Clone)]
pub struct Output {
    /// The format.
    pub exporter: &'static dyn Exporter,
    /// Its options.
    pub options: Options,
    /// The main file.
    pub path: PathBuf,
    /// The only level of detail in it; `None`: all, as far as the format holds them.
    pub level: Option<usize>,
    /// The only age of a plant that is in it, by its name; `None`: there are no ages.
    pub age: Option<String>,
    /// Whether it is one file over those of all ages.
    gathers: bool,
    /// The only season in it, by its name; `None`: all, as far as the format holds them.
    pub season: Option<String>,
    /// The file that was asked for, and where it became one for each season that of this season: those
    /// that stand in its place share pictures.
    families: Vec<PathBuf>,
}

impl Output {
    /// All levels of detail and seasons in this file.
    pub fn new(exporter: &'static dyn Exporter, options: Options, path: PathBuf) -> Self {
        let families = vec![path.clone()];
        Self { exporter, options, families, path, level: None, age: None, gathers: false, season: None }
    }

    /// The file for one of several looks of a plant, an age or a season: `oak_young.obj`. It shares pictures with those of the
    /// other looks.
    #[must_use]
    pub fn in_look(mut self, name: &str) -> Self {
        self.path = self.path_with(&format!("_{name}"));
        self.families.push(self.path.clone());
        self
    }

    /// The files for a plant at several ages: `oak_young.glb`, `oak_old.glb` and so on; for a format that can name other
    /// files, one over them too. `None` for a stream, which holds one.
    pub fn in_ages(self, ages: &[&str]) -> Option<Vec<Self>> {
        if ages.is_empty() {
            return Some(vec![self]);
        }
        if self.is_stream() {
            return None;
        }
        let named = |name: &&str| Self { age: Some((*name).to_owned()), ..self.clone().in_look(name) };
        let mut files: Vec<Self> = ages.iter().map(named).collect();
        if self.exporter.gatherer().is_some() {
            files.push(Self { gathers: true, ..self.clone() });
        }
        Some(files)
    }

    /// The files for these seasons: this one, or for a format that holds one season only `oak_summer.glb`,
    /// `oak_autumn.glb` and so on. A stream stays one, with the first that there is.
    pub fn in_seasons(self, seasons: &[Season]) -> Vec<Self> {
        if seasons.is_empty()
            || self.gathers
            || self.is_stream()
            || self.exporter.format().seasons() != LooksIn::Files
        {
            return vec![self];
        }
        let named =
            |Season { name, .. }: &Season| Self { season: Some(name.clone()), ..self.clone().in_look(name) };
        seasons.iter().map(named).collect()
    }

    /// The files for a number of levels of detail: this one, or for a format that holds one level only, or is to hold one,
    /// `fir_LOD0.obj`, `fir_LOD1.obj` and so on. A stream stays one, with the finest level. Shapes for physics are in the file of the
    /// finest.
    pub fn in_levels(self, levels: usize) -> Vec<Self> {
        let looks_in = self.exporter.format().levels_with(&self.options);
        if levels < 2 || self.gathers || self.is_stream() || looks_in != LooksIn::Files {
            return vec![self];
        }
        let of_level = |level: usize| {
            let path = self.path_with(&format!("_LOD{level}"));
            let mut file = Self { path, level: Some(level), ..self.clone() };
            if level > 0 {
                // Whoever loads all of them needs the bodies once.
                file.options.reset_once_a_plant();
            }
            file
        };
        (0..levels).map(of_level).collect()
    }

    /// What is to be said where a file for each of a number of levels was asked for, and there is one level: the file itself
    /// does not tell.
    pub fn note_on_levels(&self, levels: usize) -> Option<&'static str> {
        let are_files = self.options.is_asked("lods") && self.options.is_word("lods", "files");
        (are_files && levels < 2).then_some(ONE_LEVEL)
    }

    /// The files that are written for this one in these seasons and in a number of levels of detail.
    pub fn in_files(self, seasons: &[Season], levels: usize) -> Vec<Self> {
        self.in_seasons(seasons).into_iter().flat_map(|output| output.in_levels(levels)).collect()
    }

    /// Puts it into a folder.
    pub fn move_into(&mut self, folder: &Path) {
        for path in std::iter::once(&mut self.path).chain(&mut self.families) {
            *path = folder.join(path.file_name().unwrap_or_default());
        }
    }

    fn is_stream(&self) -> bool {
        self.path == Path::new("-") || matches!(examine(&self.path), Ok(Existing::Stream))
    }

    /// The path with something between the name and its ending.
    fn path_with(&self, suffix: &str) -> PathBuf {
        let dots =
            self.exporter.format().ending_of(&self.path).map_or(0, |ending| ending.matches('.').count());
        let mut stem = self.path.clone();
        let endings: Vec<OsString> = (0..=dots)
            .filter_map(|_| {
                let ending = stem.extension()?.to_owned();
                stem.set_extension("");
                Some(ending)
            })
            .collect();
        let mut name = stem.file_name().unwrap_or_default().to_os_string();
        name.push(suffix);
        for ending in endings.iter().rev() {
            name.push(".");
            name.push(ending);
        }
        self.path.with_file_name(name)
    }

    /// What of a stage is in this file; `None`: all of it.
    fn part_of<'s>(&self, stage: &Stage<'s>) -> Option<Stage<'s>> {
        let index_of = |name: &String| {
            let mut seasons = stage.plants.iter().map(|plant| &plant.seasons);
            seasons.find_map(|list| list.iter().position(|season| season.name == *name))
        };
        let in_season = self.season.as_ref().and_then(index_of).map(|index| stage.in_season(index));
        let at_level = self.level.map(|level| in_season.as_ref().unwrap_or(stage).at_level(level));
        at_level.or(in_season)
    }
}

impl fmt::Debug for Output {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Output")
            .field("format", &self.exporter.format().id)
            .field("options", &self.options.iter().collect::<Vec<_>>())
            .field("path", &self.path)
            .field("level", &self.level)
            .field("age", &self.age)
            .field("season", &self.season)
            .finish_non_exhaustive()
    }
}

/// An age that was written, for what gathers them.
struct WrittenAge {
    age: String,
    plant: String,
    recipe: String,
    bounds: Option<Bounds>,
    wind: Option<WindLoop>,
}

/// Outputs whose places were tried and found free.
pub struct Batch {
    outputs: Vec<Output>,
    bundles: Vec<Bundle>,
    /// What the tree is grown from, and must not be replaced.
    sources: Vec<PathBuf>,
    /// Those that are written already.
    written: Vec<Bundle>,
    /// Made for the files, and removed again after them unless they are committed.
    folders: Vec<MadeFolders>,
    ages: Vec<WrittenAge>,
}

impl Batch {
    /// The formats that are written, each once, with their options.
    pub fn formats(&self) -> Vec<(&'static Format, &Options)> {
        let mut formats: Vec<(&'static Format, &Options)> = Vec::new();
        for Output { exporter, options, .. } in &self.outputs {
            if formats.iter().all(|(known, _)| known.id != exporter.format().id) {
                formats.push((exporter.format(), options));
            }
        }
        formats
    }

    /// What has to be made of a plant for all outputs: see [`Recipe::wanting`](linden_pipeline::recipe::Recipe::wanting).
    pub fn wanted(&self) -> Wanted {
        let each = self.outputs.iter().map(|output| output.exporter.format().holds.wanted());
        each.fold(Wanted::SKELETON, Wanted::or)
    }

    /// Tries all places; `bundle` makes a bundle of an output.
    ///
    /// # Errors
    /// The first place that cannot be written to, two that are the same, or one that the tree is
    /// grown from.
    pub fn open(
        outputs: Vec<Output>,
        sources: Vec<PathBuf>,
        bundle: impl Fn(&Output) -> Result<Bundle, ExportError>,
    ) -> Result<Self, ExportError> {
        let pictures = Pictures::default();
        let sharing = |output| Ok(bundle(output)?.sharing(&pictures, &output.families));
        let bundles = outputs.iter().map(sharing).collect::<Result<Vec<_>, ExportError>>()?;
        ensure_distinct(&bundles)?;
        ensure_spared(&bundles, &sources)?;
        let (written, folders, ages) = (Vec::new(), Vec::new(), Vec::new());
        Ok(Self { outputs, bundles, sources, written, folders, ages })
    }

    /// With folders that were made for it.
    #[must_use]
    pub fn with_folders(mut self, folders: Vec<MadeFolders>) -> Self {
        self.folders.extend(folders);
        self
    }

    /// Pipes without a reader yet: writing to them waits.
    pub fn unread_pipes(&mut self) -> Vec<String> {
        self.bundles.iter_mut().filter_map(|bundle| bundle.unread_pipe().map(str::to_owned)).collect()
    }

    /// Whether standard output is all that is written.
    pub fn is_stdout_alone(&self) -> bool {
        matches!(self.outputs.as_slice(), [only] if only.path == Path::new("-"))
    }

    /// How many outputs are streams: they hold one file each, and it goes out as it is made.
    pub fn streams(&self) -> usize {
        self.bundles.iter().filter(|bundle| !bundle.takes_side_files()).count()
    }

    /// Writes outputs that need no stage, which `write` says it did; [`write`](Self::write) leaves them alone then, and
    /// all come into their places together.
    ///
    /// # Errors
    /// The first that `write` fails with.
    pub fn write_apart<E>(
        &mut self,
        mut write: impl FnMut(&Output, &mut Bundle) -> Result<bool, E>,
    ) -> Result<(), E> {
        let mut index = 0;
        while index < self.outputs.len() {
            if write(&self.outputs[index], &mut self.bundles[index])? {
                self.outputs.remove(index);
                self.written.push(self.bundles.remove(index));
            } else {
                index += 1;
            }
        }
        Ok(())
    }

    /// Whether all is written that needs no stage, and nothing is left.
    pub fn is_written(&self) -> bool {
        self.outputs.is_empty()
    }

    /// Writes one output after another (those of levels that there are in the end); `told` hears of each when it is written, with what the user
    /// should know about it.
    ///
    /// # Errors
    /// Those of the exporters.
    pub fn write(
        &mut self,
        stage: &Stage<'_>,
        monitor: &dyn Monitor,
        told: impl FnMut(&[String]),
    ) -> Result<(), ExportError> {
        self.write_age(None, stage, monitor, told)
    }

    /// The same with the outputs of one age of a plant: see [`Output::in_ages`].
    ///
    /// # Errors
    /// Those of the exporters.
    pub fn write_age(
        &mut self,
        age: Option<&str>,
        stage: &Stage<'_>,
        monitor: &dyn Monitor,
        mut told: impl FnMut(&[String]),
    ) -> Result<(), ExportError> {
        let levels = stage.levels();
        let is_its = |output: &Output| output.age.as_deref() == age && !output.gathers;
        let has = |output: &Output| !is_its(output) || output.level.is_none_or(|level| level < levels);
        let mut kept = self.outputs.iter().map(has);
        self.bundles.retain(|_| kept.next().unwrap_or(false));
        self.outputs.retain(has);
        if let Some(age) = age {
            let is_gathered = self.outputs.iter().any(|output| output.gathers);
            if is_gathered {
                self.ages.push(WrittenAge::of(age, stage));
            }
        }
        let mut said: Vec<String> = Vec::new();
        let outputs = self.outputs.iter().zip(&mut self.bundles).filter(|(output, _)| is_its(output));
        for (output, bundle) in outputs {
            let part = output.part_of(stage);
            output.exporter.write(part.as_ref().unwrap_or(stage), &output.options, bundle, monitor)?;
            // What is true of several outputs is said once.
            let new: Vec<String> =
                bundle.notes().iter().filter(|note| !said.contains(note)).cloned().collect();
            told(&new);
            said.extend(new);
        }
        Ok(())
    }

    /// Writes what gathers the files of all ages that were written.
    ///
    /// # Errors
    /// Those of the exporters.
    pub fn gather(&mut self, monitor: &dyn Monitor) -> Result<(), ExportError> {
        let (outputs, ages) = (&self.outputs, &self.ages);
        for (output, bundle) in outputs.iter().zip(&mut self.bundles).filter(|(output, _)| output.gathers) {
            let Some(gather) = output.exporter.gatherer() else { continue };
            // The finest level, where levels have files of their own.
            let of_age = |age: &str| {
                let is_its = |other: &&Output| {
                    other.age.as_deref() == Some(age) && other.families.first() == output.families.first()
                };
                outputs
                    .iter()
                    .filter(|other| other.exporter.format().id == output.exporter.format().id)
                    .find(is_its)
            };
            let file = |WrittenAge { age, bounds, wind, .. }: &WrittenAge| {
                let name = of_age(age)?.path.file_name()?.to_string_lossy().into_owned();
                Some(AgeFile { age: age.clone(), file: format!("./{name}"), bounds: *bounds, wind: *wind })
            };
            let name = ages.first().map_or_else(String::new, |first| first.plant.clone());
            let recipe = ages.last().map_or_else(String::new, |last| last.recipe.clone());
            gather(&AgeSet { name, recipe, ages: ages.iter().filter_map(file).collect() }, bundle, monitor)?;
        }
        Ok(())
    }

    /// The files of outputs whose bundles are [in memory](Bundle::in_memory), each main file before those that lie beside it.
    pub fn into_files(self) -> Vec<MemoryFile> {
        self.bundles.into_iter().chain(self.written).flat_map(Bundle::into_files).collect()
    }

    /// Puts all files in their places; gives each once, though formats may share a picture.
    ///
    /// # Errors
    /// As [`commit_all`], and when a file beside a main one would replace what the tree is grown from.
    pub fn commit(mut self) -> Result<Vec<Written>, ExportError> {
        self.bundles.append(&mut self.written);
        ensure_spared(&self.bundles, &self.sources)?;
        let mut written = commit_all(self.bundles)?;
        self.folders.into_iter().for_each(MadeFolders::keep);
        let mut listed = BTreeSet::new();
        written.retain(|file| listed.insert(file.path.clone()));
        Ok(written)
    }
}

impl WrittenAge {
    fn of(age: &str, stage: &Stage<'_>) -> Self {
        Self {
            age: age.to_owned(),
            plant: stage.name.clone(),
            recipe: crate::recipe::of_stage(stage).1.to_owned(),
            bounds: whole_bounds(stage),
            wind: WindLoop::of_stage(stage),
        }
    }
}

/// The box of all levels and seasons.
pub(crate) fn whole_bounds(stage: &Stage<'_>) -> Option<Bounds> {
    let of_season = |season: usize| {
        let stage = stage.in_season(season);
        (0..stage.levels().max(1)).filter_map(|level| stage.at_level(level).bounds()).reduce(Bounds::union)
    };
    (0..stage.seasons().max(1)).filter_map(of_season).reduce(Bounds::union)
}

/// `fir.glb`, or `fir-skeleton.ply` where another format has the plain name.
pub fn default_name(id: &str, exporter: &dyn Exporter) -> String {
    let format = exporter.format();
    let stem = plain_stem(id);
    let ending = format.usual_ending();
    // A second flavour of an ending: `ply-skeleton`.
    let is_flavour = format.extensions.is_empty();
    let flavour = format.id.split_once('-').map_or("flavour", |(_, flavour)| flavour);
    if is_flavour { format!("{stem}-{flavour}.{ending}") } else { format!("{stem}.{ending}") }
}

/// An id as the beginning of a file's name.
pub fn plain_stem(id: &str) -> String {
    id.chars().map(|c| if std::path::is_separator(c) || c.is_control() { '-' } else { c }).collect()
}

#[cfg(test)]
mod tests {
    use crate::REGISTRY;

    use super::*;

    #[test]
    fn default_names_are_distinct_and_stay_in_their_directory() {
        for id in ["fir", "a/b", "a\u{1b}b", ".."] {
            let names: BTreeSet<_> = REGISTRY.iter().map(|exporter| default_name(id, *exporter)).collect();
            assert_eq!(names.len(), REGISTRY.len());
            assert!(names.iter().all(|name| Path::new(name).components().count() == 1), "{names:?}");
        }
        assert_eq!(default_name("fir", crate::find("ply-skeleton").unwrap()), "fir-skeleton.ply");
        assert_eq!(default_name("fir", crate::find("organs").unwrap()), "fir.organs.csv");
    }

    #[test]
    fn what_tells_files_apart_stands_before_the_whole_ending() {
        let autumn = [Season { name: "autumn".to_owned(), season: 0.75 }];
        for (format, path, expected) in [
            ("obj", "a.b/old.fir.obj", "a.b/old.fir_autumn.obj"),
            ("organs", "fir.organs.csv", "fir_autumn.organs.csv"),
            ("organs", "fir.csv", "fir_autumn.csv"),
            ("organs", "fir", "fir_autumn"),
        ] {
            let exporter = crate::find(format).unwrap();
            let output = Output::new(exporter, Options::new(exporter.format()), path.into());
            assert_eq!(output.in_seasons(&autumn)[0].path, Path::new(expected));
        }
    }
}
