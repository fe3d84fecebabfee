//! The workbench as a person at a terminal has it: the real program on a pseudo-terminal.
//!
//! Bytes, counts and order are asserted, not times: a machine that is busy makes everything late and
//! nothing different. What must be fast is measured by `cargo bench -p linden-cli --bench tui`.
#![cfg(target_os = "linux")]
#![allow(clippy::unwrap_used, clippy::expect_used, reason = "a test that cannot go on fails")]
#![allow(clippy::print_stdout, reason = "a test that fails shows its screen")]

mod bars;
mod budgets;
mod carried_on;
mod colors;
mod derivation;
mod exporting;
mod given_back;
mod growing;
mod harness;
mod kept_work;
mod links;
mod palette;
mod plain;
mod sizes;
mod start;
mod tags;
mod untrusted;
mod user_files;
mod wind;
