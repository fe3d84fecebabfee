//! linden with one more generator.

use std::process::ExitCode;

fn main() -> ExitCode {
    match linden::generators::register(linden_comb::GENERATOR) {
        Ok(()) => linden_cli::run(),
        Err(_) => ExitCode::FAILURE,
    }
}
