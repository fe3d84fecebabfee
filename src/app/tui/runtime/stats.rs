//! Measures bytes and times for `--stats`.

use std::time::{Duration, Instant};

use linden_terminal::Stats;

/// How long keys wait for the frame that answers them.
pub struct Latency {
    is_on: bool,
    pressed: Option<Instant>,
    waits: Vec<Duration>,
}

/// As many keys are remembered.
const MOST: usize = 100_000;

impl Latency {
    /// Measures only when asked to.
    pub const fn new(is_on: bool) -> Self {
        Self { is_on, pressed: None, waits: Vec::new() }
    }

    /// A key came.
    pub fn pressed(&mut self, now: Instant) {
        if self.is_on {
            self.pressed.get_or_insert(now);
        }
    }

    /// A frame with its answer was handed to the terminal.
    pub fn painted(&mut self, now: Instant) {
        if let Some(pressed) = self.pressed.take()
            && self.waits.len() < MOST
        {
            self.waits.push(now.saturating_duration_since(pressed));
        }
    }

    /// The figures of the moment, for the title's end.
    pub fn line(&self, stats: &Stats) -> Option<String> {
        self.is_on.then(|| {
            let trip =
                stats.round_trip.map_or_else(String::new, |trip| format!(" · {} ms", trip.as_millis()));
            format!(" {} KB{trip} ", (stats.written.text + stats.written.picture) / 1000)
        })
    }

    /// What is said at the end.
    pub fn report(&mut self, stats: &Stats) -> Option<String> {
        if !self.is_on {
            return None;
        }
        self.waits.sort_unstable();
        let at = |share: f64| {
            let last = self.waits.len().checked_sub(1)?;
            let wait = self.waits[(last as f64 * share).round() as usize];
            Some(format!("{:.1} ms", wait.as_secs_f64() * 1e3))
        };
        let or_none = |wait: Option<String>| wait.unwrap_or_else(|| "none".to_owned());
        Some(format!(
            "frames {} · writes {} · text {} B · pictures {} B · key to frame: median {}, 95 % {}, of {} keys{}",
            stats.frames,
            stats.written.writes,
            stats.written.text,
            stats.written.picture,
            or_none(at(0.5)),
            or_none(at(0.95)),
            self.waits.len(),
            if stats.mute { " · the terminal answers no queries" } else { "" },
        ))
    }
}
