//! Says how far long work is: nothing for half a second, then a bar on a terminal and nothing in a pipe.

use std::fmt::Write;
use std::io::IsTerminal;
use std::sync::Mutex;
use std::time::{Duration, Instant};

use indicatif::{HumanCount, HumanDuration, ProgressBar, ProgressDrawTarget, ProgressState, ProgressStyle};
use linden::Monitor;
use linden::monitor::Phase;

/// Work that is over sooner is not worth a bar.
const PATIENCE: Duration = Duration::from_millis(500);
/// Between two looks at the clock's consequences.
const PACE: Duration = Duration::from_millis(50);

/// Watches the work for a person at a terminal, and for signals.
pub struct Progress {
    started: Instant,
    shows: bool,
    shown: Mutex<ShownBar>,
}

struct ShownBar {
    bar: Option<(Phase, ProgressBar)>,
    /// Which one of several is worked on: `tree 3 of 24`.
    among: String,
    last: Instant,
}

impl Progress {
    /// Starts the clock.
    pub fn new() -> Self {
        let now = Instant::now();
        let shown = Mutex::new(ShownBar { bar: None, among: String::new(), last: now });
        Self { started: now, shows: std::io::stderr().is_terminal(), shown }
    }

    /// Writes lines on the terminal where the bar is, which comes back behind them and keeps its speed.
    pub fn beside<T>(&self, write: impl FnOnce() -> T) -> T {
        if let Ok(shown) = self.shown.lock()
            && let Some((_, bar)) = &shown.bar
        {
            return bar.suspend(write);
        }
        write()
    }

    /// Takes the bar away, so that other lines can be written.
    pub fn clear(&self) {
        if let Ok(mut shown) = self.shown.lock()
            && let Some((_, bar)) = shown.bar.take()
        {
            bar.finish_and_clear();
        }
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.clear();
    }
}

impl Monitor for Progress {
    fn is_cancelled(&self) -> bool {
        crate::signals::received().is_some()
    }

    fn memory_limit(&self) -> u64 {
        crate::memory::limit()
    }

    /// All bars say it from now on.
    fn among(&self, what: &'static str, number: usize, count: usize) {
        if let Ok(mut shown) = self.shown.lock() {
            shown.among = if count > 1 { format!("{what} {number} of {count}") } else { String::new() };
            if let Some((_, bar)) = &shown.bar {
                bar.set_message(shown.among.clone());
            }
        }
    }

    fn advance(&self, stage: Phase, done: u64, total: Option<u64>) {
        if !self.shows || self.started.elapsed() < PATIENCE {
            return;
        }
        // A thread that finds another one drawing has nothing to add.
        let Ok(mut shown) = self.shown.try_lock() else { return };
        let is_new = shown.bar.as_ref().is_none_or(|(of, _)| *of != stage);
        if !is_new && shown.last.elapsed() < PACE && total != Some(done) {
            return;
        }
        shown.last = Instant::now();
        if is_new {
            if let Some((_, old)) = shown.bar.take() {
                old.finish_and_clear();
            }
            let bar = bar(stage, total);
            bar.set_message(shown.among.clone());
            shown.bar = Some((stage, bar));
        }
        if let Some((_, bar)) = &shown.bar {
            if let Some(total) = total {
                bar.set_length(total);
            }
            bar.set_position(done);
            if total == Some(done) {
                bar.force_draw();
            }
        }
    }
}

fn bar(stage: Phase, total: Option<u64>) -> ProgressBar {
    let (doing, unit) = stage.words();
    let template = match (total, stage) {
        (Some(_), Phase::Read | Phase::Write) => {
            "{prefix:>11} [{bar:28}] {bytes}/{total_bytes}  {bytes_per_sec}  {left}  {msg}".to_owned()
        }
        (None, Phase::Read | Phase::Write) => "{prefix:>11} {bytes}  {bytes_per_sec}  {msg}".to_owned(),
        (Some(_), _) => {
            format!(
                "{{prefix:>11}} [{{bar:28}}] {{human_pos}}/{{human_len}} {unit}  {{rate}}  {{left}}  {{msg}}"
            )
        }
        (None, _) => format!("{{prefix:>11}} {{human_pos}} {unit}  {{rate}}  {{msg}}"),
    };
    let bar = match total {
        Some(total) => ProgressBar::new(total),
        None => ProgressBar::no_length(),
    };
    bar.set_draw_target(ProgressDrawTarget::stderr());
    if let Ok(style) = ProgressStyle::with_template(&template) {
        // Before anything is done nobody knows how fast it goes.
        let rate = |state: &ProgressState, out: &mut dyn Write| {
            if state.pos() > 0 {
                // The line is drawn again in a moment: a failure to write it is nothing to stop for.
                let _ = write!(out, "{}/s", HumanCount(state.per_sec() as u64));
            }
        };
        // What is done is not what is waited for any more.
        let left = |state: &ProgressState, out: &mut dyn Write| {
            if state.pos() > 0 && state.len() != Some(state.pos()) {
                let _ = write!(out, "{:#} left", HumanDuration(state.eta()));
            }
        };
        bar.set_style(style.with_key("rate", rate).with_key("left", left).progress_chars("=> "));
    }
    bar.set_prefix(doing);
    bar
}
