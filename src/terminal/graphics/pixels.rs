//! Pixels → PNG, and to half the size.

use std::borrow::Cow;

use super::EncodeError;
use crate::grid::{decode, encode};

/// RGBA, sRGB, not premultiplied.
pub(super) struct Pixels<'a> {
    pub width: u32,
    pub height: u32,
    pub rgba: Cow<'a, [u8]>,
}

impl<'a> Pixels<'a> {
    /// `width × height × 4` bytes.
    pub fn new(width: u32, height: u32, rgba: &'a [u8]) -> Self {
        Self { width, height, rgba: Cow::Borrowed(rgba) }
    }

    pub fn is_opaque(&self) -> bool {
        self.rgba.chunks_exact(4).all(|pixel| pixel[3] == 255)
    }

    /// 8 bits a channel; without alpha where there is none.
    pub fn png(&self) -> Result<Vec<u8>, EncodeError> {
        let (width, height) = (self.width, self.height);
        let refused = |source| EncodeError::Png { width, height, source };
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, width, height);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_compression(png::Compression::Balanced);
        let opaque = self.is_opaque();
        encoder.set_color(if opaque { png::ColorType::Rgb } else { png::ColorType::Rgba });
        let rgb: Cow<'_, [u8]> = if opaque {
            self.rgba.chunks_exact(4).flat_map(|pixel| [pixel[0], pixel[1], pixel[2]]).collect()
        } else {
            Cow::Borrowed(&self.rgba)
        };
        let mut writer = encoder.write_header().map_err(refused)?;
        writer.write_image_data(&rgb).map_err(refused)?;
        writer.finish().map_err(refused)?;
        Ok(bytes)
    }

    /// The mean of each 2×2 pixels, in linear light.
    pub fn halved(&self) -> Pixels<'static> {
        let light: [f32; 256] = std::array::from_fn(|i| decode(i as f32 / 255.0));
        let (width, height) = (self.width.div_ceil(2), self.height.div_ceil(2));
        let mut rgba = Vec::with_capacity(width as usize * height as usize * 4);
        for y in 0..height {
            for x in 0..width {
                let (mut sum, mut alpha) = ([0.0_f32; 3], 0.0_f32);
                for (dx, dy) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
                    let (x, y) = ((x * 2 + dx).min(self.width - 1), (y * 2 + dy).min(self.height - 1));
                    let pixel = &self.rgba[(y as usize * self.width as usize + x as usize) * 4..][..4];
                    let a = f32::from(pixel[3]);
                    for (sum, &c) in sum.iter_mut().zip(pixel) {
                        *sum += a * light[usize::from(c)];
                    }
                    alpha += a;
                }
                let c = sum.map(|c| if alpha > 0.0 { (encode(c / alpha) * 255.0 + 0.5) as u8 } else { 0 });
                rgba.extend_from_slice(&[c[0], c[1], c[2], (alpha / 4.0 + 0.5) as u8]);
            }
        }
        Pixels { width, height, rgba: Cow::Owned(rgba) }
    }
}
