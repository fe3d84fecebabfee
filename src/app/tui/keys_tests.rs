//! The table of keys in docs/workbench.md is the table of commands.

use std::collections::BTreeSet;
use std::path::Path;

use linden_terminal::ColorDepth;

use super::chrome::footer::label_of;
use super::command::Context;
use super::commands;
use crate::config::keymap::Keymap;
use crate::config::settings::Settings;
use crate::config::theme::Theme;

const BEGIN: &str = "<!-- keys: LINDEN_UPDATE=1 cargo test -p linden-cli --lib keys -->\n";
const END: &str = "<!-- /keys -->";

/// A row for each place: keys and what they do.
fn table() -> String {
    let mut text = "| where | keys |\n|---|---|\n".to_owned();
    let contexts: BTreeSet<Context> = commands::all().map(|command| command.context).collect();
    for context in contexts {
        let commands =
            commands::all().filter(|command| command.context == context && !command.keys.is_empty());
        let words: Vec<String> = commands
            .map(|command| {
                let keys: Vec<String> =
                    command.keys.iter().map(|key| format!("`{}`", label_of(key, true))).collect();
                format!("{} {}", keys.join(" "), command.title.replace(' ', "\u{a0}"))
            })
            .collect();
        if !words.is_empty() {
            text += &format!("| {} | {} |\n", context.title(), words.join(" · "));
        }
    }
    text
}

#[test]
fn the_documented_files_can_be_read() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/workbench.md");
    let page = std::fs::read_to_string(&path).unwrap();
    let mut read = Vec::new();
    for file in
        page.split("```toml\n").skip(1).filter_map(|rest| rest.split_once("```")).map(|(file, _)| file)
    {
        let name = file.lines().next().unwrap_or_default().trim_start_matches("# ");
        let complaints = match name {
            "config.toml" => Settings::read(Path::new(name), file).1,
            "keymap.toml" => Keymap::read(Path::new(name), file, &commands::key_table()).1,
            "themes/moor.toml" => Theme::read(Path::new(name), file, "moor", false, ColorDepth::True).1,
            _ => continue,
        };
        assert_eq!(complaints, [], "{file}");
        read.push(name.to_owned());
    }
    assert_eq!(read, ["config.toml", "keymap.toml", "themes/moor.toml"]);
}

#[test]
fn the_workbench_s_page_has_the_keys_as_they_are() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/workbench.md");
    let page = std::fs::read_to_string(&path).unwrap();
    let (before, rest) = page.split_once(BEGIN).expect("the page has the beginning of the table");
    let (found, after) = rest.split_once(END).expect("the page has the end of the table");
    let table = table();
    if found != table && std::env::var_os("LINDEN_UPDATE").is_some() {
        std::fs::write(&path, format!("{before}{BEGIN}{table}{END}{after}")).unwrap();
        return;
    }
    assert!(
        found == table,
        "the table of keys in docs/workbench.md is old; run: LINDEN_UPDATE=1 cargo test -p linden-cli --lib keys"
    );
}
