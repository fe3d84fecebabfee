//! The grammar's editor as a dialog: keys, mouse, and how it is painted.

use crossterm::event::{KeyEvent, MouseEvent};
use linden::knob::printable;
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::style::{Modifier, Style};
use unicode_width::UnicodeWidthChar;

use super::grammar::{GrammarEditor, said};
use super::{forecast, grammar};
use crate::config::theme::Theme;
use crate::tui::chrome::popup::popup;
use crate::tui::command::Context;
use crate::tui::dialog::{After, Dialog};
use crate::tui::effect::Effects;
use crate::tui::layout::{Target, View};
use crate::tui::model::Model;
use crate::wrap::{clipped, wrapped_within};

/// How the text is written, for those who see it for the first time.
const SYNTAX: &str = "axiom = F · a rule a line: F -> F[+F]F · a chance: F -> (0.5) FF · // comment";
/// Rows besides the text: the frame, the syntax, what is wrong or how much it grows.
const AROUND: u16 = 5;

impl Dialog<Model> for GrammarEditor {
    fn context(&self) -> Context {
        grammar::CONTEXT
    }

    fn paint(&self, model: &Model, body: Rect, buffer: &mut Buffer, view: &mut View) {
        paint(model, self, body, buffer, view);
    }

    fn key(&mut self, model: &mut Model, key: KeyEvent, _effects: &mut Effects) -> After {
        self.change(model, |text| text.key(key))
    }

    fn paste(&mut self, model: &mut Model, text: &str, _effects: &mut Effects) -> After {
        self.change(model, |typed| typed.paste(text))
    }

    fn click(&mut self, model: &mut Model, _spot: usize, mouse: MouseEvent, _effects: &mut Effects) -> After {
        self.point(model, mouse);
        After::Stays
    }

    fn wheel(&mut self, model: &mut Model, spot: Option<usize>, down: bool) {
        if spot.is_some() {
            self.roll(model, down);
        }
    }
}

/// Paints the editor over the lower part of the screen, so that the tree stays in sight above it.
fn paint(model: &Model, editor: &GrammarEditor, body: Rect, buffer: &mut Buffer, view: &mut View) {
    let theme = &model.config.theme;
    let lines = editor.text.lines().count();
    let room = body.height;
    let wanted = u16::try_from(lines + 1).unwrap_or(u16::MAX).saturating_add(AROUND);
    let height = wanted.min((u32::from(room) * 6 / 10) as u16).max(12).min(room);
    let area = Rect { y: body.y + room - height, height, ..body };
    let fault = fault(model, editor);
    let title = match (editor.is_changed(), &fault) {
        (false, None) => "Grammar",
        (true, None) => "Grammar ●",
        (false, Some(_)) => "Grammar ✗ does not grow",
        (true, Some(_)) => "Grammar ● ✗ does not grow",
    };
    let inner = popup(model, title, area, buffer, view);
    if inner.is_empty() {
        return;
    }
    let forecast = || model.tree.as_ref().and_then(|tree| forecast::line(tree.preset()));
    let (said, style) = match fault {
        Some(fault) => (fault, theme.popup.patch(theme.error).remove_modifier(Modifier::UNDERLINED)),
        None => (forecast().unwrap_or_default(), theme.popup_dim),
    };
    // What is wrong is read whole where that leaves the text two thirds.
    let rows = wrapped_within(&said, inner.width.into(), usize::from(inner.height / 3).max(2));
    let bottom = if inner.height >= 6 { (rows.len() as u16).max(2) } else { u16::from(inner.height >= 2) };
    let top = u16::from(inner.height >= 5);
    let text = Rect { y: inner.y + top, height: inner.height - top - bottom, ..inner };
    if top > 0 {
        let row = clipped(SYNTAX, inner.width.into());
        buffer.set_stringn(inner.x, inner.y, row, inner.width.into(), theme.popup_dim);
    }
    body_of(model, editor, lines, text, buffer, view);
    let below = Rect { y: text.bottom(), height: bottom, ..inner };
    let rows = if bottom < 2 { wrapped_within(&said, below.width.into(), bottom.into()) } else { rows };
    for (row, y) in rows.iter().zip(below.y..below.bottom()) {
        buffer.set_stringn(below.x, y, row, below.width.into(), style);
    }
}

/// Why the text, as it stands, grows into no tree: it cannot be read, or what it says came to nothing.
fn fault(model: &Model, editor: &GrammarEditor) -> Option<String> {
    // What is growing was not there to be wrong yet.
    let tree = model.tree.as_ref().filter(|tree| tree.growing.is_none());
    editor.fault.as_ref().map(said).or_else(|| tree?.fault.clone())
}

/// The text with its line numbers.
fn body_of(
    model: &Model,
    editor: &GrammarEditor,
    lines: usize,
    area: Rect,
    buffer: &mut Buffer,
    view: &mut View,
) {
    let theme = &model.config.theme;
    let numbers = if area.width >= 24 { lines.to_string().len() as u16 + 2 } else { 0 };
    let area = Rect { x: area.x + numbers, width: area.width - numbers, ..area };
    view.regions.push((area, Target::Dialog(Some(grammar::TEXT))));
    let (first, skipped) = editor.scrolled(area.width.into(), area.height.into());
    let cursor = editor.text.cursor();
    let partner = partner(editor);
    for (y, (i, line)) in (area.y..area.bottom()).zip(editor.text.lines().enumerate().skip(first)) {
        if numbers > 0 {
            let number = format!("{:>width$} ", i + 1, width = usize::from(numbers) - 1);
            let style = if i == cursor.0 {
                theme.popup.patch(theme.accent)
            } else {
                theme.popup.patch(theme.line_number)
            };
            buffer.set_string(area.x - numbers, y, number, style);
        }
        let mut x = area.x;
        let mut classes = Classes::new(line);
        for (column, c) in line.chars().enumerate() {
            let mut style = theme.popup.patch(classes.of(c).style(theme));
            if column < skipped {
                continue;
            }
            if partner == Some((i, column)) {
                style = style.patch(theme.matched);
            }
            let (shown, style) = cell(c, style, theme);
            let width = shown.width().unwrap_or(1) as u16;
            if i == cursor.0 && column == cursor.1 {
                view.cursor = Some((x, y));
            }
            if x + width > area.right() {
                break;
            }
            buffer[(x, y)].set_char(shown).set_style(wrong(editor, (i, column), style, theme));
            x += width;
        }
        let length = line.chars().count();
        if i == cursor.0 && cursor.1 < length && cursor.1 >= skipped && view.cursor.is_none() {
            // Wide characters may have pushed it out.
            view.cursor = Some((area.right().saturating_sub(1), y));
        }
        if x < area.right() {
            // What is missing is missing past the end.
            buffer[(x, y)].set_style(wrong(editor, (i, length), Style::new(), theme));
        }
        if i == cursor.0 && cursor.1 >= length {
            view.cursor = Some((x.min(area.right().saturating_sub(1)), y));
        }
    }
}

/// The style of a place, underlined when that is where the text is wrong.
fn wrong(editor: &GrammarEditor, at: (usize, usize), style: Style, theme: &Theme) -> Style {
    let is_there = editor.fault.as_ref().is_some_and(|fault| (fault.line - 1, fault.column - 1) == at);
    if is_there { style.patch(theme.error).add_modifier(Modifier::UNDERLINED) } else { style }
}

/// How a character is shown: in one cell, or two where it is that wide; what cannot be seen as a
/// mark.
fn cell(c: char, style: Style, theme: &Theme) -> (char, Style) {
    let is_seen =
        c.width().is_some_and(|width| width > 0) && printable(c.encode_utf8(&mut [0; 4])).starts_with(c);
    if is_seen { (c, style) } else { ('·', style.patch(theme.error)) }
}

/// What a character of the text is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Class {
    Symbol,
    Operator,
    Number,
    Comment,
}

impl Class {
    fn style(self, theme: &Theme) -> Style {
        match self {
            Self::Symbol => theme.symbol,
            Self::Operator => theme.operator,
            Self::Number => theme.number,
            Self::Comment => theme.comment,
        }
    }
}

/// The style of a character of a module: of its symbol, or behind it, where arguments are.
pub fn class_style(is_behind: bool, c: char, theme: &Theme) -> Style {
    let mut classes = Classes { comment: false, in_brackets: is_behind };
    classes.of(c).style(theme)
}

/// Tells a line's characters from left to right.
struct Classes {
    comment: bool,
    in_brackets: bool,
}

impl Classes {
    fn new(line: &str) -> Self {
        Self { comment: line.trim_start().starts_with("//"), in_brackets: false }
    }

    fn of(&mut self, c: char) -> Class {
        if self.comment {
            return Class::Comment;
        }
        if c == '(' {
            self.in_brackets = true;
        }
        let inside = self.in_brackets;
        if c == ')' {
            self.in_brackets = false;
        }
        match c {
            _ if inside => Class::Number,
            _ if c.is_alphanumeric() || c == '_' => Class::Symbol,
            _ => Class::Operator,
        }
    }
}

/// The bracket that belongs to the one at the cursor, on the same line.
fn partner(editor: &GrammarEditor) -> Option<(usize, usize)> {
    let (row, column) = editor.text.cursor();
    let line: Vec<char> = editor.text.lines().nth(row)?.chars().collect();
    let (steps, closes): (Box<dyn Iterator<Item = usize>>, [char; 2]) = match line.get(column)? {
        '[' => (Box::new(column..line.len()), ['[', ']']),
        ']' => (Box::new((0..=column).rev()), [']', '[']),
        _ => return None,
    };
    let mut depth = 0_usize;
    for i in steps {
        if line[i] == closes[0] {
            depth += 1;
        } else if line[i] == closes[1] {
            depth -= 1;
            if depth == 0 {
                return Some((row, i));
            }
        }
    }
    None
}
