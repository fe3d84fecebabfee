//! A package: an archive whose files are stored as they are (<https://openusd.org/release/spec_usdz.html>).

use super::{ReadError, broken};
use crate::read::Beside;

/// The files of a package, in their order.
pub(super) struct Package<'a>(Vec<(String, &'a [u8])>);

/// Bytes of a local header without its name.
const HEADER: usize = 30;

impl<'a> Package<'a> {
    pub fn read(bytes: &'a [u8]) -> Result<Self, ReadError> {
        let (mut files, mut at) = (Vec::new(), 0);
        while let Some(header) = bytes.get(at..at + HEADER).filter(|header| header.starts_with(b"PK\x03\x04"))
        {
            let short = |at: usize| u16::from_le_bytes([header[at], header[at + 1]]);
            let size = u32::from_le_bytes([header[22], header[23], header[24], header[25]]) as usize;
            if short(8) != 0 || short(6) & 8 != 0 {
                return Err(broken("its package has files that are packed, which packages may not have"));
            }
            let name = at + HEADER;
            let data = name + usize::from(short(26)) + usize::from(short(28));
            let file = data.checked_add(size).and_then(|end| bytes.get(data..end));
            let file = file.ok_or_else(|| broken("its package ends within a file"))?;
            let name = String::from_utf8_lossy(&bytes[name..name + usize::from(short(26))]).into_owned();
            files.push((name, file));
            at = data + size;
        }
        if files.is_empty() { Err(broken("its package is empty")) } else { Ok(Self(files)) }
    }

    /// The layer.
    pub fn first(&self) -> Option<&'a [u8]> {
        self.0.first().map(|(_, file)| *file)
    }
}

impl Beside for Package<'_> {
    fn read(&self, name: &str) -> Result<Option<Vec<u8>>, String> {
        let name = name.trim_start_matches("./");
        Ok(self.0.iter().find(|(known, _)| known == name).map(|(_, file)| file.to_vec()))
    }
}
