//! Figures → an atlas: where each goes, the pixels, and what is around them.

use std::sync::Arc;

use glam::{Affine2, Mat2, Vec2, Vec3};
use rayon::prelude::*;

use super::field::Window;
use super::figure::Figure;
use super::mip::{cutout, keep_coverage};
use super::paint::{Grain, Placed, Spot, rows};
use super::{Cell, LeafError, LeafPictures};
use linden_base::color::code;
use linden_base::memory::bytes_of;
use linden_base::monitor::{Cancelled, Monitor};
use linden_base::picture::Picture;
use linden_base::random::Key;

/// Rows that are drawn at once.
const BAND: usize = 64;
/// Room around each figure, as a share of its cell: what keeps smaller copies of the picture from
/// mixing neighbours.
const ROOM: f32 = 0.03;
/// The least room, pixels, where cells are large enough for it.
const LEAST_ROOM_PX: f32 = 3.0;
/// Steps of the table from light to code value.
const CURVE_STEPS: usize = 16_384;

/// Draws figures side by side on a square of `size` pixels.
pub(super) fn draw(
    figures: &[Figure],
    size: u32,
    key: Key,
    monitor: &dyn Monitor,
) -> Result<LeafPictures, LeafError> {
    let n = size as usize;
    // While it is made, its smaller copies, and two pictures of four bytes a pixel.
    let bytes = bytes_of::<Spot>(n * n) + bytes_of::<Spot>(n * n) / 3 + bytes_of::<[u8; 8]>(n * n);
    // Figures grew one by one.
    let figured = figures.iter().map(Figure::bytes).sum::<u64>() * 3 / 2;
    monitor.admit("drawing leaves", bytes + figured, "lower leaf_size or twig_leaves")?;
    let grid = Grid::new(figures, size);
    let placed: Vec<Placed<'_>> =
        figures.iter().enumerate().map(|(i, figure)| grid.place(figure, i)).collect();
    let grain = Grain::new(key.named("grain"));
    let mut spots = vec![Spot::default(); n * n];
    spots.par_chunks_mut(n * BAND).enumerate().try_for_each(|(band, spots)| {
        let from = band * BAND;
        let band_rows = from..from + spots.len() / n;
        placed.iter().try_for_each(|placed| rows(placed, &grain, n, &band_rows, spots, monitor))
    })?;
    let cells = placed.iter().map(|placed| grid.cell(placed, &spots)).collect();
    bleed(&mut spots, n, monitor)?;
    keep_coverage(&mut spots, n);
    let curve: Vec<u8> = (0..=CURVE_STEPS).map(|i| code(i as f32 / CURVE_STEPS as f32)).collect();
    let (mut colors, mut normals) = (vec![0; n * n * 4], vec![255; n * n * 4]);
    colors.par_chunks_mut(4 * n).zip(normals.par_chunks_mut(4 * n)).zip(spots.par_chunks(n)).for_each(
        |((colors, normals), spots)| {
            let pixels = colors.as_chunks_mut::<4>().0.iter_mut().zip(normals.as_chunks_mut::<4>().0);
            for ((color, normal), spot) in pixels.zip(spots) {
                let byte = |c: f32| curve[(c.clamp(0.0, 1.0) * CURVE_STEPS as f32 + 0.5) as usize];
                let [r, g, b] = spot.color.to_array().map(byte);
                *color = [r, g, b, (spot.alpha.clamp(0.0, 1.0) * 255.0 + 0.5) as u8];
                let [x, y, z] =
                    spot.slope.extend(1.0).normalize().to_array().map(|c| (c * 127.5 + 128.0) as u8);
                *normal = [x, y, z, 255];
            }
        },
    );
    let picture = |rgba| Arc::new(Picture::new(size, size, rgba));
    let base_color = picture(colors);
    let cutout = cutout(&base_color);
    Ok(LeafPictures { cutout, base_color, normal: picture(normals), cells, backs: Vec::new() })
}

/// Where figures go: columns and rows of equal cells, all figures in the same scale and held at the
/// same place of their cells.
struct Grid {
    size: f32,
    columns: usize,
    /// Pixels.
    cell: Vec2,
    /// Pixels to one unit of the figures.
    scale: f32,
    /// Where the figures' origin is, pixels from a cell's upper left corner.
    origin: Vec2,
}

impl Grid {
    /// As many columns as make the figures largest.
    fn new(figures: &[Figure], size: u32) -> Self {
        let size = size as f32;
        let (min, max) = figures
            .iter()
            .map(Figure::bounds)
            .reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)))
            .unwrap_or((Vec2::ZERO, Vec2::ONE));
        let extent = (max - min).max(Vec2::splat(1e-3));
        let with = |columns: usize| {
            let rows = figures.len().div_ceil(columns).max(1);
            let cell = Vec2::new(size / columns as f32, size / rows as f32);
            let room = (cell * ROOM).max(Vec2::splat(LEAST_ROOM_PX)).min(cell / 4.0);
            let scale = ((cell - 2.0 * room) / extent).min_element();
            let origin =
                cell / 2.0 + Vec2::new(-f32::midpoint(min.x, max.x), f32::midpoint(min.y, max.y)) * scale;
            Self { size, columns, cell, scale, origin }
        };
        (2..=figures.len())
            .map(with)
            .fold(with(1), |best, tried| if tried.scale > best.scale { tried } else { best })
    }

    fn place<'a>(&self, figure: &'a Figure, index: usize) -> Placed<'a> {
        let corner = Vec2::new((index % self.columns) as f32, (index / self.columns) as f32) * self.cell;
        let end = corner + self.cell;
        let range = |from: f32, to: f32| (from + 0.5) as usize..(to + 0.5) as usize;
        Placed {
            figure,
            to_pixels: Affine2::from_mat2_translation(
                Mat2::from_cols(Vec2::new(self.scale, 0.0), Vec2::new(0.0, -self.scale)),
                corner + self.origin,
            ),
            window: Window { columns: range(corner.x, end.x), rows: range(corner.y, end.y) },
        }
    }

    fn cell(&self, placed: &Placed<'_>, spots: &[Spot]) -> Cell {
        let uv = |p: Vec2| {
            let pixel = placed.to_pixels.transform_point2(p) / self.size;
            Vec2::new(pixel.x, 1.0 - pixel.y)
        };
        // One pixel more on all sides: the edge's own softness.
        let soft = Vec2::splat(1.0 / self.size);
        let (low, high) = placed.figure.bounds();
        let (min, max) = (uv(low) - soft, uv(high) + soft);
        Cell {
            min: min.max(Vec2::ZERO),
            max: max.min(Vec2::ONE),
            attach: uv(Vec2::ZERO),
            unit: Vec2::splat(self.scale / self.size),
            outline: octagon(placed.figure.points().map(uv), min.max(Vec2::ZERO), max.min(Vec2::ONE), soft.x),
            color: mean_color(placed, self.size as usize, spots),
            stalk: uv(placed.figure.stalk.unwrap_or(Vec2::new(0.0, 0.005))),
        }
    }
}

/// The box around points with its corners cut off as far as the points allow; counter-clockwise.
fn octagon(points: impl Iterator<Item = Vec2>, min: Vec2, max: Vec2, soft: f32) -> Vec<Vec2> {
    const DIAGONALS: [Vec2; 4] = [Vec2::new(1.0, -1.0), Vec2::ONE, Vec2::new(-1.0, 1.0), Vec2::NEG_ONE];
    let mut most = [f32::NEG_INFINITY; 4];
    for p in points {
        for (most, diagonal) in most.iter_mut().zip(DIAGONALS) {
            *most = most.max(p.dot(diagonal));
        }
    }
    let mut outline = vec![min, Vec2::new(max.x, min.y), max, Vec2::new(min.x, max.y)];
    for (diagonal, most) in DIAGONALS.into_iter().zip(most) {
        let beyond = |p: Vec2| p.dot(diagonal) - most - 2.0 * soft;
        let last = outline.last().copied();
        let mut cut = Vec::with_capacity(outline.len() + 1);
        for (&from, &to) in last.iter().chain(&outline).zip(&outline) {
            let (a, b) = (beyond(from), beyond(to));
            if (a > 0.0) != (b > 0.0) {
                cut.push(from.lerp(to, a / (a - b)));
            }
            if b <= 0.0 {
                cut.push(to);
            }
        }
        outline = cut;
    }
    outline
}

/// sRGB.
fn mean_color(placed: &Placed<'_>, n: usize, spots: &[Spot]) -> [u8; 3] {
    let Window { columns, rows } = &placed.window;
    let (mut color, mut alpha) = (Vec3::ZERO, 0.0);
    for row in rows.start..rows.end.min(n) {
        let line = &spots[row * n + columns.start..row * n + columns.end.min(n)];
        // Row by row: sums of many small numbers stay exact enough.
        color += line.iter().map(|spot| spot.color).sum::<Vec3>();
        alpha += line.iter().map(|spot| spot.alpha).sum::<f32>();
    }
    (color / alpha.max(1e-6)).to_array().map(code)
}

/// Divides colours and slopes by alpha, and gives pixels without any those of what is near: the mean
/// of the smallest square of a power of two pixels around them in which something is drawn.
fn bleed(spots: &mut [Spot], n: usize, monitor: &dyn Monitor) -> Result<(), Cancelled> {
    let mut levels: Vec<(usize, Vec<Spot>)> = Vec::new();
    let mut side = n;
    while side > 1 {
        monitor.check()?;
        let from: &[Spot] = levels.last().map_or(&*spots, |(_, level)| level);
        let half = side.div_ceil(2);
        let mut level = vec![Spot::default(); half * half];
        level.par_chunks_mut(half).enumerate().for_each(|(row, out)| {
            let rows = 2 * row..(2 * row + 2).min(side);
            for line in rows.map(|row| &from[row * side..][..side]) {
                for (out, pair) in out.iter_mut().zip(line.chunks(2)) {
                    for spot in pair {
                        out.color += spot.color;
                        out.slope += spot.slope;
                        out.alpha += spot.alpha;
                    }
                }
            }
        });
        levels.push((half, level));
        side = half;
    }
    // From the smallest copy: what has nothing takes it from the one below.
    let mut below: Option<(usize, Vec<Spot>)> = None;
    while let Some((side, mut level)) = levels.pop() {
        monitor.check()?;
        fill(&mut level, side, below.as_ref());
        below = Some((side, level));
    }
    fill(spots, n, below.as_ref());
    Ok(())
}

fn fill(level: &mut [Spot], side: usize, below: Option<&(usize, Vec<Spot>)>) {
    level.par_chunks_mut(side).enumerate().for_each(|(row, line)| {
        for (column, spot) in line.iter_mut().enumerate() {
            if spot.alpha > 1e-4 {
                (spot.color, spot.slope) = (spot.color / spot.alpha, spot.slope / spot.alpha);
            } else if let Some((half, below)) = below {
                let near = &below[row / 2 * half + column / 2];
                (spot.color, spot.slope) = (near.color, near.slope);
            }
        }
    });
}
