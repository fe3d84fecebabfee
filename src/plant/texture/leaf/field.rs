//! Distances to lines, written into windows of pixels.
//!
//! A segment touches only the pixels in its reach, so that thousands of veins and needles cost as much
//! as the pixels near them.

use std::ops::Range;

use glam::Vec2;

/// Some columns and rows of the picture, pixels.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Window {
    pub columns: Range<usize>,
    pub rows: Range<usize>,
}

impl Window {
    pub fn len(&self) -> usize {
        self.columns.len() * self.rows.len()
    }

    /// The part of it that is no further than `reach` from a box.
    pub fn near(&self, min: Vec2, max: Vec2, reach: f32) -> Option<Self> {
        let clip = |range: &Range<usize>, low: f32, high: f32| {
            let from = ((low - reach).floor().max(0.0) as usize).max(range.start);
            let to = ((high + reach).ceil().max(0.0) as usize).min(range.end);
            (from < to).then_some(from..to)
        };
        Some(Self { columns: clip(&self.columns, min.x, max.x)?, rows: clip(&self.rows, min.y, max.y)? })
    }

    /// Calls with the index of each pixel in reach of a segment, its distance from the segment, and
    /// how far along the segment is nearest, 0..1.
    pub fn along(&self, a: Vec2, b: Vec2, reach: f32, mut each: impl FnMut(usize, f32, f32)) {
        let Some(part) = self.near(a.min(b), a.max(b), reach) else { return };
        let way = b - a;
        let per_length = 1.0 / way.length_squared().max(1e-12);
        for row in part.rows {
            let start = (row - self.rows.start) * self.columns.len();
            for column in part.columns.clone() {
                let from = Vec2::new(column as f32 + 0.5, row as f32 + 0.5) - a;
                let t = (from.dot(way) * per_length).clamp(0.0, 1.0);
                let distance = (from - way * t).length();
                each(start + column - self.columns.start, distance, t);
            }
        }
    }
}
