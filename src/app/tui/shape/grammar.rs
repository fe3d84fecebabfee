//! The grammar as text, edited in place or in `$EDITOR`.

use linden::lsystem::Grammar;
use linden_terminal::input::Key;
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;

use crate::tui::frame::View;
use crate::tui::model::Model;

/// The grammar's editor.
pub struct GrammarEditor {}

/// The grammar, a line each: the axiom, then the productions.
pub fn lines(_grammar: &Grammar) -> Vec<String> {
    Vec::new()
}

/// A key for the editor.
pub fn typed(_model: &mut Model, _key: Key) {}

/// Pasted text for the editor.
pub fn pasted(_model: &mut Model, _text: &str) {}

/// Takes an edited grammar.
pub fn take_text(_model: &mut Model, _text: &str) {}

/// Paints the editor.
pub fn view(_model: &Model, _editor: &GrammarEditor, _body: Rect, _buffer: &mut Buffer, _view: &mut View) {}
