//! A picture averaged onto the grid that characters can show.

/// RGBA pixels, rows from the top, sRGB, not premultiplied.
#[derive(Clone, Copy, Debug)]
pub struct Image<'a> {
    width: u32,
    height: u32,
    rgba: &'a [u8],
}

/// The pixels are not what the size says.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("a picture of {width}×{height} pixels cannot be shown: it has {bytes} bytes, {expected} are needed")]
pub struct ImageError {
    width: u32,
    height: u32,
    bytes: usize,
    expected: u64,
}

impl<'a> Image<'a> {
    /// Checks that there are `width × height × 4` bytes.
    ///
    /// # Errors
    /// [`ImageError`] when there are not, or when a side is 0.
    pub fn new(width: u32, height: u32, rgba: &'a [u8]) -> Result<Self, ImageError> {
        let expected = u64::from(width).saturating_mul(u64::from(height)).saturating_mul(4);
        if expected == 0 || expected != rgba.len() as u64 {
            return Err(ImageError { width, height, bytes: rgba.len(), expected });
        }
        Ok(Self { width, height, rgba })
    }

    /// The mean of the pixels under each place of a grid, rows from the top.
    pub(crate) fn averaged(&self, columns: usize, rows: usize) -> Vec<Light> {
        let decoded: [f32; 256] = std::array::from_fn(|i| decode(i as f32 / 255.0));
        let across = shares(self.width as usize, columns);
        let down = shares(self.height as usize, rows);
        let mut grid = Vec::with_capacity(columns * rows);
        for ys in &down {
            for xs in &across {
                let (mut sum, mut weight) = (Light::default(), 0.0);
                for &(y, wy) in ys {
                    let row = &self.rgba[y * self.width as usize * 4..][..self.width as usize * 4];
                    for &(x, wx) in xs {
                        let w = wx * wy;
                        let pixel = &row[x * 4..x * 4 + 4];
                        let alpha = w * f32::from(pixel[3]) / 255.0;
                        for (sum, &c) in sum.rgb.iter_mut().zip(pixel) {
                            *sum += alpha * decoded[usize::from(c)];
                        }
                        sum.alpha += alpha;
                        weight += w;
                    }
                }
                sum.rgb = sum.rgb.map(|c| c / weight);
                sum.alpha /= weight;
                grid.push(sum);
            }
        }
        grid
    }
}

/// Premultiplied linear light.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Light {
    pub rgb: [f32; 3],
    pub alpha: f32,
}

impl Light {
    /// What is seen of it over something opaque, linear light.
    pub(crate) fn over(self, behind: [f32; 3]) -> [f32; 3] {
        std::array::from_fn(|i| self.rgb[i] + (1.0 - self.alpha) * behind[i])
    }
}

/// For each of `n` equal parts of `pixels`: which pixels lie in it, and how much of each.
fn shares(pixels: usize, n: usize) -> Vec<Vec<(usize, f32)>> {
    let part = pixels as f64 / n as f64;
    (0..n)
        .map(|i| {
            let (from, to) = (i as f64 * part, (i + 1) as f64 * part);
            let covered = |x: usize| ((x + 1) as f64).min(to) - (x as f64).max(from);
            (from as usize..pixels.min(to.ceil() as usize))
                .map(|x| (x, covered(x) as f32))
                .filter(|&(_, w)| w > 0.0)
                .collect()
        })
        .collect()
}

/// sRGB code value to linear light, 0..1 (IEC 61966-2-1).
pub(crate) fn decode(c: f32) -> f32 {
    if c <= 0.040_45 { c / 12.92 } else { libm::powf((c + 0.055) / 1.055, 2.4) }
}

/// Linear light to an sRGB code value, 0..1 (IEC 61966-2-1).
pub(crate) fn encode(c: f32) -> f32 {
    if c <= 0.003_130_8 { c * 12.92 } else { 1.055 * libm::powf(c, 1.0 / 2.4) - 0.055 }
}

/// Linear light as sRGB bytes.
pub(crate) fn bytes(linear: [f32; 3]) -> [u8; 3] {
    linear.map(|c| (encode(c.clamp(0.0, 1.0)) * 255.0 + 0.5) as u8)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn halves_are_means_of_light() {
        // Black and white: half the light, code value 188, not 128.
        let image = Image::new(2, 1, &[0, 0, 0, 255, 255, 255, 255, 255]).unwrap();
        assert_eq!(bytes(image.averaged(1, 1)[0].rgb), [188; 3]);
    }

    #[test]
    fn transparent_pixels_add_no_color() {
        let image = Image::new(2, 1, &[255, 0, 0, 255, 0, 255, 0, 0]).unwrap();
        let mean = image.averaged(1, 1)[0];
        assert_eq!((mean.rgb, mean.alpha), ([0.5, 0.0, 0.0], 0.5));
    }

    #[test]
    fn parts_cover_all_pixels_once() {
        for (pixels, n) in [(7, 3), (3, 7), (1, 5), (64, 64), (100, 33)] {
            let mut total = vec![0.0; pixels];
            for (x, w) in shares(pixels, n).into_iter().flatten() {
                total[x] += w;
            }
            assert!(total.iter().all(|w: &f32| (w - 1.0).abs() < 1e-4), "{pixels} {n}: {total:?}");
        }
    }

    #[test]
    fn a_size_that_lies_is_an_error() {
        assert!(Image::new(2, 2, &[0; 15]).is_err() && Image::new(0, 2, &[]).is_err());
        assert!(Image::new(u32::MAX, u32::MAX, &[0; 16]).is_err());
    }
}
