//! Messages for the user: the footer shows the last one.

use std::time::Instant;

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
    /// When it leaves the footer.
    pub until: Instant,
}
