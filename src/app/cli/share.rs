//! Several trees at a time in one program.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc;

use anyhow::Context;
use linden::Monitor;
use linden::monitor::Phase;

use crate::progress::Progress;

/// Watches one of several trees that grow at once: each may hold its share of the memory.
pub struct Share<'a> {
    pub progress: &'a Progress,
    /// Whether nobody wants the rest.
    pub is_over: &'a AtomicBool,
    /// How many there are.
    pub jobs: u64,
}

impl Monitor for Share<'_> {
    fn is_cancelled(&self) -> bool {
        self.is_over.load(Ordering::Relaxed) || self.progress.is_cancelled()
    }

    fn advance(&self, _: Phase, _: u64, _: Option<u64>) {}

    fn memory_limit(&self) -> u64 {
        self.progress.memory_limit() / self.jobs
    }
}

/// Does `count` things, some at a time, each in threads of its own; gives what comes of each to `take` as it comes,
/// until that says false or fails.
pub fn side_by_side<R: Send>(
    count: usize,
    jobs: Option<usize>,
    progress: &Progress,
    work: impl Fn(usize, &Share<'_>) -> R + Sync,
    mut take: impl FnMut(R) -> anyhow::Result<bool>,
) -> anyhow::Result<()> {
    let threads = rayon::current_num_threads();
    let jobs = jobs.unwrap_or(threads).min(count).max(1);
    let (next, is_over) = (AtomicUsize::new(0), AtomicBool::new(false));
    let (sender, receiver) = mpsc::channel::<R>();
    std::thread::scope(|scope| {
        for _ in 0..jobs {
            // A pool each, so that no thread that waits for a tree's parts begins another tree.
            let pool = rayon::ThreadPoolBuilder::new().num_threads((threads / jobs).max(1)).build();
            let pool = pool.context("starting threads")?;
            let (sender, next, is_over, work) = (sender.clone(), &next, &is_over, &work);
            scope.spawn(move || {
                let share = Share { progress, is_over, jobs: jobs as u64 };
                while !share.is_cancelled() {
                    let number = next.fetch_add(1, Ordering::Relaxed);
                    if number >= count {
                        break;
                    }
                    let result = pool.install(|| work(number, &share));
                    // What was stopped is no result.
                    if share.is_cancelled() || sender.send(result).is_err() {
                        break;
                    }
                }
            });
        }
        drop(sender);
        let mut done = 0;
        let taken = (|| {
            for result in receiver {
                done += 1;
                if !take(result)? {
                    return Ok(());
                }
                progress.advance(Phase::Measure, done, Some(count as u64));
            }
            progress.check()?;
            Ok(())
        })();
        is_over.store(true, Ordering::Relaxed);
        taken
    })
}
