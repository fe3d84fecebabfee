//! Pixels → PNG bytes.

use linden::scene::Picture;

/// Writes a picture as PNG: 8 bits per channel, marked sRGB; without an alpha channel where no
/// pixel needs one.
///
/// # Errors
/// When the picture's byte count is not `width × height × 4`, or a side is 0.
pub fn encode_png(picture: &Picture) -> Result<Vec<u8>, PngError> {
    let Picture { width, height, ref rgba } = *picture;
    let expected = (width as usize).checked_mul(height as usize).and_then(|n| n.checked_mul(4));
    if expected != Some(rgba.len()) {
        return Err(PngError::Bytes { width, height, bytes: rgba.len() });
    }
    let opaque = rgba.as_chunks::<4>().0.iter().all(|p| p[3] == 255);
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(if opaque { png::ColorType::Rgb } else { png::ColorType::Rgba });
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
    let mut writer = encoder.write_header()?;
    if opaque {
        let rgb: Vec<u8> = rgba.as_chunks::<4>().0.iter().flat_map(|&[r, g, b, _]| [r, g, b]).collect();
        writer.write_image_data(&rgb)?;
    } else {
        writer.write_image_data(rgba)?;
    }
    writer.finish()?;
    Ok(bytes)
}

/// Why a picture could not be written as PNG.
#[derive(Debug, thiserror::Error)]
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
        let bytes = encode_png(&Picture { width: 3, height: 2, rgba: rgba.clone() }).unwrap();
        assert_eq!(decoded(&bytes), (png::ColorType::Rgba, rgba));
    }

    #[test]
    fn an_opaque_picture_has_no_alpha_channel() {
        let bytes =
            encode_png(&Picture { width: 1, height: 2, rgba: vec![1, 2, 3, 255, 4, 5, 6, 255] }).unwrap();
        assert_eq!(decoded(&bytes), (png::ColorType::Rgb, vec![1, 2, 3, 4, 5, 6]));
    }

    #[test]
    fn lies_about_the_size_are_errors() {
        let error = encode_png(&Picture { width: 3, height: 2, rgba: vec![0; 23] }).unwrap_err();
        assert!(error.to_string().contains("3×2"), "{error}");
        assert!(encode_png(&Picture { width: 0, height: 0, rgba: vec![] }).is_err());
        assert!(encode_png(&Picture { width: u32::MAX, height: u32::MAX, rgba: vec![] }).is_err());
    }
}
