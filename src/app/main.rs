//! The program `linden`.

use std::process::ExitCode;

fn main() -> ExitCode {
    linden_cli::run()
}
