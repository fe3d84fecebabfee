//! USD in one file (`.usdz`), and 3MF: a ZIP archive whose entries are stored as they are, the layer first, and
//! each beginning at a multiple of 64 bytes, so that readers map them into memory.
//!
//! <https://openusd.org/release/spec_usdz.html>. The container is PKWARE's APPNOTE 6.3.10, of which a
//! stored archive needs three records; dates are 1980-01-01, the earliest there is.
//!
//! By hand rather than by the crate zip 9.8: layers are written where they stay, by writers that append to a
//! `Vec`, and are not held twice; and [`first`] reads the recipe of any archive without its directory.

use std::io;

use crate::ExportError;
use crate::recipe::{self, Readable};

/// Where the data of an entry may begin.
const ALIGNMENT: usize = 64;
/// Bytes of a local header without its name.
const LOCAL_HEADER: usize = 30;
/// Bytes of a field of the header before its own data: what it is, and how long.
const FIELD_HEADER: usize = 4;
/// A field's number for padding (as `zipalign` has it).
const PADDING: u16 = 0xd935;
/// 1980-01-01 as MS-DOS has dates; the time is 0.
const DATE: u16 = 0x21;

/// An archive that is put together in memory.
#[derive(Default)]
pub(crate) struct Package {
    bytes: Vec<u8>,
    entries: Vec<Entry>,
}

struct Entry {
    name: String,
    crc: u32,
    size: u32,
    at: u32,
}

impl Package {
    /// An empty archive with room for so many bytes.
    pub fn with_capacity(bytes: usize) -> Self {
        Self { bytes: Vec::with_capacity(bytes), entries: Vec::new() }
    }

    /// Adds a file; `name` is ASCII or UTF-8.
    ///
    /// # Errors
    /// [`ExportError::TooLarge`] where 32 bits do not reach.
    pub fn push(&mut self, name: &str, data: &[u8]) -> Result<(), ExportError> {
        self.push_with(name, |bytes| {
            bytes.extend(data);
            Ok(())
        })
    }

    /// Adds a file that is written where it stays: appended to the archive's bytes.
    ///
    /// # Errors
    /// As [`Package::push`], and those of `write`.
    pub fn push_with(
        &mut self,
        name: &str,
        write: impl FnOnce(&mut Vec<u8>) -> Result<(), ExportError>,
    ) -> Result<(), ExportError> {
        let at = self.bytes.len();
        let start = (at + LOCAL_HEADER + name.len() + FIELD_HEADER).next_multiple_of(ALIGNMENT);
        // Sum and size are known when the data stand.
        self.bytes.resize(start, 0);
        write(&mut self.bytes)?;
        narrow(self.bytes.len())?;
        let data = &self.bytes[start..];
        let (crc, size) = (crc32fast::hash(data), narrow(data.len())?);
        let entry = Entry { name: name.to_owned(), crc, size, at: narrow(at)? };
        let padding = start - at - LOCAL_HEADER - name.len() - FIELD_HEADER;
        let mut header = Vec::with_capacity(start - at);
        header.extend(0x0403_4b50_u32.to_le_bytes());
        header.extend(entry.common());
        header.extend(shorts(&[name.len() as u16, (FIELD_HEADER + padding) as u16]));
        header.extend(name.as_bytes());
        header.extend(shorts(&[PADDING, padding as u16]));
        self.bytes[at..at + header.len()].copy_from_slice(&header);
        self.entries.push(entry);
        Ok(())
    }

    /// The archive.
    ///
    /// # Errors
    /// As [`Package::push`].
    pub fn finish(mut self) -> Result<Vec<u8>, ExportError> {
        let directory = narrow(self.bytes.len())?;
        for entry in std::mem::take(&mut self.entries) {
            self.bytes.extend(0x0201_4b50_u32.to_le_bytes());
            // Made by version 1.0 on MS-DOS: no permissions.
            self.bytes.extend(shorts(&[10]));
            self.bytes.extend(entry.common());
            self.bytes.extend(shorts(&[entry.name.len() as u16, 0, 0, 0, 0, 0, 0]));
            self.bytes.extend(entry.at.to_le_bytes());
            self.bytes.extend(entry.name.as_bytes());
            self.entries.push(entry);
        }
        let length = narrow(self.bytes.len() - directory as usize)?;
        let count = self.entries.len() as u16;
        self.bytes.extend(0x0605_4b50_u32.to_le_bytes());
        self.bytes.extend(shorts(&[0, 0, count, count]));
        self.bytes.extend(length.to_le_bytes());
        self.bytes.extend(directory.to_le_bytes());
        self.bytes.extend(shorts(&[0]));
        Ok(self.bytes)
    }
}

/// What `read` finds in the first entry of an archive, where that is stored as it is. Its size is not
/// looked at: what reads it knows where it ends.
pub(crate) fn first<T>(
    file: &mut dyn Readable,
    read: impl FnOnce(&mut dyn Readable) -> io::Result<Option<T>>,
) -> io::Result<Option<T>> {
    if !recipe::begins(file, b"PK\x03\x04")? {
        return Ok(None);
    }
    let mut header = [0; LOCAL_HEADER - 4];
    file.read_exact(&mut header)?;
    let short = |at: usize| i64::from(u16::from_le_bytes([header[at], header[at + 1]]));
    // Version, flags, method, time, date, sum, two sizes, the lengths of name and extra fields.
    if short(4) != 0 {
        return Ok(None);
    }
    recipe::skip(file, short(22) + short(24))?;
    read(file)
}

fn shorts(words: &[u16]) -> impl Iterator<Item = u8> {
    words.iter().flat_map(|word| word.to_le_bytes())
}

impl Entry {
    /// What local header and directory share: version, flags, method, time, date, sum, sizes.
    fn common(&self) -> Vec<u8> {
        // Bit 11: the name is UTF-8.
        let flags: u16 = if self.name.is_ascii() { 0 } else { 0x800 };
        let mut bytes: Vec<u8> = [10, flags, 0, 0, DATE].iter().flat_map(|word| word.to_le_bytes()).collect();
        for word in [self.crc, self.size, self.size] {
            bytes.extend(word.to_le_bytes());
        }
        bytes
    }
}

fn narrow(bytes: usize) -> Result<u32, ExportError> {
    u32::try_from(bytes).map_err(|_| ExportError::TooLarge {
        format: "usdz",
        amount: format!("{bytes} bytes"),
        limit: "4 GiB",
        advice: "write .usda instead, or lower the resolution",
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn data_begins_at_multiples_of_64() {
        let mut package = Package::default();
        let files =
            [("tree.usda", &b"#usda 1.0\n"[..]), ("tree_bark.png", &[7; 100]), ("\u{d6}.png", &[9; 64])];
        for (name, data) in files {
            package.push(name, data).unwrap();
        }
        let bytes = package.finish().unwrap();
        for (_, data) in files {
            let at = bytes.windows(data.len()).position(|window| window == data).unwrap();
            assert_eq!(at % 64, 0);
        }
    }
}
