//! The id that a tree or a forest is saved under, typed, and the question whether what has that id is replaced.

use std::path::PathBuf;
use std::sync::Arc;

use crossterm::event::{KeyCode, KeyEvent, KeyModifiers};
use linden::forest::Forest;
use linden::recipe::Recipe;
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;

use super::save::{self, Destination};
use crate::tui::chrome::prompt::{self, Prompt, Remark};
use crate::tui::command::Context;
use crate::tui::dialog::{After, Dialog};
use crate::tui::effect::{Effect, Effects};
use crate::tui::forest::ForestOnScreen;
use crate::tui::layout::View;
use crate::tui::model::Model;
use crate::tui::tree::{Tree, TreePlace};

/// The line of the id.
pub struct SaveLine {
    /// What is typed.
    pub prompt: Prompt,
    what: Saving,
}

/// The line of an answer: yes or no.
struct YesLine {
    prompt: Prompt,
    asks: Question,
}

/// What is asked before something is saved, and done after a yes.
enum Question {
    /// Whether what has the id or the path, as it was typed, is replaced.
    Replace { id: String, what: Saving },
    /// Whether a folder is made to save in.
    Folder { folder: PathBuf, order: Option<Effect> },
}

impl Question {
    fn open(self, model: &mut Model) {
        model.dialogs.open(YesLine { prompt: Prompt::new(""), asks: self });
    }

    /// The question, and what it is about.
    fn words(&self, model: &Model) -> (String, String) {
        match self {
            Self::Replace { id, .. } => {
                // Of a path the name says enough, and leaves room for the answers.
                let name = id.rsplit(std::path::is_separator).next().unwrap_or_default();
                let label = format!("replace '{}'? y or n", linden::knob::excerpt(name));
                (label, save::loss(model, id).to_owned())
            }
            Self::Folder { folder, .. } => (
                "make it? y or n".to_owned(),
                format!("there is no directory {}", crate::paths::show(folder)),
            ),
        }
    }

    /// Does it.
    fn yes(&mut self, effects: &mut Effects) {
        match self {
            Self::Replace { id, what } => what.order(id, true, effects),
            Self::Folder { order, .. } => effects.extend(order.take()),
        }
    }
}

/// There is no folder to save in: whether it is to be made.
pub fn ask_for_folder(model: &mut Model, folder: PathBuf, order: Effect) {
    Question::Folder { folder, order: Some(order) }.open(model);
}

/// What is saved: what the line was opened for, whatever is on screen when it is accepted.
#[derive(Clone)]
enum Saving {
    Tree { from: TreePlace, recipe: Arc<Recipe>, base: Arc<Recipe> },
    Forest { from: TreePlace, forest: Arc<Forest> },
}

impl Saving {
    /// Asks for it to be saved.
    fn order(&self, typed: &str, overwrite: bool, effects: &mut Effects) {
        // What is wrong with it was said while it was typed.
        let Ok(Destination { dir, id }) = Destination::read(typed) else { return };
        effects.push(match self.clone() {
            Self::Tree { from, recipe, base } => {
                Effect::Save { dir, id, from, recipe, base, overwrite, makes_folder: false }
            }
            Self::Forest { from, forest } => {
                Effect::SaveForest { dir, id, from, forest, overwrite, makes_folder: false }
            }
        });
    }
}

impl SaveLine {
    /// For a tree, with an id to begin with.
    pub fn of_tree(tree: &Tree, id: &str) -> Self {
        let (recipe, base) = (Arc::clone(tree.recipe()), Arc::clone(tree.saved()));
        Self::new(Saving::Tree { from: tree.place.clone(), recipe, base }, id)
    }

    /// For a forest, with an id to begin with.
    pub fn of_forest(forest: &ForestOnScreen, id: &str) -> Self {
        Self::new(Saving::Forest { from: forest.place.clone(), forest: Arc::clone(forest.wanted()) }, id)
    }

    fn new(what: Saving, id: &str) -> Self {
        let mut line = Self { prompt: Prompt::new(id), what };
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
        let label = match &self.what {
            Saving::Tree { .. } => "save as",
            Saving::Forest { .. } => "save forest as",
        };
        self.prompt.paint_at_bottom(model, label, Some(&remark), screen, buffer, view);
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
            Question::Replace { id, what: self.what.clone() }.open(model);
        } else {
            self.what.order(&id, false, effects);
        }
        After::Closes
    }

    /// Enter alone saves.
    fn leave(&mut self, model: &mut Model, effects: &mut Effects) -> After {
        self.cancel(model, effects);
        After::Closes
    }
}

impl Dialog<Model> for YesLine {
    fn context(&self) -> Context {
        prompt::CONTEXT
    }

    fn is_prompt(&self) -> bool {
        true
    }

    fn paint(&self, model: &Model, screen: Rect, buffer: &mut Buffer, view: &mut View) {
        let (label, text) = self.asks.words(model);
        let remark = Remark { text, warns: true };
        self.prompt.paint_at_bottom(model, &label, Some(&remark), screen, buffer, view);
    }

    /// One letter answers.
    fn key(&mut self, model: &mut Model, key: KeyEvent, effects: &mut Effects) -> After {
        match key.code {
            KeyCode::Char('y' | 'Y') if key.modifiers - KeyModifiers::SHIFT == KeyModifiers::NONE => {
                self.asks.yes(effects);
                After::Closes
            }
            KeyCode::Char(_) => self.accept(model, effects),
            _ => After::Stays,
        }
    }

    /// Enter alone is no.
    fn accept(&mut self, model: &mut Model, _effects: &mut Effects) -> After {
        model.say("not saved");
        After::Closes
    }

    /// Enter alone does nothing.
    fn leave(&mut self, model: &mut Model, effects: &mut Effects) -> After {
        self.cancel(model, effects);
        After::Closes
    }
}
