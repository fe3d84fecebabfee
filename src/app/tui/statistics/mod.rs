//! The numbers of the tree on screen, on a page.

mod commands;
mod page;

use std::sync::Arc;

pub use commands::COMMANDS;

use super::chrome::Page;
use super::model::Model;
use crate::jobs::{Measured, ShownTree};

/// The page's title, by which it is known.
const TITLE: &str = "Statistics";

/// The tree that is to be measured: the one on screen, while the page is open and it was not measured yet.
pub fn wanted(model: &Model) -> Option<Arc<ShownTree>> {
    let is_open = model.dialogs.find::<Page>().is_some_and(|page| page.title == TITLE);
    let shown = model.tree.as_ref()?.shown.as_ref().filter(|_| is_open)?;
    of(model, shown).is_none().then(|| Arc::clone(shown))
}

/// A tree was measured.
pub fn measured(model: &mut Model, measured: Measured) {
    model.measured = Some(measured);
}

/// What was measured of a tree, if that was it.
fn of<'m>(model: &'m Model, shown: &Arc<ShownTree>) -> Option<&'m Measured> {
    model.measured.as_ref().filter(|measured| Arc::ptr_eq(&measured.shown, shown))
}

#[cfg(test)]
mod tests;
