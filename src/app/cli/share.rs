//! Several trees at a time in one program.

use std::sync::atomic::{AtomicBool, Ordering};

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
