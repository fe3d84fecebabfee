//! An edit of the wood, typed in short as `--edit` takes it.

use crossterm::event::KeyEvent;
use linden::skeleton::edit::Edit;
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;

use crate::tui::chrome::prompt::{self, Prompt};
use crate::tui::command::Context;
use crate::tui::dialog::{After, Dialog};
use crate::tui::effect::Effects;
use crate::tui::layout::View;
use crate::tui::model::Model;

/// The line of an edit.
pub struct EditLine {
    prompt: Prompt,
    /// The edit of the preset in whose place it goes.
    replaces: Option<usize>,
}

impl EditLine {
    /// With an edit to begin with.
    pub fn new(text: &str, replaces: Option<usize>) -> Self {
        Self { prompt: Prompt::new(text), replaces }
    }

    fn judge(&mut self) {
        let read = self.prompt.text().parse::<Edit>().and_then(|edit| edit.check());
        self.prompt.problem = read.err();
    }
}

impl Dialog<Model> for EditLine {
    fn context(&self) -> Context {
        prompt::CONTEXT
    }

    fn is_prompt(&self) -> bool {
        true
    }

    fn paint(&self, model: &Model, screen: Rect, buffer: &mut Buffer, view: &mut View) {
        let remark = match &self.prompt.problem {
            Some(problem) => prompt::Remark { text: problem.clone(), warns: true },
            None => prompt::Remark {
                text: "an operation, an axis, its value and others by name; docs/editing.md has all"
                    .to_owned(),
                warns: false,
            },
        };
        self.prompt.paint_at_bottom(model, "edit", Some(&remark), screen, buffer, view);
    }

    fn key(&mut self, _model: &mut Model, key: KeyEvent, _effects: &mut Effects) -> After {
        if self.prompt.key(key) {
            self.judge();
        }
        After::Stays
    }

    fn paste(&mut self, _model: &mut Model, text: &str, _effects: &mut Effects) -> After {
        self.prompt.paste(text);
        self.judge();
        After::Stays
    }

    fn accept(&mut self, model: &mut Model, _effects: &mut Effects) -> After {
        match super::add(model, self.prompt.text().trim(), self.replaces) {
            Ok(()) => After::Closes,
            Err(why) => {
                self.prompt.problem = Some(why);
                After::Stays
            }
        }
    }

    fn leave(&mut self, model: &mut Model, effects: &mut Effects) -> After {
        self.take_or_give_up(model, effects)
    }
}
