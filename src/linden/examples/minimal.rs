//! A preset, two knobs, a file: `cargo run --example minimal -- fir.glb`

#![allow(clippy::print_stdout, reason = "an example shows what it did")]

use std::env;

fn main() -> Result<(), linden::Error> {
    let file = env::args().nth(1).unwrap_or_else(|| "fir.glb".to_owned());
    let fir = linden::tree("fir")?.seed(7).set("points", "800")?.grow()?;
    for written in fir.export(file)?.files {
        println!("{}  {} bytes", written.path.display(), written.bytes);
    }
    Ok(())
}
