//! Recipes inside pictures: a text of a PNG, the description in the Exif data of a JPEG or WebP.
//!
//! Exif is a TIFF file of its own (TIFF 6.0, section 2). What is written is the smallest there is: one
//! directory with one entry, `ImageDescription`.

use std::io::{self, BufRead, Read, Seek, SeekFrom};

use super::pieces::{self, jpeg_segment, marker, png_chunk, webp_chunk};

/// The keyword of a recipe among a PNG's texts, and how a description begins that holds one.
pub(super) const KEYWORD: &str = "linden recipe";
/// No recipe is longer.
const LONGEST_BYTES: u32 = 16 << 20;
/// What stands before the Exif data in a segment of a JPEG.
const EXIF: &[u8] = b"Exif\0\0";
/// Little-endian, TIFF, and where the directory begins.
const TIFF: &[u8] = b"II\x2a\0\x08\0\0\0";
/// One entry, `ImageDescription`, of the type ASCII.
const ENTRY: &[u8] = b"\x01\0\x0e\x01\x02\0";
/// Where the text begins: behind its length, this offset, and the offset of the next directory.
const TEXT_AT: usize = TIFF.len() + ENTRY.len() + 12;
/// The longest recipe that a JPEG has room for, bytes: a segment's length has 16 bits, and counts itself. A
/// space stands before the recipe, a zero behind it.
pub(super) const LONGEST_IN_JPEG: usize = 0xffff - 2 - EXIF.len() - TEXT_AT - KEYWORD.len() - 2;

/// A recipe as Exif data.
pub(super) fn to_exif(recipe: &str) -> Vec<u8> {
    let text = format!("{KEYWORD} {recipe}\0");
    let numbers = [text.len() as u32, TEXT_AT as u32, 0].map(u32::to_le_bytes);
    [TIFF, ENTRY, numbers.as_flattened(), text.as_bytes()].concat()
}

/// The recipe in Exif data that [`to_exif`] made.
fn of_exif(exif: &[u8]) -> Option<String> {
    exif.strip_prefix(TIFF)?.strip_prefix(ENTRY)?;
    let text = exif.get(TEXT_AT..)?.strip_prefix(KEYWORD.as_bytes())?;
    String::from_utf8(text.strip_prefix(b" ")?.strip_suffix(b"\0")?.to_vec()).ok()
}

/// The recipe that [`Picture::preview`](super::Picture::preview) put into a file. Reads what stands around
/// the pixels, and not those.
///
/// # Errors
/// What reading failed with, which is [`io::ErrorKind::UnexpectedEof`] where a file ends without a recipe;
/// files of other kinds are no error.
pub fn recipe_in_picture(file: &mut (impl BufRead + Seek + ?Sized)) -> io::Result<Option<String>> {
    let mut opening = [0; 12];
    file.read_exact(&mut opening)?;
    let mut after = |bytes: usize| file.seek(SeekFrom::Start(bytes as u64)).map(drop);
    if opening.starts_with(&pieces::PNG) {
        after(pieces::PNG.len())?;
        in_png(file)
    } else if opening.starts_with(&pieces::JPEG) {
        after(pieces::JPEG.len())?;
        in_jpeg(file)
    } else if pieces::is_webp(&opening) {
        in_webp(file)
    } else {
        Ok(None)
    }
}

fn in_png(file: &mut (impl Read + Seek + ?Sized)) -> io::Result<Option<String>> {
    loop {
        match png_chunk(file)? {
            (kind, _) if [b"IDAT", b"IEND"].contains(&&kind) => return Ok(None),
            (kind, length) if kind == *b"tEXt" && length <= LONGEST_BYTES => {
                let text = content(file, length)?;
                let carried = text.strip_prefix(KEYWORD.as_bytes()).and_then(|rest| rest.strip_prefix(b"\0"));
                if let Some(recipe) = carried {
                    return Ok(String::from_utf8(recipe.to_vec()).ok());
                }
                skip(file, 4)?;
            }
            (_, length) => skip(file, u64::from(length) + 4)?,
        }
    }
}

fn in_jpeg(file: &mut (impl Read + Seek + ?Sized)) -> io::Result<Option<String>> {
    loop {
        match jpeg_segment(file)? {
            (marker::SOS, _) => return Ok(None),
            (marker::APP1, length) => {
                let data = content(file, length.into())?;
                if let Some(recipe) = data.strip_prefix(EXIF).and_then(of_exif) {
                    return Ok(Some(recipe));
                }
            }
            (_, length) => skip(file, length.into())?,
        }
    }
}

fn in_webp(file: &mut (impl Read + Seek + ?Sized)) -> io::Result<Option<String>> {
    loop {
        match webp_chunk(file)? {
            (kind, length) if kind == *b"EXIF" && length <= LONGEST_BYTES => {
                return Ok(of_exif(&content(file, length)?));
            }
            (_, length) => skip(file, u64::from(length) + u64::from(length % 2))?,
        }
    }
}

fn content(file: &mut (impl Read + ?Sized), length: u32) -> io::Result<Vec<u8>> {
    let mut content = Vec::new();
    Read::take(file, length.into()).read_to_end(&mut content)?;
    Ok(content)
}

fn skip(file: &mut (impl Seek + ?Sized), bytes: u64) -> io::Result<()> {
    file.seek_relative(bytes as i64)
}

#[cfg(test)]
mod tests {
    use std::io::Cursor;

    use super::*;
    use crate::picture::{Picture, PictureFormat};

    fn read(bytes: &[u8]) -> io::Result<Option<String>> {
        recipe_in_picture(&mut Cursor::new(bytes.to_vec()))
    }

    #[test]
    fn every_format_carries_a_recipe() {
        let picture = Picture::new(1, 2, vec![1, 2, 3, 255, 4, 5, 6, 255]);
        for format in PictureFormat::ALL {
            for recipe in [r#"{"id":"fir","about":"\u00f6"}"#.to_owned(), "x".repeat(LONGEST_IN_JPEG)] {
                let with = picture.preview(format, Some(&recipe)).unwrap();
                assert!(format.has_room_for(&recipe));
                assert_eq!(read(&with).unwrap(), Some(recipe), "{format:?}");
                let found = crate::input::read_picture("", &with, &crate::monitor::Quiet).unwrap();
                assert_eq!([found.picture.width(), found.picture.height()], [1, 2], "{format:?}");
            }
            let without = picture.preview(format, None).unwrap();
            assert!(!matches!(read(&without), Ok(Some(_))), "{format:?}");
            assert!(read(&without[..10]).is_err(), "{format:?}");
        }
    }

    #[test]
    fn what_a_jpeg_has_no_room_for_is_left_out() {
        let picture = Picture::new(1, 1, vec![1, 2, 3, 255]);
        let long = "x".repeat(LONGEST_IN_JPEG + 1);
        assert!(!PictureFormat::Jpeg.has_room_for(&long) && PictureFormat::Webp.has_room_for(&long));
        let plain = picture.preview(PictureFormat::Jpeg, None).unwrap();
        assert_eq!(picture.preview(PictureFormat::Jpeg, Some(&long)).unwrap(), plain);
        let webp = picture.preview(PictureFormat::Webp, Some(&long)).unwrap();
        assert_eq!(read(&webp).unwrap(), Some(long));
    }

    #[test]
    fn the_pixels_are_not_needed() {
        let png = Picture::new(1, 1, vec![1, 2, 3, 255]).preview(PictureFormat::Png, Some("{}")).unwrap();
        let pixels = png.windows(4).position(|kind| kind == b"IDAT").unwrap();
        assert_eq!(read(&png[..pixels]).unwrap().as_deref(), Some("{}"));
        assert_eq!(read(b"no picture at all").unwrap(), None);
    }
}
