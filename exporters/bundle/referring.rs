//! Side files that files of other exports refer to: replacing them would change what those show.

use std::collections::{BTreeMap, BTreeSet};
use std::ffi::OsString;
use std::fs::File;
use std::io::{self, BufReader};
use std::path::{Path, PathBuf};

use super::file_system::{FileSystem, again};
use super::staged::Staged;
use super::stem;
use crate::gltf::percent_encoded;
use crate::system::compared;
use crate::usdc::Names;
use crate::{ExportError, REGISTRY};

/// Checks that no side file replaces one with other bytes that a file refers to which this export does not
/// replace. `stems` are what names of its side files begin with; `replaced` are all its files, without links.
/// What cannot be read is not in the way.
///
/// # Errors
/// [`ExportError::Referred`].
pub(super) fn ensure_unreferred<'a>(
    system: &dyn FileSystem,
    sides: impl Iterator<Item = &'a Staged>,
    stems: &BTreeSet<String>,
    replaced: &BTreeSet<PathBuf>,
) -> Result<(), ExportError> {
    let mut listed: BTreeMap<&Path, Vec<OsString>> = BTreeMap::new();
    for staged in sides {
        let location = &staged.location;
        if again(|| system.symlink_metadata(&location.path())).is_err() {
            continue;
        }
        let names = listed.entry(&location.folder).or_insert_with(|| {
            let mut names = again(|| system.names(&location.folder)).unwrap_or_default();
            names.sort();
            names
        });
        let side = location.name.to_string_lossy();
        let others = names.iter().filter(|name| may_refer(Path::new(name), &side, stems));
        let others = others.map(|name| location.folder.join(name));
        let others: Vec<PathBuf> =
            others.filter(|path| !replaced.contains(&compared(path.clone()))).collect();
        let is_same = || {
            let before = again(|| system.open(&location.path()));
            before.is_ok_and(|before| staged.holds_same_as(system, &before))
        };
        if others.is_empty() || is_same() {
            continue;
        }
        if let Some(other) = others.iter().find(|path| refers(system, path, &side)) {
            // A library of materials is known by the file that it belongs to.
            let owner = other.with_extension("obj");
            let is_library = other.extension().is_some_and(|ending| ending == "mtl");
            let other = if is_library && others.contains(&owner) { &owner } else { other };
            let by = location.shown_path().with_file_name(other.file_name().unwrap_or_default());
            return Err(ExportError::Referred { path: location.shown_path(), by });
        }
    }
    Ok(())
}

/// Whether a file is of a format with files beside it, and of a name that goes with that of the side file.
fn may_refer(path: &Path, side: &str, stems: &BTreeSet<String>) -> bool {
    let is_library = path.extension().is_some_and(|ending| ending == "mtl");
    let mut formats = REGISTRY.iter().map(|exporter| exporter.format());
    let has_sides = formats.any(|format| !format.self_contained && format.ending_of(path).is_some());
    let stem = stem::plain(path);
    (is_library || has_sides)
        && (side.starts_with(&stem) || stems.iter().any(|of_export| stem.starts_with(of_export)))
}

/// Whether a file names the side file.
pub(super) fn refers(system: &dyn FileSystem, path: &Path, side: &str) -> bool {
    let look = || -> io::Result<bool> {
        let file = again(|| system.open(path))?;
        if !file.metadata()?.is_file() {
            return Ok(false);
        }
        if let Some(names) = Names::read(&mut BufReader::new(&file))? {
            return Ok(names.has_file(side));
        }
        let encoded = percent_encoded(side);
        Ok(contains(system, &file, side)? || (encoded != side && contains(system, &file, &encoded)?))
    };
    look().unwrap_or(false)
}

/// Whether a file holds a name that is no part of a longer one.
fn contains(system: &dyn FileSystem, file: &File, name: &str) -> io::Result<bool> {
    const PIECE: usize = 1 << 16;
    let goes_on = |byte: u8| byte.is_ascii_alphanumeric() || !byte.is_ascii() || b"-_.+%".contains(&byte);
    let name = name.as_bytes();
    let stands_in = |window: &[u8]| {
        window[1..].starts_with(name) && !goes_on(window[0]) && !goes_on(window[name.len() + 1])
    };
    // Before and behind a file no name goes on.
    let mut text = vec![b'\n'];
    let mut offset = 0;
    loop {
        let kept = text.len();
        text.resize(kept + PIECE, b'\n');
        let count = again(|| system.read_at(file, &mut text[kept..], offset))?;
        offset += count as u64;
        text.truncate(kept + count.max(1));
        if text.windows(name.len() + 2).any(stands_in) {
            return Ok(true);
        }
        if count == 0 {
            return Ok(false);
        }
        text.drain(..text.len().saturating_sub(name.len() + 1));
    }
}
