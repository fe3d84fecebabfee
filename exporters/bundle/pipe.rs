//! Pipes and devices as targets: never waited for without listening for a user who has changed their mind.
//!
//! Opening a pipe that is not read blocks, and so does writing to one whose reader has fallen asleep;
//! both would be deaf to Ctrl-C. So neither is done before the system says that it will not block.

use std::fs::File;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::time::Duration;

use linden_pipeline::{Cancelled, Monitor};

use crate::system;

/// Between two looks at the monitor.
const LOOK: Duration = Duration::from_millis(50);

/// Something that is written to as it is.
pub(super) struct Pipe {
    /// Opened when it has a reader.
    file: Option<File>,
    path: PathBuf,
    /// Bytes that it takes at once when it takes any.
    piece: usize,
}

impl Pipe {
    /// Opens a pipe or device; one without a reader is opened when there is something to write.
    pub fn open(path: &Path) -> io::Result<Self> {
        let mut pipe = Self { file: None, path: path.to_owned(), piece: usize::MAX };
        pipe.try_open()?;
        Ok(pipe)
    }

    /// Standard output, which may be anything.
    pub fn stdout() -> io::Result<Self> {
        let file = system::stdout()?;
        // Whoever shares it expects it to block, and writing more than a piece might.
        let piece = if file.metadata()?.is_file() { usize::MAX } else { system::PIECE };
        Ok(Self { file: Some(file), path: PathBuf::new(), piece })
    }

    /// Whether it is open now; `false` while it has no reader.
    fn try_open(&mut self) -> io::Result<bool> {
        let mut options = File::options();
        options.write(true);
        system::opens_at_once(&mut options);
        match options.open(&self.path) {
            Ok(file) => self.file = Some(file),
            Err(error) if system::has_no_reader(&self.path, &error) => return Ok(false),
            Err(error) => return Err(error),
        }
        Ok(true)
    }

    /// Whether it has no reader yet.
    pub fn is_unread(&mut self) -> bool {
        self.file.is_none() && matches!(self.try_open(), Ok(false))
    }

    /// A way to write to it that hears the monitor: what was cancelled ends with [`Cancelled`] as its
    /// error. Waits for a reader.
    pub fn writer<'a>(&'a mut self, monitor: &'a dyn Monitor) -> io::Result<Patient<'a>> {
        while self.file.is_none() && !self.try_open()? {
            monitor.check().map_err(io::Error::other)?;
            std::thread::sleep(LOOK);
        }
        let Self { file: Some(file), piece, .. } = self else {
            return Err(io::ErrorKind::NotConnected.into());
        };
        Ok(Patient { file, piece: *piece, monitor })
    }
}

/// Writes when that does not block.
pub(super) struct Patient<'a> {
    file: &'a File,
    piece: usize,
    monitor: &'a dyn Monitor,
}

impl Write for Patient<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        loop {
            self.monitor.check().map_err(io::Error::other)?;
            if !system::is_ready(self.file, LOOK)? {
                continue;
            }
            match self.file.write(&bytes[..bytes.len().min(self.piece)]) {
                Err(error) if error.kind() == io::ErrorKind::WouldBlock => {}
                done => return done,
            }
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// Whether an error is that of a writer that was cancelled.
pub(super) fn is_cancelled(error: &io::Error) -> bool {
    error.get_ref().is_some_and(<dyn std::error::Error + Send + Sync>::is::<Cancelled>)
}
