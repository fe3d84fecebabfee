//! The form of a forest, painted: its kinds of trees, and the knobs that lay them out.

use linden::forest::{Forest, ForestKind};
use linden::knob::{Kind, Value};
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::text::{Line, Span};
use ratatui::widgets::{Paragraph, Widget, Wrap};
use unicode_width::UnicodeWidthStr;

use super::{ForestOnScreen, selected};
use crate::tui::layout::{Pane, Target, View, first_row};
use crate::tui::model::Model;
use crate::tui::shape::value::ValueLine;
use crate::wrap::clipped;

/// Columns of a knob's name.
const NAME: u16 = 18;
/// Rows that explain what the cursor is on, where there is room.
const ABOUT: u16 = 4;
/// The mark of what differs from the document.
const TURNED: &str = "●";

/// Paints the form.
pub fn view(model: &Model, forest: &ForestOnScreen, area: Rect, buffer: &mut Buffer, view: &mut View) {
    let theme = &model.config.theme;
    let about = if area.height >= 12 { ABOUT } else { 0 };
    let list = Rect { height: area.height - about, ..area };
    let wanted = forest.wanted();
    let chosen = selected(model).map(|(knob, _)| knob.name);
    let knobs: Vec<_> = wanted.layout.knobs().collect();
    let at = knobs.iter().position(|(row, _)| Some(row.knob.name) == chosen).unwrap_or(0);
    let first = first_row(at, knobs.len(), list.height.into());
    let rows = knobs.iter().enumerate().skip(first);
    let mut y = list.y;
    for ((i, (row, value)), at_y) in rows.zip(list.y..list.bottom()) {
        y = at_y + 1;
        let place = Rect { y: at_y, height: 1, ..list };
        view.regions.push((place, Target::Knob(i)));
        let is_chosen = i == at;
        if is_chosen {
            view.answers(list, at_y);
        }
        let base = match (is_chosen, model.focus == Pane::Shape) {
            (true, true) => theme.selected,
            (true, false) => theme.selected_unfocused,
            (false, _) => theme.text,
        };
        buffer.set_style(place, base);
        let mark = if forest.is_turned(row.knob.name) { TURNED } else { " " };
        buffer.set_stringn(place.x, at_y, mark, place.width.into(), base.patch(theme.modified));
        let name_width = (place.width / 2).min(NAME);
        let name = clipped(row.knob.name, name_width.into());
        buffer.set_stringn(place.x + 1, at_y, name, name_width.into(), base);
        let x = place.x + 2 + name_width;
        let field = Rect { x, width: place.right().saturating_sub(x), ..place };
        match model.dialogs.top::<ValueLine>().filter(|line| line.knob == row.knob.name) {
            Some(line) => {
                view.regions.push((place, Target::Dialog(None)));
                line.prompt.paint(field, buffer, view, theme);
            }
            None => {
                let text = with_unit(value, row.knob.unit);
                let text = clipped(&text, field.width.into());
                buffer.set_stringn(field.x, at_y, text, field.width.into(), base.patch(theme.value));
            }
        }
    }
    kinds(model, wanted, Rect { y, height: list.bottom().saturating_sub(y), ..list }, buffer);
    explain(model, forest, Rect { y: list.bottom(), height: about, ..area }, buffer);
}

/// The kinds of trees with their shares, below the knobs where there is room.
fn kinds(model: &Model, forest: &Forest, area: Rect, buffer: &mut Buffer) {
    let theme = &model.config.theme;
    if area.height < 2 {
        return;
    }
    buffer.set_stringn(area.x, area.y, "Trees", area.width.into(), theme.heading);
    let all: f64 = forest.kinds.iter().map(|kind| kind.share).sum();
    for (kind, y) in forest.kinds.iter().zip(area.y + 1..area.bottom()) {
        let ForestKind { recipe, share, size } = kind;
        let size = if (size - 1.0).abs() > f64::EPSILON { format!(" × {size}") } else { String::new() };
        let share = format!("{:.0} %{size}", share / all * 100.0);
        let name_width = (area.width / 2).min(NAME);
        let name = clipped(&recipe.preset.id, name_width.into());
        buffer.set_stringn(area.x + 1, y, name, name_width.into(), theme.text);
        let x = area.x + 2 + name_width;
        let room = area.right().saturating_sub(x);
        buffer.set_stringn(x, y, clipped(&share, room.into()), room.into(), theme.value);
    }
}

/// What the chosen knob is, and what it takes.
fn explain(model: &Model, forest: &ForestOnScreen, area: Rect, buffer: &mut Buffer) {
    let theme = &model.config.theme;
    let Some((knob, _)) = selected(model).filter(|_| !area.is_empty()) else { return };
    let rule = format!("─ {} ", knob.name);
    let rest = usize::from(area.width).saturating_sub(rule.width());
    buffer.set_stringn(area.x, area.y, rule + &"─".repeat(rest), area.width.into(), theme.border);
    let problem = model.dialogs.top::<ValueLine>().and_then(|line| line.prompt.problem.clone());
    let range = match knob.kind {
        Kind::Integer { max: u64::MAX, .. } => "any whole number from 0".to_owned(),
        kind if knob.unit.is_empty() => kind.to_string(),
        kind => format!("{kind} ({})", knob.unit),
    };
    let mut range = vec![Span::styled(range, theme.unit)];
    if let Some(saved) = forest.saved_value(knob.name).filter(|_| forest.is_turned(knob.name)) {
        range.push(Span::styled(format!(" · saved: {}", with_unit(&saved, knob.unit)), theme.modified));
    }
    let lines = match problem {
        Some(problem) => vec![Line::styled(problem, theme.error)],
        None => vec![Line::styled(knob.help, theme.text), Line::from(range)],
    };
    let below = Rect { y: area.y + 1, height: area.height - 1, ..area };
    Paragraph::new(lines).wrap(Wrap { trim: true }).render(below, buffer);
}

fn with_unit(value: &Value, unit: &str) -> String {
    match value {
        Value::Real(_) if !unit.is_empty() => format!("{value} {unit}"),
        _ => value.to_string(),
    }
}
