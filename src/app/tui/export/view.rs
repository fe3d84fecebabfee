//! The export dialog, painted.

use ratatui::buffer::Buffer;
use ratatui::layout::Rect;

use super::ExportDialog;
use crate::tui::frame::View;
use crate::tui::model::Model;

/// Paints the dialog.
pub fn view(_model: &Model, _dialog: &ExportDialog, _body: Rect, _buffer: &mut Buffer, _view: &mut View) {}
