//! The list of presets, painted.

use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::text::Line as TextLine;
use ratatui::widgets::{Paragraph, Widget, Wrap};
use unicode_width::UnicodeWidthStr;

use super::{Entry, Row};
use crate::tui::around::Purpose;
use crate::tui::frame::{View, clipped};
use crate::tui::model::{Layer, Model, Pane, Target};
use crate::tui::shape::view::first_row;

/// Rows that tell about the selected preset, where there is room.
const ABOUT: u16 = 6;

/// Paints the list.
pub fn view(model: &Model, mut area: Rect, buffer: &mut Buffer, view: &mut View) {
    let theme = &model.config.theme;
    if area.is_empty() {
        return;
    }
    let library = &model.library;
    let typed = match model.layers.last() {
        Some(Layer::Line(line)) if matches!(line.purpose, Purpose::Filter { .. }) => Some(line),
        _ => None,
    };
    if typed.is_some() || !library.filter.is_empty() {
        let row = Rect { height: 1, ..area };
        buffer.set_stringn(row.x, row.y, "/", row.width.into(), theme.key);
        let rest = Rect { x: row.x + 1, width: row.width - 1, ..row };
        match typed {
            Some(line) => line.paint(rest, buffer, view, theme),
            None => {
                buffer.set_stringn(
                    rest.x,
                    rest.y,
                    clipped(&library.filter, rest.width.into()),
                    rest.width.into(),
                    theme.accent,
                );
            }
        }
        area.y += 1;
        area.height -= 1;
    }
    let about = if area.height >= 3 * ABOUT { ABOUT } else { 0 };
    let list = Rect { height: area.height - about, ..area };
    if library.rows().is_empty() {
        buffer.set_stringn(list.x, list.y, "nothing matches", list.width.into(), theme.dim);
    }
    let cursor = library.selected_row();
    let first = first_row(cursor.unwrap_or(0), library.rows().len(), list.height.into());
    for (y, (i, row)) in (list.y..list.bottom()).zip(library.rows().iter().enumerate().skip(first)) {
        let place = Rect { y, height: 1, ..list };
        match row {
            Row::Heading(group) => {
                buffer.set_stringn(
                    place.x,
                    y,
                    clipped(&title(group), place.width.into()),
                    place.width.into(),
                    theme.heading,
                );
            }
            Row::Entry(index, marks) => {
                view.regions.push((place, Target::Preset(i)));
                entry_row(model, library.get(*index), marks, cursor == Some(i), place, buffer);
            }
        }
    }
    if about > 0
        && let Some(entry) = library.entry()
    {
        tell(model, entry, Rect { y: list.bottom(), height: about, ..area }, buffer);
    }
}

/// A group as a heading.
fn title(group: &str) -> String {
    match group {
        "abop" => "The Algorithmic Beauty of Plants".to_owned(),
        "crowns" => "Crowns".to_owned(),
        "older" => "Older trees".to_owned(),
        "species" => "Species".to_owned(),
        "yours" => "Yours".to_owned(),
        "opened" => "Opened".to_owned(),
        other => other.to_owned(),
    }
}

fn entry_row(model: &Model, entry: &Entry, marks: &[u32], chosen: bool, area: Rect, buffer: &mut Buffer) {
    let theme = &model.config.theme;
    let base = match (chosen, model.focus == Pane::Presets) {
        (true, true) => theme.selected,
        (true, false) => theme.selected_unfocused,
        (false, _) => theme.text,
    };
    buffer.set_style(area, base);
    let is_shown = model.tree.as_ref().is_some_and(|tree| tree.place == entry.place);
    let is_modified = model.library.is_shelved(&entry.place)
        || (is_shown && model.tree.as_ref().is_some_and(crate::tui::tree::Tree::is_modified));
    let (mark, style) = if entry.fault.is_some() {
        ("!", theme.error)
    } else if is_modified {
        ("●", theme.modified)
    } else {
        (" ", base)
    };
    buffer.set_stringn(area.x, area.y, mark, area.width.into(), base.patch(style));
    let room = usize::from(area.width).saturating_sub(2);
    let id = clipped(&entry.id, room);
    buffer.set_stringn(area.x + 2, area.y, &id, room, base);
    // What was filtered by is shown letter by letter; ids with escapes in them are not marked.
    if id == entry.id {
        for &mark in marks {
            if let Some(cell) = buffer.cell_mut((area.x + 2 + mark as u16, area.y))
                && (mark as usize) < room
            {
                cell.set_style(base.patch(theme.matched));
            }
        }
    }
    let left = room.saturating_sub(id.width() + 2);
    if left >= 8 && !entry.name.is_empty() {
        let name = clipped(&entry.name, left);
        let x = area.right() - name.width() as u16;
        buffer.set_stringn(x, area.y, name, left, if chosen { base } else { theme.dim });
    }
}

/// What the selected preset is and where it comes from.
fn tell(model: &Model, entry: &Entry, area: Rect, buffer: &mut Buffer) {
    let theme = &model.config.theme;
    let safe = |text: &str| linden::knob::printable(text);
    let mut lines = vec![TextLine::styled("─".repeat(area.width.into()), theme.border)];
    if let Some(fault) = &entry.fault {
        lines.push(TextLine::styled(safe(fault), theme.error));
    } else {
        lines.push(TextLine::styled(safe(&entry.summary), theme.text));
        lines.push(TextLine::styled(safe(&entry.source), theme.dim));
    }
    Paragraph::new(lines).wrap(Wrap { trim: true }).render(area, buffer);
}
