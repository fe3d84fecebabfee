//! The files below a folder, for commands that take folders.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::Context;
use linden::Monitor;

use crate::paths::show;
use crate::progress::Progress;

/// All regular files below a folder, in order; links to folders are not followed. `visit` sees each folder before its files are
/// listed.
pub fn files_below(
    root: &Path,
    progress: &Progress,
    visit: &mut dyn FnMut(&Path) -> anyhow::Result<()>,
) -> anyhow::Result<Vec<PathBuf>> {
    let mut files = Vec::new();
    let mut folders = vec![root.to_owned()];
    while let Some(folder) = folders.pop() {
        progress.check()?;
        visit(&folder)?;
        let reading = || format!("reading the folder {}", show(&folder));
        for entry in fs::read_dir(&folder).with_context(reading)? {
            let entry = entry.with_context(reading)?;
            let kind = entry.file_type().with_context(reading)?;
            if kind.is_dir() {
                folders.push(entry.path());
            } else if kind.is_file() {
                files.push(entry.path());
            }
        }
    }
    files.sort_unstable();
    Ok(files)
}
