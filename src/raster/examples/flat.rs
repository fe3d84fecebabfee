//! Draws a procedural tree flat, and times it beside the shaded strokes:
//! `cargo run --release -p linden-raster --example flat FOLDER`.
#![allow(clippy::print_stdout)]

#[path = "../skeleton/sample.rs"]
#[expect(dead_code, reason = "shared with the tests")]
mod sample;

use std::path::PathBuf;
use std::time::Instant;

use linden_pipeline::Quiet;
use linden_raster::{Camera, Drawing, Size, Style, draw_skeleton};

/// Repeats, of which the median counts.
const TIMES: usize = 15;

fn median_ms(mut once: impl FnMut()) -> f64 {
    let mut times: Vec<f64> = (0..TIMES)
        .map(|_| {
            let start = Instant::now();
            once();
            start.elapsed().as_secs_f64() * 1e3
        })
        .collect();
    times.sort_by(f64::total_cmp);
    times[TIMES / 2]
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder: PathBuf = std::env::args_os().nth(1).unwrap_or_else(|| ".".into()).into();
    for (depth, width, height) in
        [(2, 800, 1000), (3, 800, 1000), (2, 128, 144), (3, 128, 144), (4, 128, 144), (4, 800, 1000)]
    {
        let tree = sample::tree(7, depth);
        let size = Size::new(width, height)?;
        let draw = || Drawing::new(&tree, &Camera::default(), &Style::paper(), size, &Quiet);
        let drawing = draw()?;
        let shapes = median_ms(|| drop(draw()));
        let pixels = median_ms(|| drop(drawing.picture(&Quiet)));
        let strokes =
            median_ms(|| drop(draw_skeleton(&tree, &Camera::default(), &Style::studio(), size, &Quiet)));
        let svg = drawing.svg(None);
        println!(
            "{width}x{height}, {} nodes: shapes in {shapes:.1} ms, pixels in {pixels:.1} ms, SVG {} KB; \
             shaded strokes in {strokes:.1} ms",
            tree.positions.len(),
            svg.len() / 1000
        );
        let name = format!("flat{depth}-{width}x{height}");
        std::fs::write(folder.join(format!("{name}.png")), drawing.picture(&Quiet)?.srgb_png()?)?;
        std::fs::write(folder.join(format!("{name}.svg")), svg)?;
    }
    Ok(())
}
