//! The program `linden`: parses the command line, dispatches, and turns errors into exit codes.
//!
//! A program that adds a generator of its own registers it and then runs this one:
//!
//! ```no_run
//! use std::process::ExitCode;
//!
//! fn main() -> ExitCode {
//!     // linden::generators::register(my_generator::GENERATOR) …
//!     linden_cli::run()
//! }
//! ```
//!
//! Everything that is worth testing alone lives in the libraries.

mod cache;
mod cli;
mod config;
mod exit;
mod figures;
mod forecast;
mod formats;
mod jobs;
mod memory;
mod numbers;
mod paths;
mod portrait;
mod progress;
mod reading;
mod signals;
mod source;
mod system;
mod triangles;
mod trust;
mod tui;
mod viewpoint;
mod wrap;

pub use cli::run;
