//! Pipes and devices as targets: never waited for without an ear for who has changed their mind.
//!
//! Opening a pipe that is not read blocks, and so does writing to one whose reader has fallen asleep;
//! both would be deaf to Ctrl-C. So neither is done before the system says that it will not block.

use std::fs::File;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::time::Duration;

use linden_pipeline::{Cancelled, Monitor};

/// Between two looks at the monitor.
const LOOK: Duration = Duration::from_millis(50);
/// Bytes that a pipe takes without blocking when it says that it takes any (POSIX: at least 512, and
/// what Linux and macOS say is atomic).
const PIECE: usize = if cfg!(target_os = "linux") { 4096 } else { 512 };

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
    #[cfg(unix)]
    pub fn stdout() -> io::Result<Self> {
        use std::os::fd::AsFd;
        let file = File::from(io::stdout().as_fd().try_clone_to_owned()?);
        // Whoever shares it expects it to block, and writing more than a piece might.
        let piece = if file.metadata()?.is_file() { usize::MAX } else { PIECE };
        Ok(Self { file: Some(file), path: PathBuf::new(), piece })
    }

    /// Whether it is open now; `false` while it has no reader.
    fn try_open(&mut self) -> io::Result<bool> {
        let mut options = File::options();
        options.write(true);
        #[cfg(unix)]
        {
            use std::os::unix::fs::OpenOptionsExt;
            let flags = rustix::fs::OFlags::NONBLOCK | rustix::fs::OFlags::NOCTTY;
            options.custom_flags(flags.bits() as i32);
        }
        match options.open(&self.path) {
            Ok(file) => self.file = Some(file),
            Err(error) if self.has_no_reader(&error) => return Ok(false),
            Err(error) => return Err(error),
        }
        Ok(true)
    }

    /// Whether it has no reader yet.
    pub fn is_unread(&mut self) -> bool {
        self.file.is_none() && matches!(self.try_open(), Ok(false))
    }

    /// What the system says of a pipe that is not read.
    #[cfg(unix)]
    fn has_no_reader(&self, error: &io::Error) -> bool {
        use std::os::unix::fs::FileTypeExt;
        let is_pipe = || std::fs::metadata(&self.path).is_ok_and(|meta| meta.file_type().is_fifo());
        rustix::io::Errno::from_io_error(error) == Some(rustix::io::Errno::NXIO) && is_pipe()
    }

    #[cfg(not(unix))]
    fn has_no_reader(&self, _: &io::Error) -> bool {
        false
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
            if !is_ready(self.file)? {
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

/// Waits a moment until it can be written to; a failure is left to the writing.
#[cfg(unix)]
fn is_ready(file: &File) -> io::Result<bool> {
    use rustix::event::{PollFd, PollFlags, Timespec, poll};
    let look = Timespec { tv_sec: 0, tv_nsec: LOOK.subsec_nanos().into() };
    match poll(&mut [PollFd::new(file, PollFlags::OUT)], Some(&look)) {
        Ok(count) => Ok(count > 0),
        Err(rustix::io::Errno::INTR) => Ok(false),
        Err(error) => Err(error.into()),
    }
}

#[cfg(not(unix))]
fn is_ready(_: &File) -> io::Result<bool> {
    Ok(true)
}

/// Whether an error is that of a writer that was cancelled.
pub(super) fn is_cancelled(error: &io::Error) -> bool {
    error.get_ref().is_some_and(<dyn std::error::Error + Send + Sync>::is::<Cancelled>)
}
