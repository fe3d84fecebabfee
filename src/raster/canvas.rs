//! The picture while it is being drawn, and what is behind it.
//!
//! A picture is drawn in bands of rows, in parallel. No pixel depends on how the rows are divided, so
//! any number of threads gives the same bytes. Light is added up in linear floats.

use std::sync::LazyLock;

use glam::{Vec3, Vec4};
use linden_pipeline::Monitor;
use linden_pipeline::color::encode;
use linden_pipeline::picture::Picture;
use rayon::prelude::*;

use crate::backdrop::Backdrop;
use crate::color::linear;
use crate::{RasterError, Size};

/// Rows of a band: enough to share what is done once a band.
const BAND: u32 = 32;
/// The most bands, so that looking through all strokes for each is little work.
const MOST_BANDS: u32 = 256;

/// Some rows of a picture.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rows {
    /// The uppermost, from the picture's upper edge.
    pub top: u32,
    /// How many.
    pub height: u32,
    /// Pixels per row: the picture's.
    pub width: u32,
}

/// How many rows the bands of a picture have (the last one fewer).
pub(crate) fn band_height(size: Size) -> u32 {
    BAND.max(size.height().div_ceil(MOST_BANDS))
}

/// Bytes of all bands that are drawn at once, each pixel with `bytes_per_pixel` besides its light.
pub(crate) fn band_bytes(size: Size, bytes_per_pixel: u64) -> u64 {
    let band = u64::from(band_height(size)) * u64::from(size.width());
    let at_once = size.height().div_ceil(band_height(size)).min(rayon::current_num_threads() as u32);
    u64::from(at_once) * band * (size_of::<Vec4>() as u64 + bytes_per_pixel)
}

/// Draws all bands by `draw`, which is given their pixels (premultiplied linear light, transparent
/// at first), and lays them over the backdrop.
pub(crate) fn compose(
    size: Size,
    backdrop: &Backdrop,
    monitor: &dyn Monitor,
    draw: impl Fn(Rows, &mut [Vec4]) -> Result<(), RasterError> + Sync,
) -> Result<Picture, RasterError> {
    let (width, height) = (size.width(), size.height());
    let per_row = width as usize * 4;
    let band = band_height(size);
    let mut rgba = vec![0; per_row * height as usize];
    rgba.par_chunks_mut(per_row * band as usize).enumerate().try_for_each(|(i, bytes)| {
        monitor.check()?;
        let rows = Rows { top: i as u32 * band, height: (bytes.len() / per_row) as u32, width };
        let mut pixels = vec![Vec4::ZERO; bytes.len() / 4];
        draw(rows, &mut pixels)?;
        let lines = bytes.chunks_exact_mut(per_row).zip(pixels.chunks_exact(width as usize));
        for ((line, pixels), y) in lines.zip(rows.top..) {
            let behind = backdrop.row(y, height);
            for ((out, pixel), x) in line.as_chunks_mut::<4>().0.iter_mut().zip(pixels).zip(0..) {
                *out = behind.below(*pixel, x, &LIGHT);
            }
        }
        Ok::<(), RasterError>(())
    })?;
    Ok(Picture::new(width, height, rgba))
}

/// The sRGB curve in tables: a picture asks for it millions of times.
pub(crate) struct Light {
    decoded: [f32; 256],
    encoded: Vec<f32>,
}

/// Steps of the table from light to code value; between them the curve is all but straight.
const ENCODE_STEPS: usize = 8192;

static LIGHT: LazyLock<Light> = LazyLock::new(Light::new);

impl Light {
    fn new() -> Self {
        let decoded = std::array::from_fn(|i| linear([i as u8; 3]).x);
        let encoded = (0..=ENCODE_STEPS).map(|i| encode(i as f32 / ENCODE_STEPS as f32)).collect();
        Self { decoded, encoded }
    }

    pub fn srgb(&self, light: Vec3) -> Vec3 {
        Vec3::from(light.to_array().map(|c| {
            let at = c.clamp(0.0, 1.0) * ENCODE_STEPS as f32;
            let below = (at as usize).min(ENCODE_STEPS - 1);
            let (a, b) = (self.encoded[below], self.encoded[below + 1]);
            a + (b - a) * (at - below as f32)
        }))
    }

    pub fn linear(&self, srgb: Vec3) -> Vec3 {
        Vec3::from(srgb.to_array().map(|c| {
            let at = c.clamp(0.0, 1.0) * 255.0;
            let below = (at as usize).min(254);
            let (a, b) = (self.decoded[below], self.decoded[below + 1]);
            a + (b - a) * (at - below as f32)
        }))
    }
}
