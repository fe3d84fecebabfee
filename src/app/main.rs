//! The program `linden`: parses the command line, dispatches, and turns errors into exit codes.
//! Everything that is worth testing alone lives in the libraries.

mod cli;
mod config;
mod exit;
mod forecast;
mod jobs;
mod memory;
mod paths;
mod progress;
mod reading;
mod signals;
mod source;
mod targets;
mod trust;
mod tui;
mod viewpoint;

use std::process::ExitCode;

fn main() -> ExitCode {
    cli::run()
}
