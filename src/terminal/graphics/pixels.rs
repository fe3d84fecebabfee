//! Pixels → PNG, and to fewer pixels.

use std::borrow::Cow;
use std::sync::LazyLock;

use super::EncodeError;
use crate::grid::{Image, bytes};

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
    pub fn png(&self, filter: png::Filter) -> Result<Vec<u8>, EncodeError> {
        let (width, height) = (self.width, self.height);
        let refused = |source| EncodeError::Png { width, height, source };
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, width, height);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_compression(png::Compression::Balanced);
        encoder.set_filter(filter);
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

    /// Rounds channels to 32 shades, black and white included; what is wholly transparent has no
    /// colour.
    pub fn coarsen(&mut self) {
        let shades: [u8; 256] = std::array::from_fn(|c| ((c * 31 + 127) / 255 * 255 / 31) as u8);
        for pixel in self.rgba.to_mut().chunks_exact_mut(4) {
            if pixel[3] == 0 {
                pixel.fill(0);
            }
            for c in pixel {
                *c = shades[usize::from(*c)];
            }
        }
    }

    /// The same picture with sides of `factor` (below 1) their length: the means of the pixels, in
    /// linear light.
    pub fn reduced(&self, factor: f64) -> Result<Pixels<'static>, EncodeError> {
        let side = |pixels: u32| ((f64::from(pixels) * factor) as u32).clamp(1, pixels);
        let (width, height) = (side(self.width), side(self.height));
        let image = Image::new(self.width, self.height, &self.rgba)?;
        let mut rgba = Vec::with_capacity(width as usize * height as usize * 4);
        for light in image.averaged(width as usize, height as usize) {
            let unmixed =
                |c: f32| if light.alpha > 0.0 { CODES[(c / light.alpha * STEPS) as usize & MASK] } else { 0 };
            rgba.extend(light.rgb.map(unmixed));
            rgba.push((light.alpha * 255.0 + 0.5) as u8);
        }
        Ok(Pixels { width, height, rgba: Cow::Owned(rgba) })
    }
}

/// sRGB bytes by linear light, in steps so fine that in the darkest tones five of them are one byte.
static CODES: LazyLock<Vec<u8>> =
    LazyLock::new(|| (0..=MASK).map(|i| bytes([(i as f32 + 0.5) / STEPS; 3])[0]).collect());
/// Steps from black to white; there is room above for what rounding adds.
const STEPS: f32 = 16_384.0;
const MASK: usize = 0x7fff;
