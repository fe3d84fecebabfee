//! Bark: a height field, its colours and its normals.
//!
//! The height is composed of plates, ridges or layers, bent by slow noise, and grain. Colour follows
//! it: furrows are dark, what sticks out is weathered, and lichen sits where light and rain come. Light that varies over
//! much of a picture is evened out, or repeats would be seen from afar.

mod even;
mod lenticels;
mod moss;
mod styles;
mod surface;
mod torn;
mod user;

use std::sync::Arc;

use glam::Vec3;
use rayon::prelude::*;

use self::even::even;
use self::lenticels::Lenticels;
pub use self::moss::Moss;
use self::surface::{Spot, Surface};
pub(crate) use self::torn::Torn;
pub use self::user::{normals_by_lightness, opaque};
use linden_base::color::{code, linear};
use linden_base::memory::{OverMemory, bytes_of};
use linden_base::monitor::{Cancelled, Monitor};
use linden_base::picture::Picture;
use linden_base::random::Key;

/// A kind of bark.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum BarkStyle {
    /// Long ridges that part and meet: oak, ash, lime.
    #[default]
    Ridged,
    /// Thin and whole, with lenticels and blotches: beech, hornbeam.
    Smooth,
    /// Flaking plates between narrow fissures: pine, larch.
    Plated,
    /// White, with dark lenticels across and black scars: birch.
    Birch,
    /// Thin plates that fall and leave patches of other colours: plane, sycamore.
    Peeling,
    /// Shed in long ribbons, down to pale young skin: blue gum.
    Ribbon,
    /// The smooth stem of a grass: bamboo.
    Culm,
    /// What is left of shed leaves, in rows that overlap like shingles: date palm.
    Palm,
}

impl BarkStyle {
    /// Every style: its name for users, what it looks like, and its usual bark.
    pub const ALL: [(&'static str, Self, &'static str); 8] = [
        ("ridged", Self::Ridged, "long ridges that part and meet, as oak and ash"),
        ("smooth", Self::Smooth, "thin and whole with lenticels, as beech"),
        ("plated", Self::Plated, "flaking plates between fissures, as pine"),
        ("birch", Self::Birch, "white with dark lenticels and black scars, as birch"),
        ("peeling", Self::Peeling, "patches where thin plates have fallen, as plane"),
        ("ribbon", Self::Ribbon, "shed in long strips down to pale skin, as blue gum"),
        ("culm", Self::Culm, "smooth with fine lines along it, as bamboo"),
        ("palm", Self::Palm, "bases of shed leaves in overlapping rows, as date palm"),
    ];

    /// The style that a user means.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.iter().find(|(n, _, _)| *n == name).map(|&(_, style, _)| style)
    }
}

/// What bark to draw.
///
/// ```
/// use linden_base::{monitor::Quiet, random::Key};
/// use linden_plant::texture::{Bark, BarkStyle};
/// let bark = Bark { size_px: 64, ..Bark::new(BarkStyle::Plated, Key::new(7).named("bark")) };
/// let pictures = bark.draw(&Quiet).unwrap();
/// assert_eq!(pictures.base_color.rgba().len(), 64 * 64 * 4);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bark {
    /// The kind of bark.
    pub style: BarkStyle,
    /// The picture's mean colour, sRGB.
    pub color: [u8; 3],
    /// How strong the grain is: 0 polished, 1 usual, up to 3.
    pub roughness: f32,
    /// How many lenticels lie across it beside those of its style: 0 none, 1 in dense rows, as cherry.
    pub lenticels: f32,
    /// From the deepest furrow to the highest ridge, as a share of the picture's side; 0 to 0.5.
    pub relief: f32,
    /// The picture's side, pixels: 1 to [`Bark::MAX_SIZE_PX`].
    pub size_px: u32,
    /// Where its randomness comes from.
    pub key: Key,
}

/// A bark's pictures. Both continue across their edges; those that are drawn are square. U runs round the
/// girth and V up the branch: the first row is the upper end.
#[derive(Clone, Debug, PartialEq)]
pub struct BarkPictures {
    /// sRGB, opaque.
    pub base_color: Arc<Picture>,
    /// Tangent-space normals; OpenGL convention, green points up.
    pub normal: Arc<Picture>,
}

/// Why there is no picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum BarkError {
    /// The size is 0 or too large.
    #[error("a bark picture of {0}×{0} pixels cannot be drawn: choose 1 to {max}", max = Bark::MAX_SIZE_PX)]
    Size(u32),
    /// It would take more memory than there may be.
    #[error(transparent)]
    Memory(#[from] OverMemory),
    /// Nobody wants the picture any more.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

impl Bark {
    /// The largest side, pixels.
    pub const MAX_SIZE_PX: u32 = 4096;

    /// The usual bark of a style, 512 pixels.
    pub const fn new(style: BarkStyle, key: Key) -> Self {
        let (color, relief) = match style {
            BarkStyle::Ridged => ([112, 98, 84], 0.045),
            BarkStyle::Smooth => ([148, 146, 136], 0.006),
            BarkStyle::Plated => ([140, 100, 76], 0.032),
            BarkStyle::Birch => ([212, 208, 198], 0.008),
            BarkStyle::Peeling => ([158, 150, 122], 0.004),
            BarkStyle::Ribbon => ([176, 166, 148], 0.008),
            BarkStyle::Culm => ([127, 148, 64], 0.002),
            BarkStyle::Palm => ([134, 116, 94], 0.055),
        };
        Self { style, color, roughness: 1.0, lenticels: 0.0, relief, size_px: 512, key }
    }

    /// Draws both pictures.
    ///
    /// # Errors
    /// [`BarkError::Size`], or [`BarkError::Cancelled`] soon after the monitor is.
    pub fn draw(&self, monitor: &dyn Monitor) -> Result<BarkPictures, BarkError> {
        let size = self.size_px;
        if !(1..=Self::MAX_SIZE_PX).contains(&size) {
            return Err(BarkError::Size(size));
        }
        let n = size as usize;
        // What is drawn, and two pictures of four bytes a pixel.
        let bytes = bytes_of::<(Spot, [u8; 8])>(n * n);
        monitor.admit("drawing the bark", bytes, "lower bark_size")?;
        let roughness = if self.roughness.is_finite() { self.roughness.clamp(0.0, 3.0) } else { 1.0 };
        let surface = Surface::new(self.style, roughness, self.key).fine(size, self.key);
        let lenticels = Lenticels::new(self);
        let mut spots = vec![Spot::default(); n * n];
        spots.par_chunks_mut(n).enumerate().try_for_each(|(row, spots)| {
            monitor.check()?;
            let v = 1.0 - (row as f32 + 0.5) / size as f32;
            surface.row(v, spots);
            if let Some(lenticels) = &lenticels {
                lenticels.row(v, spots);
            }
            Ok::<_, Cancelled>(())
        })?;
        even(&mut spots, n);
        let relief = if self.relief.is_finite() { self.relief.clamp(0.0, 0.5) } else { 0.0 };
        let base_color = colors(&spots, n, self.color);
        monitor.check()?;
        let normal = normals(|row, column| spots[row * n + column].height, (n, n), relief);
        let picture = |rgba| Arc::new(Picture::new(size, size, rgba));
        Ok(BarkPictures { base_color: picture(base_color), normal: picture(normal) })
    }
}

impl Bark {
    /// How high the drawn bark is, in `side` rows of as many values, V up: 0 to 1, about.
    pub fn heights(&self, side: usize) -> Vec<f32> {
        let roughness = if self.roughness.is_finite() { self.roughness.clamp(0.0, 3.0) } else { 1.0 };
        let surface = Surface::new(self.style, roughness, self.key);
        let row = |row: usize| {
            let mut spots = vec![Spot::default(); side];
            surface.row((row as f32 + 0.5) / side as f32, &mut spots);
            spots.into_iter().map(|spot| spot.height).collect::<Vec<_>>()
        };
        (0..side).into_par_iter().flat_map_iter(row).collect()
    }
}

/// sRGB pixels whose mean, in linear light, is the colour asked for.
fn colors(spots: &[Spot], n: usize, color: [u8; 3]) -> Vec<u8> {
    let wanted = Vec3::from(linear(color));
    // Summed row by row in their order: the same bits whatever the threads do.
    let mean = |gain: Vec3| -> Vec3 {
        let rows: Vec<Vec3> = spots
            .par_chunks(n)
            .map(|row| {
                row.iter().map(|s| (s.tint * gain).clamp(Vec3::ZERO, Vec3::ONE)).sum::<Vec3>() / n as f32
            })
            .collect();
        rows.iter().sum::<Vec3>() / rows.len() as f32
    };
    let mut gain = wanted;
    // Bright colours are cut off at white, which lowers the mean: some rounds of correction.
    for _ in 0..4 {
        let found = mean(gain);
        gain *= wanted / found.max(Vec3::splat(1e-6));
    }
    let curve: Vec<u8> = (0..=CURVE_STEPS).map(|i| code(i as f32 / CURVE_STEPS as f32)).collect();
    let byte = |c: f32| curve[(c.clamp(0.0, 1.0) * CURVE_STEPS as f32 + 0.5) as usize];
    let mut rgba = vec![255; spots.len() * 4];
    rgba.par_chunks_mut(4 * n).zip(spots.par_chunks(n)).for_each(|(pixels, spots)| {
        for (pixel, spot) in pixels.as_chunks_mut::<4>().0.iter_mut().zip(spots) {
            let [r, g, b] = (spot.tint * gain).to_array().map(byte);
            *pixel = [r, g, b, 255];
        }
    });
    rgba
}

/// Steps of the table from light to code value: fine enough that the darkest codes are all reached.
const CURVE_STEPS: usize = 16_384;

/// Tangent-space normals by central differences across the edges, `width` × `height` pixels. Heights, by
/// row and column, are shares of the relief, which is a share of the width.
fn normals(
    heights: impl Fn(usize, usize) -> f32 + Sync,
    (width, height): (usize, usize),
    relief: f32,
) -> Vec<u8> {
    // The pixel's size cancels.
    let per_step = relief * width as f32 / 2.0;
    let mut rgba = vec![255; width * height * 4];
    rgba.par_chunks_mut(4 * width).enumerate().for_each(|(row, pixels)| {
        for (column, pixel) in pixels.as_chunks_mut::<4>().0.iter_mut().enumerate() {
            let right = heights(row, (column + 1) % width) - heights(row, (column + width - 1) % width);
            let up = heights((row + height - 1) % height, column) - heights((row + 1) % height, column);
            let normal = Vec3::new(-right * per_step, -up * per_step, 1.0).normalize();
            let [x, y, z] = normal.to_array().map(|c| (c * 127.5 + 128.0) as u8);
            *pixel = [x, y, z, 255];
        }
    });
    rgba
}

/// The value below which a share of all lies.
fn quantile(values: &[f32], share: f32) -> f32 {
    let mut sorted = values.to_vec();
    let at = ((share * values.len() as f32) as usize).min(values.len().saturating_sub(1));
    if sorted.is_empty() {
        return 0.0;
    }
    *sorted.select_nth_unstable_by(at, f32::total_cmp).1
}

#[cfg(test)]
mod tests;
