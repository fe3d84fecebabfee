//! `[detail]`: how many triangles, and in how many levels.

use super::knobs::{PresetKnob, integer, real, row};

/// How much of the tree is shown from near and from far.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DetailLook {
    /// Triangles of the finest level; 0: all that there are.
    pub triangles: u64,
    /// Levels of triangles.
    pub lods: u32,
    /// Triangles of a level as a share of those of the one before.
    pub lod_ratio: f64,
    /// Upright planes of a last level, after those of triangles; 0: none.
    pub billboard: u32,
    /// Height of the planes' picture, pixels.
    pub billboard_size_px: u32,
}

impl DetailLook {
    /// How many levels there will be at most, the planes included.
    pub const fn levels(&self) -> usize {
        self.lods as usize + (self.billboard > 0) as usize
    }
}

impl Default for DetailLook {
    /// One level, with everything.
    fn default() -> Self {
        Self { triangles: 0, lods: 1, lod_ratio: 0.33, billboard: 0, billboard_size_px: 1024 }
    }
}

/// The most levels of triangles.
const MOST_LODS: u64 = 8;

/// The section's knobs.
pub(super) const KNOBS: &[PresetKnob] = &[
    row!(Detail, "triangles", integer(0, u32::MAX as u64), "", "budget of the finest level, met within 5 %; 0: all that there are", .detail.triangles),
    row!(Detail, "lods", integer(1, MOST_LODS), "", "levels of detail: the same tree with fewer triangles each time", .detail.lods),
    row!(Detail, "lod_ratio", real(0.05, 0.9), "", "triangles of a level / triangles of the one before", .detail.lod_ratio),
    row!(Detail, "billboard", integer(0, 4), "planes", "a last level of crossed planes with pictures of the tree; 0: none", .detail.billboard),
    row!(Detail, "billboard_size", integer(64, 4096), "px", "height of the planes' picture", .detail.billboard_size_px),
];
