//! Where what is drawn lies on a picture.

use super::sight::Sight;
use crate::detail::drawing::{MARGIN_PX, Pixels};

/// Where cells lie on a square: on shelves, the tallest first.
pub(super) struct Sheet {
    /// Pixels of a radius.
    pub scale: f32,
    /// The upper left corner of each sight's cell.
    pub cells: Vec<Pixels>,
}

impl Sheet {
    /// In the largest scale in which all have room.
    pub fn new(sights: &[Sight], size_px: u32) -> Self {
        const STEPS: u32 = 20;
        let mut order: Vec<usize> = (0..sights.len()).collect();
        let tall = |at: usize| sights[at].size().y * sights[at].share;
        order.sort_by(|&a, &b| tall(b).total_cmp(&tall(a)).then(a.cmp(&b)));
        let (mut low, mut high) = (0.0, size_px as f32);
        let mut best = Self { scale: 1e-3, cells: vec![Pixels::new(0, 0); sights.len()] };
        for _ in 0..STEPS {
            let scale = f32::midpoint(low, high);
            match shelves(sights, &order, scale, size_px) {
                Some(cells) => (low, best) = (scale, Self { scale, cells }),
                None => high = scale,
            }
        }
        best
    }

    pub fn pixels(&self, sight: &Sight) -> Pixels {
        pixels(sight, self.scale)
    }
}

/// A cell with its margins.
fn pixels(sight: &Sight, scale: f32) -> Pixels {
    let size = (sight.size() * (scale * sight.share)).ceil();
    Pixels::new(size.x as u32 + 2 * MARGIN_PX, size.y as u32 + 2 * MARGIN_PX)
}

fn shelves(sights: &[Sight], order: &[usize], scale: f32, size_px: u32) -> Option<Vec<Pixels>> {
    let mut cells = vec![Pixels::new(0, 0); sights.len()];
    let (mut x, mut y, mut height) = (0, 0, 0);
    for &at in order {
        let size = pixels(&sights[at], scale);
        if size.x > size_px {
            return None;
        }
        if x + size.x > size_px {
            (x, y, height) = (0, y + height, 0);
        }
        height = height.max(size.y);
        if y + height > size_px {
            return None;
        }
        cells[at] = Pixels::new(x, y);
        x += size.x;
    }
    Some(cells)
}
