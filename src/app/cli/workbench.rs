//! `linden` and `linden open SOURCE`: the workbench.

use std::path::PathBuf;

use clap::Args;
use linden_terminal::Tty;
use linden_terminal::probe::Overrides;
use linden_terminal::tty::OpenError;

use super::{GrowArgs, complete};
use crate::config::log::Request;
use crate::exit::usage;
use crate::source;
use crate::system::{HANGUP, end_by};
use crate::tui::{End, StartOptions, run};

/// Open the workbench on a source; without one, linden opens it where it was left
#[derive(Args)]
pub struct Open {
    #[command(flatten)]
    growing: GrowArgs,

    #[command(flatten)]
    pub(super) terminal: TerminalArgs,
}

/// What the user says of the terminal.
#[derive(Args, Default, Clone)]
pub struct TerminalLook {
    /// How pictures are shown: auto, kitty, sixel, iterm2, quadrants, halves or braille
    #[arg(long, value_name = "HOW", add = complete::words(|| Overrides::graphics_words()))]
    graphics: Option<String>,

    /// How many colours there are: auto, truecolor, 256, 16 or none
    #[arg(long, value_name = "DEPTH", add = complete::words(|| Overrides::colors_words()))]
    colors: Option<String>,
}

/// How the workbench uses the terminal.
#[derive(Args, Default)]
pub struct TerminalArgs {
    #[command(flatten)]
    pub(super) look: TerminalLook,

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
        self.growing.without_defines("in the workbench edit the grammar itself")?;
        self.growing.without_edits("give the preset's document an [[edit]] and open that")?;
        self.growing.without_age("turn the knob age there")?;
        let set = self.growing.pairs()?;
        source::ensure_there(&self.growing.source)?;
        self.terminal.open(Some(self.growing.source), set)
    }
}

impl TerminalArgs {
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
        let end = run(tty, StartOptions { source, set, overrides, stats: self.stats });
        // Of an export that did not stop in time.
        linden_exporters::abandon();
        match end? {
            End::Quit => Ok(()),
            End::Signal(signal) => Ok(end_by(signal)?),
            End::Hangup => Ok(end_by(HANGUP)?),
        }
    }
}

/// The flags of the workbench that mean something to other commands, too, and those that do not: given
/// before a command, they go to it or are refused, but never dropped.
impl TerminalArgs {
    /// Takes what `before` says where this says nothing.
    pub fn fill(&mut self, before: &mut Self) {
        self.look.fill(&mut before.look);
        self.stats |= std::mem::take(&mut before.stats);
        let log = before.log.take();
        self.log = self.log.take().or(log);
    }

    /// The first flag that is given, and which commands have it.
    pub fn given(&self) -> Option<(&'static str, &'static str)> {
        const WITH_PICTURES: &str = "linden, linden open, linden preview and linden doctor";
        const WORKBENCH: &str = "linden and linden open";
        [
            (self.look.graphics.is_some(), "--graphics", WITH_PICTURES),
            (self.look.colors.is_some(), "--colors", WITH_PICTURES),
            (self.stats, "--stats", WORKBENCH),
            (self.log.is_some(), "--log", WORKBENCH),
        ]
        .into_iter()
        .find_map(|(is_given, flag, commands)| is_given.then_some((flag, commands)))
    }
}

impl TerminalLook {
    /// Takes what `before` says where this says nothing.
    pub fn fill(&mut self, before: &mut Self) {
        let Self { graphics, colors } = std::mem::take(before);
        self.graphics = self.graphics.take().or(graphics);
        self.colors = self.colors.take().or(colors);
    }

    /// The first flag that is given.
    pub fn given(&self) -> Option<&'static str> {
        let graphics = self.graphics.as_ref().map(|_| "--graphics");
        graphics.or(self.colors.as_ref().map(|_| "--colors"))
    }

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
