//! The files of one export: written beside the target, renamed into place together.
//!
//! There is never half an export. Files are written without a name in the target's folder (a rename
//! across file systems is a copy, and can fail half-way), or under a temporary one where the system
//! knows no such files; whatever ends the program, nothing of them remains, or the next run sweeps it.
//! Standard output, pipes and devices are the exception: their bytes go out as they are made, because a
//! reader should not have to wait and there is nothing to put back. Files [in memory](Bundle::in_memory) are given to the
//! caller, which puts them where it likes.
//!
//! Every call of the operating system goes through [`file_system::FileSystem`].

mod commit;
mod file_system;
mod folders;
mod pipe;
mod record;
mod referring;
mod shared;
mod single;
mod sink;
mod staged;
mod stem;
mod sweep;
mod target;
mod temporary;

use std::io::Write;
use std::path::{Path, PathBuf};

use linden_pipeline::Monitor;

pub use commit::{Written, commit_all, ensure_distinct, ensure_spared};
use file_system::{FileSystem, System};
pub use folders::{MadeFolders, make_folders};
use pipe::Pipe;
pub use shared::Pictures;
pub use single::write_file;
pub use sink::Sink;
use staged::Staged;
use sweep::sweep;
pub use target::{Existing, examine};
use target::{Located, locate};
pub use temporary::abandon;

use crate::ExportError;

/// The named files of one export: one main file, and those that it refers to.
pub struct Bundle {
    place: Place,
    notes: Vec<String>,
    system: &'static dyn FileSystem,
    /// Whether files are brought to the disk.
    is_synced: bool,
    /// Whether files stay that hold the same bytes.
    spares_same: bool,
    membership: Option<shared::Membership>,
    picture_folder: Option<shared::PictureFolder>,
}

enum Place {
    Files(Files),
    /// A pipe, a device, or standard output.
    Pipe {
        label: String,
        pipe: Pipe,
    },
    Stream {
        label: String,
        out: Box<dyn Write + Send>,
    },
    Memory(MemoryFiles),
}

/// A file that was kept in memory.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct MemoryFile {
    /// What it is called beside the others, which may refer to it by this name.
    pub name: String,
    /// What is in it.
    pub bytes: Vec<u8>,
}

struct MemoryFiles {
    /// What names of side files start with.
    stem: String,
    main: MemoryFile,
    sides: Vec<MemoryFile>,
}

struct Files {
    /// What names of side files start with.
    stem: String,
    main: Staged,
    sides: Vec<Staged>,
    /// Files that it refers to and that were there before.
    there: Vec<Written>,
}

impl Bundle {
    /// A bundle whose main file will be `target`. Follows a symbolic link: the file that it points at
    /// is replaced, and side files lie beside that one. A target that exists but is no regular file
    /// (`/dev/null`, a named pipe) is written to directly, as by [`Bundle::stream`]; a pipe's reader is
    /// waited for when there is something to write.
    ///
    /// A file is made at once, so that a directory without permission to write is found before a tree is grown.
    /// What killed programs have left in that directory is swept.
    ///
    /// # Errors
    /// [`ExportError::Target`] when the target is a directory or is read-only,
    /// [`ExportError::NoFolder`] when its directory is missing; [`ExportError::Io`] when nothing can be
    /// written there.
    pub fn create(target: &Path) -> Result<Self, ExportError> {
        Self::create_on(&System, target)
    }

    fn create_on(system: &'static dyn FileSystem, target: &Path) -> Result<Self, ExportError> {
        let place = match locate(system, target)? {
            Located::File { location, .. } => {
                sweep(system, &location.folder);
                let stem = stem::plain(Path::new(&location.name));
                Place::Files(Files {
                    stem,
                    main: Staged::create(system, location)?,
                    sides: Vec::new(),
                    there: Vec::new(),
                })
            }
            Located::Stream(path) => Place::Pipe {
                label: linden_pipeline::knob::printable(&target.to_string_lossy()),
                pipe: Pipe::open(&path).map_err(|source| target::looking(target, source))?,
            },
        };
        Ok(Self::at(place, system))
    }

    const fn at(place: Place, system: &'static dyn FileSystem) -> Self {
        Self {
            place,
            notes: Vec::new(),
            system,
            is_synced: true,
            spares_same: false,
            membership: None,
            picture_folder: None,
        }
    }

    /// A bundle of a single file that goes to `out` as it is made; `label` names it in messages:
    /// `standard output`.
    pub fn stream(label: &str, out: impl Write + Send + 'static) -> Self {
        let place = Place::Stream { label: label.to_owned(), out: Box::new(out) };
        Self::at(place, &System)
    }

    /// A bundle whose files are kept in memory, for whoever has no disk to write to; `name` is what its main file is called,
    /// like `oak.obj`. [`Bundle::into_files`] gives them.
    ///
    /// ```
    /// # use linden_pipeline::preset::builtin;
    /// # use linden_pipeline::{Quiet, dress, grow};
    /// use linden_exporters::{Bundle, Options, find};
    /// use linden_pipeline::stage::Stage;
    /// # let recipe = builtin("fir")?.recipe(&Quiet)?;
    /// # let scene = dress::dress(&recipe, &grow::grow(&recipe, &Quiet)?, &Quiet)?;
    /// let obj = find("obj")?;
    /// let mut bundle = Bundle::in_memory("fir.obj");
    /// obj.write(&Stage::of(&scene), &Options::new(obj.format()), &mut bundle, &Quiet)?;
    /// let files = bundle.into_files();
    /// assert_eq!(files[0].name, "fir.obj");
    /// assert!(files[1..].iter().any(|side| side.name == "fir.mtl"));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn in_memory(name: &str) -> Self {
        let main = MemoryFile { name: name.to_owned(), bytes: Vec::new() };
        let stem = stem::plain(Path::new(name));
        Self::at(Place::Memory(MemoryFiles { stem, main, sides: Vec::new() }), &System)
    }

    /// The files of a bundle [in memory](Bundle::in_memory), the main one first; of any other bundle none.
    pub fn into_files(self) -> Vec<MemoryFile> {
        match self.place {
            Place::Memory(MemoryFiles { main, sides, .. }) => std::iter::once(main).chain(sides).collect(),
            Place::Files(_) | Place::Pipe { .. } | Place::Stream { .. } => Vec::new(),
        }
    }

    /// A bundle of a single file that goes to standard output as it is made. A reader that does not
    /// read is waited for as long as the monitor wants it.
    pub fn stdout() -> Self {
        const LABEL: &str = "standard output";
        if let Ok(pipe) = Pipe::stdout() {
            let place = Place::Pipe { label: LABEL.to_owned(), pipe };
            return Self::at(place, &System);
        }
        Self::stream(LABEL, std::io::stdout())
    }

    /// Does not wait until files are on the disk: faster, and a power cut soon afterwards can take them.
    #[must_use]
    pub fn unsynced(mut self) -> Self {
        self.is_synced = false;
        self
    }

    /// Leaves files alone that hold the same bytes already, main and beside it: they keep their times and are no
    /// others to programs that have them open.
    #[must_use]
    pub fn sparing_same(mut self) -> Self {
        self.spares_same = true;
        self
    }

    /// Whether files can lie beside the main one.
    pub fn takes_side_files(&self) -> bool {
        matches!(self.place, Place::Files(_) | Place::Memory(_))
    }

    /// The name of a pipe without a reader: writing to it waits.
    pub fn unread_pipe(&mut self) -> Option<&str> {
        match &mut self.place {
            Place::Pipe { label, pipe } => pipe.is_unread().then_some(label.as_str()),
            Place::Files(_) | Place::Stream { .. } | Place::Memory(_) => None,
        }
    }

    /// What the user should know about this export, one line each.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// Leaves a line for the user.
    pub fn note(&mut self, line: impl Into<String>) {
        self.notes.push(line.into());
    }

    /// Writes the main file. `bytes` is its length where that is known before.
    ///
    /// # Errors
    /// Those of `write`, and [`ExportError::Io`].
    pub fn write_main(
        &mut self,
        bytes: Option<u64>,
        monitor: &dyn Monitor,
        write: impl FnOnce(&mut Sink<'_>) -> Result<(), ExportError>,
    ) -> Result<(), ExportError> {
        match &mut self.place {
            Place::Files(files) => files.main.write(bytes, monitor, write),
            Place::Pipe { label, pipe } => {
                let waiting = |source| sink::failed("opening", label, source);
                let mut out = pipe.writer(monitor).map_err(waiting)?;
                let mut sink = Sink::new(&mut out, label.clone(), bytes, monitor);
                write(&mut sink)?;
                sink.finish().map(|_| ())
            }
            Place::Stream { label, out } => {
                let mut sink = Sink::new(out.as_mut(), label.clone(), bytes, monitor);
                write(&mut sink)?;
                sink.finish().map(|_| ())
            }
            Place::Memory(MemoryFiles { main, .. }) => {
                Sink::gather(&main.name, &mut main.bytes, monitor, write)
            }
        }
    }

    /// What the main file is called in its folder; `None` for a stream.
    pub fn main_name(&self) -> Option<&Path> {
        match &self.place {
            Place::Files(files) => Some(Path::new(&files.main.location.name)),
            Place::Memory(files) => Some(Path::new(&files.main.name)),
            Place::Pipe { .. } | Place::Stream { .. } => None,
        }
    }

    /// What a side file with this ending is called: `fir` and `_bark.png` give `fir_bark.png`.
    /// It is made of characters that every reader of every format here takes: Unicode letters,
    /// digits, `-`, `_`, `.` and `+`.
    pub fn side_name(&self, suffix: &str) -> String {
        match &self.place {
            Place::Files(Files { stem, .. }) | Place::Memory(MemoryFiles { stem, .. }) => {
                format!("{stem}{}", stem::plain_suffix(suffix))
            }
            Place::Pipe { .. } | Place::Stream { .. } => String::new(),
        }
    }

    /// Writes the side file [`Bundle::side_name`].
    ///
    /// # Errors
    /// Those of `write`, and [`ExportError::Io`]; also for a bundle that takes no side files.
    pub fn write_side(
        &mut self,
        suffix: &str,
        bytes: Option<u64>,
        monitor: &dyn Monitor,
        write: impl FnOnce(&mut Sink<'_>) -> Result<(), ExportError>,
    ) -> Result<(), ExportError> {
        // A stream has no names to make one from.
        let name = if self.takes_side_files() { self.side_name(suffix) } else { suffix.to_owned() };
        self.write_named(&name, bytes, monitor, write)
    }

    fn write_named(
        &mut self,
        name: &str,
        bytes: Option<u64>,
        monitor: &dyn Monitor,
        write: impl FnOnce(&mut Sink<'_>) -> Result<(), ExportError>,
    ) -> Result<(), ExportError> {
        match &mut self.place {
            Place::Files(files) => {
                let location = side_location(self.system, &files.main.location, name)?;
                if location.folder != files.main.location.folder {
                    sweep(self.system, &location.folder);
                }
                let mut side = Staged::create(self.system, location)?;
                side.write(bytes, monitor, write)?;
                files.sides.push(side);
                Ok(())
            }
            Place::Memory(files) => {
                let mut side = MemoryFile { name: name.to_owned(), bytes: Vec::new() };
                Sink::gather(name, &mut side.bytes, monitor, write)?;
                files.sides.push(side);
                Ok(())
            }
            Place::Pipe { label, .. } | Place::Stream { label, .. } => Err(ExportError::Target {
                path: PathBuf::from(label.as_str()),
                problem: format!(
                    "it holds a single file, and '{name}' would be another; name a file instead"
                ),
            }),
        }
    }

    /// Puts the files in their places: see [`commit_all`].
    ///
    /// # Errors
    /// As [`commit_all`].
    pub fn commit(self) -> Result<Vec<Written>, ExportError> {
        commit_all(vec![self])
    }
}

/// Where a side file goes: as a main file would, through a link and never over a file that is
/// write-protected.
fn side_location(
    system: &dyn FileSystem,
    main: &target::Location,
    name: &str,
) -> Result<target::Location, ExportError> {
    let beside = target::Location { name: name.into(), ..main.clone() };
    located_file(system, &beside.shown_path())
}

/// Where a file goes that must be one.
fn located_file(system: &dyn FileSystem, path: &Path) -> Result<target::Location, ExportError> {
    match locate(system, path)? {
        Located::File { location, .. } => Ok(location),
        Located::Stream(_) => Err(ExportError::Target {
            path: path.to_owned(),
            problem: "that is a pipe or a device, and a file belongs there; remove it or choose another name"
                .to_owned(),
        }),
    }
}

#[cfg(test)]
pub(crate) mod test_output {
    use std::io::{self, Write};
    use std::sync::{Arc, Mutex};

    /// A stream that can be looked at afterwards.
    #[derive(Clone, Default)]
    pub(crate) struct Output(Arc<Mutex<Vec<u8>>>);

    impl Output {
        pub fn bytes(&self) -> Vec<u8> {
            self.0.lock().unwrap().clone()
        }
    }

    impl Write for Output {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            self.0.lock().unwrap().extend_from_slice(bytes);
            Ok(bytes.len())
        }

        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }
}

#[cfg(test)]
mod fault_tests;
#[cfg(test)]
mod tests;
