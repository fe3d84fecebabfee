//! A knob's value, typed.

use crossterm::event::{KeyCode, KeyEvent};
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;

use super::complete::{complete, completed};
use crate::tui::chrome::prompt::{self, Prompt};
use crate::tui::command::Context;
use crate::tui::dialog::{After, Dialog};
use crate::tui::effect::Effects;
use crate::tui::layout::View;
use crate::tui::model::{FormSpot, Model};

/// The line of a knob's value.
pub struct ValueLine {
    /// What is typed; the form paints it where it is on screen.
    pub prompt: Prompt,
    /// The knob's name.
    pub knob: &'static str,
}

impl ValueLine {
    /// With the value that is set, which the first character typed replaces.
    pub fn new(knob: &'static str, value: &str) -> Self {
        Self { prompt: Prompt::selected(value), knob }
    }

    /// The text changed: what is wrong with it now.
    fn judge(&mut self, model: &Model) {
        let text = completed(self.knob, self.prompt.text());
        let of_forest = model.forest.as_ref().and_then(|forest| forest.problem(self.knob, text));
        let of_tree = model.tree.as_ref().and_then(|tree| {
            let mut preset = tree.preset().clone();
            preset.set(self.knob, text).err().map(|error| error.to_string())
        });
        self.prompt.problem = of_tree.or(of_forest);
    }
}

impl Dialog<Model> for ValueLine {
    fn context(&self) -> Context {
        prompt::CONTEXT
    }

    fn is_prompt(&self) -> bool {
        true
    }

    fn paint(&self, model: &Model, screen: Rect, buffer: &mut Buffer, view: &mut View) {
        // Where the form is on screen, it has painted the line.
        if view.cursor.is_none() {
            self.prompt.paint_at_bottom(model, "value", None, screen, buffer, view);
        }
    }

    /// Tab, Down and Up go through the words that the knob takes.
    fn key(&mut self, model: &mut Model, key: KeyEvent, _effects: &mut Effects) -> After {
        let has_changed = if matches!(key.code, KeyCode::Tab | KeyCode::BackTab | KeyCode::Down | KeyCode::Up)
        {
            let forward = matches!(key.code, KeyCode::Tab | KeyCode::Down);
            let word = complete(self.knob, self.prompt.text(), forward);
            word.inspect(|word| self.prompt.replace(word)).is_some()
        } else {
            self.prompt.key(key)
        };
        if has_changed {
            self.judge(model);
        }
        After::Stays
    }

    fn paste(&mut self, model: &mut Model, text: &str, _effects: &mut Effects) -> After {
        self.prompt.paste(text);
        self.judge(model);
        After::Stays
    }

    fn accept(&mut self, model: &mut Model, _effects: &mut Effects) -> After {
        if self.prompt.problem.is_some() {
            return After::Stays;
        }
        turn(model, self.knob, completed(self.knob, self.prompt.text().trim()));
        After::Closes
    }

    fn leave(&mut self, model: &mut Model, effects: &mut Effects) -> After {
        self.take_or_give_up(model, effects)
    }
}

/// Turns a knob to what was typed, and puts the cursor on it; whether that could be done, and why not is said.
pub fn take(model: &mut Model, name: &'static str, text: &str) -> bool {
    let is_turned = try_turn(model, name, completed(name, text));
    if is_turned {
        model.form.selected = Some(FormSpot::Knob(name));
    }
    is_turned
}

/// Turns a knob to what was typed; says why not.
pub fn turn(model: &mut Model, name: &'static str, text: &str) {
    try_turn(model, name, text);
}

/// Turns a knob of the tree or the forest on screen; whether that could be done, and why not is said.
fn try_turn(model: &mut Model, name: &'static str, text: &str) -> bool {
    let now = model.now;
    let turned = match (&mut model.tree, &mut model.forest) {
        (Some(tree), _) => tree.set(name, text, now).map_err(|error| error.to_string()),
        (None, Some(forest)) => forest.set(name, text).map_err(|error| error.to_string()),
        (None, None) => return false,
    };
    if let Err(why) = &turned {
        model.say_warning(why.clone());
    }
    turned.is_ok()
}
