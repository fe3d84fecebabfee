//! Staged files go to their places together, or none does.
//!
//! What takes time comes first: syncing, naming, looking. Then each file comes into its place by one
//! call that swaps it for the one before (the last one simply replaces it), so that at every moment
//! each place holds the old file or the new one, whole. What was swapped out is the way back until all
//! are in their places, and then goes. Should we be killed between two files, the next run in that folder
//! [completes](super::record) what was begun.

use std::collections::{BTreeMap, BTreeSet};
use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};

use super::file_system::{FileSystem, again, synced};
use super::record::Record;
use super::referring::ensure_unreferred;
use super::staged::Staged;
use super::temporary::{PART, TempName, placing};
use super::{Bundle, Files, Place};
use crate::ExportError;
use crate::system::{REPLACES_OPEN_FILES, TELLS_FILES_APART, compared, mode_of};

/// A file that an export has left.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Written {
    /// Where, in the directory as the target named it.
    pub path: PathBuf,
    /// How long it is.
    pub bytes: u64,
    /// Whether it was left alone because it was there with the same bytes: [`Bundle::sparing_same`], and pictures that many
    /// exports share.
    pub kept: bool,
}

/// Checks that no two bundles have the same main file: worth doing before a tree is grown.
///
/// # Errors
/// [`ExportError::SameTarget`].
pub fn ensure_distinct(bundles: &[Bundle]) -> Result<(), ExportError> {
    let mut seen = BTreeSet::new();
    for files in bundles.iter().filter_map(files_of) {
        if !seen.insert(compared(files.main.location.path())) {
            return Err(ExportError::SameTarget { path: files.main.location.shown_path() });
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
    for bundle in bundles {
        let Some(Files { main, sides, .. }) = files_of(bundle) else { continue };
        let mut real = BTreeSet::new();
        for source in sources {
            match again(|| bundle.system.canonicalize(source)) {
                Ok(path) => real.extend([compared(path)]),
                // A source that is gone by now cannot be replaced any more.
                Err(e) if e.kind() == io::ErrorKind::NotFound => {}
                Err(e) => return Err(super::target::looking(source, e)),
            }
        }
        let mut locations = std::iter::once(main).chain(sides).map(|staged| &staged.location);
        if let Some(location) = locations.find(|location| real.contains(&compared(location.path()))) {
            let problem = "the tree is grown from that file; choose another name".to_owned();
            return Err(ExportError::Target { path: location.shown_path(), problem });
        }
    }
    Ok(())
}

/// Puts the files of all bundles in their places: side files first and main files last, so that
/// nothing ever refers to a file that is not there. When one cannot be placed, those already placed
/// are taken back and what was there before is put back. Bundles may share side files (the same
/// picture beside an OBJ and a glTF) as long as they agree in every byte. A side file with other bytes is replaced only
/// where no file refers to it but those that are replaced too.
///
/// Files are on the disk before they are placed, and their folders afterwards, unless a bundle is
/// [unsynced](Bundle::unsynced).
///
/// Gives what was written, bundle by bundle, the main file first, and the shared pictures that were there.
///
/// # Errors
/// [`ExportError::SameTarget`], [`ExportError::Referred`] and [`ExportError::Io`]. One of `syncing the directory of` comes when all
/// files are in their places; any other leaves what was there before.
pub fn commit_all(bundles: Vec<Bundle>) -> Result<Vec<Written>, ExportError> {
    ensure_distinct(&bundles)?;
    let Some(system) = bundles.first().map(|bundle| bundle.system) else { return Ok(Vec::new()) };
    let mut written = Vec::new();
    let mut mains = Vec::new();
    let mut sides = BTreeMap::new();
    let mut folders = BTreeMap::new();
    let mut stems = BTreeSet::new();
    let mut stay = BTreeSet::new();
    for bundle in bundles {
        let (is_synced, spares_same) = (bundle.is_synced, bundle.spares_same);
        let families = bundle.membership.map_or_else(Vec::new, |membership| membership.families);
        let Place::Files(Files { stem, main, sides: side_files, there }) = bundle.place else { continue };
        stems.extend(families.into_iter().chain([stem]));
        for staged in std::iter::once(&main).chain(&side_files) {
            if !staged.whole {
                let source = io::Error::other("its writer has not finished");
                return Err(staged.location.failed("placing", source));
            }
            let kept = spares_same && is_there(system, staged);
            if kept {
                stay.insert(compared(staged.location.path()));
            } else if is_synced {
                staged.sync().map_err(|source| staged.location.failed("syncing", source))?;
                folders.entry(staged.location.folder.clone()).or_insert_with(|| staged.location.clone());
            }
            written.push(Written { path: staged.location.shown_path(), bytes: staged.bytes, kept });
        }
        written.extend(there);
        for side in side_files {
            let path = compared(side.location.path());
            if sides.get(&path).is_some_and(|other| !side.holds_same(other)) {
                return Err(ExportError::SameTarget { path: side.location.shown_path() });
            }
            sides.insert(path, side);
        }
        mains.push(main);
    }
    if let Some(main) = mains.iter().find(|main| sides.contains_key(&compared(main.location.path()))) {
        return Err(ExportError::SameTarget { path: main.location.shown_path() });
    }
    let replaced =
        sides.keys().cloned().chain(mains.iter().map(|main| compared(main.location.path()))).collect();
    ensure_unreferred(system, sides.values(), &stems, &replaced)?;
    let moves = |staged: &Staged| !stay.contains(&compared(staged.location.path()));
    place_all(system, sides.into_values().chain(mains).filter(moves).collect())?;
    for (folder, location) in folders {
        let done = again(|| system.open_folder(&folder)).and_then(|open| again(|| system.sync(&open)));
        synced(done).map_err(|source| location.failed("syncing the directory of", source))?;
    }
    Ok(written)
}

/// Whether a file with these bytes is in its place.
fn is_there(system: &'static dyn FileSystem, staged: &Staged) -> bool {
    let path = staged.location.path();
    let is_like = |meta: std::fs::Metadata| meta.is_file() && meta.len() == staged.bytes;
    again(|| system.symlink_metadata(&path)).is_ok_and(is_like)
        && again(|| system.open(&path)).is_ok_and(|there| staged.holds_same_as(system, &there))
}

fn files_of(bundle: &Bundle) -> Option<&Files> {
    match &bundle.place {
        Place::Files(files) => Some(files),
        Place::Stream { .. } | Place::Pipe { .. } | Place::Memory(_) => None,
    }
}

/// A file that only has to be renamed, and the one that is in its place now.
struct Ready {
    staged: Staged,
    exists: bool,
    /// The one in its place, locked, so that no other program sweeps it away while it is set aside.
    before: Option<File>,
}

/// A file in its place, and the way back.
struct Placed {
    path: PathBuf,
    /// The file that was there before; `None`: there was none.
    before: Option<(TempName, Option<File>)>,
}

fn place_all(system: &'static dyn FileSystem, staged: Vec<Staged>) -> Result<(), ExportError> {
    let mut ready = Vec::with_capacity(staged.len());
    for staged in staged {
        let location = staged.location.clone();
        ready.push(prepare(system, staged).map_err(|source| location.failed("placing", source))?);
    }
    let records = records(system, &ready)?;
    let _guard = placing();
    let mut placed = Vec::with_capacity(ready.len());
    let mut rest = ready.into_iter().peekable();
    while let Some(next) = rest.next() {
        let location = next.staged.location.clone();
        match place(system, next, rest.peek().is_none()) {
            Ok(done) => placed.push(done),
            Err(source) => {
                drop(records);
                let source = take_back(system, placed, source);
                return Err(location.failed("placing", source));
            }
        }
    }
    // Then the way back: as long as there is a record, what is set aside may be asked for.
    drop(records);
    drop(placed);
    Ok(())
}

/// What is about to be placed, for the next run to complete where several files belong together. There is
/// none where files cannot be told apart.
fn records(system: &'static dyn FileSystem, ready: &[Ready]) -> Result<Vec<Record>, ExportError> {
    if !TELLS_FILES_APART {
        return Ok(Vec::new());
    }
    let several = ready.iter().map(|ready| &ready.staged).filter(|_| ready.len() > 1);
    let failed = |source| ready[0].staged.location.failed("placing", source);
    let files = several.clone().map(|staged| (staged.temp_path().to_owned(), staged.location.path()));
    let text = Record::text(system, files).map_err(failed)?;
    let folders: BTreeSet<&Path> = several.map(|staged| staged.location.folder.as_path()).collect();
    folders.into_iter().map(|folder| Record::write(system, folder, &text).map_err(failed)).collect()
}

/// All that can be done for a file before it is placed.
fn prepare(system: &'static dyn FileSystem, mut staged: Staged) -> io::Result<Ready> {
    let path = staged.location.path();
    let there = match again(|| system.symlink_metadata(&path)) {
        Ok(meta) if meta.is_dir() => return Err(io::ErrorKind::IsADirectory.into()),
        Ok(meta) => Some(meta),
        Err(e) if e.kind() == io::ErrorKind::NotFound => None,
        Err(e) => return Err(e),
    };
    let before = there.as_ref().filter(|meta| meta.is_file()).and_then(|meta| {
        if let Some(mode) = mode_of(meta) {
            staged.set_mode(mode);
        }
        if !REPLACES_OPEN_FILES {
            return None;
        }
        let open = again(|| system.open(&path)).ok()?;
        let _ = again(|| system.try_lock(&open));
        Some(open)
    });
    staged.name()?;
    Ok(Ready { staged, exists: there.is_some(), before })
}

fn place(system: &'static dyn FileSystem, ready: Ready, is_last: bool) -> io::Result<Placed> {
    use io::ErrorKind::{InvalidInput, NotFound, Unsupported};
    let Ready { staged, exists, before } = ready;
    let path = staged.location.path();
    if exists && !is_last {
        match again(|| system.exchange(staged.temp_path(), &path)) {
            Ok(()) => {
                let aside = staged.into_name().map(|name| (name, before));
                return Ok(Placed { path, before: aside });
            }
            // It has vanished: nothing is to be put back.
            Err(e) if e.kind() == NotFound => {}
            // The words of systems and file systems that do not know it.
            Err(e) if matches!(e.kind(), InvalidInput | Unsupported) => {
                let aside = set_aside(system, &staged, &path, before)?;
                again(|| system.rename(staged.temp_path(), &path))?;
                staged.placed();
                return Ok(Placed { path, before: Some(aside) });
            }
            Err(e) => return Err(e),
        }
    }
    again(|| system.rename(staged.temp_path(), &path))?;
    staged.placed();
    Ok(Placed { path, before: None })
}

/// Gives the file at `path` a second name; where the file system knows no links either, a copy has it.
/// There is no moment without the file.
fn set_aside(
    system: &'static dyn FileSystem,
    staged: &Staged,
    path: &Path,
    before: Option<File>,
) -> io::Result<(TempName, Option<File>)> {
    let linked = TempName::new(system, &staged.location.folder, PART, |aside| system.link(path, aside));
    if let Ok((aside, ())) = linked {
        return Ok((aside, before));
    }
    let from = match before {
        Some(open) => open,
        None => again(|| system.open(path))?,
    };
    let (aside, copy) = staged.copy(&from)?;
    if let Ok(meta) = from.metadata()
        && let Some(mode) = mode_of(&meta)
    {
        let _ = again(|| system.set_mode(&copy, mode));
    }
    Ok((aside, Some(copy)))
}

/// Undoes everything, last first; gives `why` with what could not be undone.
fn take_back(system: &'static dyn FileSystem, placed: Vec<Placed>, why: io::Error) -> io::Error {
    let mut stuck = Vec::new();
    for Placed { path, before } in placed.into_iter().rev() {
        let undo = || match &before {
            Some((aside, _)) => again(|| system.rename(aside.path(), &path)),
            None => again(|| system.remove(&path)),
        };
        // What fails once may do so by chance.
        match undo().or_else(|_| undo()) {
            Ok(()) => before.map(|(aside, _)| aside.gone()),
            Err(e) => {
                stuck.push(format!("{} ({e})", linden_pipeline::knob::printable(&path.to_string_lossy())));
                None
            }
        };
    }
    if stuck.is_empty() {
        why
    } else {
        io::Error::new(why.kind(), format!("{why}; could not put back {}", stuck.join(", ")))
    }
}
