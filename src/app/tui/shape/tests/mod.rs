//! The room's commands through its keys, its views, and what undo promises.

mod editor;
mod finding;
mod history;
mod knobs;
mod painting;

use std::sync::Arc;

use crossterm::event::Event;
use proptest::prelude::*;
use ratatui::style::Modifier;

use super::*;
use crate::tui::layout::Target;
use crate::tui::testing::form::{FormBench, text};
use crate::tui::update::Msg;

/// The cell where the text is wrong.
fn underlined(buffer: &ratatui::buffer::Buffer) -> Option<(u16, u16)> {
    let area = buffer.area;
    let mut cells = (0..area.height).flat_map(|y| (0..area.width).map(move |x| (x, y)));
    let is_wrong =
        |&(x, y): &(u16, u16)| buffer[(x, y)].modifier.contains(Modifier::UNDERLINED | Modifier::BOLD);
    cells.rfind(is_wrong)
}
