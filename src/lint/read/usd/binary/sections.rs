//! The sections of a crate file: names, fields, sets of fields, specs.

use openusd::sdf::Path;

use super::super::{ReadError, broken};
use super::bytes::{Bytes, Room};
use super::packed::{blocks, integers};
use super::{paths, values::Rep};

/// More than any version has.
const MOST_SECTIONS: usize = 64;
/// Ends a set of fields.
pub(super) const END: u32 = u32::MAX;

/// Where the sections are.
pub(super) struct Sections<'a> {
    file: &'a [u8],
    /// Their names with zeros behind, their bytes.
    entries: Vec<([u8; 16], u64, u64)>,
}

/// Tokens, and those that are strings.
pub(super) struct Names {
    text: String,
    /// Where in it each token ends.
    tokens: Vec<usize>,
    strings: Vec<u32>,
}

impl<'a> Sections<'a> {
    /// The table of contents.
    pub fn read(file: &'a [u8], place: u64) -> Result<Self, ReadError> {
        let mut bytes = Bytes::at(file, place, "the table of contents")?;
        let count = bytes.count()?;
        if count > MOST_SECTIONS {
            return Err(
                bytes.broken(&format!("says that there are {count} sections; no version has so many"))
            );
        }
        let mut entries = Vec::with_capacity(count);
        for _ in 0..count {
            entries.push((bytes.numbers()?, bytes.word()?, bytes.word()?));
        }
        Ok(Self { file, entries })
    }

    fn section(&self, name: &str, what: &'static str) -> Result<Bytes<'a>, ReadError> {
        let named = self.entries.iter().find(|(known, ..)| {
            known.strip_prefix(name.as_bytes()).is_some_and(|rest| rest.first() == Some(&0))
        });
        let (_, at, size) =
            named.ok_or_else(|| broken(format!("{what} is missing; write the file again")))?;
        let bytes = usize::try_from(*at).ok().zip(usize::try_from(*size).ok());
        let bytes = bytes.and_then(|(at, size)| self.file.get(at..at.checked_add(size)?));
        let bytes = bytes.ok_or_else(|| {
            broken(format!(
                "{what} ends behind the file's end; the file is damaged or cut off: write it again"
            ))
        })?;
        Ok(Bytes::new(bytes, what))
    }

    pub fn names(&self, room: &mut Room<'_>) -> Result<Names, ReadError> {
        let what = "the section TOKENS";
        let mut bytes = self.section("TOKENS", what)?;
        let (count, size) = (bytes.count()?, bytes.count()?);
        let text = blocks(bytes.counted()?, size, what, room)?;
        let text = String::from_utf8(text).map_err(|_| bytes.broken("has names that are no UTF-8 text"))?;
        let ends = || text.bytes().enumerate().filter(|(_, byte)| *byte == 0).map(|(at, _)| at);
        if text.len() != size || ends().count() != count {
            return Err(bytes.short());
        }
        room.take(count, size_of::<usize>())?;
        let tokens = ends().collect();
        let mut bytes = self.section("STRINGS", "the section STRINGS")?;
        let count = bytes.count()?;
        let (numbers, _) = bytes.elements(count, 4)?.as_chunks();
        room.take(count, 4)?;
        Ok(Names {
            text,
            tokens,
            strings: numbers.iter().map(|number| u32::from_le_bytes(*number)).collect(),
        })
    }

    /// Names of fields, and their values.
    pub fn fields<'n>(
        &self,
        names: &'n Names,
        room: &mut Room<'_>,
    ) -> Result<Vec<(&'n str, Rep)>, ReadError> {
        let what = "the section FIELDS";
        let mut bytes = self.section("FIELDS", what)?;
        let count = bytes.count()?;
        let tokens: Vec<u32> = integers(bytes.counted()?, count, what, room)?;
        room.take(count, size_of::<(&str, Rep)>())?;
        let values = blocks(bytes.counted()?, count.saturating_mul(8), what, room)?;
        let (values, _) = values.as_chunks();
        if values.len() != count {
            return Err(bytes.short());
        }
        let values = values.iter().map(|value| Rep(u64::from_le_bytes(*value)));
        tokens.into_iter().zip(values).map(|(token, value)| Ok((names.token(token)?, value))).collect()
    }

    /// All sets one behind the other, each with its [`END`].
    pub fn field_sets(&self, room: &mut Room<'_>) -> Result<Vec<u32>, ReadError> {
        let what = "the section FIELDSETS";
        let mut bytes = self.section("FIELDSETS", what)?;
        let count = bytes.count()?;
        integers(bytes.counted()?, count, what, room)
    }

    pub fn paths(&self, names: &Names, room: &mut Room<'_>) -> Result<Vec<Path>, ReadError> {
        paths::read(self.section("PATHS", paths::WHAT)?, names, room)
    }

    /// The path, the set of fields and the kind of each spec.
    pub fn specs(&self, room: &mut Room<'_>) -> Result<impl Iterator<Item = [u32; 3]> + use<>, ReadError> {
        let what = "the section SPECS";
        let mut bytes = self.section("SPECS", what)?;
        let count = bytes.count()?;
        let mut numbers = || integers::<u32>(bytes.counted()?, count, what, room);
        let (paths, sets, kinds) = (numbers()?, numbers()?, numbers()?);
        Ok(paths.into_iter().zip(sets).zip(kinds).map(|((path, set), kind)| [path, set, kind]))
    }
}

impl Names {
    pub fn token(&self, number: u32) -> Result<&str, ReadError> {
        let number = number as usize;
        let start = number.checked_sub(1).map_or(Some(0), |before| Some(self.tokens.get(before)? + 1));
        let token = start.zip(self.tokens.get(number)).and_then(|(start, end)| self.text.get(start..*end));
        token.ok_or_else(|| broken("something is called by a name that is not in the section TOKENS"))
    }

    pub fn string(&self, number: u32) -> Result<&str, ReadError> {
        let token = self.strings.get(number as usize);
        self.token(*token.ok_or_else(|| broken("a text is not in the section STRINGS"))?)
    }
}
