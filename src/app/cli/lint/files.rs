//! Which files are one model, and what lies beside them.

use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use linden::Monitor;
use linden_lint::{Asset, Beside};

use crate::exit::{sentence, usage};
use crate::paths::show;
use crate::progress::Progress;
use crate::{reading, trust};

/// A file, or files of one level of detail each.
pub struct Model {
    /// By level; a file by itself is level 0.
    pub files: Vec<(u32, PathBuf)>,
    /// What they have in common.
    family: Option<(PathBuf, String)>,
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

/// Files that are named alike but for `_LOD` and a number become one.
pub fn models(paths: &[PathBuf]) -> anyhow::Result<Vec<Model>> {
    let mut models: Vec<Model> = Vec::new();
    for path in paths {
        if !path.exists() {
            return Err(usage(format!("there is no file '{}'", show(path))));
        }
        if path.is_dir() {
            return Err(usage(format!("'{}' is a directory; name files in it", show(path))));
        }
        let level = level(path);
        let family = level.as_ref().map(|(_, family)| family.clone());
        let number = level.map_or(0, |(number, _)| number);
        let is_it = |model: &&mut Model| family.is_some() && model.family == family;
        match models.iter_mut().find(is_it) {
            Some(model) => model.files.push((number, path.clone())),
            None => models.push(Model { files: vec![(number, path.clone())], family }),
        }
    }
    for model in &mut models {
        model.files.sort();
        model.files.dedup();
    }
    Ok(models)
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
