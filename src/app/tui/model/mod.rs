//! The state of the workbench, all of it.
//!
//! A room's state is a file here, without a terminal, a clock or a thread; what changes it and what paints
//! it is the room's folder.

mod entry;
mod exporting;
mod filter;
mod form;
mod growth;
mod library;
mod message;
mod picture;
mod wind;

use std::collections::VecDeque;
use std::time::{Duration, Instant};

use crossterm::event::{KeyCode, KeyEvent, KeyModifiers};
use linden_terminal::input::Shortcut;
use linden_terminal::probe::{Capabilities, Graphics};
use ratatui::layout::Rect;

pub use entry::{GroupHeading, ID_COLUMNS, ListRow, PresetEntry};
pub use exporting::{ExportReport, Exporting, KeptExport, NamedFiles, RunningExport};
pub use filter::{has_tags, split_tags};
pub use form::{Form, FormSpot};
pub use growth::Playback;
pub use library::{FORESTS, Library, Removed};
use message::reading_time;
pub use message::{Message, Weight};
pub use picture::PictureState;
pub use wind::Breeze;

use super::command::{self, Context};
use super::dialog::{After, Dialog, Dialogs};
use super::effect::Effects;
use super::forest::ForestOnScreen;
use super::layout::{Layout, Pane, Target};
use super::tree::{Changes, Tree, TreePlace};
use crate::config::Complaint;
use crate::config::dirs::Dirs;
use crate::config::keymap::Keymap;
use crate::config::settings::Settings;
use crate::config::theme::Theme;
use crate::jobs::Measured;

/// Columns that a dialog of text has where it leaves a picture of characters in sight: lines of help are whole in them.
const BESIDE_PICTURE: u16 = 62;

/// The command that is within reach in dialogs too.
pub const HELP: &str = "help";

/// A message of no weight leaves the footer after this, when nothing is done before.
const MESSAGE_STAYS: Duration = Duration::from_secs(4);
/// How long nothing must happen before pictures are drawn in full.
pub const QUIET: Duration = Duration::from_millis(140);
/// Messages that are kept for the page of messages.
const MOST_MESSAGES: usize = 200;

/// A row of the table of commands.
pub type Command = command::Command<Model>;

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
    /// The last focused pane but the picture: the second one where there is room for two.
    pub side: Pane,
    /// The list of presets.
    pub library: Library,
    /// What is being read.
    pub loading: Option<TreePlace>,
    /// Changes to make as soon as it is read.
    pub changes: Option<(TreePlace, Changes)>,
    /// The tree on screen.
    pub tree: Option<Tree>,
    /// The forest on screen, where that is no tree.
    pub forest: Option<ForestOnScreen>,
    /// How it is looked at.
    pub picture: PictureState,
    /// Growth, played.
    pub growth: Playback,
    /// The wind in the picture.
    pub wind: Breeze,
    /// The form of knobs.
    pub form: Form,
    /// The open dialogs.
    pub dialogs: Dialogs<Self>,
    /// What the footer says.
    pub message: Option<Message>,
    /// What was said.
    pub messages: VecDeque<Message>,
    /// The export under way, and what the dialog offers next time.
    pub exporting: Exporting,
    /// The numbers of the tree that was measured last.
    pub measured: Option<Measured>,
    /// What the user configured.
    pub config: Config,
    /// What the terminal can do, as far as it is known.
    pub terminal: Capabilities,
    /// What lies where on the screen, from the last frame; the topmost last.
    pub regions: Vec<(Rect, Target)>,
    /// Bytes and milliseconds for `--stats`, when asked for.
    pub stats: Option<String>,
    /// The table of commands, room by room.
    commands: &'static [&'static [Command]],
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

impl Model {
    /// The workbench at its start: nothing chosen yet.
    pub fn new(
        commands: &'static [&'static [Command]],
        config: Config,
        terminal: Capabilities,
        size: (u16, u16),
        now: Instant,
    ) -> Self {
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
            forest: None,
            picture: PictureState::default(),
            growth: Playback::default(),
            wind: Breeze::default(),
            form: Form::default(),
            dialogs: Dialogs::default(),
            message: None,
            messages: VecDeque::new(),
            exporting: Exporting::default(),
            measured: None,
            config,
            terminal,
            regions: Vec::new(),
            stats: None,
            commands,
        }
    }

    /// Gives a pane the keys.
    pub fn focus_on(&mut self, pane: Pane) {
        self.focus = pane;
        if pane != Pane::Picture {
            self.side = pane;
        }
    }

    /// Where the panes are.
    pub fn layout(&self) -> Layout {
        Layout::new(self.size.0, self.size.1, self.focus, self.side, self.library.columns())
    }

    /// Where dialogs may lie: above the footer, which has their hints.
    pub fn dialog_body(&self) -> Rect {
        Rect::new(0, 0, self.size.0, self.size.1 - self.layout().footer.height)
    }

    /// Where dialogs of text lie. A picture of characters costs a slow line kilobytes when a dialog that covered it
    /// goes: there they lie over the list or the form, whichever is wider, and over as little of the picture as their
    /// text allows.
    pub fn popup_body(&self) -> Rect {
        let body = self.dialog_body();
        if !self.terminal.remote.value || self.terminal.graphics.value != Graphics::Cells {
            return body;
        }
        let layout = self.layout();
        // In one column there is nothing beside the picture.
        if layout.headings[Pane::Picture as usize].is_empty() {
            return body;
        }
        let beside = [Pane::Shape, Pane::Presets].into_iter().map(|pane| layout.panes[pane as usize]);
        let Some(side) = beside.max_by_key(|area| area.width) else { return body };
        let width = side.width.max(BESIDE_PICTURE).min(body.width);
        // To the edge of the screen that the pane is at.
        let x = if side.right() == body.right() { body.right() - width } else { side.x };
        Rect { x, width, ..side }
    }

    /// Where keys are listened to: the topmost dialog, or the focused pane.
    pub fn context(&self) -> Context {
        self.dialogs.last().map_or(self.focus.context(), Dialog::context)
    }

    /// All commands, room by room.
    pub fn commands(&self) -> impl Iterator<Item = &'static Command> + use<> {
        self.commands.iter().copied().flatten()
    }

    /// The command that keymaps call `id`.
    pub fn command(&self, id: &str) -> Option<&'static Command> {
        self.commands().find(|command| command.id == id)
    }

    /// The command that a key means here.
    pub fn command_of(&self, key: Shortcut) -> Option<&'static str> {
        let keymap = &self.config.keymap;
        let here = self.context();
        let outer = if self.dialogs.is_empty() {
            &[Context::GLOBAL, Context::ALWAYS][..]
        } else {
            &[Context::ALWAYS]
        };
        keymap
            .lookup(here.id(), key)
            .or_else(|| outer.iter().find_map(|context| keymap.lookup(context.id(), key)))
            .or_else(|| {
                keymap.lookup(Context::GLOBAL.id(), key).filter(|id| *id == HELP && !is_text(here, key))
            })
    }

    /// Runs a command, or says why it cannot be used.
    pub fn run(&mut self, command: &Command, effects: &mut Effects) {
        match (command.hindrance)(self) {
            None => (command.run)(self, effects),
            Some(why) => self.say_warning(format!("{}: {why}", command.title)),
        }
    }

    /// Tells the topmost dialog something. It is off the stack meanwhile, and then back in its place or
    /// closed; `None` when no dialog is open.
    pub fn tell(&mut self, tell: impl FnOnce(&mut dyn Dialog<Self>, &mut Self) -> After) -> Option<After> {
        let (place, mut dialog) = self.dialogs.take()?;
        let after = tell(&mut *dialog, self);
        if after == After::Stays {
            self.dialogs.put_back(place, dialog);
        }
        Some(after)
    }

    /// The same with a dialog of a type; nothing when the topmost one is of another.
    pub fn with<T: Dialog<Self>>(&mut self, act: impl FnOnce(&mut T, &mut Self) -> After) -> Option<After> {
        self.dialogs.top::<T>()?;
        self.tell(|dialog, model| {
            let dialog: &mut dyn std::any::Any = dialog;
            dialog.downcast_mut().map_or(After::Stays, |dialog| act(dialog, model))
        })
    }

    /// Gives the topmost dialog up.
    pub fn cancel(&mut self, effects: &mut Effects) {
        self.tell(|dialog, model| {
            dialog.cancel(model, effects);
            After::Closes
        });
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

    /// Something failed, and is on screen elsewhere: for the page of messages alone.
    pub fn keep_error(&mut self, text: &str) {
        let said = self.message.take();
        self.push(Weight::Error, text);
        self.message = said;
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
        let reading = reading_time(&text);
        // Who has pressed a key sees at once what it did; of what went wrong, and of news, nobody knew.
        let is_answer = weight == Weight::Note && self.last_input == self.now;
        let read_by = if is_answer { self.now } else { self.now + reading };
        let message = Message { weight, text, until: self.now + stays.max(reading), read_by };
        tracing::debug!(?weight, text = message.text, "message");
        // What is said again while it still stands is said once.
        let stands =
            |said: &Message| said.weight == weight && said.text == message.text && said.until > self.now;
        if self.messages.iter().rev().any(stands) {
            self.message = Some(message);
            return;
        }
        self.messages.push_back(message.clone());
        if self.messages.len() > MOST_MESSAGES {
            self.messages.pop_front();
        }
        self.message = Some(message);
    }
}

impl Model {
    /// Ends the comparison with the document: what is written, saved or copied is the tree with its changes, and that
    /// is to be on screen. Whether there was one.
    pub fn end_comparison(&mut self) -> bool {
        self.tree.as_mut().is_some_and(|tree| std::mem::take(&mut tree.compares))
    }

    /// Where what is on screen comes from.
    pub fn place(&self) -> Option<&TreePlace> {
        let forest = self.forest.as_ref().map(|forest| &forest.place);
        self.tree.as_ref().map(|tree| &tree.place).or(forest)
    }
}

/// Whether a key is text at a place.
fn is_text(here: Context, key: Shortcut) -> bool {
    let key = KeyEvent::from(key);
    let held = key.modifiers - KeyModifiers::SHIFT;
    here.is_typed() && matches!(key.code, KeyCode::Char(_)) && held.is_empty()
}

/// For commands that can always be used.
pub const fn free(_: &Model) -> Option<String> {
    None
}

/// For commands that need a preset.
pub fn without_preset(model: &Model) -> Option<String> {
    match (&model.tree, &model.forest) {
        (Some(_), _) => None,
        (None, Some(_)) => Some("this is for one tree, and a forest is on screen".to_owned()),
        (None, None) => Some("no preset is chosen".to_owned()),
    }
}

/// For commands that need a tree on screen.
pub fn without_tree(model: &Model) -> Option<String> {
    let shown = model.tree.as_ref().and_then(|tree| tree.shown.as_ref());
    let why = || without_preset(model).unwrap_or_else(|| "no tree has grown yet".to_owned());
    shown.is_none().then(why)
}

/// For commands that need a form: a tree, or a forest.
pub fn without_form(model: &Model) -> Option<String> {
    if model.forest.is_some() { None } else { without_preset(model) }
}

/// For commands that need something grown on screen.
pub fn without_picture(model: &Model) -> Option<String> {
    let has_forest = model.forest.as_ref().is_some_and(|forest| forest.shown.is_some());
    if has_forest { None } else { without_tree(model) }
}
