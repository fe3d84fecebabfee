//! Whose turn it is: jobs of the shell, and what is still on its way when the terminal is given back.

use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use rustix::event::PollFlags;
use rustix::process::{Signal, getpgid, getpgrp, getppid, getsid, kill_current_process_group};
use rustix::termios::{LocalModes, QueueSelector, tcflush, tcgetattr, tcgetpgrp};
use signal_hook::consts::{SIGCONT, SIGTSTP};

use super::tty::{Tty, wait};

/// Whether no other job has the terminal. One that does not control us has no jobs of ours.
pub(crate) fn is_ours(tty: &Tty) -> bool {
    tcgetpgrp(tty.output()).map_or(true, |foreground| foreground == getpgrp())
}

/// Whether writing would not stop us, as it does when another job has the terminal and wants it so.
pub(crate) fn may_be_written(tty: &Tty) -> bool {
    let stops = || tcgetattr(tty.input()).is_ok_and(|now| now.local_modes.contains(LocalModes::TOSTOP));
    is_ours(tty) || !stops()
}

/// Throws away what has come and was not read: it is not typed at the shell.
///
/// Taking raw mode back with TCSAFLUSH would do the same after all output has gone: on a line that stands
/// still that is never.
pub(crate) fn discard_input(tty: &Tty) {
    let _ = tcflush(tty.input(), QueueSelector::IFlush);
}

/// Reads what is still on its way: the terminal answers in order, so when it has said where the
/// cursor is it has said all. Asked for is what nothing else asks for.
pub(crate) fn drain(tty: &Tty, within: Duration) {
    let deadline = Instant::now() + within;
    let _reading = tty.reading();
    if tty.write_within(ASK_CURSOR, within).is_err() {
        return;
    }
    let mut tail = Vec::new();
    let mut bytes = [0; 4096];
    while wait(tty.input(), PollFlags::IN, Some(deadline)).is_ok_and(|ready| ready == PollFlags::IN) {
        match rustix::io::read(tty.input(), &mut bytes) {
            Ok(0) | Err(_) => return,
            Ok(count) => tail.extend_from_slice(&bytes[..count]),
        }
        if tells_cursor(&tail) {
            return;
        }
        // The answer is shorter than this, and may be cut in two.
        tail.drain(..tail.len().saturating_sub(16));
    }
}

/// Whether something could continue us once we stop: a shell with job control gives each job a group of
/// its own, so in the group of the session's leader there is none. The system ignores SIGTSTP there too
/// (POSIX, "orphaned process group").
pub(crate) fn stops() -> bool {
    getsid(None).map_or(true, |session| session != getpgrp())
}

/// Stops this process as SIGTSTP would; returns when it is continued.
pub(crate) fn stop() -> io::Result<()> {
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

/// DSR 6: where is the cursor?
const ASK_CURSOR: &[u8] = b"\x1b[6n";

/// Whether an answer to [`ASK_CURSOR`] is in it: `CSI row ; column R`.
fn tells_cursor(bytes: &[u8]) -> bool {
    let is_answer = |body: &[u8]| {
        let mut numbers = body.split(|byte| *byte == b';');
        let mut is_number =
            || numbers.next().is_some_and(|n| !n.is_empty() && n.iter().all(u8::is_ascii_digit));
        is_number() && is_number()
    };
    bytes.split(|byte| *byte == 0x1b).any(|sequence| {
        let body = sequence.strip_prefix(b"[");
        body.and_then(|body| Some(&body[..body.iter().position(|byte| *byte == b'R')?]))
            .is_some_and(is_answer)
    })
}
