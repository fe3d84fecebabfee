//! Grows and measures the trees of a sweep, one on each thread, and hands them on in their order.

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicBool, AtomicU64, AtomicUsize, Ordering};
use std::sync::mpsc;
use std::time::Instant;

use anyhow::Context;
use linden::Monitor;
use linden::grow::grow;
use linden::monitor::Phase;
use linden::report::Report;

use super::rows::Row;
use super::{Item, Plan};
use crate::cli::share::Share;
use crate::exit::sentence;
use crate::progress::Progress;

/// Rows that may wait for one before them: what a slow tree holds up.
const MOST_WAITING: usize = 4096;

/// What is to be done.
pub struct Work<'a> {
    pub plan: &'a Plan,
    /// The first item that is not done yet.
    pub first: usize,
}

/// An item with its row and the seconds that it took.
type Done = (usize, Item, Row, [f64; 2]);

impl Work<'_> {
    /// Does it, and gives each row to `take` in the order of the items, until that says false or fails.
    pub fn run(
        &self,
        progress: &Progress,
        mut take: impl FnMut(&Item, Row, [f64; 2]) -> anyhow::Result<bool>,
    ) -> anyhow::Result<()> {
        let trees = self.plan.len();
        let jobs = rayon::current_num_threads().min(trees - self.first.min(trees)).max(1);
        let threads = (rayon::current_num_threads() / jobs).max(1);
        let (next, is_over, taken) =
            (AtomicUsize::new(self.first), AtomicBool::new(false), AtomicU64::new(self.first as u64));
        let (sender, receiver) = mpsc::channel::<Done>();
        std::thread::scope(|scope| {
            for _ in 0..jobs {
                // A pool each, so that no thread that waits for a tree's parts begins another tree.
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
                let pool = pool.context("starting threads")?;
                let (sender, next, is_over, taken) = (sender.clone(), &next, &is_over, &taken);
                scope.spawn(move || {
                    let job = Share { progress, is_over, jobs: jobs as u64 };
                    while !job.is_cancelled() {
                        // Within reach of what is written.
                        if next.load(Ordering::Relaxed) as u64
                            > taken.load(Ordering::Relaxed) + MOST_WAITING as u64
                        {
                            std::thread::sleep(std::time::Duration::from_millis(1));
                            continue;
                        }
                        let index = next.fetch_add(1, Ordering::Relaxed);
                        if index >= trees {
                            break;
                        }
                        let item = self.plan.item(index);
                        let (row, times) = pool.install(|| self.measure(&item, &job));
                        if sender.send((index, item, row, times)).is_err() {
                            break;
                        }
                    }
                });
            }
            drop(sender);
            let written = self.hand_on(&receiver, progress, &taken, &mut take);
            is_over.store(true, Ordering::Relaxed);
            written
        })
    }

    /// Gives the rows on in their order, as they come in.
    fn hand_on(
        &self,
        receiver: &mpsc::Receiver<Done>,
        progress: &Progress,
        taken: &AtomicU64,
        take: &mut impl FnMut(&Item, Row, [f64; 2]) -> anyhow::Result<bool>,
    ) -> anyhow::Result<()> {
        let total = self.plan.len() as u64;
        let mut waiting = BTreeMap::new();
        let mut next = self.first;
        for (index, item, row, times) in receiver {
            waiting.insert(index, (item, row, times));
            while let Some((item, row, times)) = waiting.remove(&next) {
                // What was stopped is no row.
                progress.check()?;
                if !take(&item, row, times)? {
                    return Ok(());
                }
                next += 1;
                taken.store(next as u64, Ordering::Relaxed);
                progress.advance(Phase::Measure, next as u64, Some(total));
            }
        }
        progress.check()?;
        Ok(())
    }

    fn measure(&self, item: &Item, job: &Share<'_>) -> (Row, [f64; 2]) {
        let recipe = match self.plan.recipe(item) {
            Ok(recipe) => recipe,
            Err(error) => {
                let row = Row { measured: Err(sentence(&error)), recipe: self.plan.base.to_line() };
                return (row, [0.0; 2]);
            }
        };
        let started = Instant::now();
        let grown = grow(&recipe, job).map_err(anyhow::Error::from);
        let grow_s = started.elapsed().as_secs_f64();
        let started = Instant::now();
        let measured = grown.and_then(|grown| Ok(Report::of(&recipe, &grown, job)?));
        let times = [grow_s, started.elapsed().as_secs_f64()];
        let line = |error: anyhow::Error| sentence(&error).replace(['\n', '\r'], " ");
        (Row { measured: measured.map_err(line), recipe: recipe.to_line() }, times)
    }
}
