//! Joins the model to the terminal and to the jobs.
//!
//! One thread owns the model. It sleeps until something happens: input, an answer of a job, a write
//! that is done, or a time that somebody asked for. All that has happened is taken in, then one frame
//! is painted: nothing is queued, the newest state is what is sent.

mod effects;
mod jobs;
mod probing;

use std::path::PathBuf;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::time::{Duration, Instant};

use anyhow::Context as _;
use linden_terminal::display::Display;
use linden_terminal::input::{Event, Reply};
use linden_terminal::listen::{Incoming, Listener, listen};
use linden_terminal::probe::{Capabilities, Overrides};
use linden_terminal::session::{Modes, Session, install_panic_hook};
use linden_terminal::tty::Tty;
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;

use self::jobs::{Desk, LoadRequest};
use self::probing::Probing;
use super::command;
use super::frame;
use super::model::{Config, Model};
use super::update::{Msg, update};
use crate::jobs::THREAD_PREFIX;

/// How a workbench begins.
pub struct Start {
    /// What to show first; what was on screen last time when `None`.
    pub source: Option<PathBuf>,
    /// Knobs to turn.
    pub set: Vec<(String, String)>,
    /// What the user says of the terminal.
    pub overrides: Overrides,
    /// Whether bytes and times are shown.
    pub stats: bool,
}

/// How a workbench ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// The user left.
    Quit,
    /// A signal asks the process to end; it has to be raised again.
    Signal(i32),
    /// The terminal is gone.
    Hangup,
}

/// What wakes the loop.
enum Happening {
    Incoming(Incoming),
    Written,
    Job(jobs::News),
    Msg(Box<Msg>),
}

/// The most happenings that are taken in before a frame is painted.
const MOST_AT_ONCE: usize = 256;

struct Runtime {
    model: Model,
    desk: Desk,
    display: Display,
    probing: Probing,
    session: Session,
    listener: Listener,
    tty: Tty,
    sender: Sender<Happening>,
    end: Option<End>,
    dirty: bool,
}
