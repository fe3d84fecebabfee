//! The question whether changes are written into a preset's file before it is opened in an editor.

use std::path::PathBuf;
use std::sync::Arc;

use crossterm::event::{KeyCode, KeyEvent};
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;

use crate::tui::chrome::prompt::{self, Prompt, Remark};
use crate::tui::command::Context;
use crate::tui::dialog::{After, Dialog};
use crate::tui::effect::{Effect, Effects};
use crate::tui::layout::View;
use crate::tui::model::Model;

/// The line of the answer: a key.
pub struct SaveFirstLine {
    prompt: Prompt,
    path: PathBuf,
}

impl SaveFirstLine {
    /// The question about a file.
    pub fn new(path: PathBuf) -> Self {
        Self { prompt: Prompt::new(""), path }
    }

    /// Opens the file, with the changes in it when that is wanted.
    fn answer(&self, model: &Model, saves: bool, effects: &mut Effects) -> After {
        let path = self.path.clone();
        match model.tree.as_ref().filter(|tree| saves && tree.is_from(&path)) {
            Some(tree) => effects.push(Effect::WriteBack { path, recipe: Arc::clone(tree.recipe()) }),
            None => effects.push(Effect::EditFile(path)),
        }
        After::Closes
    }
}

impl Dialog<Model> for SaveFirstLine {
    fn context(&self) -> Context {
        prompt::CONTEXT
    }

    fn is_prompt(&self) -> bool {
        true
    }

    fn paint(&self, model: &Model, screen: Rect, buffer: &mut Buffer, view: &mut View) {
        let text = "y writes your changes into the file first, n opens it without them";
        let remark = Remark { text: text.to_owned(), warns: true };
        self.prompt.paint_at_bottom(model, "save first? y or n", Some(&remark), screen, buffer, view);
    }

    fn key(&mut self, model: &mut Model, key: KeyEvent, effects: &mut Effects) -> After {
        match key.code {
            KeyCode::Char('y' | 'Y') => self.answer(model, true, effects),
            KeyCode::Char('n' | 'N') => self.answer(model, false, effects),
            _ => After::Stays,
        }
    }

    /// Enter answers nothing.
    fn accept(&mut self, _model: &mut Model, _effects: &mut Effects) -> After {
        After::Stays
    }
}
