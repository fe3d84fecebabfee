//! Models in folders that carry no recipe: files that were cut off, and those that linden did not write.

use std::path::{Path, PathBuf};

use linden::Monitor;
use linden::memory::OverMemory;
use linden_lint::{ENDINGS, ReadError};

use super::row::{Outcome, Row};
use crate::cli::lint::read_file;
use crate::exit::sentence;
use crate::progress::Progress;

/// What was found.
#[derive(Default)]
pub struct Strangers {
    /// What is called like a model, and is none.
    pub broken: Vec<Row>,
    /// What anyone may have written.
    pub whole: Vec<PathBuf>,
}

/// Looks at those of some files that are called like models. A recipe that was cut off with its file leaves a broken one.
pub fn among<'a>(paths: impl Iterator<Item = &'a PathBuf>, progress: &Progress) -> anyhow::Result<Strangers> {
    let mut found = Strangers::default();
    for path in paths.filter(|path| is_model(path)) {
        progress.check()?;
        match problem(path, progress) {
            None => found.whole.push(path.clone()),
            Some(reason) => {
                progress.check()?;
                found.broken.push(Row::new(path, Outcome::Failed).because(reason));
            }
        }
    }
    Ok(found)
}

fn is_model(path: &Path) -> bool {
    let ending = path.extension().map(|ending| ending.to_string_lossy().to_lowercase());
    ending.is_some_and(|ending| ENDINGS.contains(&&*ending))
}

/// Why a file is no model.
fn problem(path: &Path, progress: &Progress) -> Option<String> {
    // Of text without an end to its form, nothing is none too.
    if std::fs::metadata(path).is_ok_and(|about| about.len() == 0) {
        return Some("it is empty".to_owned());
    }
    let error = read_file(path, true, progress).err()?;
    // Points alone are a model too; what is too large or too new to be read may be whole.
    let is_beyond = matches!(
        error.downcast_ref(),
        Some(
            ReadError::NoTriangles(_)
                | ReadError::Elsewhere { .. }
                | ReadError::Beyond { .. }
                | ReadError::Memory(_)
        )
    );
    let may_be_whole = is_beyond || error.chain().any(<dyn std::error::Error>::is::<OverMemory>);
    (!may_be_whole).then(|| sentence(&error).replace(['\n', '\r'], " "))
}
