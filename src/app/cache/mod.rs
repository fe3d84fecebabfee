//! Pictures that were drawn are kept in a folder of the user's, from one run to the next: how much of it there may be,
//! and what trees take from it.
//!
//! Files are the same with it and without. Nothing that goes wrong with it is an error: what cannot be read is drawn,
//! what cannot be written is not kept.

mod store;

use std::path::PathBuf;
use std::sync::{Arc, OnceLock};

use linden::knob::excerpt;
use linden::recipe::Recipe;
use linden::texture::DrawnPictures;

pub use self::store::{Contents, Counts, FolderStore};
use crate::memory;

/// The variable that says it where no flag does.
pub const VARIABLE: &str = "LINDEN_CACHE";

/// What the user may write.
pub const TAKES: &str = "off, auto (512M), or bytes like 2G or 100M (powers of 1024)";

/// How much there may be where nothing is said, bytes: pictures of a hundred kinds of trees.
const USUAL_BYTES: u64 = 512 << 20;

static STORE: OnceLock<Option<Arc<FolderStore>>> = OnceLock::new();

/// How much is kept.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum CacheSize {
    /// What is usual.
    #[default]
    Auto,
    /// Nothing.
    Off,
    /// So many bytes.
    Bytes(u64),
}

impl CacheSize {
    /// As the user writes it.
    ///
    /// # Errors
    /// What was expected instead.
    pub fn parse(text: &str) -> Result<Self, String> {
        match text.trim() {
            "off" => Ok(Self::Off),
            "auto" => Ok(Self::Auto),
            text => match memory::parse(text) {
                Ok(Some(bytes)) => Ok(Self::Bytes(bytes)),
                _ => {
                    // A folder's is another variable.
                    let is_path = text.contains(std::path::is_separator);
                    let hint = if is_path { "; LINDEN_CACHE_DIR names the folder" } else { "" };
                    Err(format!("'{}': expected {TAKES}{hint}", excerpt(text)))
                }
            },
        }
    }

    /// At most so many bytes; 0 when it is off.
    pub const fn bytes(self) -> u64 {
        match self {
            Self::Auto => USUAL_BYTES,
            Self::Off => 0,
            Self::Bytes(bytes) => bytes,
        }
    }
}

impl std::fmt::Display for CacheSize {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Auto => f.write_str("auto"),
            Self::Off => f.write_str("off"),
            Self::Bytes(bytes) => write!(f, "{}M", bytes >> 20),
        }
    }
}

/// Opens the folder for all work from now on, unless the size is none or there is no folder; the first call counts.
/// The folder is made when something is put there. Before, and in programs that never call it, nothing is kept.
pub fn open(folder: Option<PathBuf>, size: CacheSize) {
    let folder = folder.filter(|_| size != CacheSize::Off);
    STORE.get_or_init(|| folder.map(|folder| Arc::new(FolderStore::new(folder, size.bytes()))));
}

/// What was opened.
fn opened() -> Option<&'static Arc<FolderStore>> {
    STORE.get()?.as_ref()
}

/// At most so many bytes are kept; 0 where nothing is.
pub fn room() -> u64 {
    opened().map_or(0, |store| store.room())
}

/// Pictures of trees that may look alike, within so much memory: taken from the folder, and kept there.
pub fn pictures(pictures: DrawnPictures) -> DrawnPictures {
    match opened() {
        Some(store) => pictures.kept_in(store.clone()),
        None => pictures,
    }
}

/// A recipe whose pictures are taken from the folder, and kept there.
pub fn kept(recipe: Recipe) -> Recipe {
    match opened() {
        Some(_) => recipe.drawn_into(&Arc::new(pictures(DrawnPictures::default()))),
        None => recipe,
    }
}

/// How often the folder had what was asked for so far; `None` where nothing is kept.
pub fn counts() -> Option<Counts> {
    opened().map(|store| store.counts())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_read_as_people_write_them_and_shown_as_they_are_read() {
        for (text, size) in [
            ("off", CacheSize::Off),
            (" auto ", CacheSize::Auto),
            ("2G", CacheSize::Bytes(2 << 30)),
            ("100M", CacheSize::Bytes(100 << 20)),
        ] {
            assert_eq!(CacheSize::parse(text), Ok(size), "{text}");
            assert_eq!(CacheSize::parse(&size.to_string()), Ok(size));
        }
        for text in ["", "on", "0", "1M", "-4G", "nan", "\u{1b}[2J"] {
            let problem = CacheSize::parse(text).unwrap_err();
            assert!(problem.contains("off, auto") && !problem.contains('\u{1b}'), "{text}: {problem}");
        }
        assert_eq!(CacheSize::Off.bytes(), 0);
    }
}
