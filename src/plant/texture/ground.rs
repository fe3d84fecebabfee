//! A patch of ground seen from some steps away: grass with worn places.

use rayon::prelude::*;

use super::periodic::{Octaves, smoothstep};
use linden_base::color::encode;
use linden_base::picture::Picture;
use linden_base::random::Key;

/// Pixels a side: half a centimetre each where the patch covers [`GROUND_TILE_M`].
const SIDE: usize = 512;

/// The side of the square that the picture shows, metres.
pub const GROUND_TILE_M: f32 = 2.5;

/// Linear colours of grass in shade and in light, and of bare earth.
const SHADE: [f32; 3] = [0.022, 0.034, 0.009];
const GRASS: [f32; 3] = [0.062, 0.08, 0.022];
const EARTH: [f32; 3] = [0.075, 0.058, 0.036];

/// sRGB, tileable both ways, and its mean as linear RGB.
pub fn ground(key: Key) -> (Picture, [f32; 3]) {
    let key = key.named("ground");
    let blades = Octaves::new(56, 56, 3, key.named("blades"));
    let tufts = Octaves::new(5, 5, 3, key.named("tufts"));
    let rows: Vec<(Vec<u8>, [f64; 3])> = (0..SIDE)
        .into_par_iter()
        .map(|y| {
            let v = (y as f32 + 0.5) / SIDE as f32;
            let (fine, coarse) = (blades.row(v, SIDE), tufts.row(v, SIDE));
            let mut pixels = Vec::with_capacity(4 * SIDE);
            let mut sum = [0.0; 3];
            for (fine, coarse) in fine.into_iter().zip(coarse) {
                let light = smoothstep(-0.7, 0.7, fine + 0.3 * coarse);
                let worn = 0.6 * smoothstep(0.1, 0.6, coarse - 0.5 * fine);
                for (channel, sum) in sum.iter_mut().enumerate() {
                    let grass = SHADE[channel] + (GRASS[channel] - SHADE[channel]) * light;
                    let color = grass + (EARTH[channel] * (0.6 + 0.5 * light) - grass) * worn;
                    *sum += f64::from(color);
                    pixels.push(libm::roundf(255.0 * encode(color)) as u8);
                }
                pixels.push(255);
            }
            (pixels, sum)
        })
        .collect();
    let mut rgba = Vec::with_capacity(4 * SIDE * SIDE);
    let mut mean = [0.0; 3];
    for (row, sum) in rows {
        rgba.extend(row);
        mean = [0, 1, 2].map(|i| mean[i] + sum[i] / (SIDE * SIDE) as f64);
    }
    (Picture::new(SIDE as u32, SIDE as u32, rgba), mean.map(|x| x as f32))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_tiles_and_its_mean_is_that_of_its_pixels() {
        let (picture, mean) = ground(Key::new(1));
        let rgba = picture.rgba().as_chunks::<4>().0;
        let of = |x: usize, y: usize| f32::from(rgba[y * SIDE + x][1]);
        let step = |a: &dyn Fn(usize) -> (f32, f32)| {
            (0..SIDE)
                .map(|i| {
                    let (p, q) = a(i);
                    (p - q).abs()
                })
                .sum::<f32>()
                / SIDE as f32
        };
        // Across the edge neighbours differ as much as they do inside.
        let inside = step(&|i| (of(100, i), of(101, i)));
        assert!(step(&|i| (of(SIDE - 1, i), of(0, i))) < 1.5 * inside);
        assert!(step(&|i| (of(i, SIDE - 1), of(i, 0))) < 1.5 * inside);
        for channel in 0..3 {
            let sum: f32 =
                rgba.iter().map(|p| linden_base::color::decode(f32::from(p[channel]) / 255.0)).sum();
            assert!((sum / rgba.len() as f32 - mean[channel]).abs() < 1e-3);
        }
    }
}
