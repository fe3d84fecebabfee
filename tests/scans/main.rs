//! The simulated scanner against its definition, and trees that come back from its scans.

#![allow(clippy::unwrap_used, reason = "what the tests share may fail them too")]

mod closed_loop;
mod leaves;
mod plots;
mod scanner;
