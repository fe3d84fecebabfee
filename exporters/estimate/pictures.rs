//! Bytes that pictures take as PNG, from what draws them.

use linden_pipeline::preset::{BarkSettings, DetailSettings};
use linden_pipeline::recipe::{Geometry, Recipe};
use linden_pipeline::surface::Junction;
use linden_pipeline::texture::BarkStyle;

/// All pictures of a bark as PNG, drawn or from files.
pub(super) fn bark_bytes(recipe: &Recipe) -> u64 {
    let look = &recipe.preset.dressing.bark;
    let is_parted = recipe.preset.dressing.tubes.junction != Junction::Watertight;
    let is_mossy = look.moss.amount > 0.0 && is_parted;
    let moss = if is_mossy { mossy_bytes(recipe) } else { 0 };
    let dressing = &recipe.preset.dressing;
    let foot = dressing.foot_bark().zip(dressing.tubes.foot_edge()).filter(|_| look.is_drawn());
    let foot = foot.map_or(0, |(foot, [from, to])| {
        let look = BarkSettings { style: foot.style, relief: None, ..look.clone() };
        // That of the foot, and the edge above it, which is as many tiles high.
        u64::from(1 + to - from) * (picture_bytes(&look) + moss)
    });
    bare_bytes(recipe) + moss + foot
}

/// Those of bark with moss: one as large as the bark's own, three of a quarter of its pixels.
fn mossy_bytes(recipe: &Recipe) -> u64 {
    let look = &recipe.preset.dressing.bark;
    let color = look.picture.as_ref().map_or_else(
        || {
            let side = f64::from(look.size_px);
            (side * side * libm::pow(side / 512.0, -0.45)) as u64
        },
        |file| file_bytes(recipe, file),
    );
    (MOSSY * color as f64) as u64
}

/// All four pictures of moss, in bytes a pixel of the bark's own: between a beech, whose bark is plain, and an ash.
const MOSSY: f64 = 2.2;

/// Both pictures of a bark without moss.
fn bare_bytes(recipe: &Recipe) -> u64 {
    let look = &recipe.preset.dressing.bark;
    match (&look.picture, &look.normal) {
        (None, None) => picture_bytes(look),
        // Normals follow the picture and take about twice as much (2.1 times for a ridged bark).
        (Some(file), None) => 3 * file_bytes(recipe, file),
        (None, Some(file)) => picture_bytes(look) / 2 + file_bytes(recipe, file),
        (Some(picture), Some(normal)) => file_bytes(recipe, picture) + file_bytes(recipe, normal),
    }
}

/// The pictures of a billboard as PNG: two, all planes beside each other in each.
pub(super) fn billboard_bytes(detail: &DetailSettings) -> u64 {
    let side = f64::from(detail.billboard_size_px);
    (f64::from(detail.billboard) * side * side * BILLBOARD_BYTES) as u64
}

/// For each pixel of a square as high as a plane: both pictures. Between an oak (0.8), a fir, whose
/// needles say more (1.9), and a box hedge in branch cards (2.8).
const BILLBOARD_BYTES: f64 = 1.8;

/// Both pictures of branch cards as PNG, all levels together: measured at 1024 pixels over all plants.
pub(super) fn card_bytes(size_px: u32) -> u64 {
    let side = f64::from(size_px);
    (side * side * libm::pow(side / 1024.0, -0.3)) as u64
}

/// The picture of how much light passes ÷ both others, of branch cards and billboards: 0.12 to 0.17 of an oak, a spruce
/// and a box hedge.
pub(super) const PASSING: f64 = 0.13;

/// Of a picture of the user's.
pub(super) fn file_bytes(recipe: &Recipe, file: &str) -> u64 {
    match recipe.input(file).map(|input| &input.geometry) {
        Some(Geometry::Picture(picture)) => picture.file_bytes,
        _ => 0,
    }
}

/// Both pictures of a bark as PNG.
///
/// Measured at 512 pixels with the usual grain; a pixel of a larger picture says less that its
/// neighbours have not said, and takes 0.73 times as much for each doubling of the side. From 1024 on finer grain says more,
/// in all styles about the same, and a pixel takes 0.86 times as much for each doubling.
fn picture_bytes(look: &BarkSettings) -> u64 {
    let (color, normal, relief) = match look.style {
        BarkStyle::Ridged => (0.98, 1.72, 0.045),
        BarkStyle::Smooth => (0.66, 0.54, 0.006),
        BarkStyle::Plated => (1.10, 1.80, 0.035),
        BarkStyle::Birch => (0.90, 1.2, 0.008),
        BarkStyle::Peeling => (0.85, 0.43, 0.012),
        BarkStyle::Ribbon => (0.61, 0.60, 0.008),
        BarkStyle::Culm => (0.37, 0.16, 0.002),
        BarkStyle::Palm => (1.10, 1.80, 0.055),
    };
    let side = f64::from(look.size_px.max(1));
    let is_fine = side >= 1024.0;
    let coarseness = if is_fine { libm::pow(side / 1024.0, -0.22) } else { libm::pow(side / 512.0, -0.45) };
    let (color, normal) =
        if is_fine { (f64::max(color, 1.05), f64::max(normal, 0.9)) } else { (color, normal) };
    let grain = 0.84 + 0.16 * libm::sqrt(f64::from(look.grain.clamp(0.0, 3.0)));
    // Without any relief all normals are the same.
    let depth = libm::pow(look.relief.map_or(1.0, |depth| f64::from(depth) / relief).clamp(0.0, 50.0), 0.15);
    (side * side * coarseness * grain * (color + normal * depth)) as u64
}

/// Both pictures of a kind of leaves as PNG, about: measured at 512 and 1024 pixels over all outlines.
pub(super) fn leaf_picture_bytes(size_px: u32) -> u64 {
    let side = f64::from(size_px);
    (side * side * libm::pow(side / 1024.0, -0.3)) as u64
}
