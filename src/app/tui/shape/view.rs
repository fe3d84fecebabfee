//! The form, painted.

use linden::knob::{Kind, Value};
use linden::preset::{PresetKnob, Section};
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::text::{Line, Span};
use ratatui::widgets::{Paragraph, Widget, Wrap};

use super::{Row, rows, selected};
use crate::tui::around::Purpose;
use crate::tui::frame::{View, clipped};
use crate::tui::model::{Layer, Model, Pane, Target};
use crate::tui::tree::Tree;

/// Rows that explain the selected knob, where there is room.
const ABOUT: u16 = 4;

/// What the pane's border says beside its name.
pub fn heading(model: &Model) -> Vec<Span<'static>> {
    let modified = model.tree.as_ref().is_some_and(Tree::is_modified);
    if modified { vec![Span::styled("● modified ", model.config.theme.modified)] } else { Vec::new() }
}

/// Paints the form.
pub fn view(model: &Model, area: Rect, buffer: &mut Buffer, view: &mut View) {
    let theme = &model.config.theme;
    let Some(tree) = &model.tree else {
        let text = if model.loading.is_some() { "reading …" } else { "choose a preset" };
        buffer.set_stringn(area.x, area.y, text, area.width.into(), theme.dim);
        return;
    };
    let about = if area.height >= 3 * ABOUT { ABOUT } else { 0 };
    let list = Rect { height: area.height - about, ..area };
    let preset = &tree.wanted().preset;
    let rows = rows(preset);
    let chosen = selected(model).map(|(row, _)| row.knob.name);
    let is_chosen = |row: &Row| matches!(row, Row::Knob(own, _) if Some(own.knob.name) == chosen);
    let at = rows.iter().position(is_chosen).unwrap_or(0);
    let first = first_row(at, rows.len(), list.height.into());
    for (y, (i, row)) in (list.y..list.bottom()).zip(rows.iter().enumerate().skip(first)) {
        let place = Rect { y, height: 1, ..list };
        match row {
            Row::Heading(section) => heading_row(model, *section, place, buffer),
            Row::Rule(text) => {
                buffer.set_stringn(
                    place.x + 1,
                    y,
                    clipped(text, usize::from(place.width).saturating_sub(1)),
                    place.width.into(),
                    theme.text,
                );
            }
            Row::Knob(own, value) => {
                view.regions.push((place, Target::Knob(i)));
                knob_row(model, tree, own, value, is_chosen(row), place, buffer, view);
            }
        }
    }
    if about > 0
        && let Some((own, _)) = selected(model)
    {
        let area = Rect { y: list.bottom(), height: about, ..area };
        explain(model, &own, area, buffer);
    }
}

/// The first row that is shown so that the cursor is in sight, with some rows around it.
pub fn first_row(cursor: usize, rows: usize, height: usize) -> usize {
    let most = rows.saturating_sub(height);
    cursor.saturating_sub(height / 2).min(most)
}

fn heading_row(model: &Model, section: Section, area: Rect, buffer: &mut Buffer) {
    let name = match section {
        Section::Tree => "Tree",
        Section::LSystem => "L-system",
        Section::Colonization => "Colonization",
        Section::Wood => "Wood",
        Section::Surface => "Surface",
        Section::Bark => "Bark",
    };
    buffer.set_stringn(area.x, area.y, name, area.width.into(), model.config.theme.heading);
}

#[expect(clippy::too_many_arguments, reason = "a row is painted from everything that there is to it")]
fn knob_row(
    model: &Model,
    tree: &Tree,
    own: &PresetKnob,
    value: &Value,
    chosen: bool,
    area: Rect,
    buffer: &mut Buffer,
    view: &mut View,
) {
    let theme = &model.config.theme;
    let turned = tree.is_turned(own) && !tree.compares;
    let base = match (chosen, model.focus == Pane::Shape) {
        (true, true) => theme.selected,
        (true, false) => theme.selected_unfocused,
        (false, _) => theme.text,
    };
    buffer.set_style(area, base);
    let mark = if turned { "●" } else { " " };
    buffer.set_stringn(area.x, area.y, mark, area.width.into(), base.patch(theme.modified));
    let name_width = (area.width / 2).min(18);
    buffer.set_stringn(
        area.x + 1,
        area.y,
        clipped(own.knob.name, usize::from(name_width)),
        name_width.into(),
        base,
    );
    let x = area.x + 1 + name_width + 1;
    let width = area.right().saturating_sub(x);
    if let Some(Layer::Line(line)) = model.layers.last()
        && chosen
        && matches!(line.purpose, Purpose::Knob(_))
    {
        line.paint(Rect { x, width, ..area }, buffer, view, theme);
        return;
    }
    let unit = if own.knob.unit.is_empty() || matches!(value, Value::Auto | Value::Steps(_)) {
        String::new()
    } else {
        format!(" {}", own.knob.unit)
    };
    let text = clipped(&format!("{value}{unit}"), width.into());
    let style = base.patch(if turned { theme.modified } else { theme.value });
    buffer.set_stringn(x, area.y, text, width.into(), style);
    if let (Kind::Color { .. }, Value::Color([r, g, b])) = (own.knob.kind, value)
        && width > 10
        && model.terminal.colors.value != linden_terminal::ColorDepth::None
    {
        let swatch = ratatui::style::Style::new().bg(ratatui::style::Color::Rgb(*r, *g, *b));
        buffer.set_string(x + 8, area.y, "  ", swatch);
    }
}

/// What the selected knob does, its range, and what is wrong with what is typed.
fn explain(model: &Model, own: &PresetKnob, area: Rect, buffer: &mut Buffer) {
    let theme = &model.config.theme;
    let unit = if own.knob.unit.is_empty() { String::new() } else { format!(" {}", own.knob.unit) };
    let mut lines = vec![
        Line::styled("─".repeat(area.width.into()), theme.border),
        Line::styled(own.knob.help, theme.text),
    ];
    let problem = match model.layers.last() {
        Some(Layer::Line(line)) => line.problem.clone(),
        _ => None,
    };
    match problem.or_else(|| model.tree.as_ref().and_then(|tree| tree.fault.clone())) {
        Some(problem) => lines.push(Line::styled(problem, theme.error)),
        None => lines.push(Line::styled(format!("{}{unit}", own.knob.kind), theme.unit)),
    }
    Paragraph::new(lines).wrap(Wrap { trim: true }).render(area, buffer);
}
