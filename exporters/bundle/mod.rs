//! The files of one export: written beside the target, renamed into place together.
//!
//! There is never half an export. Files are written under temporary names in the target's own
//! directory (a rename across file systems is a copy, and can fail half-way); dropping a bundle that
//! was not committed removes them. Standard output is the exception: its bytes go out as they are
//! made, because a pipe's reader should not have to wait and there is nothing to put back.

mod commit;
mod sink;
mod stem;
mod target;

use std::ffi::OsString;
use std::io::Write;
use std::path::{Path, PathBuf};

use linden::Monitor;
use tempfile::NamedTempFile;

pub use commit::{Written, commit_all, ensure_distinct, ensure_spared};
pub use sink::Sink;
use target::Resolved;
pub use target::{Existing, examine};

use crate::ExportError;

/// The named files of one export: one main file, and those that it refers to.
pub struct Bundle {
    place: Place,
    notes: Vec<String>,
}

enum Place {
    Files(Files),
    Stream { label: String, out: Box<dyn Write + Send> },
}

struct Files {
    /// The directory as it is shown; `.` for the current one.
    shown: PathBuf,
    /// The directory itself, without links.
    dir: PathBuf,
    /// What names of side files start with.
    stem: String,
    main: Staged,
    sides: Vec<Staged>,
}

/// A file that waits under a temporary name.
struct Staged {
    name: OsString,
    file: NamedTempFile,
    bytes: u64,
    /// Whether its writer has finished.
    whole: bool,
}

impl Bundle {
    /// A bundle whose main file will be `target`. Follows a symbolic link: the file that it points at
    /// is replaced, and side files lie beside that one. A target that exists but is no regular file
    /// (`/dev/stdout`, a pipe) is written to directly, as by [`Bundle::stream`].
    ///
    /// A temporary file is made at once, so that a directory nobody may write to is found before a
    /// tree is grown.
    ///
    /// # Errors
    /// [`ExportError::Target`] when the target is a directory, is read-only, or its directory is
    /// missing; [`ExportError::Io`] when nothing can be written there.
    pub fn create(target: &Path) -> Result<Self, ExportError> {
        let place = match target::resolve(target)? {
            Resolved::File { shown, dir, name } => {
                let main = Staged::create(&shown, &dir, name.clone())?;
                Place::Files(Files {
                    stem: stem::plain(Path::new(&name)),
                    shown,
                    dir,
                    main,
                    sides: Vec::new(),
                })
            }
            Resolved::Stream(out) => {
                Place::Stream { label: linden::knob::printable(&target.to_string_lossy()), out }
            }
        };
        Ok(Self { place, notes: Vec::new() })
    }

    /// A bundle of a single file that goes to `out` as it is made; `label` names it in messages:
    /// `standard output`.
    pub fn stream(label: &str, out: impl Write + Send + 'static) -> Self {
        Self { place: Place::Stream { label: label.to_owned(), out: Box::new(out) }, notes: Vec::new() }
    }

    /// Whether files can lie beside the main one.
    pub fn takes_side_files(&self) -> bool {
        matches!(self.place, Place::Files(_))
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
            Place::Files(files) => files.main.write(&files.shown, bytes, monitor, write),
            Place::Stream { label, out } => {
                let mut sink = Sink::new(out.as_mut(), label.clone(), bytes, monitor);
                write(&mut sink)?;
                sink.finish().map(|_| ())
            }
        }
    }

    /// What a side file with this ending is called: `fir` and `_bark.png` give `fir_bark.png`.
    /// It is made of characters that every reader of every format here takes: Unicode letters,
    /// digits, `-`, `_`, `.` and `+`.
    pub fn side_name(&self, suffix: &str) -> String {
        match &self.place {
            Place::Files(files) => format!("{}{}", files.stem, stem::plain_suffix(suffix)),
            Place::Stream { .. } => String::new(),
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
        let name = self.side_name(suffix);
        match &mut self.place {
            Place::Files(files) => {
                let mut side = Staged::create(&files.shown, &files.dir, name.into())?;
                side.write(&files.shown, bytes, monitor, write)?;
                files.sides.push(side);
                Ok(())
            }
            Place::Stream { label, .. } => Err(ExportError::Target {
                path: PathBuf::from(label.as_str()),
                problem: format!(
                    "it holds a single file, and '{suffix}' would be another; name a file instead"
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

impl Staged {
    fn create(shown: &Path, dir: &Path, name: OsString) -> Result<Self, ExportError> {
        let mut builder = tempfile::Builder::new();
        builder.prefix(".linden-").suffix(".part");
        // Temporary files are private by default; these become ordinary files, so that the umask
        // decides, as for any other program's output.
        #[cfg(unix)]
        builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
        let file = builder.tempfile_in(dir).map_err(|e| {
            // tempfile tells the temporary name, which means nothing to anybody; the kind says it all
            // where it is known.
            let source = if crate::error::advice(&e).is_empty() { e } else { e.kind().into() };
            ExportError::Io { doing: "creating", what: show(shown, &name), source }
        })?;
        Ok(Self { name, file, bytes: 0, whole: false })
    }

    fn write(
        &mut self,
        shown: &Path,
        bytes: Option<u64>,
        monitor: &dyn Monitor,
        write: impl FnOnce(&mut Sink<'_>) -> Result<(), ExportError>,
    ) -> Result<(), ExportError> {
        let mut sink = Sink::new(self.file.as_file_mut(), show(shown, &self.name), bytes, monitor);
        write(&mut sink)?;
        self.bytes = sink.finish()?;
        self.whole = true;
        Ok(())
    }
}

/// A file as people know it.
fn show(dir: &Path, name: &std::ffi::OsStr) -> String {
    linden::knob::printable(&under(dir, name).to_string_lossy())
}

fn under(dir: &Path, name: &std::ffi::OsStr) -> PathBuf {
    if dir == Path::new(".") { name.into() } else { dir.join(name) }
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
mod tests;
