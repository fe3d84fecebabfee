//! Writes a tree as a file shows that it was written, and compares.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{BufRead, BufReader, ErrorKind};
use std::path::{Path, PathBuf};

use anyhow::Context;
use linden::Monitor;
use linden::dress::Levels;
use linden_exporters::{Batch, Bundle, Exporter, Format, LooksIn, Options, Output, Traces, writers};

use super::looks::{is_one_of_several, splits};
use crate::cli::batch::PICTURES;
use crate::paths::show;
use crate::reading;

/// What the bytes say.
pub enum Bytes {
    /// All are the same, those of the files `beside` it too.
    Same { format: &'static str, options: BTreeMap<&'static str, String>, beside: Vec<PathBuf> },
    /// Where they differ, and the format that the file is in most likely.
    Other { format: &'static Format, place: String },
    /// Why they were not compared.
    NotCompared(String),
}

/// Compares a file with what the levels of its tree give, written with the options that show in it.
pub fn compare(path: &Path, levels: &Levels, monitor: &dyn Monitor) -> anyhow::Result<Bytes> {
    let mut file = BufReader::new(reading::open_regular(path)?);
    let exporters = writers(path, &mut file)?;
    let Some(format) = exporters.first().map(|exporter| exporter.format()) else {
        return Ok(Bytes::NotCompared("a picture or a recipe alone: no bytes to compare".to_owned()));
    };
    let mut nearest: Option<Place> = None;
    for exporter in exporters {
        std::io::Seek::rewind(&mut file)?;
        let traces = exporter.traces(&mut file)?;
        if traces.seasons {
            return Ok(Bytes::NotCompared(
                "several seasons or ages are in it: bytes not compared".to_owned(),
            ));
        }
        for options in &traces.options {
            let attempts = attempts(path, exporter, options, levels.levels.len());
            for (pictures, attempt) in
                places(path).flat_map(|place| attempts.iter().map(move |of| (place, of)))
            {
                monitor.check()?;
                match attempt.difference(path, pictures, levels, &traces, monitor)? {
                    Difference::None(beside) => {
                        let format = exporter.format().id;
                        // What changes nothing in it may have been on or off.
                        let shown = options.iter().filter(|(name, _)| !traces.is_idle(options, name));
                        let options = shown.map(|(name, value)| (name, value.to_string())).collect();
                        return Ok(Bytes::Same { format, options, beside });
                    }
                    Difference::At(place)
                        if nearest.as_ref().is_none_or(|before| before.is_before(&place)) =>
                    {
                        nearest = Some(place);
                    }
                    Difference::At(_) => {}
                }
            }
            if !exporter.format().self_contained && is_one_of_several(path, exporter.format(), monitor)? {
                return Ok(Bytes::NotCompared(
                    "it shares pictures with other ages or seasons: bytes not compared".to_owned(),
                ));
            }
        }
    }
    Ok(Bytes::Other { format, place: nearest.map(|place| place.what).unwrap_or_default() })
}

/// Where the pictures of a file may lie.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum PicturePlace {
    Beside,
    /// In the folder that the trees of a batch share.
    Shared,
}

fn places(path: &Path) -> impl Iterator<Item = PicturePlace> {
    let shared = shared_folder(path).is_some_and(|folder| folder.is_dir()).then_some(PicturePlace::Shared);
    shared.into_iter().chain([PicturePlace::Beside])
}

/// The pictures of the batch that a file may belong to.
fn shared_folder(path: &Path) -> Option<PathBuf> {
    match path.parent()?.parent() {
        Some(folder) => Some(folder.join(PICTURES)),
        // A name alone.
        None => Some(std::path::absolute(path).ok()?.parent()?.parent()?.join(PICTURES)),
    }
}

enum Difference {
    /// The files beside the main one.
    None(Vec<PathBuf>),
    At(Place),
}

/// Where files differ. Of several ways in which a file may have been written, the one that it agrees with longest is the one
/// that it was written in.
struct Place {
    /// How many files are the same before: the file itself, then those beside it.
    same_files: usize,
    byte: u64,
    /// For people.
    what: String,
}

impl Place {
    fn is_before(&self, other: &Self) -> bool {
        (self.same_files, self.byte) < (other.same_files, other.byte)
    }
}

/// Outputs that are written together, and which of them is the file.
struct Attempt {
    outputs: Vec<Output>,
    index: usize,
}

/// How a file may have been named: as it is, as a level, or as an age or a season of another name.
fn attempts(path: &Path, exporter: &'static dyn Exporter, options: &Options, levels: usize) -> Vec<Attempt> {
    let format = exporter.format();
    let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let ending = format.ending_of(path).map_or(0, |ending| ending.len() + 1);
    let (stem, ending) = name.split_at(name.len() - ending);
    let may_be_files = format.options.iter().any(|spec| spec.knob.name == "lods");
    let in_files = levels > 1 && (format.levels() == LooksIn::Files || may_be_files);
    let level = stem.rsplit_once("_LOD").and_then(|(stem, level)| Some((stem, level.parse().ok()?)));
    let is_one = in_files && level.is_some_and(|(_, level): (&str, usize)| level < levels);
    let (stem, index) =
        level.filter(|&(_, level): &(_, usize)| in_files && level < levels).unwrap_or((stem, 0));
    let mut options = options.clone();
    if may_be_files && is_one {
        // A format that could hold all levels has one because it was told so.
        let _ = options.set("lods", "files");
    }
    let output = |stem: &str| Output::new(exporter, options.clone(), format!("{stem}{ending}").into());
    let in_levels = |output: Output| {
        let outputs = if level.is_some() { output.in_levels(levels) } else { vec![output] };
        Attempt { index: index.min(outputs.len() - 1), outputs }
    };
    let mut attempts = vec![in_levels(output(stem))];
    if !format.self_contained {
        attempts.extend(splits(stem).map(|(stem, look)| in_levels(output(stem).in_look(look))));
    }
    attempts
}

fn is_picture(path: &Path) -> bool {
    path.extension()
        .is_some_and(|ending| ["png", "jpg", "jpeg", "webp"].iter().any(|picture| ending == *picture))
}

fn stem_of(path: &Path) -> String {
    path.file_stem().unwrap_or_default().to_string_lossy().into_owned()
}

impl Attempt {
    /// Where what is written now differs from the files that are there.
    fn difference(
        &self,
        path: &Path,
        pictures: PicturePlace,
        levels: &Levels,
        traces: &Traces,
        monitor: &dyn Monitor,
    ) -> anyhow::Result<Difference> {
        let folder = tempfile::tempdir().context("making a temporary folder")?;
        let (own_folder, shared) = (folder.path().join("tree"), folder.path().join(PICTURES));
        std::fs::create_dir(&own_folder).context("making a temporary folder")?;
        let mut outputs = self.outputs.clone();
        for output in &mut outputs {
            output.move_into(&own_folder);
        }
        let mains: Vec<PathBuf> = outputs.iter().map(|output| output.path.clone()).collect();
        let bundle = |output: &Output| {
            let bundle = Bundle::create(&output.path)?.unsynced();
            Ok(match pictures {
                PicturePlace::Beside => bundle,
                PicturePlace::Shared => bundle.with_pictures_in(&shared, &format!("../{PICTURES}")),
            })
        };
        let mut batch = Batch::open(outputs, Vec::new(), bundle)?;
        let stage = levels.stage();
        let stage = match &traces.setting {
            Some(surroundings) => stage.surrounded(surroundings, monitor)?,
            None => stage,
        };
        batch.write(&stage, monitor, |_| ())?;
        let written = batch.commit()?;
        let Some(main) = mains.get(self.index) else {
            return Ok(Difference::At(Place { same_files: 0, byte: 0, what: String::new() }));
        };
        if let Some(place) = difference(path, main)? {
            return Ok(Difference::At(place));
        }
        let own = stem_of(main);
        let mut same = Vec::new();
        let sides = written.iter().map(|file| &file.path).filter(|side| !mains.contains(side));
        // What names pictures says more than these do.
        let (pictures, named): (Vec<_>, Vec<_>) = sides.partition(|side| is_picture(side));
        for side in named.into_iter().chain(pictures) {
            let name = side.file_name().unwrap_or_default();
            if side.starts_with(&shared) {
                let there = shared_folder(path).unwrap_or_default().join(name);
                if let Some(place) = difference(&there, side)? {
                    return Ok(Difference::At(Place { same_files: 1 + same.len(), ..place }));
                }
                same.push(there);
                continue;
            }
            let text = name.to_string_lossy();
            let is_of_another = mains.iter().any(|other| text.starts_with(&stem_of(other)));
            if is_of_another && !text.starts_with(&own) {
                continue;
            }
            let there = path.with_file_name(name);
            if let Some(place) = difference(&there, side)? {
                return Ok(Difference::At(Place { same_files: 1 + same.len(), ..place }));
            }
            same.push(there);
        }
        Ok(Difference::None(same))
    }
}

/// Where a file differs from what was written now.
fn difference(there: &Path, now: &Path) -> anyhow::Result<Option<Place>> {
    let name = show(Path::new(there.file_name().unwrap_or_default()));
    let reading = || format!("reading {}", show(there));
    let mut a = match reading::open_regular(there) {
        Ok(file) => BufReader::new(file),
        Err(error) if error.kind() == ErrorKind::NotFound => {
            let what = format!("{name}, which belongs to it, is not there");
            return Ok(Some(Place { same_files: 0, byte: 0, what }));
        }
        Err(error) => return Err(error).with_context(reading),
    };
    let mut b = BufReader::new(File::open(now).with_context(reading)?);
    let (length, expected) = (a.get_ref().metadata()?.len(), b.get_ref().metadata()?.len());
    let mut at = 0_u64;
    loop {
        let (left, right) = (a.fill_buf().with_context(reading)?, b.fill_buf()?);
        let count = left.len().min(right.len());
        if left[..count] != right[..count] || (count == 0 && left.len() != right.len()) {
            let same = left.iter().zip(right).take_while(|(a, b)| a == b).count() as u64;
            let lengths = if length == expected {
                String::new()
            } else {
                format!("; it has {length} bytes, its recipe gives {expected}")
            };
            let byte = at + same;
            let what = format!("{name} differs from byte {byte} on{lengths}");
            return Ok(Some(Place { same_files: 0, byte, what }));
        }
        if count == 0 {
            return Ok(None);
        }
        a.consume(count);
        b.consume(count);
        at += count as u64;
    }
}
