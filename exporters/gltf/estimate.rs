//! Bytes of a document, its buffer and its pictures, from what they hold.

use linden_pipeline::picture::PictureFormat;
use linden_pipeline::wind::Wind;

use super::options::is_wind_packed;
use crate::collision;
use crate::writing::lightmap::LIGHTMAP_UV;
use crate::{Amounts, Encoding, Options};

/// What meshopt leaves of wind. Set by estimate; three plants bear it out within 30 % (test).
const PACKED_WIND: f64 = 0.5;

/// What meshopt leaves of the second set.
const PACKED_SECOND: f64 = 0.7;

/// What meshopt leaves of bindings.
const PACKED_BINDINGS: f64 = 0.2;
/// A joint's node and how it is animated, as JSON, and its matrix.
const JOINT: u64 = 64 + 310;

/// What JPEG colours and normals in steps leave of the bark's pictures: 0.51 to 0.55 at eight plants, 0.29 at a sunflower.
const JPEG_OPAQUE: f64 = 0.52;
/// What normals in steps leave of all others, whose colours stay PNG: 0.82 to 0.91 at the six of them with leaves.
const JPEG_CUT: f64 = 0.88;
/// What WebP leaves of all pictures: measured at six plants, from 0.85 to 1.03.
const WEBP_PICTURES: f64 = 0.94;

/// A texel with pivots and one with directions, of an axis. Finer axes have none, and sides of pictures are powers of
/// two.
const TEXEL: u64 = 12;

/// Bytes with these options, in one file or several.
pub(crate) fn bytes(amounts: &Amounts, options: &Options) -> u64 {
    let amounts = if options.is_on("instances") { amounts.instanced() } else { *amounts };
    let Amounts { vertices, triangles, plain_vertices, placements, .. } = amounts;
    let passing = if options.is_on("translucency") { amounts.passing_picture_bytes } else { 0 };
    let pictures = if options.is_on("pictures") { amounts.picture_bytes + passing } else { 0 };
    let pictures = match super::picture_format(options) {
        PictureFormat::Png => pictures,
        PictureFormat::Jpeg => {
            let opaque = amounts.opaque_picture_bytes.min(pictures);
            (JPEG_OPAQUE * opaque as f64 + JPEG_CUT * (pictures - opaque) as f64) as u64
        }
        PictureFormat::Webp => (pictures as f64 * WEBP_PICTURES) as u64,
    };
    let has_pictures = pictures > 0;
    let tangents = if has_pictures { 16 * (vertices - plain_vertices) } else { 0 };
    // The sway loop cannot be quantized.
    let is_quantized = options.is_on("quantize") && amounts.wind != Wind::Sway;
    // Texture coordinates stay whole where no picture is seen.
    let plain = if has_pictures { plain_vertices } else { vertices };
    // Twelve bytes a vertex where they are packed, eight where they name texels (four with fewer bits), in place of two
    // vectors of sixteen.
    let (vector, texels) = if is_wind_packed(options, amounts.wind == Wind::Sway) {
        (6, 0)
    } else if options.is_word("wind_as", "pivot-painter") && amounts.wind_vectors() > 0 {
        (if is_quantized { 2 } else { 4 }, TEXEL * amounts.axes)
    } else {
        (16, 0)
    };
    let moved = vector * amounts.wind_vectors() + 12 * amounts.target_vectors();
    // What each vertex is bound to, and the turns of each joint: of four numbers, in halves with fewer bits.
    let turns = amounts.joints * amounts.frames * if is_quantized { 8 } else { 16 };
    let bound = 8 * amounts.bound_vertices();
    // Whatever the order, each number of the second set is a new one.
    let second = if options.is_on(LIGHTMAP_UV.knob.name) { if is_quantized { 4 } else { 8 } } else { 0 };
    let second = second * vertices;
    let buffer = if super::encoding(options) == Encoding::Packed {
        // Measured over the built-in presets.
        let (vertex, tangent) = if is_quantized { (9.0, 2.6) } else { (21.6, 9.6) };
        let whole = if is_quantized { 2.5 * plain as f64 } else { 0.0 };
        let tangents = tangent / 16.0 * tangents as f64;
        let meshes = vertex * vertices as f64 + whole + tangents + 2.1 * triangles as f64;
        meshes as u64
            + 34 * placements
            + (second as f64 * PACKED_SECOND) as u64
            + ((moved + turns) as f64 * PACKED_WIND + bound as f64 * PACKED_BINDINGS) as u64
    } else {
        let index = if u16::try_from(vertices).is_ok() { 2 } else { 4 };
        let of_vertices =
            if is_quantized { vertices * 16 + tangents / 4 + plain * 4 } else { vertices * 32 + tangents };
        of_vertices + second + triangles * 3 * index + 40 * placements + moved + turns + bound
    };
    let shapes = collision::expected(amounts.axes, options);
    // As nodes, or as meshes of 34 points and 64 triangles each.
    let shapes = shapes * if options.is_word("collision_as", "omi") { 340 } else { 34 * 12 + 64 * 6 + 780 };
    let buffer = buffer + pictures + shapes;
    // As base64.
    let buffer = if options.is_on("embed") { buffer.div_ceil(3) * 4 } else { buffer };
    buffer + texels + JOINT * amounts.joints + amounts.recipe_bytes + 1700 + 900 * amounts.foliage_materials
}
