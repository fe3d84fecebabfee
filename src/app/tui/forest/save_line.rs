//! The id that a forest is saved under, typed.

use std::sync::Arc;

use crossterm::event::KeyEvent;
use linden::forest::Forest;
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;

use crate::tui::chrome::prompt::{self, Prompt, Remark};
use crate::tui::command::Context;
use crate::tui::dialog::{After, Dialog};
use crate::tui::effect::{Effect, Effects};
use crate::tui::layout::View;
use crate::tui::model::Model;
use crate::tui::shape::save;
use crate::tui::tree::TreePlace;

/// The line of the id, with what it is for: the screen may show something else by the time that it is accepted.
pub struct ForestSaveLine {
    prompt: Prompt,
    from: TreePlace,
    forest: Arc<Forest>,
    /// The id that the user was told would be replaced; a second Enter means it.
    warned: Option<String>,
}

impl ForestSaveLine {
    /// For the forest on screen, if there is one.
    pub fn new(model: &Model) -> Option<Self> {
        let forest = model.forest.as_ref()?;
        let id = save::proposed_for(model, &forest.wanted().id, &forest.place);
        let (from, forest) = (forest.place.clone(), Arc::clone(forest.wanted()));
        Some(Self { prompt: Prompt::selected(&id), from, forest, warned: None })
    }

    fn id(&self) -> &str {
        self.prompt.text().trim()
    }

    fn is_warned(&self) -> bool {
        self.warned.as_deref() == Some(self.id())
    }
}

impl Dialog<Model> for ForestSaveLine {
    fn context(&self) -> Context {
        prompt::CONTEXT
    }

    fn is_prompt(&self) -> bool {
        true
    }

    fn paint(&self, model: &Model, screen: Rect, buffer: &mut Buffer, view: &mut View) {
        let remark = match &self.prompt.problem {
            Some(problem) => Remark { text: problem.clone(), warns: true },
            None if self.is_warned() => {
                let text = "there is one of that name: Enter again replaces it, comments stay";
                Remark { text: text.to_owned(), warns: true }
            }
            None => Remark { text: save::consequence(model, self.id()), warns: false },
        };
        self.prompt.paint_at_bottom(model, "save forest as", Some(&remark), screen, buffer, view);
    }

    fn key(&mut self, _model: &mut Model, key: KeyEvent, _effects: &mut Effects) -> After {
        if self.prompt.key(key) {
            self.prompt.problem = save::problem(self.id());
        }
        After::Stays
    }

    fn paste(&mut self, _model: &mut Model, text: &str, _effects: &mut Effects) -> After {
        self.prompt.paste(text);
        self.prompt.problem = save::problem(self.id());
        After::Stays
    }

    fn accept(&mut self, model: &mut Model, effects: &mut Effects) -> After {
        // What is wrong with it is on screen.
        if self.prompt.problem.is_some() {
            return After::Stays;
        }
        let id = self.id().to_owned();
        let overwrite = save::replaces(model, &id);
        if overwrite && !self.is_warned() {
            self.warned = Some(id);
            return After::Stays;
        }
        let (from, forest) = (self.from.clone(), Arc::clone(&self.forest));
        effects.push(Effect::SaveForest { id, from, forest, overwrite });
        After::Closes
    }
}
