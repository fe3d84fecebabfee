//! The id that a tree is saved under, typed, and the question whether a preset of that id is replaced.

use std::sync::Arc;

use crossterm::event::KeyEvent;
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;

use super::save;
use crate::tui::chrome::prompt::{self, Prompt, Remark};
use crate::tui::command::Context;
use crate::tui::dialog::{After, Dialog};
use crate::tui::effect::{Effect, Effects};
use crate::tui::layout::View;
use crate::tui::model::Model;

/// The line of the id.
pub struct SaveLine {
    /// What is typed.
    pub prompt: Prompt,
}

/// The line of the answer: yes or no.
struct ReplaceLine {
    prompt: Prompt,
    /// The preset in question.
    id: String,
}

impl SaveLine {
    /// With an id to begin with.
    pub fn new(id: &str) -> Self {
        let mut line = Self { prompt: Prompt::new(id) };
        line.judge();
        line
    }

    fn id(&self) -> &str {
        self.prompt.text().trim()
    }

    /// The text changed: what is wrong with it now.
    fn judge(&mut self) {
        self.prompt.problem = save::problem(self.id());
    }
}

impl Dialog<Model> for SaveLine {
    fn context(&self) -> Context {
        prompt::CONTEXT
    }

    fn is_prompt(&self) -> bool {
        true
    }

    fn paint(&self, model: &Model, screen: Rect, buffer: &mut Buffer, view: &mut View) {
        let remark = match &self.prompt.problem {
            Some(problem) => Remark { text: problem.clone(), warns: true },
            None => Remark { text: save::consequence(model, self.id()), warns: false },
        };
        self.prompt.paint_at_bottom(model, "save as", Some(&remark), screen, buffer, view);
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

    fn accept(&mut self, model: &mut Model, effects: &mut Effects) -> After {
        // What is wrong with it is on screen.
        if self.prompt.problem.is_some() {
            return After::Stays;
        }
        let id = self.id().to_owned();
        if save::replaces(model, &id) {
            model.dialogs.open(ReplaceLine { prompt: Prompt::new(""), id });
        } else {
            order(model, id, false, effects);
        }
        After::Closes
    }
}

impl Dialog<Model> for ReplaceLine {
    fn context(&self) -> Context {
        prompt::CONTEXT
    }

    fn is_prompt(&self) -> bool {
        true
    }

    fn paint(&self, model: &Model, screen: Rect, buffer: &mut Buffer, view: &mut View) {
        let label = format!("replace '{}'? yes or no", linden::knob::excerpt(&self.id));
        let remark = Remark { text: save::loss(model, &self.id).to_owned(), warns: true };
        self.prompt.paint_at_bottom(model, &label, Some(&remark), screen, buffer, view);
    }

    fn key(&mut self, _model: &mut Model, key: KeyEvent, _effects: &mut Effects) -> After {
        self.prompt.key(key);
        After::Stays
    }

    fn paste(&mut self, _model: &mut Model, text: &str, _effects: &mut Effects) -> After {
        self.prompt.paste(text);
        After::Stays
    }

    fn accept(&mut self, model: &mut Model, effects: &mut Effects) -> After {
        if matches!(self.prompt.text().trim().to_lowercase().as_str(), "y" | "yes") {
            order(model, self.id.clone(), true, effects);
        } else {
            model.say("not saved");
        }
        After::Closes
    }
}

/// Asks for the tree on screen to be saved.
fn order(model: &Model, id: String, overwrite: bool, effects: &mut Effects) {
    if let Some(tree) = &model.tree {
        let recipe = Arc::clone(tree.recipe());
        effects.push(Effect::Save { id, from: tree.place.clone(), recipe, overwrite });
    }
}
