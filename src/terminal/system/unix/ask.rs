//! Asking a terminal and waiting for what it says: for programs that want to know and nothing else.

use std::io;
use std::time::{Duration, Instant};

use rustix::event::PollFlags;
use rustix::io::{Errno, retry_on_intr};
use rustix::termios::{OptionalActions, QueueSelector, Termios, tcflush, tcgetattr, tcsetattr};

use super::tty::{Tty, wait};
use crate::input::{Parser, Said};
use crate::probe::{Environment, Findings, queries};

/// Sends the [`queries`] and collects replies until the last has come or the time is over; then
/// [`Findings::is_complete`] tells which. The terminal's screen stays as it is. Keys that are pressed
/// meanwhile are lost. There must be no [`crate::Session`] and no [`crate::Listener`].
///
/// # Errors
/// What the system says when it refuses raw mode, reading or writing.
pub fn ask(tty: &Tty, environment: &Environment, within: Duration) -> io::Result<Findings> {
    let mut findings = Findings::default();
    findings.take_window(tty.size());
    let bytes = queries(environment);
    if bytes.is_empty() {
        findings.ask_nothing();
        return Ok(findings);
    }
    let deadline = Instant::now() + within;
    let _reading = tty.reading();
    let _raw = Raw::enter(tty)?;
    tty.write_within(&bytes, within)?;
    let mut parser = Parser::default();
    let mut events = Vec::new();
    let mut read = [0; 4096];
    while !findings.is_complete() {
        let ready = wait(tty.input(), PollFlags::IN, Some(deadline))?;
        if !ready.contains(PollFlags::IN) {
            break;
        }
        match rustix::io::read(tty.input(), &mut read) {
            Ok(0) => break,
            Ok(count) => parser.feed(&read[..count], &mut events),
            Err(Errno::INTR | Errno::AGAIN) => {}
            Err(error) => return Err(error.into()),
        }
        for event in events.drain(..) {
            if let Said::Reply(reply) = event {
                findings.take(&reply);
            }
        }
    }
    findings.give_up();
    Ok(findings)
}

/// Raw mode, until dropped.
struct Raw<'t> {
    tty: &'t Tty,
    cooked: Termios,
}

impl<'t> Raw<'t> {
    fn enter(tty: &'t Tty) -> io::Result<Self> {
        let cooked = tcgetattr(tty.input())?;
        let mut raw = cooked.clone();
        raw.make_raw();
        let entered = Self { tty, cooked };
        retry_on_intr(|| tcsetattr(tty.input(), OptionalActions::Now, &raw))?;
        Ok(entered)
    }
}

impl Drop for Raw<'_> {
    fn drop(&mut self) {
        // What came too late is not typed at the shell.
        let _ = tcflush(self.tty.input(), QueueSelector::IFlush);
        let _ = retry_on_intr(|| tcsetattr(self.tty.input(), OptionalActions::Now, &self.cooked));
    }
}
