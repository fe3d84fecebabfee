//! The terminal's descriptors.

use std::io;
use std::os::fd::{AsFd, BorrowedFd, OwnedFd};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::fs::{Mode, OFlags};
use rustix::io::Errno;
use rustix::termios::{isatty, tcgetwinsize, ttyname};

use crate::sequences;
use crate::size::used;
use crate::tty::{OpenError, Stream, WindowSize};

/// Buttons (1000), drags (1002), cells beyond 223 (1006). Crossterm asks for 1003 too, motion with no
/// button down: that is nothing to us, and over a slow link it is many bytes.
const MOUSE_ON: &str = "\x1b[?1000h\x1b[?1002h\x1b[?1006h";

/// A terminal that is both standard input and standard output. Copies are the same terminal.
///
/// As [`io::Write`] it is not buffered and waits as long as the terminal does: give it whole frames,
/// from a thread that may wait.
#[derive(Clone, Debug)]
pub struct Tty(Arc<Ends>);

#[derive(Debug)]
struct Ends {
    input: OwnedFd,
    output: OwnedFd,
    /// The same terminal, opened once more for writing without waiting. Making `output` itself so
    /// would make it so for the shell too, which shares it.
    unblocked: Option<OwnedFd>,
    /// Whoever holds this may read: the input thread, or who wants a reply for itself.
    reading: Mutex<()>,
}

impl Tty {
    /// The terminal that standard input and standard output are.
    ///
    /// # Errors
    /// [`OpenError::NotATerminal`] says which of them is none.
    pub fn open() -> Result<Self, OpenError> {
        let copy = |fd: BorrowedFd<'_>, stream| {
            if !isatty(fd) {
                return Err(OpenError::NotATerminal(stream));
            }
            fd.try_clone_to_owned().map_err(|source| OpenError::Descriptor { stream, source })
        };
        let input = copy(rustix::stdio::stdin(), Stream::Input)?;
        let output = copy(rustix::stdio::stdout(), Stream::Output)?;
        Self::over(input, output)
    }

    /// A terminal by its descriptors.
    ///
    /// # Errors
    /// [`OpenError::NotATerminal`] says which of them is none.
    pub fn over(input: OwnedFd, output: OwnedFd) -> Result<Self, OpenError> {
        for (fd, stream) in [(&input, Stream::Input), (&output, Stream::Output)] {
            if !isatty(fd) {
                return Err(OpenError::NotATerminal(stream));
            }
        }
        let unblocked = ttyname(&output, Vec::new())
            .and_then(|path| {
                let flags = OFlags::WRONLY | OFlags::NOCTTY | OFlags::NONBLOCK | OFlags::CLOEXEC;
                rustix::fs::open(path, flags, Mode::empty())
            })
            .ok();
        Ok(Self(Arc::new(Ends { input, output, unblocked, reading: Mutex::new(()) })))
    }

    /// How large it is now. 80×24 when it does not know, as one without a size.
    pub fn size(&self) -> WindowSize {
        let fallback = WindowSize::default();
        match tcgetwinsize(&self.0.output) {
            Ok(size) if size.ws_col > 0 && size.ws_row > 0 => {
                let (columns, rows) = (used(size.ws_col), used(size.ws_row));
                let share = |px: u16, cells: u16, claimed: u16| {
                    (u32::from(px) * u32::from(cells) / u32::from(claimed)) as u16
                };
                WindowSize {
                    columns,
                    rows,
                    width_px: share(size.ws_xpixel, columns, size.ws_col),
                    height_px: share(size.ws_ypixel, rows, size.ws_row),
                }
            }
            _ => fallback,
        }
    }

    pub(crate) fn input(&self) -> BorrowedFd<'_> {
        self.0.input.as_fd()
    }

    pub(crate) fn output(&self) -> BorrowedFd<'_> {
        self.0.output.as_fd()
    }

    /// Waits until no other thread reads, and keeps others from reading.
    pub(crate) fn reading(&self) -> MutexGuard<'_, ()> {
        self.0.reading.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Turns reports of the mouse on or off.
    pub(crate) fn set_mouse(&self, on: bool, limit: Duration) -> io::Result<()> {
        let sequence = if on { MOUSE_ON } else { sequences::MOUSE_OFF };
        self.write_within(sequence.as_bytes(), limit)
    }

    /// Writes all of it, or fails when the terminal does not take it in that time: it is gone, its
    /// line stands still, or a large picture is on its way.
    pub(crate) fn write_within(&self, mut bytes: &[u8], limit: Duration) -> io::Result<()> {
        /// What the kernel has room for when it says that there is room (Linux: `WAKEUP_CHARS`).
        const PIECE: usize = 256;
        let deadline = Instant::now() + limit;
        let fd = self.0.unblocked.as_ref().unwrap_or(&self.0.output);
        while !bytes.is_empty() {
            let ready = wait(fd, PollFlags::OUT, Some(deadline))?;
            if ready.intersects(PollFlags::HUP | PollFlags::ERR | PollFlags::NVAL) {
                return Err(Errno::IO.into());
            }
            if ready.is_empty() {
                return Err(Errno::TIMEDOUT.into());
            }
            match rustix::io::write(fd, &bytes[..bytes.len().min(PIECE)]) {
                Ok(written) => bytes = &bytes[written..],
                Err(Errno::INTR) => {}
                Err(Errno::AGAIN) => std::thread::sleep(Duration::from_millis(1)),
                Err(error) => return Err(error.into()),
            }
        }
        Ok(())
    }
}

impl io::Write for Tty {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        loop {
            match rustix::io::write(&self.0.output, bytes) {
                // Another program has made the terminal one that does not wait, and left it so.
                Err(Errno::AGAIN) => wait(&self.0.output, PollFlags::OUT, None).map(drop)?,
                Err(Errno::INTR) => {}
                written => return Ok(written?),
            }
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// Waits for one descriptor; what it is ready for, nothing when the time is over.
pub(crate) fn wait(fd: impl AsFd, flags: PollFlags, deadline: Option<Instant>) -> io::Result<PollFlags> {
    let mut fds = [PollFd::from_borrowed_fd(fd.as_fd(), flags)];
    wait_any(&mut fds, deadline)?;
    Ok(fds[0].revents())
}

/// Waits for any of them; whether one is ready before the time is over.
pub(crate) fn wait_any(fds: &mut [PollFd<'_>], deadline: Option<Instant>) -> io::Result<bool> {
    loop {
        let left = deadline.map(|at| at.saturating_duration_since(Instant::now()));
        // A wait beyond what the type holds is one without an end.
        let left = left.and_then(|left| Timespec::try_from(left).ok());
        match poll(fds, left.as_ref()) {
            Ok(ready) => return Ok(ready > 0),
            Err(Errno::INTR) => {}
            Err(error) => return Err(error.into()),
        }
    }
}
