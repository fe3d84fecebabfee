//! Bytes of a layer and its pictures, from what they hold.
//!
//! Text was measured over the built-in presets, in bytes a vertex or node without indices: those follow
//! from the number of digits.

use linden_pipeline::wind::Wind;

use super::nanite::Nanite;
use crate::collision;
use crate::writing::lightmap::LIGHTMAP_UV;
use crate::writing::mean_digits;
use crate::{Amounts, Options};

// Of wind: characters of a vector of four numbers, those of a vector of three and its comma. Set by
// estimate; three plants bear them out within 30 % (test).
const WIND: f64 = 38.0;
const TARGET: f64 = 34.0;
// Of joints: what binds a vertex, in binary and as text; a joint itself; its turn in a frame.
const BOUND: f64 = 12.0;
const BOUND_TEXT: f64 = 36.0;
const JOINT: u64 = 340;
const JOINT_TEXT: u64 = 420;
const TURN_TEXT: u64 = 48;

// Texture coordinates have an index for each corner: characters and bytes that those of a corner take more than one for each
// vertex. Leaves have few pairs and short indices, wood has long ones.
const CORNER_TEXT: f64 = 5.0;
const CORNER: f64 = 0.25;

/// Corners of triangles, less one for each vertex.
fn more_corners(amounts: &Amounts) -> f64 {
    (3 * amounts.triangles).saturating_sub(amounts.vertices) as f64
}

/// What is written with these options.
fn written(amounts: &Amounts, options: &Options) -> Amounts {
    let is_full = !options.is_word("flavor", "ar");
    match Nanite::asked(options) {
        Some(Nanite::Skeletal) if amounts.wind == Wind::Bones => amounts.in_parts(),
        Some(_) => {
            let mut still = amounts.in_parts();
            still.wind = Wind::Off;
            (still.joints, still.frames) = (0, 0);
            still
        }
        None if options.is_on("instances") && is_full => amounts.instanced(),
        None => *amounts,
    }
}

// What binds a copy of a skeletal assembly, as text and in binary.
const PLACE_TEXT: f64 = 70.0;
const PLACE: f64 = 18.0;

/// 1 where copies are bound to joints.
fn bound_place(amounts: &Amounts, options: &Options) -> f64 {
    f64::from(u8::from(Nanite::asked(options) == Some(Nanite::Skeletal) && amounts.wind == Wind::Bones))
}

/// Bytes a vertex that the second set of texture coordinates takes as text.
fn second_set(options: &Options) -> f64 {
    if options.is_on(LIGHTMAP_UV.knob.name) { 24.0 } else { 0.0 }
}

/// Bytes with these options, in one file or several, as binary: numbers take four bytes, indices one and a bit.
pub(super) fn binary_bytes(amounts: &Amounts, options: &Options) -> u64 {
    let is_full = !options.is_word("flavor", "ar");
    let amounts = written(amounts, options);
    let Amounts { vertices, triangles, nodes, axes, .. } = amounts;
    let is_plain = is_full && Nanite::asked(options).is_none();
    let curves = if options.is_on("skeleton") && is_plain { 20.0 * (nodes + axes) as f64 } else { 0.0 };
    let meshes = 27.0 * vertices as f64
        + 3.2 * triangles as f64
        + (33.0 + bound_place(&amounts, options) * PLACE) * amounts.placements as f64;
    let moved = 12.0 * amounts.wind_vectors() as f64 + 13.0 * amounts.target_vectors() as f64;
    let meshes = meshes + CORNER * more_corners(&amounts) + second_set(options) / 3.0 * vertices as f64;
    let moved = moved + BOUND * amounts.bound_vertices() as f64;
    let moved = moved + (JOINT + 16 * amounts.frames) as f64 * amounts.joints as f64;
    let materialx = if options.is_on("materialx") && is_full { 400 * amounts.foliage_materials } else { 0 };
    let shapes = if is_plain { 160 * collision::expected(amounts.axes, options) } else { 0 };
    let around = amounts.recipe_bytes + 4000 + 300 * amounts.foliage_materials + materialx + shapes;
    let pictures = picture_bytes(&amounts, options);
    (meshes + moved + curves) as u64 + around + pictures
}

/// Of all pictures as they are.
fn picture_bytes(amounts: &Amounts, options: &Options) -> u64 {
    let with_materialx = options.is_on("materialx") && !options.is_word("flavor", "ar");
    let passing = if with_materialx { amounts.passing_picture_bytes } else { 0 };
    if options.is_on("pictures") { amounts.picture_bytes + passing } else { 0 }
}

/// Bytes with these options, in one file or several, as text.
pub(super) fn bytes(amounts: &Amounts, options: &Options) -> u64 {
    // What augmented reality refuses is left out.
    let is_full = !options.is_word("flavor", "ar");
    let amounts = written(amounts, options);
    let is_plain = is_full && Nanite::asked(options).is_none();
    let Amounts { vertices, triangles, nodes, axes, .. } = amounts;
    let digits = mean_digits(vertices);
    // `3, ` and `a, b, c, `.
    let faces = triangles as f64 * (3.0 * digits + 9.0);
    let curves = if options.is_on("skeleton") && is_plain { 49.0 * (nodes + axes) as f64 } else { 0.0 };
    let places = (109.0 + bound_place(&amounts, options) * PLACE_TEXT) * amounts.placements as f64;
    // Vectors of four and three numbers; the latter with the index of their vertex.
    let moved = WIND * amounts.wind_vectors() as f64 + (TARGET + digits) * amounts.target_vectors() as f64;
    let moved = moved + BOUND_TEXT * amounts.bound_vertices() as f64;
    let moved = moved + (JOINT_TEXT + TURN_TEXT * amounts.frames) as f64 * amounts.joints as f64;
    let materialx = if options.is_on("materialx") && is_full { 3400 * amounts.foliage_materials } else { 0 };
    let around = 2 * amounts.recipe_bytes + 3000 + 900 * amounts.foliage_materials + materialx;
    let shapes = if is_plain { 520 * collision::expected(amounts.axes, options) } else { 0 };
    let around = around + shapes;
    let pictures = picture_bytes(&amounts, options);
    let second = second_set(options) * vertices as f64 + CORNER_TEXT * more_corners(&amounts);
    (85.0 * vertices as f64 + second + places + moved + faces + curves) as u64 + around + pictures
}
