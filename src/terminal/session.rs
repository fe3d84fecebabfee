//! The terminal while it is ours: taken, and given back whatever happens.
//!
//! There is one session in a process, because there is one terminal. What it takes to give it back
//! stands in a static, so that any thread can do it: the end of `main`, a panic, a signal's thread.
//! Giving back is done once however often it is asked for, and never waits long: the terminal may be
//! gone, or at the other end of a line that stands still.

use std::io;
use std::panic::PanicHookInfo;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::ThreadId;
use std::time::{Duration, Instant};

use rustix::event::PollFlags;
use rustix::io::retry_on_intr;
use rustix::process::{Signal, getpgid, getpgrp, getppid, getsid, kill_current_process_group};
use rustix::termios::{
    LocalModes, OptionalActions, QueueSelector, Termios, tcflush, tcgetattr, tcgetpgrp, tcsetattr,
};
use signal_hook::consts::{SIGCONT, SIGTSTP};

use crate::sequences;
use crate::tty::{Tty, wait};

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
    /// How it was before.
    cooked: Termios,
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
        let cooked = tcgetattr(tty.input())?;
        let owner = std::thread::current().id();
        let mut session = Held { tty, cooked, modes, owner, raised: false, replies: None, images: false };
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
        if is_alone() {
            return Ok(false);
        }
        restore();
        let stopped = stop();
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
        let sequence = if on { sequences::MOUSE_ON } else { sequences::MOUSE_OFF };
        held.tty.write_within(sequence, WRITE_LIMIT)
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
        if !self.raised {
            // The user may have changed it since.
            self.cooked = tcgetattr(self.tty.input())?;
        }
        let mut raw = self.cooked.clone();
        raw.make_raw();
        retry_on_intr(|| tcsetattr(self.tty.input(), OptionalActions::Now, &raw))?;
        // From here on there is something to give back, whatever comes of the rest.
        self.raised = true;
        let mut bytes = sequences::ENTER.to_vec();
        if self.modes.mouse {
            bytes.extend_from_slice(sequences::MOUSE_ON);
        }
        let written = self.tty.write_within(&bytes, WRITE_LIMIT);
        if written.is_err() {
            self.lower();
        }
        written
    }

    fn lower(&mut self) {
        if !std::mem::take(&mut self.raised) {
            return;
        }
        let is_ours = !is_background(&self.tty);
        if !is_ours
            && tcgetattr(self.tty.input()).is_ok_and(|now| now.local_modes.contains(LocalModes::TOSTOP))
        {
            // Another job has the terminal, and writing would stop us.
            return;
        }
        // Each step is tried: what one of them could not do, the next may. After a write that the
        // terminal did not take, none of the others would be taken either.
        let mut taken = self.tty.write_within(sequences::QUIET, WRITE_LIMIT).is_ok();
        if let (true, true, Some(within)) = (taken, is_ours, self.replies.take()) {
            drain(&self.tty, within.min(REPLIES_LIMIT));
        }
        if taken && std::mem::take(&mut self.images) {
            taken = self.tty.write_within(sequences::DELETE_IMAGES, WRITE_LIMIT).is_ok();
        }
        if taken {
            let _ = self.tty.write_within(sequences::LEAVE, WRITE_LIMIT);
        }
        if is_ours {
            // TCSAFLUSH would do the same after all output has gone: on a line that stands still
            // that is never. What has come until now is thrown away, not typed at the shell.
            let _ = tcflush(self.tty.input(), QueueSelector::IFlush);
            let _ = retry_on_intr(|| tcsetattr(self.tty.input(), OptionalActions::Now, &self.cooked));
        }
    }
}

/// Reads what is still on its way: the terminal answers in order, so when it has said where the
/// cursor is it has said all. Asked for is what nothing else asks for.
fn drain(tty: &Tty, within: Duration) {
    let deadline = Instant::now() + within;
    let _reading = tty.reading();
    if tty.write_within(sequences::ASK_CURSOR, within).is_err() {
        return;
    }
    let mut tail = Vec::new();
    let mut bytes = [0; 4096];
    while wait(tty.input(), PollFlags::IN, Some(deadline)).is_ok_and(|ready| ready == PollFlags::IN) {
        match rustix::io::read(tty.input(), &mut bytes) {
            Ok(0) | Err(_) => return,
            Ok(count) => tail.extend_from_slice(&bytes[..count]),
        }
        if sequences::tells_cursor(&tail) {
            return;
        }
        // The answer is shorter than this, and may be cut in two.
        tail.drain(..tail.len().saturating_sub(16));
    }
}

/// Whether another job has the terminal. A terminal that does not control us has no jobs of ours.
fn is_background(tty: &Tty) -> bool {
    tcgetpgrp(tty.output()).is_ok_and(|foreground| foreground != getpgrp())
}

/// Whether nothing could continue us: a shell with job control gives each job a group of its own, so
/// in the group of the session's leader there is none. The system ignores SIGTSTP there too (POSIX,
/// "orphaned process group").
fn is_alone() -> bool {
    getsid(None).is_ok_and(|session| session == getpgrp())
}

/// Stops this process as SIGTSTP would; returns when it is continued.
fn stop() -> io::Result<()> {
    let in_our_group = |parent| getpgid(Some(parent)).is_ok_and(|group| group == getpgrp());
    if !getppid().is_some_and(in_our_group) {
        return signal_hook::low_level::emulate_default_handler(SIGTSTP);
    }
    // Started by a script or by sudo: the shell waits for them, so they have to stop as well. This
    // thread may run on for a moment after the call, and must not take the terminal again in it.
    let continued = Arc::new(AtomicBool::new(false));
    let registration = signal_hook::flag::register(SIGCONT, Arc::clone(&continued))?;
    let stopped = kill_current_process_group(Signal::STOP);
    let patience = Instant::now() + Duration::from_secs(1);
    while stopped.is_ok() && !continued.load(Ordering::Acquire) && Instant::now() < patience {
        std::thread::sleep(Duration::from_millis(1));
    }
    signal_hook::low_level::unregister(registration);
    Ok(stopped?)
}
