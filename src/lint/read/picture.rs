//! The size of a picture out of its header.

use std::io::Cursor;

use image::ImageReader;

use crate::asset::{Aspect, Asset, Texture};

use super::shown;

/// What is known of a picture by its bytes; what is not readable is noted.
pub(super) fn texture(asset: &mut Asset, name: &str, bytes: &[u8]) -> Texture {
    let size = size(bytes);
    let mut texture = Texture { name: shown(name), size, problem: None };
    if size.is_none() {
        let known = ImageReader::new(Cursor::new(bytes))
            .with_guessed_format()
            .is_ok_and(|reader| reader.format().is_some());
        if known || bytes.is_empty() {
            texture.problem = Some("it is no whole picture".to_owned());
        } else {
            asset.note(Aspect::Pictures, format!("{} is of a format whose size is not read", texture.name));
        }
    }
    texture
}

fn size(bytes: &[u8]) -> Option<[u32; 2]> {
    let word = |at: usize| Some(u32::from_le_bytes(bytes.get(at..at + 4)?.try_into().ok()?));
    let [width, height] = if bytes.starts_with(b"\xabKTX 20\xbb") {
        [word(20)?, word(24)?]
    } else if bytes.starts_with(b"DDS ") {
        [word(16)?, word(12)?]
    } else {
        let (width, height) =
            ImageReader::new(Cursor::new(bytes)).with_guessed_format().ok()?.into_dimensions().ok()?;
        [width, height]
    };
    (width > 0 && height > 0).then_some([width, height])
}
