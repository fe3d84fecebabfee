//! Where the bark of a trunk ends over the older one of its foot.
//!
//! The upper bark is torn open along lines up the branch that cross in lozenges, first where slow noise says so and
//! where the lower bark has its furrows: nowhere at the upper end of the picture, everywhere at the lower one. It is some
//! tiles high, and continues the one bark above it and the other one below.

use std::sync::Arc;

use glam::Vec3;
use rayon::prelude::*;

use super::{BarkError, BarkPictures};
use crate::texture::periodic::{Noise, Octaves, smoothstep};
use linden_base::color::{code, linear, luminance};
use linden_base::memory::bytes_of;
use linden_base::monitor::{Cancelled, Monitor};
use linden_base::picture::Picture;
use linden_base::random::Key;

/// How one bark is torn open over another one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Torn {
    /// How high the picture is, in tiles of the barks: 1 or more.
    pub tiles: u32,
    /// Where its randomness comes from.
    pub key: Key,
}

/// Half the width of an edge, as a share of the field's range.
const EDGE: f32 = 0.04;
/// How far the upper bark stands out over the lower one, as a share of the picture's width.
const LIFT: f32 = 0.006;
/// Light that is left just below an edge.
const SHADE: f32 = 0.72;

impl Torn {
    /// The pictures of `upper` torn open over those of `lower`, which are squares as large.
    ///
    /// # Errors
    /// [`BarkError`]: memory, or cancelled.
    pub fn over(
        &self,
        upper: &BarkPictures,
        lower: &BarkPictures,
        monitor: &dyn Monitor,
    ) -> Result<BarkPictures, BarkError> {
        let side = lower.base_color.width() as usize;
        let rows = self.tiles as usize * side;
        let pixels = rows * side;
        monitor.admit("tearing the bark", bytes_of::<([f32; 4], [u8; 8])>(pixels), "lower bark_size")?;
        let above = self.above_least(&lower.base_color, side, monitor)?;
        let open: Vec<f32> = above.iter().map(|above| smoothstep(-EDGE, EDGE, *above)).collect();
        let mut base_color = vec![255; 4 * pixels];
        let mut normal = vec![255; 4 * pixels];
        let both = base_color.par_chunks_mut(4 * side).zip(normal.par_chunks_mut(4 * side));
        both.enumerate().try_for_each(|(row, (colors, normals))| {
            monitor.check()?;
            let [higher, deeper] = [row.saturating_sub(1), (row + 1).min(rows - 1)].map(|row| row * side);
            let in_tile = row % side * side;
            let pixels = colors.as_chunks_mut::<4>().0.iter_mut().zip(normals.as_chunks_mut::<4>().0);
            for (column, (color, normal)) in pixels.enumerate() {
                let i = row * side + column;
                let light = |of: &BarkPictures| {
                    let [r, g, b, _] = of.base_color.rgba().as_chunks::<4>().0[in_tile + column];
                    Vec3::from(linear([r, g, b]))
                };
                let shade = 1.0 - (1.0 - SHADE) * (1.0 - smoothstep(EDGE, 4.0 * EDGE, above[i]));
                let [r, g, b] = light(upper).lerp(light(lower) * shade, open[i]).to_array().map(code);
                *color = [r, g, b, 255];
                let facing = |of: &BarkPictures| {
                    let [x, y, z, _] = of.normal.rgba().as_chunks::<4>().0[in_tile + column];
                    Vec3::new(f32::from(x), f32::from(y), f32::from(z)) / 127.5 - 1.0
                };
                let (left, right) = ((column + side - 1) % side, (column + 1) % side);
                let across = open[row * side + right] - open[row * side + left];
                let up = open[higher + column] - open[deeper + column];
                let edge = Vec3::new(across, up, 0.0) * (LIFT * side as f32 / 2.0);
                let facing = (facing(upper).lerp(facing(lower), open[i]) + edge).normalize_or(Vec3::Z);
                let [x, y, z] = facing.to_array().map(|c| (c * 127.5 + 128.0) as u8);
                *normal = [x, y, z, 255];
            }
            Ok::<_, Cancelled>(())
        })?;
        let picture = |rgba| Arc::new(Picture::new(side as u32, rows as u32, rgba));
        Ok(BarkPictures { base_color: picture(base_color), normal: picture(normal) })
    }

    /// How far each pixel's field is above what is torn at its height: open where it is more than 0.
    fn above_least(
        &self,
        lower: &Picture,
        side: usize,
        monitor: &dyn Monitor,
    ) -> Result<Vec<f32>, Cancelled> {
        let mut field = self.field(lower, side, monitor)?;
        let mut sorted = field.clone();
        sorted.par_sort_unstable_by(f32::total_cmp);
        let rows = self.tiles as usize * side;
        for (row, field) in field.chunks_mut(side).enumerate() {
            // Of the first and the last rows nothing, and everything.
            let share = smoothstep(0.02, 0.98, (row as f32 + 0.5) / rows as f32);
            let least = sorted[(((1.0 - share) * sorted.len() as f32) as usize).min(sorted.len() - 1)];
            let beyond = if share <= 0.0 || share >= 1.0 { 2.0 * (share - 0.5) } else { 0.0 };
            for at in field {
                *at += beyond * FAR - least;
            }
        }
        Ok(field)
    }

    /// Where it tears first: the highest.
    fn field(&self, lower: &Picture, side: usize, monitor: &dyn Monitor) -> Result<Vec<f32>, Cancelled> {
        let named = |purpose: &str| self.key.named(purpose);
        let tall = self.tiles;
        let rows = tall as usize * side;
        let patches = Octaves::new(5, 3 * tall, 3, named("patches"));
        let ragged = Octaves::new(24, 16 * tall, 3, named("ragged"));
        let seams = [("first seam", 7, 2), ("second seam", 9, 3)]
            .map(|(purpose, across, up)| Noise::new(across, up * tall, named(purpose)));
        let light = |&[r, g, b, _]: &[u8; 4]| luminance(linear([r, g, b]));
        let pixels = lower.rgba().as_chunks::<4>().0;
        let mean = pixels.iter().map(light).sum::<f32>() / pixels.len().max(1) as f32;
        let mut field = vec![0.0; rows * side];
        field.par_chunks_mut(side).enumerate().try_for_each(|(row, out)| {
            monitor.check()?;
            let v = 1.0 - (row as f32 + 0.5) / rows as f32;
            let (patches, ragged) = (patches.row(v, side), ragged.row(v, side));
            for (column, out) in out.iter_mut().enumerate() {
                let u = (column as f32 + 0.5) / side as f32 + 0.012 * ragged[column];
                let [a, b] = seams.each_ref().map(|seam| seam.at(u, v).abs());
                let seam = (1.0 - 4.0 * a.min(b)).max(0.0);
                let dark = 1.0 - (light(&pixels[row % side * side + column]) / mean.max(1e-6)).min(2.0);
                *out = 0.45 * seam + 0.7 * patches[column] + 0.2 * ragged[column] + 0.12 * dark;
            }
            Ok::<_, Cancelled>(())
        })?;
        Ok(field)
    }
}

/// More than any two places of a field differ.
const FAR: f32 = 8.0;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::texture::{Bark, BarkStyle};
    use linden_base::monitor::Quiet;

    const SIDE: usize = 128;
    const TILES: usize = 2;
    const TORN: Torn = Torn { tiles: TILES as u32, key: Key::new(3) };

    /// Barks of one colour each, which are flat: what is seen of which can be told.
    fn plain(color: [u8; 3]) -> BarkPictures {
        let picture = |[r, g, b]: [u8; 3]| {
            Arc::new(Picture::new(SIDE as u32, SIDE as u32, [r, g, b, 255].repeat(SIDE * SIDE)))
        };
        BarkPictures { base_color: picture(color), normal: picture([128, 128, 255]) }
    }

    #[test]
    fn it_is_closed_above_and_open_below_and_ever_more_open_between() {
        let pictures = TORN.over(&plain([220; 3]), &plain([40; 3]), &Quiet).unwrap();
        let size = [pictures.base_color.width(), pictures.base_color.height()];
        assert_eq!(size, [SIDE as u32, (TILES * SIDE) as u32]);
        let open = |rows: &[u8]| {
            rows.as_chunks::<4>().0.iter().filter(|pixel| pixel[0] < 130).count() as f32 * 4.0
                / rows.len() as f32
        };
        let quarters: Vec<f32> = pictures.base_color.rgba().chunks(SIDE * TILES * SIDE).map(open).collect();
        // A field that has no height of its own opens by the share: the mean of each quarter's is known.
        let expected = [0.03, 0.30, 0.70, 0.97];
        assert_eq!(quarters.len(), expected.len());
        for (found, expected) in quarters.iter().zip(expected) {
            assert!((found - expected).abs() < 0.12, "{quarters:?}");
        }
    }

    #[test]
    fn at_either_end_it_is_that_bark() {
        let draw =
            |style| Bark { size_px: SIDE as u32, ..Bark::new(style, Key::new(1)) }.draw(&Quiet).unwrap();
        let (upper, lower) = (draw(BarkStyle::Birch), draw(BarkStyle::Ridged));
        let found = TORN.over(&upper, &lower, &Quiet).unwrap();
        for (rows, like, its) in [(0, &upper, 0), (TILES * SIDE - 2, &lower, SIDE - 2)] {
            let two = |picture: &Picture, row: usize| picture.rgba()[4 * SIDE * row..][..8 * SIDE].to_vec();
            assert_eq!(two(&found.base_color, rows), two(&like.base_color, its));
            // Within what is lost where a rounded vector is made one of length 1 again.
            let (found, like) = (two(&found.normal, rows), two(&like.normal, its));
            let off = found.iter().zip(like).map(|(a, b)| a.abs_diff(b)).max();
            assert!(off <= Some(1), "{off:?}");
        }
    }

    #[test]
    fn edges_face_away_from_the_upper_bark_and_the_picture_continues_around() {
        let pictures = TORN.over(&plain([220; 3]), &plain([40; 3]), &Quiet).unwrap();
        let at = |picture: &Picture, x: usize, y: usize| i32::from(picture.rgba()[4 * (y * SIDE + x % SIDE)]);
        let mut seen = 0;
        for (x, y) in (0..SIDE).flat_map(|x| (0..TILES * SIDE).map(move |y| (x, y))) {
            let rise = at(&pictures.base_color, x + 1, y) - at(&pictures.base_color, x + SIDE - 1, y);
            let lean = at(&pictures.normal, x, y) - 128;
            // Darker, and so lower, to the right: it looks to the right. At the border columns too.
            if rise.abs() > 60 {
                assert!(lean * rise < 0, "{x} {y}: {lean} {rise}");
                seen += 1;
            }
        }
        assert!(seen > 500, "{seen}");
    }
}
