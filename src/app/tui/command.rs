//! The one table of commands. Keys, footer hints, `?` help, the `:` palette and the table of keys in
//! `docs/workbench.md` are made from it; a command that cannot be used says why.
//!
//! Each room of the workbench has its own rows beside the code that they run; [`all`] puts the rooms
//! in the order that help has them. A new command is one row.

use super::effect::Effects;
use super::model::Model;
use super::{around, export, growth, library, picture, shape, vary, wind};

/// Where a command's keys are listened to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Context {
    /// Everywhere, above dialogs too.
    Always,
    /// Everywhere but in dialogs.
    Global,
    /// The list of presets.
    Presets,
    /// The picture.
    Picture,
    /// The form of knobs.
    Shape,
    /// The gallery.
    Gallery,
    /// The export dialog.
    Export,
    /// A line of the export dialog that is being typed.
    ExportLine,
    /// The grammar's editor.
    Grammar,
    /// Pages of text: help, messages.
    Page,
    /// The palette, and lines that are typed.
    Prompt,
}

impl Context {
    /// All, in the order of help.
    pub const ALL: [Self; 11] = [
        Self::Global,
        Self::Presets,
        Self::Picture,
        Self::Shape,
        Self::Gallery,
        Self::Export,
        Self::ExportLine,
        Self::Grammar,
        Self::Page,
        Self::Prompt,
        Self::Always,
    ];

    /// What keymaps call it.
    pub const fn id(self) -> &'static str {
        match self {
            Self::Always => "always",
            Self::Global => "global",
            Self::Presets => "presets",
            Self::Picture => "picture",
            Self::Shape => "shape",
            Self::Gallery => "gallery",
            Self::Export => "export",
            Self::ExportLine => "export-line",
            Self::Grammar => "grammar",
            Self::Page => "page",
            Self::Prompt => "prompt",
        }
    }

    /// What help calls it.
    pub const fn title(self) -> &'static str {
        match self {
            Self::Always => "Always",
            Self::Global => "Anywhere",
            Self::Presets => "In the list of presets",
            Self::Picture => "In the picture",
            Self::Shape => "In the knobs",
            Self::Gallery => "In the gallery",
            Self::Export => "While exporting",
            Self::ExportLine => "While typing where to export to",
            Self::Grammar => "In the grammar",
            Self::Page => "In a page of text",
            Self::Prompt => "While typing a line",
        }
    }
}

/// One row of the table.
pub struct Command {
    /// What keymaps call it: `undo`.
    pub id: &'static str,
    /// Where its keys are listened to.
    pub context: Context,
    /// Its keys when no keymap says otherwise, as [`linden_terminal::input::Key`] reads them.
    pub keys: &'static [&'static str],
    /// Two or three words: what the footer and the palette call it.
    pub title: &'static str,
    /// One line: what it does.
    pub help: &'static str,
    /// Whether the footer offers it; the smaller the earlier. `None`: only help and the palette.
    pub hint: Option<u8>,
    /// Why it cannot be used now, if it cannot.
    pub hindrance: fn(&Model) -> Option<String>,
    /// Does it.
    pub run: fn(&mut Model, &mut Effects),
}

/// For commands that can always be used.
pub const fn free(_: &Model) -> Option<String> {
    None
}

/// For commands that need a preset.
pub fn without_preset(model: &Model) -> Option<String> {
    model.tree.is_none().then(|| "no preset is chosen".to_owned())
}

/// For commands that need a tree on screen.
pub fn without_tree(model: &Model) -> Option<String> {
    let shown = model.tree.as_ref().and_then(|tree| tree.shown.as_ref());
    shown.is_none().then(|| "no tree has grown yet".to_owned())
}

/// All commands, room by room.
pub fn all() -> impl Iterator<Item = &'static Command> {
    [
        around::COMMANDS,
        library::COMMANDS,
        picture::COMMANDS,
        growth::COMMANDS,
        wind::COMMANDS,
        shape::COMMANDS,
        vary::COMMANDS,
        export::COMMANDS,
    ]
    .into_iter()
    .flatten()
}

/// The command that keymaps call `id`.
pub fn find(id: &str) -> Option<&'static Command> {
    all().find(|command| command.id == id)
}

/// The table as keymaps are read against.
pub fn key_table() -> Vec<crate::config::keymap::Row> {
    all().map(|command| (command.id, command.context.id(), command.keys)).collect()
}

/// Runs a command, or says why it cannot be used.
pub fn run(command: &Command, model: &mut Model, effects: &mut Effects) {
    match (command.hindrance)(model) {
        None => (command.run)(model, effects),
        Some(why) => model.say_warning(format!("{}: {why}", command.title)),
    }
}

#[cfg(test)]
mod tests {
    use linden_terminal::input::Key;

    use super::*;

    #[test]
    fn ids_are_unique_and_rows_are_whole() {
        let mut ids: Vec<_> = all().map(|c| c.id).collect();
        for command in all() {
            assert!(command.id.bytes().all(|b| b.is_ascii_lowercase() || b == b'-'), "{}", command.id);
            assert!(!command.title.is_empty() && command.title.len() <= 22, "{}", command.id);
            assert!(command.help.len() > 8 && !command.help.ends_with('.'), "{}", command.id);
        }
        let n = ids.len();
        ids.sort_unstable();
        ids.dedup();
        assert_eq!(ids.len(), n);
    }

    #[test]
    fn no_key_means_two_things_at_one_place() {
        let mut seen = std::collections::BTreeMap::new();
        for command in all() {
            for key in command.keys {
                let parsed: Key = key.parse().unwrap();
                assert_eq!(parsed.to_string(), *key, "{}", command.id);
                if let Some(other) = seen.insert((command.context, parsed), command.id) {
                    panic!("{key} is {other} and {} in {:?}", command.id, command.context);
                }
            }
        }
        // What is global is not hidden by a pane, or a hint would lie.
        for ((context, key), id) in &seen {
            if matches!(context, Context::Presets | Context::Picture | Context::Shape) {
                for outer in [Context::Global, Context::Always] {
                    let outer = seen.get(&(outer, *key));
                    assert!(outer.is_none(), "{key} is {id} in {context:?} and {outer:?} everywhere");
                }
            }
            if *context != Context::Always {
                assert!(!seen.contains_key(&(Context::Always, *key)), "{key} of {id} is taken everywhere");
            }
        }
    }
}
