//! Everything that the workbench knows.

use std::collections::VecDeque;
use std::time::{Duration, Instant};

use linden_terminal::input::Key;
use linden_terminal::probe::Capabilities;
use ratatui::layout::Rect;

use super::around::{Line, Page, Palette};
use super::command::Context;
use super::export::{ExportDialog, Exporting};
use super::growth::Playback;
use super::library::Library;
use super::picture::{self, PictureState};
use super::shape::{Form, GrammarEditor};
use super::tree::{Changes, Place, Tree};
use super::vary::Gallery;
use super::wind::{self, Breeze};
use crate::config::Complaint;
use crate::config::dirs::Dirs;
use crate::config::keymap::Keymap;
use crate::config::settings::Settings;
use crate::config::theme::Theme;

/// A message of no weight leaves the footer after this.
const MESSAGE_STAYS: Duration = Duration::from_secs(4);
/// How long nothing must happen before pictures are drawn in full.
pub const QUIET: Duration = Duration::from_millis(140);
/// Messages that are kept for the page of messages.
const MOST_MESSAGES: usize = 200;

/// The state of the workbench.
pub struct Model {
    /// Columns and rows.
    pub size: (u16, u16),
    /// The time of the last message, given from outside.
    pub now: Instant,
    /// When something was last done by hand.
    pub last_input: Instant,
    /// The pane that keys go to.
    pub focus: Pane,
    /// The last focused pane but the picture: what is beside it where there is room for two.
    pub side: Pane,
    /// The list of presets.
    pub library: Library,
    /// What is being read.
    pub loading: Option<Place>,
    /// What is to be changed of it then.
    pub changes: Option<(Place, Changes)>,
    /// The tree on screen.
    pub tree: Option<Tree>,
    /// How it is looked at.
    pub picture: PictureState,
    /// Growth, played.
    pub growth: Playback,
    /// The wind in the picture.
    pub wind: Breeze,
    /// The form of knobs.
    pub form: Form,
    /// Dialogs, the topmost last.
    pub layers: Vec<Layer>,
    /// What the footer says.
    pub message: Option<Message>,
    /// What was said.
    pub messages: VecDeque<Message>,
    /// The export under way, and what the dialog offers next time.
    pub exporting: Exporting,
    /// What the user configured.
    pub config: Config,
    /// What the terminal can do, as far as it is known.
    pub terminal: Capabilities,
    /// What lies where on the screen, from the last frame; the topmost last.
    pub regions: Vec<(Rect, Target)>,
    /// Bytes and milliseconds for `--stats`, when asked for.
    pub stats: Option<String>,
}

/// What the user configured, and what was wrong with it.
pub struct Config {
    /// Where it lies.
    pub dirs: Dirs,
    /// Colours.
    pub theme: Theme,
    /// Keys.
    pub keymap: Keymap,
    /// The rest.
    pub settings: Settings,
    /// What could not be read.
    pub complaints: Vec<Complaint>,
}

/// One of the three panes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Pane {
    /// The list.
    Presets,
    /// The tree.
    Picture,
    /// The knobs.
    Shape,
}

impl Pane {
    /// From left to right.
    pub const ALL: [Self; 3] = [Self::Presets, Self::Picture, Self::Shape];

    /// What its border says.
    pub const fn title(self) -> &'static str {
        match self {
            Self::Presets => "Presets",
            Self::Picture => "Picture",
            Self::Shape => "Shape",
        }
    }

    /// Where its keys are.
    pub const fn context(self) -> Context {
        match self {
            Self::Presets => Context::Presets,
            Self::Picture => Context::Picture,
            Self::Shape => Context::Shape,
        }
    }
}

/// A dialog above the panes.
pub enum Layer {
    /// A page of text: help, messages.
    Page(Page),
    /// The palette of commands.
    Palette(Palette),
    /// A line that is being typed, wherever its purpose shows it.
    Line(Line),
    /// A grid of pictures.
    Gallery(Box<Gallery>),
    /// What to export.
    Export(Box<ExportDialog>),
    /// The grammar as text.
    Grammar(Box<GrammarEditor>),
}

impl Layer {
    /// Where its keys are.
    pub const fn context(&self) -> Context {
        match self {
            Self::Page(_) => Context::Page,
            Self::Palette(_) | Self::Line(_) => Context::Prompt,
            Self::Gallery(_) => Context::Gallery,
            Self::Export(dialog) => dialog.context(),
            Self::Grammar(_) => Context::Grammar,
        }
    }
}

/// Something on the screen that the mouse can mean.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Target {
    /// A pane as a whole.
    Pane(Pane),
    /// A row of the list of presets, by its place in what is listed.
    Preset(usize),
    /// A row of the form.
    Knob(usize),
    /// A step of growth, in the bar to scrub.
    Growth(u32),
    /// A picture of the gallery.
    Thumbnail(usize),
    /// A row of the export dialog.
    ExportRow(usize),
    /// The text of the grammar's editor.
    Grammar,
    /// A row of the palette.
    PaletteRow(usize),
    /// A command, by its id: a hint of the footer.
    Command(&'static str),
    /// A dialog as a whole: what lies below it is not meant.
    Dialog,
}

/// How much a message matters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Weight {
    /// It happened.
    Note,
    /// It did not happen, and why.
    Warning,
    /// It failed.
    Error,
}

/// A line for the user, printable.
#[derive(Clone, Debug, PartialEq)]
pub struct Message {
    /// How much it matters.
    pub weight: Weight,
    /// What is said.
    pub text: String,
    /// When it leaves the footer.
    pub until: Instant,
}

impl Model {
    /// The workbench at its start: nothing chosen yet.
    pub fn new(config: Config, terminal: Capabilities, size: (u16, u16), now: Instant) -> Self {
        Self {
            size,
            now,
            last_input: now,
            focus: Pane::Presets,
            side: Pane::Presets,
            library: Library::builtin(),
            loading: None,
            changes: None,
            tree: None,
            picture: PictureState::default(),
            growth: Playback::default(),
            wind: Breeze::default(),
            form: Form::default(),
            layers: Vec::new(),
            message: None,
            messages: VecDeque::new(),
            exporting: Exporting::default(),
            config,
            terminal,
            regions: Vec::new(),
            stats: None,
        }
    }

    /// Gives a pane the keys.
    pub fn focus_on(&mut self, pane: Pane) {
        self.focus = pane;
        if pane != Pane::Picture {
            self.side = pane;
        }
    }

    /// Where keys are listened to: the topmost dialog, or the focused pane.
    pub fn context(&self) -> Context {
        self.layers.last().map_or(self.focus.context(), Layer::context)
    }

    /// The command that a key means here.
    pub fn command_of(&self, key: Key) -> Option<&'static str> {
        let keymap = &self.config.keymap;
        let here = self.context();
        let outer =
            if self.layers.is_empty() { &[Context::Global, Context::Always][..] } else { &[Context::Always] };
        keymap
            .lookup(here.id(), key)
            .or_else(|| outer.iter().find_map(|context| keymap.lookup(context.id(), key)))
    }

    /// Something happened.
    pub fn say(&mut self, text: impl Into<String>) {
        self.push(Weight::Note, &text.into());
    }

    /// Something did not happen.
    pub fn say_warning(&mut self, text: impl Into<String>) {
        self.push(Weight::Warning, &text.into());
    }

    /// Something failed.
    pub fn say_error(&mut self, text: impl Into<String>) {
        self.push(Weight::Error, &text.into());
    }

    /// What was wrong with what the user configured. The last one is on screen, all are on the page
    /// of messages.
    pub fn say_complaints(&mut self) {
        for complaint in std::mem::take(&mut self.config.complaints) {
            self.say_error(complaint.to_string());
        }
    }

    fn push(&mut self, weight: Weight, text: &str) {
        let text = linden::knob::printable(text);
        let stays = if weight == Weight::Note { MESSAGE_STAYS } else { 2 * MESSAGE_STAYS };
        let message = Message { weight, text, until: self.now + stays };
        tracing::debug!(?weight, text = message.text, "message");
        self.messages.push_back(message.clone());
        if self.messages.len() > MOST_MESSAGES {
            self.messages.pop_front();
        }
        self.message = Some(message);
    }

    /// When something changes by itself next: an animation's frame, a message that leaves, the full
    /// picture after the draft. `None`: nothing does, and the program sleeps.
    pub fn wake_at(&self) -> Option<Instant> {
        let message = self.message.as_ref().map(|message| message.until);
        let quiet = self.picture.waits_for_quiet(self).then(|| self.last_input + QUIET);
        let frames = [picture::next_frame(self), self.growth.next_frame(), wind::next_frame(self)];
        [message, quiet].into_iter().chain(frames).flatten().min()
    }
}
