//! The filter of the list, typed: the list follows at once.

use crossterm::event::KeyEvent;
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;

use super::set_filter;
use crate::tui::chrome::prompt::{self, Prompt};
use crate::tui::command::Context;
use crate::tui::dialog::{After, Dialog};
use crate::tui::effect::Effects;
use crate::tui::layout::View;
use crate::tui::model::Model;

/// The filter's line.
pub struct FilterLine {
    /// What is typed; the list paints it where it is on screen.
    pub prompt: Prompt,
    /// What the filter was, for Esc.
    before: String,
}

impl FilterLine {
    /// With the filter that is set, which the first character typed replaces.
    pub fn new(filter: &str) -> Self {
        Self { prompt: Prompt::selected(filter), before: filter.to_owned() }
    }
}

impl Dialog<Model> for FilterLine {
    fn context(&self) -> Context {
        prompt::CONTEXT
    }

    fn is_prompt(&self) -> bool {
        true
    }

    fn paint(&self, model: &Model, screen: Rect, buffer: &mut Buffer, view: &mut View) {
        // Where the list is on screen, it has painted the line.
        if view.cursor.is_none() {
            self.prompt.paint_at_bottom(model, "filter", None, screen, buffer, view);
        }
    }

    fn key(&mut self, model: &mut Model, key: KeyEvent, effects: &mut Effects) -> After {
        if self.prompt.key(key) {
            set_filter(model, self.prompt.text(), effects);
        }
        After::Stays
    }

    fn paste(&mut self, model: &mut Model, text: &str, effects: &mut Effects) -> After {
        self.prompt.paste(text);
        set_filter(model, self.prompt.text(), effects);
        After::Stays
    }

    fn cancel(&mut self, model: &mut Model, effects: &mut Effects) {
        set_filter(model, &self.before, effects);
    }

    fn leave(&mut self, model: &mut Model, effects: &mut Effects) -> After {
        self.take_or_give_up(model, effects)
    }
}
