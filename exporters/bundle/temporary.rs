//! Temporary names: each is known while it is there, and locked while we live, so that the next run knows
//! what to sweep.

use std::collections::BTreeSet;
use std::ffi::OsStr;
use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use super::file_system::{FileSystem, again};
use crate::system::is_same_file;

/// What temporary names begin and end with.
const PREFIX: &str = ".linden-";
pub(super) const PART: &str = ".part";
pub(super) const RECORD: &str = ".commit";
/// Names that are tried where others are taken: by what earlier programs of our number left.
const MOST_NAMES: u64 = 10_000;
/// How long a program that ends at once waits for files that are being placed.
const PATIENCE: Duration = Duration::from_secs(2);

/// Temporary names that are there.
static NAMES: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());
/// Held while files are put in their places, which is a few calls.
static PLACING: Mutex<()> = Mutex::new(());

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// While this lives, [`abandon`] waits.
pub(super) fn placing() -> MutexGuard<'static, ()> {
    lock(&PLACING)
}

/// Takes away all temporary names, for a program that ends at once: its bundles are not dropped.
/// Nothing of theirs is placed any more; what is being placed in this moment comes to its end first.
pub fn abandon() {
    let asked = Instant::now();
    let guard = loop {
        match PLACING.try_lock() {
            Ok(guard) => break guard,
            Err(std::sync::TryLockError::Poisoned(poisoned)) => break poisoned.into_inner(),
            // The next run sweeps.
            Err(std::sync::TryLockError::WouldBlock) if asked.elapsed() > PATIENCE => return,
            Err(std::sync::TryLockError::WouldBlock) => std::thread::sleep(Duration::from_millis(1)),
        }
    };
    for name in std::mem::take(&mut *lock(&NAMES)) {
        let _ = std::fs::remove_file(name);
    }
    // Not given back: the program ends.
    std::mem::forget(guard);
}

/// Whether a temporary name is one of this program's.
pub(super) fn is_known(path: &Path) -> bool {
    lock(&NAMES).contains(path)
}

/// A temporary name. Dropped, it is taken away with the file that has it then.
pub(super) struct TempName {
    system: &'static dyn FileSystem,
    path: PathBuf,
    is_kept: bool,
}

impl TempName {
    /// A name in a folder that `make` found free.
    pub fn new<T>(
        system: &'static dyn FileSystem,
        folder: &Path,
        suffix: &str,
        mut make: impl FnMut(&Path) -> io::Result<T>,
    ) -> io::Result<(Self, T)> {
        static NEXT: AtomicU64 = AtomicU64::new(0);
        let process = std::process::id();
        for _ in 0..MOST_NAMES {
            let number = NEXT.fetch_add(1, Ordering::Relaxed);
            let path = folder.join(format!("{PREFIX}{process}-{number}{suffix}"));
            // It is known before it is there, and so is never there unknown.
            lock(&NAMES).insert(path.clone());
            match again(|| make(&path)) {
                Ok(made) => return Ok((Self { system, path, is_kept: false }, made)),
                Err(error) => {
                    lock(&NAMES).remove(&path);
                    if error.kind() != io::ErrorKind::AlreadyExists {
                        return Err(error);
                    }
                }
            }
        }
        Err(io::Error::other("all temporary names are taken"))
    }

    /// A new file under a temporary name, locked as far as the file system knows locks.
    pub fn create(
        system: &'static dyn FileSystem,
        folder: &Path,
        suffix: &str,
        mode: u32,
    ) -> io::Result<(Self, File)> {
        loop {
            let (name, file) = Self::new(system, folder, suffix, |path| system.create(path, mode))?;
            // Another program may be about to sweep it, or have swept it before it was locked.
            let is_free = !matches!(again(|| system.try_lock(&file)), Ok(false));
            if is_free && is_at(system, &file, &name.path)? {
                return Ok((name, file));
            }
        }
    }

    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The file has another name now, and this one is gone.
    pub fn gone(mut self) {
        self.is_kept = true;
    }
}

impl Drop for TempName {
    fn drop(&mut self) {
        // What fails once may do so by chance; what fails twice is for the next run to sweep.
        if !self.is_kept && again(|| self.system.remove(&self.path)).is_err() {
            let _ = again(|| self.system.remove(&self.path));
        }
        lock(&NAMES).remove(&self.path);
    }
}

/// Whether an open file still has a name.
pub(super) fn is_at(system: &dyn FileSystem, file: &File, path: &Path) -> io::Result<bool> {
    let there = match again(|| system.symlink_metadata(path)) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(false),
        there => there?,
    };
    Ok(is_same_file(&file.metadata()?, &there))
}

/// Whether a name is that of a file on its way: `.linden-1234-5.part`.
pub(super) fn is_temporary(name: &OsStr) -> bool {
    is_ours(name, PART)
}

/// Whether a name is temporary and has this ending.
pub(super) fn is_ours(name: &OsStr, suffix: &str) -> bool {
    let middle = name.to_str().and_then(|name| name.strip_prefix(PREFIX)?.strip_suffix(suffix));
    let is_number = |text: &str| !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit());
    middle.and_then(|middle| middle.split_once('-')).is_some_and(|(a, b)| is_number(a) && is_number(b))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_our_names_are_temporary() {
        for name in [".linden-1-0.part", ".linden-4194304-17.part"] {
            assert!(is_temporary(OsStr::new(name)), "{name}");
        }
        for name in [".linden-.part", ".linden-a-1.part", ".linden-1-.part", ".linden-1-1.part2", "x.part"] {
            assert!(!is_temporary(OsStr::new(name)), "{name}");
        }
    }
}
