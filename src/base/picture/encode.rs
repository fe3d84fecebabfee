//! Pixels → files.

use std::borrow::Cow;

use image::codecs::jpeg::JpegEncoder;
use image::codecs::webp::WebPEncoder;
use image::{ExtendedColorType, ImageBuffer, ImageEncoder, ImageError, Rgba};

use super::recipe::{KEYWORD, to_exif};
use super::{Picture, PictureError, PictureFormat};

/// Of 100. Differences to the picture are seen only where the two are laid over each other.
const JPEG_QUALITY: u8 = 90;

/// What a file says about the picture.
#[derive(Default)]
pub(super) struct About<'a> {
    /// Whether it is to be looked at rather than laid on a surface: its colours are sRGB, and its file is as small as
    /// can be.
    pub is_for_people: bool,
    /// Whether its file is as small as can be though it is laid on a surface.
    pub is_small: bool,
    /// How to grow what it shows.
    pub recipe: Option<&'a str>,
}

/// A picture as a file.
pub(super) fn encode(
    picture: &Picture,
    format: PictureFormat,
    about: &About<'_>,
) -> Result<Vec<u8>, PictureError> {
    let Picture { width, height, ref rgba, .. } = *picture;
    let expected = (width as usize).checked_mul(height as usize).and_then(|n| n.checked_mul(4));
    if expected != Some(rgba.len()) || rgba.is_empty() {
        return Err(PictureError::Bytes { width, height, bytes: rgba.len() });
    }
    let refused = |source| PictureError::Encode { format: format.name(), width, height, source };
    match format {
        PictureFormat::Png => Ok(png(picture, about)?),
        PictureFormat::Jpeg => jpeg(picture, about).map_err(refused),
        PictureFormat::Webp => webp(picture, about).map_err(refused),
    }
}

/// By the crate `png` itself: the encoder of `image` writes neither texts nor that colours are sRGB.
fn png(picture: &Picture, about: &About<'_>) -> Result<Vec<u8>, png::EncodingError> {
    let opaque = picture.is_opaque();
    let mut bytes = Vec::with_capacity(picture.rgba.len() / 2);
    let mut encoder = png::Encoder::new(&mut bytes, picture.width, picture.height);
    if !(about.is_for_people || about.is_small) {
        // Bark and leaves hardly repeat: without looking for what does, their colours take 5 to 25 % more and their
        // normals 5 % less, in a thirtieth of the time (benchmark `writers`).
        encoder.set_compression(png::Compression::Fast);
    }
    encoder.set_depth(png::BitDepth::Eight);
    let color = match (opaque, !about.is_for_people && picture.is_grey()) {
        (true, true) => png::ColorType::Grayscale,
        (false, true) => png::ColorType::GrayscaleAlpha,
        (true, false) => png::ColorType::Rgb,
        (false, false) => png::ColorType::Rgba,
    };
    encoder.set_color(color);
    if about.is_for_people {
        encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
    }
    if let Some(recipe) = about.recipe {
        encoder.add_text_chunk(KEYWORD.to_owned(), recipe.to_owned())?;
    }
    let mut writer = encoder.write_header()?;
    match color {
        png::ColorType::Grayscale => writer.write_image_data(&grey(picture))?,
        png::ColorType::GrayscaleAlpha => writer.write_image_data(&grey_and_alpha(picture))?,
        png::ColorType::Rgb => writer.write_image_data(&rgb(picture))?,
        _ => writer.write_image_data(&picture.rgba)?,
    }
    writer.finish()?;
    Ok(bytes)
}

fn jpeg(picture: &Picture, about: &About<'_>) -> Result<Vec<u8>, ImageError> {
    let mut bytes = Vec::new();
    let mut encoder = JpegEncoder::new_with_quality(&mut bytes, JPEG_QUALITY);
    if let Some(recipe) = about.recipe {
        encoder.set_exif_metadata(to_exif(recipe)).map_err(ImageError::Unsupported)?;
    }
    let pixels = if picture.is_opaque() {
        Cow::Borrowed(picture.rgba.as_slice())
    } else {
        Cow::Owned(picture.rgba.as_chunks().0.iter().flat_map(|&pixel| over_white(pixel)).collect())
    };
    // The length was looked at.
    if let Some(view) = ImageBuffer::<Rgba<u8>, _>::from_raw(picture.width, picture.height, &*pixels) {
        encoder.encode_image(&view)?;
    }
    Ok(bytes)
}

/// Lossless: the encoder of `image` has no other mode.
fn webp(picture: &Picture, about: &About<'_>) -> Result<Vec<u8>, ImageError> {
    let mut bytes = Vec::new();
    let mut encoder = WebPEncoder::new_lossless(&mut bytes);
    if let Some(recipe) = about.recipe {
        encoder.set_exif_metadata(to_exif(recipe)).map_err(ImageError::Unsupported)?;
    }
    if picture.is_opaque() {
        encoder.encode(&rgb(picture), picture.width, picture.height, ExtendedColorType::Rgb8)?;
    } else {
        encoder.encode(&picture.rgba, picture.width, picture.height, ExtendedColorType::Rgba8)?;
    }
    Ok(bytes)
}

fn rgb(picture: &Picture) -> Vec<u8> {
    picture.rgba.as_chunks().0.iter().flat_map(|&[r, g, b, _]| [r, g, b]).collect()
}

fn grey(picture: &Picture) -> Vec<u8> {
    picture.rgba.as_chunks::<4>().0.iter().map(|pixel| pixel[0]).collect()
}

fn grey_and_alpha(picture: &Picture) -> Vec<u8> {
    picture.rgba.as_chunks().0.iter().flat_map(|&[grey, _, _, a]| [grey, a]).collect()
}

/// What a pixel looks like on a white page, in sRGB as browsers do it.
fn over_white([r, g, b, a]: [u8; 4]) -> [u8; 4] {
    let alpha = u32::from(a);
    let over = |c: u8| ((u32::from(c) * alpha + 255 * (255 - alpha) + 127) / 255) as u8;
    [over(r), over(g), over(b), 255]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::input::read_picture;
    use crate::monitor::Quiet;

    #[test]
    fn webp_keeps_every_pixel() {
        for alpha in [200, 255] {
            let rgba = (0..9 * 7).flat_map(|i| [i, 255 - i, i ^ 0x55, alpha]).collect();
            let picture = Picture::new(9, 7, rgba);
            let file = picture.encoded(PictureFormat::Webp).unwrap();
            assert_eq!(*read_picture("", file, &Quiet).unwrap().picture, picture);
        }
    }

    #[test]
    fn jpeg_keeps_what_is_seen_and_shows_what_is_not_opaque_over_white() {
        let half = [20, 60, 100, 128].repeat(32);
        let none = [90, 0, 0, 0].repeat(32);
        let file = Picture::new(8, 8, [half, none].concat()).preview(PictureFormat::Jpeg, None).unwrap();
        let found = read_picture("", &file, &Quiet).unwrap();
        assert!(!found.has_alpha);
        let at = |row: usize| &found.picture.rgba()[row * 32..][..4];
        for (row, expected) in [(0, [137, 157, 177, 255]), (7, [255; 4])] {
            let near = at(row).iter().zip(expected).all(|(&a, b)| a.abs_diff(b) <= 8);
            assert!(near, "row {row}: {:?}", at(row));
        }
    }
}
