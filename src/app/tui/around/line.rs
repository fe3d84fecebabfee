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
    pub fn label(&self) -> String {
        match &self.purpose {
            Purpose::Filter { .. } => "filter".to_owned(),
            Purpose::Knob(_) => "value".to_owned(),
            Purpose::SaveAs => "save as".to_owned(),
            Purpose::Replace(id) => format!("replace '{}'? yes or no", linden::knob::excerpt(id)),
        }
    }

    /// A key; whether it changed the text.
    pub fn typed(&mut self, key: Key) -> bool {
        if let Purpose::Knob(name) = self.purpose
            && matches!(key.code, KeyCode::Tab | KeyCode::Down | KeyCode::Up)
        {
            let forward = key.code != KeyCode::Up && !key.shift;
            let word = shape::complete(name, self.text(), forward);
            return word.is_some_and(|word| {
                self.input = Input::new(word.to_owned());
                true
            });
        }
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

/// The most characters that pasting makes a line: no path is longer, and each is looked at again
/// with every key.
const LONGEST: usize = 4096;

/// Inserts text, without line breaks and control characters, as far as there is room for it.
pub fn paste(input: &mut Input, text: &str) {
    let room = LONGEST.saturating_sub(input.value().chars().count());
    // Terminals send the Return key for the breaks of pasted lines.
    let pasted: String = text
        .trim_end()
        .chars()
        .map(|c| if matches!(c, '\n' | '\r' | '\t') { ' ' } else { c })
        .filter(|c| !c.is_control())
        .take(room)
        .collect();
    let at = input.cursor();
    let behind = at + pasted.chars().count();
    let value = input.value().chars().take(at).chain(pasted.chars()).chain(input.value().chars().skip(at));
    *input = Input::new(value.collect()).with_cursor(behind);
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
            let text = shape::completed(name, line.text()).to_owned();
            let problem = model.tree.as_ref().and_then(|tree| {
                let mut preset = tree.preset().clone();
                preset.set(name, &text).err().map(|error| error.to_string())
            });
            if let Some(Layer::Line(line)) = model.layers.last_mut() {
                line.problem = problem;
            }
        }
        Purpose::SaveAs => {
            let id = line.text().trim().to_owned();
            let problem = shape::save::problem(&id);
            if let Some(Layer::Line(line)) = model.layers.last_mut() {
                line.problem = problem;
            }
        }
        Purpose::Replace(_) => line.problem = None,
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
                shape::turn(model, name, shape::completed(name, &text));
            }
        }
        Purpose::SaveAs => {
            // What is wrong with it is on screen.
            if line.problem.is_some() {
                return;
            }
            model.layers.pop();
            if shape::save::replaces(model, &text) {
                model.layers.push(Layer::Line(Line::new(Purpose::Replace(text), "")));
            } else {
                save(model, text, false, effects);
            }
        }
        Purpose::Replace(id) => {
            model.layers.pop();
            if matches!(text.to_lowercase().as_str(), "y" | "yes") {
                save(model, id, true, effects);
            } else {
                model.say("not saved");
            }
        }
    }
}

fn save(model: &mut Model, id: String, overwrite: bool, effects: &mut Effects) {
    if let Some(tree) = &model.tree {
        let recipe = std::sync::Arc::clone(tree.recipe());
        effects.push(Effect::Save { id, from: tree.place.clone(), recipe, overwrite });
    }
}

/// What is said of a line at the bottom, above it: what is wrong, or what Enter would do.
pub fn remark(model: &Model, line: &Line) -> Option<(bool, String)> {
    match &line.purpose {
        Purpose::SaveAs => Some(match &line.problem {
            Some(problem) => (true, problem.clone()),
            None => (false, shape::save::consequence(model, line.text().trim())),
        }),
        Purpose::Replace(id) => Some((true, shape::save::loss(model, id).to_owned())),
        Purpose::Filter { .. } | Purpose::Knob(_) => None,
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pasted_text_goes_in_at_the_cursor_as_one_line() {
        let mut input = Input::new("äz".to_owned()).with_cursor(1);
        paste(&mut input, "b\r\tc\u{1b}\u{7}\n\n");
        assert_eq!((input.value(), input.cursor()), ("äb  cz", 5));
    }

    #[test]
    fn what_is_pasted_has_an_end() {
        let mut input = Input::new("a".to_owned());
        paste(&mut input, &"ö".repeat(1 << 20));
        assert_eq!((input.value().chars().count(), input.cursor()), (LONGEST, LONGEST));
        paste(&mut input, "more");
        assert_eq!(input.value().chars().count(), LONGEST);
    }
}
