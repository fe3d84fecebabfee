//! Asks the terminal what it can do, after the first frame.

use std::time::{Duration, Instant};

use linden_terminal::input::Reply;
use linden_terminal::probe::{Environment, Findings, Overrides, queries};
use linden_terminal::{Capabilities, Display, Session, WindowSize};

/// How long replies are waited for before the terminal counts as mute. Later ones still count.
const PATIENCE: Duration = Duration::from_millis(1500);

/// What was asked and what was answered.
pub struct Probing {
    environment: Environment,
    findings: Findings,
    /// What the command line says.
    flags: Overrides,
    /// That, and what environment and settings say.
    overrides: Overrides,
    until: Option<Instant>,
}

impl Probing {
    /// Nothing is known yet but the environment, and what the command line says.
    pub fn new(flags: Overrides) -> Self {
        Self {
            environment: Environment::of_process(),
            findings: Findings::default(),
            overrides: flags.clone(),
            flags,
            until: None,
        }
    }

    /// Takes what environment and settings say, in place of what they said before. The command line
    /// comes first.
    pub fn take_overrides(&mut self, overrides: Overrides) {
        self.overrides = self.flags.clone().or(overrides);
    }

    /// What follows from all that is known.
    pub fn conclude(&self) -> Capabilities {
        Capabilities::conclude(&self.findings, &self.environment, &self.overrides)
    }

    /// The environment.
    pub fn environment(&self) -> &Environment {
        &self.environment
    }

    /// What the system knows of the window.
    pub fn take_window(&mut self, size: WindowSize) {
        self.findings.take_window(size);
    }

    /// Sends the queries.
    pub fn begin(&mut self, display: &mut Display, session: &Session, now: Instant) {
        let bytes = queries(&self.environment);
        if bytes.is_empty() {
            self.findings.give_up();
            return;
        }
        // The first frame is on its way: the queries go behind it.
        display.beside(&bytes, now);
        session.expect_replies(Some(Duration::from_millis(300)));
        self.until = Some(now + PATIENCE);
    }

    /// Takes a reply; whether the terminal has to be judged anew.
    pub fn take(&mut self, reply: &Reply, session: &Session) -> bool {
        let is_new = self.findings.take(reply);
        if self.findings.is_complete() && self.until.take().is_some() {
            session.expect_replies(None);
        }
        is_new
    }

    /// When to give up.
    pub fn wake_at(&self) -> Option<Instant> {
        self.until
    }

    /// Gives up when it is time; whether the terminal has to be judged anew.
    pub fn expire(&mut self, session: &Session, now: Instant) -> bool {
        if self.until.is_none_or(|until| now < until) {
            return false;
        }
        self.until = None;
        self.findings.give_up();
        session.expect_replies(None);
        true
    }
}
