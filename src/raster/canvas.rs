//! Tiles that are drawn larger than they are shown, and what is behind them.
//!
//! tiny-skia covers a pixel in steps of a quarter and cannot take coordinates past 8191. Small
//! pictures are therefore drawn at two or four times their size and averaged in linear light, and
//! all pictures in tiles. The backdrop is computed per pixel, in floats and dithered: without that
//! a soft gradient shows bands.

use glam::{Vec2, Vec3};
use linden::color::encode;
use linden::picture::Picture;
use tiny_skia::Pixmap;

use crate::color::{encoded, linear};
use crate::style::Background;
use crate::{Extent, RasterError, Size, View};

/// The longest side of what tiny-skia draws at once.
const TILE_PX: u32 = 2048;

/// A rectangle of the picture while it is being drawn.
pub(crate) struct Tile {
    /// Premultiplied sRGB, transparent at first.
    pub pixmap: Pixmap,
    /// The tile's upper left corner, pixels of the finished picture.
    pub origin: Vec2,
    /// Drawn pixels per pixel of the finished picture, along one side.
    pub factor: f32,
}

/// How many times larger than shown a picture is drawn.
pub(crate) fn oversampling(size: Size) -> u32 {
    match size.width().max(size.height()) {
        0..=256 => 4,
        257..=2048 => 2,
        _ => 1,
    }
}

/// Draws all tiles by `draw` and lays them over the backdrop.
pub(crate) fn compose(
    size: Size,
    backdrop: &Backdrop,
    mut draw: impl FnMut(&mut Tile) -> Result<(), RasterError>,
) -> Result<Picture, RasterError> {
    let (width, height) = (size.width(), size.height());
    let factor = oversampling(size);
    let side = TILE_PX / factor;
    let light = Light::new();
    let mut rgba = vec![0; width as usize * height as usize * 4];
    for top in (0..height).step_by(side as usize) {
        for left in (0..width).step_by(side as usize) {
            let (w, h) = (side.min(width - left), side.min(height - top));
            let Some(pixmap) = Pixmap::new(w * factor, h * factor) else {
                return Err(RasterError::Size { width, height });
            };
            let origin = Vec2::new(left as f32, top as f32);
            let mut tile = Tile { pixmap, origin, factor: factor as f32 };
            draw(&mut tile)?;
            for y in 0..h {
                let start = ((top + y) as usize * width as usize + left as usize) * 4;
                let row = rgba[start..start + w as usize * 4].as_chunks_mut::<4>().0;
                for (x, pixel) in row.iter_mut().enumerate() {
                    let over = light.average(&tile.pixmap, x as u32, y, factor);
                    *pixel = backdrop.below(over, left + x as u32, top + y, height, &light);
                }
            }
        }
    }
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
    /// `extent` is the tree's when it throws a shadow, on the plane through `ground`, where it stands.
    pub(crate) fn new(background: Background, view: &View, ground: Vec3, extent: Option<Extent>) -> Self {
        let shadow = extent.filter(|_| view.is_above(ground.y)).map(|e| {
            let reach = 0.6 * e.radius();
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
    fn below(&self, (light, alpha): (Vec3, f32), x: u32, y: u32, height: u32, curve: &Light) -> [u8; 4] {
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

    /// The mean of the drawn pixels under one shown pixel: premultiplied linear light, and alpha.
    fn average(&self, pixmap: &Pixmap, x: u32, y: u32, factor: u32) -> (Vec3, f32) {
        let (mut light, mut alpha) = (Vec3::ZERO, 0.0);
        let data = pixmap.data().as_chunks::<4>().0;
        for row in y * factor..(y + 1) * factor {
            let start = (row * pixmap.width() + x * factor) as usize;
            for &[r, g, b, a] in &data[start..start + factor as usize] {
                if a == 0 {
                    continue;
                }
                let whole = f32::from(a) / 255.0;
                let [r, g, b] = [r, g, b].map(|c| match a {
                    255 => self.decoded[usize::from(c)],
                    _ => {
                        self.decoded
                            [((u32::from(c) * 255 + u32::from(a) / 2) / u32::from(a)).min(255) as usize]
                    }
                });
                light += Vec3::new(r, g, b) * whole;
                alpha += whole;
            }
        }
        let share = 1.0 / (factor * factor) as f32;
        (light * share, alpha * share)
    }
}

/// Linear light as tiny-skia's colour.
pub(crate) fn skia_color(light: Vec3, alpha: f32) -> tiny_skia::Color {
    let c = encoded(light);
    tiny_skia::Color::from_rgba(c.x, c.y, c.z, alpha.clamp(0.0, 1.0)).unwrap_or(tiny_skia::Color::TRANSPARENT)
}
