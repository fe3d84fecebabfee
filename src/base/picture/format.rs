//! The formats that pictures are written in: one table from the ending of a file's name to its encoder.

use std::path::Path;

use super::recipe;

/// A format that pictures are written in.
///
/// ```
/// use linden_base::picture::PictureFormat;
/// assert_eq!(PictureFormat::of_name("birch.JPG".as_ref()), Some(PictureFormat::Jpeg));
/// assert_eq!(PictureFormat::of_name("birch.gif".as_ref()), None);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PictureFormat {
    /// Lossless, with alpha; every program reads it.
    Png,
    /// Small and lossy, without alpha.
    Jpeg,
    /// With alpha. Written without loss, for the encoder has no lossy mode: colours in a tenth to a fifth fewer
    /// bytes than PNG has, as a rule.
    Webp,
}

/// What is known of a format.
struct Facts {
    name: &'static str,
    endings: &'static [&'static str],
    media_type: &'static str,
    has_alpha: bool,
    encoding_bytes_per_pixel: u64,
}

impl PictureFormat {
    /// All of them, the usual one first.
    pub const ALL: [Self; 3] = [Self::Png, Self::Jpeg, Self::Webp];

    const fn facts(self) -> Facts {
        match self {
            Self::Png => Facts {
                name: "PNG",
                endings: &["png"],
                media_type: "image/png",
                has_alpha: true,
                encoding_bytes_per_pixel: super::PNG_BYTES_PER_PIXEL,
            },
            Self::Jpeg => Facts {
                name: "JPEG",
                endings: &["jpg", "jpeg"],
                media_type: "image/jpeg",
                has_alpha: false,
                // The file while it grows, and where there is alpha, the colours over white.
                encoding_bytes_per_pixel: 10,
            },
            Self::Webp => Facts {
                name: "WebP",
                endings: &["webp"],
                media_type: "image/webp",
                has_alpha: true,
                // The colours, twice; the picture's chunk while it grows, and the file.
                encoding_bytes_per_pixel: 16,
            },
        }
    }

    /// The format that a file of this name is written in, by its ending.
    pub fn of_name(path: &Path) -> Option<Self> {
        let ending = path.extension()?.to_str()?;
        Self::ALL
            .into_iter()
            .find(|format| format.endings().iter().any(|known| known.eq_ignore_ascii_case(ending)))
    }

    /// `PNG`, `JPEG`, `WebP`.
    pub const fn name(self) -> &'static str {
        self.facts().name
    }

    /// Endings of its files' names without the dot, the usual one first.
    pub const fn endings(self) -> &'static [&'static str] {
        self.facts().endings
    }

    /// Its media type (RFC 2046).
    pub const fn media_type(self) -> &'static str {
        self.facts().media_type
    }

    /// Whether it says how opaque a pixel is.
    pub const fn has_alpha(self) -> bool {
        self.facts().has_alpha
    }

    /// Bytes that are held for each pixel while a picture is encoded, besides those of the picture itself.
    pub const fn encoding_bytes_per_pixel(self) -> u64 {
        self.facts().encoding_bytes_per_pixel
    }

    /// Whether a file of this format has room for a recipe: JPEG has 64 KiB.
    pub const fn has_room_for(self, recipe: &str) -> bool {
        match self {
            Self::Jpeg => recipe.len() <= recipe::LONGEST_IN_JPEG,
            Self::Png | Self::Webp => true,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_ending_belongs_to_two_formats() {
        let endings: Vec<&str> =
            PictureFormat::ALL.iter().flat_map(|format| format.endings()).copied().collect();
        for (index, ending) in endings.iter().enumerate() {
            assert!(!endings[..index].contains(ending), "{ending}");
            assert!(PictureFormat::of_name(format!("a.b.{ending}").as_ref()).is_some(), "{ending}");
        }
    }
}
