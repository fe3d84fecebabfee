//! What the decoder of `image` does not tell of a JPEG: how many inks it has, and whether it is whole.

use std::io::Cursor;

use crate::picture::pieces::{self, jpeg_segment, marker};

/// What a JPEG's segments say.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Frame {
    /// 1 grey, 3 colours, 4 inks of a printing press (CMYK, or YCCK, which is the same in other words).
    pub components: u8,
    /// Whether the image's end is marked. The decoder gives grey for what is missing.
    pub is_whole: bool,
}

/// Reads the segments before the pixels; `None` where they are no JPEG's.
pub(super) fn frame(bytes: &[u8]) -> Option<Frame> {
    let mut components = None;
    let mut cursor = Cursor::new(bytes);
    cursor.set_position(pieces::JPEG.len() as u64);
    loop {
        let (marker, length) = jpeg_segment(&mut cursor).ok()?;
        let rest = &bytes[cursor.position() as usize..];
        let (segment, after) = rest.split_at_checked(length.into())?;
        match marker {
            marker::SOS => {
                // Among pixels a zero follows every 0xff (T.81, F.1.2.3): this is a marker.
                let is_whole = after.windows(2).any(|pair| pair == [0xff, marker::EOI]);
                return Some(Frame { components: components?, is_whole });
            }
            // SOF0 to SOF15, but for DHT, JPG and DAC: precision, height, width, components.
            0xc0..=0xcf if ![0xc4, 0xc8, 0xcc].contains(&marker) => components = segment.get(5).copied(),
            _ => {}
        }
        cursor.set_position(cursor.position() + u64::from(length));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn segments_are_walked_and_their_content_is_not() {
        let sof = |components| [&[0xff, 0xff, 0xc2, 0, 8, 8, 0, 1, 0, 1][..], &[components]].concat();
        // Holds what looks like an end, as a thumbnail does.
        let app = [0xff, 0xe1, 0, 4, 0xff, 0xd9];
        let sos = [0xff, 0xda, 0, 2, 7, 7, 0xff, 0];
        let file = |pieces: &[&[u8]]| [&[0xff, 0xd8], &*pieces.concat()].concat();
        let cut = file(&[&app, &sof(4), &sos]);
        assert_eq!(frame(&cut), Some(Frame { components: 4, is_whole: false }));
        let whole = [&*cut, &[0xff, 0xd9, 1, 2, 3]].concat();
        assert_eq!(frame(&whole), Some(Frame { components: 4, is_whole: true }));
        for length in 0..cut.len() - 4 {
            assert_eq!(frame(&cut[..length]), None, "{length}");
        }
        assert_eq!(frame(&file(&[&app, &sos])), None, "no frame before the pixels");
        assert_eq!(frame(&file(&[&[0xff, 0xe1, 0, 1]])), None, "a length that does not count itself");
    }
}
