//! Pictures on surfaces, halved until their texels are about as large as pixels.

use glam::{Vec2, Vec3, Vec4};
use linden_pipeline::memory::bytes_of;
use linden_pipeline::picture::Picture;

use crate::color::linear;

/// A picture in linear light at several sizes, each half the last.
pub(super) struct Texels {
    levels: Vec<Level>,
    /// How often the picture was halved before the first of them.
    finest: u32,
}

struct Level {
    width: u32,
    height: u32,
    /// Light, and alpha: how much of the texel there is.
    colors: Vec<Vec4>,
}

impl Texels {
    /// Bytes that they take for a picture, the sums on the way included.
    pub fn bytes(picture: &Picture, finest: u32) -> u64 {
        let finest = finest.min(picture.width().max(picture.height()).max(1).ilog2());
        let side = |pixels: u32| pixels.div_ceil(1 << finest) as usize;
        let texels = side(picture.width()) * side(picture.height());
        // All coarser sizes are a third of the finest.
        bytes_of::<(Vec4, f32)>(texels) + bytes_of::<Vec4>(texels + texels / 3)
    }

    /// Sizes from the one that was halved `finest` times. `None` for a picture without pixels.
    pub fn new(picture: &Picture, finest: u32) -> Option<Self> {
        let (width, height) = (picture.width(), picture.height());
        let pixels = picture.rgba().as_chunks::<4>().0;
        if width == 0 || height == 0 || pixels.len() != width as usize * height as usize {
            return None;
        }
        let finest = finest.min(width.max(height).ilog2());
        let mut curve = [0.0; 256];
        for (code, light) in curve.iter_mut().enumerate() {
            *light = linear([code as u8; 3]).x;
        }
        // Blocks of the picture, which at the edges may be incomplete.
        let block = 1_u32 << finest;
        let (w, h) = (width.div_ceil(block), height.div_ceil(block));
        let mut sums = vec![(Vec4::ZERO, 0.0_f32); w as usize * h as usize];
        for (y, row) in pixels.chunks_exact(width as usize).enumerate() {
            let first = (y as u32 / block * w) as usize;
            for (blocks, sum) in row.chunks(block as usize).zip(&mut sums[first..]) {
                for &[r, g, b, a] in blocks {
                    let [r, g, b] = [r, g, b].map(|code| curve[usize::from(code)]);
                    sum.0 += Vec4::new(r, g, b, f32::from(a) / 255.0);
                }
                sum.1 += blocks.len() as f32;
            }
        }
        let colors = sums.into_iter().map(|(sum, count)| sum / count).collect();
        let mut levels = vec![Level { width: w, height: h, colors }];
        while let Some(next) = levels.last().and_then(Level::halved) {
            levels.push(next);
        }
        Some(Self { levels, finest })
    }

    /// The colour at a place, in pictures, V up, and its alpha; of the size that was halved so often.
    pub fn at(&self, uv: Vec2, halved: u32) -> Vec4 {
        let wanted = halved.saturating_sub(self.finest) as usize;
        self.levels[wanted.min(self.levels.len() - 1)].at(uv)
    }

    /// The mean of all.
    pub fn mean(&self) -> Vec3 {
        self.levels.last().map_or(Vec3::ONE, |level| level.colors[0].truncate())
    }
}

impl Level {
    fn halved(&self) -> Option<Self> {
        if self.width == 1 && self.height == 1 {
            return None;
        }
        let (width, height) = (self.width.div_ceil(2), self.height.div_ceil(2));
        let mut colors = Vec::with_capacity(width as usize * height as usize);
        for y in 0..height {
            for x in 0..width {
                let texel = |dx: u32, dy: u32| {
                    let (x, y) = ((2 * x + dx).min(self.width - 1), (2 * y + dy).min(self.height - 1));
                    self.colors[(y * self.width + x) as usize]
                };
                colors.push((texel(0, 0) + texel(1, 0) + texel(0, 1) + texel(1, 1)) / 4.0);
            }
        }
        Some(Self { width, height, colors })
    }

    /// Between the four nearest texels; the picture repeats.
    fn at(&self, uv: Vec2) -> Vec4 {
        if let [only] = self.colors[..] {
            return only;
        }
        let split = |x: f32, n: u32| {
            let x = (x - x.floor()) * n as f32 - 0.5;
            let low = x.floor();
            let wrap = |i: i64| i.rem_euclid(i64::from(n)) as u32;
            (wrap(low as i64), wrap(low as i64 + 1), x - low)
        };
        let (x0, x1, s) = split(uv.x, self.width);
        let (y0, y1, t) = split(1.0 - uv.y, self.height);
        let texel = |x: u32, y: u32| self.colors[(y * self.width + x) as usize];
        texel(x0, y0).lerp(texel(x1, y0), s).lerp(texel(x0, y1).lerp(texel(x1, y1), s), t)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Upper half white, lower half black.
    fn halves() -> Picture {
        let rgba = (0..8 * 8).flat_map(|i| if i < 32 { [255; 4] } else { [0, 0, 0, 255] }).collect();
        Picture::new(8, 8, rgba)
    }

    #[test]
    fn v_points_up_and_the_mean_is_a_mean_of_light() {
        let texels = Texels::new(&halves(), 0).unwrap();
        assert_eq!(texels.at(Vec2::new(0.5, 0.75), 0), Vec4::ONE);
        assert_eq!(texels.at(Vec2::new(7.5, -0.75), 0), Vec4::W);
        assert_eq!(texels.mean(), Vec3::splat(0.5));
        assert_eq!(texels.at(Vec2::new(0.1, 0.1), 9), Vec3::splat(0.5).extend(1.0));
        assert_eq!(texels.at(Vec2::new(0.5, 0.75), 2), Vec4::ONE);
    }

    #[test]
    fn starting_halved_changes_nothing() {
        let (all, coarse) = (Texels::new(&halves(), 0).unwrap(), Texels::new(&halves(), 2).unwrap());
        for i in 0..20 {
            let uv = Vec2::new(i as f32 * 0.13, i as f32 * 0.29);
            assert!((all.at(uv, 2) - coarse.at(uv, 0)).length() < 1e-6);
        }
        assert!(Texels::new(&Picture::new(2, 2, vec![0; 3]), 0).is_none());
    }
}
