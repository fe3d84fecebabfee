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
    fn add_folder(&mut self, folder: &Path, files: Vec<PathBuf>) {
        let ending = |path: &PathBuf| path.extension().map(|ending| ending.to_string_lossy().to_lowercase());
        let is_model = |path: &PathBuf| ending(path).is_some_and(|ending| ENDINGS.contains(&&*ending));
        let models: Vec<PathBuf> = files.into_iter().filter(is_model).collect();
        if models.is_empty() {
            let endings = ENDINGS.map(|ending| format!(".{ending}")).join(", ");
            self.failed
                .push((show(folder), format!("there is no model in the folder: no file ends in {endings}")));
        }
        for file in models {
            self.add(file, true);
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

/// The level in a file's name, and the folder and name without it.
fn level(path: &Path) -> Option<(u32, (PathBuf, String))> {
    let name = path.file_name()?.to_str()?;
    let (stem, ending) = name.rsplit_once('.')?;
    let (family, number) = stem.rsplit_once("_LOD")?;
    let folder = path.parent().unwrap_or(Path::new("")).to_owned();
    Some((number.parse().ok()?, (folder, format!("{family}.{ending}"))))
}

/// Reads a model, and what it names beside it.
pub fn read(path: &Path, progress: &Progress) -> anyhow::Result<Asset> {
    let bytes = reading::open(path, progress)?.bytes(progress)?;
    let beside = Neighbours { path, monitor: progress };
    Ok(linden_lint::read(&path.to_string_lossy(), &bytes, &beside, progress)?)
}

struct Neighbours<'a> {
    path: &'a Path,
    monitor: &'a dyn Monitor,
}

impl Beside for Neighbours<'_> {
    fn read(&self, name: &str) -> Result<Option<Vec<u8>>, String> {
        let name = name.replace('\\', "/");
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
