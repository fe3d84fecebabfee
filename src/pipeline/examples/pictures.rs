//! Draws every leaf, twigs in four seasons and every bark as contact sheets:
//! `cargo run --release -p linden --example pictures FOLDER [PIXELS]`.
#![allow(clippy::print_stdout)]

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

use linden_pipeline::Quiet;
use linden_pipeline::color::{decode, encode};
use linden_pipeline::picture::Picture;
use linden_pipeline::random::Key;
use linden_pipeline::texture::leaf::{LeafLook, LeafPictures, Outline, TwigLook};
use linden_pipeline::texture::{Bark, BarkStyle};

type Fallible<T> = Result<T, Box<dyn std::error::Error>>;

fn main() -> Fallible<()> {
    let mut args = std::env::args_os().skip(1);
    let folder: PathBuf = args.next().unwrap_or_else(|| ".".into()).into();
    let size_px = args.next().and_then(|s| s.to_str()?.parse().ok()).unwrap_or(512);
    std::fs::create_dir_all(&folder)?;
    barks(&folder, size_px)?;
    let key = Key::new(7).named("leaf");
    let mut leaves = Vec::new();
    let mut twigs = Vec::new();
    for (name, outline, _) in Outline::ALL {
        let look = LeafLook { size_px, ..LeafLook::new(outline) };
        let start = Instant::now();
        let drawn = look.draw(key, &Quiet)?;
        let leaf_ms = start.elapsed().as_secs_f64() * 1e3;
        let start = Instant::now();
        let twig = look.draw_twig(&TwigLook::default(), key, &Quiet)?;
        println!("{name}: leaves {leaf_ms:.0} ms, twigs {:.0} ms", start.elapsed().as_secs_f64() * 1e3);
        save(&folder, name, &drawn)?;
        let one = LeafLook { variants: 1, ..look }.draw(key, &Quiet)?;
        leaves.push(Arc::new(lit(&one.base_color, &one.normal)));
        twigs.push(Arc::new(lit(&twig.base_color, &twig.normal)));
    }
    sheet(&leaves, 6, size_px, &folder.join("leaves.png"))?;
    sheet(&twigs, 6, size_px, &folder.join("twigs.png"))?;
    let mut seasons = Vec::new();
    for outline in [Outline::Cordate, Outline::Lobed, Outline::Palmate, Outline::Rhombic] {
        for season in [0.05, 0.35, 0.7, 0.85] {
            let look = LeafLook { size_px, season, ..LeafLook::new(outline) };
            let twig = look.draw_twig(&TwigLook::default(), key, &Quiet)?;
            seasons.push(Arc::new(lit(&twig.base_color, &twig.normal)));
        }
    }
    sheet(&seasons, 4, size_px, &folder.join("seasons.png"))?;
    Ok(())
}

fn barks(folder: &Path, size_px: u32) -> Fallible<()> {
    let mut barks = Vec::new();
    for (name, style, _) in BarkStyle::ALL {
        let start = Instant::now();
        let drawn = Bark { size_px, ..Bark::new(style, Key::new(7).named("bark")) }.draw(&Quiet)?;
        println!("bark {name}: {:.0} ms", start.elapsed().as_secs_f64() * 1e3);
        barks.push(Arc::new(lit(&drawn.base_color, &drawn.normal)));
    }
    sheet(&barks, 3, size_px, &folder.join("barks.png"))
}

fn save(folder: &Path, name: &str, drawn: &LeafPictures) -> Fallible<()> {
    std::fs::write(folder.join(format!("{name}.png")), drawn.base_color.srgb_png()?)?;
    std::fs::write(folder.join(format!("{name}-normal.png")), drawn.normal.png()?)?;
    Ok(())
}

/// A picture as it looks in light from the upper left.
fn lit(base: &Picture, normal: &Picture) -> Picture {
    let pixels = base.rgba().as_chunks::<4>().0.iter().zip(normal.rgba().as_chunks::<4>().0);
    let rgba = pixels.flat_map(|(&[r, g, b, a], &normal)| {
        let [x, y, z, _] = normal.map(|c| f32::from(c) / 127.5 - 1.0);
        let light = 0.3 + 1.0 * (-0.45 * x + 0.5 * y + 0.74 * z).max(0.0);
        let shade = |c: u8| (encode(decode(f32::from(c) / 255.0) * light).min(1.0) * 255.0 + 0.5) as u8;
        [shade(r), shade(g), shade(b), a]
    });
    Picture::new(base.width(), base.height(), rgba.collect())
}

/// Pictures side by side on light grey.
fn sheet(pictures: &[impl AsRef<Picture>], columns: usize, size_px: u32, path: &Path) -> Fallible<()> {
    let n = size_px as usize;
    let rows = pictures.len().div_ceil(columns);
    let mut rgba = vec![225; n * columns * n * rows * 4];
    for (i, picture) in pictures.iter().enumerate() {
        let (x, y) = (i % columns * n, i / columns * n);
        for (row, line) in picture.as_ref().rgba().chunks_exact(4 * n).enumerate() {
            let out = &mut rgba[((y + row) * n * columns + x) * 4..][..4 * n];
            for (out, &[r, g, b, a]) in out.as_chunks_mut::<4>().0.iter_mut().zip(line.as_chunks().0) {
                let over = |c: u8| ((u32::from(c) * u32::from(a) + 225 * (255 - u32::from(a))) / 255) as u8;
                *out = [over(r), over(g), over(b), 255];
            }
        }
    }
    std::fs::write(path, Picture::new((n * columns) as u32, (n * rows) as u32, rgba).srgb_png()?)?;
    Ok(())
}
