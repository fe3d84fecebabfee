//! The question whether a preset is removed, or a file taken off the list.

use crossterm::event::{KeyCode, KeyEvent};
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;

use crate::tui::chrome::prompt::{self, Prompt, Remark};
use crate::tui::command::Context;
use crate::tui::dialog::{After, Dialog};
use crate::tui::effect::{Effect, Effects};
use crate::tui::layout::View;
use crate::tui::model::Model;
use crate::tui::tree::TreePlace;

/// The line of the answer: a key.
pub struct RemoveLine {
    prompt: Prompt,
    id: String,
    place: TreePlace,
    /// Whether its file is removed, and not only taken off the list.
    is_own: bool,
}

impl RemoveLine {
    /// For the selected entry; `None` where it is built in.
    pub fn new(model: &Model) -> Option<Self> {
        let entry = model.library.entry()?;
        let TreePlace::File(path) = &entry.place else { return None };
        let is_own = model.config.dirs.presets().is_some_and(|dir| path.starts_with(dir));
        Some(Self { prompt: Prompt::new(""), id: entry.id.clone(), place: entry.place.clone(), is_own })
    }
}

impl Dialog<Model> for RemoveLine {
    fn context(&self) -> Context {
        prompt::CONTEXT
    }

    fn is_prompt(&self) -> bool {
        true
    }

    fn paint(&self, model: &Model, screen: Rect, buffer: &mut Buffer, view: &mut View) {
        let id = linden::knob::excerpt(&self.id);
        let (label, mut text) = if self.is_own {
            (format!("remove '{id}'? y or n"), "its file goes into the folder .removed beside it".to_owned())
        } else {
            (format!("take '{id}' off the list? y or n"), "its file stays".to_owned())
        };
        let shown = model.tree.as_ref().is_some_and(|tree| tree.place == self.place && tree.is_modified());
        let warns = shown || model.library.is_shelved(&self.place);
        if warns {
            text += "; your changes that are not saved are lost";
        }
        self.prompt.paint_at_bottom(model, &label, Some(&Remark { text, warns }), screen, buffer, view);
    }

    fn key(&mut self, model: &mut Model, key: KeyEvent, effects: &mut Effects) -> After {
        match key.code {
            KeyCode::Char('y' | 'Y') => {
                match &self.place {
                    TreePlace::File(path) if self.is_own => effects.push(Effect::Remove(path.clone())),
                    place => super::removed(model, place, effects),
                }
                After::Closes
            }
            KeyCode::Char('n' | 'N') => After::Closes,
            _ => After::Stays,
        }
    }

    /// Enter answers nothing.
    fn accept(&mut self, _model: &mut Model, _effects: &mut Effects) -> After {
        After::Stays
    }
}
