//! A worker thread: it does the newest request and cancels the one before.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use linden::Monitor;
use linden::monitor::Phase;

use crate::system;

/// Names of worker threads begin with this: their panics become messages, not the end of the program.
pub const THREAD_PREFIX: &str = "linden-job-";

/// Between two reports of progress: people do not read faster, and over SSH each costs bytes.
const REPORT_EVERY: Duration = Duration::from_millis(120);

/// What a lane says of a request.
#[derive(Debug)]
pub struct Answer<T> {
    /// The request's number, as [`Lane::submit`] gave it.
    pub number: u64,
    /// What it says.
    pub done: Done<T>,
}

/// How far the work on a request is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HowFar {
    /// What is being done.
    pub stage: Phase,
    /// Units finished.
    pub done: u64,
    /// Units in all, where that is known.
    pub total: Option<u64>,
    /// Which one of several this is about: `tree`, 3 of 24.
    pub among: Option<Among>,
}

/// What the several are, the number of the one that is worked on (from 1), and how many there are.
pub type Among = (&'static str, usize, usize);

/// How far a request is.
#[derive(Debug)]
pub enum Done<T> {
    /// Still at it.
    Progress(HowFar),
    /// Here it is. A lane may give several for one request (a gallery).
    Value(T),
    /// The work panicked, which is our fault.
    Broken(String),
    /// It is over, with or without a value: the last that is said of a request.
    Finished,
}

/// A worker thread with one place for the next request.
pub struct Lane<R> {
    shared: Arc<Shared<R>>,
    thread: JoinHandle<()>,
}

struct Shared<R> {
    slot: Mutex<Slot<R>>,
    filled: Condvar,
    /// The number of the newest request. Older work is cancelled.
    newest: AtomicU64,
}

struct Slot<R> {
    next: Option<(u64, R)>,
    closed: bool,
}

/// Watches one request's work: cancelled as soon as there is a newer one.
pub struct Watcher<'a> {
    number: u64,
    newest: &'a AtomicU64,
    report: &'a (dyn Fn(HowFar) + Sync),
    said: Mutex<Said>,
}

/// What was reported last, and which one of several the next report is about.
#[derive(Default)]
struct Said {
    last: Option<(Phase, Instant)>,
    among: Option<Among>,
}

impl<R: Send + 'static> Lane<R> {
    /// Starts the worker. `work` is given each request and a place to put values; `send` takes what
    /// it says and returns quickly.
    ///
    /// # Errors
    /// When the system has no thread left.
    pub fn start<T: 'static>(
        name: &str,
        send: impl Fn(Answer<T>) + Send + Sync + 'static,
        mut work: impl FnMut(R, &Watcher<'_>, &dyn Fn(T)) + Send + 'static,
    ) -> std::io::Result<Self> {
        let shared = Arc::new(Shared {
            slot: Mutex::new(Slot { next: None, closed: false }),
            filled: Condvar::new(),
            newest: AtomicU64::new(0),
        });
        let waiting = Arc::clone(&shared);
        let thread = std::thread::Builder::new().name(format!("{THREAD_PREFIX}{name}")).spawn(move || {
            system::lower_priority();
            while let Some((number, request)) = waiting.wait() {
                let report = |how_far| send(Answer { number, done: Done::Progress(how_far) });
                let said = Mutex::default();
                let watcher = Watcher { number, newest: &waiting.newest, report: &report, said };
                let give = |value| send(Answer { number, done: Done::Value(value) });
                let worked = catch_unwind(AssertUnwindSafe(|| work(request, &watcher, &give)));
                if let Err(panic) = worked {
                    send(Answer { number, done: Done::Broken(message(&*panic)) });
                }
                send(Answer { number, done: Done::Finished });
            }
        })?;
        Ok(Self { shared, thread })
    }

    /// Hands in a request; whatever was under way or waiting is dropped. Returns its number.
    pub fn submit(&self, request: R) -> u64 {
        let mut slot = self.shared.slot.lock().unwrap_or_else(PoisonError::into_inner);
        let number = self.shared.newest.fetch_add(1, Ordering::Relaxed) + 1;
        slot.next = Some((number, request));
        self.shared.filled.notify_one();
        number
    }

    /// Drops whatever is under way or waiting.
    pub fn cancel(&self) {
        let mut slot = self.shared.slot.lock().unwrap_or_else(PoisonError::into_inner);
        self.shared.newest.fetch_add(1, Ordering::Relaxed);
        slot.next = None;
    }
}

impl<R> Lane<R> {
    /// Cancels, and waits for the worker at most so long: what it has begun to write is taken away by
    /// then. A worker that hangs in the system (on a network that is gone) is left.
    pub fn finish(self, patience: Duration) {
        self.shared.close();
        let end = Instant::now() + patience;
        while !self.thread.is_finished() && Instant::now() < end {
            std::thread::sleep(Duration::from_millis(2));
        }
    }
}

impl<R> Drop for Lane<R> {
    /// Cancels. The worker hears it within milliseconds, unless it hangs in the system; it is not waited for.
    fn drop(&mut self) {
        self.shared.close();
    }
}

impl<R> Shared<R> {
    /// There will be no more requests.
    fn close(&self) {
        let mut slot = self.slot.lock().unwrap_or_else(PoisonError::into_inner);
        slot.closed = true;
        slot.next = None;
        self.newest.fetch_add(1, Ordering::Relaxed);
        self.filled.notify_one();
    }

    /// The next request, `None` when there will be no more.
    fn wait(&self) -> Option<(u64, R)> {
        let mut slot = self.slot.lock().unwrap_or_else(PoisonError::into_inner);
        loop {
            if slot.closed {
                return None;
            }
            if let Some(next) = slot.next.take() {
                return Some(next);
            }
            slot = self.filled.wait(slot).unwrap_or_else(PoisonError::into_inner);
        }
    }
}

#[cfg(test)]
impl Watcher<'static> {
    /// Watches work that nothing overtakes.
    pub fn idle() -> Self {
        static NEWEST: AtomicU64 = AtomicU64::new(0);
        Self { number: 0, newest: &NEWEST, report: &|_| (), said: Mutex::default() }
    }
}

impl Monitor for Watcher<'_> {
    fn is_cancelled(&self) -> bool {
        self.newest.load(Ordering::Relaxed) != self.number
    }

    fn memory_limit(&self) -> u64 {
        crate::memory::limit()
    }

    fn advance(&self, stage: Phase, done: u64, total: Option<u64>) {
        // A thread that finds another one reporting has nothing to add.
        let Ok(mut said) = self.said.try_lock() else { return };
        let now = Instant::now();
        match said.last {
            Some((of, at)) if of == stage && now - at < REPORT_EVERY => {}
            // Work that is over at once is not worth a report.
            None => said.last = Some((stage, now)),
            Some(_) => {
                said.last = Some((stage, now));
                (self.report)(HowFar { stage, done, total, among: said.among });
            }
        }
    }

    fn among(&self, what: &'static str, number: usize, count: usize) {
        let mut said = self.said.lock().unwrap_or_else(PoisonError::into_inner);
        said.among = (count > 1).then_some((what, number, count));
    }
}

/// What a panic said.
fn message(panic: &(dyn std::any::Any + Send)) -> String {
    let text = panic.downcast_ref::<&str>().map(|s| (*s).to_owned());
    text.or_else(|| panic.downcast_ref::<String>().cloned()).unwrap_or_else(|| "no message".to_owned())
}

#[cfg(test)]
mod tests {
    use std::sync::mpsc;

    use super::*;

    #[test]
    fn the_newest_request_wins_and_cancels_the_one_before() {
        let (sender, answers) = mpsc::channel();
        let (entered, is_in) = mpsc::channel();
        let lane = Lane::start(
            "test",
            move |answer: Answer<u32>| drop(sender.send(answer)),
            move |request: u32, watcher, give| {
                entered.send(request).unwrap();
                while request == 1 && !watcher.is_cancelled() {
                    std::thread::yield_now();
                }
                if !watcher.is_cancelled() {
                    give(request);
                }
            },
        )
        .unwrap();
        lane.submit(1);
        assert_eq!(is_in.recv().unwrap(), 1);
        let two = lane.submit(2);
        let first = answers.recv().unwrap();
        assert!(first.number < two && matches!(first.done, Done::Finished), "{first:?}");
        let second = answers.recv().unwrap();
        assert!(second.number == two && matches!(second.done, Done::Value(2)), "{second:?}");
    }

    #[test]
    fn progress_tells_which_one_of_several_it_is_about() {
        let (sender, answers) = mpsc::channel();
        let work = |(): (), watcher: &Watcher<'_>, _: &dyn Fn(())| {
            watcher.advance(Phase::Grow, 0, None);
            watcher.among("tree", 3, 24);
            watcher.advance(Phase::Sweep, 5, Some(9));
            watcher.among("tree", 1, 1);
            watcher.advance(Phase::Sprout, 6, None);
        };
        let lane = Lane::start("test", move |answer| drop(sender.send(answer)), work).unwrap();
        lane.submit(());
        let of = |stage, done, total, among| HowFar { stage, done, total, among };
        for expected in
            [of(Phase::Sweep, 5, Some(9), Some(("tree", 3, 24))), of(Phase::Sprout, 6, None, None)]
        {
            let done = answers.recv().unwrap().done;
            assert!(matches!(done, Done::Progress(how_far) if how_far == expected), "{done:?}");
        }
    }

    #[test]
    fn a_panic_is_an_answer_and_the_lane_goes_on() {
        let (sender, answers) = mpsc::channel();
        let lane = Lane::start(
            "test",
            move |answer: Answer<u32>| drop(sender.send(answer)),
            |request: u32, _, give| {
                assert_ne!(request, 1, "one");
                give(request);
            },
        )
        .unwrap();
        lane.submit(1);
        assert!(matches!(answers.recv().unwrap().done, Done::Broken(why) if why.contains("one")));
        assert!(matches!(answers.recv().unwrap().done, Done::Finished));
        lane.submit(3);
        assert!(matches!(answers.recv().unwrap().done, Done::Value(3)));
    }

    #[test]
    fn a_lane_that_is_finished_ends_work_that_would_go_on_for_ever() {
        let (entered, is_in) = mpsc::channel();
        let (left, is_out) = mpsc::channel();
        let lane = Lane::start(
            "test",
            |_: Answer<()>| {},
            move |(): (), watcher, _| {
                entered.send(()).unwrap();
                while !watcher.is_cancelled() {
                    std::thread::yield_now();
                }
                left.send(()).unwrap();
            },
        )
        .unwrap();
        lane.submit(());
        is_in.recv().unwrap();
        lane.finish(Duration::from_mins(10));
        assert!(is_out.try_recv().is_ok());
    }
}
