//! Which files are one model, and what lies beside them.

use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use linden::Monitor;
use linden_lint::{Asset, Beside, ENDINGS};

use crate::cli::walk::files_below;
use crate::exit::sentence;
use crate::paths::show;
use crate::progress::Progress;
use crate::{reading, trust};

/// A file, or files of one level of detail each.
pub struct Model {
    /// By level; a file by itself is level 0.
    pub files: Vec<(u32, PathBuf)>,
    /// What they have in common.
    family: Option<(PathBuf, String)>,
    /// Whether all were found in folders, and none was named: then what holds no mesh is passed over.
    pub is_by_the_way: bool,
}

impl Model {
    /// As the user gave it, without the level's number.
    pub fn shown(&self) -> String {
        match (self.files.as_slice(), &self.family) {
            ([(_, only)], _) => show(only),
            (_, Some((folder, name))) => show(&folder.join(name)),
            (_, None) => String::new(),
        }
    }
}

/// What there is to look at.
#[derive(Default)]
pub struct Found {
    pub models: Vec<Model>,
    /// Files and folders that are not there, cannot be listed, or hold no model, each with the reason.
    pub failed: Vec<(String, String)>,
}

/// Files, and the models in folders. Those that are named alike but for `_LOD` and a number become one; each counts once,
/// however often it is named.
pub fn find(paths: &[PathBuf], progress: &Progress) -> anyhow::Result<Found> {
    let mut found = Found::default();
    for path in paths {
        if path.is_dir() {
            match files_below(path, progress, &mut |_| Ok(())) {
                Ok(files) => found.add_folder(path, files),
                Err(error) => {
                    progress.check()?;
                    found.failed.push((show(path), sentence(&error)));
                }
            }
        } else if path.exists() {
            found.add(path.clone(), false);
        } else {
            found.failed.push((show(path), "there is no such file or folder".to_owned()));
        }
    }
    for model in &mut found.models {
        model.files.sort();
    }
    Ok(found)
}

impl Found {
    /// Payloads are looked at with the file that has them.
    fn add_folder(&mut self, folder: &Path, files: Vec<PathBuf>) {
        let models: Vec<PathBuf> = files.into_iter().filter(|path| is_model(path)).collect();
        if models.is_empty() {
            let endings = ENDINGS.map(|ending| format!(".{ending}")).join(", ");
            self.failed
                .push((show(folder), format!("there is no model in the folder: no file ends in {endings}")));
        }
        let is_of_another = |file: &PathBuf| whole(file).is_some_and(|whole| models.contains(&whole));
        for file in models.iter().filter(|file| !is_of_another(file)) {
            self.add(file.clone(), true);
        }
    }

    fn add(&mut self, path: PathBuf, is_by_the_way: bool) {
        let is_known = |model: &Model| model.files.iter().any(|(_, known)| *known == path);
        if let Some(model) = self.models.iter_mut().find(|model| is_known(model)) {
            model.is_by_the_way &= is_by_the_way;
            return;
        }
        let level = level(&path);
        let family = level.as_ref().map(|(_, family)| family.clone());
        let number = level.map_or(0, |(number, _)| number);
        let is_it = |model: &&mut Model| family.is_some() && model.family == family;
        match self.models.iter_mut().find(is_it) {
            Some(model) => {
                model.files.push((number, path));
                model.is_by_the_way &= is_by_the_way;
            }
            None => self.models.push(Model { files: vec![(number, path)], family, is_by_the_way }),
        }
    }
}

/// The file that an export has beside the payload that it wrote: `oak.usda` of `oak_payload.usda`.
pub fn whole(path: &Path) -> Option<PathBuf> {
    let stem = path.file_stem()?.to_str()?.strip_suffix("_payload")?;
    Some(path.with_file_name(format!("{stem}.{}", path.extension()?.to_str()?)))
}

fn is_payload(path: &Path) -> bool {
    whole(path).is_some()
}

/// Whether a file is called like a model.
fn is_model(path: &Path) -> bool {
    let ending = path.extension().map(|ending| ending.to_string_lossy().to_lowercase());
    ending.is_some_and(|ending| ENDINGS.contains(&&*ending))
}

/// The level in a file's name, and the folder and name without it.
fn level(path: &Path) -> Option<(u32, (PathBuf, String))> {
    let name = path.file_name()?.to_str()?;
    let (stem, ending) = name.rsplit_once('.')?;
    let (family, number) = stem.rsplit_once("_LOD")?;
    let folder = path.parent().unwrap_or(Path::new("")).to_owned();
    Some((number.parse().ok()?, (folder, format!("{family}.{ending}"))))
}

/// Reads a model, and what it names beside it; of one that was found `by_the_way` no models beside it.
pub fn read(path: &Path, by_the_way: bool, progress: &Progress) -> anyhow::Result<Asset> {
    let bytes = reading::open(path, progress)?.bytes(progress)?;
    let beside = Neighbours { path, by_the_way, monitor: progress };
    Ok(linden_lint::read(&path.to_string_lossy(), &bytes, &beside, progress)?)
}

struct Neighbours<'a> {
    path: &'a Path,
    by_the_way: bool,
    monitor: &'a dyn Monitor,
}

impl Beside for Neighbours<'_> {
    fn read(&self, name: &str) -> Result<Option<Vec<u8>>, String> {
        let name = name.replace('\\', "/");
        // What a layer names lies in the same folders mostly, and would be looked at twice.
        if self.by_the_way && is_model(Path::new(&name)) && !is_payload(Path::new(&name)) {
            return Err("models in folders are looked at each by itself".to_owned());
        }
        let allowed = trust::beside(Some(self.path), &name).map_err(|error| error.to_string())?;
        match reading::regular(&allowed, self.monitor) {
            Ok(bytes) => Ok(Some(bytes)),
            Err(error) => {
                let is_missing =
                    error.downcast_ref::<std::io::Error>().is_some_and(|e| e.kind() == ErrorKind::NotFound);
                if is_missing { Ok(None) } else { Err(sentence(&error)) }
            }
        }
    }
}
