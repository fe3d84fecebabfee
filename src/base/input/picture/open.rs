//! Files of pictures as decoders that have read no more than the header, within all limits.

use std::io::Cursor;

use image::codecs::jpeg::JpegDecoder;
use image::codecs::png::PngDecoder;
use image::codecs::tga::TgaDecoder;
use image::codecs::webp::WebPDecoder;
use image::{ImageDecoder, Limits};

use super::format::Readable;
use super::{MAX_PIXELS, MAX_SIDE_PX, UserPictureError, jpeg, webp};
use crate::knob::printable;

/// What a PNG may hold besides its pixels, bytes: texts and profiles, unpacked.
const MAX_EXTRAS_BYTES: u64 = 64 << 20;
/// Deflate makes at most this many bytes of one (RFC 1951: 258 bytes from two bits).
const MOST_INFLATED: u64 = 1032;

/// A file of which no more than the header was read.
pub(super) struct Opened<'a> {
    /// Tells the size, and decodes the rest.
    pub decoder: Box<dyn ImageDecoder + 'a>,
    /// How many there are.
    pub pixels: u64,
    /// Bytes that decoding takes besides the pixels that it gives.
    pub scratch_bytes: u64,
}

/// Reads the header, and refuses what its decoder would not.
///
/// # Errors
/// [`UserPictureError`].
pub(super) fn open(format: Readable, bytes: &[u8]) -> Result<Opened<'_>, UserPictureError> {
    match format {
        Readable::Png => open_png(bytes),
        Readable::Jpeg => open_jpeg(bytes),
        Readable::Webp => open_webp(bytes),
        Readable::Tga => open_tga(bytes),
    }
}

/// Refuses a file that is too short for `amount`, where a byte of it can stand for `most`.
fn check_length(format: Readable, bytes: &[u8], amount: u64, most: u64) -> Result<(), UserPictureError> {
    if amount > most.saturating_mul(bytes.len() as u64) {
        return Err(UserPictureError::ends_early(format));
    }
    Ok(())
}

fn open_png(bytes: &[u8]) -> Result<Opened<'_>, UserPictureError> {
    // The decoder of `image` makes room for a row before it tells the size.
    let mut reader = png::Decoder::new(Cursor::new(bytes));
    let header = reader.read_header_info().map_err(|error| UserPictureError::Damaged {
        format: Readable::Png.name(),
        problem: printable(&error.to_string()),
    })?;
    let pixels = pixels_within_limits(header.size())?;
    let packed = u64::from(header.height) * header.raw_row_length() as u64;
    check_length(Readable::Png, bytes, packed, MOST_INFLATED)?;
    let mut limits = Limits::no_limits();
    limits.max_alloc = Some(MAX_EXTRAS_BYTES);
    let decoder = PngDecoder::with_limits(Cursor::new(bytes), limits)
        .map_err(|error| UserPictureError::of(Readable::Png, &error))?;
    Ok(Opened { decoder: Box::new(decoder), pixels, scratch_bytes: 0 })
}

fn open_jpeg(bytes: &[u8]) -> Result<Opened<'_>, UserPictureError> {
    let frame = jpeg::frame(bytes).ok_or_else(|| UserPictureError::ends_early(Readable::Jpeg))?;
    if frame.components == 4 {
        return Err(UserPictureError::Cmyk);
    }
    if !frame.is_whole {
        return Err(UserPictureError::ends_early(Readable::Jpeg));
    }
    let decoder =
        JpegDecoder::new(Cursor::new(bytes)).map_err(|error| UserPictureError::of(Readable::Jpeg, &error))?;
    let pixels = pixels_within_limits(decoder.dimensions())?;
    // A bit for each block of 8 by 8 pixels.
    check_length(Readable::Jpeg, bytes, pixels, 8 * 64)?;
    // The file itself is copied; a progressive one has all its coefficients in 16 bits at once.
    let scratch_bytes = bytes.len() as u64 + 2 * u64::from(frame.components) * pixels;
    Ok(Opened { decoder: Box::new(decoder), pixels, scratch_bytes })
}

fn open_webp(bytes: &[u8]) -> Result<Opened<'_>, UserPictureError> {
    let chunks = webp::chunks(bytes).ok_or_else(|| UserPictureError::ends_early(Readable::Webp))?;
    let decoder =
        WebPDecoder::new(Cursor::new(bytes)).map_err(|error| UserPictureError::of(Readable::Webp, &error))?;
    if decoder.has_animation() {
        return Err(UserPictureError::Animated);
    }
    let pixels = pixels_within_limits(decoder.dimensions())?;
    let scratch_bytes = chunks.scratch_bytes(pixels, decoder.color_type().has_alpha());
    Ok(Opened { decoder: Box::new(decoder), pixels, scratch_bytes })
}

fn open_tga(bytes: &[u8]) -> Result<Opened<'_>, UserPictureError> {
    let decoder =
        TgaDecoder::new(Cursor::new(bytes)).map_err(|error| UserPictureError::of(Readable::Tga, &error))?;
    let pixels = pixels_within_limits(decoder.dimensions())?;
    // Two bytes for a run of 128.
    check_length(Readable::Tga, bytes, pixels, 64)?;
    // Indices into a palette, and colours of 16 bits, are unpacked from a copy.
    Ok(Opened { decoder: Box::new(decoder), pixels, scratch_bytes: 2 * pixels })
}

/// How many pixels there are.
///
/// # Errors
/// [`UserPictureError::TooLarge`].
fn pixels_within_limits((width, height): (u32, u32)) -> Result<u64, UserPictureError> {
    let pixels = u64::from(width) * u64::from(height);
    if width.max(height) > MAX_SIDE_PX || pixels > MAX_PIXELS {
        return Err(UserPictureError::TooLarge { width, height });
    }
    Ok(pixels)
}
