//! `linden bench`: how many trees this machine makes, so that a farm can be sized.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use anyhow::{Context, bail};
use clap::Args;
use indicatif::{BinaryBytes, HumanCount};
use linden::manifest::{Manifest, Sampling, Seeds, TreeKind, Values, Varied};
use serde::Serialize;
use unicode_width::UnicodeWidthStr;

use super::batch::plan::Plan;
use super::batch::work::Work;
use crate::forecast::Outlook;
use crate::paths::show;
use crate::progress::Progress;
use crate::system::cpu_time;

/// Plants from the smallest to the largest, of all ways to grow.
const USUAL: [&str; 6] = ["bush-3d", "abop-honda-a", "fir", "silver-birch", "oak", "abop-ternary-c"];

/// Seeds to grow: more than a machine makes in the time.
const SEEDS: u64 = 1_000_000;

/// Measure how many trees an hour this machine makes, by preset
///
/// Each source grows with one seed after another and is written as 'linden batch' writes it, then taken away again.
/// Bark and leaves are drawn before the clock starts: a batch draws them once.
#[derive(Args)]
pub struct Bench {
    /// What is grown: presets or files; without, six plants from a shrub to an oak
    #[arg(value_name = "SOURCE")]
    sources: Vec<String>,

    /// The format that is written
    #[arg(long, value_name = "FORMAT", default_value = "glb")]
    format: String,

    /// Turn a knob, like triangles=20000
    #[arg(long, value_name = "KNOB=VALUE")]
    set: Vec<String>,

    /// For so long each, and at least one tree for each job
    #[arg(long, value_name = "SECONDS", default_value_t = 5.0, value_parser = seconds)]
    seconds: f64,

    /// So many trees at a time; without, one for each thread
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    jobs: Option<u16>,

    /// Write into a folder within this one: the disk counts, too; without, where the system has temporary files
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,

    /// Machine-readable
    #[arg(long)]
    json: bool,
}

fn seconds(text: &str) -> Result<f64, String> {
    let seconds: f64 = text.parse().map_err(|_| "expected a number of seconds".to_owned())?;
    if (0.0..=86_400.0).contains(&seconds) {
        Ok(seconds)
    } else {
        Err("expected 0 to 86400 seconds".to_owned())
    }
}

/// The names of `--json`: scripts rely on them.
#[derive(Serialize)]
struct Benchmark {
    linden: &'static str,
    /// Threads that the machine has, or that there may be.
    threads: usize,
    /// Trees at a time.
    jobs: usize,
    format: String,
    rates: Vec<Rate>,
}

#[derive(Serialize)]
struct Rate {
    source: String,
    /// Trees that were written in that time.
    trees: usize,
    seconds: f64,
    trees_per_hour: f64,
    /// Of all threads; null where the system does not tell.
    cpu_seconds_per_tree: Option<f64>,
    /// All files but pictures that trees share, mean.
    bytes_per_tree: f64,
    nodes_per_tree: f64,
    /// What a tree holds while it is written at least, by its forecast.
    least_memory_bytes_per_tree: Option<u64>,
}

impl Bench {
    pub fn run(self) -> anyhow::Result<()> {
        let progress = Progress::new();
        let jobs = self.jobs.map_or_else(rayon::current_num_threads, usize::from);
        let folder = match &self.out {
            Some(out) => {
                tempfile::tempdir_in(out).with_context(|| format!("making a folder in {}", show(out)))?
            }
            None => tempfile::tempdir().context("making a temporary folder")?,
        };
        let sources =
            if self.sources.is_empty() { USUAL.map(str::to_owned).to_vec() } else { self.sources.clone() };
        // A mistake in one of them is found before the first grows.
        let plans = sources.iter().map(|source| Plan::typed(self.manifest(source)?, &progress));
        let plans: Vec<Plan> = plans.collect::<anyhow::Result<_>>()?;
        let mut rates = Vec::with_capacity(plans.len());
        for (source, plan) in sources.iter().zip(&plans) {
            let rate = self.rate(source, plan, jobs, folder.path(), &progress);
            rates.push(rate.with_context(|| format!("growing {source}"))?);
        }
        progress.clear();
        let linden = linden::recipe::VERSION;
        let format = self.format.clone();
        let found = Benchmark { linden, threads: rayon::current_num_threads(), jobs, format, rates };
        if self.json { super::print_json(&found) } else { super::print(&found.text()) }
    }

    fn manifest(&self, source: &str) -> anyhow::Result<Manifest> {
        let set = super::split_pairs(&self.set, "--set", "KNOB=VALUE, like --set triangles=20000")?;
        let varied = |(name, value)| Varied { name, values: Values::Each(vec![value]) };
        let kind = TreeKind {
            source: source.to_owned(),
            formats: Vec::new(),
            ages: Vec::new(),
            seeds: Some(Seeds::Range(1, SEEDS)),
            samples: 1,
            sampling: Sampling::default(),
            set: set.into_iter().map(varied).collect(),
            define: Vec::new(),
        };
        Ok(Manifest { formats: vec![self.format.clone()], trees: vec![kind], ..Manifest::default() })
    }

    fn rate(
        &self,
        source: &str,
        plan: &Plan,
        jobs: usize,
        out: &Path,
        progress: &Progress,
    ) -> anyhow::Result<Rate> {
        // The last tree draws what all share.
        let last = [plan.len() - 1];
        let numbers: Vec<usize> = (0..last[0]).collect();
        let mut work = Work { plan, numbers: &last, out, sync: false };
        let tree = plan.tree(0)?;
        let outlook = Outlook::of(&tree.recipe, progress);
        let (mut trees, mut bytes, mut nodes) = (0, 0, 0);
        let (mut started, mut worked, mut took) = (Instant::now(), cpu_time(), Duration::ZERO);
        for is_counted in [false, true] {
            work.run(Some(jobs), progress, |row| {
                if let Some(error) = row.error {
                    bail!("tree {}: {error}", row.index);
                }
                let own = row.files.iter().filter(|file| file.shared().is_none());
                for file in own.clone() {
                    let path = out.join(&file.path);
                    std::fs::remove_file(&path).with_context(|| format!("removing {}", show(&path)))?;
                }
                trees += 1;
                bytes += own.map(|file| file.bytes).sum::<u64>();
                nodes += row.nodes.unwrap_or(0);
                took = started.elapsed();
                Ok(is_counted && (took.as_secs_f64() < self.seconds || trees < jobs))
            })?;
            if !is_counted {
                (trees, bytes, nodes, work.numbers) = (0, 0, 0, &numbers);
                (started, worked) = (Instant::now(), cpu_time());
            }
        }
        let cpu = worked.zip(cpu_time()).map(|(before, now)| now.saturating_sub(before).as_secs_f64());
        let (seconds, count) = (took.as_secs_f64(), trees as f64);
        Ok(Rate {
            source: source.to_owned(),
            trees,
            seconds,
            trees_per_hour: count / seconds * 3600.0,
            cpu_seconds_per_tree: cpu.map(|cpu| cpu / count),
            bytes_per_tree: bytes as f64 / count,
            nodes_per_tree: nodes as f64 / count,
            least_memory_bytes_per_tree: outlook.map(|outlook| outlook.held_bytes(&tree.formats())),
        })
    }
}

impl Benchmark {
    fn text(&self) -> String {
        let width = self.rates.iter().map(|rate| rate.source.width()).max().unwrap_or(0).max(6);
        let mut text =
            format!("{:width$}  {:>9}  {:>9}  {:>9}  {:>9}\n", "", "trees/h", "CPU s", "bytes", "memory");
        for rate in &self.rates {
            let cpu = rate.cpu_seconds_per_tree.map_or_else(|| "-".to_owned(), |cpu| format!("{cpu:.4}"));
            let memory = rate.least_memory_bytes_per_tree;
            let memory = memory.map_or_else(|| "-".to_owned(), |bytes| BinaryBytes(bytes).to_string());
            let per_hour = HumanCount(rate.trees_per_hour as u64).to_string();
            let bytes = BinaryBytes(rate.bytes_per_tree as u64).to_string();
            let pad = " ".repeat(width - rate.source.width());
            text += &format!("{}{pad}  {per_hour:>9}  {cpu:>9}  {bytes:>9}  {memory:>9}\n", rate.source);
        }
        let Self { linden, threads, jobs, format, .. } = self;
        text += &format!(
            "\nlinden {linden}, {format}, {jobs} at a time on {threads} threads; CPU, bytes and memory are for a tree\n"
        );
        text
    }
}

#[cfg(test)]
mod tests {
    use super::USUAL;

    #[test]
    fn what_is_grown_without_a_word_is_there() {
        for id in USUAL {
            assert!(linden::preset::builtin(id).is_ok(), "{id}");
        }
    }
}
