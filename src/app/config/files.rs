//! Reads files of bounded size, and writes files that are there as a whole or not at all.

use std::fs;
use std::io::{ErrorKind, Read};
use std::path::Path;

use linden::preset::TextPlace;
use linden_exporters::write_file;

use super::Complaint;
use crate::reading;

/// Reads a regular file of at most `limit` bytes; `None` when there is none.
///
/// Pipes and devices are refused before they are opened: opening them can wait for ever.
pub fn read(path: &Path, limit: u64) -> Result<Option<Vec<u8>>, Complaint> {
    let failed = |error: &std::io::Error| Complaint::new(path, format!("cannot be read: {error}"));
    let about = match fs::metadata(path) {
        Ok(about) => about,
        // A link that leads nowhere is there, and its owner wants to know.
        Err(error) if error.kind() == ErrorKind::NotFound && fs::symlink_metadata(path).is_err() => {
            return Ok(None);
        }
        Err(error) => return Err(failed(&error)),
    };
    if about.is_dir() {
        return Err(Complaint::new(path, "is a directory, where a file was expected; rename or remove it"));
    }
    if !about.is_file() {
        return Err(Complaint::new(path, "is a pipe or a device, where a file was expected"));
    }
    let mut bytes = Vec::new();
    let read = reading::open_regular(path).and_then(|file| file.take(limit + 1).read_to_end(&mut bytes));
    read.map_err(|error| failed(&error))?;
    if bytes.len() as u64 > limit {
        let limit_mib = limit >> 20;
        return Err(Complaint::new(path, format!("is larger than {limit_mib} MiB and was not read")));
    }
    Ok(Some(bytes))
}

/// The same, as text.
pub fn read_text(path: &Path, limit: u64) -> Result<Option<String>, Complaint> {
    let Some(bytes) = read(path, limit)? else { return Ok(None) };
    into_text(path, bytes).map(Some)
}

/// A file's bytes as text, or where they stop being any.
pub fn into_text(path: &Path, bytes: Vec<u8>) -> Result<String, Complaint> {
    String::from_utf8(bytes).map_err(|error| {
        let end = error.utf8_error().valid_up_to();
        let before = String::from_utf8_lossy(&error.as_bytes()[..end]);
        let place = TextPlace::at(&before, end);
        Complaint::at(path, Some(place), "is not UTF-8 text here; save the file as UTF-8")
    })
}

/// Who may read a file that is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Readers {
    /// Its owner.
    Owner,
    /// As the user's umask has it.
    Umask,
}

/// What to do where a file of that name is already.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Existing {
    /// Replace it.
    Replace,
    /// Leave it alone and fail with [`ErrorKind::AlreadyExists`].
    Keep,
}

/// Writes a whole file or nothing, to the disk, as exports are written. Makes the directory.
///
/// A program that reads at the same time sees the old file or the new one. A link is followed: the file that
/// it names is replaced, the link stays.
pub fn write(path: &Path, bytes: &[u8], readers: Readers, existing: Existing) -> std::io::Result<()> {
    if let Some(dir) = path.parent().filter(|dir| !dir.as_os_str().is_empty()) {
        fs::create_dir_all(dir)?;
    }
    let mode = match readers {
        Readers::Owner => 0o600,
        Readers::Umask => 0o666,
    };
    write_file(path, bytes, mode, existing == Existing::Replace)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_file_is_refused_and_nothing_is_no_complaint() {
        let dir = tempfile::tempdir().unwrap();
        assert_eq!(read(&dir.path().join("none"), 10), Ok(None));
        assert!(read(dir.path(), 10).unwrap_err().message.contains("directory"));
        assert!(read(Path::new("/dev/zero"), 10).unwrap_err().message.contains("device"));
        let link = dir.path().join("loop");
        std::os::unix::fs::symlink(&link, &link).unwrap();
        assert!(read(&link, 10).unwrap_err().message.contains("cannot be read"));
        let nowhere = dir.path().join("nowhere");
        std::os::unix::fs::symlink(dir.path().join("none"), &nowhere).unwrap();
        assert!(read(&nowhere, 10).is_err());
    }

    #[test]
    fn a_file_is_read_up_to_the_limit_and_refused_beyond_it() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("a");
        fs::write(&path, [b'x'; 11]).unwrap();
        assert_eq!(read(&path, 11).unwrap().unwrap().len(), 11);
        assert!(read(&path, 10).unwrap_err().message.contains("larger"));
    }

    #[test]
    fn bytes_that_are_no_text_are_found() {
        let error = into_text(Path::new("a"), b"one\ntw\xc3\xb6\xff".to_vec()).unwrap_err();
        assert_eq!(error.place, Some((2, 4)));
    }

    #[test]
    fn writing_replaces_what_a_link_names_and_leaves_nothing_beside_it() {
        let dir = tempfile::tempdir().unwrap();
        let (real, link) = (dir.path().join("real"), dir.path().join("link"));
        fs::write(&real, "old").unwrap();
        std::os::unix::fs::symlink(&real, &link).unwrap();
        write(&link, b"new", Readers::Umask, Existing::Replace).unwrap();
        assert_eq!(fs::read_to_string(&real).unwrap(), "new");
        assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
        let error = write(&real, b"other", Readers::Umask, Existing::Keep).unwrap_err();
        assert_eq!(error.kind(), ErrorKind::AlreadyExists);
        assert_eq!(fs::read_to_string(&real).unwrap(), "new");
        assert_eq!(fs::read_dir(dir.path()).unwrap().count(), 2);
    }

    #[test]
    fn the_session_is_its_owners_alone() {
        use std::os::unix::fs::PermissionsExt as _;
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("deep/er/file");
        write(&path, b"", Readers::Owner, Existing::Replace).unwrap();
        assert_eq!(fs::metadata(&path).unwrap().permissions().mode() & 0o777, 0o600);
    }
}
