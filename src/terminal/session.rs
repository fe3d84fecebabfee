//! The terminal while it is ours: taken, and given back whatever happens.
//!
//! There is one session in a process, because there is one terminal. What it takes to give it back
//! stands in a static, so that any thread can do it: the end of `main`, a panic, a signal's thread.
//! Giving back is done once however often it is asked for, and never waits long: the terminal may be
//! gone, or at the other end of a line that stands still.

use std::io;
use std::panic::PanicHookInfo;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::thread::ThreadId;
use std::time::Duration;

use crossterm::terminal::{disable_raw_mode, enable_raw_mode, is_raw_mode_enabled};

use crate::sequences;
use crate::system::{self, Tty};

/// How long the terminal may keep us from writing what gives it back.
const WRITE_LIMIT: Duration = Duration::from_millis(500);
/// The longest wait for replies that are on their way, whatever the caller thinks.
const REPLIES_LIMIT: Duration = Duration::from_secs(1);

/// Modes of the terminal that a session asks for beyond keys.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Modes {
    /// Buttons, drags and the wheel; never mere motion.
    pub mouse: bool,
}

/// The terminal is ours. Dropping gives it back.
#[derive(Debug)]
#[must_use = "the terminal is given back when this is dropped"]
pub struct Session(());

/// What it takes to give the terminal back.
#[derive(Debug)]
struct Held {
    tty: Tty,
    modes: Modes,
    /// The thread whose panic gives it back.
    owner: ThreadId,
    /// Whether it is ours at this moment.
    raised: bool,
    /// How long replies may still come, when some are awaited.
    replies: Option<Duration>,
    /// Whether it holds images of kitty's protocol.
    images: bool,
}

static HELD: Mutex<Option<Held>> = Mutex::new(None);

fn held() -> MutexGuard<'static, Option<Held>> {
    HELD.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Session {
    /// Takes the terminal: raw mode, alternate screen, no cursor, bracketed paste, focus, and the
    /// mouse when asked for. A panic of the calling thread gives it back (see
    /// [`install_panic_hook`]).
    ///
    /// # Errors
    /// `AlreadyExists` when there is a session; else what the system says when it refuses.
    pub fn start(tty: Tty, modes: Modes) -> io::Result<Self> {
        let mut slot = held();
        if slot.is_some() {
            return Err(io::Error::new(io::ErrorKind::AlreadyExists, "the terminal is taken already"));
        }
        let owner = std::thread::current().id();
        let mut session = Held { tty, modes, owner, raised: false, replies: None, images: false };
        session.raise()?;
        *slot = Some(session);
        Ok(Self(()))
    }

    /// Gives the terminal back until [`Self::resume`], as for an external editor. Does nothing when
    /// that has been done. What the terminal refuses is left: there is no place for a message.
    pub fn restore(&self) {
        restore();
    }

    /// Takes the terminal again, after [`Self::restore`] or when the process was stopped and
    /// continued by others (SIGSTOP, SIGCONT: the shell has made the terminal its own meanwhile).
    /// What was on the screen is gone.
    ///
    /// # Errors
    /// What the system says when it refuses.
    pub fn resume(&self) -> io::Result<()> {
        held().as_mut().map_or(Ok(()), Held::raise)
    }

    /// Ctrl-Z: gives the terminal back, stops the process, and takes it again when it is continued.
    /// `false` when nothing could continue it (`ssh -t host program` has no shell to return to): then
    /// nothing was done.
    ///
    /// # Errors
    /// What the system says when it refuses.
    pub fn suspend(&self) -> io::Result<bool> {
        if !system::stops() {
            return Ok(false);
        }
        restore();
        let stopped = system::stop();
        self.resume()?;
        stopped.map(|()| true)
    }

    /// Tells that replies are awaited, and how long the slowest may take (a few round trips; at
    /// most a second is waited), or that none are: giving back then waits for none.
    pub fn expect_replies(&self, within: Option<Duration>) {
        if let Some(held) = held().as_mut() {
            held.replies = within;
        }
    }

    /// Tells whether the terminal holds images of kitty's protocol, to be deleted when it is given
    /// back.
    pub fn expect_images(&self, any: bool) {
        if let Some(held) = held().as_mut() {
            held.images = any;
        }
    }

    /// Turns the mouse on or off.
    ///
    /// # Errors
    /// What the system says when it refuses.
    pub fn set_mouse(&self, on: bool) -> io::Result<()> {
        let mut slot = held();
        let Some(held) = slot.as_mut() else { return Ok(()) };
        held.modes.mouse = on;
        if !held.raised {
            return Ok(());
        }
        held.tty.set_mouse(on, WRITE_LIMIT)
    }
}

impl Drop for Session {
    fn drop(&mut self) {
        let mut slot = held();
        if let Some(mut held) = slot.take() {
            held.lower();
        }
    }
}

/// Gives the terminal back, if it is ours, from any thread.
pub fn restore() {
    if let Some(held) = held().as_mut() {
        held.lower();
    }
}

/// Gives the terminal back before a panic of the session's thread is told.
///
/// Nothing else may be written to a terminal that is ours: panics of threads whose name begins with
/// `workers`, and of any other thread while there is a session, go to `report` instead.
pub fn install_panic_hook(
    workers: &'static str,
    report: impl Fn(&PanicHookInfo<'_>) + Send + Sync + 'static,
) {
    let previous = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |info| {
        let thread = std::thread::current();
        let is_worker = thread.name().is_some_and(|name| name.starts_with(workers));
        let owner = held().as_ref().filter(|held| held.raised).map(|held| held.owner);
        if is_worker || owner.is_some_and(|owner| owner != thread.id()) {
            return report(info);
        }
        restore();
        previous(info);
    }));
}

impl Held {
    fn raise(&mut self) -> io::Result<()> {
        if is_raw_mode_enabled()? {
            // Another may have changed the modes since: what crossterm takes for raw need not be.
            let _ = disable_raw_mode();
        }
        enable_raw_mode()?;
        // From here on there is something to give back, whatever comes of the rest.
        self.raised = true;
        let written = sequences::enter().and_then(|bytes| self.tty.write_within(&bytes, WRITE_LIMIT));
        let written = written
            .and_then(|()| if self.modes.mouse { self.tty.set_mouse(true, WRITE_LIMIT) } else { Ok(()) });
        if written.is_err() {
            self.lower();
        }
        written
    }

    fn lower(&mut self) {
        if !std::mem::take(&mut self.raised) || !system::may_be_written(&self.tty) {
            return;
        }
        let is_ours = system::is_ours(&self.tty);
        let write = |bytes: io::Result<Vec<u8>>| {
            bytes.and_then(|bytes| self.tty.write_within(&bytes, WRITE_LIMIT)).is_ok()
        };
        // Each step is tried: what one of them could not do, the next may. After a write that the
        // terminal did not take, none of the others would be taken either.
        let mut taken = write(sequences::quiet());
        if let (true, true, Some(within)) = (taken, is_ours, self.replies.take()) {
            system::drain(&self.tty, within.min(REPLIES_LIMIT));
        }
        if taken && std::mem::take(&mut self.images) {
            taken = write(Ok(sequences::DELETE_IMAGES.to_vec()));
        }
        if taken {
            write(sequences::leave());
        }
        if is_ours {
            system::discard_input(&self.tty);
            let _ = disable_raw_mode();
        }
    }
}
