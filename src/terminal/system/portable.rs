//! Everything but Unix: crossterm reads, and turns on what the console can.
//!
//! Crossterm's reader gives no replies of the terminal, so nothing is asked: what a terminal can do is what
//! the environment says, or the user. There is no job control, and Ctrl-C is a key.

use std::io::{self, Write as _};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use crossterm::event::{
    DisableMouseCapture, EnableMouseCapture, Event, KeyEvent, KeyEventKind, MouseEventKind,
};
use crossterm::tty::IsTty as _;

use crate::input::Said;
use crate::listen::Incoming;
use crate::probe::{Environment, Findings};
use crate::size::used;
use crate::tty::{OpenError, Stream, WindowSize};

/// Whether replies of the terminal reach us.
pub const ANSWERS: bool = false;

/// How long a wait for a key may keep one who wants the terminal for himself.
const LOOK: Duration = Duration::from_millis(50);
/// The most events that are passed on at once.
const MOST_AT_ONCE: usize = 1024;

/// The console that standard input and standard output are. Copies are the same one.
#[derive(Clone, Debug)]
pub struct Tty {
    /// Whoever holds this may read.
    reading: Arc<Mutex<()>>,
}

impl Tty {
    /// The console that standard input and standard output are.
    ///
    /// # Errors
    /// [`OpenError::NotATerminal`] says which of them is none.
    pub fn open() -> Result<Self, OpenError> {
        if !io::stdin().is_tty() {
            return Err(OpenError::NotATerminal(Stream::Input));
        }
        if !io::stdout().is_tty() {
            return Err(OpenError::NotATerminal(Stream::Output));
        }
        Ok(Self { reading: Arc::default() })
    }

    /// How large it is now. 80×24 when it does not know; no pixels are told.
    pub fn size(&self) -> WindowSize {
        match crossterm::terminal::size() {
            Ok((columns, rows)) if columns > 0 && rows > 0 => {
                WindowSize { columns: used(columns), rows: used(rows), ..WindowSize::default() }
            }
            _ => WindowSize::default(),
        }
    }

    /// Writes all of it. A console takes what it is given, whatever the limit is.
    #[expect(clippy::unused_self, reason = "a terminal elsewhere has descriptors")]
    pub(crate) fn write_within(&self, bytes: &[u8], _limit: Duration) -> io::Result<()> {
        let mut out = io::stdout().lock();
        out.write_all(bytes)?;
        out.flush()
    }

    /// Turns reports of the mouse on or off.
    #[expect(clippy::unused_self, reason = "a terminal elsewhere has descriptors")]
    pub(crate) fn set_mouse(&self, on: bool, _limit: Duration) -> io::Result<()> {
        let mut out = io::stdout().lock();
        if on {
            crossterm::execute!(out, EnableMouseCapture)
        } else {
            crossterm::execute!(out, DisableMouseCapture)
        }
    }

    fn reading(&self) -> MutexGuard<'_, ()> {
        self.reading.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl io::Write for Tty {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.write_within(bytes, Duration::MAX)?;
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// The thread that listens. Dropping ends it.
#[derive(Debug)]
pub struct Listener {
    tty: Tty,
    shared: Arc<Shared>,
}

#[derive(Debug, Default)]
struct Shared {
    /// Whether another program has the terminal for the moment. Changed only while it is not read.
    paused: AtomicBool,
    closed: AtomicBool,
}

/// Listens to a terminal that is in raw mode. `send` is called from a thread; when it says `false`, its
/// receiver is gone and the thread ends.
///
/// # Errors
/// What the system says when it refuses a thread.
pub fn listen(tty: Tty, send: impl Fn(Incoming) -> bool + Send + Clone + 'static) -> io::Result<Listener> {
    let shared = Arc::new(Shared::default());
    let listener = Listener { tty: tty.clone(), shared: Arc::clone(&shared) };
    std::thread::Builder::new()
        .name("terminal-input".into())
        .spawn(move || pass_events(&tty, &shared, &send))?;
    Ok(listener)
}

fn pass_events(tty: &Tty, shared: &Shared, send: &impl Fn(Incoming) -> bool) {
    while !shared.closed.load(Ordering::Acquire) {
        let found = {
            let _reading = tty.reading();
            if shared.paused.load(Ordering::Acquire) { Ok(Vec::new()) } else { events() }
        };
        if shared.paused.load(Ordering::Acquire) {
            std::thread::sleep(LOOK);
        }
        let Ok(found) = found else {
            send(Incoming::Hangup);
            return;
        };
        let resized = found.iter().any(|event| matches!(event, Event::Resize(..)));
        let said: Vec<Said> = found.into_iter().filter_map(meant).map(Said::Event).collect();
        if (resized && !send(Incoming::Resized)) || (!said.is_empty() && !send(Incoming::Input(said))) {
            return;
        }
    }
}

/// What has come, after a short wait for the first.
fn events() -> io::Result<Vec<Event>> {
    let mut found = Vec::new();
    let mut wait = LOOK;
    while found.len() < MOST_AT_ONCE && crossterm::event::poll(wait)? {
        found.push(crossterm::event::read()?);
        wait = Duration::ZERO;
    }
    Ok(found)
}

/// An event as the parser of Unix would have it; `None` for what is nothing to the program.
fn meant(event: Event) -> Option<Event> {
    match event {
        Event::Resize(..) => None,
        Event::Key(key) if key.kind == KeyEventKind::Release => None,
        Event::Key(key) => Some(Event::Key(KeyEvent::new(key.code, key.modifiers))),
        Event::Mouse(mouse) => match mouse.kind {
            MouseEventKind::Moved | MouseEventKind::ScrollLeft | MouseEventKind::ScrollRight => None,
            _ => Some(event),
        },
        _ => Some(event),
    }
}

impl Listener {
    /// Leaves the terminal to somebody else: when this returns, nothing of it is read.
    pub fn pause(&self) {
        let _reading = self.tty.reading();
        self.shared.paused.store(true, Ordering::Release);
    }

    /// The terminal is ours again.
    pub fn resume(&self) {
        self.shared.paused.store(false, Ordering::Release);
    }
}

impl Drop for Listener {
    fn drop(&mut self) {
        // Not joined: the thread may be waiting in `send` for the one that drops this.
        self.shared.closed.store(true, Ordering::Release);
    }
}

/// Nothing is asked.
///
/// # Errors
/// None here.
pub fn ask(tty: &Tty, _environment: &Environment, _within: Duration) -> io::Result<Findings> {
    let mut findings = Findings::default();
    findings.take_window(tty.size());
    findings.ask_nothing();
    Ok(findings)
}

/// What a variable that is not set stands for. Windows' console sets none, and has 24-bit colours since
/// version 1703 of 2017.
pub(crate) fn stands_for(name: &str) -> Option<&'static str> {
    (cfg!(windows) && name == "COLORTERM").then_some("truecolor")
}

/// Columns and rows of the terminal that the process has.
pub(crate) fn asked_size() -> Option<(u16, u16)> {
    crossterm::terminal::size().ok()
}

/// Whether the terminal takes control sequences; Windows' console is asked to.
pub fn takes_sequences() -> bool {
    #[cfg(windows)]
    return crossterm::ansi_support::supports_ansi();
    #[cfg(not(windows))]
    true
}

/// Whether no other job has the terminal: there are none.
pub(crate) fn is_ours(_: &Tty) -> bool {
    true
}

/// Whether writing would not stop us.
pub(crate) fn may_be_written(_: &Tty) -> bool {
    true
}

/// Throws away what has come and was not read.
pub(crate) fn discard_input(tty: &Tty) {
    let _reading = tty.reading();
    while crossterm::event::poll(Duration::ZERO).unwrap_or(false) {
        if crossterm::event::read().is_err() {
            return;
        }
    }
}

/// Reads what is still on its way: nothing was asked.
pub(crate) fn drain(_: &Tty, _within: Duration) {}

/// Whether something could continue us once we stop: there is no job control.
pub(crate) fn stops() -> bool {
    false
}

/// Is not called: nothing could continue us.
#[expect(clippy::unnecessary_wraps, reason = "elsewhere the system can refuse")]
pub(crate) fn stop() -> io::Result<()> {
    Ok(())
}
