//! Pictures: RGBA pixels, and what they are as PNG.

use std::io::{self, Read, Seek, SeekFrom};
use std::sync::OnceLock;

/// Bytes a pixel while a picture is compressed, besides those of its colours: the colours, filtered, and the
/// file, which moves to a larger place while it grows (measured).
pub const PNG_BYTES_PER_PIXEL: u64 = 8;

/// 8-bit RGBA pixels, rows from the top.
///
/// ```
/// use linden_base::picture::Picture;
/// let dot = Picture::new(1, 1, vec![112, 98, 84, 255]);
/// assert!(dot.png()?.starts_with(b"\x89PNG"));
/// # Ok::<(), linden_base::picture::PngError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Picture {
    width: u32,
    height: u32,
    rgba: Vec<u8>,
    /// What [`Picture::png`] gave: several exporters write the same pictures, and compressing them
    /// takes longer than growing most trees.
    png: OnceLock<Vec<u8>>,
}

/// Equal pixels: what was already compressed does not count.
impl PartialEq for Picture {
    fn eq(&self, other: &Self) -> bool {
        (self.width, self.height, &self.rgba) == (other.width, other.height, &other.rgba)
    }
}

impl Eq for Picture {}

impl Picture {
    /// `width × height` pixels of four bytes, rows from the top, not premultiplied. Whether the bytes
    /// are as many is checked where they are used.
    pub const fn new(width: u32, height: u32, rgba: Vec<u8>) -> Self {
        Self { width, height, rgba, png: OnceLock::new() }
    }

    /// Pixels per row.
    pub const fn width(&self) -> u32 {
        self.width
    }

    /// Rows.
    pub const fn height(&self) -> u32 {
        self.height
    }

    /// `width × height × 4` bytes, not premultiplied.
    pub fn rgba(&self) -> &[u8] {
        &self.rgba
    }

    /// The picture as PNG, compressed when it is first asked for: 8 bits per channel, no alpha channel
    /// where every pixel is opaque, nothing said about colour (a normal map has none).
    ///
    /// # Errors
    /// When the picture's byte count is not `width × height × 4`, or a side is 0.
    pub fn png(&self) -> Result<&[u8], PngError> {
        if let Some(known) = self.png.get() {
            return Ok(known);
        }
        let encoded = self.encode(false, None)?;
        Ok(self.png.get_or_init(|| encoded))
    }

    /// As [`Picture::png`], marked as sRGB: for pictures that people look at. Not kept.
    ///
    /// # Errors
    /// As [`Picture::png`].
    pub fn srgb_png(&self) -> Result<Vec<u8>, PngError> {
        self.encode(true, None)
    }

    /// As [`Picture::srgb_png`], with the recipe of what it shows, one line of ASCII, as a text that
    /// [`recipe_in_png`] finds.
    ///
    /// # Errors
    /// As [`Picture::png`].
    pub fn srgb_png_of(&self, recipe: &str) -> Result<Vec<u8>, PngError> {
        self.encode(true, Some(recipe))
    }

    fn encode(&self, is_srgb: bool, recipe: Option<&str>) -> Result<Vec<u8>, PngError> {
        let Self { width, height, ref rgba, .. } = *self;
        let expected = (width as usize).checked_mul(height as usize).and_then(|n| n.checked_mul(4));
        if expected != Some(rgba.len()) {
            return Err(PngError::Bytes { width, height, bytes: rgba.len() });
        }
        let pixels = rgba.as_chunks::<4>().0;
        let opaque = pixels.iter().all(|p| p[3] == 255);
        let mut bytes = Vec::with_capacity(rgba.len() / 2);
        let mut encoder = png::Encoder::new(&mut bytes, width, height);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_color(if opaque { png::ColorType::Rgb } else { png::ColorType::Rgba });
        if is_srgb {
            encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
        }
        if let Some(recipe) = recipe {
            encoder.add_text_chunk(RECIPE.to_owned(), recipe.to_owned())?;
        }
        let mut writer = encoder.write_header()?;
        if opaque {
            let rgb: Vec<u8> = pixels.iter().flat_map(|&[r, g, b, _]| [r, g, b]).collect();
            writer.write_image_data(&rgb)?;
        } else {
            writer.write_image_data(rgba)?;
        }
        writer.finish()?;
        Ok(bytes)
    }
}

/// The keyword of a recipe among a PNG's texts.
const RECIPE: &str = "linden recipe";
/// No recipe is longer.
const LONGEST_RECIPE_BYTES: u64 = 16 << 20;

/// The recipe that [`Picture::srgb_png_of`] put into a PNG. Reads what stands before the pixels.
///
/// # Errors
/// What reading failed with; other files are no error.
pub fn recipe_in_png(file: &mut (impl Read + Seek + ?Sized)) -> io::Result<Option<String>> {
    let mut opening = [0; 8];
    file.read_exact(&mut opening)?;
    if opening != *b"\x89PNG\r\n\x1a\n" {
        return Ok(None);
    }
    loop {
        // Length, kind, data, sum.
        let mut head = [0; 8];
        file.read_exact(&mut head)?;
        let [a, b, c, d, kind @ ..] = head;
        let length = u32::from_be_bytes([a, b, c, d]);
        match &kind {
            b"IDAT" | b"IEND" => return Ok(None),
            b"tEXt" if u64::from(length) <= LONGEST_RECIPE_BYTES => {
                let mut text = Vec::new();
                Read::take(&mut *file, length.into()).read_to_end(&mut text)?;
                let carried = text.strip_prefix(RECIPE.as_bytes()).and_then(|rest| rest.strip_prefix(b"\0"));
                if let Some(recipe) = carried {
                    return Ok(String::from_utf8(recipe.to_vec()).ok());
                }
                file.seek(SeekFrom::Current(4))?;
            }
            _ => drop(file.seek(SeekFrom::Current(i64::from(length) + 4))?),
        }
    }
}

/// Why a picture could not be written as PNG.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PngError {
    /// The pixels are not what the size says.
    #[error("a picture of {width}×{height} pixels cannot be written as PNG: it has {bytes} bytes of pixels")]
    Bytes {
        /// Pixels per row.
        width: u32,
        /// Rows.
        height: u32,
        /// Bytes that there are.
        bytes: usize,
    },
    /// The encoder refused.
    #[error("a picture could not be written as PNG: {0}")]
    Encode(#[from] png::EncodingError),
}

#[cfg(test)]
mod tests {
    use super::*;

    fn decoded(bytes: &[u8]) -> (png::ColorType, Vec<u8>) {
        let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().unwrap();
        let mut out = vec![0; reader.output_buffer_size().unwrap()];
        let info = reader.next_frame(&mut out).unwrap();
        out.truncate(info.buffer_size());
        (info.color_type, out)
    }

    #[test]
    fn pixels_come_back() {
        let rgba: Vec<u8> = (0..3 * 2 * 4).map(|i| (i * 11) as u8).collect();
        let bytes = Picture::new(3, 2, rgba.clone()).srgb_png().unwrap();
        assert_eq!(decoded(&bytes), (png::ColorType::Rgba, rgba));
    }

    #[test]
    fn an_opaque_picture_has_no_alpha_channel() {
        let bytes = Picture::new(1, 2, vec![1, 2, 3, 255, 4, 5, 6, 255]).srgb_png().unwrap();
        assert_eq!(decoded(&bytes), (png::ColorType::Rgb, vec![1, 2, 3, 4, 5, 6]));
    }

    #[test]
    fn a_recipe_is_found_before_the_pixels() {
        let picture = Picture::new(1, 2, vec![1, 2, 3, 255, 4, 5, 6, 255]);
        let recipe = r#"{"id":"fir","about":"\u00f6"}"#;
        let png = picture.srgb_png_of(recipe).unwrap();
        assert_eq!(decoded(&png), decoded(&picture.srgb_png().unwrap()));
        let pixels = png.windows(4).position(|kind| kind == b"IDAT").unwrap();
        let read = |bytes: &[u8]| recipe_in_png(&mut std::io::Cursor::new(bytes.to_vec()));
        assert_eq!(read(&png[..pixels]).unwrap().as_deref(), Some(recipe), "the pixels are not needed");
        assert_eq!(read(&picture.srgb_png().unwrap()).unwrap(), None);
        assert_eq!(read(b"no picture at all").unwrap(), None);
        assert!(read(&png[..20]).is_err());
    }

    #[test]
    fn lies_about_the_size_are_errors() {
        let error = Picture::new(3, 2, vec![0; 23]).srgb_png().unwrap_err();
        assert!(error.to_string().contains("3×2"), "{error}");
        assert!(Picture::new(0, 0, vec![]).srgb_png().is_err());
        assert!(Picture::new(u32::MAX, u32::MAX, vec![]).srgb_png().is_err());
    }

    #[test]
    fn png_is_kept_and_says_nothing_about_colour() {
        let picture = Picture::new(2, 1, vec![1, 2, 3, 255, 4, 5, 6, 7]);
        let first = picture.png().unwrap();
        assert_eq!(decoded(first), (png::ColorType::Rgba, vec![1, 2, 3, 255, 4, 5, 6, 7]));
        assert!(std::ptr::eq(first, picture.png().unwrap()));
        assert!(!first.windows(4).any(|chunk| chunk == b"sRGB"));
        assert!(picture.srgb_png().unwrap().windows(4).any(|chunk| chunk == b"sRGB"));
        assert_eq!(picture, Picture::new(2, 1, picture.rgba().to_vec()));
    }
}
