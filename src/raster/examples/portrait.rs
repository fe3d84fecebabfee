//! Draws a procedural tree in all styles: `cargo run --release -p linden-raster --example portrait FOLDER`.
#![allow(clippy::print_stdout)]

#[path = "../skeleton/sample.rs"]
#[expect(dead_code, reason = "shared with the tests")]
mod sample;

use std::path::PathBuf;
use std::time::Instant;

use linden_pipeline::scene::{Material, Part};
use linden_pipeline::surface::{Tubes, sweep};
use linden_pipeline::{Quiet, Skeleton};
use linden_raster::{Camera, Paint, Size, Style, Surface, draw_skeleton, draw_surface};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder: PathBuf = std::env::args_os().nth(1).unwrap_or_else(|| ".".into()).into();
    for (depth, width, height) in
        [(2, 800, 1000), (3, 800, 1000), (4, 800, 1000), (3, 64, 72), (4, 64, 72), (3, 4096, 4096)]
    {
        let tree = sample::tree(7, depth);
        for (name, style) in [("studio", Style::studio()), ("dark", Style::over_dark())] {
            let start = Instant::now();
            let picture =
                draw_skeleton(&tree, &Camera::default(), &style, Size::new(width, height)?, &Quiet)?;
            let drawn = start.elapsed();
            let start = Instant::now();
            let png = picture.srgb_png()?;
            println!(
                "{name} {width}x{height}, {} nodes: drawn in {:.1} ms, PNG in {:.1} ms, {} KB",
                tree.positions.len(),
                drawn.as_secs_f64() * 1e3,
                start.elapsed().as_secs_f64() * 1e3,
                png.len() / 1000
            );
            std::fs::write(folder.join(format!("tree{depth}-{width}x{height}-{name}.png")), png)?;
        }
    }
    let tree = sample::tree(7, 3);
    for (name, paint, _) in Paint::ALL {
        for (ground, style) in [("studio", Style::studio()), ("dark", Style::over_dark())] {
            let style = Style { paint, ..style };
            let picture = draw_skeleton(&tree, &Camera::default(), &style, Size::new(400, 500)?, &Quiet)?;
            std::fs::write(folder.join(format!("paint-{name}-{ground}.png")), picture.srgb_png()?)?;
        }
    }
    let (parts, materials) = skin(&tree)?;
    let surface = Surface { parts: &parts, materials: &materials, skeleton: &tree };
    for (ground, style) in [("studio", Style::studio()), ("dark", Style::over_dark())] {
        let style = Style { person: true, ..style };
        let picture = draw_surface(&surface, &Camera::default(), &style, Size::new(400, 500)?, &Quiet)?;
        std::fs::write(folder.join(format!("surface-{ground}.png")), picture.srgb_png()?)?;
    }
    Ok(())
}

fn skin(tree: &Skeleton) -> Result<(Vec<Part>, Vec<Material>), Box<dyn std::error::Error>> {
    let mesh = sweep(tree, &Tubes::default(), &Quiet)?;
    let bark = Material {
        name: "bark".to_owned(),
        base_color: [0.16, 0.1, 0.06],
        base_color_picture: None,
        normal_picture: None,
        roughness: 0.9,
        double_sided: false,
        cutout: None,
        wrap: linden_pipeline::scene::Wrap::Repeat,
        translucency: None,
        passing_picture: None,
    };
    Ok((vec![Part::new("wood", 0, mesh)], vec![bark]))
}
