//! How long dressing and writing take, from rates that were measured.
//!
//! Pictures from the processor time of `linden export older-f --set bark_size=64` to `2048` and of `linden export
//! dressed-simple --set leaf_size=256` to `2048`, triangles and bytes from the benchmarks in docs/measured.md, the rest
//! set by estimate; on two shared cores (Xeon, 2.0 GHz), release build. `cargo bench -p linden-tests --bench
//! forecast` prints forecasts beside the truth. Other machines differ by a factor: what is said before long work
//! is meant to tell seconds from minutes.

use linden_pipeline::recipe::Recipe;
use linden_pipeline::settings::Dressing;
use linden_pipeline::surface::Junction;

use super::Estimate;
use crate::{Encoding, Format, Options};

/// Sweeping or shaping a triangle, its memory touched for the first time.
const TRIANGLE_S: f64 = 25e-9;
/// Measuring one without keeping it: swept by two threads, and its tube compared with one that was proved closed.
const SURVEYED_TRIANGLE_S: f64 = 45e-9;
/// Drawing a pixel of bark, both pictures.
const BARK_PIXEL_S: f64 = 300e-9;
/// Drawing a pixel of leaves, both pictures.
const LEAF_PIXEL_S: f64 = 120e-9;
/// Drawing a pixel of a billboard.
const BILLBOARD_PIXEL_S: f64 = 600e-9;
/// Drawing and compressing a pixel of branch cards, both pictures.
const CARD_PIXEL_S: f64 = 350e-9;
/// Compressing a pixel of a picture.
const PNG_PIXEL_S: f64 = 45e-9;
/// Solving for a level: triangles of the whole tree are counted again and again.
const SOLVED_TRIANGLE_S: f64 = 15e-9;
/// Wind: for each triangle.
const BLOWN_TRIANGLE_S: f64 = 40e-9;
/// A triangle of one closed solid, which is contoured cell by cell.
const SOLID_TRIANGLE_S: f64 = 4e-6;
/// Writing a byte as text and as it is.
const TEXT_BYTE_S: f64 = 2.2e-9;
const BINARY_BYTE_S: f64 = 1.2e-9;
/// Packing a triangle and its vertices.
const PACKED_TRIANGLE_S: f64 = 90e-9;

impl Estimate {
    /// From a skeleton to all levels of a scene, its pictures drawn.
    pub fn dress_seconds(&self, recipe: &Recipe) -> f64 {
        self.shape_seconds(recipe) + self.draw_seconds(recipe)
    }

    /// Drawing bark and leaves.
    pub fn draw_seconds(&self, recipe: &Recipe) -> f64 {
        let Dressing { bark, foliage, .. } = &recipe.preset.dressing;
        let square = |side: u32| f64::from(side) * f64::from(side);
        square(bark.size_px) * BARK_PIXEL_S
            + self.drawn_kinds(recipe) * square(foliage.size_px) * LEAF_PIXEL_S
    }

    /// From a skeleton to all levels of a scene where bark and leaves were drawn before.
    pub fn shape_seconds(&self, recipe: &Recipe) -> f64 {
        let Dressing { detail, tubes, wind, .. } = &recipe.preset.dressing;
        let triangles: f64 = self.level_triangles().sum();
        let is_solved = detail.finest() > 0 || detail.triangle_levels() > 1;
        let solved = if is_solved { SOLVED_TRIANGLE_S * self.unbudgeted_triangles() * 8.0 } else { 0.0 };
        let swept = match tubes.junction {
            Junction::Watertight => SOLID_TRIANGLE_S,
            _ => TRIANGLE_S,
        };
        let blown = if wind.wind == linden_pipeline::wind::Wind::Off { 0.0 } else { BLOWN_TRIANGLE_S };
        let square = |side: u32| f64::from(side) * f64::from(side);
        let planes = f64::from(detail.billboard) * square(detail.billboard_size_px);
        let cards = if self.has_cards() { square(detail.card_size_px) * CARD_PIXEL_S } else { 0.0 };
        triangles * (swept + blown) + solved + planes * BILLBOARD_PIXEL_S + cards
    }

    /// Measuring the surface and the leaves, as `linden stats` does.
    pub fn survey_seconds(&self, recipe: &Recipe) -> f64 {
        let of_triangle = match recipe.preset.dressing.tubes.junction {
            Junction::Watertight => SOLID_TRIANGLE_S,
            _ => SURVEYED_TRIANGLE_S,
        };
        let side = f64::from(recipe.preset.dressing.foliage.size_px);
        self.triangles as f64 * of_triangle + self.drawn_kinds(recipe) * side * side * LEAF_PIXEL_S
    }

    /// Writing a format with these options; pictures are compressed once for all, by the first. `None`
    /// where the format has no estimate of its bytes.
    pub fn write_seconds(&self, format: &Format, options: &Options) -> Option<f64> {
        let bytes = self.bytes(format, options)? as f64;
        Some(match (format.encoding)(options) {
            Encoding::Text => bytes * TEXT_BYTE_S,
            Encoding::Binary => bytes * BINARY_BYTE_S,
            Encoding::Packed => {
                bytes * BINARY_BYTE_S + self.level_triangles().sum::<f64>() * PACKED_TRIANGLE_S
            }
        })
    }

    /// Compressing all pictures.
    pub fn compress_seconds(&self, recipe: &Recipe) -> f64 {
        let square = |side: u32| f64::from(side) * f64::from(side);
        let bark = square(recipe.preset.dressing.bark.size_px);
        let leaves = self.drawn_kinds(recipe) * square(recipe.preset.dressing.foliage.size_px);
        2.0 * (bark + leaves) * PNG_PIXEL_S
    }
}
