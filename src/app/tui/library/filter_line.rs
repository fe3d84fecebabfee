//! The filter of the list, typed: the list follows at once.

use crossterm::event::KeyEvent;
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;

use super::{set_filter, show_place};
use crate::tui::chrome::prompt::{self, Prompt};
use crate::tui::command::Context;
use crate::tui::dialog::{After, Dialog};
use crate::tui::effect::Effects;
use crate::tui::layout::View;
use crate::tui::model::Model;
use crate::tui::tree::TreePlace;

/// The filter's line.
pub struct FilterLine {
    /// What is typed; the list paints it where it is on screen.
    pub prompt: Prompt,
    /// What the filter was, for Esc.
    before: String,
    /// Where the cursor was: its entry, and the folded group whose heading it was on.
    cursor: (Option<TreePlace>, Option<String>),
}

impl FilterLine {
    /// With the filter that is set, which the first character typed replaces. What is shown from here on passes by.
    pub fn new(model: &mut Model) -> Self {
        let (shown, loading) = (model.place().cloned(), model.loading.clone());
        let library = &mut model.library;
        library.begin_passing(shown.as_ref(), loading.as_ref());
        Self {
            prompt: Prompt::selected(&library.filter),
            before: library.filter.clone(),
            cursor: (library.entry().map(|entry| entry.place.clone()), library.at_group.clone()),
        }
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

    fn accept(&mut self, model: &mut Model, _effects: &mut Effects) -> After {
        model.library.end_passing(model.loading.is_some());
        After::Closes
    }

    /// The list, its cursor and the tree are as they were.
    fn cancel(&mut self, model: &mut Model, effects: &mut Effects) {
        let (entry, group) = &self.cursor;
        model.library.go_back(&self.before, entry.as_ref(), group.clone());
        if let Some(from) = model.library.passing.as_ref().and_then(|passing| passing.from.clone()) {
            show_place(model, from, effects);
        }
        model.library.end_passing(model.loading.is_some());
    }

    fn leave(&mut self, model: &mut Model, effects: &mut Effects) -> After {
        self.take_or_give_up(model, effects)
    }
}
