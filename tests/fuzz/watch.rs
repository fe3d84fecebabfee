//! Finds inputs that take too long for their bytes, and ends a run at one that does not end.
//!
//! What an input may take is counted in steps of a loop that the run itself has timed, and time is the
//! processor's: on a slow or a busy machine the loop takes as much longer as everything else does.

use std::io::Write as _;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use linden::random::Key;

use crate::targets::Target;

/// Steps that any input may take, and those that grow a tree besides.
const STEPS: f64 = 1e9;
const STEPS_OF_TREES: f64 = 1e10;
/// Steps for each byte of an input: a few microseconds.
const STEPS_PER_BYTE: f64 = 1e3;
/// What takes this many times longer than it may is not waited for.
const ENDLESS: f64 = 4.0;
/// An input that takes no processor time for so long waits for something.
const STILL: Duration = Duration::from_mins(2);

/// Looks at what runs.
pub struct Watch {
    steps_per_second: f64,
    running: Arc<Mutex<Option<Running>>>,
}

struct Running {
    target: &'static Target,
    bytes: Vec<u8>,
    since: Duration,
    allowed: f64,
}

/// An input that runs until this is asked how long it took.
pub struct Run<'a>(&'a Watch);

impl Watch {
    /// Times the loop and begins to look. `keep` saves an input that does not end.
    pub fn start(keep: fn(&Target, &[u8]) -> PathBuf) -> Self {
        let steps_per_second = calibrated();
        let running = Arc::new(Mutex::new(None));
        let seen = Arc::clone(&running);
        std::thread::spawn(move || look(&seen, steps_per_second, keep));
        Self { steps_per_second, running }
    }

    /// An input begins to run.
    pub fn begin(&self, target: &'static Target, bytes: &[u8]) -> Run<'_> {
        let of_trees = if target.is_grown() { STEPS_OF_TREES } else { 0.0 };
        let allowed = STEPS + of_trees + STEPS_PER_BYTE * bytes.len() as f64;
        let running = Running { target, bytes: bytes.to_vec(), since: processor_time(), allowed };
        *locked(&self.running) = Some(running);
        Run(self)
    }
}

impl Run<'_> {
    /// It has ended: what is to be said of its time, if it took too much.
    pub fn end(self) -> Option<String> {
        let running = locked(&self.0.running).take()?;
        let took = processor_time().saturating_sub(running.since).as_secs_f64() * self.0.steps_per_second;
        (took > running.allowed).then(|| said(&running, took))
    }
}

fn said(running: &Running, steps: f64) -> String {
    let (bytes, allowed) = (running.bytes.len(), running.allowed);
    format!("{steps:.1e} steps of time for {bytes} bytes of input, which may take {allowed:.1e}")
}

/// Ends the process at an input that does not end: there is no way to stop its thread.
fn look(running: &Mutex<Option<Running>>, steps_per_second: f64, keep: fn(&Target, &[u8]) -> PathBuf) {
    let mut last = (Duration::ZERO, Instant::now());
    loop {
        std::thread::sleep(Duration::from_millis(50));
        let now = processor_time();
        if now != last.0 {
            last = (now, Instant::now());
        }
        let running = locked(running);
        let Some(running) = running.as_ref() else { continue };
        let took = now.saturating_sub(running.since).as_secs_f64() * steps_per_second;
        let waits = last.1.elapsed() > STILL;
        if took > ENDLESS * running.allowed || waits {
            let path = keep(running.target, &running.bytes);
            let what = if waits { "it waits for something".to_owned() } else { said(running, took) };
            // Not by the macro, whose text tests keep to themselves.
            let _ = writeln!(
                std::io::stderr(),
                "\n{} does not end: {what}\n  the input: {}",
                running.target.name,
                path.display()
            );
            std::process::exit(1);
        }
    }
}

fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Steps of the loop in a second of processor time.
fn calibrated() -> f64 {
    const LEAST: Duration = Duration::from_millis(200);
    let (started, mut steps, mut key) = (processor_time(), 0_u64, Key::new(1));
    loop {
        for _ in 0..100_000 {
            key = key.child(steps);
            steps += 1;
        }
        let took = processor_time().saturating_sub(started);
        if took >= LEAST {
            assert_ne!(std::hint::black_box(key).bits(), 0, "the loop is not left out");
            return steps as f64 / took.as_secs_f64();
        }
    }
}

/// The processor time of all threads, where the system tells it in a file; else the time that passes.
fn processor_time() -> Duration {
    let stat = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    // After the name, which may have blanks and parentheses in it: fields 14 and 15, in hundredths.
    let after_name = stat.rfind(')').map_or("", |end| &stat[end + 1..]);
    let ticks: Vec<u64> =
        after_name.split_whitespace().skip(11).take(2).filter_map(|field| field.parse().ok()).collect();
    match ticks[..] {
        [user, system] => Duration::from_millis(10 * (user + system)),
        _ => {
            static START: std::sync::LazyLock<Instant> = std::sync::LazyLock::new(Instant::now);
            START.elapsed()
        }
    }
}
