//! `--json`: what a call of a batch did, in one document. The names of files and of the run are those of `export --json`.

use std::collections::BTreeMap;
use std::path::Path;

use serde::Serialize;

use super::forecast::ForecastRow;
use super::rows::Row;
use crate::cli::timings::{File, Run, Subject, Timings};
use crate::paths::show;

/// What a call has to say, and how it says it.
pub struct Report<'a> {
    pub is_json: bool,
    pub timings: Timings,
    /// The manifest and its sources.
    pub subject: Subject,
    pub out: &'a Path,
}

/// The names of `--json`: scripts rely on them.
#[derive(Serialize)]
struct Document<'a, D> {
    #[serde(flatten)]
    run: Run,
    #[serde(flatten)]
    subject: &'a Subject,
    #[serde(flatten)]
    done: D,
}

/// Trees that were grown.
#[derive(Serialize)]
struct Grown<'a> {
    /// In the order of their numbers, as in `parts`.
    trees: &'a [Row],
    failed: usize,
    /// Left out by `--resume`: their files are there.
    there: usize,
    /// Of all these trees, each once.
    files: Vec<File>,
}

/// What a merge found and made.
#[derive(Serialize)]
pub struct Merging {
    /// Trees whose files are all there.
    pub whole: usize,
    pub failed: usize,
    pub missing: Vec<usize>,
    pub files: Vec<File>,
}

/// What there will be.
#[derive(Serialize)]
struct Forecasted {
    forecast: ForecastRow,
    files: [File; 0],
}

impl Report<'_> {
    /// Says what was grown.
    pub fn grown(&mut self, mut trees: Vec<Row>, failed: usize, there: usize) -> anyhow::Result<()> {
        trees.sort_by_key(|row| row.index);
        let mut files: BTreeMap<&str, File> = BTreeMap::new();
        for file in trees.iter().flat_map(|row| &row.files) {
            let path = || show(&self.out.join(file.path.split('/').collect::<std::path::PathBuf>()));
            let known = files.entry(&file.path);
            let of_all = known.or_insert_with(|| File { path: path(), bytes: file.bytes, kept: true });
            // One of the trees that share a picture wrote it.
            of_all.kept &= file.kept;
        }
        let files = files.into_values().collect();
        self.print("grow", Grown { trees: &trees, failed, there, files })
    }

    /// Says what was put together.
    pub fn merged(&mut self, merging: Merging) -> anyhow::Result<()> {
        self.print("merge", merging)
    }

    /// Says what there will be.
    pub fn forecast(&mut self, forecast: ForecastRow) -> anyhow::Result<()> {
        self.print("forecast", Forecasted { forecast, files: [] })
    }

    fn print(&mut self, step: &'static str, done: impl Serialize) -> anyhow::Result<()> {
        self.timings.lap(step);
        crate::cli::print_json(&Document { run: self.timings.run(), subject: &self.subject, done })
    }
}
