//! The box of a dialog with its title, and the mark of how far a list is scrolled.

use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::text::Span;
use ratatui::widgets::{Block, BorderType, Widget};

use crate::tui::layout::{Target, View, inside};
use crate::tui::model::Model;

/// Paints a dialog's box with its title; gives the inside. What lies below it is not meant by the mouse.
pub fn popup(model: &Model, title: &str, area: Rect, buffer: &mut Buffer, view: &mut View) -> Rect {
    let theme = &model.config.theme;
    view.regions.push((Rect::new(0, 0, model.size.0, model.size.1), Target::Dialog(None)));
    ratatui::widgets::Clear.render(area, buffer);
    buffer.set_style(area, theme.popup);
    let inner = inside(area);
    if inner != area {
        Block::bordered()
            .border_type(BorderType::Rounded)
            .border_style(theme.popup_border)
            .title(Span::styled(format!(" {title} "), theme.popup_title))
            .render(area, buffer);
    }
    inner
}

/// Where a list is scrolled to, on its right border.
pub fn scrollbar(model: &Model, bar: Rect, first: usize, rows: usize, buffer: &mut Buffer) {
    let (height, shown) = (usize::from(bar.height), usize::from(bar.height).min(rows));
    if rows == 0 || height == 0 {
        return;
    }
    let thumb = (height * shown / rows).clamp(1, height);
    let most = rows - shown;
    let from = ((height - thumb) * first.min(most)).checked_div(most).unwrap_or(0);
    for y in from..from + thumb {
        buffer.set_string(bar.x, bar.y + y as u16, "┃", model.config.theme.scrollbar);
    }
}
