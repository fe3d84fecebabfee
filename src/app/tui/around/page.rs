//! Pages of text to scroll: help, messages.

use crate::tui::command::{self, Context};
use crate::tui::frame::key_label;
use crate::tui::model::{Model, Weight};

/// A page of text.
pub struct Page {
    /// What its border says.
    pub title: &'static str,
    /// Its lines.
    pub lines: Vec<PageLine>,
    /// The first line on screen.
    pub scroll: usize,
}

/// A line of a page.
#[derive(Clone, Debug, PartialEq)]
pub enum PageLine {
    /// A heading.
    Heading(String),
    /// Keys, and what they do.
    Keys(String, String),
    /// Text.
    Text(Weight, String),
}

impl Page {
    /// All commands with their keys, those of this place first.
    pub fn help(model: &Model) -> Self {
        let here = model.context();
        let mut contexts = vec![here];
        contexts.extend(Context::ALL.into_iter().filter(|context| *context != here));
        let mut lines = Vec::new();
        for context in contexts {
            let own: Vec<_> = command::all().filter(|command| command.context == context).collect();
            if own.is_empty() {
                continue;
            }
            lines.push(PageLine::Heading(context.title().to_owned()));
            for command in own {
                let keys: Vec<_> = model
                    .config
                    .keymap
                    .keys_of(command.id)
                    .iter()
                    .map(|key| key_label(&key.to_string()))
                    .collect();
                lines.push(PageLine::Keys(keys.join(" "), command.help.to_owned()));
            }
            lines.push(PageLine::Text(Weight::Note, String::new()));
        }
        Self { title: "Help", lines, scroll: 0 }
    }

    /// What was said, the newest first.
    pub fn messages(model: &Model) -> Self {
        let mut lines: Vec<_> =
            model.messages.iter().rev().map(|said| PageLine::Text(said.weight, said.text.clone())).collect();
        if lines.is_empty() {
            lines.push(PageLine::Text(Weight::Note, "nothing was said yet".to_owned()));
        }
        Self { title: "Messages", lines, scroll: 0 }
    }
}
