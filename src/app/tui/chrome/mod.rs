//! What frames the panes, whatever tree is on screen: the footer, the palette, pages of help and messages,
//! the box of dialogs, lines that are typed, leaving.

mod commands;
pub mod footer;
mod page;
mod palette;
pub mod popup;
pub mod prompt;
mod yank;

pub use commands::COMMANDS;
pub use page::{Page, PageLine};
