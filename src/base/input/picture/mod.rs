//! Pictures that users bring, as pixels: PNG, JPEG, WebP and TGA files.

mod format;
mod jpeg;
mod open;
mod webp;

use std::sync::Arc;

use image::metadata::Orientation;
use image::{ColorType, DynamicImage, ImageDecoder, ImageError};

use self::format::{Readable, other_format};
use self::open::{Opened, open};
use crate::color::{code, decode};
use crate::knob::printable;
use crate::memory::OverMemory;
use crate::monitor::Monitor;
use crate::picture::Picture;

/// What may be read, for messages of those who expected it.
pub const A_PICTURE: &str = "a picture (PNG, JPEG, WebP or TGA)";
/// The largest side, pixels.
const MAX_SIDE_PX: u32 = 8192;
/// The most pixels.
const MAX_PIXELS: u64 = 64 << 20;

/// Whether a file is a picture by its content.
pub fn is_picture(bytes: &[u8]) -> bool {
    Readable::of_content(bytes).is_some()
}

/// Whether a file is a picture by its content, or claims to be one by its name.
pub(super) fn claims_to_be_picture(name: &str, bytes: &[u8]) -> bool {
    is_picture(bytes) || Readable::of_name(name).is_some()
}

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
    /// No picture of any format that is known.
    #[error("this is not a picture that linden reads; save it as PNG, JPEG, WebP or TGA")]
    NotPicture,
    /// A picture in a format that is not read.
    #[error("this is a {0} picture, which linden does not read; save it as PNG, JPEG, WebP or TGA")]
    OtherFormat(&'static str),
    /// The colours of a printing press.
    #[error("this JPEG picture is in CMYK, the inks of a printing press; save it as RGB")]
    Cmyk,
    /// More than one picture.
    #[error("this WebP file is an animation; save one picture of it")]
    Animated,
    /// Larger than anything that a leaf or bark needs.
    #[error("a picture of {width}×{height} pixels is too large: at most {MAX_SIDE_PX} a side and {most} million in all; scale it down", most = MAX_PIXELS >> 20)]
    TooLarge {
        /// Pixels per row.
        width: u32,
        /// Rows.
        height: u32,
    },
    /// A file that ends early or contradicts itself.
    #[error("this {format} picture is damaged ({problem}); save it again")]
    Damaged {
        /// `PNG`, `JPEG`, `WebP`, `TGA`.
        format: &'static str,
        /// What is wrong.
        problem: String,
    },
    /// A rare kind of a format.
    #[error("this {format} picture is of a kind that linden does not read ({problem}); save it as PNG")]
    RareKind {
        /// `PNG`, `JPEG`, `WebP`, `TGA`.
        format: &'static str,
        /// What is not read.
        problem: String,
    },
    /// It would take more memory than there may be.
    #[error(transparent)]
    Memory(#[from] OverMemory),
}

impl UserPictureError {
    /// What a decoder said.
    fn of(format: Readable, error: &ImageError) -> Self {
        let (format, problem) = (format.name(), printable(&error.to_string()));
        match error {
            ImageError::Unsupported(_) => Self::RareKind { format, problem },
            _ => Self::Damaged { format, problem },
        }
    }

    fn ends_early(format: Readable) -> Self {
        Self::Damaged { format: format.name(), problem: "it ends early".to_owned() }
    }
}

/// Reads a picture of any kind: grey, palette and 16 bits become RGBA of 8 bits, upright as a camera's Exif
/// data says. Sizes are looked at before anything is allocated for them. The content tells the format; `name`
/// decides where it does not: a TGA may have no mark. Colour profiles are not looked at: colours are sRGB.
///
/// ```
/// use linden_base::{monitor::Quiet, picture::Picture, input::read_picture};
/// let leaf = Picture::new(2, 1, vec![10, 200, 30, 255, 0, 0, 0, 0]);
/// let found = read_picture("leaf.png", leaf.png()?, &Quiet).unwrap();
/// assert!(found.has_alpha && *found.picture == leaf);
/// # Ok::<(), linden_base::picture::PictureError>(())
/// ```
///
/// # Errors
/// [`UserPictureError`]: no picture, a kind that is not read, too large, damaged, or too little memory.
pub fn read_picture(
    name: &str,
    bytes: &[u8],
    monitor: &dyn Monitor,
) -> Result<UserPicture, UserPictureError> {
    let format = Readable::of_content(bytes)
        .or_else(|| Readable::of_name(name).filter(|&format| format == Readable::Tga))
        .ok_or_else(|| {
            other_format(bytes).map_or(UserPictureError::NotPicture, UserPictureError::OtherFormat)
        })?;
    let refused = |error: ImageError| UserPictureError::of(format, &error);
    let Opened { mut decoder, pixels, scratch_bytes } = open(format, bytes)?;
    let orientation = decoder.orientation().map_err(refused)?;
    let needs = needed_bytes(pixels, decoder.as_ref(), scratch_bytes, orientation);
    monitor.admit("reading a picture", needs, "scale the picture down")?;
    let decoded = DynamicImage::from_decoder(decoder).map_err(refused)?;
    let mut upright = DynamicImage::from(decoded.into_rgba8());
    upright.apply_orientation(orientation);
    let (width, height, rgba) = (upright.width(), upright.height(), upright.into_rgba8().into_raw());
    let has_alpha = rgba.as_chunks::<4>().0.iter().any(|p| p[3] < 255);
    let mean_color = mean_color(&rgba);
    let picture = Arc::new(Picture::new(width, height, rgba));
    Ok(UserPicture { picture, has_alpha, file_bytes: bytes.len() as u64, mean_color })
}

/// The most that is held at once: while the file is decoded, as its pixels become RGBA of 8 bits, or as these
/// are turned.
fn needed_bytes(
    pixels: u64,
    decoder: &dyn ImageDecoder,
    scratch_bytes: u64,
    orientation: Orientation,
) -> u64 {
    let rgba = 4 * pixels;
    let decoding = decoder.total_bytes() + scratch_bytes;
    let converting = if decoder.color_type() == ColorType::Rgba8 { 0 } else { decoder.total_bytes() + rgba };
    let turning = if is_turn(orientation) { 2 * rgba } else { 0 };
    decoding.max(converting).max(turning)
}

/// Whether columns become rows, which needs a second picture.
const fn is_turn(orientation: Orientation) -> bool {
    matches!(
        orientation,
        Orientation::Rotate90
            | Orientation::Rotate270
            | Orientation::Rotate90FlipH
            | Orientation::Rotate270FlipH
    )
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
    sums.map(|sum| code((sum / weight) as f32))
}

#[cfg(test)]
mod tests {
    use png::{BitDepth, ColorType};

    use super::*;
    use crate::monitor::Quiet;
    use crate::picture::PictureFormat;

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
            let found = read_picture("", &file(2, 1, color, depth, data), &Quiet).unwrap();
            assert_eq!(
                (found.picture.rgba(), found.has_alpha),
                (&expected[..], has_alpha),
                "{color:?} {depth:?}"
            );
        }
    }

    #[test]
    fn what_is_no_picture_is_said_to_be_none() {
        for bytes in [&b""[..], b"\x89PNG", b"\xff\xd8", b"<svg/>", b"RIFF\0\0\0\0WAVE"] {
            let error = read_picture("leaf.png", bytes, &Quiet).unwrap_err();
            assert_eq!(error, UserPictureError::NotPicture);
        }
        let error = read_picture("leaf.png", b"GIF89a", &Quiet).unwrap_err();
        assert_eq!(error, UserPictureError::OtherFormat("GIF"));
    }

    #[test]
    fn what_ends_early_is_said_to_be_damaged() {
        let png = file(20, 20, ColorType::Grayscale, BitDepth::Eight, &[7; 400]);
        let picture = Picture::new(20, 20, (0..1600).map(|i| (i * 7) as u8 | 3).collect());
        let encoded = |format| picture.encoded(format).unwrap().to_vec();
        // The last chunk of a PNG, a filling byte of a WebP.
        for (whole, spare) in
            [(png, 12), (encoded(PictureFormat::Jpeg), 0), (encoded(PictureFormat::Webp), 1)]
        {
            assert!(read_picture("", &whole, &Quiet).is_ok());
            for length in 12..whole.len() - spare {
                let error = read_picture("", &whole[..length], &Quiet).unwrap_err();
                assert!(matches!(error, UserPictureError::Damaged { .. }), "{length}: {error}");
            }
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
            let error = read_picture("", &header(width, height), &Quiet).unwrap_err();
            assert_eq!(error, UserPictureError::TooLarge { width, height });
            assert!(error.to_string().contains("8192"), "{error}");
        }
        let error = read_picture("", &header(8000, 8000), &Quiet).unwrap_err();
        assert_eq!(error, UserPictureError::ends_early(Readable::Png));
        // A TGA has no mark but its name: 8000 by 8000 pixels of three bytes, in runs.
        let tga =
            [&[0, 0, 10][..], &[0; 9], &8000_u16.to_le_bytes(), &8000_u16.to_le_bytes(), &[24, 0]].concat();
        let error = read_picture("a.TGA", &tga, &Quiet).unwrap_err();
        assert_eq!(error, UserPictureError::ends_early(Readable::Tga));
        assert_eq!(read_picture("a.png", &tga, &Quiet), Err(UserPictureError::NotPicture));
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
        assert!(matches!(read_picture("", &bytes, &Poor), Err(UserPictureError::Memory(_))));
    }
}
