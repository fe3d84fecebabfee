//! `linden` and `linden open SOURCE`: the workbench.

use std::path::PathBuf;

use clap::Args;
use linden_terminal::Tty;
use linden_terminal::probe::Overrides;
use linden_terminal::tty::OpenError;

use super::Growing;
use crate::config::log::Request;
use crate::exit::usage;
use crate::source;
use crate::tui::{End, Start, run};

/// Open the workbench on a source; without one, linden opens it where it was left
#[derive(Args)]
pub struct Open {
    #[command(flatten)]
    growing: Growing,

    #[command(flatten)]
    terminal: Terminal,
}

/// What the user says of the terminal.
#[derive(Args, Default)]
pub struct Look {
    /// How pictures are shown: auto, kitty, sixel, iterm2, quadrants, halves or braille
    #[arg(long, value_name = "HOW")]
    graphics: Option<String>,

    /// How many colours there are: auto, truecolor, 256, 16 or none
    #[arg(long, value_name = "DEPTH")]
    colors: Option<String>,
}

/// How the workbench uses the terminal.
#[derive(Args, Default)]
pub struct Terminal {
    #[command(flatten)]
    look: Look,

    /// Show bytes and times, and sum them up at the end
    #[arg(long)]
    stats: bool,

    #[arg(
        long,
        value_name = "FILE",
        help = "Write what happens into a file (LINDEN_LOG_LEVEL: error, warn, info, debug, trace)"
    )]
    log: Option<PathBuf>,
}

impl Open {
    pub fn run(self) -> anyhow::Result<()> {
        let set = self.growing.pairs()?;
        source::ensure_there(&self.growing.source)?;
        self.terminal.open(Some(self.growing.source), set)
    }
}

impl Terminal {
    /// Opens the workbench and stays until it is left.
    pub fn open(self, source: Option<PathBuf>, set: Vec<(String, String)>) -> anyhow::Result<()> {
        let (request, complaints) = Request::new(self.log.clone(), |name| std::env::var_os(name));
        for complaint in complaints {
            crate::exit::say(&format!("note: {complaint}"));
        }
        if let Some(request) = request {
            request.start().map_err(|complaint| anyhow::anyhow!("{complaint}"))?;
        }
        let tty = Tty::open().map_err(|error| match error {
            OpenError::NotATerminal(stream) => usage(format!(
                "the workbench needs a terminal, and {stream} is none. Without one, try:\n  \
                 linden list\n  linden preview fir -o fir.png\n  linden export fir -o fir.glb"
            )),
            OpenError::Descriptor { .. } => error.into(),
        })?;
        let overrides = self.look.overrides()?;
        let end = run(tty, Start { source, set, overrides, stats: self.stats });
        // Of an export that did not stop in time.
        linden_exporters::abandon();
        match end? {
            End::Quit => Ok(()),
            End::Signal(signal) => raise(signal),
            End::Hangup => raise(signal_hook::consts::SIGHUP),
        }
    }
}

impl Look {
    /// What the flags say of the terminal.
    pub fn overrides(&self) -> anyhow::Result<Overrides> {
        let mut overrides = Overrides::default();
        if let Some(value) = &self.graphics {
            overrides.set_graphics(value, "--graphics").map_err(usage)?;
        }
        if let Some(value) = &self.colors {
            overrides.set_colors(value, "--colors").map_err(usage)?;
        }
        Ok(overrides)
    }
}

/// Ends as the signal would have ended us: whoever waits for us sees which it was.
fn raise(signal: i32) -> anyhow::Result<()> {
    signal_hook::low_level::emulate_default_handler(signal)?;
    // Not reached for signals that end a process.
    Ok(())
}
