//! The frame of the sway loop that is on screen while the wind is played.

use std::time::Instant;

/// The wind that blows in the picture.
#[derive(Debug, Default)]
pub struct Breeze {
    /// When it began; `None` in a calm.
    pub since: Option<Instant>,
    /// The frame on screen, and when it was asked for.
    pub frame: Option<(u32, Instant)>,
    /// Whether the next frame is due, and waits for the picture of this one.
    pub waits: bool,
}

impl Breeze {
    /// The frame on screen, `None` in a calm.
    pub fn frame(&self) -> Option<u32> {
        self.frame.map(|(frame, _)| frame)
    }

    /// Whether it blows.
    pub fn is_blowing(&self) -> bool {
        self.since.is_some()
    }

    /// Shows the tree as it grew.
    pub fn stop(&mut self) {
        *self = Self::default();
    }
}
