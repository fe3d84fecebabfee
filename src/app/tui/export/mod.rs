//! The export dialog, and the export that runs while one goes on.

pub mod view;

use linden_terminal::input::{Key, Mouse};
use ratatui::text::Span;

use super::command::Command;
use super::effect::Effects;
use super::model::Model;

/// What the dialog offers.
pub struct ExportDialog {}

/// The export under way.
#[derive(Debug, Default)]
pub struct Exporting {}

/// What to export.
#[derive(Debug)]
pub struct ExportOrder {}

/// What an export says.
#[derive(Debug)]
pub enum ExportNews {}

/// What the footer says of the export under way.
pub fn status(_model: &Model) -> Vec<Span<'static>> {
    Vec::new()
}

/// An export's progress or end.
pub fn news(_model: &mut Model, _news: ExportNews) {}

/// A key for the dialog's line.
pub fn typed(_model: &mut Model, _key: Key, _effects: &mut Effects) {}

/// Pasted text for the dialog's line.
pub fn pasted(_model: &mut Model, _text: &str) {}

/// The mouse on a row.
pub fn clicked(_model: &mut Model, _row: usize, _mouse: Mouse, _effects: &mut Effects) {}

/// The rows of this room.
pub const COMMANDS: &[Command] = &[];
