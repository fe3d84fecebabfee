//! A file on its way to its place: without a name where the system has such files, and else under a
//! temporary name that is locked while we live, so that the next run knows what to sweep.

use std::collections::BTreeSet;
use std::ffi::OsStr;
use std::fs::File;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use linden::Monitor;

use super::Sink;
use super::system::{FileSystem, again};
use super::target::Location;
use crate::ExportError;

/// The mode of files that are nothing special.
pub(super) const ORDINARY: u32 = 0o666;
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

/// Tidies up what programs that were killed have left in a folder. What they were about to place together
/// is completed; then files with our temporary names go whose lock is free. What cannot be looked at is
/// left.
pub(super) fn sweep(system: &dyn FileSystem, folder: &Path) {
    let Ok(names) = again(|| system.names(folder)) else { return };
    let of_kind = |suffix: &'static str| {
        let own = names.iter().filter(move |name| is_ours(name, suffix)).map(|name| folder.join(name));
        own.filter(|path| !lock(&NAMES).contains(path))
    };
    for path in of_kind(RECORD) {
        match left(system, &path) {
            #[cfg(unix)]
            Left::Ours(record) => {
                if super::record::complete(system, &record).is_err() {
                    return;
                }
                let _ = again(|| system.remove(&path));
            }
            #[cfg(not(unix))]
            Left::Ours(_) => {}
            Left::Nothing => {}
            // What it speaks of is not left: a program is at work, or tidies up.
            Left::InUse => return,
        }
    }
    for path in of_kind(PART) {
        if let Left::Ours(_locked) = left(system, &path) {
            let _ = again(|| system.remove(&path));
        }
    }
}

/// What a name of ours stands for.
enum Left {
    /// What a program that is gone has left, locked now.
    Ours(File),
    /// A file of a program that lives, or one that cannot be looked at.
    InUse,
    /// No file of ours, or none any more.
    Nothing,
}

fn left(system: &dyn FileSystem, path: &Path) -> Left {
    let file = match again(|| system.open(path)) {
        Ok(file) => file,
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Left::Nothing,
        Err(_) => return Left::InUse,
    };
    if !file.metadata().is_ok_and(|meta| meta.is_file()) {
        return Left::Nothing;
    }
    match again(|| system.try_lock(&file)) {
        Ok(true) if is_at(system, &file, path).unwrap_or(false) => Left::Ours(file),
        Ok(true) => Left::Nothing,
        _ => Left::InUse,
    }
}

/// Whether an open file still has a name.
pub(super) fn is_at(system: &dyn FileSystem, file: &File, path: &Path) -> io::Result<bool> {
    let there = match again(|| system.symlink_metadata(path)) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(false),
        there => there?,
    };
    #[cfg(unix)]
    {
        use std::os::unix::fs::MetadataExt;
        let own = file.metadata()?;
        Ok((own.dev(), own.ino()) == (there.dev(), there.ino()))
    }
    #[cfg(not(unix))]
    {
        let _ = (file, there);
        Ok(true)
    }
}

/// `.linden-1234-5.part`
pub(super) fn is_temporary(name: &OsStr) -> bool {
    is_ours(name, PART)
}

fn is_ours(name: &OsStr, suffix: &str) -> bool {
    let middle = name.to_str().and_then(|name| name.strip_prefix(PREFIX)?.strip_suffix(suffix));
    let is_number = |text: &str| !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit());
    middle.and_then(|middle| middle.split_once('-')).is_some_and(|(a, b)| is_number(a) && is_number(b))
}

/// A file that waits to be placed.
pub(super) struct Staged {
    /// Where it will be.
    pub location: Location,
    pub bytes: u64,
    /// Whether its writer has finished.
    pub whole: bool,
    system: &'static dyn FileSystem,
    /// Locked, where it has a name and the file system knows locks.
    file: File,
    name: Option<TempName>,
}

impl Staged {
    /// A file of an export in the folder of its place, so that a folder that may not be written to is
    /// found at once.
    pub fn create(system: &'static dyn FileSystem, location: Location) -> Result<Self, ExportError> {
        let failed = location.clone();
        Self::with_mode(system, location, ORDINARY).map_err(|source| failed.failed("creating", source))
    }

    /// A file with a mode, less the umask.
    pub fn with_mode(system: &'static dyn FileSystem, location: Location, mode: u32) -> io::Result<Self> {
        use io::ErrorKind::{InvalidInput, IsADirectory, NotFound, Unsupported};
        let (file, name) = match again(|| system.create_unnamed(&location.folder, mode)) {
            Ok(file) => (file, None),
            // The words of systems and file systems without such files.
            Err(e) if matches!(e.kind(), Unsupported | IsADirectory | InvalidInput | NotFound) => {
                let (name, file) = TempName::create(system, &location.folder, PART, mode)?;
                (file, Some(name))
            }
            Err(e) => return Err(e),
        };
        Ok(Self { location, bytes: 0, whole: false, system, file, name })
    }

    /// Writes it; `bytes` is its length where that is known before.
    pub fn write(
        &mut self,
        bytes: Option<u64>,
        monitor: &dyn Monitor,
        write: impl FnOnce(&mut Sink<'_>) -> Result<(), ExportError>,
    ) -> Result<(), ExportError> {
        let mut out = Appending { system: self.system, file: &self.file };
        let mut sink = Sink::new(&mut out, self.location.shown(), bytes, monitor);
        write(&mut sink)?;
        self.bytes = sink.finish()?;
        self.whole = true;
        Ok(())
    }

    /// Writes all of it at once.
    pub fn fill(&mut self, bytes: &[u8]) -> io::Result<()> {
        Appending { system: self.system, file: &self.file }.write_all(bytes)?;
        self.whole = true;
        Ok(())
    }

    /// Brings it to the disk: without this a power cut after the rename can leave an empty file.
    pub fn sync(&self) -> io::Result<()> {
        synced(again(|| self.system.sync(&self.file)))
    }

    /// Gives it the permissions of the file that it replaces; a file system without any refuses, and then
    /// there is no loss.
    pub fn set_mode(&self, mode: u32) {
        let _ = again(|| self.system.set_mode(&self.file, mode));
    }

    /// Gives it a temporary name beside its place, if it has none yet.
    pub fn name(&mut self) -> io::Result<()> {
        use io::ErrorKind::{CrossesDevices, InvalidInput, NotFound, PermissionDenied, Unsupported};
        if self.name.is_some() {
            return Ok(());
        }
        let (system, file) = (self.system, &self.file);
        let _ = again(|| system.try_lock(file));
        match TempName::new(system, &self.location.folder, PART, |path| system.link_unnamed(file, path)) {
            Ok((name, ())) => self.name = Some(name),
            // Some systems make such files and do not let them be named.
            Err(e)
                if matches!(
                    e.kind(),
                    CrossesDevices | InvalidInput | NotFound | PermissionDenied | Unsupported
                ) =>
            {
                let mode = mode_of(&again(|| file.metadata())?);
                let (name, named) = self.copy(file)?;
                if let Some(mode) = mode {
                    let _ = again(|| system.set_mode(&named, mode));
                }
                synced(again(|| system.sync(&named)))?;
                (self.file, self.name) = (named, Some(name));
            }
            Err(e) => return Err(e),
        }
        Ok(())
    }

    /// The file's temporary name, once it has one.
    pub fn temp_path(&self) -> &Path {
        self.name.as_ref().map_or(Path::new(""), TempName::path)
    }

    /// It is in its place, and its temporary name is gone.
    pub fn placed(self) {
        if let Some(name) = self.name {
            name.gone();
        }
    }

    /// Its temporary name for what has it now: nothing, or the file that was in its place.
    pub fn into_name(self) -> Option<TempName> {
        self.name
    }

    /// A copy of a file under a temporary name beside this one.
    pub fn copy(&self, from: &File) -> io::Result<(TempName, File)> {
        let system = self.system;
        let (name, to) = TempName::create(system, &self.location.folder, PART, ORDINARY)?;
        let mut out = Appending { system, file: &to };
        let mut piece = vec![0; 1 << 16];
        let mut offset = 0;
        loop {
            let count = again(|| system.read_at(from, &mut piece, offset))?;
            if count == 0 {
                return Ok((name, to));
            }
            out.write_all(&piece[..count])?;
            offset += count as u64;
        }
    }

    /// Whether another file holds the same; one that cannot be read is unlike any other.
    pub fn holds_same(&self, other: &Self) -> bool {
        let compare = || -> io::Result<bool> {
            if self.bytes != other.bytes {
                return Ok(false);
            }
            let mut pieces = [vec![0; 1 << 16], vec![0; 1 << 16]];
            let mut offset = 0;
            loop {
                let [one, two] = &mut pieces;
                let count = again(|| self.system.read_at(&self.file, one, offset))?;
                if count == 0 {
                    return Ok(true);
                }
                let mut read = 0;
                while read < count {
                    let part = &mut two[read..count];
                    match again(|| other.system.read_at(&other.file, part, offset + read as u64))? {
                        0 => return Ok(false),
                        more => read += more,
                    }
                }
                if one[..count] != two[..count] {
                    return Ok(false);
                }
                offset += count as u64;
            }
        };
        compare().unwrap_or(false)
    }
}

/// A file that is written through the file system's own call.
struct Appending<'a> {
    system: &'a dyn FileSystem,
    file: &'a File,
}

impl Write for Appending<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.system.write(self.file, bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// What a file system that knows no syncing says is no failure.
pub(super) fn synced(done: io::Result<()>) -> io::Result<()> {
    use io::ErrorKind::{InvalidInput, Unsupported};
    done.or_else(|e| if matches!(e.kind(), InvalidInput | Unsupported) { Ok(()) } else { Err(e) })
}

/// Permissions, where there are any.
#[cfg_attr(unix, allow(clippy::unnecessary_wraps, reason = "other systems have none"))]
pub(super) fn mode_of(meta: &std::fs::Metadata) -> Option<u32> {
    #[cfg(unix)]
    return Some(std::os::unix::fs::PermissionsExt::mode(&meta.permissions()) & 0o777);
    #[cfg(not(unix))]
    {
        let _ = meta;
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_our_temporary_names_are_swept() {
        for name in [".linden-1-0.part", ".linden-4194304-17.part"] {
            assert!(is_temporary(OsStr::new(name)), "{name}");
        }
        for name in [".linden-.part", ".linden-a-1.part", ".linden-1-.part", ".linden-1-1.part2", "x.part"] {
            assert!(!is_temporary(OsStr::new(name)), "{name}");
        }
    }
}
