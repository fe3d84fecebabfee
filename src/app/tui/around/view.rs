//! Dialogs around the tree, painted.

use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::text::{Line as TextLine, Span};
use ratatui::widgets::{Paragraph, Widget, Wrap};
use unicode_width::UnicodeWidthStr;

use super::line::{self, Line, Purpose};
use super::page::{Page, PageLine};
use super::palette::Palette;
use crate::tui::frame::{View, centered, clipped, dialog, key_label};
use crate::tui::model::{Model, Target, Weight};

/// Columns of the keys on the page of help.
const KEYS: usize = 18;

/// A page of text.
pub fn page(model: &Model, page: &Page, body: Rect, buffer: &mut Buffer, view: &mut View) {
    let theme = &model.config.theme;
    let area = centered(100, body.height.saturating_sub(2).max(body.height.min(6)), body);
    let area = dialog(model, page.title, area, buffer, view);
    let mut lines = Vec::new();
    let most = page.lines.len().saturating_sub(area.height.into());
    for own in page.lines.iter().skip(page.scroll.min(most)) {
        lines.push(match own {
            PageLine::Heading(text) => TextLine::styled(text.clone(), theme.heading),
            PageLine::Keys(keys, text) => {
                let pad = KEYS.saturating_sub(keys.width()).max(1);
                TextLine::from(vec![
                    Span::styled(format!("  {keys}"), theme.key),
                    Span::raw(" ".repeat(pad)),
                    Span::styled(text.clone(), theme.text),
                ])
            }
            PageLine::Text(weight, text) => TextLine::styled(
                text.clone(),
                match weight {
                    Weight::Note => theme.text,
                    Weight::Warning => theme.warning,
                    Weight::Error => theme.error,
                },
            ),
        });
    }
    Paragraph::new(lines).wrap(Wrap { trim: false }).render(area, buffer);
}

/// The palette.
pub fn palette(model: &Model, palette: &Palette, body: Rect, buffer: &mut Buffer, view: &mut View) {
    let theme = &model.config.theme;
    let mut area = centered(76, body.height.saturating_sub(4).clamp(body.height.min(5), 22), body);
    area.y = body.y + (body.height / 8).min(body.height - area.height);
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
    let first = crate::tui::shape::view::first_row(palette.selected, found.len(), list.height.into());
    for (y, (i, command)) in (list.y..list.bottom()).zip(found.iter().enumerate().skip(first)) {
        let row = Rect { y, height: 1, ..list };
        view.regions.push((row, Target::PaletteRow(i)));
        // Judged where it would run: below the palette.
        let hindrance = (command.hindrance)(model);
        let base = match (i == palette.selected, &hindrance) {
            (true, _) => theme.selected,
            (false, Some(_)) => theme.disabled,
            (false, None) => theme.text,
        };
        buffer.set_style(row, base);
        let keys: Vec<_> = model
            .config
            .keymap
            .keys_of(command.id)
            .iter()
            .take(2)
            .map(|key| key_label(&key.to_string()))
            .collect();
        let keys = keys.join(" ");
        let about = hindrance.unwrap_or_else(|| command.help.to_owned());
        let name = format!(" {:<22}", command.title);
        let room = usize::from(row.width).saturating_sub(name.width() + keys.width() + 2);
        let text = format!("{name}{}", clipped(&about, room));
        buffer.set_stringn(row.x, y, text, row.width.into(), base);
        let width = (keys.width() as u16).min(row.width);
        buffer.set_stringn(row.right() - width, y, &keys, width.into(), base.patch(theme.key));
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
