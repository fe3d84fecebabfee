//! Grows and writes trees, some at a time.

use std::path::Path;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc;
use std::time::Instant;

use anyhow::Context;
use linden::Monitor;
use linden::dress::levels;
use linden::grow::grow;
use linden::monitor::{Holding, Phase};
use linden_exporters::{Batch, Bundle, Output};

use super::plan::{Plan, Tree};
use super::rows::{Row, WrittenFile};
use crate::cli::share::Share;
use crate::exit::sentence;
use crate::progress::Progress;

/// What is to be done.
pub struct Work<'a> {
    pub plan: &'a Plan,
    pub numbers: &'a [usize],
    pub out: &'a Path,
    /// Whether to wait for the disk.
    pub sync: bool,
}

impl Work<'_> {
    /// Does it, and gives each row to `take` as it comes, until that says false or fails.
    pub fn run(
        &self,
        jobs: Option<usize>,
        progress: &Progress,
        mut take: impl FnMut(Row) -> anyhow::Result<bool>,
    ) -> anyhow::Result<()> {
        let threads = rayon::current_num_threads();
        let jobs = jobs.unwrap_or(threads).min(self.numbers.len()).max(1);
        let (next, is_over) = (AtomicUsize::new(0), AtomicBool::new(false));
        let (sender, receiver) = mpsc::channel::<Row>();
        std::thread::scope(|scope| {
            for _ in 0..jobs {
                // A pool each, so that no thread that waits for a tree's parts begins another tree.
                let pool = rayon::ThreadPoolBuilder::new().num_threads((threads / jobs).max(1)).build();
                let pool = pool.context("starting threads")?;
                let (sender, next, is_over) = (sender.clone(), &next, &is_over);
                scope.spawn(move || {
                    let share = Share { progress, is_over, jobs: jobs as u64 };
                    while !share.is_cancelled() {
                        let Some(&number) = self.numbers.get(next.fetch_add(1, Ordering::Relaxed)) else {
                            break;
                        };
                        let row = pool.install(|| self.tree(number, &share));
                        // What was stopped is no row.
                        if share.is_cancelled() || sender.send(row).is_err() {
                            break;
                        }
                    }
                });
            }
            drop(sender);
            let mut done = 0;
            let written = (|| {
                for row in receiver {
                    done += 1;
                    if !take(row)? {
                        return Ok(());
                    }
                    progress.advance(Phase::Measure, done, Some(self.numbers.len() as u64));
                }
                progress.check()?;
                Ok(())
            })();
            is_over.store(true, Ordering::Relaxed);
            written
        })
    }

    fn tree(&self, number: usize, share: &Share<'_>) -> Row {
        let tree = match self.plan.tree(number) {
            Ok(tree) => tree,
            Err(error) => return Row::unreadable(number, sentence(&error)),
        };
        let mut row = Row::of(&tree);
        let started = Instant::now();
        if let Err(error) = self.write(&tree, &mut row, share) {
            row.files.clear();
            row.error = Some(sentence(&error).replace(['\n', '\r'], " "));
        }
        row.seconds = Some((started.elapsed().as_secs_f64() * 1e4).round() / 1e4);
        row
    }

    fn write(&self, tree: &Tree, row: &mut Row, share: &Share<'_>) -> anyhow::Result<()> {
        let count = tree.recipe.preset.dressing.detail.levels();
        let outputs: Vec<Output> = tree
            .outputs
            .iter()
            .map(|(exporter, options, path)| Output::new(*exporter, options.clone(), self.out.join(path)))
            .flat_map(|output| output.in_levels(count))
            .collect();
        for folder in outputs.iter().filter_map(|output| output.path.parent()) {
            std::fs::create_dir_all(folder)
                .with_context(|| format!("making the folder {}", crate::paths::show(folder)))?;
        }
        let bundle = |output: &Output| {
            let bundle = Bundle::create(&output.path)?;
            Ok(if self.sync { bundle } else { bundle.unsynced() })
        };
        let mut batch = Batch::open(outputs, tree.files.clone(), bundle)?;
        let grown = grow(&tree.recipe, share)?;
        row.skeleton_hash = Some(format!("{:032x}", grown.skeleton.hash()));
        row.nodes = Some(grown.skeleton.positions.len());
        row.height_m = Some(grown.skeleton.measures().height_m);
        let levels = levels(&tree.recipe, &grown, share)?;
        drop(grown);
        let holding = Holding::new(share, tree.recipe.inputs.bytes());
        let stage = levels.stage();
        row.bounds_m = stage.bounds().map(|bounds| [bounds.min.to_array(), bounds.max.to_array()]);
        batch.write(&stage, &holding, |_| ())?;
        share.check()?;
        for file in batch.commit()? {
            let within = file.path.strip_prefix(self.out).unwrap_or(&file.path);
            let parts: Vec<_> = within.iter().map(|part| part.to_string_lossy()).collect();
            row.files.push(WrittenFile { path: parts.join("/"), bytes: file.bytes });
        }
        Ok(())
    }
}
