//! Pictures as PNG, each once.

use std::sync::Arc;

use linden::scene::{Material, Picture, Scene};

use crate::ExportError;

/// A picture of a scene, and what its file is called after the stem: `_bark_normal.png`.
pub(crate) struct Named<'a> {
    pub suffix: String,
    pub picture: &'a Arc<Picture>,
}

/// Every picture of a scene once, in the order of the materials, named after its first use.
pub(crate) fn pictures(scene: &Scene) -> Vec<Named<'_>> {
    let mut named: Vec<Named<'_>> = Vec::new();
    for material in &scene.materials {
        let Material { base_color_picture, normal_picture, .. } = material;
        for (picture, kind) in [(base_color_picture, ""), (normal_picture, "_normal")] {
            if let Some(picture) = picture
                && !named.iter().any(|known| Arc::ptr_eq(known.picture, picture))
            {
                named.push(Named { suffix: format!("_{}{kind}.png", material.name), picture });
            }
        }
    }
    named
}

/// Where among [`pictures`] one is.
pub(crate) fn index_of(named: &[Named<'_>], picture: Option<&Arc<Picture>>) -> Option<usize> {
    picture.and_then(|picture| named.iter().position(|known| Arc::ptr_eq(known.picture, picture)))
}

/// A picture as PNG: without the alpha channel where every pixel is opaque.
///
/// # Errors
/// Only for a picture whose pixels do not fill it, which [`crate::sound::check`] has refused before.
pub(crate) fn encode(named: &Named<'_>) -> Result<Vec<u8>, ExportError> {
    let Picture { width, height, ref rgba } = **named.picture;
    let fault = |e: png::EncodingError| ExportError::Scene {
        what: format!("picture '{}'", named.suffix),
        problem: e.to_string(),
    };
    let opaque = rgba.chunks_exact(4).all(|pixel| pixel[3] == 255);
    let mut file = Vec::with_capacity(rgba.len() / 2);
    let mut encoder = png::Encoder::new(&mut file, width, height);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_color(if opaque { png::ColorType::Rgb } else { png::ColorType::Rgba });
    let mut writer = encoder.write_header().map_err(fault)?;
    if opaque {
        let rgb: Vec<u8> = rgba.chunks_exact(4).flat_map(|pixel| [pixel[0], pixel[1], pixel[2]]).collect();
        writer.write_image_data(&rgb).map_err(fault)?;
    } else {
        writer.write_image_data(rgba).map_err(fault)?;
    }
    writer.finish().map_err(fault)?;
    Ok(file)
}

/// Linear 0..1 to sRGB 0..255 (IEC 61966-2-1).
pub(crate) fn srgb(linear: f32) -> u8 {
    let x = linear.clamp(0.0, 1.0);
    let encoded = if x <= 0.003_130_8 { 12.92 * x } else { 1.055 * libm::powf(x, 1.0 / 2.4) - 0.055 };
    libm::roundf(encoded * 255.0) as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    fn decoded(file: &[u8]) -> (png::ColorType, Vec<u8>) {
        let mut reader = png::Decoder::new(std::io::Cursor::new(file)).read_info().unwrap();
        let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
        let info = reader.next_frame(&mut pixels).unwrap();
        pixels.truncate(info.buffer_size());
        (info.color_type, pixels)
    }

    #[test]
    fn pixels_come_back_and_alpha_only_where_it_says_something() {
        let encode_rgba = |rgba: Vec<u8>| {
            let picture = Arc::new(Picture { width: 2, height: 1, rgba });
            decoded(&encode(&Named { suffix: String::new(), picture: &picture }).unwrap())
        };
        assert_eq!(
            encode_rgba(vec![1, 2, 3, 255, 4, 5, 6, 255]),
            (png::ColorType::Rgb, vec![1, 2, 3, 4, 5, 6])
        );
        assert_eq!(
            encode_rgba(vec![1, 2, 3, 255, 4, 5, 6, 7]),
            (png::ColorType::Rgba, vec![1, 2, 3, 255, 4, 5, 6, 7])
        );
    }

    #[test]
    fn srgb_agrees_with_the_standards_points() {
        assert_eq!([0.0, 1.0, 0.214_041_14, 0.002].map(srgb), [0, 255, 128, 7]);
    }
}
