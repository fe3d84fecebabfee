//! What a command is, and where its keys are listened to.
//!
//! Each room of the workbench has its rows in the file that knows what they do; the table of all of them
//! is [`commands`](super::commands).

use super::effect::Effects;

/// Where a command's keys are listened to: a section of keymaps and of help.
///
/// A dialog with keys of its kind names its context in its file; help finds it through the commands.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Context {
    /// Its place in help, the smaller the earlier.
    place: u8,
    id: &'static str,
    title: &'static str,
    /// Whether letters are text there.
    is_typed: bool,
}

impl Context {
    /// Everywhere but in dialogs.
    pub const GLOBAL: Self = Self::new(0, "global", "Anywhere");
    /// The list of presets.
    pub const PRESETS: Self = Self::new(10, "presets", "In the list of presets");
    /// The picture.
    pub const PICTURE: Self = Self::new(20, "picture", "In the picture");
    /// The form of knobs.
    pub const SHAPE: Self = Self::new(30, "shape", "In the knobs");
    /// Everywhere, above dialogs too.
    pub const ALWAYS: Self = Self::new(u8::MAX, "always", "Always");

    /// A context, `place` being where help has it between the others.
    pub const fn new(place: u8, id: &'static str, title: &'static str) -> Self {
        Self { place, id, title, is_typed: false }
    }

    /// The same where letters are text, and no key of a letter means a command of elsewhere.
    pub const fn typed(self) -> Self {
        Self { is_typed: true, ..self }
    }

    /// What keymaps call it.
    pub const fn id(self) -> &'static str {
        self.id
    }

    /// What help calls it.
    pub const fn title(self) -> &'static str {
        self.title
    }

    /// Whether letters are text there.
    pub const fn is_typed(self) -> bool {
        self.is_typed
    }

    /// Whether its keys are listened to only while no dialog is open.
    pub fn is_below_dialogs(self) -> bool {
        [Self::GLOBAL, Self::PRESETS, Self::PICTURE, Self::SHAPE].contains(&self)
    }
}

/// One row of the table, for a model `M`.
pub struct Command<M> {
    /// What keymaps call it: `undo`.
    pub id: &'static str,
    /// Where its keys are listened to.
    pub context: Context,
    /// Its keys when no keymap says otherwise, as [`linden_terminal::input::Shortcut`] reads them.
    pub keys: &'static [&'static str],
    /// Two or three words: what the footer and the palette call it.
    pub title: &'static str,
    /// One line: what it does.
    pub help: &'static str,
    /// Whether the footer offers it; the smaller the earlier. `None`: only help and the palette.
    pub hint: Option<u8>,
    /// Why it cannot be used now, if it cannot.
    pub hindrance: fn(&M) -> Option<String>,
    /// Does it.
    pub run: fn(&mut M, &mut Effects),
}
