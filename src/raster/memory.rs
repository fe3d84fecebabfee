//! How much memory a picture takes, asked for before it is taken.

use std::sync::atomic::{AtomicU64, Ordering};

use linden_pipeline::memory::OverMemory;
use linden_pipeline::{Monitor, picture};

use crate::Size;

/// For messages.
const DOING: &str = "drawing the picture";
const ADVICE: &str = "take a smaller picture (--size), or grow a smaller tree";

/// Bytes of a finished picture, and of its PNG while it is compressed: known before anything is grown.
pub fn png_bytes(size: Size) -> u64 {
    picture_bytes(size) + pixels(size) * picture::PNG_BYTES_PER_PIXEL
}

/// Asks for [`png_bytes`] beside `held_bytes`.
///
/// # Errors
/// [`OverMemory`].
pub fn admit_png(size: Size, held_bytes: u64, monitor: &dyn Monitor) -> Result<(), OverMemory> {
    monitor.admit(DOING, held_bytes.saturating_add(png_bytes(size)), ADVICE)
}

pub(crate) fn picture_bytes(size: Size) -> u64 {
    pixels(size) * 4
}

fn pixels(size: Size) -> u64 {
    u64::from(size.width()) * u64::from(size.height())
}

/// What one drawing holds, together: strokes are traced by many threads, and how many there will be is not
/// known before.
pub(crate) struct Ledger<'a> {
    monitor: &'a dyn Monitor,
    bytes: AtomicU64,
}

impl<'a> Ledger<'a> {
    pub fn new(monitor: &'a dyn Monitor) -> Self {
        Self { monitor, bytes: AtomicU64::new(0) }
    }

    /// Asks for more, on top of all that was taken before.
    pub fn take(&self, bytes: u64) -> Result<(), OverMemory> {
        let held = self.bytes.fetch_add(bytes, Ordering::Relaxed).saturating_add(bytes);
        self.monitor.admit(DOING, held, ADVICE)
    }

    /// Asks for what a list that held `held` bytes takes more, now that it holds `bytes`.
    pub fn grow(&self, held: &mut u64, bytes: u64) -> Result<(), OverMemory> {
        let more = bytes.saturating_sub(*held);
        *held += more;
        self.take(more)
    }

    pub fn give_back(&self, bytes: u64) {
        self.bytes.fetch_sub(bytes, Ordering::Relaxed);
    }
}
