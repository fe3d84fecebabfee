//! Reading what the user names, or a document of the user's: the one place where inputs are opened.
//!
//! Regular files, and pipes that the user named; never a device, which has no end. How long a file
//! is, is asked for memory before a byte of it is read, and what a pipe gives while it comes. All reading
//! stops when the monitor says so, also while a pipe has no writer.

use std::fs::{File, Metadata, OpenOptions};
use std::io::{self, BufReader, Cursor, ErrorKind, Read, Seek, SeekFrom};
use std::path::Path;
use std::sync::mpsc::{self, Receiver, RecvTimeoutError};
use std::time::Duration;

use anyhow::{Context, bail};
use linden::memory::bytes_grown;
use linden::monitor::{Holding, Phase};
use linden::recipe::Input;
use linden::{Cancelled, Monitor};

use crate::system;

/// Bytes between two looks at the monitor.
const PIECE: usize = 1 << 20;
/// Between two looks at the monitor while a pipe is silent.
const LOOK: Duration = Duration::from_millis(20);

/// For messages about memory.
const READING: &str = "reading it";
const READING_ADVICE: &str = "take a smaller file";

/// What is to be read.
pub enum Content {
    /// A regular file, from its beginning.
    File(File),
    /// What came through a pipe.
    Bytes(Vec<u8>),
}

/// Opens a regular file, or reads a pipe to its end.
pub fn open(path: &Path, monitor: &dyn Monitor) -> anyhow::Result<Content> {
    if system::is_pipe(&std::fs::metadata(path)?) {
        let path = path.to_owned();
        return Ok(Content::Bytes(from_pipe(move || File::open(path), monitor)?));
    }
    Ok(Content::File(open_regular(path)?))
}

/// All of standard input.
pub fn standard_input(monitor: &dyn Monitor) -> anyhow::Result<Content> {
    let bytes = from_pipe(|| Ok(io::stdin().lock()), monitor).context("reading standard input")?;
    Ok(Content::Bytes(bytes))
}

/// All of a regular file.
pub fn regular(path: &Path, monitor: &dyn Monitor) -> anyhow::Result<Vec<u8>> {
    Content::File(open_regular(path)?).bytes(monitor)
}

/// Opens a regular file and nothing else.
///
/// Pipes and devices are refused before they are opened, because opening alone can wait, or do
/// something. What takes a file's place in between does not make us wait.
pub fn open_regular(path: &Path) -> io::Result<File> {
    ensure_regular(&std::fs::metadata(path)?)?;
    let mut options = OpenOptions::new();
    options.read(true);
    system::opens_at_once(&mut options);
    let file = options.open(path)?;
    ensure_regular(&file.metadata()?)?;
    Ok(file)
}

fn ensure_regular(about: &Metadata) -> io::Result<()> {
    match what(about) {
        None => Ok(()),
        Some(what) => Err(io::Error::new(
            ErrorKind::InvalidInput,
            format!("it is {what}, where a regular file was expected"),
        )),
    }
}

/// What something is that is no regular file.
pub fn what(about: &Metadata) -> Option<&'static str> {
    if about.is_file() {
        None
    } else if about.is_dir() {
        Some("a directory")
    } else if system::is_pipe(about) {
        Some("a pipe")
    } else {
        Some("a device or a socket")
    }
}

impl Content {
    /// All of it.
    pub fn bytes(self, monitor: &dyn Monitor) -> anyhow::Result<Vec<u8>> {
        let mut file = match self {
            Self::Bytes(bytes) => return Ok(bytes),
            Self::File(file) => file,
        };
        let announced = file.metadata()?.len();
        monitor.admit(READING, announced, READING_ADVICE)?;
        let mut bytes = Vec::with_capacity(usize::try_from(announced)?);
        loop {
            monitor.check()?;
            // A file that grows meanwhile, and those of /proc, which say that they are empty.
            let all = bytes.len() + PIECE.min((announced as usize).saturating_sub(bytes.len())).max(1);
            if all > bytes.capacity() {
                monitor.admit(READING, bytes_grown::<u8>(bytes.len() + PIECE), READING_ADVICE)?;
            }
            let room = (bytes.capacity() - bytes.len()).clamp(1, PIECE);
            if (&mut file).take(room as u64).read_to_end(&mut bytes)? == 0 {
                return Ok(bytes);
            }
            monitor.advance(Phase::Read, bytes.len() as u64, Some(announced.max(bytes.len() as u64)));
        }
    }

    /// Whether it is a file that points are read from without holding it.
    pub fn is_streamed(&mut self, name: &str) -> io::Result<bool> {
        let Self::File(file) = self else { return Ok(false) };
        let mut opening = Vec::new();
        file.by_ref().take(Input::OPENING).read_to_end(&mut opening)?;
        file.rewind()?;
        Ok(Input::is_streamed(name, &opening))
    }

    /// Geometry or a picture; points are thinned to cubes with sides `cube`, if it is given. No more of the file is held
    /// than that takes.
    pub fn input(mut self, name: &str, cube: Option<f64>, monitor: &dyn Monitor) -> anyhow::Result<Input> {
        if self.is_streamed(name)?
            && let Self::File(file) = self
        {
            return Ok(Input::stream(name, file, cube, monitor)?);
        }
        let bytes = self.bytes(monitor)?;
        Ok(Input::read_thinned(name, &bytes, cube, &Holding::new(monitor, bytes.len() as u64))?)
    }

    /// The recipe that it carries, if it is a file of ours. Reads as much of it as that takes.
    pub fn recipe(&mut self, monitor: &dyn Monitor) -> anyhow::Result<Option<String>> {
        let found = match self {
            Self::Bytes(bytes) => linden_exporters::recipe_in(&mut Cursor::new(bytes))?,
            Self::File(file) => {
                let found = linden_exporters::recipe_in(&mut BufReader::new(Watched::new(file, monitor)));
                let found = found.map_err(|error| match error.downcast::<Cancelled>() {
                    Ok(cancelled) => anyhow::Error::from(cancelled),
                    Err(error) => error.into(),
                })?;
                file.rewind()?;
                found
            }
        };
        Ok(found)
    }
}

/// A file that is read only until it is cancelled, and no more of it than there is memory for.
struct Watched<'a> {
    file: &'a mut File,
    monitor: &'a dyn Monitor,
    read: u64,
}

impl<'a> Watched<'a> {
    fn new(file: &'a mut File, monitor: &'a dyn Monitor) -> Self {
        Self { file, monitor, read: 0 }
    }
}

impl Read for Watched<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        self.monitor.check().map_err(io::Error::other)?;
        self.monitor.admit(READING, self.read, READING_ADVICE).map_err(io::Error::other)?;
        let count = self.file.read(buffer)?;
        self.read += count as u64;
        Ok(count)
    }
}

impl Seek for Watched<'_> {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.file.seek(to)
    }
}

/// All that comes through a pipe. A thread opens and reads it, so that a signal is heard while nothing
/// comes; when it is not waited for any more, it ends with what it reads next, or with the program.
fn from_pipe<R: Read>(
    open: impl FnOnce() -> io::Result<R> + Send + 'static,
    monitor: &dyn Monitor,
) -> anyhow::Result<Vec<u8>> {
    // Few pieces at a time: the reader is not to be far ahead of what was asked for.
    let (sender, pieces) = mpsc::sync_channel(2);
    std::thread::spawn(move || {
        let mut pipe = match open() {
            Ok(pipe) => pipe,
            Err(error) => return drop(sender.send(Err(error))),
        };
        loop {
            let mut piece = vec![0; PIECE / 16];
            let read = pipe.read(&mut piece);
            if read.as_ref().is_err_and(|error| error.kind() == ErrorKind::Interrupted) {
                continue;
            }
            let is_last = !matches!(read, Ok(1..));
            let sent = sender.send(read.map(|count| {
                piece.truncate(count);
                piece
            }));
            if is_last || sent.is_err() {
                return;
            }
        }
    });
    gather(&pieces, monitor)
}

/// Puts together what comes, up to the first empty piece.
fn gather(pieces: &Receiver<io::Result<Vec<u8>>>, monitor: &dyn Monitor) -> anyhow::Result<Vec<u8>> {
    let mut bytes: Vec<u8> = Vec::new();
    loop {
        monitor.check()?;
        match pieces.recv_timeout(LOOK) {
            Ok(piece) => {
                let piece = piece?;
                if piece.is_empty() {
                    return Ok(bytes);
                }
                monitor.admit(READING, bytes_grown::<u8>(bytes.len() + piece.len()), READING_ADVICE)?;
                bytes.extend(piece);
                monitor.advance(Phase::Read, bytes.len() as u64, None);
            }
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => bail!("the reader stopped"),
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicU64, Ordering};

    use super::*;

    /// Allows a number of bytes, and cancels after a number of looks.
    struct Strict {
        limit: u64,
        looks: u64,
        looked: AtomicU64,
    }

    impl Strict {
        fn new(limit: u64, looks: u64) -> Self {
            Self { limit, looks, looked: AtomicU64::new(0) }
        }
    }

    impl Monitor for Strict {
        fn is_cancelled(&self) -> bool {
            self.looked.fetch_add(1, Ordering::Relaxed) >= self.looks
        }

        fn advance(&self, _: Phase, _: u64, _: Option<u64>) {}

        fn memory_limit(&self) -> u64 {
            self.limit
        }
    }

    /// A file of zeros that takes no place on the disk.
    fn sparse(dir: &Path, bytes: u64) -> std::path::PathBuf {
        let path = dir.join("sparse.xyz");
        File::create(&path).unwrap().set_len(bytes).unwrap();
        path
    }

    #[test]
    fn a_file_is_read_whole_in_pieces() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("a");
        for length in [0, 1, PIECE - 1, PIECE, PIECE + 1, 3 * PIECE + 7] {
            let bytes: Vec<u8> = (0..length).map(|i| (i % 251) as u8).collect();
            std::fs::write(&path, &bytes).unwrap();
            let monitor = Strict::new(length as u64 + 2 * bytes_grown::<u8>(PIECE + length), u64::MAX);
            assert!(regular(&path, &monitor).unwrap() == bytes, "{length}");
        }
    }

    #[test]
    fn a_length_is_refused_before_anything_is_read() {
        let dir = tempfile::tempdir().unwrap();
        let path = sparse(dir.path(), 1 << 40);
        let error = regular(&path, &Strict::new(64 << 20, u64::MAX)).unwrap_err().to_string();
        assert!(error.contains("1.00 TiB") && error.contains("64.0 MiB"), "{error}");
    }

    #[test]
    fn reading_stops_at_the_next_piece() {
        let dir = tempfile::tempdir().unwrap();
        let path = sparse(dir.path(), 64 << 20);
        let monitor = Strict::new(u64::MAX, 3);
        assert!(regular(&path, &monitor).unwrap_err().is::<Cancelled>());
        assert_eq!(
            monitor.looked.into_inner(),
            4,
            "a look for each of three pieces, and the one that said no"
        );
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_file_that_says_it_is_empty_is_bounded_too() {
        let bytes = regular(Path::new("/proc/self/status"), &Strict::new(1 << 30, u64::MAX)).unwrap();
        assert!(bytes.starts_with(b"Name:"));
        assert!(regular(Path::new("/proc/self/status"), &Strict::new(10, u64::MAX)).is_err());
    }

    #[cfg(unix)]
    #[test]
    fn devices_directories_and_pipes_are_no_files() {
        for (path, what) in [("/dev/zero", "a device"), ("/", "a directory")] {
            let error = regular(Path::new(path), &linden::Quiet).unwrap_err().to_string();
            assert!(error.contains(what), "{path}: {error}");
        }
    }

    #[test]
    fn a_pipe_without_end_is_read_up_to_the_limit() {
        let monitor = Strict::new(8 << 20, u64::MAX);
        let error = from_pipe(|| Ok(io::repeat(b'a')), &monitor).unwrap_err().to_string();
        assert!(error.contains("8.00 MiB"), "{error}");
        assert_eq!(from_pipe(|| Ok(io::repeat(b'a').take(200_000)), &monitor).unwrap().len(), 200_000);
    }

    #[test]
    fn a_silent_pipe_is_left() {
        // Opening it never ends, as it does for a named pipe without a writer.
        let (_keep, never) = mpsc::channel::<()>();
        let open = move || {
            let _ = never.recv();
            Ok(io::empty())
        };
        assert!(from_pipe(open, &Strict::new(u64::MAX, 3)).unwrap_err().is::<Cancelled>());
    }
}
