//! Draws presets lit, in a studio and over terminals: `cargo run --release -p linden-raster --example lit FOLDER PRESET...`.
#![allow(clippy::print_stdout)]

use std::path::PathBuf;
use std::time::Instant;

use linden_pipeline::dress::dress;
use linden_pipeline::grow::grow;
use linden_pipeline::recipe::Recipe;
use linden_pipeline::{Quiet, preset};
use linden_raster::{Camera, Size, Style, Surface, draw_skeleton, draw_surface};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut words = std::env::args().skip(1);
    let folder = PathBuf::from(words.next().unwrap_or_else(|| ".".into()));
    for id in words {
        let recipe = Recipe::new(preset::builtin(&id)?.load()?);
        let grown = grow(&recipe, &Quiet)?;
        let scene = dress(&recipe, &grown, &Quiet)?;
        let surface = Surface::from(&scene);
        let size = Size::new(1400, 1000)?;
        let styles = [
            ("studio", Style::studio()),
            ("dark", Style::landscape([16, 16, 18], true)),
            ("light", Style::landscape([250, 250, 250], false)),
        ];
        for (name, style) in styles {
            let style = Style {
                organs: Some(&grown.organs),
                leaf_colors: recipe.preset.dressing.foliage.turtle_colors(),
                ..style
            };
            let camera = Camera::default();
            let time = |draft: bool, is_surface: bool| {
                let style = Style { draft, ..style };
                let mut took: Vec<f64> = (0..5)
                    .map(|_| {
                        let start = Instant::now();
                        let drawn = if is_surface {
                            draw_surface(&surface, &camera, &style, size, &Quiet)
                        } else {
                            draw_skeleton(&grown.skeleton, &camera, &style, size, &Quiet)
                        };
                        drop(drawn);
                        start.elapsed().as_secs_f64() * 1e3
                    })
                    .collect();
                took.sort_by(f64::total_cmp);
                took[2]
            };
            println!(
                "{id} {name}: surface {:.0} ms, draft {:.0} ms; skeleton {:.0} ms, draft {:.0} ms",
                time(false, true),
                time(true, true),
                time(false, false),
                time(true, false)
            );
            let lit = draw_surface(&surface, &camera, &style, size, &Quiet)?;
            std::fs::write(folder.join(format!("{id}-{name}.png")), lit.srgb_png()?)?;
            let strokes = draw_skeleton(&grown.skeleton, &camera, &style, size, &Quiet)?;
            std::fs::write(folder.join(format!("{id}-{name}-strokes.png")), strokes.srgb_png()?)?;
        }
    }
    Ok(())
}
