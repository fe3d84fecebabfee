//! What the decoder of `image` does not tell of a WebP: whether it is whole, and what decoding it takes.

use std::io::Cursor;

use crate::picture::pieces::webp_chunk;

/// Groups of Huffman codes that libwebp writes at most, bytes of each when decoded (five tables of 1024
/// entries), and bytes of a file that one takes at least.
const GROUPS: (u64, u64, u64) = (2600, 5 << 12, 50);

/// What a WebP's chunks say.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Chunks {
    /// Bytes of its lossless parts: pixels, or the alpha of lossy ones.
    lossless: u64,
    /// Whether the pixels are lossy.
    is_lossy: bool,
    /// Whether lossy pixels have alpha.
    has_lossy_alpha: bool,
}

/// Reads the lengths of all chunks; `None` where they claim more than there is, which the decoder would
/// allocate.
pub(super) fn chunks(bytes: &[u8]) -> Option<Chunks> {
    let mut found = Chunks::default();
    let mut cursor = Cursor::new(bytes);
    cursor.set_position(12);
    while cursor.position() < bytes.len() as u64 {
        let (kind, length) = webp_chunk(&mut cursor).ok()?;
        let length = u64::from(length);
        let end = cursor.position() + length;
        if end > bytes.len() as u64 {
            return None;
        }
        match &kind {
            b"VP8 " => found.is_lossy = true,
            b"VP8L" => found.lossless += length,
            b"ALPH" => {
                found.has_lossy_alpha = true;
                found.lossless += length;
            }
            _ => {}
        }
        cursor.set_position(end + length % 2);
    }
    Some(found)
}

impl Chunks {
    /// Bytes that decoding takes besides the pixels that it gives, three or four bytes each.
    ///
    /// A file that is made to waste memory can take 1.3 GiB more, by codes that it never uses: the decoder has
    /// no limit for those.
    pub fn scratch_bytes(self, pixels: u64, has_alpha: bool) -> u64 {
        let (most_groups, group_bytes, file_bytes) = GROUPS;
        let codes = most_groups.min(self.lossless / file_bytes) * group_bytes;
        // Planes of colour with half the resolution in two of them; alpha as the green of four channels, and
        // alone. Lossless pixels come with four channels; predictors and codes change every few pixels.
        let each = match (self.is_lossy, self.has_lossy_alpha, has_alpha) {
            (true, false, _) | (false, _, true) => 2,
            (true, true, _) => 8,
            (false, _, false) => 6,
        };
        pixels * each + codes
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_are_not_believed() {
        let file = |length: u32, rest: &[u8]| {
            [b"RIFF\0\0\0\0WEBPVP8L".as_slice(), &length.to_le_bytes(), rest].concat()
        };
        let odd = [file(3, &[1, 2, 3, 0]), b"EXIF\x01\0\0\0\x07\0".to_vec()].concat();
        assert_eq!(chunks(&odd), Some(Chunks { lossless: 3, ..Chunks::default() }));
        assert_eq!(chunks(&file(5, &[1, 2, 3, 0])), None);
        assert_eq!(chunks(&file(u32::MAX, &[])), None);
        assert_eq!(chunks(&odd[..odd.len() - 4]), None);
    }
}
