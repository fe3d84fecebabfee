//! The formats that are read, and how they are told apart.

use image::{ImageFormat, guess_format};

/// How a TGA ends that was written since 1989; older ones have no mark.
const TGA_FOOTER: &[u8] = b"TRUEVISION-XFILE.\0";

/// A format that is read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Readable {
    Png,
    Jpeg,
    Webp,
    Tga,
}

impl Readable {
    /// Each with its name and the endings of its files' names.
    const ALL: [(Self, &str, &[&str]); 4] = [
        (Self::Png, "PNG", &["png"]),
        (Self::Jpeg, "JPEG", &["jpg", "jpeg"]),
        (Self::Webp, "WebP", &["webp"]),
        (Self::Tga, "TGA", &["tga"]),
    ];

    /// By the file's content, as far as that tells.
    pub fn of_content(bytes: &[u8]) -> Option<Self> {
        match guess_format(bytes) {
            Ok(ImageFormat::Png) => Some(Self::Png),
            Ok(ImageFormat::Jpeg) => Some(Self::Jpeg),
            Ok(ImageFormat::WebP) => Some(Self::Webp),
            _ => bytes.ends_with(TGA_FOOTER).then_some(Self::Tga),
        }
    }

    /// By the ending of the file's name.
    pub fn of_name(name: &str) -> Option<Self> {
        let (_, ending) = name.rsplit_once('.')?;
        let has = |endings: &[&str]| endings.iter().any(|known| known.eq_ignore_ascii_case(ending));
        Self::ALL.iter().find(|(_, _, endings)| has(endings)).map(|&(format, ..)| format)
    }

    /// `PNG`, `JPEG`, `WebP`, `TGA`.
    pub const fn name(self) -> &'static str {
        Self::ALL[self as usize].1
    }
}

/// The format of a picture that is not read.
pub(super) fn other_format(bytes: &[u8]) -> Option<&'static str> {
    Some(match guess_format(bytes).ok()? {
        ImageFormat::Gif => "GIF",
        ImageFormat::Tiff => "TIFF",
        ImageFormat::Bmp => "BMP",
        ImageFormat::OpenExr => "OpenEXR",
        ImageFormat::Avif => "AVIF",
        _ => return None,
    })
}
