//! The numbers of a tree against computations that know nothing of ours.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

mod hull;
mod topology;
