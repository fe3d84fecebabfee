//! Moss and algae on a bark's picture.
//!
//! Cushions stand where a field of tufts, slow patches and the bark's own furrows is highest, over the share of
//! the picture that is asked for; between them algae tint the bark. The field is the same whatever the share: what
//! a lower share covers, a higher one covers too, so that pictures of several shares fit each other at their borders.

use glam::Vec3;
use rayon::prelude::*;

use super::{BarkError, quantile};
use crate::texture::periodic::{Cells, Noise, Octaves, smoothstep};
use linden_base::color::{code, linear, luminance};
use linden_base::memory::bytes_of;
use linden_base::monitor::{Cancelled, Monitor};
use linden_base::picture::Picture;
use linden_base::random::Key;

/// How mossy a bark is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moss {
    /// The share of the picture that cushions cover, 0 to 1.
    pub share: f32,
    /// The mean colour of cushions, sRGB.
    pub color: [u8; 3],
    /// How often the picture is halved: what is soft needs fewer pixels.
    pub halvings: u32,
    /// Where its randomness comes from.
    pub key: Key,
}

/// A picture is halved no further, pixels.
const SMALLEST_PX: u32 = 64;
/// How far the algae between full cushions tint the bark.
const FILM: f32 = 0.6;
/// Half the width of a cushion's edge, as a share of the field's range.
const EDGE: f32 = 0.05;

impl Moss {
    /// How far the bark between cushions is tinted by algae, 0 to 1.
    pub fn film(&self) -> f32 {
        FILM * self.share.clamp(0.0, 1.0).sqrt()
    }

    /// A picture of bark with moss on it, in colours alone.
    ///
    /// # Errors
    /// [`BarkError`]: memory, or cancelled.
    pub fn grow_on(&self, bark: &Picture, monitor: &dyn Monitor) -> Result<Picture, BarkError> {
        let pixels = bark.rgba().len() / 4;
        monitor.admit("growing moss", bytes_of::<(Vec3, [f32; 3], [u8; 8])>(pixels), "lower bark_size")?;
        let (light, [width, height]) = self.linear(bark);
        let field = self.field(&light, [width, height], monitor)?;
        let least = quantile(&field, 1.0 - self.share.clamp(0.0, 1.0));
        let (soft, grain) = (self.noise("soft", 7, 2), self.noise("grain", 90, 2));
        let green = Vec3::from(linear(self.color));
        let film = self.film();
        let mut rgba = vec![255; width * height * 4];
        rgba.par_chunks_mut(4 * width).enumerate().try_for_each(|(row, out)| {
            monitor.check()?;
            let v = 1.0 - (row as f32 + 0.5) / height as f32;
            let (soft, grain) = (soft.row(v, width), grain.row(v, width));
            for (column, out) in out.as_chunks_mut::<4>().0.iter_mut().enumerate() {
                let (bark, above) = (light[row * width + column], field[row * width + column] - least);
                let shade = 1.0 - 0.35 * smoothstep(-3.0 * EDGE, 0.0, above) * f32::from(self.share > 0.0);
                let bare = bark.lerp(algae(bark), film * (0.75 + 0.5 * soft[column]).clamp(0.0, 1.0)) * shade;
                // Cushions are dark at their edges and yellower where they are young.
                let young = Vec3::new(1.35, 1.12, 0.8);
                let hue = green * Vec3::ONE.lerp(young, (0.5 + 0.9 * soft[column]).clamp(0.0, 1.0));
                let rise = 0.55 + 0.6 * smoothstep(-EDGE, 6.0 * EDGE, above);
                let cushion = hue * (rise * (1.0 + 0.75 * grain[column]));
                let covered = smoothstep(-EDGE, EDGE, above) * f32::from(self.share > 0.0);
                let [r, g, b] = bare.lerp(cushion, covered).to_array().map(|c| code(c.clamp(0.0, 1.0)));
                *out = [r, g, b, 255];
            }
            Ok::<_, Cancelled>(())
        })?;
        Ok(Picture::new(width as u32, height as u32, rgba))
    }

    /// The mean colour where the bark has one, linear.
    pub fn mean(&self, bark: [f32; 3]) -> [f32; 3] {
        let (bark, green) = (Vec3::from(bark), Vec3::from(linear(self.color)));
        bark.lerp(algae(bark), 0.75 * self.film()).lerp(green, self.share.clamp(0.0, 1.0)).to_array()
    }

    /// Octaves that are the same whatever the share.
    fn noise(&self, purpose: &str, lattice: u32, octaves: u32) -> Octaves {
        Octaves::new(lattice, lattice, octaves, self.key.named(purpose))
    }

    /// The bark's pixels in linear light, halved as often as is asked for; width and height.
    fn linear(&self, bark: &Picture) -> (Vec<Vec3>, [usize; 2]) {
        let pixel = |&[r, g, b, _]: &[u8; 4]| Vec3::from(linear([r, g, b]));
        let mut light: Vec<Vec3> = bark.rgba().as_chunks().0.iter().map(pixel).collect();
        let mut size = [bark.width(), bark.height()];
        for _ in 0..self.halvings {
            if size.iter().any(|&side| !side.is_multiple_of(2) || side < 2 * SMALLEST_PX) {
                break;
            }
            let width = size[0] as usize;
            size = size.map(|side| side / 2);
            let half = |i: usize| {
                let (row, column) = (i / size[0] as usize, i % size[0] as usize);
                let first = 2 * row * width + 2 * column;
                0.25 * (light[first] + light[first + 1] + light[first + width] + light[first + width + 1])
            };
            light = (0..size[0] as usize * size[1] as usize).map(half).collect();
        }
        (light, size.map(|side| side as usize))
    }

    /// Where cushions stand first: the highest.
    fn field(
        &self,
        light: &[Vec3],
        [width, height]: [usize; 2],
        monitor: &dyn Monitor,
    ) -> Result<Vec<f32>, Cancelled> {
        let tufts = Cells::new(19, 19, 0.9, self.key.named("tufts"));
        let patches = self.noise("patches", 4, 3);
        let (bend_u, bend_v) =
            (Noise::new(24, 24, self.key.named("bend u")), Noise::new(24, 24, self.key.named("bend v")));
        let mean =
            light.iter().map(|bark| luminance(bark.to_array())).sum::<f32>() / light.len().max(1) as f32;
        let mut field = vec![0.0; width * height];
        field.par_chunks_mut(width).enumerate().try_for_each(|(row, out)| {
            monitor.check()?;
            let v = 1.0 - (row as f32 + 0.5) / height as f32;
            let patches = patches.row(v, width);
            for (column, out) in out.iter_mut().enumerate() {
                let u = (column as f32 + 0.5) / width as f32;
                let (bu, bv) = (u + 0.02 * bend_u.at(u, v), v + 0.02 * bend_v.at(u, v));
                // Moss holds in furrows, which are dark.
                let dark =
                    1.0 - (luminance(light[row * width + column].to_array()) / mean.max(1e-6)).min(2.0);
                let tuft = (tufts.at(bu, bv).border * 14.0).min(1.0);
                *out = 0.5 * tuft + 0.9 * patches[column] + 0.22 * dark;
            }
            Ok::<_, Cancelled>(())
        })?;
        Ok(field)
    }
}

/// Bark under a film of algae: as light and dark as it is, and yellower than moss.
fn algae(bark: Vec3) -> Vec3 {
    luminance(bark.to_array()) * Vec3::new(1.02, 1.22, 0.62)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::texture::{Bark, BarkStyle};
    use linden_base::monitor::Quiet;

    fn moss(share: f32) -> Moss {
        Moss { share, color: [70, 92, 30], halvings: 0, key: Key::new(4) }
    }

    /// Pixels far nearer to green than the bark is: those where green outweighs red by a fifth.
    fn green(picture: &Picture) -> Vec<bool> {
        let is_green = |&[r, g, _, _]: &[u8; 4]| f32::from(g) > 1.2 * f32::from(r);
        picture.rgba().as_chunks().0.iter().map(is_green).collect()
    }

    #[test]
    fn cushions_cover_what_is_asked_for_and_more_of_them_the_same_places() {
        // Grey, so that algae alone cannot be told from moss by its lightness.
        let bark = Picture::new(256, 128, [120, 112, 104, 255].repeat(256 * 128));
        let covers = [0.2, 0.5, 0.85].map(|share| {
            let mossy = moss(share).grow_on(&bark, &Quiet).unwrap();
            let changed: Vec<u8> = mossy.rgba().as_chunks::<4>().0.iter().map(|p| p[2]).collect();
            // Blue is far lower in moss than in bark with algae.
            changed.iter().map(|&blue| blue < 62).collect::<Vec<bool>>()
        });
        for (cover, share) in covers.iter().zip([0.2, 0.5, 0.85]) {
            let found = cover.iter().filter(|is| **is).count() as f32 / cover.len() as f32;
            assert!((found - share).abs() < 0.1, "{found} for {share}");
        }
        for pair in covers.windows(2) {
            let lost = pair[0].iter().zip(&pair[1]).filter(|(few, many)| **few && !**many).count();
            assert!(lost * 100 < pair[0].len(), "{lost} pixels are mossy at the lower share alone");
        }
    }

    #[test]
    fn it_continues_across_the_edges_of_the_picture() {
        let bark = Bark { size_px: 128, ..Bark::new(BarkStyle::Ridged, Key::new(1)) }.draw(&Quiet).unwrap();
        let mossy = moss(0.5).grow_on(&bark.base_color, &Quiet).unwrap();
        let at = |x: u32, y: u32| i32::from(mossy.rgba()[((y * 128 + x) * 4 + 1) as usize]);
        let step = |a: u32, b: u32| (0..128).map(|y| (at(a, y) - at(b, y)).abs()).sum::<i32>();
        let rows = |a: u32, b: u32| (0..128).map(|x| (at(x, a) - at(x, b)).abs()).sum::<i32>();
        let inside = (0..127).map(|x| step(x, x + 1)).max().unwrap();
        assert!(step(127, 0) <= inside && rows(127, 0) <= (0..127).map(|y| rows(y, y + 1)).max().unwrap());
    }

    #[test]
    fn without_a_share_the_bark_stays_and_halves_are_as_green() {
        let bark = Bark { size_px: 256, ..Bark::new(BarkStyle::Plated, Key::new(1)) }.draw(&Quiet).unwrap();
        assert_eq!(moss(0.0).grow_on(&bark.base_color, &Quiet).unwrap().rgba(), bark.base_color.rgba());
        let whole = moss(0.6).grow_on(&bark.base_color, &Quiet).unwrap();
        let half = Moss { halvings: 1, ..moss(0.6) }.grow_on(&bark.base_color, &Quiet).unwrap();
        assert_eq!([half.width(), half.height()], [128, 128]);
        let share = |picture: &Picture| {
            let green = green(picture);
            green.iter().filter(|is| **is).count() as f32 / green.len() as f32
        };
        assert!((share(&whole) - share(&half)).abs() < 0.08, "{} {}", share(&whole), share(&half));
        // As forecast, within what cushions' light and dark are worth.
        let mean = |picture: &Picture, channel: usize| {
            let sum: f32 = picture
                .rgba()
                .as_chunks::<4>()
                .0
                .iter()
                .map(|&[r, g, b, _]| linear([r, g, b])[channel])
                .sum();
            sum / (picture.rgba().len() / 4) as f32
        };
        let bark_mean = [0, 1, 2].map(|channel| mean(&bark.base_color, channel));
        let expected = moss(0.6).mean(bark_mean);
        for channel in 0..3 {
            let found = mean(&whole, channel);
            assert!((found / expected[channel] - 1.0).abs() < 0.3, "{channel}: {found} {expected:?}");
        }
    }
}
