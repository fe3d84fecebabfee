//! `linden batch`: all trees of a manifest, or a part of them, each into files that are named by what they hold.

mod assembly;
mod contact;
mod forecast;
mod merge;
mod noted;
mod part;
pub mod plan;
mod report;
mod rows;
mod table;
mod template;
mod thumbnail;
pub mod work;

use std::path::PathBuf;

use anyhow::bail;
use clap::Args;
use linden::Monitor;

use self::forecast::Forecast;
use self::merge::Merged;
use self::noted::Noted;
use self::part::Part;
use self::plan::Plan;
use self::report::Report;
use self::rows::{Journal, Rows};
pub use self::rows::{PICTURES, listed_files};
use self::template::{Engine, Job};
use crate::cli::timings::{Subject, Timings};
use crate::exit::{say, usage};
use crate::paths::show;
use crate::progress::Progress;
use crate::source;

/// Grow and write all trees of a manifest, or a part of them
///
/// A manifest names sources, seeds, values of knobs and formats; 'docs/farms.md' shows one. Its trees are numbered from
/// 0. Files are named by what decides them, as ab/cdef….glb, so that any parts, repeated or side by side, give the same
/// files. A tree that fails is noted and stops no other.
#[derive(Args)]
#[expect(clippy::struct_excessive_bools, reason = "each is a flag of its own")]
pub struct Batch {
    /// The manifest: TOML, or JSON Lines with a tree a line
    #[arg(value_name = "MANIFEST")]
    manifest: PathBuf,

    /// Write into this folder
    #[arg(long, value_name = "DIR", default_value = "out")]
    out: PathBuf,

    /// Only trees with these numbers, like 0-99,200 or 0-999:10; with --merge, those of sheets and assemblies
    #[arg(long, value_name = "RANGES", conflicts_with = "shard")]
    only: Option<String>,

    /// Only part I of N, every Nth tree from I on; I counts from 0
    #[arg(long, value_name = "I/N")]
    shard: Option<String>,

    /// So many trees at a time, which share --memory; without, one for each thread
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    jobs: Option<u16>,

    /// Leave out trees whose files are there, whoever wrote them
    #[arg(long)]
    resume: bool,

    /// Stop at the first tree that fails
    #[arg(long)]
    fail_fast: bool,

    /// Wait until files are on the disk: without, a power cut can take the last of them, and --resume makes them again
    #[arg(long)]
    sync: bool,

    /// Grow nothing; say how many trees, bytes and seconds it will be
    #[arg(long, conflicts_with_all = ["merge", "resume"])]
    dry_run: bool,

    /// Grow nothing; write index.jsonl over all parts, and say what is missing
    #[arg(long, conflicts_with_all = NO_MERGE)]
    merge: bool,

    /// What was written, on standard output, machine-readable: a row a tree, and all files; with --dry-run the forecast, with
    /// --merge what was found
    #[arg(long)]
    json: bool,

    #[command(flatten)]
    merged: Merged,

    /// Grow nothing; print a job that spreads this batch over machines
    #[arg(long, value_name = "ENGINE", conflicts_with_all = NO_TEMPLATE)]
    template: Option<Engine>,

    /// For --template: so many parts, each some minutes of work at best; without, one for each ten trees, 1000 at
    /// most. Open Job Description finds that by itself
    #[arg(long, value_name = "N", requires = "template", conflicts_with_all = NO_TEMPLATE,
        value_parser = clap::value_parser!(u32).range(1..=100_000))]
    parts: Option<u32>,
}

/// What excludes `--merge`, and with it every flag that requires it: clap forgives a missing flag that could not be given.
const NO_MERGE: [&str; 4] = ["resume", "shard", "dry_run", "template"];

/// What excludes `--template`, likewise.
const NO_TEMPLATE: [&str; 6] = ["resume", "only", "shard", "dry_run", "merge", "json"];

/// The most parts that are taken without asking: what an array of Slurm may have as it is installed.
const MOST_PARTS: usize = 1000;

impl Batch {
    pub fn run(self) -> anyhow::Result<()> {
        let (progress, timings) = (Progress::new(), Timings::new());
        let plan = Plan::read(&self.manifest, &progress)?;
        if let Some(engine) = self.template {
            let trees = plan.len();
            let most = trees.div_ceil(10).min(MOST_PARTS);
            let shards = self.parts.map_or(most, |parts| (parts as usize).min(trees)).max(1);
            let job = Job { manifest: &self.manifest, out: &self.out, trees, shards };
            progress.clear();
            return super::print(&engine.print(&job));
        }
        let part = match (&self.only, &self.shard) {
            (Some(ranges), _) => Part::only(ranges, plan.len()),
            (_, Some(shard)) => Part::shard(shard, plan.len()),
            _ => Ok(Part::all(plan.len())),
        };
        let part = part.map_err(usage)?;
        let sources = plan.source_names().map(linden::knob::printable).collect();
        let subject = Subject { source: source::shown(&self.manifest), sources, ..Subject::default() };
        let mut report = Report { is_json: self.json, timings, subject, out: &self.out };
        report.timings.lap("read");
        if self.dry_run {
            let forecast = Forecast::of(&plan, &part, &progress)?;
            progress.clear();
            let jobs = self.jobs.map_or_else(rayon::current_num_threads, usize::from);
            return if self.json {
                report.forecast(forecast.row(jobs))
            } else {
                super::print(&forecast.text(jobs))
            };
        }
        if self.merge {
            let part = self.only.is_some().then_some(&part);
            return self.merged.write(&plan, part, report, &progress);
        }
        if let Some(shard) = self.shard.as_ref().filter(|_| part.numbers().next().is_none()) {
            say(&format!("note: shard {shard} has no trees: the manifest has only {}", plan.len()));
            return if self.json { report.grown(Vec::new(), 0, 0) } else { Ok(()) };
        }
        std::fs::create_dir_all(&self.out)
            .map_err(|error| anyhow::anyhow!("making the folder {}: {error}", show(&self.out)))?;
        let known = if self.resume { Rows::read(&self.out)? } else { Rows::default() };
        let (mut missing, mut there) = (Vec::new(), 0);
        for number in part.numbers() {
            progress.check()?;
            // What cannot be a tree at all is said by whoever comes to it, and stops no other.
            let is_there =
                self.resume && plan.tree(number).is_ok_and(|tree| known.whole(&tree, &self.out).is_some());
            if is_there {
                there += 1;
            } else {
                missing.push(number);
            }
        }
        let count = missing.len();
        if count == 0 {
            say("note: all of these trees are there already");
            return if self.json { report.grown(Vec::new(), 0, there) } else { Ok(()) };
        }
        let mut journal = Journal::begin(&self.out)?;
        let work = work::Work { plan: &plan, numbers: &missing, out: &self.out, sync: self.sync };
        let (mut failed, mut stopped, mut noted, mut rows) = (0, None, Noted::default(), Vec::new());
        work.run(self.jobs.map(usize::from), &progress, |row| {
            journal.write(&row)?;
            noted.add(&row);
            let error = row.error.as_ref().map(|error| format!("tree {}: {error}", row.index));
            if self.json {
                rows.push(row);
            }
            let Some(said) = error else { return Ok(true) };
            failed += 1;
            if self.fail_fast {
                stopped = Some(said);
                return Ok(false);
            }
            super::notes(&[said], &progress);
            Ok(true)
        })?;
        super::notes(&noted.lines(), &progress);
        progress.clear();
        if self.json {
            report.grown(rows, failed, there)?;
        }
        match (stopped, failed) {
            (Some(said), _) => bail!("{said}"),
            (None, 0) if self.json => Ok(()),
            (None, 0) => super::print(&format!("{count} trees written into {}\n", show(&self.out))),
            (None, failed) => bail!("{failed} of {count} trees failed; --resume tries them again"),
        }
    }
}
