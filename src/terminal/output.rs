//! A thread that writes, so that no other waits for a slow terminal.
//!
//! There is no queue: the next bytes are made when the last ones are written, from what is newest
//! then. One frame is one call of `write`, if the terminal takes it.

use std::io::{ErrorKind, Write};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// How long a terminal that takes nothing now (`EWOULDBLOCK`) is left alone.
const RETRY: Duration = Duration::from_millis(2);

/// How many bytes were written, and what they were.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Text, cursor, colours, queries.
    pub text: u64,
    /// Pictures, in cells or in pixels.
    pub picture: u64,
    /// Calls of [`Output::send`].
    pub writes: u64,
}

/// The bytes could not be taken: those before are not written yet. They come back.
#[derive(Debug, PartialEq, Eq)]
pub struct Busy(pub Vec<u8>);

/// The way to the terminal.
///
/// Dropping it lets the last bytes go out but does not wait for them; [`Output::flush`] does.
#[derive(Debug)]
pub struct Output {
    shared: Arc<Shared>,
    counts: Counts,
}

#[derive(Debug, Default)]
struct Shared {
    state: Mutex<State>,
    changed: Condvar,
}

#[derive(Debug, Default)]
struct State {
    /// What is to be written next.
    job: Option<Vec<u8>>,
    /// Whether something is being written.
    writing: bool,
    /// What went wrong; nothing is written afterwards.
    error: Option<(ErrorKind, String)>,
    closed: bool,
}

impl Shared {
    fn lock(&self) -> MutexGuard<'_, State> {
        // The state is whole at any moment, also where a panic has left it.
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Output {
    /// Starts the thread. `done` is called on it after each write, also after one that failed.
    ///
    /// # Errors
    /// When the system gives no thread.
    pub fn new(
        write: impl Write + Send + 'static,
        done: impl Fn() + Send + 'static,
    ) -> std::io::Result<Self> {
        let shared = Arc::new(Shared::default());
        let of_thread = Arc::clone(&shared);
        std::thread::Builder::new()
            .name("output".to_owned())
            .spawn(move || write_all_that_comes(&of_thread, write, &done))?;
        Ok(Self { shared, counts: Counts::default() })
    }

    /// Whether all bytes are written: the next ones may be sent.
    pub fn is_idle(&self) -> bool {
        let state = self.shared.lock();
        state.job.is_none() && !state.writing
    }

    /// Hands bytes over, `picture` of them a picture's.
    ///
    /// # Errors
    /// [`Busy`] with the bytes while others are being written. After an [`Output::error`] bytes are
    /// taken and thrown away.
    pub fn send(&mut self, bytes: Vec<u8>, picture: usize) -> Result<(), Busy> {
        let mut state = self.shared.lock();
        if state.error.is_some() {
            return Ok(());
        }
        if state.job.is_some() || state.writing {
            return Err(Busy(bytes));
        }
        self.counts.picture += picture.min(bytes.len()) as u64;
        self.counts.text += bytes.len().saturating_sub(picture) as u64;
        self.counts.writes += 1;
        state.job = Some(bytes);
        drop(state);
        self.shared.changed.notify_all();
        Ok(())
    }

    /// Why nothing can be written any more: `EIO` and `EPIPE` mean that the terminal is gone.
    pub fn error(&self) -> Option<std::io::Error> {
        let state = self.shared.lock();
        state.error.as_ref().map(|(kind, text)| std::io::Error::new(*kind, text.clone()))
    }

    /// Waits until all is written; whether it was in time.
    pub fn flush(&self, timeout: Duration) -> bool {
        let end = Instant::now() + timeout;
        let mut state = self.shared.lock();
        while state.error.is_none() && (state.job.is_some() || state.writing) {
            let Some(left) = end.checked_duration_since(Instant::now()).filter(|left| !left.is_zero()) else {
                return false;
            };
            let waited = self.shared.changed.wait_timeout(state, left);
            state = waited.unwrap_or_else(PoisonError::into_inner).0;
        }
        state.error.is_none()
    }

    /// Counts of the bytes sent so far.
    pub const fn counts(&self) -> Counts {
        self.counts
    }
}

impl Drop for Output {
    fn drop(&mut self) {
        self.shared.lock().closed = true;
        self.shared.changed.notify_all();
    }
}

/// The thread: ends when the output is dropped or the terminal is gone.
fn write_all_that_comes(shared: &Shared, mut write: impl Write, done: &impl Fn()) {
    loop {
        let mut state = shared.lock();
        let bytes = loop {
            if let Some(bytes) = state.job.take() {
                break bytes;
            }
            if state.closed {
                return;
            }
            state = shared.changed.wait(state).unwrap_or_else(PoisonError::into_inner);
        };
        state.writing = true;
        drop(state);
        let result = write_whole(&mut write, &bytes);
        let mut state = shared.lock();
        state.writing = false;
        let failed = result.is_err();
        state.error = result.err().map(|error| (error.kind(), error.to_string()));
        drop(state);
        shared.changed.notify_all();
        done();
        if failed {
            return;
        }
    }
}

/// As `write_all`, for a terminal that may have been made non-blocking by another program.
fn write_whole(write: &mut impl Write, mut bytes: &[u8]) -> std::io::Result<()> {
    while !bytes.is_empty() {
        match write.write(bytes) {
            Ok(0) => return Err(ErrorKind::WriteZero.into()),
            Ok(written) => bytes = &bytes[written..],
            Err(error) if error.kind() == ErrorKind::Interrupted => {}
            Err(error) if error.kind() == ErrorKind::WouldBlock => std::thread::sleep(RETRY),
            Err(error) => return Err(error),
        }
    }
    write.flush()
}

#[cfg(test)]
mod tests {
    use std::sync::mpsc;

    use super::*;

    /// Writes when it is let, and tells what.
    struct Gate {
        open: mpsc::Receiver<std::io::Result<usize>>,
        written: mpsc::Sender<Vec<u8>>,
    }

    impl Write for Gate {
        fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
            let n = self.open.recv().unwrap_or(Ok(usize::MAX))?.min(bytes.len());
            self.written.send(bytes[..n].to_vec()).ok();
            Ok(n)
        }

        fn flush(&mut self) -> std::io::Result<()> {
            Ok(())
        }
    }

    struct Rig {
        output: Output,
        open: mpsc::Sender<std::io::Result<usize>>,
        written: mpsc::Receiver<Vec<u8>>,
        done: mpsc::Receiver<()>,
    }

    fn rig() -> Rig {
        let (open, gate) = mpsc::channel();
        let (told, written) = mpsc::channel();
        let (tell_done, done) = mpsc::channel();
        let write = Gate { open: gate, written: told };
        let output = Output::new(write, move || tell_done.send(()).unwrap()).unwrap();
        Rig { output, open, written, done }
    }

    #[test]
    fn the_sender_does_not_wait_and_nothing_is_queued() {
        let mut rig = rig();
        rig.output.send(b"first".to_vec(), 0).unwrap();
        assert!(!rig.output.is_idle());
        assert_eq!(rig.output.send(b"second".to_vec(), 0), Err(Busy(b"second".to_vec())));
        rig.open.send(Ok(usize::MAX)).unwrap();
        rig.done.recv().unwrap();
        assert_eq!(rig.written.recv().unwrap(), b"first", "one call of write");
        assert!(rig.output.is_idle());
        rig.output.send(b"third".to_vec(), 2).unwrap();
        assert_eq!(rig.output.counts(), Counts { text: 8, picture: 2, writes: 2 });
    }

    #[test]
    fn a_terminal_that_takes_little_gets_the_rest() {
        let mut rig = rig();
        for n in [Ok(2), Err(ErrorKind::Interrupted.into()), Err(ErrorKind::WouldBlock.into()), Ok(9)] {
            rig.open.send(n).unwrap();
        }
        rig.output.send(b"abcdef".to_vec(), 0).unwrap();
        assert!(rig.output.flush(Duration::from_mins(1)));
        assert_eq!(rig.written.try_iter().collect::<Vec<_>>(), [b"ab".to_vec(), b"cdef".to_vec()]);
    }

    #[test]
    fn a_terminal_that_is_gone_is_told() {
        let mut rig = rig();
        rig.open.send(Err(ErrorKind::BrokenPipe.into())).unwrap();
        rig.output.send(b"lost".to_vec(), 0).unwrap();
        rig.done.recv().unwrap();
        assert_eq!(rig.output.error().map(|error| error.kind()), Some(ErrorKind::BrokenPipe));
        assert!(!rig.output.flush(Duration::from_mins(1)), "nothing is waited for");
        assert_eq!(rig.output.send(b"more".to_vec(), 0), Ok(()), "what comes after is thrown away");
    }

    #[test]
    fn flush_gives_up() {
        let mut rig = rig();
        rig.output.send(b"stuck".to_vec(), 0).unwrap();
        assert!(!rig.output.flush(Duration::from_millis(1)));
    }

    #[test]
    fn what_was_sent_before_the_end_is_written() {
        let mut rig = rig();
        rig.output.send(b"last".to_vec(), 0).unwrap();
        drop(rig.output);
        rig.open.send(Ok(usize::MAX)).unwrap();
        assert_eq!(rig.written.recv().unwrap(), b"last");
    }
}
