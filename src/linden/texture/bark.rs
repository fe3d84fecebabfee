//! Bark: a height field, its colours and its normals.
//!
//! The height is composed of cells (plates, or ridges where cells are elongated), bent by slow noise,
//! and grain. Colour follows it: furrows are dark, what sticks out is weathered, and lichen sits
//! where light and rain come.

use std::sync::Arc;

use glam::Vec3;
use rayon::prelude::*;

use super::periodic::{Cells, Noise, Octaves, smoothstep};
use crate::color::{encode, linear};
use crate::memory::{OverMemory, bytes_of};
use crate::monitor::{Cancelled, Monitor};
use crate::picture::Picture;
use crate::random::Key;

/// What kind of bark.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum BarkStyle {
    /// Long ridges that part and meet: oak, ash, lime.
    #[default]
    Ridged,
    /// Thin and whole, with lenticels and blotches: beech, hornbeam.
    Smooth,
    /// Flaking plates between narrow fissures: pine, larch.
    Plated,
}

impl BarkStyle {
    /// Every style: its name for users, what it looks like, and its usual bark.
    pub const ALL: [(&'static str, Self, &'static str); 3] = [
        ("ridged", Self::Ridged, "long ridges that part and meet, as oak and ash"),
        ("smooth", Self::Smooth, "thin and whole with lenticels, as beech"),
        ("plated", Self::Plated, "flaking plates between fissures, as pine"),
    ];

    /// The style that a user means.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.iter().find(|(n, _, _)| *n == name).map(|&(_, style, _)| style)
    }
}

/// What bark to draw.
///
/// ```
/// use linden::texture::{Bark, BarkStyle};
/// use linden::{Quiet, random::Key};
/// let bark = Bark { size_px: 64, ..Bark::new(BarkStyle::Plated, Key::new(7).named("bark")) };
/// let pictures = bark.draw(&Quiet).unwrap();
/// assert_eq!(pictures.base_color.rgba().len(), 64 * 64 * 4);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bark {
    /// What kind.
    pub style: BarkStyle,
    /// The picture's mean colour, sRGB.
    pub color: [u8; 3],
    /// How strong the grain is: 0 polished, 1 usual, up to 3.
    pub roughness: f32,
    /// From the deepest furrow to the highest ridge, as a share of the picture's side; 0 to 0.5.
    pub relief: f32,
    /// The picture's side, pixels: 1 to [`Bark::MAX_SIZE_PX`].
    pub size_px: u32,
    /// Where its randomness comes from.
    pub key: Key,
}

/// A bark's pictures. Both are square and continue across their edges. U runs round the girth and
/// V up the branch: the first row is the upper end.
#[derive(Clone, Debug, PartialEq)]
pub struct BarkPictures {
    /// sRGB, opaque.
    pub base_color: Arc<Picture>,
    /// Tangent-space normals; OpenGL convention, green points up.
    pub normal: Arc<Picture>,
}

/// Why there is no picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
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
            BarkStyle::Plated => ([136, 98, 74], 0.035),
        };
        Self { style, color, roughness: 1.0, relief, size_px: 512, key }
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
        let surface = Surface::new(self.style, roughness, self.key);
        let mut spots = vec![Spot::default(); n * n];
        spots.par_chunks_mut(n).enumerate().try_for_each(|(row, spots)| {
            monitor.check()?;
            surface.row(1.0 - (row as f32 + 0.5) / size as f32, spots);
            Ok::<_, Cancelled>(())
        })?;
        let relief = if self.relief.is_finite() { self.relief.clamp(0.0, 0.5) } else { 0.0 };
        let base_color = colors(&spots, n, self.color);
        monitor.check()?;
        let normal = normals(&spots, n, relief);
        let picture = |rgba| Arc::new(Picture::new(size, size, rgba));
        Ok(BarkPictures { base_color: picture(base_color), normal: picture(normal) })
    }
}

/// One place of the bark.
#[derive(Clone, Copy, Debug, Default)]
struct Spot {
    /// 0 the deepest, 1 the highest, about.
    height: f32,
    /// Linear light, relative to the bark's colour.
    tint: Vec3,
}

/// Yellow-green grey, relative to grey bark: crustose lichen.
const LICHEN: Vec3 = Vec3::new(1.12, 1.25, 0.98);

/// The noises at a place, -1..1.
#[derive(Clone, Copy, Debug)]
struct Noises {
    /// Bends what stands there round the girth.
    sway: f32,
    /// Bends it along the branch.
    lift: f32,
    grain: f32,
    blotch: f32,
}

/// All that a style's height and colour are made of.
struct Surface {
    style: BarkStyle,
    roughness: f32,
    bend: [Octaves; 2],
    cells: Cells,
    cracks: Cells,
    grain: Octaves,
    blotches: Octaves,
    fibres: Noise,
    /// A number 0..1 for each cell, and for each crack cell.
    character: [Vec<f32>; 2],
}

impl Surface {
    fn new(style: BarkStyle, roughness: f32, key: Key) -> Self {
        // Lattices are across × up the branch. Ridges are some five times longer than wide,
        // lenticels and the wrinkles of smooth bark lie across the branch.
        let ((cells, cracks), grain, bend, fibres) = match style {
            BarkStyle::Ridged => (((10, 3), (12, 15)), (26, 9), (4, 3), (110, 9)),
            BarkStyle::Plated => (((6, 4), (10, 9)), (18, 18), (4, 4), (14, 70)),
            BarkStyle::Smooth => (((9, 22), (4, 3)), (14, 20), (3, 4), (7, 56)),
        };
        let named = |purpose: &str| key.named(purpose);
        let grid = |(across, up): (u32, u32), purpose: &str| Cells::new(across, up, 0.85, named(purpose));
        let (cells, cracks) = (grid(cells, "cells"), grid(cracks, "cracks"));
        let each = |cells: &Cells, purpose: &str| -> Vec<f32> {
            (0..cells.len() as u64).map(|i| named(purpose).child(i).unit() as f32).collect()
        };
        let character = [each(&cells, "cell"), each(&cracks, "crack")];
        Self {
            style,
            roughness,
            bend: ["bend u", "bend v"].map(|purpose| Octaves::new(bend.0, bend.1, 3, named(purpose))),
            cells,
            cracks,
            grain: Octaves::new(grain.0, grain.1, 4, named("grain")),
            blotches: Octaves::new(4, 4, 4, named("blotches")),
            fibres: Noise::new(fibres.0, fibres.1, named("fibres")),
            character,
        }
    }

    /// A row across the branch.
    fn row(&self, v: f32, spots: &mut [Spot]) {
        let n = spots.len();
        let [sway, lift] = [0, 1].map(|i| self.bend[i].row(v, n));
        let (grain, blotch) = (self.grain.row(v, n), self.blotches.row(v, n));
        let draw = match self.style {
            BarkStyle::Ridged => Self::ridged,
            BarkStyle::Plated => Self::plated,
            BarkStyle::Smooth => Self::smooth,
        };
        for (i, spot) in spots.iter_mut().enumerate() {
            let u = (i as f32 + 0.5) / n as f32;
            let noises = Noises { sway: sway[i], lift: lift[i], grain: grain[i], blotch: blotch[i] };
            *spot = draw(self, u, v, noises);
        }
    }

    fn ridged(&self, u: f32, v: f32, noises: Noises) -> Spot {
        let Noises { sway, lift, grain, blotch } = noises;
        // The furrows' edges are ragged: the grain bends them too.
        let (bu, bv) = (u + 0.05 * sway + 0.012 * grain, v + 0.08 * lift);
        let ridge = self.cells.at(bu, bv);
        let own = self.character[0][ridge.index];
        let away = (ridge.border / (0.030 + 0.016 * own)).min(1.0);
        let body = 1.0 - (1.0 - away) * (1.0 - away);
        // Short cracks run across the ridges; most end before the furrow.
        let fibre = self.fibres.at(bu, v);
        let strength = smoothstep(-0.15, 0.5, lift - blotch + 0.35 * fibre);
        let depth = if strength > 0.0 {
            let crack = self.cracks.at(bu + 0.01 * grain, v + 0.05 * sway + 0.008 * grain);
            0.26 * strength * (1.0 - smoothstep(0.0, 0.012, crack.border))
        } else {
            0.0
        };
        let rough = self.roughness * (0.17 * grain + 0.085 * fibre);
        let height = body * (0.70 + 0.22 * own - depth) + rough * (0.3 + 0.7 * body);
        let dark = 0.17 + 0.83 * smoothstep(-0.08, 0.80, height);
        let weathered = Vec3::new(1.0, 0.99, 0.97).lerp(Vec3::new(1.10, 1.10, 1.10), height.clamp(0.0, 1.0));
        // Deep furrows show the inner bark: redder.
        let inner = Vec3::new(1.14, 0.97, 0.84).lerp(Vec3::ONE, smoothstep(0.1, 0.65, height));
        let tint = weathered * inner * dark * (0.94 + 0.14 * own + 1.0 * rough + 0.10 * blotch);
        let lichen = 0.5 * smoothstep(0.08, 0.40, blotch + 0.25 * grain) * smoothstep(0.45, 0.85, height);
        Spot { height, tint: tint.lerp(LICHEN * tint.max_element(), lichen) }
    }

    fn plated(&self, u: f32, v: f32, noises: Noises) -> Spot {
        let Noises { sway, lift, grain, blotch } = noises;
        let (bu, bv) = (u + 0.07 * sway + 0.010 * grain, v + 0.08 * lift + 0.010 * grain);
        let plate = self.cells.at(bu, bv);
        let own = self.character[0][plate.index];
        let body = smoothstep(0.001, 0.016 + 0.016 * own, plate.border);
        // A plate is a stack of thin scales, torn off to different depths along ragged lines.
        let scale = self.cracks.at(u + 0.09 * lift + 0.035 * grain, v + 0.07 * sway + 0.03 * grain);
        let layer = self.character[1][scale.index];
        // What is deeper than its neighbour lies in its shade along the common edge.
        let edge = 1.0 - smoothstep(0.0, 0.016, scale.border);
        let depth = (1.0 - layer) * edge;
        let stack =
            0.34 * layer * smoothstep(0.0, 0.012, scale.border) + 0.07 * scale.offset[1] * (own - 0.3);
        let rough = self.roughness * (0.12 * grain + 0.05 * self.fibres.at(u + 0.05 * lift, bv));
        // Plates bulge towards their middle.
        let bulge = 0.18 * (plate.border / 0.08).min(1.0);
        let height = body * (0.42 + 0.12 * own + bulge + stack) + rough * (0.4 + 0.6 * body);
        let dark = 0.13 + 0.87 * smoothstep(-0.02, 0.66, height);
        // Freshly torn scales are orange, old ones grey with a breath of violet.
        let (fresh, old) = (Vec3::new(1.26, 0.97, 0.74), Vec3::new(0.96, 0.99, 1.06));
        let age = (1.1 * layer + 0.8 * blotch + 0.5 * (own - 0.5) + 0.05).clamp(0.0, 1.0);
        let tint =
            fresh.lerp(old, age) * dark * (0.88 + 0.16 * own + 1.5 * rough - 0.14 * depth + 0.12 * layer);
        let lichen = 0.22 * smoothstep(0.15, 0.45, sway - blotch) * smoothstep(0.5, 0.9, height);
        Spot { height, tint: tint.lerp(LICHEN * tint.max_element(), lichen) }
    }

    fn smooth(&self, u: f32, v: f32, noises: Noises) -> Spot {
        let Noises { sway, lift, grain, blotch } = noises;
        let (bu, bv) = (u + 0.03 * sway, v + 0.02 * lift);
        // Lenticels: corky lips across the branch, on some of the places.
        let place = self.cells.at(bu, bv);
        let own = self.character[0][place.index];
        let wide = 0.18 + 0.30 * own;
        let [x, y] = [place.offset[0] / wide, place.offset[1] / (0.10 + 0.08 * own)];
        let inside = (1.0 - x * x - y * y).max(0.0);
        let lenticel = if own > 0.62 { inside } else { 0.0 };
        let wrinkle = self.fibres.at(bu, bv + 0.012 * sway);
        let wrinkles = smoothstep(0.25, 0.95, wrinkle.abs()) * (0.5 + 0.5 * lift);
        let grain = self.roughness * 0.09 * grain;
        let height = 0.5 + 0.30 * sway + 0.35 * lenticel - 0.10 * wrinkles + grain;
        let slit = if own > 0.62 && inside > 0.5 { 1.0 - (y * y / 0.12).min(1.0) } else { 0.0 };
        // Pale crusts with an edge, green algae without one.
        let crust = 0.20 * smoothstep(0.10, 0.20, blotch) + 0.12 * smoothstep(0.28, 0.34, blotch);
        let algae = 0.26 * smoothstep(-0.05, 0.45, lift - blotch);
        let light =
            0.90 + crust + 0.12 * sway - 0.13 * wrinkles - 0.22 * lenticel - 0.35 * slit + 1.4 * grain;
        let tint = Vec3::splat(light).lerp(Vec3::new(0.92, 1.02, 0.80) * light, algae);
        Spot { height, tint }
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
    let curve: Vec<u8> =
        (0..=CURVE_STEPS).map(|i| (encode(i as f32 / CURVE_STEPS as f32) * 255.0 + 0.5) as u8).collect();
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

/// Tangent-space normals by central differences across the edges.
fn normals(spots: &[Spot], n: usize, relief: f32) -> Vec<u8> {
    // Heights are shares of the relief, which is a share of the side: both cancel the pixel's size.
    let per_step = relief * n as f32 / 2.0;
    let mut rgba = vec![255; spots.len() * 4];
    rgba.par_chunks_mut(4 * n).enumerate().for_each(|(row, pixels)| {
        let height = |row: usize, column: usize| spots[row * n + column].height;
        for (column, pixel) in pixels.as_chunks_mut::<4>().0.iter_mut().enumerate() {
            let right = height(row, (column + 1) % n) - height(row, (column + n - 1) % n);
            let up = height((row + n - 1) % n, column) - height((row + 1) % n, column);
            let normal = Vec3::new(-right * per_step, -up * per_step, 1.0).normalize();
            let [x, y, z] = normal.to_array().map(|c| (c * 127.5 + 128.0) as u8);
            *pixel = [x, y, z, 255];
        }
    });
    rgba
}

#[cfg(test)]
#[path = "bark_tests.rs"]
mod tests;
