//! Lines that are typed: a filter, a value, a name. What a line is for is a dialog of its room.

use crossterm::event::{Event, KeyCode, KeyEvent, KeyModifiers};
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::widgets::{Clear, Widget as _};
use tui_input::backend::crossterm::to_input_request;
use tui_input::{Input, InputRequest};
use unicode_width::UnicodeWidthStr;

use crate::config::theme::Theme;
use crate::system::CTRL_ALT_TYPES;
use crate::tui::command::Context;
use crate::tui::layout::{Target, View};
use crate::tui::model::Model;
use crate::wrap::{without_middle, wrapped_within};

/// Where the keys of typed lines are listened to, and of the palette.
pub const CONTEXT: Context = Context::new(80, "prompt", "While typing a line").typed();

/// The most rows of what is said above a line, where there are few and where there are many: answers to a question are
/// read whole.
const REMARK_ROWS: [u16; 2] = [2, 3];
/// The share of the screen that they have in between.
const REMARK_SHARE: u16 = 8;

/// A line that is typed.
pub struct Prompt {
    input: Input,
    /// Whether the first character that is typed takes the place of all that is there.
    is_selected: bool,
    /// What is wrong with what was typed so far.
    pub problem: Option<String>,
}

/// What is said above a line at the bottom of the screen.
pub struct Remark {
    /// What is wrong, or what Enter would do.
    pub text: String,
    /// Whether something is wrong, or would be lost.
    pub warns: bool,
}

impl Prompt {
    /// A line with something in it already, the cursor at its end.
    pub fn new(text: &str) -> Self {
        Self { input: Input::new(text.to_owned()), is_selected: false, problem: None }
    }

    /// A line with something in it that the first character typed replaces; a key that moves the cursor keeps it.
    pub fn selected(text: &str) -> Self {
        Self { is_selected: !text.is_empty(), ..Self::new(text) }
    }

    /// What was typed.
    pub fn text(&self) -> &str {
        self.input.value()
    }

    /// Puts another text in the line, the cursor at its end.
    pub fn replace(&mut self, text: &str) {
        self.is_selected = false;
        self.input = Input::new(text.to_owned());
    }

    /// A key; whether it changed the text.
    pub fn key(&mut self, key: KeyEvent) -> bool {
        let held = key.modifiers - KeyModifiers::SHIFT;
        let replaces = matches!(key.code, KeyCode::Char(_)) && held.is_empty()
            || matches!(key.code, KeyCode::Backspace | KeyCode::Delete);
        if std::mem::take(&mut self.is_selected) && replaces {
            self.input = Input::default();
            edit(&mut self.input, key);
            return true;
        }
        edit(&mut self.input, key)
    }

    /// Pasted text, as one line.
    pub fn paste(&mut self, text: &str) {
        if std::mem::take(&mut self.is_selected) {
            self.input = Input::default();
        }
        paste(&mut self.input, text);
    }

    /// Paints the line into a row, with its cursor.
    pub fn paint(&self, area: Rect, buffer: &mut Buffer, view: &mut View, theme: &Theme) {
        paint(&self.input, area, buffer, view, theme);
        if self.is_selected {
            let width = (self.text().width() as u16).min(area.width);
            buffer.set_style(Rect { width, height: area.height.min(1), ..area }, theme.selected);
        }
    }

    /// Paints the line at the bottom of the screen, a label before it and a remark above.
    pub fn paint_at_bottom(
        &self,
        model: &Model,
        label: &str,
        remark: Option<&Remark>,
        screen: Rect,
        buffer: &mut Buffer,
        view: &mut View,
    ) {
        if screen.is_empty() {
            return;
        }
        let theme = &model.config.theme;
        let row = Rect { y: screen.bottom() - 1, height: 1, ..screen };
        // What is asked stands in front, what answers it behind.
        let label = without_middle(&format!(" {label}: "), usize::from(screen.width).saturating_sub(4));
        // Its hints, which it covers, are not meant by the mouse.
        view.regions.push((row, Target::Dialog(None)));
        Clear.render(row, buffer);
        buffer.set_style(row, theme.input);
        buffer.set_stringn(row.x, row.y, &label, row.width.into(), theme.key);
        let x = row.x + label.width() as u16;
        self.paint(Rect { x, width: row.right().saturating_sub(x), ..row }, buffer, view, theme);
        if let Some(remark) = remark
            && screen.height >= 2
        {
            let most = (screen.height / REMARK_SHARE).clamp(REMARK_ROWS[0], REMARK_ROWS[1]);
            let most = usize::from((screen.height - 1).min(most));
            let rows = wrapped_within(&remark.text, usize::from(row.width).saturating_sub(1), most);
            let height = rows.len() as u16;
            let above = Rect { y: row.y - height, height, ..row };
            let style = theme.popup.patch(if remark.warns { theme.warning } else { theme.dim });
            view.covers.push(above);
            Clear.render(above, buffer);
            buffer.set_style(above, style);
            for (text, y) in rows.iter().zip(above.y..) {
                buffer.set_stringn(above.x + 1, y, text, usize::from(above.width) - 1, style);
            }
        }
    }
}

/// Edits a line as shells do; whether the text changed.
pub fn edit(input: &mut Input, key: KeyEvent) -> bool {
    if !CTRL_ALT_TYPES && key.modifiers.contains(KeyModifiers::CONTROL | KeyModifiers::ALT) {
        return false;
    }
    // Nothing can be selected: with Shift, keys that move the cursor move it.
    let key = match key.code {
        KeyCode::Char(_) => key,
        _ => KeyEvent { modifiers: key.modifiers - KeyModifiers::SHIFT, ..key },
    };
    let word = match (key.code, key.modifiers) {
        // Words with Alt too, as terminals on a Mac send them.
        (KeyCode::Left | KeyCode::Char('b'), KeyModifiers::ALT) => Some(InputRequest::GoToPrevWord),
        (KeyCode::Right | KeyCode::Char('f'), KeyModifiers::ALT) => Some(InputRequest::GoToNextWord),
        (KeyCode::Char('d'), KeyModifiers::ALT) => Some(InputRequest::DeleteNextWord),
        (KeyCode::Backspace, KeyModifiers::CONTROL) => Some(InputRequest::DeletePrevWord),
        _ => None,
    };
    let request = word.or_else(|| to_input_request(&Event::Key(key)));
    request.and_then(|request| input.handle(request)).is_some_and(|change| change.value)
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

/// What all texts begin with; `None` where there are none.
pub fn common_start(texts: &[String]) -> Option<&str> {
    let (first, rest) = texts.split_first()?;
    Some(rest.iter().fold(first.as_str(), |common, other| {
        let same = common.char_indices().zip(other.chars()).find(|((_, a), b)| a != b);
        let end = same.map_or(common.len().min(other.len()), |((at, _), _)| at);
        &common[..end]
    }))
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
    view.order.first.push(area);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[cfg(unix)]
    #[test]
    fn what_is_held_with_ctrl_and_alt_types_nothing() {
        let mut input = Input::new("a".to_owned());
        let held = KeyModifiers::CONTROL | KeyModifiers::ALT;
        assert!(!edit(&mut input, KeyEvent::new(KeyCode::Char('x'), held)));
        assert!(edit(&mut input, KeyEvent::new(KeyCode::Char('X'), KeyModifiers::SHIFT)));
        let end = input.cursor();
        for (code, cursor) in
            [(KeyCode::Home, 0), (KeyCode::Right, 1), (KeyCode::End, end), (KeyCode::Left, end - 1)]
        {
            assert!(!edit(&mut input, KeyEvent::new(code, KeyModifiers::SHIFT)), "moving changes no text");
            assert_eq!(input.cursor(), cursor, "Shift {code:?}");
        }
        edit(&mut input, KeyEvent::new(KeyCode::End, KeyModifiers::NONE));
        assert_eq!(input.value(), "aX");
    }

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
