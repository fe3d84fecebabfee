//! Threads that wait for the terminal and for signals, and pass on what comes.
//!
//! They sleep until something comes: nothing is looked at from time to time. One exception: after an
//! ESC, silence tells the key from a sequence, so one more look is taken.

use std::io::{self, PipeReader, PipeWriter, Read as _, Write as _};
use std::sync::atomic::{AtomicBool, AtomicU8, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use rustix::event::{PollFd, PollFlags};
use rustix::io::Errno;
use signal_hook::SigId;
use signal_hook::consts::{SIGCONT, SIGHUP, SIGINT, SIGQUIT, SIGTERM, SIGTSTP, SIGWINCH};
use signal_hook::flag::register_conditional_default;
use signal_hook::iterator::{Handle, Signals};
use signal_hook::low_level::{raise, unregister};

use super::tty::{Tty, wait, wait_any};
use crate::input::Parser;
use crate::listen::Incoming;

/// The threads that listen. Dropping ends them, and signals do by themselves again what they do in
/// any process.
#[derive(Debug)]
pub struct Listener {
    shared: Arc<Shared>,
    signals: Handle,
}

#[derive(Debug)]
struct Shared {
    tty: Tty,
    /// Whether another program has the terminal for the moment. Changed only while it is not read.
    paused: AtomicBool,
    /// Whether the listener is gone; then signals have their default effect.
    closed: Arc<AtomicBool>,
    /// SIGTSTP has its default effect: while an editor has the terminal, its Ctrl-Z stops us both.
    stops: Arc<AtomicBool>,
    /// Whose the signals are: [`OURS`], [`THEIRS`], or [`RETURNING`].
    signals: AtomicU8,
    /// Ends the wait of the input thread.
    wake: PipeWriter,
}

/// Signals are meant for us.
const OURS: u8 = 0;
/// Keys that make signals are typed at another program.
const THEIRS: u8 = 1;
/// They are ours after the next SIGWINCH. Signals that came before it are passed on before it, so
/// the Ctrl-C that ended the other program is not taken for ours, however late its turn comes.
const RETURNING: u8 = 2;

/// Bytes read at once: a paste or a mouse that is dragged comes in few pieces.
const READ_BYTES: usize = 64 * 1024;

/// Signals that are sent one right after the other come within this.
const SIGNALS_MEANT_TOGETHER: Duration = Duration::from_millis(20);

/// Listens to a terminal that is in raw mode, and to signals. `send` is called from both threads;
/// when it says `false`, its receiver is gone and the thread ends. One listener at a time: an earlier
/// one goes on, but signals stay caught after it.
///
/// # Errors
/// What the system says when it refuses a thread, a pipe, or a signal.
pub fn listen(tty: Tty, send: impl Fn(Incoming) -> bool + Send + Clone + 'static) -> io::Result<Listener> {
    let (woken, wake) = io::pipe()?;
    let (closed, stops) = (Arc::new(AtomicBool::new(false)), Arc::new(AtomicBool::new(false)));
    keep_defaults(&closed, &stops)?;
    let signals = Signals::new([SIGCONT, SIGHUP, SIGINT, SIGQUIT, SIGTERM, SIGTSTP, SIGWINCH])?;
    let paused = AtomicBool::new(false);
    let shared = Arc::new(Shared { tty, paused, closed, stops, signals: AtomicU8::new(OURS), wake });
    // From here on an early return ends what was begun.
    let listener = Listener { shared: Arc::clone(&shared), signals: signals.handle() };
    let (to_input, to_signals) = (Arc::clone(&shared), shared);
    let send_input = send.clone();
    std::thread::Builder::new()
        .name("terminal-input".into())
        .spawn(move || Input { shared: to_input, woken, send: send_input }.run())?;
    std::thread::Builder::new()
        .name("terminal-signals".into())
        .spawn(move || pass_signals(signals, &to_signals, send))?;
    Ok(listener)
}

/// Gives each signal its default effect while `closed`, and SIGTSTP while `stops`: one that was caught
/// once would be ignored for ever after the listener is gone. Those of an earlier listener end.
fn keep_defaults(closed: &Arc<AtomicBool>, stops: &Arc<AtomicBool>) -> io::Result<()> {
    static LAST: Mutex<Vec<SigId>> = Mutex::new(Vec::new());
    let mut last = LAST.lock().unwrap_or_else(PoisonError::into_inner);
    for id in last.drain(..) {
        unregister(id);
    }
    for signal in [SIGHUP, SIGINT, SIGQUIT, SIGTERM, SIGTSTP] {
        last.push(register_conditional_default(signal, Arc::clone(closed))?);
    }
    last.push(register_conditional_default(SIGTSTP, Arc::clone(stops))?);
    Ok(())
}

impl Listener {
    /// Leaves the terminal to somebody else: when this returns, nothing of it is read, and Ctrl-C
    /// and Ctrl-Z that are typed there are not ours. That it is gone is still noticed.
    pub fn pause(&self) {
        let reading = self.shared.tty.reading();
        self.shared.paused.store(true, Ordering::Release);
        self.shared.signals.store(THEIRS, Ordering::Release);
        self.shared.stops.store(true, Ordering::Release);
        drop(reading);
        self.wake();
    }

    /// The terminal is ours again. What was half read before is forgotten. [`Incoming::Resized`]
    /// follows, whether or not the window changed meanwhile.
    pub fn resume(&self) {
        self.shared.stops.store(false, Ordering::Release);
        self.shared.signals.store(RETURNING, Ordering::Release);
        if raise(SIGWINCH).is_err() {
            self.shared.signals.store(OURS, Ordering::Release);
        }
        self.shared.paused.store(false, Ordering::Release);
        self.wake();
    }

    fn wake(&self) {
        // The pipe is full only of calls that it has not heard yet.
        let _ = (&self.shared.wake).write(&[0]);
    }
}

impl Drop for Listener {
    fn drop(&mut self) {
        let reading = self.shared.tty.reading();
        // Not both at once: each would stop the process.
        self.shared.stops.store(false, Ordering::Release);
        self.shared.closed.store(true, Ordering::Release);
        drop(reading);
        self.signals.close();
        self.wake();
        // Not joined: a thread may be waiting in `send` for the one that drops this.
    }
}

/// The input thread.
struct Input<S> {
    shared: Arc<Shared>,
    woken: PipeReader,
    send: S,
}

/// What a look at the terminal gave.
enum Look {
    Nothing,
    Bytes(usize),
    Gone,
}

impl<S: Fn(Incoming) -> bool> Input<S> {
    fn run(mut self) {
        let mut bytes = vec![0; READ_BYTES];
        let mut parser = Parser::default();
        let mut due = None;
        loop {
            let paused = self.shared.paused.load(Ordering::Acquire);
            if paused {
                parser = Parser::default();
                due = None;
            }
            let wanted = if paused { PollFlags::empty() } else { PollFlags::IN };
            let mut fds = [
                PollFd::from_borrowed_fd(self.shared.tty.input(), wanted),
                PollFd::new(&self.woken, PollFlags::IN),
            ];
            let ready = wait_any(&mut fds, due);
            let (on_tty, on_wake) = (fds[0].revents(), fds[1].revents());
            let mut events = Vec::new();
            match ready {
                Err(_) => return self.gone(),
                Ok(false) => {
                    parser.flush(&mut events);
                    due = None;
                }
                Ok(true) => {
                    if !on_wake.is_empty() && self.awake().is_err() {
                        return;
                    }
                    match self.look(on_tty, &mut bytes) {
                        Look::Nothing => {}
                        Look::Gone => return self.gone(),
                        Look::Bytes(count) => {
                            parser.feed(&bytes[..count], &mut events);
                            due = parser.timeout().map(|silence| Instant::now() + silence);
                        }
                    }
                }
            }
            if !events.is_empty() && !(self.send)(Incoming::Input(events)) {
                return;
            }
        }
    }

    /// Somebody changed the state; `Err` when the listener is gone.
    fn awake(&mut self) -> Result<(), ()> {
        let heard = self.woken.read(&mut [0; 64]);
        if self.shared.closed.load(Ordering::Acquire) || !heard.is_ok_and(|count| count > 0) {
            return Err(());
        }
        Ok(())
    }

    fn look(&self, ready: PollFlags, bytes: &mut [u8]) -> Look {
        if !ready.contains(PollFlags::IN) {
            let gone = ready.intersects(PollFlags::HUP | PollFlags::ERR | PollFlags::NVAL);
            return if gone { Look::Gone } else { Look::Nothing };
        }
        let _reading = self.shared.tty.reading();
        // Another may have read what we were told of, or taken the terminal.
        if self.shared.paused.load(Ordering::Acquire) || self.shared.closed.load(Ordering::Acquire) {
            return Look::Nothing;
        }
        match wait(self.shared.tty.input(), PollFlags::IN, Some(Instant::now())) {
            Ok(still) if still.contains(PollFlags::IN) => {}
            Ok(still) if still.is_empty() => return Look::Nothing,
            _ => return Look::Gone,
        }
        match rustix::io::read(self.shared.tty.input(), bytes) {
            Ok(0) => Look::Gone,
            Ok(count) => Look::Bytes(count),
            Err(Errno::INTR | Errno::AGAIN) => Look::Nothing,
            Err(_) => Look::Gone,
        }
    }

    fn gone(self) {
        (self.send)(Incoming::Hangup);
    }
}

/// The signal thread.
fn pass_signals(mut signals: Signals, shared: &Shared, send: impl Fn(Incoming) -> bool) {
    let handle = signals.handle();
    while !handle.is_closed() {
        let mut arrived: Vec<i32> = signals.wait().collect();
        let whose = shared.signals.load(Ordering::Acquire);
        if arrived.contains(&SIGCONT) {
            // A shell that ends a stopped job sends what ends it, then SIGCONT; they may come to be
            // seen the other way round. To take a terminal that is the shell's would stop us for good.
            std::thread::sleep(SIGNALS_MEANT_TOGETHER);
            arrived.extend(signals.pending());
            arrived.sort_by_key(|&signal| (signal == SIGCONT, signal));
            arrived.dedup();
        }
        if !arrived.into_iter().all(|signal| pass(signal, whose, shared, &send)) {
            return;
        }
    }
}

/// Whether to go on.
fn pass(signal: i32, whose: u8, shared: &Shared, send: &impl Fn(Incoming) -> bool) -> bool {
    let incoming = match signal {
        SIGWINCH if whose == THEIRS => return true,
        SIGWINCH => {
            // A pause that begins now stays one.
            let (order, otherwise) = (Ordering::AcqRel, Ordering::Acquire);
            let _ = shared.signals.compare_exchange(RETURNING, OURS, order, otherwise);
            Incoming::Resized
        }
        // Typed at the other program, which has done with it what it wanted. SIGTSTP has already
        // stopped us, and who has the terminal takes it again by itself.
        SIGINT | SIGQUIT | SIGTSTP | SIGCONT if whose != OURS => return true,
        SIGTSTP => Incoming::Suspend,
        SIGCONT => Incoming::Continued,
        _ => Incoming::Terminate(signal),
    };
    send(incoming)
}
