//! A line that is typed: a filter, a value, a name.

use linden_terminal::input::{Key, KeyCode};
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use tui_input::{Input, InputRequest};

use crate::config::theme::Theme;
use crate::tui::effect::{Effect, Effects};
use crate::tui::frame::View;
use crate::tui::model::{Layer, Model};
use crate::tui::{library, shape};

/// What a line is typed for.
#[derive(Clone, Debug, PartialEq)]
pub enum Purpose {
    /// The filter of the list, live.
    Filter {
        /// What it was, for Esc.
        before: String,
    },
    /// A knob's value.
    Knob(&'static str),
    /// The id of a preset to save.
    SaveAs,
    /// Whether a preset of that id is to be replaced.
    Replace(String),
}

/// A line that is typed.
pub struct Line {
    /// What for.
    pub purpose: Purpose,
    input: Input,
    /// What is wrong with what was typed so far.
    pub problem: Option<String>,
}

impl Line {
    /// A line with something in it already, the cursor at its end.
    pub fn new(purpose: Purpose, text: &str) -> Self {
        Self { purpose, input: Input::new(text.to_owned()), problem: None }
    }

    /// What was typed.
    pub fn text(&self) -> &str {
        self.input.value()
    }

    /// What stands before the line.
    pub fn label(&self) -> &'static str {
        match self.purpose {
            Purpose::Filter { .. } => "filter",
            Purpose::Knob(_) => "value",
            Purpose::SaveAs => "save as",
            Purpose::Replace(_) => "there is one of that name; type 'yes' to replace it",
        }
    }

    /// A key; whether it changed the text.
    pub fn typed(&mut self, key: Key) -> bool {
        edit(&mut self.input, key)
    }

    /// Pasted text, as one line.
    pub fn pasted(&mut self, text: &str) {
        paste(&mut self.input, text);
    }

    /// Paints the line into a row, with its cursor.
    pub fn paint(&self, area: Rect, buffer: &mut Buffer, view: &mut View, theme: &Theme) {
        paint(&self.input, area, buffer, view, theme);
    }
}

/// Edits a line as shells do; whether the text changed.
pub fn edit(input: &mut Input, key: Key) -> bool {
    let request = match (key.code, key.ctrl, key.alt) {
        (KeyCode::Char(c), false, false) => InputRequest::InsertChar(c),
        (KeyCode::Backspace, false, false) | (KeyCode::Char('h'), true, _) => InputRequest::DeletePrevChar,
        (KeyCode::Backspace, _, _) | (KeyCode::Char('w'), true, _) => InputRequest::DeletePrevWord,
        (KeyCode::Delete, false, _) => InputRequest::DeleteNextChar,
        (KeyCode::Delete, true, _) | (KeyCode::Char('d'), false, true) => InputRequest::DeleteNextWord,
        (KeyCode::Left, false, false) | (KeyCode::Char('b'), true, _) => InputRequest::GoToPrevChar,
        (KeyCode::Right, false, false) | (KeyCode::Char('f'), true, _) => InputRequest::GoToNextChar,
        (KeyCode::Left, _, _) | (KeyCode::Char('b'), false, true) => InputRequest::GoToPrevWord,
        (KeyCode::Right, _, _) | (KeyCode::Char('f'), false, true) => InputRequest::GoToNextWord,
        (KeyCode::Home, _, _) | (KeyCode::Char('a'), true, _) => InputRequest::GoToStart,
        (KeyCode::End, _, _) | (KeyCode::Char('e'), true, _) => InputRequest::GoToEnd,
        (KeyCode::Char('u'), true, _) => InputRequest::DeleteLine,
        (KeyCode::Char('k'), true, _) => InputRequest::DeleteTillEnd,
        _ => return false,
    };
    input.handle(request).is_some_and(|change| change.value)
}

/// Inserts text, without line breaks and control characters.
pub fn paste(input: &mut Input, text: &str) {
    for c in text.trim_end().chars() {
        let c = if c == '\n' || c == '\t' { ' ' } else { c };
        if !c.is_control() {
            let _ = input.handle(InputRequest::InsertChar(c));
        }
    }
}

/// Paints an input into a row, scrolled so that its cursor is in sight.
pub fn paint(input: &Input, area: Rect, buffer: &mut Buffer, view: &mut View, theme: &Theme) {
    if area.is_empty() {
        return;
    }
    buffer.set_style(area, theme.input);
    let scroll = input.visual_scroll(usize::from(area.width.saturating_sub(1)));
    let mut left = scroll;
    let rest: String = input
        .value()
        .chars()
        .skip_while(|c| {
            let width = unicode_width::UnicodeWidthChar::width(*c).unwrap_or(0);
            let skip = left > 0;
            left = left.saturating_sub(width);
            skip
        })
        .collect();
    buffer.set_stringn(area.x, area.y, linden::knob::printable(&rest), area.width.into(), theme.input);
    let at = area.x + (input.visual_cursor().saturating_sub(scroll) as u16).min(area.width - 1);
    view.cursor = Some((at, area.y));
}

/// The text of the topmost line changed: what follows from it at once.
pub fn changed(model: &mut Model, effects: &mut Effects) {
    let Some(Layer::Line(line)) = model.layers.last_mut() else { return };
    match line.purpose.clone() {
        Purpose::Filter { .. } => {
            let text = line.text().to_owned();
            library::set_filter(model, &text, effects);
        }
        Purpose::Knob(name) => {
            let text = line.text().to_owned();
            let problem = model.tree.as_ref().and_then(|tree| {
                let mut preset = tree.preset().clone();
                preset.set(name, &text).err().map(|error| error.to_string())
            });
            if let Some(Layer::Line(line)) = model.layers.last_mut() {
                line.problem = problem;
            }
        }
        Purpose::SaveAs | Purpose::Replace(_) => line.problem = None,
    }
}

/// Enter.
pub fn accept(model: &mut Model, effects: &mut Effects) {
    let Some(Layer::Line(line)) = model.layers.last() else { return };
    let text = line.text().trim().to_owned();
    match line.purpose.clone() {
        Purpose::Filter { .. } => {
            model.layers.pop();
        }
        Purpose::Knob(name) => {
            if line.problem.is_none() {
                model.layers.pop();
                shape::turn(model, name, &text);
            }
        }
        Purpose::SaveAs => {
            let taken =
                model.config.dirs.presets().is_some_and(|dir| dir.join(format!("{text}.toml")).exists());
            model.layers.pop();
            if taken {
                model.layers.push(Layer::Line(Line::new(Purpose::Replace(text), "")));
            } else {
                save(model, text, false, effects);
            }
        }
        Purpose::Replace(id) => {
            model.layers.pop();
            if text == "yes" {
                save(model, id, true, effects);
            } else {
                model.say("not saved");
            }
        }
    }
}

fn save(model: &mut Model, id: String, overwrite: bool, effects: &mut Effects) {
    if let Some(tree) = &model.tree {
        effects.push(Effect::Save { id, recipe: std::sync::Arc::clone(tree.recipe()), overwrite });
    }
}

/// Esc.
pub fn cancel(model: &mut Model, effects: &mut Effects) {
    if let Some(Layer::Line(line)) = model.layers.pop()
        && let Purpose::Filter { before } = line.purpose
    {
        library::set_filter(model, &before, effects);
    }
}
