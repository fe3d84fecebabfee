//! What is about to be placed, written down: a program that is killed between two files of an export
//! leaves a record of it, and the next run in that folder puts the rest in their places. Without it the
//! OBJ could be new and its materials old. Where files go to several folders, each has the whole record.
//!
//! A record is trusted as far as it can be checked: it is ours by its owner, gives names to nothing but
//! temporary files beside them, and everything is only done while every file is the one that it speaks
//! of, by a number that only the file system gives. Who has replaced or changed one of them since has
//! decided otherwise.

use std::ffi::{OsStr, OsString};
use std::fs::{File, Metadata};
use std::io;
use std::path::{Path, PathBuf};

use super::file_system::{FileSystem, again, synced};
use super::temporary::{RECORD, TempName, is_temporary};
use crate::system::{change_of, is_mine, name_from};

const FIRST_LINE: &str = "linden: files to be placed together";
/// Without it the record was not finished, and so nothing was placed.
const LAST_LINE: &str = "end";
/// More than any export has; what is longer is no record.
const LONGEST: u64 = 1 << 24;

/// A file to be placed.
struct Entry {
    temporary: PathBuf,
    path: PathBuf,
    /// What the temporary name stands for.
    new: Identity,
    /// What is at the place before.
    old: Option<Identity>,
}

/// A file's number, length and time of change, which another file does not have.
#[derive(Clone, Copy, PartialEq, Eq)]
struct Identity {
    inode: u64,
    bytes: u64,
    changed: (i64, i64),
}

impl Identity {
    /// `None` where the system does not tell.
    fn of(meta: &Metadata) -> Option<Self> {
        change_of(meta).map(|(inode, changed)| Self { inode, bytes: meta.len(), changed })
    }
}

/// A record of what is being placed in a folder. Dropped, it is gone.
pub(super) struct Record {
    _name: TempName,
    /// Locked.
    _file: File,
}

impl Record {
    /// What a record says: that files with these temporary names are to be at these paths.
    pub fn text(
        system: &dyn FileSystem,
        files: impl Iterator<Item = (PathBuf, PathBuf)>,
    ) -> io::Result<String> {
        let mut text = format!("{FIRST_LINE}\n");
        for (temporary, path) in files {
            let new = identity(system, &temporary)?.ok_or(io::ErrorKind::NotFound)?;
            let old = identity(system, &path)?;
            text.push_str(&Entry { temporary, path, new, old }.to_line());
        }
        text.push_str(LAST_LINE);
        Ok(text)
    }

    /// Writes it down in a folder.
    pub fn write(system: &'static dyn FileSystem, folder: &Path, text: &str) -> io::Result<Self> {
        let (name, file) = TempName::create(system, folder, RECORD, 0o600)?;
        let mut left = text.as_bytes();
        while !left.is_empty() {
            match again(|| system.write(&file, left))? {
                0 => return Err(io::ErrorKind::WriteZero.into()),
                count => left = &left[count..],
            }
        }
        Ok(Self { _name: name, _file: file })
    }
}

/// Completes what a record speaks of, if it was begun. The record is locked; it can go afterwards,
/// unless there was an error.
pub(super) fn complete(system: &dyn FileSystem, record: &File) -> io::Result<()> {
    let meta = record.metadata()?;
    if !is_mine(&meta) || meta.len() > LONGEST {
        return Ok(());
    }
    let Some(entries) = parse(&read(system, record)?) else { return Ok(()) };
    let mut waiting = Vec::new();
    let mut is_begun = false;
    for entry in &entries {
        let there = identity(system, &entry.path)?;
        let temporary = identity(system, &entry.temporary)?;
        if there == Some(entry.new) {
            is_begun = true;
        } else if there == entry.old && temporary == Some(entry.new) {
            waiting.push(entry);
        } else {
            return Ok(());
        }
    }
    if is_begun && !waiting.is_empty() {
        for entry in waiting {
            again(|| system.rename(&entry.temporary, &entry.path))?;
            let folder = again(|| system.open_folder(entry.path.parent().unwrap_or(Path::new("/"))))?;
            synced(again(|| system.sync(&folder)))?;
        }
    }
    Ok(())
}

/// The regular file at a path.
fn identity(system: &dyn FileSystem, path: &Path) -> io::Result<Option<Identity>> {
    match again(|| system.symlink_metadata(path)) {
        Ok(meta) => Ok(Identity::of(&meta)),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(None),
        Err(error) => Err(error),
    }
}

fn read(system: &dyn FileSystem, file: &File) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    let mut piece = vec![0; 1 << 16];
    loop {
        match again(|| system.read_at(file, &mut piece, bytes.len() as u64))? {
            0 => return Ok(bytes),
            count => bytes.extend_from_slice(&piece[..count]),
        }
    }
}

impl Entry {
    fn to_line(&self) -> String {
        let old = self.old.map_or_else(|| "-".to_owned(), Identity::to_text);
        let (temporary, path) = (hex(self.temporary.as_os_str()), hex(self.path.as_os_str()));
        format!("{temporary} {path} {} {old}\n", self.new.to_text())
    }

    fn parse(line: &str) -> Option<Self> {
        let mut words = line.split(' ');
        let (temporary, path) = (PathBuf::from(unhex(words.next()?)?), PathBuf::from(unhex(words.next()?)?));
        let new = Identity::parse(words.next()?)?;
        let old = match words.next()? {
            "-" => None,
            text => Some(Identity::parse(text)?),
        };
        let is_beside = temporary.parent() == path.parent() && path.is_absolute();
        let is_ours = temporary.file_name().is_some_and(is_temporary) && path.file_name().is_some();
        (is_beside && is_ours).then_some(Self { temporary, path, new, old })
    }
}

impl Identity {
    fn to_text(self) -> String {
        format!("{}:{}:{}:{}", self.inode, self.bytes, self.changed.0, self.changed.1)
    }

    fn parse(text: &str) -> Option<Self> {
        let mut words = text.split(':');
        let (inode, bytes) = (words.next()?.parse().ok()?, words.next()?.parse().ok()?);
        Some(Self { inode, bytes, changed: (words.next()?.parse().ok()?, words.next()?.parse().ok()?) })
    }
}

fn parse(bytes: &[u8]) -> Option<Vec<Entry>> {
    let text = std::str::from_utf8(bytes).ok()?;
    let lines = text.strip_prefix(FIRST_LINE)?.strip_prefix('\n')?.strip_suffix(LAST_LINE)?;
    lines.lines().map(Entry::parse).collect()
}

/// Names may be any bytes.
fn hex(name: &OsStr) -> String {
    let digit = |value: u8| char::from_digit(value.into(), 16).unwrap_or('0');
    name.as_encoded_bytes().iter().flat_map(|byte| [digit(byte >> 4), digit(byte & 15)]).collect()
}

fn unhex(text: &str) -> Option<OsString> {
    let digit = |byte: u8| char::from(byte).to_digit(16).and_then(|digit| u8::try_from(digit).ok());
    let pairs = text.as_bytes().chunks(2);
    let bytes: Option<Vec<u8>> = pairs
        .map(|pair| match pair {
            [high, low] => Some((digit(*high)? << 4) | digit(*low)?),
            _ => None,
        })
        .collect();
    bytes.and_then(name_from)
}

#[cfg(all(test, unix, not(linden_portable)))]
mod tests {
    use super::*;

    #[test]
    fn an_entry_is_read_as_it_was_written_and_names_temporary_files_only() {
        let identity = Identity { inode: u64::MAX, bytes: 7, changed: (-1, 999_999_999) };
        let entry = |temporary: &str, path: &[u8]| Entry {
            temporary: temporary.into(),
            path: name_from(path.to_vec()).unwrap().into(),
            new: identity,
            old: None,
        };
        let entry_of_file = entry("/b\u{e4}/.linden-1-2.part", "/b\u{e4}/b\u{e4}um 1\n.obj".as_bytes());
        let line = entry_of_file.to_line();
        let read = Entry::parse(line.trim_end()).unwrap();
        assert_eq!((&read.temporary, &read.path), (&entry_of_file.temporary, &entry_of_file.path));
        assert!(read.new == identity && read.old.is_none());
        for path in [&b"/a/../fir.obj"[..], b"/etc/passwd", b"fir.obj", b"/a/b/c", b"/a/..", b"", b"\xff"] {
            let line = entry("/a/.linden-1-2.part", path).to_line();
            assert!(Entry::parse(line.trim_end()).is_none(), "{path:?}");
        }
        assert!(Entry::parse(entry("/a/fir.obj", b"/a/b").to_line().trim_end()).is_none());
        let whole = format!("{FIRST_LINE}\n{line}{LAST_LINE}");
        assert_eq!(parse(whole.as_bytes()).unwrap().len(), 1);
        for end in 0..whole.len() {
            assert!(parse(&whole.as_bytes()[..end]).is_none(), "half a record is none: {end}");
        }
    }
}
