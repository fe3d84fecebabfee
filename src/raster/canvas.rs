//! The picture while it is being drawn, and what is behind it.
//!
//! A picture is drawn in bands of rows, in parallel. No pixel depends on how the rows are divided, so
//! any number of threads gives the same bytes. Light is added up in linear floats; the backdrop is
//! computed per pixel and dithered: without that a soft gradient shows bands.

use std::sync::LazyLock;

use glam::{Vec2, Vec3, Vec4};
use linden_pipeline::Monitor;
use linden_pipeline::color::encode;
use linden_pipeline::picture::Picture;
use rayon::prelude::*;

use crate::color::linear;
use crate::style::Background;
use crate::{RasterError, Size, View};

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
        let places = (0..rows.height).flat_map(|y| (0..width).map(move |x| (x, y)));
        for ((out, pixel), (x, y)) in bytes.as_chunks_mut::<4>().0.iter_mut().zip(&pixels).zip(places) {
            *out = backdrop.below(*pixel, x, rows.top + y, height, &LIGHT);
        }
        Ok::<(), RasterError>(())
    })?;
    Ok(Picture::new(width, height, rgba))
}

/// What is behind the tree, with the shadow on it.
pub(crate) struct Backdrop {
    background: Background,
    shadow: Option<Shadow>,
}

/// An ellipse on the ground that fades out towards its rim.
struct Shadow {
    middle: Vec2,
    half_axes: Vec2,
}

/// How much light the shadow's middle swallows.
const SHADOW_DEPTH: f32 = 0.5;

impl Backdrop {
    /// `radius_m` is the crown's when the tree throws a shadow, on the plane through `ground`, where it
    /// stands.
    pub(crate) fn new(background: Background, view: &View, ground: Vec3, radius_m: Option<f32>) -> Self {
        let shadow = radius_m.filter(|_| view.is_above(ground.y)).map(|radius_m| {
            let reach = 0.6 * radius_m;
            let at = |dx: f32, dz: f32| view.project(ground + Vec3::new(dx * reach, 0.0, dz * reach)).at;
            let middle = at(0.0, 0.0);
            // Largest reach right and down over the rim, by its two conjugate half-axes.
            let (a, b) = (at(1.0, 0.0) - middle, at(0.0, 1.0) - middle);
            let half_axes = (a * a + b * b).map(libm::sqrtf).max(Vec2::splat(0.5));
            Shadow { middle, half_axes }
        });
        Self { background, shadow }
    }

    /// The finished pixel: what was drawn (premultiplied linear light), and this behind it.
    fn below(&self, drawn: Vec4, x: u32, y: u32, height: u32, curve: &Light) -> [u8; 4] {
        let (light, alpha) = (drawn.truncate(), drawn.w.clamp(0.0, 1.0));
        let at = Vec2::new(x as f32 + 0.5, y as f32 + 0.5);
        let shade = self.shadow.as_ref().map_or(0.0, |s| {
            let away = (at - s.middle) / s.half_axes;
            let left = (1.0 - away.length_squared()).max(0.0);
            SHADOW_DEPTH * left * left
        });
        let (top, bottom) = match self.background {
            Background::Transparent => {
                let whole = alpha + (1.0 - alpha) * shade;
                let color = if whole > 0.0 { curve.srgb(light / whole) } else { Vec3::ZERO };
                let [r, g, b] = (color * 255.0 + 0.5).to_array().map(|c| c as u8);
                return [r, g, b, (whole * 255.0 + 0.5) as u8];
            }
            Background::Plain(c) => (c, c),
            Background::Gradient(top, bottom) => (top, bottom),
        };
        // Gradients are even to the eye in sRGB.
        let t = if height > 1 { y as f32 / (height - 1) as f32 } else { 0.5 };
        let [top, bottom] = [top, bottom].map(|c| Vec3::from(c.map(f32::from)));
        let plain = top.lerp(bottom, t) / 255.0;
        let color = if alpha == 0.0 && shade == 0.0 {
            plain
        } else {
            curve.srgb(light + curve.linear(plain) * ((1.0 - alpha) * (1.0 - shade)))
        };
        let [r, g, b] = (color * 255.0 + grain(x, y)).to_array().map(|c| c as u8);
        [r, g, b, 255]
    }
}

/// Threshold 0..1 for rounding, "interleaved gradient noise" (Jimenez 2014, "Next generation
/// post-processing in Call of Duty", slide 123): neighbours differ much, areas little.
fn grain(x: u32, y: u32) -> f32 {
    let f = 0.067_110_56 * f64::from(x) + 0.005_837_15 * f64::from(y);
    let g = 52.982_918_9 * (f - f.floor());
    (g - g.floor()) as f32
}

/// The sRGB curve in tables: a picture asks for it millions of times.
struct Light {
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

    fn srgb(&self, light: Vec3) -> Vec3 {
        Vec3::from(light.to_array().map(|c| {
            let at = c.clamp(0.0, 1.0) * ENCODE_STEPS as f32;
            let below = (at as usize).min(ENCODE_STEPS - 1);
            let (a, b) = (self.encoded[below], self.encoded[below + 1]);
            a + (b - a) * (at - below as f32)
        }))
    }

    fn linear(&self, srgb: Vec3) -> Vec3 {
        Vec3::from(srgb.to_array().map(|c| {
            let at = c.clamp(0.0, 1.0) * 255.0;
            let below = (at as usize).min(254);
            let (a, b) = (self.decoded[below], self.decoded[below + 1]);
            a + (b - a) * (at - below as f32)
        }))
    }
}
