//! Weber and Penn's trees against the paper: a plain twin, closed forms, its table, and files of other programs.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]
#![allow(
    clippy::disallowed_methods,
    reason = "the twin is to share nothing with linden, its mathematics neither"
)]

mod files;
mod growth;
mod presets;
mod twin;
