//! `linden verify`: grows the recipes of files again, and says whether the files are what they grow.

mod bytes;
mod find;
mod looks;
mod row;
mod strangers;
mod tree;

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use anyhow::bail;
use clap::Args;
use linden::recipe::VERSION;
use serde::Serialize;

use self::row::{Outcome, Row};
use self::strangers::Strangers;
use crate::cli::lint::whole_of;
use crate::exit::usage;
use crate::paths::show;
use crate::progress::Progress;

/// Grow the recipes of files again and compare
///
/// Trees are compared by their hashes; files by their bytes, where this version wrote them and they show with which
/// options. Nothing is written but into a temporary folder, which vanishes.
#[derive(Args)]
pub struct Verify {
    /// Files that linden wrote, or folders of such files, as 'linden batch' makes them
    #[arg(value_name = "FILE|DIR", required = true)]
    paths: Vec<PathBuf>,

    /// Take nothing but the same bytes for good: not the same tree alone
    #[arg(long)]
    bytes: bool,

    /// So many trees at a time, which share --memory; without, one for each thread
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    jobs: Option<u16>,

    /// Machine-readable
    #[arg(long)]
    json: bool,
}

/// The names of `--json`: scripts rely on them.
#[derive(Serialize)]
struct VerifyReport<'a> {
    linden: &'static str,
    files: &'a [Row],
    /// Files in folders that carry no recipe, as pictures beside them.
    others: usize,
    /// Those of them that are models, and whole.
    without_recipe: Vec<String>,
    good: usize,
    bad: usize,
}

impl Verify {
    pub fn run(self) -> anyhow::Result<()> {
        let progress = Progress::new();
        let found = find::find(&self.paths, &progress)?;
        let (mut rows, mut others) = (found.rows, found.others);
        rows.extend(tree::check(&found.groups, self.jobs.map(usize::from), &progress)?);
        let beside: BTreeSet<PathBuf> = rows.iter().flat_map(|row| row.beside.iter().cloned()).collect();
        others.retain(|path| !beside.contains(path));
        // What an index lists is somebody's; all else in a folder is not asked for.
        let are_all_compared = rows.iter().all(|row| row.outcome != Outcome::SameTree);
        rows.extend(found.listed.unchecked(&others, are_all_compared));
        let known: BTreeSet<PathBuf> = rows.iter().map(|row| row.path.clone()).collect();
        let Strangers { broken, mut whole } =
            strangers::among(others.iter().filter(|path| !known.contains(*path)), &progress)?;
        // A payload belongs to the layer beside it, which carries the recipe of both.
        whole.retain(|path| !whole_of(path).is_some_and(|layer| known.contains(&layer)));
        let failed: BTreeSet<&Path> = broken.iter().map(|row| row.path.as_path()).collect();
        others.retain(|path| !failed.contains(path.as_path()));
        rows.extend(broken);
        rows.sort_by(|a, b| a.path.cmp(&b.path));
        let is_good = |row: &&Row| row.outcome.is_good(self.bytes);
        let good = rows.iter().filter(is_good).count();
        let bad = rows.len() - good;
        progress.clear();
        if self.json {
            let without_recipe = whole.iter().map(|path| show(path)).collect();
            let (files, others) = (rows.as_slice(), others.len());
            let report = VerifyReport { linden: VERSION, files, others, without_recipe, good, bad };
            super::print_json(&report)?;
        } else {
            super::print(&table(&rows, &whole, others.len()))?;
        }
        if let (Some(path), true) = (self.paths.first(), found.absent == self.paths.len()) {
            return Err(usage(format!("there is no file or folder '{}'", show(path))));
        }
        match (rows.len(), bad) {
            (0, _) => bail!("no file there carries a recipe of linden's"),
            (_, 0) => Ok(()),
            (count, bad) => bail!("{bad} of {count} files are not verified"),
        }
    }
}

/// A line for each file, and how many of each kind there are.
fn table(rows: &[Row], without_recipe: &[PathBuf], others: usize) -> String {
    let mut text = String::new();
    for row in rows {
        text.push_str(&format!("{:11} {}\n", row.outcome.word(), row.file));
        if let Some(reason) = &row.reason {
            text.push_str(&format!("{:11}   {reason}\n", ""));
        }
    }
    for path in without_recipe {
        text.push_str(&format!("{:11} {}\n", "no recipe", show(path)));
    }
    let counts = Outcome::ALL.iter().filter_map(|outcome| {
        let count = rows.iter().filter(|row| row.outcome == *outcome).count();
        (count > 0).then(|| format!("{count} {}", outcome.word()))
    });
    let mut counts: Vec<String> = counts.collect();
    if others > 0 {
        counts.push(format!("{others} others without a recipe"));
    }
    text + &format!("\n{}\n", counts.join(", "))
}
