//! Unix.

mod guard;

use std::ffi::{OsStr, OsString};
use std::fs::{self, File, Metadata, OpenOptions, Permissions};
use std::io;
use std::os::fd::AsFd as _;
use std::os::unix::ffi::OsStringExt as _;
use std::os::unix::fs::{
    FileExt as _, FileTypeExt as _, MetadataExt as _, OpenOptionsExt as _, PermissionsExt as _,
};
use std::path::{Path, PathBuf};
use std::time::Duration;

use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::fs::OFlags;
use rustix::io::Errno;

pub(crate) use guard::{Guard, ask_to_end, with_process_group};

/// What is done so that a write-protected file may be written to.
pub const HOW_TO_ALLOW_WRITING: &str = "chmod u+w";
/// What to do where the system denies a file, with a separator before it.
pub const DENIED: &str = "; you may not write there: choose a directory of yours or ask for permission";
/// Whether a file can be replaced that is open.
pub const REPLACES_OPEN_FILES: bool = true;
/// Whether [`change_of`] and [`is_same_file`] know.
pub const TELLS_FILES_APART: bool = true;
/// Bytes that a pipe takes without blocking when it says that it takes any (POSIX: at least 512, and
/// what Linux and macOS say is atomic).
pub const PIECE: usize = if cfg!(target_os = "linux") { 4096 } else { 512 };

/// A file without a name in a folder, open for reading and writing: the system takes it back when it is
/// closed. [`io::ErrorKind::Unsupported`] where there are none.
#[cfg(target_os = "linux")]
pub fn create_unnamed(folder: &Path, mode: u32) -> io::Result<File> {
    let flags = OFlags::TMPFILE | OFlags::RDWR | OFlags::CLOEXEC;
    let file = File::from(rustix::fs::open(folder, flags, rustix::fs::Mode::from_raw_mode(mode))?);
    // It is named by way of this link: without it a file could be written and never placed.
    fs::symlink_metadata(link_of(&file)).map_err(|_| io::ErrorKind::Unsupported)?;
    Ok(file)
}

/// There are none.
#[cfg(not(target_os = "linux"))]
pub fn create_unnamed(_: &Path, _: u32) -> io::Result<File> {
    Err(io::ErrorKind::Unsupported.into())
}

/// Gives a file from [`create_unnamed`] a name that is not taken.
#[cfg(target_os = "linux")]
pub fn link_unnamed(file: &File, path: &Path) -> io::Result<()> {
    use rustix::fs::{AtFlags, CWD, linkat};
    Ok(linkat(CWD, link_of(file), CWD, path, AtFlags::SYMLINK_FOLLOW)?)
}

/// There are none.
#[cfg(not(target_os = "linux"))]
pub fn link_unnamed(_: &File, _: &Path) -> io::Result<()> {
    Err(io::ErrorKind::Unsupported.into())
}

/// The link that the system keeps for an open file.
#[cfg(target_os = "linux")]
fn link_of(file: &File) -> PathBuf {
    use std::os::fd::AsRawFd as _;
    PathBuf::from(format!("/proc/self/fd/{}", file.as_raw_fd()))
}

/// Two files swap their names in one moment. [`io::ErrorKind::Unsupported`] where that is unknown.
#[cfg(any(target_os = "linux", target_vendor = "apple"))]
pub fn exchange(one: &Path, other: &Path) -> io::Result<()> {
    use rustix::fs::{CWD, RenameFlags, renameat_with};
    Ok(renameat_with(CWD, one, CWD, other, RenameFlags::EXCHANGE)?)
}

/// That is unknown.
#[cfg(not(any(target_os = "linux", target_vendor = "apple")))]
pub fn exchange(_: &Path, _: &Path) -> io::Result<()> {
    Err(io::ErrorKind::Unsupported.into())
}

/// Gives a file another name; what had that name before is gone in the same moment.
pub fn rename(from: &Path, to: &Path) -> io::Result<()> {
    fs::rename(from, to)
}

/// A folder, for syncing it.
pub fn open_folder(path: &Path) -> io::Result<File> {
    File::open(path)
}

/// Reads from a place; how many bytes there were.
pub fn read_at(file: &File, bytes: &mut [u8], offset: u64) -> io::Result<usize> {
    file.read_at(bytes, offset)
}

/// A file that is made gets this mode, less the umask.
pub fn with_mode(options: &mut OpenOptions, mode: u32) {
    options.mode(mode);
}

/// Opening follows no link, and waits for no pipe of that name.
pub fn opens_no_link(options: &mut OpenOptions) {
    options.custom_flags((OFlags::NOFOLLOW | OFlags::NONBLOCK).bits() as i32);
}

/// Opening a pipe waits for no reader.
pub fn opens_at_once(options: &mut OpenOptions) {
    options.custom_flags((OFlags::NONBLOCK | OFlags::NOCTTY).bits() as i32);
}

/// Permissions, where there are any.
#[expect(clippy::unnecessary_wraps, reason = "other systems have none")]
pub fn mode_of(meta: &Metadata) -> Option<u32> {
    Some(meta.permissions().mode() & 0o777)
}

/// Sets permissions.
pub fn set_mode(file: &File, mode: u32) -> io::Result<()> {
    file.set_permissions(Permissions::from_mode(mode))
}

/// Whether two looks saw the same file.
pub fn is_same_file(one: &Metadata, other: &Metadata) -> bool {
    (one.dev(), one.ino()) == (other.dev(), other.ino())
}

/// A file's number and the time of its change, in seconds and nanoseconds; `None` where they are not told.
#[expect(clippy::unnecessary_wraps, reason = "other systems do not tell")]
pub fn change_of(meta: &Metadata) -> Option<(u64, (i64, i64))> {
    Some((meta.ino(), (meta.mtime(), meta.mtime_nsec())))
}

/// Whether a file is the user's.
pub fn is_mine(meta: &Metadata) -> bool {
    meta.uid() == rustix::process::geteuid().as_raw()
}

/// A name that was written down by [`OsStr::as_encoded_bytes`].
#[expect(clippy::unnecessary_wraps, reason = "elsewhere not every name can be had back")]
pub fn name_from(bytes: Vec<u8>) -> Option<OsString> {
    Some(OsString::from_vec(bytes))
}

/// Why no file of this name is made: here any name will do.
pub fn refused(_: &OsStr) -> Option<&'static str> {
    None
}

/// Whether a path is that of the device that takes everything, where looking does not tell.
pub fn is_null_device(_: &Path) -> bool {
    false
}

/// A path as others are compared with it: two that differ are two files. Macs mostly do not tell large
/// letters from small ones.
pub fn compared(path: PathBuf) -> PathBuf {
    if cfg!(target_vendor = "apple") {
        path.to_str().map(|text| text.to_lowercase().into()).unwrap_or(path)
    } else {
        path
    }
}

/// Whether a file may be run.
pub fn is_program(meta: &Metadata) -> bool {
    meta.is_file() && meta.permissions().mode() & 0o111 != 0
}

/// Whether following links ended with this error because they lead in a circle.
pub fn leads_in_a_circle(error: &io::Error) -> bool {
    Errno::from_io_error(error) == Some(Errno::LOOP)
}

/// Standard output, apart from the standard library's buffer.
pub fn stdout() -> io::Result<File> {
    Ok(File::from(io::stdout().as_fd().try_clone_to_owned()?))
}

/// Whether opening a pipe failed with this error because nobody reads it.
pub fn has_no_reader(path: &Path, error: &io::Error) -> bool {
    let is_pipe = || fs::metadata(path).is_ok_and(|meta| meta.file_type().is_fifo());
    Errno::from_io_error(error) == Some(Errno::NXIO) && is_pipe()
}

/// Waits a moment, less than a second, until a file can be written to; a failure is left to the writing.
pub fn is_ready(file: &File, within: Duration) -> io::Result<bool> {
    let look = Timespec { tv_sec: 0, tv_nsec: within.subsec_nanos().into() };
    match poll(&mut [PollFd::new(file, PollFlags::OUT)], Some(&look)) {
        Ok(count) => Ok(count > 0),
        Err(Errno::INTR) => Ok(false),
        Err(error) => Err(error.into()),
    }
}
