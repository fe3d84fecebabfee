//! The one table of commands. Keys, footer hints, `?` help, the `:` palette and the table of keys in
//! `docs/workbench.md` are made from it; a command that cannot be used says why.
//!
//! Each room of the workbench has its rows in the file that knows what they do; [`ALL`] puts the rooms
//! in the order that help has them. A new command is one row, a new room or dialog with commands is one
//! line here.

use super::model::Command;
use super::{
    chrome, crown, derivation, export, growth, library, picture, shape, statistics, vary, wind, wood,
};

/// All commands, room by room.
pub const ALL: &[&[Command]] = &[
    chrome::COMMANDS,
    library::COMMANDS,
    picture::COMMANDS,
    growth::COMMANDS,
    wind::COMMANDS,
    shape::COMMANDS,
    crown::COMMANDS,
    crown::CAMERA,
    wood::COMMANDS,
    wood::CAMERA,
    wood::CURVE,
    wood::CURVE_CAMERA,
    derivation::COMMANDS,
    derivation::CAMERA,
    statistics::COMMANDS,
    vary::COMMANDS,
    export::COMMANDS,
];

/// All commands, in the order of help.
pub fn all() -> impl Iterator<Item = &'static Command> {
    ALL.iter().copied().flatten()
}

/// The table as keymaps are read against.
pub fn key_table() -> Vec<crate::config::keymap::KeyRow> {
    all().map(|command| (command.id, command.context.id(), command.keys)).collect()
}

#[cfg(test)]
mod tests {
    use linden_terminal::input::Shortcut;

    use super::*;
    use crate::tui::command::Context;

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
                let parsed: Shortcut = key.parse().unwrap();
                assert_eq!(parsed.to_string(), *key, "{}", command.id);
                if let Some(other) = seen.insert((command.context, parsed), command.id) {
                    panic!("{key} is {other} and {} in {:?}", command.id, command.context);
                }
            }
        }
        // What is global is not hidden by a pane, or a hint would lie.
        for ((context, key), id) in &seen {
            if [Context::PRESETS, Context::PICTURE, Context::SHAPE].contains(context) {
                for outer in [Context::GLOBAL, Context::ALWAYS] {
                    let outer = seen.get(&(outer, *key));
                    assert!(outer.is_none(), "{key} is {id} in {context:?} and {outer:?} everywhere");
                }
            }
            if *context != Context::ALWAYS {
                assert!(!seen.contains_key(&(Context::ALWAYS, *key)), "{key} of {id} is taken everywhere");
            }
        }
    }
}
