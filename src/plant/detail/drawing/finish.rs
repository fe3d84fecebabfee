//! Samples → pictures: alpha that a threshold can cut, colours beyond the edge.

use glam::{Vec2, Vec3, Vec4};
use rayon::prelude::*;

use super::Canvas;
use super::Pixels;
use super::raster::ROWS_PER_COUNT;
use crate::detail::wood::GOLDEN;
use crate::texture::leaf;
use linden_base::color;
use linden_base::memory::bytes_of;
use linden_base::monitor::{Cancelled, Monitor};
use linden_base::picture::Picture;

/// The two pictures.
pub(in crate::detail) struct Finished {
    /// sRGB and alpha.
    pub color: Picture,
    /// Tangent space.
    pub normal: Picture,
    /// See [`Material::passing_picture`](crate::scene::Material::passing_picture).
    pub passing: Picture,
}

/// A picture that is put together from what was drawn in samples.
pub(in crate::detail) struct Pile {
    colors: Plane,
    normals: Plane,
    passing: Plane,
    /// Share of a pixel that a sample is.
    share: f32,
}

/// What the pixels of a drawing show: colours and normals, summed over their samples; what passes what is nearest, and
/// how many samples that is of.
pub(in crate::detail) struct Resolved {
    size: Pixels,
    pixels: Vec<(Vec4, Vec4)>,
    passing: Vec<Vec2>,
}

impl Resolved {
    /// Bytes of so many pixels.
    pub const fn bytes(pixels: usize) -> u64 {
        bytes_of::<(Vec4, Vec4, Vec2)>(pixels)
    }

    /// Of `samples × samples` to a pixel.
    pub fn of(drawn: &Canvas, samples: u32) -> Self {
        let size = Pixels::new(drawn.size.x / samples, drawn.size.y / samples);
        let mut pixels = vec![(Vec4::ZERO, Vec4::ZERO); size.area()];
        let mut passing = vec![Vec2::ZERO; size.area()];
        for (row, line) in drawn.samples.chunks_exact(drawn.size.x as usize).enumerate() {
            let first = row / samples as usize * size.x as usize;
            let is_counted = row.is_multiple_of(ROWS_PER_COUNT as usize);
            for (column, seen) in line.iter().enumerate() {
                let at = first + column / samples as usize;
                if let (Some(pixel), true) = (pixels.get_mut(at), seen.near_m > f32::NEG_INFINITY) {
                    pixel.0 += seen.color.extend(1.0);
                    pixel.1 += seen.normal.extend(1.0);
                    if is_counted {
                        // What is nearest is what the material says.
                        let [nearest, behind] = seen.passes;
                        passing[at] += Vec2::new(if nearest > 0.0 { behind } else { 0.0 }, 1.0);
                    }
                }
            }
        }
        Self { size, pixels, passing }
    }

    /// Of all that is seen, linear.
    pub fn mean_color(&self) -> Vec3 {
        let sum: Vec4 = self.pixels.iter().map(|(color, _)| *color).sum();
        sum.truncate() / sum.w.max(1.0)
    }
}

impl Pile {
    /// Nothing yet, for drawings of `samples × samples` to a pixel.
    pub fn new(size: Pixels, samples: u32) -> Self {
        let [colors, normals, passing] = [(); 3].map(|()| Plane::new(size));
        Self { colors, normals, passing, share: 1.0 / (samples * samples) as f32 }
    }

    /// Bytes while it is made and finished.
    pub const fn bytes(size: Pixels) -> u64 {
        bytes_of::<[f32; 21]>(size.area())
    }

    /// Lays a drawing, its upper left corner at a pixel, its colours times `light`.
    pub fn lay(&mut self, drawing: &Resolved, corner: Pixels, light: Vec3) {
        let light = light.extend(1.0);
        let size = self.colors.size;
        let width = (drawing.size.x as usize).max(1);
        for (row, line) in drawing.pixels.chunks_exact(width).enumerate() {
            let y = corner.y as usize + row;
            if y >= size.y as usize {
                break;
            }
            let first = y * size.x as usize;
            let passing = &drawing.passing[row * width..][..width];
            for (x, ((color, normal), seen)) in
                (corner.x as usize..size.x as usize).zip(line.iter().zip(passing))
            {
                self.colors.values[first + x] += *color * light;
                self.normals.values[first + x] += *normal;
                self.passing.values[first + x] += Vec4::new(seen.x, 0.0, 0.0, seen.y);
            }
        }
    }

    /// Makes the pictures, cut out where alpha is below `cutout`. What is covered stays so `in_copies`: smaller
    /// ones of the picture. That costs about half of the file again where thin wood is seen.
    pub fn finish(self, cutout: f32, in_copies: bool, monitor: &dyn Monitor) -> Result<Finished, Cancelled> {
        let Self { mut colors, mut normals, mut passing, share } = self;
        let size = colors.size;
        let covered: Vec<f32> = colors.values.iter().map(|sum| sum.w * share).collect();
        let mut alpha = keep_coverage(&covered, size, cutout);
        if in_copies {
            leaf::keep_coverage(&mut alpha, size.x as usize);
        }
        let (filled, others) = rayon::join(
            || colors.fill(monitor),
            || normals.fill(monitor).and_then(|()| passing.fill(monitor)),
        );
        filled.and(others)?;
        let code = |x: f32| libm::roundf(x.clamp(0.0, 1.0) * 255.0) as u8;
        let colored = |(color, alpha): (&Vec4, f32)| {
            let [r, g, b] = color.truncate().to_array().map(color::code);
            [r, g, b, code(alpha)]
        };
        let normal = |normal: &Vec4| {
            let normal = normal.truncate().normalize_or(Vec3::Z) * 0.5 + 0.5;
            [code(normal.x), code(normal.y), code(normal.z), 255]
        };
        let color: Vec<[u8; 4]> = colors.values.par_iter().zip(alpha).map(colored).collect();
        let normal: Vec<[u8; 4]> = normals.values.par_iter().map(normal).collect();
        let picture = |pixels: Vec<[u8; 4]>| Picture::new(size.x, size.y, pixels.into_flattened());
        let passing = passing.values.iter().map(|seen| [code(seen.x); 4]).collect();
        Ok(Finished { color: picture(color), normal: picture(normal), passing: picture(passing) })
    }
}

/// Alpha such that as much is above the threshold as is covered: cut at half of their cover, thin twigs
/// would vanish (Castaño 2010, "Computing alpha mipmaps"). Pixels that are covered equally are told apart
/// by what their neighbours are, and then by a pattern.
fn keep_coverage(covered: &[f32], size: Pixels, cutout: f32) -> Vec<f32> {
    let (width, height) = (i64::from(size.x), i64::from(size.y));
    let at = |x: i64, y: i64| {
        let inside = (0..width).contains(&x) && (0..height).contains(&y);
        if inside { covered[(y * width + x) as usize] } else { 0.0 }
    };
    let weighed: Vec<f32> = (0..height)
        .flat_map(|y| (0..width).map(move |x| (x, y)))
        .map(|(x, y)| {
            let share = at(x, y);
            if share == 0.0 || share >= 1.0 {
                return share;
            }
            let around: f32 =
                [(-1, 0), (1, 0), (0, -1), (0, 1)].map(|(dx, dy)| at(x + dx, y + dy)).iter().sum();
            let pattern = ((y * width + x) as f64 * GOLDEN).fract() as f32;
            0.89 * share + 0.1 * around / 4.0 + 0.01 * pattern
        })
        .collect();
    let mut ranked: Vec<f32> = weighed.iter().copied().filter(|&share| share > 0.0).collect();
    ranked.sort_unstable_by(|a, b| b.total_cmp(a));
    let wanted = covered.iter().map(|&share| f64::from(share)).sum::<f64>() as usize;
    let Some(&least) = ranked.get(wanted.min(ranked.len().saturating_sub(1))) else { return weighed };
    // Linear on either side of the threshold.
    let alpha = |share: f32| {
        if share == 0.0 || share >= 1.0 {
            share
        } else if share < least {
            cutout * 0.98 * share / least
        } else {
            // Well above after rounding to 8 bits.
            cutout + 0.02 + (0.98 - cutout) * (share - least) / (1.0 - least).max(1e-6)
        }
    };
    weighed.into_iter().map(alpha).collect()
}

/// Sums of values in `xyz` and of their weights in `w`.
pub(in crate::detail) struct Plane {
    size: Pixels,
    pub values: Vec<Vec4>,
}

impl Plane {
    pub fn new(size: Pixels) -> Self {
        Self { size, values: vec![Vec4::ZERO; size.area()] }
    }

    /// Gives every pixel without a value one from around it, and the others their mean: halved pictures
    /// and filters then find no foreign colour beyond an edge. The pull-push of Gortler et al. 1996
    /// ("The Lumigraph"), with weights that are either there or not.
    pub fn fill(&mut self, monitor: &dyn Monitor) -> Result<(), Cancelled> {
        monitor.check()?;
        for value in &mut self.values {
            *value = if value.w > 0.0 { *value / value.w } else { Vec4::ZERO };
        }
        if self.size.area() <= 1 {
            return Ok(());
        }
        let mut half = Self::new(Pixels::new(self.size.x.div_ceil(2), self.size.y.div_ceil(2)));
        for (i, value) in self.values.iter().enumerate() {
            let (x, y) = (i as u32 % self.size.x, i as u32 / self.size.x);
            half.values[(y / 2 * half.size.x + x / 2) as usize] += *value;
        }
        half.fill(monitor)?;
        for (i, value) in self.values.iter_mut().enumerate().filter(|(_, value)| value.w == 0.0) {
            let (x, y) = (i as u32 % self.size.x, i as u32 / self.size.x);
            *value = half.values[(y / 2 * half.size.x + x / 2) as usize];
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use linden_base::random::Key;

    #[test]
    fn as_much_is_above_the_threshold_as_was_covered() {
        let size = Pixels::new(64, 48);
        for seed in 0..20 {
            let key = Key::new(seed);
            // Thin things: few pixels are covered by more than half.
            let covered: Vec<f32> = (0..64 * 48)
                .map(|i| (key.child(i).unit() * 4.0 - 1.8).clamp(0.0, 1.0) as f32 * 0.75)
                .map(|share| (share * 4.0).round() / 4.0)
                .collect();
            let wanted: f32 = covered.iter().sum();
            let alpha = keep_coverage(&covered, size, 0.5);
            let found =
                alpha.iter().filter(|&&value| libm::roundf(value * 255.0) / 255.0 >= 0.5).count() as f32;
            assert!((found / wanted - 1.0).abs() < 0.03, "{found} of {wanted}");
            assert!(alpha.iter().zip(&covered).all(|(alpha, covered)| (*alpha > 0.0) == (*covered > 0.0)));
        }
    }

    #[test]
    fn colours_go_on_beyond_the_edge() {
        let mut plane = Plane::new(Pixels::new(34, 18));
        plane.values[0] = Vec4::new(2.0, 4.0, 6.0, 2.0);
        plane.values[34 * 18 - 1] = Vec4::new(0.0, 1.0, 0.0, 1.0);
        plane.fill(&linden_base::monitor::Quiet).unwrap();
        assert_eq!(plane.values[0].truncate(), Vec3::new(1.0, 2.0, 3.0));
        assert_eq!(plane.values[1].truncate(), Vec3::new(1.0, 2.0, 3.0), "its neighbour");
        assert_eq!(plane.values[34 * 18 - 2].truncate(), Vec3::Y);
        assert!(plane.values.iter().all(|value| value.w > 0.0));
    }
}
