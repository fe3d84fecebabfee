//! What a target is: a file to be, or a pipe that is there already.

use std::ffi::OsString;
use std::io;
use std::path::{Path, PathBuf};

use linden_pipeline::knob::printable;

use super::file_system::{FileSystem, System, again};
use crate::{ExportError, system};

/// As many as Linux follows.
const MOST_LINKS: usize = 40;

/// A place for a file.
#[derive(Clone, Debug)]
pub(super) struct Location {
    /// The folder as it is shown; `.` for the current one.
    pub shown_folder: PathBuf,
    /// The folder itself, without links.
    pub folder: PathBuf,
    pub name: OsString,
}

impl Location {
    /// The path itself, without links.
    pub fn path(&self) -> PathBuf {
        self.folder.join(&self.name)
    }

    /// The path as people know it.
    pub fn shown_path(&self) -> PathBuf {
        if self.shown_folder == Path::new(".") {
            self.name.clone().into()
        } else {
            self.shown_folder.join(&self.name)
        }
    }

    /// The same for a message.
    pub fn shown(&self) -> String {
        printable(&self.shown_path().to_string_lossy())
    }

    /// What went wrong here.
    pub fn failed(&self, doing: &'static str, source: io::Error) -> ExportError {
        ExportError::Io { doing, what: self.shown(), source }
    }
}

/// What a target leads to.
pub(super) enum Located {
    /// A file, or the place for one.
    File { location: Location, exists: bool },
    /// A pipe or a device.
    Stream(PathBuf),
}

/// What is at a target before an export.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Existing {
    /// Nothing: a file will be new.
    Nothing,
    /// A file that would be replaced.
    File,
    /// A pipe or a device, which is written to as it is.
    Stream,
}

/// Finds out what is at a target, and whether it can be written to as far as looking tells: what
/// [`Bundle::create`](super::Bundle::create) would refuse is refused here, but nothing is opened or
/// made.
///
/// # Errors
/// [`ExportError::Target`] and [`ExportError::Io`].
pub fn examine(target: &Path) -> Result<Existing, ExportError> {
    Ok(match locate(&System, target)? {
        Located::Stream(_) => Existing::Stream,
        Located::File { exists: true, .. } => Existing::File,
        Located::File { exists: false, .. } => Existing::Nothing,
    })
}

pub(super) fn looking(target: &Path, source: io::Error) -> ExportError {
    ExportError::Io { doing: "looking at", what: printable(&target.to_string_lossy()), source }
}

/// Follows links, and finds out whether a file can stand where they lead.
pub(super) fn locate(system: &dyn FileSystem, target: &Path) -> Result<Located, ExportError> {
    let fault = |problem: String| ExportError::Target { path: target.to_owned(), problem };
    if system::is_null_device(target) {
        return Ok(Located::Stream(target.to_owned()));
    }
    if let Some(problem) = target.file_name().and_then(system::refused) {
        return Err(fault(problem.to_owned()));
    }
    let io_fault = |source| looking(target, source);
    let ends_in_separator = target
        .as_os_str()
        .as_encoded_bytes()
        .last()
        .is_some_and(|&byte| std::path::is_separator(byte.into()));
    if ends_in_separator
        || is_folder(system, target)
        || matches!(target.as_os_str().to_str(), Some("." | ".."))
    {
        return Err(fault("that is a directory; name a file in it".to_owned()));
    }
    let path = follow(system, target).map_err(io_fault)?;
    let exists = match again(|| system.metadata(&path)) {
        Ok(meta) if meta.is_dir() => return Err(fault("that is a directory; name a file in it".to_owned())),
        Ok(meta) if !meta.is_file() => return Ok(Located::Stream(path)),
        Ok(meta) if meta.permissions().readonly() => {
            return Err(fault(format!(
                "that file is write-protected; allow writing to it ({}) or choose another name",
                system::HOW_TO_ALLOW_WRITING
            )));
        }
        Ok(_) => true,
        Err(e) if e.kind() == io::ErrorKind::NotFound => false,
        Err(e) if e.kind() == io::ErrorKind::NotADirectory => {
            return Err(fault("something on the way there is a file, not a directory".to_owned()));
        }
        Err(e) => return Err(io_fault(e)),
    };
    let Some(name) = path.file_name() else {
        return Err(fault("that is not the name of a file".to_owned()));
    };
    let shown = match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    };
    let folder = match again(|| system.canonicalize(shown)) {
        Ok(folder) if is_folder(system, &folder) => folder,
        Ok(_) => {
            return Err(fault(format!("{} is not a directory", printable(&shown.to_string_lossy()))));
        }
        Err(e) if e.kind() == io::ErrorKind::NotFound => {
            return Err(ExportError::NoFolder { path: target.to_owned(), folder: shown.to_owned() });
        }
        Err(e) => return Err(io_fault(e)),
    };
    let location = Location { shown_folder: shown.to_owned(), folder, name: name.to_owned() };
    Ok(Located::File { location, exists })
}

fn is_folder(system: &dyn FileSystem, path: &Path) -> bool {
    again(|| system.metadata(path)).is_ok_and(|meta| meta.is_dir())
}

/// What a path points at in the end, which need not exist.
fn follow(system: &dyn FileSystem, target: &Path) -> io::Result<PathBuf> {
    let mut path = target.to_owned();
    for _ in 0..MOST_LINKS {
        match again(|| system.symlink_metadata(&path)) {
            Ok(meta) if meta.is_symlink() => {}
            Ok(_) => return Ok(path),
            Err(e) if is_missing(&e) => return Ok(path),
            // What may be a link must not be taken for a file: it would be replaced.
            Err(e) => return Err(e),
        }
        match again(|| system.metadata(&path)) {
            // The magic links of /proc (what /dev/stdout points at) lead to names that are no paths.
            Ok(meta) if !meta.is_file() => return Ok(path),
            Ok(_) => {}
            Err(e) if is_missing(&e) || system::leads_in_a_circle(&e) => {}
            Err(e) => return Err(e),
        }
        let to = again(|| system.read_link(&path))?;
        path = path.parent().unwrap_or(Path::new("")).join(to);
    }
    Err(io::Error::new(io::ErrorKind::InvalidInput, "the symbolic link leads in a circle"))
}

fn is_missing(error: &io::Error) -> bool {
    matches!(error.kind(), io::ErrorKind::NotFound | io::ErrorKind::NotADirectory)
}
