//! Everything but Unix, Windows first: what the standard library knows.
//!
//! Files lie under temporary names from the beginning, and folders are not synced. What is locked can be
//! read by nobody else, and what is open may not be replaced. Nothing outlives us to end a plug-in.

use std::ffi::{OsStr, OsString};
use std::fs::{self, File, Metadata, OpenOptions};
use std::io::{self, Read as _, Seek as _, SeekFrom};
use std::path::{Path, PathBuf};
use std::process::{Child, Command};
use std::time::{Duration, Instant};

/// What is done so that a write-protected file may be written to.
pub const HOW_TO_ALLOW_WRITING: &str = "attrib -r";
/// What to do where the system denies a file, with a separator before it.
pub const DENIED: &str = "; another program may have it open: close it there, or choose a directory of yours";
/// Whether a file can be replaced that is open: on NTFS of late, and elsewhere not.
pub const REPLACES_OPEN_FILES: bool = false;
/// Whether [`change_of`] and [`is_same_file`] know.
pub const TELLS_FILES_APART: bool = false;
/// Bytes that a pipe takes at once.
pub const PIECE: usize = usize::MAX;

/// How long a file that is denied is tried again: scanners for viruses and indexes open what is new for a
/// moment.
const PATIENCE: Duration = Duration::from_secs(1);
/// Between two tries.
const LOOK: Duration = Duration::from_millis(20);
/// What Windows says of a file that another program has opened for itself.
const SHARING_VIOLATION: i32 = 32;

/// There are none.
pub fn create_unnamed(_: &Path, _: u32) -> io::Result<File> {
    Err(io::ErrorKind::Unsupported.into())
}

/// There are none.
pub fn link_unnamed(_: &File, _: &Path) -> io::Result<()> {
    Err(io::ErrorKind::Unsupported.into())
}

/// That is unknown.
pub fn exchange(_: &Path, _: &Path) -> io::Result<()> {
    Err(io::ErrorKind::Unsupported.into())
}

/// Gives a file another name; what had that name before is gone in the same moment. One that is denied is
/// tried again for a while.
pub fn rename(from: &Path, to: &Path) -> io::Result<()> {
    let asked = Instant::now();
    loop {
        match fs::rename(from, to) {
            Err(error) if is_denied(&error) && asked.elapsed() < PATIENCE => std::thread::sleep(LOOK),
            // So that it is known for what it is.
            Err(error) if is_denied(&error) => {
                return Err(io::Error::new(io::ErrorKind::PermissionDenied, error));
            }
            done => return done,
        }
    }
}

fn is_denied(error: &io::Error) -> bool {
    error.kind() == io::ErrorKind::PermissionDenied
        || (cfg!(windows) && error.raw_os_error() == Some(SHARING_VIOLATION))
}

/// Folders are not synced.
pub fn open_folder(_: &Path) -> io::Result<File> {
    Err(io::ErrorKind::Unsupported.into())
}

/// Reads from a place; how many bytes there were. The next write would be behind them.
pub fn read_at(mut file: &File, bytes: &mut [u8], offset: u64) -> io::Result<usize> {
    file.seek(SeekFrom::Start(offset))?;
    file.read(bytes)
}

/// A folder's permissions are its files'.
pub fn with_mode(_: &mut OpenOptions, _: u32) {}

/// Nothing of a temporary name is a link unless somebody made it one.
pub fn opens_no_link(_: &mut OpenOptions) {}

/// Opening waits for nothing here.
pub fn opens_at_once(_: &mut OpenOptions) {}

/// There are none.
pub fn mode_of(_: &Metadata) -> Option<u32> {
    None
}

/// There are none.
#[expect(clippy::unnecessary_wraps, reason = "elsewhere the system can refuse")]
pub fn set_mode(_: &File, _: u32) -> io::Result<()> {
    Ok(())
}

/// Is not told; a file that is open keeps its name for itself.
pub fn is_same_file(_: &Metadata, _: &Metadata) -> bool {
    true
}

/// Is not told.
pub fn change_of(_: &Metadata) -> Option<(u64, (i64, i64))> {
    None
}

/// Is not told.
pub fn is_mine(_: &Metadata) -> bool {
    false
}

/// A name that was written down by [`OsStr::as_encoded_bytes`], if it is of whole characters.
pub fn name_from(bytes: Vec<u8>) -> Option<OsString> {
    String::from_utf8(bytes).ok().map(OsString::from)
}

/// Why no file of this name is made. Windows would take its devices for some, reads the others without
/// what they end in, and takes what follows a colon for a stream of a file.
pub fn refused(name: &OsStr) -> Option<&'static str> {
    let name = name.to_str()?;
    if name.contains(':') {
        return Some("a name with a colon is no file's on Windows; choose one without");
    }
    if name.ends_with([' ', '.']) {
        return Some("Windows finds no file whose name ends in a space or a dot; choose another name");
    }
    let stem = name.split('.').next().unwrap_or(name).trim_end().to_uppercase();
    let numbered = ["COM", "LPT"].iter().filter_map(|device| stem.strip_prefix(device));
    let is_number = |rest: &str| {
        let mut rest = rest.chars();
        matches!((rest.next(), rest.next()), (Some('0'..='9' | '¹' | '²' | '³'), None))
    };
    let is_device = matches!(stem.as_str(), "CON" | "PRN" | "AUX" | "NUL" | "CONIN$" | "CONOUT$")
        || numbered.into_iter().any(is_number);
    is_device.then_some("Windows keeps that name for a device; choose another one")
}

/// Whether a path is that of the device that takes everything: Windows tells nothing of it.
pub fn is_null_device(path: &Path) -> bool {
    path.as_os_str().eq_ignore_ascii_case("nul")
}

/// A path as others are compared with it: two that differ are two files. Windows does not tell large
/// letters from small ones.
pub fn compared(path: PathBuf) -> PathBuf {
    path.to_str().map(|text| text.to_lowercase().into()).unwrap_or(path)
}

/// Whether a file may be run: by its name, which was looked at before.
pub fn is_program(meta: &Metadata) -> bool {
    meta.is_file()
}

/// Is not told apart from other errors.
pub fn leads_in_a_circle(_: &io::Error) -> bool {
    false
}

/// Standard output is the standard library's.
pub fn stdout() -> io::Result<File> {
    Err(io::ErrorKind::Unsupported.into())
}

/// Pipes are no files here.
pub fn has_no_reader(_: &Path, _: &io::Error) -> bool {
    false
}

/// Is not told: writing waits by itself.
#[expect(clippy::unnecessary_wraps, reason = "elsewhere the system can refuse")]
pub fn is_ready(_: &File, _: Duration) -> io::Result<bool> {
    Ok(true)
}

/// Nothing outlives us.
#[derive(Debug)]
pub enum Guard {}

impl Guard {
    /// There is none.
    pub fn start() -> Option<Self> {
        None
    }

    /// Is not called.
    pub fn launcher(&self, _: &Path, _: &Path) -> Option<Command> {
        match *self {}
    }

    /// Is not called.
    pub fn tell(&mut self, _: &[u8]) {
        match *self {}
    }
}

/// All programs of a console are told of Ctrl-C.
pub fn with_process_group(_: &mut Command) {}

/// There is no asking: the caller ends the program.
pub fn ask_to_end(_: &mut Child, _: Duration) {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_devices_and_streams_are_refused() {
        for name in
            ["nul", "AUX.glb", "con.v2.obj", "Com1.ply", "lpt².glb", "aux .glb", "a:b.glb", "oak.", "oak "]
        {
            assert!(refused(OsStr::new(name)).is_some(), "{name}");
        }
        for name in ["oak.glb", "auxin.glb", "com.glb", "com10.glb", "conifer.obj", "Ölbaum.usda", ".aux"] {
            assert_eq!(refused(OsStr::new(name)), None, "{name}");
        }
    }

    #[cfg(windows)]
    #[test]
    fn a_file_that_another_program_keeps_open_is_waited_for_and_then_told() {
        use std::os::windows::fs::OpenOptionsExt as _;
        let dir = tempfile::tempdir().unwrap();
        let (new, old) = (dir.path().join("new"), dir.path().join("old"));
        fs::write(&new, "new").unwrap();
        fs::write(&old, "old").unwrap();
        let keep = || File::options().read(true).share_mode(0).open(&old).unwrap();
        let kept = keep();
        assert_eq!(rename(&new, &old).unwrap_err().kind(), io::ErrorKind::PermissionDenied);
        drop(kept);
        assert_eq!(fs::read_to_string(&old).unwrap(), "old");
        let kept = keep();
        let other = std::thread::spawn(move || {
            std::thread::sleep(LOOK * 5);
            drop(kept);
        });
        rename(&new, &old).unwrap();
        other.join().unwrap();
        assert_eq!(fs::read_to_string(&old).unwrap(), "new");
    }

    #[test]
    fn names_that_differ_in_large_letters_are_one() {
        assert_eq!(compared("/a/Öl.GLB".into()), compared("/a/öl.glb".into()));
        assert_ne!(compared("/a/oel.glb".into()), compared("/a/öl.glb".into()));
    }
}
