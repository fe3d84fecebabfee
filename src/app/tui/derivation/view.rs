//! The panel of a derivation, painted over the knobs.

use crossterm::event::MouseEvent;
use linden::lsystem::TracedModule;
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::style::Style;
use unicode_width::UnicodeWidthStr;

use super::commands::last_step;
use super::{Debugger, PICTURE, WORD, grammar, marks};
use crate::figures::{metres, thousands};
use crate::jobs::{DerivedWord, short};
use crate::tui::layout::{Pane, Target, View, first_row};
use crate::tui::model::Model;
use crate::tui::picture;
use crate::tui::shape::class_style;
use crate::wrap::{clipped, wrapped_within};

/// Rows of what is said of the module, the most first: all with a rule below, its own and its rules, its own alone.
const HEADS: [u16; 3] = [5, 3, 1];
/// Rows that the word has for each of them at least.
const WORD_ROWS: [u16; 3] = [6, 3, 1];
/// Rows of why a word is not there.
const FAULT: usize = 4;

/// Where the parts of the panel are.
pub struct Areas {
    /// The rule above the pane.
    heading: Rect,
    /// What is said of the module.
    head: Rect,
    /// The word.
    pub word: Rect,
}

/// Where the parts of the panel are: in the place of the knobs.
pub fn areas(model: &Model) -> Areas {
    let layout = model.layout();
    let area = layout.text(Pane::Shape).unwrap_or_default();
    let heading = layout.headings[Pane::Shape as usize];
    let fits = |(head, word): (&u16, &u16)| (head + word <= area.height).then_some(*head);
    let head = HEADS.iter().zip(&WORD_ROWS).find_map(fits).unwrap_or(0);
    Areas {
        heading,
        head: Rect { height: head, ..area },
        word: Rect { y: area.y + head, height: area.height - head, ..area },
    }
}

/// The module that is painted where the mouse is.
pub fn module_at(debugger: &Debugger, area: Rect, mouse: MouseEvent) -> Option<usize> {
    let (area, _) = split(debugger, area);
    let row = mouse.row.checked_sub(area.y).filter(|row| *row < area.height)?;
    let line = first_line(debugger, area) + usize::from(row);
    let is_there = line < debugger.lines.len();
    is_there.then(|| debugger.at_column(line, mouse.column.saturating_sub(area.x).into()))
}

/// The rows of the word's letters, and below them why there is no word, or no plant.
fn split(debugger: &Debugger, area: Rect) -> (Rect, Option<(Rect, String)>) {
    let undrawn = || debugger.word.as_ref().and_then(|word| word.traced.undrawn.as_ref());
    let why = debugger.fault.clone().or_else(|| undrawn().map(ToString::to_string));
    let Some(why) = why else { return (area, None) };
    let rows = wrapped_within(&why, area.width.into(), FAULT).len() as u16;
    let rows = rows.min(area.height / 2);
    let letters = Rect { height: area.height - rows, ..area };
    (letters, Some((Rect { y: letters.bottom(), height: rows, ..area }, why)))
}

fn first_line(debugger: &Debugger, area: Rect) -> usize {
    first_row(debugger.line_of(debugger.cursor), debugger.lines.len(), area.height.into())
}

/// Paints the panel.
pub fn paint(model: &Model, debugger: &Debugger, buffer: &mut Buffer, view: &mut View) {
    let theme = &model.config.theme;
    let areas = areas(model);
    let pane = model.layout().pane(Pane::Shape).unwrap_or_default();
    // Above the footer: its hints stay within reach of the mouse.
    view.regions.push((model.dialog_body(), Target::Dialog(None)));
    if let Some(area) = picture::area(model) {
        view.regions.push((area, Target::Dialog(Some(PICTURE))));
    }
    view.regions.push((areas.word, Target::Dialog(Some(WORD))));
    for part in [areas.heading, pane] {
        ratatui::widgets::Widget::render(ratatui::widgets::Clear, part, buffer);
        buffer.set_style(part, theme.text);
    }
    let title = title(model, debugger);
    if !areas.heading.is_empty() {
        let row = areas.heading;
        buffer.set_string(row.x, row.y, "─".repeat(row.width.into()), theme.border_focused);
        let text = clipped(&format!(" {title} "), usize::from(row.width).saturating_sub(2));
        buffer.set_string(row.x + 1, row.y, text, theme.title_focused);
    }
    let Some(word) = &debugger.word else {
        let text = debugger.fault.as_deref().unwrap_or("deriving …");
        return say(
            text,
            areas.word,
            if debugger.fault.is_some() { theme.warning } else { theme.dim },
            buffer,
        );
    };
    head(model, debugger, word, areas.head, buffer);
    let (rest, why) = split(debugger, areas.word);
    if let Some((area, why)) = why {
        say(&why, area, theme.warning, buffer);
    }
    letters(model, debugger, word, rest, buffer);
    // The answer to a key: what is said of the module, and its line with those beside it.
    view.order.first.push(areas.head);
    let line = debugger.line_of(debugger.cursor).saturating_sub(first_line(debugger, rest)) as u16;
    view.answers(rest, rest.y + line);
}

/// `Derivation 3 of 5 · 1 234 modules`, `Derivation 6, past 5`.
fn title(model: &Model, debugger: &Debugger) -> String {
    let last = last_step(model);
    let of = match last {
        Some(last) if debugger.step > last => format!(", past {last}"),
        Some(last) => format!(" of {last}"),
        None => String::new(),
    };
    let count = match &debugger.word {
        Some(word) if word.request.step == debugger.step => {
            format!(" · {} modules", thousands(word.traced.modules.len() as u64))
        }
        Some(_) if debugger.fault.is_none() => " …".to_owned(),
        _ => String::new(),
    };
    format!("Derivation {}{of}{count}", debugger.step)
}

fn say(text: &str, area: Rect, style: Style, buffer: &mut Buffer) {
    for (y, line) in (area.y..area.bottom()).zip(wrapped_within(text, area.width.into(), area.height.into()))
    {
        buffer.set_stringn(area.x, y, line, area.width.into(), style);
    }
}

/// What is said of the module under the cursor.
fn head(model: &Model, debugger: &Debugger, word: &DerivedWord, area: Rect, buffer: &mut Buffer) {
    let theme = &model.config.theme;
    let width = usize::from(area.width);
    let Some(module) = debugger.module().filter(|_| area.height > 0) else {
        return say("the empty word", area, theme.dim, buffer);
    };
    let number = thousands(debugger.cursor as u64 + 1);
    let text = clipped(&module.to_string(), width.saturating_sub(number.width() + 1));
    buffer.set_string(area.x, area.y, &text, theme.accent);
    let x = area.x + text.width() as u16 + 1;
    let room = area.right().saturating_sub(x + number.width() as u16 + 1);
    let length = length_m(&word.traced.modules, debugger.cursor);
    let action = match length {
        Some(length) => format!("{}, {} m", module.action(), metres(f64::from(length))),
        None => module.action().to_owned(),
    };
    if room > 0 {
        buffer.set_string(x, area.y, clipped(&action, room.into()), theme.text);
    }
    buffer.set_stringn(
        area.right().saturating_sub(number.width() as u16).max(area.x),
        area.y,
        &number,
        width,
        theme.dim,
    );
    let came = match (module.rule, module.birth) {
        (Some(_), _) => {
            format!("written by the last step{}", siblings(&word.traced.modules, debugger.cursor))
        }
        (None, 0) => "stands since the axiom".to_owned(),
        (None, birth) => format!("stands since step {birth}"),
    };
    let rule = |rule: Option<u32>, none: &str| match rule {
        Some(rule) => grammar(word)
            .and_then(|grammar| grammar.productions().get(rule as usize))
            .map_or_else(String::new, ToString::to_string),
        None => none.to_owned(),
    };
    let rows = [
        (5, came),
        (3, format!("by    {}", rule(module.rule, "no rule: it was there"))),
        (3, format!("next  {}", rule(module.next_rule, "no rule: it stays"))),
    ];
    let shown = rows.iter().filter(|(from, _)| *from <= area.height);
    for (y, (_, text)) in (area.y + 1..area.bottom()).zip(shown) {
        buffer.set_string(area.x, y, clipped(text, width), theme.dim);
    }
    if area.height == HEADS[0] {
        buffer.set_string(area.x, area.bottom() - 1, "─".repeat(width), theme.border);
    }
}

/// How far the turtle went for a module that draws.
fn length_m(modules: &[TracedModule], module: usize) -> Option<f32> {
    let end = modules[module].at.filter(|_| !modules[module].nodes.is_empty())?;
    Some(end.distance(marks::before(modules, module)))
}

/// `, 2 of 9`: which of its rule's it is.
fn siblings(modules: &[TracedModule], module: usize) -> String {
    let family = family(modules, module);
    format!(", {} of {}", module - family.start + 1, family.len())
}

/// The modules that come from the same one.
fn family(modules: &[TracedModule], module: usize) -> std::ops::Range<usize> {
    let parent = modules[module].parent;
    let from = modules.partition_point(|other| other.parent < parent);
    from..from + modules[from..].partition_point(|other| other.parent == parent)
}

/// The word, in lines.
fn letters(model: &Model, debugger: &Debugger, word: &DerivedWord, area: Rect, buffer: &mut Buffer) {
    let theme = &model.config.theme;
    let modules = &word.traced.modules;
    let kin = match modules.get(debugger.cursor) {
        Some(module) if module.rule.is_some() => family(modules, debugger.cursor),
        _ => 0..0,
    };
    let first = first_line(debugger, area);
    for (y, line) in (area.y..area.bottom()).zip(first..debugger.lines.len()) {
        let mut x = area.x;
        for at in debugger.line(line) {
            let text = short(&modules[at]);
            let is_kin = kin.contains(&at);
            for (i, c) in text.char_indices() {
                let mut style = class_style(i > 0, c, theme);
                if is_kin {
                    style = style.patch(theme.matched);
                }
                if at == debugger.cursor {
                    style = theme.selected;
                }
                if x >= area.right() {
                    break;
                }
                let room = usize::from(area.right() - x);
                (x, _) = buffer.set_stringn(x, y, c.encode_utf8(&mut [0; 4]), room, style);
            }
        }
    }
}
