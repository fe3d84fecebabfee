//! Folders that the user allows with `--allow-path`, beside those that [`linden::trust`] always lets a document
//! name. What the user names is the user's to name.

use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use linden::trust;

use crate::paths::show;

/// Folders that the user allows, as they really are.
static ALLOWED: OnceLock<Vec<PathBuf>> = OnceLock::new();

/// Allows folders from now on; the first call counts.
///
/// # Errors
/// A folder that is not there.
pub fn allow(folders: &[PathBuf]) -> Result<(), String> {
    let real = |folder: &PathBuf| {
        let real = std::fs::canonicalize(folder);
        let real = real.map_err(|error| format!("--allow-path {}: {error}", show(folder)))?;
        if real.is_dir() { Ok(real) } else { Err(format!("--allow-path {}: not a directory", show(folder))) }
    };
    let folders = folders.iter().map(real).collect::<Result<_, _>>()?;
    ALLOWED.get_or_init(|| folders);
    Ok(())
}

fn allowed() -> &'static [PathBuf] {
    ALLOWED.get().map_or(&[], Vec::as_slice)
}

/// A file that a document may not name, and how to allow it.
#[derive(Debug, thiserror::Error)]
#[error("{0}; if you trust it, allow its folder with --allow-path {folder}", folder = show(&.0.folder))]
pub struct NotAllowed(trust::NotAllowed);

/// Where the file is that a document names (`None`: standard input).
///
/// # Errors
/// [`NotAllowed`], which says nothing about whether there is one.
pub fn beside(document: Option<&Path>, file: &str) -> Result<PathBuf, NotAllowed> {
    trust::beside(document, file, allowed()).map_err(NotAllowed)
}

/// Where a file that does not lie beside the document that names it may be looked for: under the same name in the folders that
/// the user allows, and then in the working directory. The latter may hold what the document's sender must not see: what is
/// found there counts where it is known to be what was meant.
pub fn elsewhere(file: &str) -> Vec<Elsewhere> {
    let within = |folder: &Path| trust::beside(Some(&folder.join("document")), file, &[]).ok();
    let allowed = allowed().iter().filter_map(|folder| within(folder));
    let allowed = allowed.map(|path| Elsewhere { path, is_allowed: true });
    let working = trust::beside(None, file, &[]).ok().map(|path| Elsewhere { path, is_allowed: false });
    allowed.chain(working).filter(|found| found.path.is_file()).collect()
}

/// A file under the name of one that is missing.
pub struct Elsewhere {
    /// Where it is.
    pub path: PathBuf,
    /// In a folder that the user allows.
    pub is_allowed: bool,
}

/// A program on the search path, as [`std::process::Command`] would find it, but in absolute folders
/// alone: what runs must not depend on where linden is run. A name with a `/` is a path already.
pub fn program(name: &str) -> Option<PathBuf> {
    if Path::new(name).components().count() > 1 {
        return Some(name.into());
    }
    linden_exporters::program_on_path(name)
}
