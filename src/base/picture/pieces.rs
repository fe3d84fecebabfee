//! The pieces that picture files are made of: what the next one is, and how long. Their content is for others.

use std::io::{self, ErrorKind, Read};

/// How a PNG begins.
pub const PNG: [u8; 8] = *b"\x89PNG\r\n\x1a\n";
/// How a JPEG begins: the marker SOI.
pub const JPEG: [u8; 2] = [0xff, 0xd8];

/// Markers of JPEG segments (ITU-T T.81, table B.1).
pub mod marker {
    /// Applications' data; Exif is one of them.
    pub const APP1: u8 = 0xe1;
    /// The scan: what follows the segment are pixels.
    pub const SOS: u8 = 0xda;
    /// The end of the image.
    pub const EOI: u8 = 0xd9;
}

/// Whether a file that begins like this is a WebP.
pub fn is_webp(opening: &[u8]) -> bool {
    opening.starts_with(b"RIFF") && opening.get(8..12) == Some(b"WEBP")
}

/// The kind and length of a PNG's next chunk; a checksum of four bytes follows what it holds.
pub fn png_chunk(file: &mut (impl Read + ?Sized)) -> io::Result<([u8; 4], u32)> {
    let mut head = [0; 8];
    file.read_exact(&mut head)?;
    let [a, b, c, d, kind @ ..] = head;
    Ok((kind, u32::from_be_bytes([a, b, c, d])))
}

/// The kind and length of a WebP's next chunk; what it holds is filled up to an even length.
pub fn webp_chunk(file: &mut (impl Read + ?Sized)) -> io::Result<([u8; 4], u32)> {
    let mut head = [0; 8];
    file.read_exact(&mut head)?;
    let [kind @ .., a, b, c, d] = head;
    Ok((kind, u32::from_le_bytes([a, b, c, d])))
}

/// The marker of a JPEG's next segment, and the length of what follows (T.81, B.1.1).
pub fn jpeg_segment(file: &mut (impl Read + ?Sized)) -> io::Result<(u8, u16)> {
    let mut head = [0; 2];
    file.read_exact(&mut head)?;
    // Any number of 0xff may stand before a marker.
    while head == [0xff, 0xff] {
        file.read_exact(&mut head[1..])?;
    }
    let mut length = [0; 2];
    file.read_exact(&mut length)?;
    // The length counts itself.
    match (head, u16::from_be_bytes(length).checked_sub(2)) {
        ([0xff, marker], Some(length)) => Ok((marker, length)),
        _ => Err(ErrorKind::InvalidData.into()),
    }
}
