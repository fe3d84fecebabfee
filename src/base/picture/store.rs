//! Keeping pictures from one run of a program to the next.
//!
//! Nothing here opens a file: a program hands in a [`PictureStore`]. What is kept under a key is what would be made
//! again, byte for byte, so that it makes no difference but time whether it is still there.

use std::fmt;
use std::sync::OnceLock;

use xxhash_rust::const_xxh3;
use xxhash_rust::xxh3::Xxh3;

use super::encode::{About, encode};
use super::{Picture, PictureError, PictureFormat};

/// What of this crate decides how pictures are drawn, as a number: other code has another one.
pub const DRAWING_SOURCE: u64 = const_xxh3::xxh3_64(include_bytes!("../color.rs"))
    ^ const_xxh3::xxh3_64(include_bytes!("../hull.rs"))
    ^ const_xxh3::xxh3_64(include_bytes!("../random.rs"));

/// What decides how they are compressed.
const ENCODER_SOURCE: u64 = const_xxh3::xxh3_64(include_bytes!("encode.rs"));

/// What a kept picture is found by: 128 bits of everything that decides its bytes (XXH3).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct PictureKey(u128);

impl PictureKey {
    /// Of everything that decides it, part by part: where one ends and the next begins counts too.
    ///
    /// ```
    /// use linden_base::picture::PictureKey;
    /// assert_ne!(PictureKey::of(&[b"ab", b"c"]), PictureKey::of(&[b"a", b"bc"]));
    /// ```
    pub fn of(parts: &[&[u8]]) -> Self {
        let mut hasher = Xxh3::new();
        for part in parts {
            hasher.update(&(part.len() as u64).to_le_bytes());
            hasher.update(part);
        }
        Self(hasher.digest128())
    }

    /// As a number, by which a store may name a file.
    pub const fn bits(self) -> u128 {
        self.0
    }

    /// As bytes, to be a part of another key.
    pub const fn to_bytes(self) -> [u8; 16] {
        self.0.to_le_bytes()
    }
}

/// Where pictures are kept. Any number of threads, and of programs, may use one at a time.
pub trait PictureStore: fmt::Debug + Send + Sync {
    /// What was put there under a key; `None` where it is not there, not whole, or cannot be read. What is given is
    /// taken as it is: a store has to see that it is what was put.
    fn get(&self, key: PictureKey) -> Option<Vec<u8>>;

    /// Keeps some bytes, which lie in several places. A store that cannot, or does not want to, leaves it: nothing but
    /// time is lost.
    fn put(&self, key: PictureKey, parts: &[&[u8]]);
}

/// What stands behind kept pixels: width, height, and bytes about the picture.
const TAIL: usize = 12;

impl Picture {
    /// What was kept by [`Picture::put_into`] under a key, with the bytes about it.
    pub fn get_from(store: &dyn PictureStore, key: PictureKey) -> Option<(Self, Vec<u8>)> {
        // The pixels come first: they need not move.
        let mut bytes = store.get(key)?;
        let tail = bytes.split_off(bytes.len().checked_sub(TAIL)?);
        let [width, height, about] =
            [0, 4, 8].map(|at| tail[at..].first_chunk().map(|b| u32::from_le_bytes(*b)));
        let (width, height, about) = (width?, height?, about?);
        let about = bytes.split_off(bytes.len().checked_sub(about as usize)?);
        let pixels = (width as usize).checked_mul(height as usize)?.checked_mul(4)?;
        (bytes.len() == pixels).then(|| (Self::new(width, height, bytes), about))
    }

    /// Keeps its pixels under a key, and something to know about them.
    pub fn put_into(&self, store: &dyn PictureStore, key: PictureKey, about: &[u8]) {
        let tail = [self.width, self.height, about.len() as u32].map(u32::to_le_bytes);
        store.put(key, &[&self.rgba, about, tail.as_flattened()]);
    }

    /// Of its size and pixels.
    pub fn content(&self) -> PictureKey {
        let size = [self.width, self.height].map(u32::to_le_bytes);
        *self.content.get_or_init(|| PictureKey::of(&[size.as_flattened(), &self.rgba]))
    }

    /// The picture as a file, out of a store, or into it.
    pub(super) fn encoded_in(
        &self,
        store: &dyn PictureStore,
        format: PictureFormat,
    ) -> Result<Vec<u8>, PictureError> {
        let made_by = [ENCODER_SOURCE, behaviour(format)].map(u64::to_le_bytes);
        let content = self.content().to_bytes();
        let key = PictureKey::of(&[format.name().as_bytes(), made_by.as_flattened(), &content]);
        if let Some(kept) = store.get(key) {
            return Ok(kept);
        }
        let encoded = encode(self, format, &About::default())?;
        store.put(key, &[&encoded]);
        Ok(encoded)
    }
}

/// How the encoder of a format compresses, as a number. Its crate does not say which version it is: what it makes of a
/// small picture tells.
fn behaviour(format: PictureFormat) -> u64 {
    static KNOWN: [OnceLock<u64>; PictureFormat::ALL.len()] =
        [const { OnceLock::new() }; PictureFormat::ALL.len()];
    *KNOWN[format as usize].get_or_init(|| {
        const SIDE: u32 = 48;
        // Slopes, edges, and what does not repeat.
        let pixel = |i: u32| {
            let (x, y) = (i % SIDE, i / SIDE);
            let noise = i.wrapping_mul(0x9E37_79B9) >> 27;
            [(x * 5 + noise) as u8, (y * 5) as u8, ((x ^ y) * 4) as u8, if x < 40 { 255 } else { 90 }]
        };
        let picture = Picture::new(SIDE, SIDE, (0..SIDE * SIDE).flat_map(pixel).collect());
        let file = encode(&picture, format, &About::default()).unwrap_or_default();
        xxhash_rust::xxh3::xxh3_64(&file)
    })
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;
    use std::sync::{Arc, Mutex};

    use super::*;

    /// A store in memory, with how often it was asked and given something.
    #[derive(Debug, Default)]
    struct Memory(Mutex<(Kept, [usize; 2])>);

    type Kept = BTreeMap<PictureKey, Vec<u8>>;

    impl PictureStore for Memory {
        fn get(&self, key: PictureKey) -> Option<Vec<u8>> {
            let mut kept = self.0.lock().unwrap();
            kept.1[0] += 1;
            kept.0.get(&key).cloned()
        }

        fn put(&self, key: PictureKey, parts: &[&[u8]]) {
            let mut kept = self.0.lock().unwrap();
            kept.1[1] += 1;
            kept.0.insert(key, parts.concat());
        }
    }

    fn picture(shade: u8) -> Picture {
        Picture::new(3, 2, (0..24).map(|i| (i * 7) ^ shade).collect())
    }

    #[test]
    fn what_was_kept_comes_back_and_nothing_else() {
        let store = Memory::default();
        let key = PictureKey::of(&[b"leaf"]);
        assert!(Picture::get_from(&store, key).is_none());
        picture(0).put_into(&store, key, b"about");
        assert_eq!(Picture::get_from(&store, key), Some((picture(0), b"about".to_vec())));
        // A store that keeps less than it was given gives no picture.
        let whole = store.get(key).unwrap();
        for length in 0..whole.len() {
            store.put(key, &[&whole[..length]]);
            assert!(Picture::get_from(&store, key).is_none(), "{length}");
        }
    }

    #[test]
    fn files_are_compressed_once_for_equal_pixels() {
        let store = Arc::new(Memory::default());
        let shared: Arc<dyn PictureStore> = store.clone();
        for format in PictureFormat::ALL {
            let [first, again] = [(); 2].map(|()| {
                let kept = picture(1).kept_in(&shared);
                kept.encoded(format).unwrap().to_vec()
            });
            assert_eq!(first, picture(1).encoded(format).unwrap());
            assert_eq!(first, again);
        }
        let formats = PictureFormat::ALL.len();
        assert_eq!(store.0.lock().unwrap().1, [2 * formats, formats]);
        assert_ne!(picture(2).kept_in(&shared).png().unwrap(), picture(1).png().unwrap());
    }

    #[test]
    fn pictures_of_one_area_are_told_apart() {
        let turned = Picture::new(2, 3, picture(0).rgba().to_vec());
        assert_ne!(turned.content(), picture(0).content());
        assert_ne!(picture(1).content(), picture(0).content());
        assert_eq!(picture(1).content(), picture(1).content());
    }
}
