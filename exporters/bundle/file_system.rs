//! The calls of the operating system that a bundle makes, all of them: tests let each fail in turn.

use std::ffi::OsString;
use std::fs::{self, File, Metadata, TryLockError};
use std::io;
use std::path::{Path, PathBuf};

use crate::system;

/// What a bundle asks of a file system. Methods are single calls: none tries again, none tidies up.
pub(super) trait FileSystem: Sync {
    /// What is at a path, links followed.
    fn metadata(&self, path: &Path) -> io::Result<Metadata>;
    /// What is at a path, a link being a link.
    fn symlink_metadata(&self, path: &Path) -> io::Result<Metadata>;
    /// Where a link points.
    fn read_link(&self, path: &Path) -> io::Result<PathBuf>;
    /// A path without links.
    fn canonicalize(&self, path: &Path) -> io::Result<PathBuf>;
    /// The names in a folder.
    fn names(&self, folder: &Path) -> io::Result<Vec<OsString>>;
    /// Makes a folder.
    fn create_folder(&self, path: &Path) -> io::Result<()>;
    /// Removes an empty folder.
    fn remove_folder(&self, path: &Path) -> io::Result<()>;

    /// A file without a name in a folder, open for reading and writing: the system takes it back when
    /// it is closed, however that comes. [`io::ErrorKind::Unsupported`] where there are none.
    fn create_unnamed(&self, folder: &Path, mode: u32) -> io::Result<File>;
    /// A new file, open for reading and writing. Its mode is less the umask, as that of any other
    /// program's output.
    fn create(&self, path: &Path, mode: u32) -> io::Result<File>;
    /// A file that is there, for locking it and looking at it; a link is not followed.
    fn open(&self, path: &Path) -> io::Result<File>;
    /// A folder, for syncing it.
    fn open_folder(&self, path: &Path) -> io::Result<File>;
    /// Takes the lock of an open file, which goes when we end; whether it was free.
    fn try_lock(&self, file: &File) -> io::Result<bool>;
    /// Writes at the end; how many bytes were taken.
    fn write(&self, file: &File, bytes: &[u8]) -> io::Result<usize>;
    /// Reads from a place; how many bytes there were.
    fn read_at(&self, file: &File, bytes: &mut [u8], offset: u64) -> io::Result<usize>;
    /// Sets permissions.
    fn set_mode(&self, file: &File, mode: u32) -> io::Result<()>;
    /// Brings what was written, or a folder's names, to the disk.
    fn sync(&self, file: &File) -> io::Result<()>;

    /// Gives a file from [`FileSystem::create_unnamed`] a name that is not taken.
    fn link_unnamed(&self, file: &File, path: &Path) -> io::Result<()>;
    /// Gives a file a second name.
    fn link(&self, from: &Path, to: &Path) -> io::Result<()>;
    /// Gives a file another name; what had that name before is gone in the same moment.
    fn rename(&self, from: &Path, to: &Path) -> io::Result<()>;
    /// Two files swap their names in one moment. [`io::ErrorKind::Unsupported`] where that is unknown.
    fn exchange(&self, one: &Path, other: &Path) -> io::Result<()>;
    /// Takes a name away.
    fn remove(&self, path: &Path) -> io::Result<()>;
}

/// Tries a call again as long as a signal interrupts it.
pub(super) fn again<T>(mut call: impl FnMut() -> io::Result<T>) -> io::Result<T> {
    loop {
        match call() {
            Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
            done => return done,
        }
    }
}

/// What a file system that knows no syncing says is no failure.
pub(super) fn synced(done: io::Result<()>) -> io::Result<()> {
    use io::ErrorKind::{InvalidInput, Unsupported};
    done.or_else(|e| if matches!(e.kind(), InvalidInput | Unsupported) { Ok(()) } else { Err(e) })
}

/// The file system of this machine.
pub(super) struct System;

impl FileSystem for System {
    fn metadata(&self, path: &Path) -> io::Result<Metadata> {
        fs::metadata(path)
    }

    fn symlink_metadata(&self, path: &Path) -> io::Result<Metadata> {
        fs::symlink_metadata(path)
    }

    fn read_link(&self, path: &Path) -> io::Result<PathBuf> {
        fs::read_link(path)
    }

    fn canonicalize(&self, path: &Path) -> io::Result<PathBuf> {
        fs::canonicalize(path)
    }

    fn names(&self, folder: &Path) -> io::Result<Vec<OsString>> {
        fs::read_dir(folder)?.map(|entry| Ok(entry?.file_name())).collect()
    }

    fn create_folder(&self, path: &Path) -> io::Result<()> {
        fs::create_dir(path)
    }

    fn remove_folder(&self, path: &Path) -> io::Result<()> {
        fs::remove_dir(path)
    }

    fn create_unnamed(&self, folder: &Path, mode: u32) -> io::Result<File> {
        system::create_unnamed(folder, mode)
    }

    fn create(&self, path: &Path, mode: u32) -> io::Result<File> {
        let mut options = File::options();
        options.read(true).write(true).create_new(true);
        system::with_mode(&mut options, mode);
        options.open(path)
    }

    fn open(&self, path: &Path) -> io::Result<File> {
        let open = |writes: bool| {
            let mut options = File::options();
            options.read(true).write(writes);
            system::opens_no_link(&mut options);
            options.open(path)
        };
        // Locks on a network need files that are open for writing.
        open(true).or_else(|_| open(false))
    }

    fn open_folder(&self, path: &Path) -> io::Result<File> {
        system::open_folder(path)
    }

    fn try_lock(&self, file: &File) -> io::Result<bool> {
        match file.try_lock() {
            Ok(()) => Ok(true),
            Err(TryLockError::WouldBlock) => Ok(false),
            Err(TryLockError::Error(error)) => Err(error),
        }
    }

    fn write(&self, mut file: &File, bytes: &[u8]) -> io::Result<usize> {
        io::Write::write(&mut file, bytes)
    }

    fn read_at(&self, file: &File, bytes: &mut [u8], offset: u64) -> io::Result<usize> {
        system::read_at(file, bytes, offset)
    }

    fn set_mode(&self, file: &File, mode: u32) -> io::Result<()> {
        system::set_mode(file, mode)
    }

    fn sync(&self, file: &File) -> io::Result<()> {
        file.sync_all()
    }

    fn link_unnamed(&self, file: &File, path: &Path) -> io::Result<()> {
        system::link_unnamed(file, path)
    }

    fn link(&self, from: &Path, to: &Path) -> io::Result<()> {
        fs::hard_link(from, to)
    }

    fn rename(&self, from: &Path, to: &Path) -> io::Result<()> {
        system::rename(from, to)
    }

    fn exchange(&self, one: &Path, other: &Path) -> io::Result<()> {
        system::exchange(one, other)
    }

    fn remove(&self, path: &Path) -> io::Result<()> {
        fs::remove_file(path)
    }
}
