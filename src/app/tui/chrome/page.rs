//! Pages of text to scroll: help, messages.

use std::collections::BTreeSet;

use linden::knob::Knob;
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use unicode_width::UnicodeWidthStr;

use super::footer::key_label;
use super::popup::{popup, scrollbar};
use crate::tui::command::Context;
use crate::tui::dialog::Dialog;
use crate::tui::layout::{View, centered, inside};
use crate::tui::model::{Model, Weight};
use crate::tui::shape;
use crate::wrap::wrapped;

/// Where a page's keys are listened to.
pub const CONTEXT: Context = Context::new(70, "page", "In a page of text");
/// Rows that the wheel scrolls by.
const WHEEL: isize = 3;

/// The widest column of text that is pleasant to read.
const COLUMN: u16 = 92;
/// Two columns from this width on.
const TWO: u16 = 126;
/// Between two columns.
const BETWEEN: u16 = 3;
/// The widest keys that text is aligned behind.
const MOST_KEYS: usize = 18;

/// A page of text.
pub struct Page {
    /// What its border says.
    pub title: &'static str,
    /// Its lines.
    pub lines: Vec<PageLine>,
    /// The first row on screen.
    pub scroll: usize,
    /// What its lines are made by anew after each message, where they follow the model.
    pub source: Option<fn(&Model) -> Vec<PageLine>>,
}

/// A line of a page, or a row of it on screen.
#[derive(Clone, Debug, PartialEq)]
pub enum PageLine {
    /// A heading.
    Heading(String),
    /// Keys, and what they do.
    Keys(String, String),
    /// Text.
    Text(Weight, String),
}

/// A page as it is on a screen.
pub struct Laid {
    /// With its border.
    pub area: Rect,
    /// Where its text is.
    pub text: Rect,
    /// One column of rows or two.
    pub columns: Vec<Vec<PageLine>>,
    /// Cells of a column.
    pub width: u16,
    /// Cells of the keys in it.
    pub keys: usize,
}

impl Page {
    /// A page whose lines follow the model.
    pub fn live(title: &'static str, source: fn(&Model) -> Vec<PageLine>, model: &Model) -> Self {
        Self { title, lines: source(model), scroll: 0, source: Some(source) }
    }

    /// All commands with their keys, those of this place first; in the form, before them what the chosen
    /// knob does.
    pub fn help(model: &Model) -> Self {
        let here = model.context();
        let known: BTreeSet<Context> = model.commands().map(|command| command.context).collect();
        let contexts = std::iter::once(here).chain(known.into_iter().filter(|context| *context != here));
        let mut lines = Vec::new();
        if here == Context::SHAPE
            && let Some((row, _)) = shape::selected(model)
        {
            lines.extend(about(&row.knob));
        }
        for context in contexts {
            let mut commands = model.commands().filter(|command| command.context == context).peekable();
            if commands.peek().is_none() {
                continue;
            }
            lines.push(PageLine::Heading(context.title().to_owned()));
            for command in commands {
                let keys: Vec<_> = model
                    .config
                    .keymap
                    .keys_of(command.id)
                    .iter()
                    .map(|key| key_label(model, &key.to_string()))
                    .collect();
                lines.push(PageLine::Keys(keys.join(" "), command.help.to_owned()));
            }
        }
        Self { title: "Help", lines, scroll: 0, source: None }
    }

    /// What was said, the newest first.
    pub fn messages(model: &Model) -> Self {
        let mut lines: Vec<_> =
            model.messages.iter().rev().map(|said| PageLine::Text(said.weight, said.text.clone())).collect();
        if lines.is_empty() {
            lines.push(PageLine::Text(Weight::Note, "nothing was said yet".to_owned()));
        }
        Self { title: "Messages", lines, scroll: 0, source: None }
    }

    /// Its rows on a screen of that size: wrapped, in two columns where it has sections and there is
    /// room.
    pub fn lay(&self, body: Rect) -> Laid {
        let sections = self.lines.iter().filter(|line| matches!(line, PageLine::Heading(_))).count();
        let is_double = sections > 1 && body.width >= TWO;
        let outer = if is_double { (2 * COLUMN + BETWEEN + 4).min(body.width) } else { COLUMN + 4 };
        // Below the title, where there is room for one.
        let top = u16::from(body.height > 6);
        let below = Rect { y: body.y + top, height: body.height - top, ..body };
        let mut area = centered(outer, below.height, below);
        let mut text = padded(inside(area));
        let width = if is_double { text.width.saturating_sub(BETWEEN) / 2 } else { text.width };
        let keys =
            self.lines.iter().map(|line| if let PageLine::Keys(keys, _) = line { keys.width() } else { 0 });
        let keys = keys.max().unwrap_or(0).min(MOST_KEYS).min(usize::from(width) / 3);
        let mut blocks: Vec<Vec<PageLine>> = Vec::new();
        for line in &self.lines {
            if blocks.is_empty() || matches!(line, PageLine::Heading(_)) {
                blocks.push(Vec::new());
            }
            if let Some(block) = blocks.last_mut() {
                block.extend(rows(line, width.into(), keys));
            }
        }
        let columns = if is_double {
            let (left, right) = blocks.split_at(fairest(&blocks));
            vec![stacked(left), stacked(right)]
        } else {
            vec![stacked(&blocks)]
        };
        let laid = columns.iter().map(Vec::len).max().unwrap_or(0).max(3);
        let spare = usize::from(text.height).saturating_sub(laid) as u16;
        (area.height, text.height) = (area.height - spare, text.height - spare);
        Laid { area, text, columns, width, keys }
    }

    /// Scrolls by a number of rows, as far as there are some.
    pub fn scroll_by(&mut self, by: isize, body: Rect) {
        let most = self.lay(body).most_scroll();
        self.scroll = self.scroll.min(most).saturating_add_signed(by).min(most);
    }
}

impl Laid {
    /// Rows of the longest column.
    pub fn rows(&self) -> usize {
        self.columns.iter().map(Vec::len).max().unwrap_or(0)
    }

    /// The first row when the last is in sight.
    pub fn most_scroll(&self) -> usize {
        self.rows().saturating_sub(self.text.height.into())
    }
}

impl Dialog<Model> for Page {
    fn context(&self) -> Context {
        CONTEXT
    }

    fn paint(&self, model: &Model, _body: Rect, buffer: &mut Buffer, view: &mut View) {
        let theme = &model.config.theme;
        let laid = self.lay(model.popup_body());
        let area = popup(model, self.title, laid.area, buffer, view);
        let first = self.scroll.min(laid.most_scroll());
        for (i, column) in laid.columns.iter().enumerate() {
            let x = laid.text.x + i as u16 * (laid.text.width - laid.width);
            for (y, row) in (laid.text.y..laid.text.bottom()).zip(column.iter().skip(first)) {
                let width = usize::from(laid.width);
                match row {
                    PageLine::Heading(text) => drop(buffer.set_stringn(x, y, text, width, theme.heading)),
                    PageLine::Keys(keys, text) => {
                        buffer.set_stringn(x, y, keys, width, theme.key);
                        let at = laid.keys.max(keys.width()) + 2;
                        buffer.set_stringn(x + at as u16, y, text, width.saturating_sub(at), theme.popup);
                    }
                    PageLine::Text(weight, text) => {
                        let style = match weight {
                            Weight::Note => theme.popup,
                            Weight::Warning => theme.warning,
                            Weight::Error => theme.error,
                        };
                        buffer.set_stringn(x, y, text, width, style);
                    }
                }
            }
        }
        if area != laid.area && laid.most_scroll() > 0 {
            let bar = Rect { x: area.right(), width: 1, ..area };
            scrollbar(model, bar, first, laid.rows(), buffer);
        }
    }

    fn refresh(&mut self, model: &Model) {
        if let Some(source) = self.source {
            self.lines = source(model);
        }
    }

    fn wheel(&mut self, model: &mut Model, _spot: Option<usize>, down: bool) {
        self.scroll_by(if down { WHEEL } else { -WHEEL }, model.popup_body());
    }
}

/// What a knob does, at length.
fn about(knob: &Knob) -> Vec<PageLine> {
    let see_also = if knob.see_also.is_empty() {
        String::new()
    } else {
        format!("see also: {}", knob.see_also.join(", "))
    };
    let texts = [knob.help, knob.details, &see_also].into_iter().filter(|text| !text.is_empty());
    let texts = texts.map(|text| PageLine::Text(Weight::Note, text.to_owned()));
    std::iter::once(PageLine::Heading(knob.name.to_owned())).chain(texts).collect()
}

/// A cell of air on both sides, where there is room.
fn padded(area: Rect) -> Rect {
    if area.width < 24 { area } else { Rect { x: area.x + 1, width: area.width - 2, ..area } }
}

/// A line in rows of at most `width` cells.
fn rows(line: &PageLine, width: usize, keys: usize) -> Vec<PageLine> {
    match line {
        PageLine::Heading(text) => vec![PageLine::Heading(text.clone())],
        PageLine::Text(weight, text) => {
            wrapped(text, width).into_iter().map(|row| PageLine::Text(*weight, row)).collect()
        }
        PageLine::Keys(named, text) => {
            // Keys that are wider than their column take a cell or two of the text.
            let first = keys.max(named.width());
            let mut words = wrapped(text, width.saturating_sub(first + 2));
            if named.width() > keys && words.len() > 1 {
                words = wrapped(text, width.saturating_sub(keys + 2));
                let mut rows = vec![PageLine::Keys(named.clone(), String::new())];
                rows.extend(words.into_iter().map(|row| PageLine::Keys(String::new(), row)));
                return rows;
            }
            let mut left = Some(named.clone());
            words.into_iter().map(|row| PageLine::Keys(left.take().unwrap_or_default(), row)).collect()
        }
    }
}

/// Sections one below the other, with an empty row between them.
fn stacked(blocks: &[Vec<PageLine>]) -> Vec<PageLine> {
    let empty = PageLine::Text(Weight::Note, String::new());
    blocks.join(&empty)
}

/// How many sections the left of two columns has, so that neither is much longer than the other.
fn fairest(blocks: &[Vec<PageLine>]) -> usize {
    let height = |stack: &[Vec<PageLine>]| stack.iter().map(|block| block.len() + 1).sum::<usize>();
    (1..blocks.len()).min_by_key(|at| height(&blocks[..*at]).max(height(&blocks[*at..]))).unwrap_or(0)
}
