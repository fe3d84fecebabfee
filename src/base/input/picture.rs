//! Pictures that users bring: PNG files as pixels.

use std::io::Cursor;
use std::sync::Arc;

use png::{BitDepth, ColorType, Decoder, DecodingError, Limits, Transformations};

use crate::color::{decode, encode};
use crate::memory::OverMemory;
use crate::monitor::Monitor;
use crate::picture::Picture;

/// The largest side, pixels.
const MAX_SIDE_PX: u32 = 8192;
/// The most pixels.
const MAX_PIXELS: u64 = 64 << 20;
/// Deflate makes at most this many bytes of one (RFC 1951: 258 bytes from two bits).
const MOST_INFLATED: u64 = 1032;

/// A picture that was read from a file.
#[derive(Clone, Debug, PartialEq)]
pub struct UserPicture {
    /// Its pixels, whatever kind the file had.
    pub picture: Arc<Picture>,
    /// Whether any pixel is less than opaque: whether there is something to cut out.
    pub has_alpha: bool,
    /// Bytes of the file: about what the picture takes when it is written again.
    pub file_bytes: u64,
    /// The mean colour of what shows, sRGB.
    pub mean_color: [u8; 3],
}

/// Why a file gives no picture.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum UserPictureError {
    /// Something else than PNG.
    #[error("this is not a PNG picture: it does not begin as one; save it as PNG")]
    NotPng,
    /// Larger than anything that a leaf or bark needs.
    #[error("a picture of {width}×{height} pixels is too large: at most {MAX_SIDE_PX} a side and {most} million in all; scale it down", most = MAX_PIXELS >> 20)]
    TooLarge {
        /// Pixels per row.
        width: u32,
        /// Rows.
        height: u32,
    },
    /// A PNG that ends early or contradicts itself.
    #[error("this PNG picture is damaged ({0}); save it again")]
    Damaged(String),
    /// It would take more memory than there may be.
    #[error(transparent)]
    Memory(#[from] OverMemory),
}

impl From<DecodingError> for UserPictureError {
    fn from(error: DecodingError) -> Self {
        // The decoder's words quote nothing of the file but chunk names, which it escapes.
        Self::Damaged(crate::knob::printable(&error.to_string()))
    }
}

/// Reads a PNG of any kind: grey, palette and 16 bits become RGBA of 8 bits. Sizes are looked at
/// before anything is allocated for them.
///
/// ```
/// use linden_base::{monitor::Quiet, picture::Picture, input::read_picture};
/// let png = Picture::new(2, 1, vec![10, 200, 30, 255, 0, 0, 0, 0]);
/// let found = read_picture(png.png()?, &Quiet).unwrap();
/// assert!(found.has_alpha && *found.picture == png);
/// # Ok::<(), linden_base::picture::PngError>(())
/// ```
///
/// # Errors
/// [`UserPictureError`]: no PNG, too large, damaged, or too little memory.
pub fn read_picture(bytes: &[u8], monitor: &dyn Monitor) -> Result<UserPicture, UserPictureError> {
    if !bytes.starts_with(b"\x89PNG\r\n\x1a\n") {
        return Err(UserPictureError::NotPng);
    }
    let mut decoder = Decoder::new_with_limits(Cursor::new(bytes), Limits { bytes: 64 << 20 });
    decoder.set_ignore_text_chunk(true);
    decoder.set_ignore_iccp_chunk(true);
    decoder.set_transformations(Transformations::normalize_to_color8());
    let header = decoder.read_header_info()?;
    let (width, height) = header.size();
    let pixels = u64::from(width) * u64::from(height);
    if width.max(height) > MAX_SIDE_PX || pixels > MAX_PIXELS {
        return Err(UserPictureError::TooLarge { width, height });
    }
    let packed = u64::from(height) * header.raw_row_length() as u64;
    if packed > (bytes.len() as u64).saturating_mul(MOST_INFLATED) {
        return Err(UserPictureError::Damaged("it ends early".to_owned()));
    }
    // As decoded, and as kept.
    monitor.admit("reading a picture", pixels * 8, "scale the picture down")?;
    let mut reader = decoder.read_info()?;
    let size = reader.output_buffer_size().ok_or(UserPictureError::TooLarge { width, height })?;
    let mut decoded = vec![0; size];
    let info = reader.next_frame(&mut decoded)?;
    if (info.width, info.height, info.bit_depth) != (width, height, BitDepth::Eight) {
        return Err(UserPictureError::Damaged("its first frame is not the whole picture".to_owned()));
    }
    decoded.truncate(info.buffer_size());
    let rgba: Vec<u8> = match info.color_type {
        ColorType::Rgba => decoded,
        ColorType::Rgb => decoded.as_chunks().0.iter().flat_map(|&[r, g, b]| [r, g, b, 255]).collect(),
        ColorType::GrayscaleAlpha => {
            decoded.as_chunks().0.iter().flat_map(|&[grey, a]| [grey, grey, grey, a]).collect()
        }
        ColorType::Grayscale | ColorType::Indexed => {
            decoded.iter().flat_map(|&grey| [grey, grey, grey, 255]).collect()
        }
    };
    let has_alpha = rgba.as_chunks::<4>().0.iter().any(|p| p[3] < 255);
    let mean_color = mean_color(&rgba);
    let picture = Arc::new(Picture::new(width, height, rgba));
    Ok(UserPicture { picture, has_alpha, file_bytes: bytes.len() as u64, mean_color })
}

/// The mean of what shows, in linear light.
fn mean_color(rgba: &[u8]) -> [u8; 3] {
    let curve: Vec<f64> = (0..=255_u8).map(|c| f64::from(decode(f32::from(c) / 255.0))).collect();
    let (mut sums, mut weight) = ([0.0; 3], 0.0);
    for &[r, g, b, a] in rgba.as_chunks().0 {
        let share = f64::from(a);
        weight += share;
        for (sum, c) in sums.iter_mut().zip([r, g, b]) {
            *sum += share * curve[usize::from(c)];
        }
    }
    if weight == 0.0 {
        return [0; 3];
    }
    sums.map(|sum| (encode((sum / weight) as f32) * 255.0 + 0.5) as u8)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::monitor::Quiet;

    /// A PNG of any kind, by the encoder alone.
    fn file(width: u32, height: u32, color: ColorType, depth: BitDepth, data: &[u8]) -> Vec<u8> {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, width, height);
        encoder.set_color(color);
        encoder.set_depth(depth);
        if color == ColorType::Indexed {
            encoder.set_palette(vec![1, 2, 3, 40, 50, 60]);
            encoder.set_trns(vec![255, 7]);
        }
        encoder.write_header().unwrap().write_image_data(data).unwrap();
        bytes
    }

    #[test]
    fn every_kind_becomes_rgba() {
        use BitDepth::{Eight, One, Sixteen};
        type Case = (ColorType, BitDepth, &'static [u8], [u8; 8], bool);
        let cases: [Case; 6] = [
            (ColorType::Grayscale, Eight, &[9, 200], [9, 9, 9, 255, 200, 200, 200, 255], false),
            (ColorType::Grayscale, One, &[0b0100_0000], [0, 0, 0, 255, 255, 255, 255, 255], false),
            (ColorType::GrayscaleAlpha, Eight, &[9, 3, 200, 255], [9, 9, 9, 3, 200, 200, 200, 255], true),
            (ColorType::Rgb, Eight, &[1, 2, 3, 4, 5, 6], [1, 2, 3, 255, 4, 5, 6, 255], false),
            (
                ColorType::Rgb,
                Sixteen,
                &[1, 99, 2, 99, 3, 99, 4, 0, 5, 0, 6, 0],
                [1, 2, 3, 255, 4, 5, 6, 255],
                false,
            ),
            (ColorType::Indexed, One, &[0b0100_0000], [1, 2, 3, 255, 40, 50, 60, 7], true),
        ];
        for (color, depth, data, expected, has_alpha) in cases {
            let found = read_picture(&file(2, 1, color, depth, data), &Quiet).unwrap();
            assert_eq!(
                (found.picture.rgba(), found.has_alpha),
                (&expected[..], has_alpha),
                "{color:?} {depth:?}"
            );
        }
    }

    #[test]
    fn what_is_no_picture_is_said_to_be_none() {
        for bytes in [&b""[..], b"\x89PNG", b"\xff\xd8\xff\xe0 a photograph", b"<svg/>"] {
            assert_eq!(read_picture(bytes, &Quiet), Err(UserPictureError::NotPng));
        }
        let whole = file(20, 20, ColorType::Grayscale, BitDepth::Eight, &[7; 400]);
        for length in 8..whole.len() - 12 {
            let error = read_picture(&whole[..length], &Quiet).unwrap_err();
            assert!(matches!(error, UserPictureError::Damaged(_)), "{length}: {error}");
        }
    }

    #[test]
    fn headers_are_not_believed() {
        /// A header alone: the signature, IHDR with its checksum, and nothing.
        fn header(width: u32, height: u32) -> Vec<u8> {
            let mut bytes = Vec::new();
            let mut encoder = png::Encoder::new(&mut bytes, width, height);
            encoder.set_color(ColorType::Rgba);
            drop(encoder.write_header().unwrap());
            bytes
        }
        for (width, height) in [(40_000, 40_000), (8193, 1), (1, u32::MAX >> 1)] {
            let error = read_picture(&header(width, height), &Quiet).unwrap_err();
            assert_eq!(error, UserPictureError::TooLarge { width, height });
            assert!(error.to_string().contains("8192"), "{error}");
        }
        assert!(matches!(read_picture(&header(8000, 8000), &Quiet), Err(UserPictureError::Damaged(_))));
    }

    #[test]
    fn pictures_ask_for_their_memory() {
        struct Poor;
        impl Monitor for Poor {
            fn is_cancelled(&self) -> bool {
                false
            }
            fn advance(&self, _: crate::monitor::Phase, _: u64, _: Option<u64>) {}
            fn memory_limit(&self) -> u64 {
                1000
            }
        }
        let bytes = file(100, 100, ColorType::Grayscale, BitDepth::Eight, &[7; 10_000]);
        assert!(matches!(read_picture(&bytes, &Poor), Err(UserPictureError::Memory(_))));
    }
}
