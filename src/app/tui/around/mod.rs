//! What is around the tree: help, the palette, typed lines, messages, carrying on elsewhere, leaving.

mod commands;
pub mod footer;
mod line;
mod page;
mod palette;
pub mod view;
mod yank;

use linden_terminal::input::{Key, Mouse, MouseAction};

pub use commands::COMMANDS;
pub use line::{Line, Purpose, edit, paint, paste};
pub use page::{Page, PageLine};
pub use palette::{Palette, refresh};

use super::effect::Effects;
use super::model::{Layer, Model};

/// Rows of a page that the wheel scrolls by.
const WHEEL: isize = 3;

/// A key that means no command, while a line is typed.
pub fn typed(model: &mut Model, key: Key, effects: &mut Effects) {
    match model.layers.last_mut() {
        Some(Layer::Line(line)) => {
            let has_changed = line.typed(key);
            if has_changed {
                line::changed(model, effects);
            }
        }
        Some(Layer::Palette(palette)) => palette.typed(key),
        _ => {}
    }
}

/// Pasted text, while a line is typed: as one line.
pub fn pasted(model: &mut Model, text: &str, effects: &mut Effects) {
    match model.layers.last_mut() {
        Some(Layer::Line(line)) => {
            line.pasted(text);
            line::changed(model, effects);
        }
        Some(Layer::Palette(palette)) => palette.pasted(text),
        _ => {}
    }
}

/// The wheel over a dialog: scrolls a page, moves in the palette.
pub fn wheel(model: &mut Model, mouse: Mouse) {
    let by = match mouse.action {
        MouseAction::WheelUp => -WHEEL,
        MouseAction::WheelDown => WHEEL,
        _ => return,
    };
    let body = super::frame::dialog_body(model);
    match model.layers.last_mut() {
        Some(Layer::Page(page)) => page.scroll_by(by, body),
        Some(Layer::Palette(_)) => palette::wheel(model, mouse),
        _ => {}
    }
}

/// The mouse on a row of the palette.
pub fn clicked(model: &mut Model, row: usize, mouse: Mouse, effects: &mut Effects) {
    palette::clicked(model, row, mouse, effects);
}
