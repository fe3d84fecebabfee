//! The gallery, painted.

use ratatui::buffer::Buffer;
use ratatui::layout::Rect;

use super::Gallery;
use crate::tui::frame::View;
use crate::tui::model::Model;

/// Paints the gallery.
pub fn view(_model: &Model, _gallery: &Gallery, _body: Rect, _buffer: &mut Buffer, _view: &mut View) {}
