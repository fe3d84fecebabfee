//! Messages for the user: the footer shows the last one.

use std::time::{Duration, Instant};

/// How much a message matters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Weight {
    /// It happened.
    Note,
    /// It did not happen, and why.
    Warning,
    /// It failed.
    Error,
}

/// A line for the user, printable.
#[derive(Clone, Debug, PartialEq)]
pub struct Message {
    /// How much it matters.
    pub weight: Weight,
    /// What is said.
    pub text: String,
    /// When it leaves the footer in any case.
    pub until: Instant,
    /// When it has been read: what is done by hand from then on takes it off the footer.
    pub read_by: Instant,
}

/// How long it takes to notice a text and to read it, in a hurry.
pub fn reading_time(text: &str) -> Duration {
    Duration::from_millis(1000 + 30 * text.chars().count() as u64)
}
