//! Pictures as files, each once.

use std::borrow::Cow;
use std::sync::Arc;

use glam::Vec2;
use linden_pipeline::color::encode;
use linden_pipeline::picture::{Picture, PictureFormat};
use linden_pipeline::scene::{Material, Wrap};
use rayon::prelude::*;

use crate::ExportError;
use crate::writing::distinct::NamedMaterial;

/// A picture on a stage, and what its file is called after the stem: `_bark_normal.png`.
#[non_exhaustive]
pub struct NamedPicture<'a> {
    /// What the name ends with.
    pub suffix: String,
    /// What it is called within a file: `norway_spruce_bark_normal`.
    pub name: String,
    /// The picture.
    pub picture: &'a Arc<Picture>,
    /// As its first material has it.
    pub wrap: Wrap,
    /// Whether a material takes its pixels for directions.
    pub is_normal: bool,
    /// What its file is.
    pub format: PictureFormat,
    /// Whether its file has channels in steps of 3 around the middle: of directions, a third fewer bytes, none
    /// bent by as much as a degree.
    pub is_rounded: bool,
}

/// Of 255.
const STEP: i32 = 3;

impl<'a> NamedPicture<'a> {
    /// A PNG of colours, whose name ends with `suffix` and `.png`.
    pub fn png(suffix: &str, picture: &'a Arc<Picture>, wrap: Wrap) -> Self {
        let format = PictureFormat::Png;
        let name = suffix.trim_start_matches('_').to_owned();
        Self {
            suffix: with_ending(suffix, format),
            name,
            picture,
            wrap,
            is_normal: false,
            format,
            is_rounded: false,
        }
    }

    /// The name's end without that of the format: `_bark_normal`.
    pub fn stem(&self) -> &str {
        self.suffix.rsplit_once('.').map_or(&self.suffix, |(stem, _)| stem)
    }

    /// Changes what its file is, if that serves the picture: what is not opaque needs a format with alpha.
    /// Normals stay PNG: JPEG would bend them, and our WebP of them is larger (by 3 to 64 % in six plants).
    pub fn store_as(&mut self, format: PictureFormat) {
        if !self.is_normal && (format.has_alpha() || self.picture.is_opaque()) {
            (self.suffix, self.format) = (with_ending(self.stem(), format), format);
        }
    }
}

fn with_ending(stem: &str, format: PictureFormat) -> String {
    format!("{stem}.{}", format.endings()[0])
}

/// Whether two pictures show the same, pixel by pixel: those of a plant's seasons may be drawn alike.
fn is_same(a: &Arc<Picture>, b: &Arc<Picture>) -> bool {
    Arc::ptr_eq(a, b) || a == b
}

/// Every picture of some materials once, in their order, named after its first use: as PNG, unless
/// [`NamedPicture::store_as`] says otherwise; for formats that say how much light passes, [`with_passing`].
pub fn of_materials<'a>(materials: &[NamedMaterial<'a>]) -> Vec<NamedPicture<'a>> {
    shown(materials, false)
}

/// The same with the pictures of what passes ([`Material::passing_picture`]).
pub fn with_passing<'a>(materials: &[NamedMaterial<'a>]) -> Vec<NamedPicture<'a>> {
    shown(materials, true)
}

fn shown<'a>(materials: &[NamedMaterial<'a>], with_passing: bool) -> Vec<NamedPicture<'a>> {
    let mut named: Vec<NamedPicture<'_>> = Vec::new();
    for NamedMaterial { name, file_name, material } in materials {
        let Material { base_color_picture, normal_picture, passing_picture, .. } = material;
        let passing = passing_picture.as_ref().filter(|_| with_passing);
        for (picture, kind, is_normal) in [
            (base_color_picture.as_ref(), "", false),
            (normal_picture.as_ref(), "_normal", true),
            (passing, "_passing", false),
        ] {
            let Some(picture) = picture else { continue };
            if let Some(known) = named.iter_mut().find(|known| is_same(known.picture, picture)) {
                known.is_normal |= is_normal;
                continue;
            }
            let new = NamedPicture::png(&format!("_{file_name}{kind}"), picture, material.wrap);
            named.push(NamedPicture { is_normal, name: format!("{name}{kind}"), ..new });
        }
    }
    named
}

/// Where among the pictures of [`of_materials`] one is.
pub fn index_of(named: &[NamedPicture<'_>], picture: Option<&Arc<Picture>>) -> Option<usize> {
    picture.and_then(|picture| named.iter().position(|known| is_same(known.picture, picture)))
}

/// Each picture as a file of its format, in the same order.
///
/// # Errors
/// Only for a picture whose pixels do not fill it, which `writing::validate` has refused before.
pub fn compress<'a>(named: &[NamedPicture<'a>]) -> Result<Vec<Cow<'a, [u8]>>, ExportError> {
    let encoded = |named: &NamedPicture<'a>| {
        let file = if named.is_rounded {
            rounded(named.picture).small(named.format).map(Cow::Owned)
        } else {
            named.picture.encoded(named.format).map(Cow::Borrowed)
        };
        file.map_err(|e| ExportError::Scene {
            what: format!("picture '{}'", named.suffix),
            problem: e.to_string(),
        })
    };
    named.par_iter().map(encoded).collect()
}

/// What rounding pictures takes: their pixels once more, and their files, as large as they may be.
pub fn rounding_bytes(named: &[NamedPicture<'_>]) -> u64 {
    let pixels = named.iter().filter(|named| named.is_rounded).map(|named| named.picture.rgba().len() as u64);
    2 * pixels.sum::<u64>()
}

/// A picture in fewer values; 128, which is no slope, is one of them.
fn rounded(picture: &Picture) -> Picture {
    const MIDDLE: i32 = 128;
    let round = |value: u8| {
        let offset = i32::from(value) - MIDDLE;
        let steps = (offset + STEP / 2).div_euclid(STEP);
        (MIDDLE + steps * STEP).clamp(0, 255) as u8
    };
    let pixels = picture.rgba().as_chunks::<4>().0.iter();
    let rgba = pixels.flat_map(|&[r, g, b, a]| [round(r), round(g), round(b), a]).collect();
    Picture::new(picture.width(), picture.height(), rgba)
}

/// The sRGB colour of the pixel where a texture coordinate (V up) is. What is cut out has a colour too:
/// that of the edge nearby.
pub fn color_at(picture: &Picture, wrap: Wrap, uv: Vec2) -> [u8; 3] {
    let index = |x: f32, size: u32| {
        let x = if wrap == Wrap::Repeat { x - libm::floorf(x) } else { x.clamp(0.0, 1.0) };
        ((x * size as f32) as u32).min(size - 1) as usize
    };
    let (column, row) = (index(uv.x, picture.width()), index(1.0 - uv.y, picture.height()));
    let at = 4 * (row * picture.width() as usize + column);
    [0, 1, 2].map(|channel| picture.rgba()[at + channel])
}

/// Linear 0..1 to sRGB 0..255.
pub fn srgb(linear: f32) -> u8 {
    libm::roundf(encode(linear.clamp(0.0, 1.0)) * 255.0) as u8
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;

    #[test]
    fn colors_are_those_of_the_pixel_under_the_coordinate() {
        // Two by two: red, green above; blue, white below.
        let rows = [[255, 0, 0, 255], [0, 255, 0, 255], [0, 0, 255, 255], [255, 255, 255, 255]];
        let picture = Picture::new(2, 2, rows.concat());
        let at = |wrap, u, v| color_at(&picture, wrap, Vec2::new(u, v));
        assert_eq!(at(Wrap::Repeat, 0.1, 0.9), [255, 0, 0]);
        assert_eq!(at(Wrap::Repeat, 1.1, -0.1), [255, 0, 0]);
        assert_eq!(at(Wrap::Repeat, -0.1, 3.2), [255, 255, 255]);
        assert_eq!(at(Wrap::Clamp, 1.1, -0.1), [255, 255, 255]);
        assert_eq!(at(Wrap::Clamp, 0.0, 1.0), [255, 0, 0]);
    }

    #[test]
    fn rounded_directions_are_bent_by_less_than_a_degree() {
        let sines = (0..90_000).map(|i| [(i % 300) as f32, (i / 300) as f32].map(|n| n / 150.0 - 1.0));
        let up = |[x, y]: [f32; 2]| 1.0 - x * x - y * y;
        let directions = sines.filter(|xy| up(*xy) > 0.0).map(|xy| [xy[0], xy[1], up(xy).sqrt()]);
        let stored = |direction: [f32; 3]| direction.map(|x| libm::roundf(127.5 * x + 127.5) as u8);
        let read =
            |[r, g, b, _]: [u8; 4]| Vec3::from([r, g, b].map(|c| f32::from(c) / 127.5 - 1.0)).normalize();
        let mut worst = 0.0_f32;
        for direction in directions {
            let [r, g, b] = stored(direction);
            let rounded = rounded(&Picture::new(1, 1, vec![r, g, b, 255]));
            let after: [u8; 4] = rounded.rgba().try_into().unwrap();
            worst = worst.max(read(after).angle_between(read([r, g, b, 255])).to_degrees());
        }
        assert!(0.5 < worst && worst < 1.0, "{worst}");
        let flat = Picture::new(1, 1, vec![128, 128, 255, 255]);
        assert_eq!(rounded(&flat).rgba()[..2], [128, 128]);
    }

    #[test]
    fn only_what_a_format_serves_is_stored_in_it() {
        let picture = |alpha| Arc::new(Picture::new(1, 1, vec![9, 9, 9, alpha]));
        let (opaque, hole) = (picture(255), picture(0));
        for (picture, is_normal, jpeg, webp) in [
            (&opaque, false, "_a.jpg", "_a.webp"),
            (&hole, false, "_a.png", "_a.webp"),
            (&opaque, true, "_a.png", "_a.png"),
        ] {
            let mut named = NamedPicture { is_normal, ..NamedPicture::png("_a", picture, Wrap::Clamp) };
            named.store_as(PictureFormat::Jpeg);
            assert_eq!((named.suffix.as_str(), named.stem()), (jpeg, "_a"));
            named.store_as(PictureFormat::Webp);
            assert_eq!((named.suffix.as_str(), named.stem()), (webp, "_a"));
        }
    }

    #[test]
    fn srgb_agrees_with_the_standards_points() {
        assert_eq!([0.0, 1.0, 0.214_041_14, 0.002].map(srgb), [0, 255, 128, 7]);
    }
}
