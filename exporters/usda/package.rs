//! USD in one file (`.usdz`): a ZIP archive whose entries are stored as they are, the layer first, and
//! each beginning at a multiple of 64 bytes, so that readers map them into memory.
//!
//! <https://openusd.org/release/spec_usdz.html>. The container is PKWARE's APPNOTE 6.3.10, of which a
//! stored archive needs three records; dates are 1980-01-01, the earliest there is.

use crate::ExportError;

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
pub(super) struct Package {
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
    /// Adds a file; `name` is ASCII or UTF-8 without folders.
    ///
    /// # Errors
    /// [`ExportError::TooLarge`] where 32 bits do not reach.
    pub fn push(&mut self, name: &str, data: &[u8]) -> Result<(), ExportError> {
        let at = narrow(self.bytes.len())?;
        let size = narrow(data.len())?;
        narrow(self.bytes.len() + data.len() + LOCAL_HEADER + name.len() + 2 * ALIGNMENT)?;
        let start = self.bytes.len() + LOCAL_HEADER + name.len() + FIELD_HEADER;
        let padding = start.next_multiple_of(ALIGNMENT) - start;
        let entry = Entry { name: name.to_owned(), crc: crc32(data), size, at };
        self.bytes.extend(0x0403_4b50_u32.to_le_bytes());
        self.bytes.extend(entry.common());
        self.shorts(&[name.len() as u16, (FIELD_HEADER + padding) as u16]);
        self.bytes.extend(name.as_bytes());
        self.shorts(&[PADDING, padding as u16]);
        self.bytes.resize(self.bytes.len() + padding, 0);
        self.bytes.extend(data);
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
            self.shorts(&[10]);
            self.bytes.extend(entry.common());
            self.shorts(&[entry.name.len() as u16, 0, 0, 0, 0, 0, 0]);
            self.bytes.extend(entry.at.to_le_bytes());
            self.bytes.extend(entry.name.as_bytes());
            self.entries.push(entry);
        }
        let length = narrow(self.bytes.len() - directory as usize)?;
        let count = self.entries.len() as u16;
        self.bytes.extend(0x0605_4b50_u32.to_le_bytes());
        self.shorts(&[0, 0, count, count]);
        self.bytes.extend(length.to_le_bytes());
        self.bytes.extend(directory.to_le_bytes());
        self.shorts(&[0]);
        Ok(self.bytes)
    }

    fn shorts(&mut self, words: &[u16]) {
        self.bytes.extend(words.iter().flat_map(|word| word.to_le_bytes()));
    }
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

/// CRC-32 as ZIP has it (ISO 3309), eight bytes at a step: Kounavis & Berry, "Novel table lookup-based
/// algorithms for high-performance CRC generation" (2008).
fn crc32(data: &[u8]) -> u32 {
    static TABLES: [[u32; 256]; 8] = tables();
    let mut crc = !0_u32;
    let (eights, rest) = data.as_chunks::<8>();
    for chunk in eights {
        let bytes = (u64::from_le_bytes(*chunk) ^ u64::from(crc)).to_le_bytes();
        crc = (0..8).fold(0, |sum, i| sum ^ TABLES[7 - i][usize::from(bytes[i])]);
    }
    for &byte in rest {
        crc = (crc >> 8) ^ TABLES[0][usize::from(crc as u8 ^ byte)];
    }
    !crc
}

const fn tables() -> [[u32; 256]; 8] {
    let mut tables = [[0; 256]; 8];
    let mut byte = 0;
    while byte < 256 {
        let mut crc = byte as u32;
        let mut bit = 0;
        while bit < 8 {
            crc = if crc & 1 == 1 { (crc >> 1) ^ 0xedb8_8320 } else { crc >> 1 };
            bit += 1;
        }
        tables[0][byte] = crc;
        byte += 1;
    }
    let mut table = 1;
    while table < 8 {
        let mut byte = 0;
        while byte < 256 {
            let before = tables[table - 1][byte];
            tables[table][byte] = (before >> 8) ^ tables[0][(before & 0xff) as usize];
            byte += 1;
        }
        table += 1;
    }
    tables
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sum_is_the_published_one() {
        // The check value of CRC-32/ISO-HDLC in the catalogue of parametrised CRC algorithms.
        assert_eq!(crc32(b"123456789"), 0xcbf4_3926);
        assert_eq!(crc32(b""), 0);
        let long: Vec<u8> = (0..1000_u32).map(|i| (i * 7) as u8).collect();
        let slow = long.iter().fold(!0_u32, |crc, &byte| {
            (0..8).fold(crc ^ u32::from(byte), |crc, _| (crc >> 1) ^ (0xedb8_8320 * (crc & 1)))
        });
        assert_eq!(crc32(&long), !slow);
    }

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
