//! Pictures: RGBA pixels, and what they are as PNG, JPEG and WebP.

mod encode;
mod format;
pub(crate) mod pieces;
mod recipe;
mod store;

use std::sync::{Arc, OnceLock};

pub use self::format::PictureFormat;
pub use self::recipe::recipe_in_picture;
pub use self::store::{DRAWING_SOURCE, PictureKey, PictureStore};

/// Bytes a pixel while a picture is compressed as PNG, besides those of its colours: the colours, filtered,
/// and the file, which moves to a larger place while it grows (measured).
pub const PNG_BYTES_PER_PIXEL: u64 = 8;

/// 8-bit RGBA pixels, rows from the top.
///
/// ```
/// use linden_base::picture::Picture;
/// let dot = Picture::new(1, 1, vec![112, 98, 84, 255]);
/// assert!(dot.png()?.starts_with(b"\x89PNG"));
/// # Ok::<(), linden_base::picture::PictureError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Picture {
    width: u32,
    height: u32,
    rgba: Vec<u8>,
    /// What [`Picture::encoded`] gave for each of [`PictureFormat::ALL`]: several exporters write the same
    /// pictures, and compressing them takes longer than growing most trees.
    encoded: [OnceLock<Vec<u8>>; PictureFormat::ALL.len()],
    /// What [`Picture::content`] gave.
    content: OnceLock<PictureKey>,
    /// Where files are kept that were made of it.
    store: Option<Arc<dyn PictureStore>>,
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
        Self {
            width,
            height,
            rgba,
            encoded: [const { OnceLock::new() }; PictureFormat::ALL.len()],
            content: OnceLock::new(),
            store: None,
        }
    }

    /// The same picture, whose files ([`Picture::encoded`]) are taken from a store, and kept there.
    #[must_use]
    pub fn kept_in(self, store: &Arc<dyn PictureStore>) -> Self {
        Self { store: Some(Arc::clone(store)), ..self }
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

    /// Bytes of its pixels, and of the files that [`Picture::encoded`] made of them so far.
    pub fn bytes(&self) -> u64 {
        let files = self.encoded.iter().filter_map(OnceLock::get).map(Vec::len);
        (self.rgba.len() + files.sum::<usize>()) as u64
    }

    /// Whether every pixel is opaque.
    pub fn is_opaque(&self) -> bool {
        self.rgba.as_chunks::<4>().0.iter().all(|p| p[3] == 255)
    }

    /// Whether no pixel has a colour.
    pub fn is_grey(&self) -> bool {
        self.rgba.as_chunks::<4>().0.iter().all(|&[r, g, b, _]| r == g && g == b)
    }

    /// The picture as PNG: [`Picture::encoded`].
    ///
    /// # Errors
    /// [`PictureError`].
    pub fn png(&self) -> Result<&[u8], PictureError> {
        self.encoded(PictureFormat::Png)
    }

    /// The picture as a file, compressed when it is first asked for: 8 bits per channel, no alpha channel
    /// where every pixel is opaque, one channel in place of three (PNG) where all are grey; nothing said about colour
    /// (a normal map has none). JPEG shows what is not opaque over white.
    ///
    /// # Errors
    /// [`PictureError`].
    pub fn encoded(&self, format: PictureFormat) -> Result<&[u8], PictureError> {
        let kept = &self.encoded[format as usize];
        if let Some(known) = kept.get() {
            return Ok(known);
        }
        let encoded = match &self.store {
            Some(store) => self.encoded_in(store.as_ref(), format)?,
            None => encode::encode(self, format, &encode::About::default())?,
        };
        Ok(kept.get_or_init(|| encoded))
    }

    /// As [`Picture::encoded`], in as few bytes as can be: it takes longer, and is not kept.
    ///
    /// # Errors
    /// [`PictureError`].
    pub fn small(&self, format: PictureFormat) -> Result<Vec<u8>, PictureError> {
        encode::encode(self, format, &encode::About { is_small: true, ..encode::About::default() })
    }

    /// As [`Picture::encoded`], for people to look at: a PNG is marked as sRGB, which others are anyhow, and
    /// the `recipe` of what is shown, one line of ASCII, is where [`recipe_in_picture`] finds it. It is left
    /// out where there is no room: see [`PictureFormat::has_room_for`]. Not kept.
    ///
    /// # Errors
    /// [`PictureError`].
    pub fn preview(&self, format: PictureFormat, recipe: Option<&str>) -> Result<Vec<u8>, PictureError> {
        let recipe = recipe.filter(|recipe| format.has_room_for(recipe));
        encode::encode(
            self,
            format,
            &encode::About { is_for_people: true, recipe, ..encode::About::default() },
        )
    }

    /// [`Picture::preview`] as PNG without a recipe.
    ///
    /// # Errors
    /// [`PictureError`].
    pub fn srgb_png(&self) -> Result<Vec<u8>, PictureError> {
        self.preview(PictureFormat::Png, None)
    }
}

/// Why a picture could not be written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PictureError {
    /// The pixels are not what the size says, or there are none.
    #[error("a picture of {width}×{height} pixels cannot be written: it has {bytes} bytes of pixels")]
    Bytes {
        /// Pixels per row.
        width: u32,
        /// Rows.
        height: u32,
        /// Bytes that there are.
        bytes: usize,
    },
    /// The encoder of PNG refused.
    #[error("a picture could not be written as PNG: {0}")]
    Png(#[from] png::EncodingError),
    /// Another encoder refused.
    #[error("a picture of {width}×{height} pixels could not be written as {format}: {source}")]
    Encode {
        /// What it was to be.
        format: &'static str,
        /// Pixels per row.
        width: u32,
        /// Rows.
        height: u32,
        /// Why.
        #[source]
        source: image::ImageError,
    },
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
    fn what_has_no_colour_has_one_channel_for_it() {
        let grey = |alpha| Picture::new(1, 2, vec![7, 7, 7, 255, 9, 9, 9, alpha]);
        assert_eq!(decoded(grey(255).png().unwrap()), (png::ColorType::Grayscale, vec![7, 9]));
        let with_alpha = vec![7, 255, 9, 200];
        assert_eq!(decoded(grey(200).png().unwrap()), (png::ColorType::GrayscaleAlpha, with_alpha));
        let nearly = Picture::new(1, 2, vec![7, 7, 7, 255, 9, 9, 8, 255]);
        assert_eq!(decoded(nearly.png().unwrap()), (png::ColorType::Rgb, vec![7, 7, 7, 9, 9, 8]));
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
