//! Pictures that the user gives as bark.

use std::sync::Arc;

use rayon::prelude::*;

use super::{BarkError, normals};
use linden_base::color::{encode, linear, luminance};
use linden_base::monitor::Monitor;
use linden_base::picture::Picture;

/// Without its alpha: bark has no holes.
pub fn opaque(picture: &Arc<Picture>) -> Arc<Picture> {
    if picture.rgba().as_chunks::<4>().0.iter().all(|pixel| pixel[3] == 255) {
        return Arc::clone(picture);
    }
    let solid = picture.rgba().as_chunks().0.iter().flat_map(|&[r, g, b, _]| [r, g, b, 255]);
    Arc::new(Picture::new(picture.width(), picture.height(), solid.collect()))
}

/// Tangent-space normals (OpenGL convention) of a picture whose lightest places stand out and whose
/// darkest lie deep: `relief` apart, as a share of its width, 0 to 0.5. The picture continues across its
/// edges.
///
/// Photographs are full of noise that is no height: lightness is smoothed over 3 × 3 pixels, by
/// 1-2-1 each way, before slopes are taken of it.
///
/// # Errors
/// [`BarkError`]: memory, or cancelled.
pub fn normals_by_lightness(
    picture: &Picture,
    relief: f32,
    monitor: &dyn Monitor,
) -> Result<Arc<Picture>, BarkError> {
    let (width, height) = (picture.width() as usize, picture.height() as usize);
    // Two fields of heights and the normals.
    monitor.admit("shaping the bark", (width * height * 12) as u64, "scale bark_picture down")?;
    // Evenly spaced for the eye.
    let light = |&[r, g, b, _]: &[u8; 4]| encode(luminance(linear([r, g, b])));
    let raw: Vec<f32> = picture.rgba().as_chunks().0.par_iter().map(light).collect();
    monitor.check()?;
    let mut smooth = vec![0.0_f32; raw.len()];
    smooth.par_chunks_mut(width).enumerate().for_each(|(row, out)| {
        let rows = [(row + height - 1) % height, row, (row + 1) % height].map(|row| &raw[row * width..]);
        let across = |column: usize| rows[0][column] + 2.0 * rows[1][column] + rows[2][column];
        for (column, out) in out.iter_mut().enumerate() {
            let (left, right) = ((column + width - 1) % width, (column + 1) % width);
            *out = (across(left) + 2.0 * across(column) + across(right)) / 16.0;
        }
    });
    monitor.check()?;
    let (low, high) = smooth.iter().fold((f32::MAX, f32::MIN), |(low, high), &h| (low.min(h), high.max(h)));
    let relief = if relief.is_finite() { relief.clamp(0.0, 0.5) } else { 0.0 };
    // One shade is flat.
    let relief = if high > low { relief / (high - low) } else { 0.0 };
    let rgba = normals(|row, column| smooth[row * width + column], (width, height), relief);
    Ok(Arc::new(Picture::new(picture.width(), picture.height(), rgba)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use linden_base::monitor::Quiet;

    /// A ridge along V, as a cosine of the lightness: its slope is known.
    #[test]
    fn a_ridge_leans_as_its_height_says() {
        const SIDE: u32 = 64;
        const RELIEF: f32 = 0.05;
        let shade = |x: u32| 0.5 - 0.4 * libm::cosf(std::f32::consts::TAU * x as f32 / SIDE as f32);
        let pixels = (0..SIDE / 2).flat_map(|_| 0..SIDE).flat_map(|x| {
            let code = (shade(x) * 255.0).round() as u8;
            [code, code, code, 255]
        });
        let picture = Picture::new(SIDE, SIDE / 2, pixels.collect());
        let normal = normals_by_lightness(&picture, RELIEF, &Quiet).unwrap();
        assert_eq!((normal.width(), normal.height()), (SIDE, SIDE / 2));
        let at = |x: u32| {
            let pixel = &normal.rgba()[(x * 4) as usize..][..3];
            [0, 1, 2].map(|i| f32::from(pixel[i]) / 127.5 - 1.0)
        };
        // Half way up: the height is RELIEF / 2 * (1 - cos(2 pi u)), its slope there pi * RELIEF.
        let steepest = std::f32::consts::PI * RELIEF;
        let [x, y, z] = at(SIDE / 4);
        assert!((-x / z - steepest).abs() < 0.1 * steepest, "{x} {z} {steepest}");
        assert!(y.abs() < 0.01 && (at(SIDE * 3 / 4)[0] - steepest).abs() < 0.1 * steepest + 0.01);
        for flat in [0, SIDE / 2] {
            assert!(at(flat)[0].abs() < 0.02, "{:?}", at(flat));
        }
        let grey = Picture::new(3, 2, [90, 90, 90, 255].repeat(6));
        let flat = normals_by_lightness(&grey, 0.5, &Quiet).unwrap();
        assert!(flat.rgba().as_chunks().0.iter().all(|pixel| *pixel == [128, 128, 255, 255]));
    }

    #[test]
    fn bark_has_no_holes() {
        let whole = Arc::new(Picture::new(1, 2, vec![1, 2, 3, 255, 4, 5, 6, 255]));
        assert!(Arc::ptr_eq(&opaque(&whole), &whole));
        let holed = Arc::new(Picture::new(1, 2, vec![1, 2, 3, 0, 4, 5, 6, 255]));
        assert_eq!(opaque(&holed), whole);
    }
}
