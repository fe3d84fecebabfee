//! A file on its way to its place: without a name where the system has such files, and else under a
//! temporary name.

use std::fs::File;
use std::io::{self, Write};
use std::path::Path;

use linden_pipeline::Monitor;

use super::Sink;
use super::file_system::{FileSystem, again, synced};
use super::target::Location;
use super::temporary::{PART, TempName};
use crate::ExportError;
use crate::system::mode_of;

/// The mode of files that are nothing special.
pub(super) const ORDINARY: u32 = 0o666;

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
        self.bytes == other.bytes && self.holds_same_as(other.system, &other.file)
    }

    /// The same of a file that is open.
    pub fn holds_same_as(&self, system: &dyn FileSystem, other: &File) -> bool {
        let compare = || -> io::Result<bool> {
            let mut pieces = [vec![0; 1 << 16], vec![0; 1 << 16]];
            let mut offset = 0;
            loop {
                let [one, two] = &mut pieces;
                let count = again(|| self.system.read_at(&self.file, one, offset))?;
                if count == 0 {
                    return Ok(again(|| system.read_at(other, two, offset))? == 0);
                }
                let mut read = 0;
                while read < count {
                    let part = &mut two[read..count];
                    match again(|| system.read_at(other, part, offset + read as u64))? {
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
