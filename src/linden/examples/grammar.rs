//! An L-system in code, drawn: `cargo run --example grammar -- weed.png`

#![allow(clippy::print_stdout, reason = "an example shows what it did")]

use std::env;
use std::fs;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let file = env::args().nth(1).unwrap_or_else(|| "weed.png".to_owned());
    // ABOP, Fig. 1.24 d: an apex X that branches, and internodes F that double.
    let rules = ["X -> F[+X]F[-X]+X", "F -> FF"];
    let weed = linden::grammar("X", &rules)?
        .set("angle", "20")?
        .set("derivations", "7")?
        .set("segment_length", "0.01")?
        .grow()?;
    println!("{} segments, {:.2} m high", weed.skeleton().segments(), weed.measures().height_m);
    fs::write(&file, weed.draw(480, 640)?.srgb_png()?)?;
    Ok(())
}
