//! Several trees at a time in one program.

use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::time::Duration;

use anyhow::Context;
use linden::Monitor;
use linden::monitor::Phase;

use crate::progress::Progress;

/// Results that may wait for one before them: what a slow tree holds up.
const MOST_WAITING: usize = 4096;

/// Without a result for so long, it is shown that work goes on.
const STILL: Duration = Duration::from_millis(200);

/// Bytes for pictures that several trees share: what a dozen kinds need, but never much of what there is.
pub fn room_for_pictures(progress: &Progress) -> u64 {
    (progress.memory_limit() / 8).min(64 << 20)
}

/// Workers that do one piece of work after another, each on threads of its own.
pub struct Crew<'a> {
    pub progress: &'a Progress,
    /// How many work at a time; never more than there is to do.
    pub jobs: usize,
    /// Bytes that they share equally.
    pub memory: u64,
    /// Whether results are taken in the order of their numbers, or as they come.
    pub in_order: bool,
}

/// Watches one of several workers: it may hold its share of the memory.
pub struct Share<'a> {
    progress: &'a Progress,
    /// Whether the rest is to be skipped.
    is_over: &'a AtomicBool,
    memory: u64,
}

/// Says on every way out, errors and panics too, that the rest is to be skipped: workers would go on for nothing, or wait for
/// ever for results to be taken.
struct Ending<'a>(&'a AtomicBool);

impl Drop for Ending<'_> {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Relaxed);
    }
}

impl Monitor for Share<'_> {
    fn is_cancelled(&self) -> bool {
        self.is_over.load(Ordering::Relaxed) || self.progress.is_cancelled()
    }

    fn advance(&self, _: Phase, _: u64, _: Option<u64>) {}

    fn memory_limit(&self) -> u64 {
        self.memory
    }
}

impl<'a> Crew<'a> {
    /// One worker for each thread, who share all memory there may be.
    pub fn of_threads(progress: &'a Progress) -> Self {
        let (jobs, memory) = (rayon::current_num_threads(), progress.memory_limit());
        Self { progress, jobs, memory, in_order: false }
    }

    /// Does the work of all `numbers`, and gives each result to `take`, until that says false or fails. Results of
    /// work that was interrupted are dropped.
    ///
    /// # Errors
    /// Those of `take`, when no thread can be started, and when the user wants no more.
    pub fn run<R: Send>(
        &self,
        numbers: Range<usize>,
        work: impl Fn(usize, &Share<'_>) -> R + Sync,
        take: impl FnMut(R) -> anyhow::Result<bool>,
    ) -> anyhow::Result<()> {
        let threads = rayon::current_num_threads();
        let jobs = self.jobs.min(numbers.len()).max(1);
        let (next, taken, is_over) =
            (AtomicUsize::new(numbers.start), AtomicUsize::new(numbers.start), AtomicBool::new(false));
        let (sender, receiver) = mpsc::channel::<(usize, R)>();
        std::thread::scope(|scope| {
            let _ending = Ending(&is_over);
            for _ in 0..jobs {
                // A pool each, so that no thread that waits for a tree's parts begins another tree.
                let pool = rayon::ThreadPoolBuilder::new().num_threads((threads / jobs).max(1)).build();
                let pool = pool.context("starting threads")?;
                let share =
                    Share { progress: self.progress, is_over: &is_over, memory: self.memory / jobs as u64 };
                let (sender, next, taken, work) = (sender.clone(), &next, &taken, &work);
                let work = move || {
                    while !share.is_cancelled() {
                        let ahead =
                            next.load(Ordering::Relaxed).saturating_sub(taken.load(Ordering::Relaxed));
                        if ahead > MOST_WAITING {
                            std::thread::sleep(Duration::from_millis(1));
                            continue;
                        }
                        let number = next.fetch_add(1, Ordering::Relaxed);
                        if number >= numbers.end {
                            break;
                        }
                        let result = pool.install(|| work(number, &share));
                        if share.is_cancelled() || sender.send((number, result)).is_err() {
                            break;
                        }
                    }
                };
                std::thread::Builder::new().spawn_scoped(scope, work).context("starting threads")?;
            }
            drop(sender);
            self.hand_on(&receiver, &taken, numbers, take)
        })
    }

    fn hand_on<R>(
        &self,
        receiver: &mpsc::Receiver<(usize, R)>,
        taken: &AtomicUsize,
        numbers: Range<usize>,
        mut take: impl FnMut(R) -> anyhow::Result<bool>,
    ) -> anyhow::Result<()> {
        let mut waiting = BTreeMap::new();
        let (mut next, of_all) = (numbers.start, Some(numbers.len() as u64));
        loop {
            let (number, result) = match receiver.recv_timeout(STILL) {
                Ok(done) => done,
                Err(RecvTimeoutError::Disconnected) => break,
                // The first of them may take minutes.
                Err(RecvTimeoutError::Timeout) => {
                    self.progress.advance(Phase::Measure, (next - numbers.start) as u64, of_all);
                    continue;
                }
            };
            waiting.insert(number, result);
            while let Some(entry) =
                waiting.first_entry().filter(|entry| !self.in_order || *entry.key() == next)
            {
                self.progress.check()?;
                if !take(entry.remove())? {
                    return Ok(());
                }
                next += 1;
                taken.store(next, Ordering::Relaxed);
                self.progress.advance(Phase::Measure, (next - numbers.start) as u64, of_all);
            }
        }
        self.progress.check()?;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use std::panic::{AssertUnwindSafe, catch_unwind};

    use anyhow::bail;

    use super::*;

    #[test]
    fn work_ends_on_every_way_out() {
        const ALL: usize = 2000;
        let progress = Progress::new();
        let crew = Crew { jobs: 2, ..Crew::of_threads(&progress) };
        let done = |take: &dyn Fn() -> anyhow::Result<bool>| {
            let done = AtomicUsize::new(0);
            let work = |_: usize, _: &Share<'_>| {
                std::thread::sleep(Duration::from_millis(1));
                done.fetch_add(1, Ordering::Relaxed);
            };
            let way_out = catch_unwind(AssertUnwindSafe(|| crew.run(0..ALL, work, |()| take())));
            (way_out, done.into_inner())
        };
        let (way_out, count) = done(&|| Ok(false));
        assert!(matches!(way_out, Ok(Ok(()))) && count < ALL, "{count}");
        let (way_out, count) = done(&|| bail!("no room"));
        assert!(matches!(way_out, Ok(Err(_))) && count < ALL, "{count}");
        let (way_out, count) = done(&|| panic!("a fault"));
        assert!(way_out.is_err() && count < ALL, "{count}");
        let (way_out, count) = done(&|| Ok(true));
        assert!(matches!(way_out, Ok(Ok(()))) && count == ALL, "{count}");
    }
}
