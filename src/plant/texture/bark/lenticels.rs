//! Lenticels: the corky pores of young and of thin bark, lips across the branch that draw out into bands as the
//! trunk grows in girth.

use glam::Vec3;

use super::Bark;
use super::surface::Spot;
use crate::texture::periodic::{Cells, Octaves, smoothstep};
use linden_base::color::{linear, luminance};

/// Places for lenticels, round the girth and up the branch.
const PLACES: (u32, u32) = (4, 26);
/// Bark lighter than this (linear) has darker lenticels, bark that is darker has lighter ones.
const DARK: f32 = 0.16;

/// Those of a bark.
pub(super) struct Lenticels {
    cells: Cells,
    /// A number 0 to 1 for each place.
    character: Vec<f32>,
    ragged: Octaves,
    share: f32,
    /// Relative to the bark's colour.
    tint: Vec3,
}

impl Lenticels {
    /// `None` where there are none.
    pub fn new(bark: &Bark) -> Option<Self> {
        let share = if bark.lenticels.is_finite() { bark.lenticels.clamp(0.0, 1.0) } else { 0.0 };
        if share == 0.0 {
            return None;
        }
        let key = bark.key.named("lenticels");
        let cells = Cells::new(PLACES.0, PLACES.1, 0.8, key.named("places"));
        let character = (0..cells.len() as u64).map(|i| key.child(i).unit() as f32).collect();
        let light = luminance(linear(bark.color));
        // Cork: rusty on what is dark.
        let tint = if light < DARK { Vec3::new(1.75, 1.45, 1.2) } else { Vec3::new(0.5, 0.44, 0.38) };
        Some(Self { cells, character, ragged: Octaves::new(24, 60, 3, key.named("ragged")), share, tint })
    }

    /// Lays them over a row across the branch.
    pub fn row(&self, v: f32, spots: &mut [Spot]) {
        let n = spots.len();
        let ragged = self.ragged.row(v, n);
        for (i, (spot, ragged)) in spots.iter_mut().zip(ragged).enumerate() {
            let place = self.cells.at((i as f32 + 0.5) / n as f32, v + 0.002 * ragged);
            let character = self.character[place.index];
            if character > self.share {
                continue;
            }
            // From dots to bands that meet.
            let size = character / self.share;
            let (wide, high) = (0.12 + 0.4 * self.share * size * size, 0.13 + 0.1 * size);
            let (x, y) = (place.offset[0] / wide, (place.offset[1] + 0.04 * ragged) / high);
            let inside = (1.0 - x * x - y * y).max(0.0);
            let lip = smoothstep(0.0, 0.45, inside + 0.25 * ragged * inside);
            // The lips part in the middle.
            let slit = smoothstep(0.55, 1.0, 1.0 - y.abs()) * lip;
            spot.tint *= Vec3::ONE.lerp(self.tint, 0.9 * lip) * (1.0 - 0.3 * slit);
            spot.height += 0.3 * lip - 0.15 * slit;
        }
    }
}
