//! The bar to scrub, in the rule above the picture.

use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use unicode_width::UnicodeWidthStr;

use super::{last_step, shown, younger};
use crate::tui::layout::{Target, View};
use crate::tui::model::Model;

/// Paints the bar into a row; nothing while the grown tree is on screen.
pub fn view(model: &Model, row: Rect, buffer: &mut Buffer, view: &mut View) {
    let (Some(step), Some(tree), Some((on_screen, _))) = (model.growth.step(), shown(model), younger(model))
    else {
        return;
    };
    if row.is_empty() {
        return;
    }
    let theme = &model.config.theme;
    let last = last_step(tree);
    let mark = if model.growth.is_playing() { "▶" } else { "‖" };
    let text = format!(" {mark} {on_screen} ");
    let width = text.width() as u16;
    if width > row.width {
        return;
    }
    buffer.set_string(row.x, row.y, &text, theme.busy);
    let rest = Rect { x: row.x + width, width: row.width - width, ..row };
    if rest.width < 6 {
        return;
    }
    let done = (u64::from(rest.width) * u64::from(step) / u64::from(last.max(1))) as u16;
    for x in 0..rest.width {
        let (symbol, style) = if x < done { ("━", theme.gauge) } else { ("─", theme.gauge_track) };
        buffer.set_string(rest.x + x, rest.y, symbol, style);
        let at = u64::from(last) * u64::from(x) / u64::from(rest.width.max(1));
        view.regions.push((Rect { x: rest.x + x, width: 1, ..rest }, Target::Growth(at as u32)));
    }
}
