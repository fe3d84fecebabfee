//! Staged files go to their places together, or none does.

use std::collections::{BTreeMap, BTreeSet};
use std::fs::{self, File};
use std::io::{self, Read};
use std::path::{Path, PathBuf};

use tempfile::NamedTempFile;

use super::{Bundle, Files, Place, Staged, show, under};
use crate::ExportError;

/// A file that an export has left.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Written {
    /// Where, in the directory as the target named it.
    pub path: PathBuf,
    /// How long it is.
    pub bytes: u64,
}

/// Checks that no two bundles have the same main file: worth doing before a tree is grown.
///
/// # Errors
/// [`ExportError::SameTarget`].
pub fn ensure_distinct(bundles: &[Bundle]) -> Result<(), ExportError> {
    let mut seen = BTreeSet::new();
    for files in bundles.iter().filter_map(files_of) {
        if !seen.insert(files.dir.join(&files.main.name)) {
            return Err(ExportError::SameTarget { path: under(&files.shown, &files.main.name) });
        }
    }
    Ok(())
}

/// Checks that no file of a bundle would replace one of `sources`, which the tree is grown from.
/// Side files are known once they are written.
///
/// # Errors
/// [`ExportError::Target`].
pub fn ensure_spared(bundles: &[Bundle], sources: &[PathBuf]) -> Result<(), ExportError> {
    // A source that is gone by now cannot be replaced any more.
    let sources: BTreeSet<PathBuf> = sources.iter().filter_map(|path| fs::canonicalize(path).ok()).collect();
    for Files { shown, dir, main, sides, .. } in bundles.iter().filter_map(files_of) {
        if let Some(staged) =
            std::iter::once(main).chain(sides).find(|staged| sources.contains(&dir.join(&staged.name)))
        {
            let problem = "the tree is grown from that file; choose another name".to_owned();
            return Err(ExportError::Target { path: under(shown, &staged.name), problem });
        }
    }
    Ok(())
}

/// Puts the files of all bundles in their places: side files first and main files last, so that
/// nothing ever refers to a file that is not there. When one cannot be placed, those already placed
/// are taken back and what was there before is put back. Bundles may share side files (the same
/// picture beside an OBJ and a glTF) as long as they agree in every byte.
///
/// Gives what was written, bundle by bundle, the main file first.
///
/// # Errors
/// [`ExportError::SameTarget`] and [`ExportError::Io`].
pub fn commit_all(bundles: Vec<Bundle>) -> Result<Vec<Written>, ExportError> {
    ensure_distinct(&bundles)?;
    let mut written = Vec::new();
    let mut mains = Vec::new();
    let mut sides: BTreeMap<PathBuf, (PathBuf, Staged)> = BTreeMap::new();
    for bundle in bundles {
        let Place::Files(Files { shown, dir, main, sides: own, .. }) = bundle.place else { continue };
        for staged in std::iter::once(&main).chain(&own) {
            if !staged.whole {
                let source = io::Error::other("its writer has not finished");
                return Err(ExportError::Io { doing: "placing", what: show(&shown, &staged.name), source });
            }
            written.push(Written { path: under(&shown, &staged.name), bytes: staged.bytes });
        }
        for side in own {
            let path = dir.join(&side.name);
            if let Some((_, other)) = sides.get(&path)
                && !same_bytes(other, &side)
            {
                return Err(ExportError::SameTarget { path: under(&shown, &side.name) });
            }
            sides.insert(path, (shown.clone(), side));
        }
        mains.push((dir.join(&main.name), (shown, main)));
    }
    if let Some((path, _)) = mains.iter().find(|(path, _)| sides.contains_key(path)) {
        return Err(ExportError::SameTarget { path: path.clone() });
    }
    let mut placed = Vec::new();
    for (path, (shown, staged)) in sides.into_iter().chain(mains) {
        let what = show(&shown, &staged.name);
        match place(staged, &path) {
            Ok(done) => placed.push(done),
            Err(source) => {
                let source = take_back(placed, source);
                return Err(ExportError::Io { doing: "placing", what, source });
            }
        }
    }
    Ok(written)
}

fn files_of(bundle: &Bundle) -> Option<&Files> {
    match &bundle.place {
        Place::Files(files) => Some(files),
        Place::Stream { .. } => None,
    }
}

/// Whether two staged files hold the same; a file that cannot be read is unlike any other.
fn same_bytes(a: &Staged, b: &Staged) -> bool {
    let compare = || -> io::Result<bool> {
        if a.bytes != b.bytes {
            return Ok(false);
        }
        let (mut a, mut b) = (File::open(a.file.path())?, File::open(b.file.path())?);
        let mut pieces = [vec![0; 1 << 16], vec![0; 1 << 16]];
        loop {
            let read = a.read(&mut pieces[0])?;
            if read == 0 {
                return Ok(true);
            }
            b.read_exact(&mut pieces[1][..read])?;
            if pieces[0][..read] != pieces[1][..read] {
                return Ok(false);
            }
        }
    };
    compare().unwrap_or(false)
}

/// A file in its place, and the one that was there before under a name of its own.
struct Placed {
    path: PathBuf,
    /// Removed when dropped.
    before: Option<NamedTempFile<()>>,
}

fn place(staged: Staged, path: &Path) -> io::Result<Placed> {
    let before = match fs::symlink_metadata(path) {
        Ok(meta) if meta.is_dir() => return Err(io::ErrorKind::IsADirectory.into()),
        Ok(meta) => {
            if meta.is_file() {
                keep_permissions(&staged, &meta);
            }
            Some(set_aside(path)?)
        }
        Err(e) if e.kind() == io::ErrorKind::NotFound => None,
        Err(e) => return Err(e),
    };
    if let Err(e) = staged.file.persist(path) {
        // Where links are unknown the place is empty now. Where they are known nothing has changed,
        // and dropping the second name is all there is to do.
        if let Some(before) = before.filter(|_| fs::symlink_metadata(path).is_err()) {
            before.persist(path).map_err(|e| e.error)?;
        }
        return Err(e.error);
    }
    Ok(Placed { path: path.to_owned(), before })
}

/// Gives the file at `path` a second name, so that there is no moment without it; where the file
/// system knows no links, its only other name.
fn set_aside(path: &Path) -> io::Result<NamedTempFile<()>> {
    let dir = path.parent().unwrap_or(Path::new("."));
    tempfile::Builder::new().prefix(".linden-").suffix(".before").make_in(dir, |aside| {
        fs::hard_link(path, aside).or_else(|e| match e.kind() {
            // The caller tries another name.
            io::ErrorKind::AlreadyExists => Err(e),
            _ => fs::rename(path, aside),
        })
    })
}

/// The replaced file's permissions; a file system without any refuses, and then there is no loss.
fn keep_permissions(staged: &Staged, replaced: &fs::Metadata) {
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        let mode = replaced.permissions().mode() & 0o777;
        let _ = fs::set_permissions(staged.file.path(), fs::Permissions::from_mode(mode));
    }
    #[cfg(not(unix))]
    let _ = (staged, replaced);
}

/// Undoes everything, last first; gives `why` with what could not be undone.
fn take_back(placed: Vec<Placed>, why: io::Error) -> io::Error {
    let mut stuck = Vec::new();
    for Placed { path, before } in placed.into_iter().rev() {
        let undone = match before {
            Some(before) => before.persist(&path).map_err(|e| e.error),
            None => fs::remove_file(&path),
        };
        if let Err(e) = undone {
            stuck.push(format!("{} ({e})", linden::knob::printable(&path.to_string_lossy())));
        }
    }
    if stuck.is_empty() {
        why
    } else {
        io::Error::new(why.kind(), format!("{why}; could not put back {}", stuck.join(", ")))
    }
}
