//! Folders that are made for an export, and go again when it fails.

use std::path::{Path, PathBuf};

use super::file_system::{FileSystem, System, again, synced};
use crate::ExportError;

/// Folders that were made. Dropped, they are removed as far as they are empty.
#[must_use = "dropped, the folders are removed again"]
pub struct MadeFolders {
    system: &'static dyn FileSystem,
    /// The outermost first.
    paths: Vec<PathBuf>,
}

/// Makes the folder that `target` is to lie in, and those above it, as far as they are missing. They
/// stay once they are [kept](MadeFolders::keep).
///
/// # Errors
/// [`ExportError::Io`].
pub fn make_folders(target: &Path) -> Result<MadeFolders, ExportError> {
    make_folders_on(&System, target)
}

pub(super) fn make_folders_on(
    system: &'static dyn FileSystem,
    target: &Path,
) -> Result<MadeFolders, ExportError> {
    let mut made = MadeFolders { system, paths: Vec::new() };
    let mut missing = Vec::new();
    let mut folder = target.parent();
    while let Some(path) = folder.filter(|path| !path.as_os_str().is_empty()) {
        // Whatever else hinders looking is told by the making.
        if again(|| system.metadata(path)).is_ok() {
            break;
        }
        missing.push(path.to_owned());
        folder = path.parent();
    }
    for path in missing.into_iter().rev() {
        match again(|| system.create_folder(&path)) {
            Ok(()) => made.paths.push(path),
            // Another program has made it meanwhile, or it is named twice (`a/../a`).
            Err(e) if e.kind() == std::io::ErrorKind::AlreadyExists => {}
            Err(source) => {
                let what = linden_pipeline::knob::printable(&path.to_string_lossy());
                return Err(ExportError::Io { doing: "making the directory", what, source });
            }
        }
    }
    Ok(made)
}

impl MadeFolders {
    /// They stay.
    pub fn keep(mut self) {
        for path in std::mem::take(&mut self.paths) {
            // The name of a folder is its parent's content. That it may be lost in a power cut is no
            // reason to fail: what is in it is there.
            let parent = path.parent().filter(|parent| !parent.as_os_str().is_empty());
            if let Ok(parent) = again(|| self.system.open_folder(parent.unwrap_or(Path::new(".")))) {
                let _ = synced(again(|| self.system.sync(&parent)));
            }
        }
    }
}

impl Drop for MadeFolders {
    fn drop(&mut self) {
        for path in self.paths.iter().rev() {
            // What is not empty holds something that is not ours.
            let _ = again(|| self.system.remove_folder(path));
        }
    }
}
