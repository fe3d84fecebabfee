//! Pieces → pixels: colour, alpha and normals of some rows of the picture.
//!
//! Each pixel is made from the figure alone: rows can be drawn in any pieces and on any number of
//! threads, and come out the same.

use std::ops::Range;

use glam::{Affine2, Vec2, Vec3};

use super::coverage::coverage;
use super::field::Window;
use super::figure::{Figure, Piece, Skin};
use super::mip::Cutout;
use crate::texture::periodic::{Noise, smoothstep};
use linden_base::monitor::{Cancelled, Monitor};
use linden_base::random::Key;

/// A pixel while it is made; all but alpha are multiplied by alpha.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Spot {
    /// Linear light.
    pub color: Vec3,
    /// The normal's slopes, to the right and up.
    pub slope: Vec2,
    pub alpha: f32,
}

impl Cutout for Spot {
    fn alpha(&self) -> f32 {
        self.alpha
    }

    fn set_alpha(&mut self, alpha: f32) {
        self.alpha = alpha;
    }
}

/// The noises that all pieces share, each piece at its own place.
pub(super) struct Grain {
    slow: Noise,
    fine: Noise,
}

impl Grain {
    pub fn new(key: Key) -> Self {
        Self { slow: Noise::new(16, 16, key.named("slow")), fine: Noise::new(96, 96, key.named("fine")) }
    }
}

/// A figure and where it is drawn.
pub(super) struct Placed<'a> {
    pub figure: &'a Figure,
    /// From the figure's units to pixels, Y down.
    pub to_pixels: Affine2,
    /// The part of the picture that it may draw on.
    pub window: Window,
}

/// Draws some rows of the picture. `spots` has `width` for each row.
pub(super) fn rows(
    placed: &Placed<'_>,
    grain: &Grain,
    width: usize,
    rows: &Range<usize>,
    spots: &mut [Spot],
    monitor: &dyn Monitor,
) -> Result<(), Cancelled> {
    let whole = &placed.window;
    let shared = rows.start.max(whole.rows.start)..rows.end.min(whole.rows.end);
    if shared.is_empty() {
        return Ok(());
    }
    let window = Window { columns: whole.columns.clone(), rows: shared };
    for piece in &placed.figure.pieces {
        monitor.check()?;
        let Some(sheet) = Sheet::of(piece, &placed.to_pixels, &window) else { continue };
        sheet.lay(piece, &placed.to_pixels, grain, width, rows.start, spots);
    }
    Ok(())
}

/// How far a piece darkens what is under it: in its breadths, and in lengths of the figure at most.
const SHADOW_REACH: [f32; 2] = [0.5, 0.02];
/// How far blades bulge between ribs, in their breadths. The broadest have more ribs instead.
const RIB_REACH: f32 = 0.12;
/// What counts as the broadest, in lengths of the figure.
const BROADEST: f32 = 0.6;

/// What is known of a piece's pixels before they are coloured: its window is one pixel larger on all
/// sides than what is drawn, for the slopes.
struct Sheet {
    /// What is drawn.
    inner: Window,
    window: Window,
    covered: Vec<f32>,
    /// Pixels to the edge; `reach` where that is further.
    edge: Vec<f32>,
    /// Pixels to the nearest rib; `rib_reach` where that is further.
    rib: Vec<f32>,
    rib_reach: f32,
    /// How much of the pixel is vein.
    vein: Vec<f32>,
    shadow_reach: f32,
}

impl Sheet {
    fn of(piece: &Piece, to_pixels: &Affine2, window: &Window) -> Option<Self> {
        let scale = to_pixels.matrix2.x_axis.length();
        let bevel = piece.skin.bevel * scale;
        let shadow_reach = if piece.skin.shadow > 0.0 {
            ((SHADOW_REACH[0] * piece.breadth).min(SHADOW_REACH[1]) * scale).max(1.0)
        } else {
            0.0
        };
        let reach = bevel.max(shadow_reach).max(2.0);
        let outline: Vec<Vec2> = piece.outline.iter().map(|&p| to_pixels.transform_point2(p)).collect();
        let (min, max) = outline
            .iter()
            .fold((Vec2::splat(f32::INFINITY), Vec2::splat(f32::NEG_INFINITY)), |(min, max), &p| {
                (min.min(p), max.max(p))
            });
        let inner = window.near(min, max, reach)?;
        let window = Window {
            columns: inner.columns.start.saturating_sub(1)..inner.columns.end + 1,
            rows: inner.rows.start.saturating_sub(1)..inner.rows.end + 1,
        };
        let shifted: Vec<Vec2> =
            outline.iter().map(|&p| p - Vec2::new(window.columns.start as f32, 0.0)).collect();
        let covered = coverage(&shifted, window.columns.len(), window.rows.clone());
        let mut edge = vec![reach; window.len()];
        let last = outline.last().copied();
        for (from, &to) in last.iter().chain(&outline).zip(&outline) {
            window.along(*from, to, reach, |i, distance, _| edge[i] = edge[i].min(distance));
        }
        let rib_reach = (RIB_REACH * piece.breadth.min(BROADEST) * scale).max(2.0);
        let mut sheet =
            Self { inner, rib: Vec::new(), rib_reach, vein: Vec::new(), covered, edge, shadow_reach, window };
        sheet.veins(piece, to_pixels, scale);
        Some(sheet)
    }

    fn veins(&mut self, piece: &Piece, to_pixels: &Affine2, scale: f32) {
        let Self { window, rib, vein: strength, rib_reach, .. } = self;
        if piece.veins.is_empty() {
            return;
        }
        *rib = vec![*rib_reach; window.len()];
        *strength = vec![0.0; window.len()];
        for vein in &piece.veins {
            let count = (vein.points.len().max(2) - 1) as f32;
            for (i, pair) in vein.points.windows(2).enumerate() {
                let [a, b] = [pair[0], pair[1]].map(|p| to_pixels.transform_point2(p));
                let radius_at =
                    |share: f32| scale * (vein.radius[0] + (vein.radius[1] - vein.radius[0]) * share / count);
                let [from, to] = [radius_at(i as f32), radius_at(i as f32 + 1.0)];
                let reach = if vein.is_rib { *rib_reach } else { from.max(to) + 1.0 };
                window.along(a, b, reach, |i, distance, t| {
                    let radius = from + (to - from) * t;
                    let part = (radius + 0.5 - distance).clamp(0.0, (2.0 * radius).min(1.0));
                    strength[i] = strength[i].max(part);
                    if vein.is_rib {
                        rib[i] = rib[i].min(distance);
                    }
                });
            }
        }
    }

    /// Lays the piece over what is drawn already.
    fn lay(
        &self,
        piece: &Piece,
        to_pixels: &Affine2,
        grain: &Grain,
        width: usize,
        first_row: usize,
        spots: &mut [Spot],
    ) {
        let skin = &piece.skin;
        let frame = *to_pixels * piece.frame;
        let back = frame.inverse();
        let length = frame.matrix2.y_axis.length();
        let scale = to_pixels.matrix2.x_axis.length();
        let heights = self.heights(skin, piece.bend, &back, length, scale);
        let stride = self.window.columns.len();
        for row in self.inner.rows.clone() {
            for column in self.inner.columns.clone() {
                let i = (row - self.window.rows.start) * stride + column - self.window.columns.start;
                let spot = &mut spots[(row - first_row) * width + column];
                let covered = self.covered[i];
                if self.shadow_reach > 0.0 && covered < 1.0 && self.edge[i] < self.shadow_reach {
                    let near = 1.0 - self.edge[i] / self.shadow_reach;
                    spot.color *= 1.0 - skin.shadow * near * near;
                }
                if covered <= 0.0 {
                    continue;
                }
                let local = back.transform_point2(Vec2::new(column as f32 + 0.5, row as f32 + 0.5));
                let color = self.color(i, skin, local, grain);
                // The window has a rim of one pixel, but at the picture's first row and column.
                let (left, right) =
                    (i - usize::from(!i.is_multiple_of(stride)), i + usize::from(i % stride + 1 < stride));
                let above = i.checked_sub(stride).unwrap_or(i);
                let below = if i + stride < heights.len() { i + stride } else { i };
                let slope = Vec2::new(heights[left] - heights[right], heights[below] - heights[above]) * 0.5;
                let slope = slope.clamp_length_max(1.6) + skin.lean;
                spot.color = spot.color * (1.0 - covered) + color * covered;
                spot.slope = spot.slope * (1.0 - covered) + slope * covered;
                spot.alpha = spot.alpha * (1.0 - covered) + covered;
            }
        }
    }

    /// Heights of the window's pixels, pixels.
    fn heights(&self, skin: &Skin, bend: f32, back: &Affine2, length: f32, scale: f32) -> Vec<f32> {
        let bevel = skin.bevel * scale;
        let columns = self.window.columns.len();
        (0..self.window.len())
            .map(|i| {
                let place = Vec2::new(
                    (self.window.columns.start + i % columns) as f32 + 0.5,
                    (self.window.rows.start + i / columns) as f32 + 0.5,
                );
                let mut height = 0.0;
                if skin.fold != 0.0 || skin.droop != 0.0 {
                    let local = back.transform_point2(place);
                    let across = local.x - bend * local.y * local.y;
                    // Rounded at the midrib over a hundredth of the length.
                    let folded = libm::sqrtf(across * across + 1e-4);
                    height += length * (skin.fold * folded - 0.5 * skin.droop * local.y * local.y);
                }
                if bevel > 0.0 && self.covered[i] > 0.0 {
                    let rise = 1.0 - (self.edge[i] / bevel).min(1.0);
                    height += bevel * libm::sqrtf((1.0 - rise * rise).max(0.0));
                }
                if !self.rib.is_empty() {
                    let away = self.rib[i] / self.rib_reach;
                    height += skin.pillow * self.rib_reach * away * (1.0 - 0.5 * away);
                    height -= 0.6 * skin.pillow * self.vein[i] * (1.0 + 0.004 * length);
                }
                height
            })
            .collect()
    }

    fn color(&self, i: usize, skin: &Skin, local: Vec2, grain: &Grain) -> Vec3 {
        let Vec2 { x, y } = local * 0.25 + skin.place;
        let slow = grain.slow.at(x, y);
        // Askew, twice: a lattice along the leaf's own axes would show.
        let (p, q) = (1.36 * x - 1.02 * y, 1.02 * x + 1.36 * y);
        let fine = 0.6 * grain.fine.at(p, q) + 0.4 * grain.fine.at(2.3 * q, 2.3 * p);
        let (rib, vein) = match self.rib.get(i) {
            Some(rib) => (rib / self.rib_reach, self.vein[i]),
            None => (1.0, 0.0),
        };
        let mut color = skin.color;
        if skin.patch_share > 0.0 {
            let reached = skin.patch_share * 2.4 - 1.2 + 0.75 * slow + 0.7 * (rib - 0.5) + 0.2 * fine;
            color = color.lerp(skin.patch, smoothstep(-0.35, 0.35, reached));
        }
        if skin.foot_reach > 0.0 {
            color = color.lerp(skin.foot, 1.0 - smoothstep(0.0, skin.foot_reach, local.y.max(0.0)));
        }
        // The blade is a little paler along its ribs and darker where it is thickest.
        let light = 1.0 + skin.mottle * (0.7 * slow + 0.5 * fine) + 0.16 * skin.vein_strength * (0.45 - rib);
        (color * light).lerp(skin.vein, (vein * skin.vein_strength).min(1.0)).max(Vec3::ZERO)
    }
}
