//! The step of growth that is on screen while growth is played.

use std::time::{Duration, Instant};

/// Where the playing is.
#[derive(Debug, Default)]
pub struct Playback {
    /// The step on screen, `None` for the grown tree.
    pub step: Option<u32>,
    /// When the last step came, while it plays.
    pub playing: Option<Instant>,
    /// Until the next step.
    pub pause: Duration,
    /// Whether the next step is due, and waits for the picture of this one.
    pub waits: bool,
}

impl Playback {
    /// The step on screen, `None` for the grown tree.
    pub fn step(&self) -> Option<u32> {
        self.step
    }

    /// Whether it plays.
    pub fn is_playing(&self) -> bool {
        self.playing.is_some()
    }

    /// When the next step is due.
    pub fn next_frame(&self) -> Option<Instant> {
        self.playing.filter(|_| !self.waits).map(|last| last + self.pause)
    }

    /// Stays at the step that is on screen.
    pub fn pause(&mut self) {
        self.playing = None;
        self.waits = false;
    }

    /// Shows the grown tree.
    pub fn stop(&mut self) {
        *self = Self::default();
    }
}
