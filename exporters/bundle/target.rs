//! What a target is: a file to be, or a pipe that is there already.

use std::ffi::OsString;
use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use linden::knob::printable;

use crate::ExportError;

/// As many as Linux follows.
const MOST_LINKS: usize = 40;

pub(super) enum Resolved {
    File {
        /// The directory as it is shown.
        shown: PathBuf,
        /// The directory without links.
        dir: PathBuf,
        name: OsString,
    },
    Stream(Box<dyn Write + Send>),
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
    Ok(match locate(target)? {
        Located::Stream(_) => Existing::Stream,
        Located::File { exists: true, .. } => Existing::File,
        Located::File { exists: false, .. } => Existing::Nothing,
    })
}

/// Finds out whether a file can stand at a target, and opens what is no file.
pub(super) fn resolve(target: &Path) -> Result<Resolved, ExportError> {
    match locate(target)? {
        Located::File { shown, dir, name, .. } => Ok(Resolved::File { shown, dir, name }),
        Located::Stream(path) => match File::options().write(true).open(path) {
            Ok(file) => Ok(Resolved::Stream(Box::new(file))),
            Err(source) => Err(looking(target, source)),
        },
    }
}

enum Located {
    File { shown: PathBuf, dir: PathBuf, name: OsString, exists: bool },
    Stream(PathBuf),
}

fn looking(target: &Path, source: io::Error) -> ExportError {
    ExportError::Io { doing: "looking at", what: printable(&target.to_string_lossy()), source }
}

/// Follows links.
fn locate(target: &Path) -> Result<Located, ExportError> {
    let fault = |problem: String| ExportError::Target { path: target.to_owned(), problem };
    let io_fault = |source| looking(target, source);
    let ends_in_separator = target
        .as_os_str()
        .as_encoded_bytes()
        .last()
        .is_some_and(|&byte| std::path::is_separator(byte.into()));
    if ends_in_separator || target.is_dir() || matches!(target.as_os_str().to_str(), Some("." | "..")) {
        return Err(fault("that is a directory; name a file in it".to_owned()));
    }
    let path = follow(target).map_err(io_fault)?;
    let exists = match fs::metadata(&path) {
        Ok(meta) if meta.is_dir() => return Err(fault("that is a directory; name a file in it".to_owned())),
        Ok(meta) if !meta.is_file() => return Ok(Located::Stream(path)),
        Ok(meta) if meta.permissions().readonly() => {
            return Err(fault(
                "that file is write-protected; allow writing to it (chmod u+w) or choose another name"
                    .to_owned(),
            ));
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
    let dir = match fs::canonicalize(shown) {
        Ok(dir) if dir.is_dir() => dir,
        Ok(_) => {
            return Err(fault(format!("{} is not a directory", printable(&shown.to_string_lossy()))));
        }
        Err(e) if e.kind() == io::ErrorKind::NotFound => {
            let shown = printable(&shown.to_string_lossy());
            return Err(fault(format!("the directory {shown} does not exist; create it first (mkdir -p)")));
        }
        Err(e) => return Err(io_fault(e)),
    };
    Ok(Located::File { shown: shown.to_owned(), dir, name: name.to_owned(), exists })
}

/// What a path points at in the end, which need not exist.
fn follow(target: &Path) -> io::Result<PathBuf> {
    let mut path = target.to_owned();
    for _ in 0..MOST_LINKS {
        // Whatever hinders looking is found, and told better, by the caller.
        if !fs::symlink_metadata(&path).is_ok_and(|meta| meta.is_symlink()) {
            return Ok(path);
        }
        // The magic links of /proc (what /dev/stdout points at) lead to names that are no paths.
        if fs::metadata(&path).is_ok_and(|meta| !meta.is_file()) {
            return Ok(path);
        }
        let to = fs::read_link(&path)?;
        path = path.parent().unwrap_or(Path::new("")).join(to);
    }
    Err(io::Error::new(io::ErrorKind::InvalidInput, "the symbolic link leads in a circle"))
}
