//! What crate files tell without their specs: all names and texts stand together.

use std::io::{self, Read, SeekFrom};

use super::build::{BOOTSTRAP, MAGIC};
use super::compress::unpacked;
use crate::Readable;

/// More sections than any version has.
const MOST_SECTIONS: u64 = 64;
/// The longest recipe, and as much again for all names.
const LONGEST: u64 = 32 << 20;

/// The tokens of a file, and which of them are strings, in the order of their first use.
pub(crate) struct Names {
    tokens: Vec<String>,
    strings: Vec<u32>,
}

impl Names {
    /// Of the file that begins here; `None` where that is no crate file, or broken.
    ///
    /// # Errors
    /// What reading failed with; a file that ends too early is [`io::ErrorKind::UnexpectedEof`].
    pub fn read(file: &mut dyn Readable) -> io::Result<Option<Self>> {
        let start = file.stream_position()?;
        let mut bootstrap = Vec::new();
        file.take(BOOTSTRAP as u64).read_to_end(&mut bootstrap)?;
        if bootstrap.len() < BOOTSTRAP || !bootstrap.starts_with(MAGIC) {
            return Ok(None);
        }
        let Some(contents) = word(&bootstrap, 16).and_then(|at| start.checked_add(at)) else {
            return Ok(None);
        };
        file.seek(SeekFrom::Start(contents))?;
        let mut count = [0; 8];
        file.read_exact(&mut count)?;
        let count = u64::from_le_bytes(count);
        if count > MOST_SECTIONS {
            return Ok(None);
        }
        let mut entries = vec![0; 32 * count as usize];
        file.read_exact(&mut entries)?;
        let mut section = |name: &str| -> io::Result<Option<Vec<u8>>> {
            let named = entries.chunks_exact(32).find(|entry| {
                entry.strip_prefix(name.as_bytes()).is_some_and(|rest| rest.first() == Some(&0))
            });
            let Some(entry) = named else { return Ok(None) };
            let at = word(entry, 16).and_then(|at| start.checked_add(at));
            let (Some(at), Some(size)) = (at, word(entry, 24).filter(|size| *size <= LONGEST)) else {
                return Ok(None);
            };
            file.seek(SeekFrom::Start(at))?;
            // Grows by what is there, not by what is announced.
            let mut data = Vec::new();
            file.take(size).read_to_end(&mut data)?;
            Ok((data.len() as u64 == size).then_some(data))
        };
        let (Some(tokens), Some(strings)) = (section("TOKENS")?, section("STRINGS")?) else {
            return Ok(None);
        };
        Ok(Self::of(&tokens, &strings))
    }

    fn of(tokens: &[u8], strings: &[u8]) -> Option<Self> {
        let size = word(tokens, 8).filter(|size| *size <= LONGEST)?;
        let text = unpacked(tokens.get(24..)?, size as usize)?;
        let tokens = text.split(|byte| *byte == 0).map(|token| String::from_utf8_lossy(token).into_owned());
        let (numbers, _) = strings.get(8..)?.as_chunks::<4>();
        let strings = numbers.iter().map(|bytes| u32::from_le_bytes(*bytes)).collect();
        Some(Self { tokens: tokens.collect(), strings })
    }

    /// Whether something is called so.
    pub fn has(&self, name: &str) -> bool {
        self.tokens.iter().any(|token| token == name)
    }

    /// Whether something's name begins so.
    pub fn has_beginning(&self, beginning: &str) -> bool {
        self.tokens.iter().any(|token| token.starts_with(beginning))
    }

    /// Whether something is the way to a file of this name.
    pub fn has_file(&self, name: &str) -> bool {
        self.tokens.iter().any(|token| token.rsplit('/').next() == Some(name))
    }

    /// All strings in the order of their first use.
    pub fn strings(&self) -> impl Iterator<Item = &str> {
        self.strings.iter().filter_map(|&token| self.tokens.get(token as usize)).map(String::as_str)
    }

    /// The first recipe: an object behind its key.
    pub fn recipe(&self) -> Option<String> {
        let behind = self.strings().skip_while(|text| *text != "recipe");
        behind.skip(1).find(|text| text.starts_with('{')).map(str::to_owned)
    }
}

fn word(bytes: &[u8], at: usize) -> Option<u64> {
    Some(u64::from_le_bytes(*bytes.get(at..)?.first_chunk()?))
}
