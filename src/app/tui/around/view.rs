//! Dialogs around the tree, painted.

use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::widgets::{Clear, Widget as _};
use unicode_width::UnicodeWidthStr;

use super::footer::key_label;
use super::line::{self, Line, Purpose};
use super::page::{Page, PageLine};
use super::palette::{Found, Palette};
use crate::tui::frame::{View, centered, clipped, dialog};
use crate::tui::model::{Model, Target, Weight};

/// Cells of a command's name in the palette.
const NAME: usize = 22;

/// A page of text.
pub fn page(model: &Model, page: &Page, body: Rect, buffer: &mut Buffer, view: &mut View) {
    let theme = &model.config.theme;
    let laid = page.lay(body);
    let area = dialog(model, page.title, laid.area, buffer, view);
    let first = page.scroll.min(laid.most_scroll());
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

/// Where a list is scrolled to, on its right border.
pub fn scrollbar(model: &Model, bar: Rect, first: usize, rows: usize, buffer: &mut Buffer) {
    let (height, shown) = (usize::from(bar.height), usize::from(bar.height).min(rows));
    if rows == 0 || height == 0 {
        return;
    }
    let thumb = (height * shown / rows).clamp(1, height);
    let most = rows - shown;
    let from = if most == 0 { 0 } else { (height - thumb) * first.min(most) / most };
    for y in from..from + thumb {
        buffer.set_string(bar.x, bar.y + y as u16, "┃", model.config.theme.scrollbar);
    }
}

/// The palette.
pub fn palette(model: &Model, palette: &Palette, body: Rect, buffer: &mut Buffer, view: &mut View) {
    let theme = &model.config.theme;
    let mut area = centered(86, body.height.saturating_sub(2).clamp(body.height.min(5), 24), body);
    area.y = body.y + (body.height / 8).min(body.height - area.height);
    let outer = area;
    let area = dialog(model, "Commands", area, buffer, view);
    if area.is_empty() {
        return;
    }
    buffer.set_stringn(area.x, area.y, ": ", area.width.into(), theme.key);
    let input =
        Rect { x: area.x + 2.min(area.width), width: area.width.saturating_sub(2), height: 1, ..area };
    line::paint(&palette.input, input, buffer, view, theme);
    let found = palette.found();
    let list = Rect { y: area.y + 1, height: area.height - 1, ..area };
    if found.is_empty() && !list.is_empty() {
        buffer.set_stringn(list.x, list.y, " nothing matches", list.width.into(), theme.popup_dim);
    }
    let first = crate::tui::shape::view::first_row(palette.selected, found.len(), list.height.into());
    for (y, (i, own)) in (list.y..list.bottom()).zip(found.iter().enumerate().skip(first)) {
        let row = Rect { y, height: 1, ..list };
        view.regions.push((row, Target::PaletteRow(i)));
        palette_row(model, own, i == palette.selected, row, buffer);
    }
    if outer != area && found.len() > list.height.into() {
        scrollbar(model, Rect { x: list.right(), width: 1, ..list }, first, found.len(), buffer);
    }
}

/// A command, what it does or why it cannot be used, and its keys.
fn palette_row(model: &Model, own: &Found<'_>, chosen: bool, row: Rect, buffer: &mut Buffer) {
    let theme = &model.config.theme;
    let can_be_used = own.hindrance.is_none();
    let base = if chosen { theme.selected } else { theme.popup };
    let dimmed = |style| if chosen { base } else { theme.popup.patch(style) };
    buffer.set_style(row, base);
    let width = usize::from(row.width);
    let name = if can_be_used { base } else { base.patch(theme.disabled) };
    buffer.set_stringn(row.x + 1, row.y, own.command.title, width.saturating_sub(1), name);
    for &mark in &own.marks {
        if let Some(cell) = buffer.cell_mut((row.x + 1 + mark as u16, row.y))
            && (mark as usize) + 1 < width
        {
            cell.set_style(theme.matched);
        }
    }
    let keys: Vec<_> = model
        .config
        .keymap
        .keys_of(own.command.id)
        .iter()
        .take(2)
        .map(|key| key_label(&key.to_string()))
        .collect();
    let keys = keys.join(" ");
    let about = own.hindrance.unwrap_or(own.command.help);
    let style = dimmed(if can_be_used { theme.popup_dim } else { theme.warning });
    let from = NAME + 2;
    let room = width.saturating_sub(from + keys.width() + 2);
    if room >= 8 {
        buffer.set_stringn(row.x + from as u16, row.y, clipped(about, room), room, style);
    }
    let wide = keys.width() as u16 + 1;
    if usize::from(wide) + own.command.title.width() + 2 <= width {
        buffer.set_stringn(row.right() - wide, row.y, &keys, width, dimmed(theme.key));
    }
}

/// A line that is typed and has no place of its own: at the bottom. (A filter is painted by the
/// list, a value by the form.)
pub fn line(model: &Model, line: &Line, body: Rect, buffer: &mut Buffer, view: &mut View) {
    let theme = &model.config.theme;
    let has_place = match line.purpose {
        Purpose::Filter { .. } | Purpose::Knob(_) => view.cursor.is_some(),
        Purpose::SaveAs | Purpose::Replace(_) => false,
    };
    if has_place || body.is_empty() {
        return;
    }
    let row = Rect { y: body.bottom() - 1, height: 1, ..body };
    let label = clipped(&format!(" {}: ", line.label()), usize::from(body.width).saturating_sub(4));
    Clear.render(row, buffer);
    buffer.set_style(row, theme.input);
    buffer.set_stringn(row.x, row.y, &label, row.width.into(), theme.key);
    let x = row.x + label.width() as u16;
    line.paint(Rect { x, width: row.right().saturating_sub(x), ..row }, buffer, view, theme);
    if let Some((is_problem, remark)) = line::remark(model, line)
        && body.height >= 2
    {
        let above = Rect { y: row.y - 1, ..row };
        let style = theme.popup.patch(if is_problem { theme.warning } else { theme.dim });
        ratatui::widgets::Clear.render(above, buffer);
        buffer.set_style(above, style);
        let text = clipped(&format!(" {remark}"), above.width.into());
        buffer.set_stringn(above.x, above.y, text, above.width.into(), style);
    }
}
