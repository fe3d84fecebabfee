//! Several samples a pixel, each with a depth.

use glam::{Vec3, Vec4};

use crate::canvas::Rows;
use crate::strokes::paint::Ground;

/// Of a sample.
pub(super) const BYTES: u64 = (size_of::<f32>() + size_of::<Vec4>()) as u64;

/// The samples of some rows.
pub(super) struct Samples {
    rows: Rows,
    /// Along a pixel's side.
    pub factor: u32,
    /// 1 ÷ metres from the lens; 0 where nothing is.
    pub nearness: Vec<f32>,
    /// Premultiplied linear light.
    pub light: Vec<Vec4>,
}

impl Samples {
    pub fn new(rows: Rows, factor: u32) -> Self {
        let count = (rows.width * factor) as usize * (rows.height * factor) as usize;
        Self { rows, factor, nearness: vec![0.0; count], light: vec![Vec4::ZERO; count] }
    }

    /// Samples per row of samples.
    pub fn width(&self) -> u32 {
        self.rows.width * self.factor
    }

    /// The pixels' means.
    pub fn resolve(&self, pixels: &mut [Vec4]) {
        let share = 1.0 / (self.factor * self.factor) as f32;
        for (i, pixel) in pixels.iter_mut().enumerate() {
            *pixel = self.of_pixel(i).map(|at| self.light[at]).sum::<Vec4>() * share;
        }
    }

    fn of_pixel(&self, pixel: usize) -> impl Iterator<Item = usize> + use<> {
        let (width, factor) = (self.rows.width as usize, self.factor as usize);
        let first = (pixel / width * factor * width + pixel % width) * factor;
        (0..factor).flat_map(move |y| (0..factor).map(move |x| first + y * width * factor + x))
    }
}

/// Strokes come far to near after all triangles; a triangle that is nearer hides them.
impl Ground for Samples {
    fn lay(&mut self, pixel: usize, light: Vec3, alpha: f32, depth_m: f32) {
        let nearness = 1.0 / depth_m;
        for at in self.of_pixel(pixel) {
            if self.nearness[at] <= nearness {
                let below = &mut self.light[at];
                *below = *below * (1.0 - alpha) + light.extend(alpha);
            }
        }
    }
}
