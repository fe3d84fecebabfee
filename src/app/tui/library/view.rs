//! The list of presets, painted.

use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::style::Style;
use ratatui::text::Span;
use unicode_width::UnicodeWidthStr;

use super::filter_line::FilterLine;
use crate::tui::layout::{Pane, Target, View, first_row};
use crate::tui::model::Model;
use crate::tui::model::{GroupHeading, ID_COLUMNS, ListRow, PresetEntry};
use crate::wrap::{clipped, wrapped, wrapped_within};

/// The most rows that tell about the selected preset, and the height that it takes for them.
const ABOUT: u16 = 9;
const WITH_ABOUT: u16 = 16;

/// What the pane's heading says beside its name: how many a filter leaves.
pub fn heading(model: &Model) -> Vec<Span<'static>> {
    let library = &model.library;
    if library.filter.trim().is_empty() {
        return Vec::new();
    }
    let found = library.rows().iter().filter(|row| matches!(row, ListRow::Entry(..))).count();
    vec![Span::styled(format!("{found} of {} ", library.len()), model.config.theme.dim)]
}

/// Paints the list.
pub fn view(model: &Model, mut area: Rect, buffer: &mut Buffer, view: &mut View) {
    let theme = &model.config.theme;
    if area.is_empty() {
        return;
    }
    let library = &model.library;
    let typed = model.dialogs.top::<FilterLine>();
    if typed.is_some() || !library.filter.is_empty() {
        let row = Rect { height: 1, ..area };
        buffer.set_stringn(row.x, row.y, "/", row.width.into(), theme.key);
        let rest = Rect { x: row.x + 1, width: row.width - 1, ..row };
        match typed {
            Some(line) => line.prompt.paint(rest, buffer, view, theme),
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
    let about = about(model, area);
    let height = about.len() as u16;
    let list = Rect { height: area.height - height, ..area };
    if library.rows().is_empty() && !list.is_empty() {
        buffer.set_stringn(list.x, list.y, "nothing matches", list.width.into(), theme.dim);
    }
    let cursor = library.selected_row();
    let rows = library.rows();
    let headings = rows.iter().filter(|row| matches!(row, ListRow::Heading(_))).count();
    // Where all of it has room, groups stand apart.
    let air = u16::from(rows.len() + headings <= usize::from(list.height));
    let (at, height) = (cursor.unwrap_or(0), usize::from(list.height));
    // Since the mouse was used only what is out of sight moves it.
    let first = match library.top {
        Some(top) => top.min(rows.len().saturating_sub(height)).max((at + 1).saturating_sub(height)).min(at),
        None => first_row(at, rows.len(), height),
    };
    let mut y = list.y;
    for (i, row) in rows.iter().enumerate().skip(first) {
        if i > 0 && matches!(row, ListRow::Heading(_)) {
            y += air;
        }
        if y >= list.bottom() {
            break;
        }
        let place = Rect { y, height: 1, ..list };
        if cursor == Some(i) {
            view.answers(list, y);
        }
        match row {
            ListRow::Heading(heading) => {
                view.regions.push((place, Target::Preset(i)));
                heading_row(model, heading, cursor == Some(i), place, buffer);
            }
            ListRow::Entry(index, marks) => {
                view.regions.push((place, Target::Preset(i)));
                entry_row(model, library.get(*index), marks, cursor == Some(i), place, buffer);
            }
        }
        y += 1;
    }
    for (y, (text, style)) in (list.bottom()..area.bottom()).zip(about) {
        buffer.set_stringn(area.x, y, text, area.width.into(), style);
    }
}

fn heading_row(model: &Model, heading: &GroupHeading, chosen: bool, area: Rect, buffer: &mut Buffer) {
    let theme = &model.config.theme;
    let base = match (chosen, model.focus == Pane::Presets) {
        (true, true) => theme.selected,
        (true, false) => theme.selected_unfocused,
        (false, _) => theme.heading,
    };
    if chosen {
        buffer.set_style(area, base);
    }
    let count = if heading.is_folded { format!(" ({})", heading.members) } else { String::new() };
    let mark = if heading.is_folded { "▸ " } else { "" };
    let room = usize::from(area.width).saturating_sub(count.width() + mark.width());
    let text = format!("{mark}{}{count}", clipped(title(&heading.group, room), room));
    buffer.set_stringn(area.x, area.y, text, area.width.into(), base);
}

/// A group as a heading.
fn title(group: &str, width: usize) -> &str {
    match group {
        "abop" if width >= 28 => "Algorithmic Beauty of Plants",
        "abop" => "ABOP",
        "crowns" => "Crowns",
        "older" => "Older trees",
        "species" => "Species",
        "yours" => "Yours",
        "opened" => "Opened",
        other => other,
    }
}

fn entry_row(
    model: &Model,
    entry: &PresetEntry,
    marks: &[u32],
    chosen: bool,
    area: Rect,
    buffer: &mut Buffer,
) {
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
        (if model.library.is_favourite(entry) { "★" } else { " " }, base.patch(theme.accent))
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
    let from = ID_COLUMNS.max(id.width()) + 2;
    let left = room.saturating_sub(from);
    let fits = entry.name.width() <= left || (from == ID_COLUMNS + 2 && left >= 8);
    if entry.says_more() && fits {
        let style = if chosen { base } else { theme.dim };
        buffer.set_stringn(area.x + 2 + from as u16, area.y, clipped(&entry.name, left), left, style);
    }
    // Tags stand behind, where all of that has room.
    let tags = model.library.tags_of(entry);
    let used = from + if entry.says_more() { entry.name.width() + 2 } else { 0 };
    let tags = if tags.is_empty() { String::new() } else { format!("#{}", tags.join(" #")) };
    if !tags.is_empty() && room > used + tags.width() {
        let style = if chosen { base } else { theme.info };
        buffer.set_stringn(area.x + 2 + used as u16, area.y, &tags, room - used, style);
    }
}

/// What the selected preset is and where it comes from, as rows; none where there is no room.
fn about(model: &Model, area: Rect) -> Vec<(String, Style)> {
    let theme = &model.config.theme;
    let Some(entry) = model.library.entry().filter(|_| area.height >= WITH_ABOUT) else { return Vec::new() };
    let width = usize::from(area.width);
    let most = usize::from((area.height / 3).min(ABOUT));
    let mut rows = vec![("─".repeat(width), theme.border)];
    if let Some(fault) = &entry.fault {
        rows.extend(wrapped_within(fault, width, most - 1).into_iter().map(|row| (row, theme.error)));
        return rows;
    }
    let name = if entry.name.is_empty() { &entry.id } else { &entry.name };
    rows.push((clipped(name, width), theme.accent));
    let tags = model.library.tags_of(entry);
    if !tags.is_empty() && most > rows.len() + 1 {
        rows.push((clipped(&format!("#{}", tags.join(" #")), width), theme.info));
    }
    let left = most - rows.len();
    let source = if entry.source.is_empty() { Vec::new() } else { wrapped(&entry.source, width) };
    // The source may take what the summary leaves, and a third of the room in any case.
    let summary = wrapped_within(&entry.summary, width, left - source.len().min(left / 3));
    let source_rows = left - summary.len();
    rows.extend(summary.into_iter().map(|row| (row, theme.text)));
    if !source.is_empty() && source_rows > 0 {
        rows.extend(
            wrapped_within(&entry.source, width, source_rows).into_iter().map(|row| (row, theme.dim)),
        );
    }
    rows
}

#[cfg(test)]
mod tests {
    use crate::tui::testing::Bench;

    #[test]
    fn a_filter_that_matches_nothing_bears_every_height() {
        for rows in 1..8 {
            for open in ["/", ":"] {
                let mut bench = Bench::new(20, rows).without_pictures();
                bench.keys(open).types("zzqx");
            }
        }
    }
}
