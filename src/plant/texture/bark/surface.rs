//! What a style's height and colour are made of.

use glam::Vec3;

use super::BarkStyle;
use crate::texture::periodic::{Cells, Noise, Octaves};
use linden_base::random::Key;

/// Pixels of a side whose noises are fine enough for it.
const USUAL_PX: u32 = 512;

/// How much finer grain is to be seen in height and in light.
const FINE_HEIGHT: f32 = 0.035;
const FINE_TINT: f32 = 0.22;

/// One place of the bark.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Spot {
    /// 0 the deepest, 1 the highest, about.
    pub height: f32,
    /// Linear light, relative to the bark's colour.
    pub tint: Vec3,
}

/// The noises at a place, -1..1.
#[derive(Clone, Copy, Debug)]
pub(super) struct Noises {
    /// Bends what stands there round the girth.
    pub sway: f32,
    /// Bends it along the branch.
    pub lift: f32,
    pub grain: f32,
    pub blotch: f32,
    /// The noise that layers are torn along.
    pub flake: f32,
}

/// Lattice sizes of all noises of a style, across × up the branch.
struct Lattices {
    cells: (u32, u32),
    cracks: (u32, u32),
    folds: [(u32, u32); 2],
    grain: (u32, u32),
    bend: (u32, u32),
    fibres: (u32, u32),
    flakes: (u32, u32, u32),
}

pub(super) struct Surface {
    pub style: BarkStyle,
    pub roughness: f32,
    bend: [Octaves; 2],
    pub cells: Cells,
    pub cracks: Cells,
    /// Furrows lie where either is zero: two families of lines that cross leave lozenges between them.
    pub folds: [Octaves2; 2],
    grain: Octaves,
    blotches: Octaves,
    flakes: Octaves,
    pub fibres: Noise,
    /// Grain that only a large picture can hold.
    fine: Option<Octaves>,
    /// A number 0..1 for each cell, and for each crack cell.
    pub character: [Vec<f32>; 2],
}

/// Two octaves of noise that can be asked at any place.
pub(super) struct Octaves2([Noise; 2]);

impl Octaves2 {
    fn new((across, up): (u32, u32), key: Key) -> Self {
        Self([
            Noise::new(across, up, key.named("first")),
            Noise::new(across * 2, up * 2, key.named("second")),
        ])
    }

    /// -1..1.
    pub fn at(&self, u: f32, v: f32) -> f32 {
        0.72 * self.0[0].at(u, v) + 0.28 * self.0[1].at(u, v)
    }
}

impl Surface {
    pub fn new(style: BarkStyle, roughness: f32, key: Key) -> Self {
        // Ridges are some five times longer than wide; lenticels and the wrinkles of smooth bark lie
        // across the branch.
        let plain = Lattices {
            cells: (9, 22),
            cracks: (4, 3),
            folds: [(8, 2), (9, 3)],
            grain: (18, 18),
            bend: (4, 4),
            fibres: (7, 56),
            flakes: (5, 4, 4),
        };
        let lattices = match style {
            BarkStyle::Ridged => Lattices {
                cracks: (11, 15),
                folds: [(10, 2), (12, 3)],
                grain: (26, 12),
                bend: (4, 3),
                fibres: (110, 9),
                flakes: (12, 5, 4),
                ..plain
            },
            BarkStyle::Plated => Lattices { cells: (6, 3), fibres: (14, 70), flakes: (7, 6, 4), ..plain },
            BarkStyle::Smooth => Lattices { grain: (14, 20), bend: (3, 4), fibres: (6, 70), ..plain },
            BarkStyle::Birch => Lattices {
                cells: (5, 26),
                cracks: (2, 3),
                grain: (10, 30),
                fibres: (5, 90),
                flakes: (3, 12, 4),
                ..plain
            },
            BarkStyle::Peeling => Lattices { folds: [(4, 3), (5, 4)], flakes: (4, 3, 4), ..plain },
            BarkStyle::Ribbon => Lattices {
                folds: [(12, 2), (15, 2)],
                flakes: (14, 3, 4),
                bend: (4, 2),
                fibres: (70, 3),
                grain: (30, 8),
                ..plain
            },
            BarkStyle::Culm => Lattices { fibres: (90, 2), bend: (2, 2), flakes: (16, 16, 3), ..plain },
            BarkStyle::Palm => Lattices { bend: (3, 3), fibres: (110, 9), grain: (30, 14), ..plain },
        };
        let named = |purpose: &str| key.named(purpose);
        let grid = |(across, up): (u32, u32), purpose: &str| Cells::new(across, up, 0.85, named(purpose));
        let (cells, cracks) = (grid(lattices.cells, "cells"), grid(lattices.cracks, "cracks"));
        let each = |cells: &Cells, purpose: &str| -> Vec<f32> {
            (0..cells.len() as u64).map(|i| named(purpose).child(i).unit() as f32).collect()
        };
        let character = [each(&cells, "cell"), each(&cracks, "crack")];
        let [first, second] = lattices.folds;
        Self {
            style,
            roughness,
            bend: ["bend u", "bend v"]
                .map(|purpose| Octaves::new(lattices.bend.0, lattices.bend.1, 3, named(purpose))),
            cells,
            cracks,
            folds: [Octaves2::new(first, named("first fold")), Octaves2::new(second, named("second fold"))],
            grain: Octaves::new(lattices.grain.0, lattices.grain.1, 4, named("grain")),
            blotches: Octaves::new(4, 4, 4, named("blotches")),
            flakes: Octaves::new(lattices.flakes.0, lattices.flakes.1, lattices.flakes.2, named("flakes")),
            fibres: Noise::new(lattices.fibres.0, lattices.fibres.1, named("fibres")),
            fine: None,
            character,
        }
    }

    /// With what a picture of so many pixels shows beyond one of [`USUAL_PX`].
    pub fn fine(self, size_px: u32, key: Key) -> Self {
        let octaves = (size_px / USUAL_PX).checked_ilog2().unwrap_or(0);
        let fine =
            (octaves > 0).then(|| Octaves::new(USUAL_PX / 2, USUAL_PX / 2, octaves, key.named("fine")));
        Self { fine, ..self }
    }

    /// A row across the branch.
    pub fn row(&self, v: f32, spots: &mut [Spot]) {
        let n = spots.len();
        let [sway, lift] = [0, 1].map(|i| self.bend[i].row(v, n));
        let (grain, blotch, flake) = (self.grain.row(v, n), self.blotches.row(v, n), self.flakes.row(v, n));
        let draw = match self.style {
            BarkStyle::Ridged => Self::ridged,
            BarkStyle::Plated => Self::plated,
            BarkStyle::Smooth => Self::smooth,
            BarkStyle::Birch => Self::birch,
            BarkStyle::Peeling => Self::peeling,
            BarkStyle::Ribbon => Self::ribbon,
            BarkStyle::Culm => Self::culm,
            BarkStyle::Palm => Self::palm,
        };
        for (i, spot) in spots.iter_mut().enumerate() {
            let u = (i as f32 + 0.5) / n as f32;
            let noises =
                Noises { sway: sway[i], lift: lift[i], grain: grain[i], blotch: blotch[i], flake: flake[i] };
            *spot = draw(self, u, v, noises);
        }
        if let Some(fine) = &self.fine {
            for (spot, fine) in spots.iter_mut().zip(fine.row(v, n)) {
                let rough = self.roughness * fine;
                spot.height += FINE_HEIGHT * rough * (0.3 + 0.7 * spot.height.clamp(0.0, 1.0));
                spot.tint *= 1.0 + FINE_TINT * rough;
            }
        }
    }
}
