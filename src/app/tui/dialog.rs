//! Dialogs above the panes, and the stack that they are on.
//!
//! A dialog is a type that implements [`Dialog`]; what opens it puts it on the model's stack with
//! [`Dialogs::open`]. Keys that mean a command are rows of the table with the dialog's context, and reach
//! it by its type ([`Dialogs::top_mut`]); all else that is typed, pasted or done with the mouse reaches it
//! through the trait. A new dialog is one file, and one line in the table of commands when it has some.

use std::any::Any;

use crossterm::event::{KeyEvent, MouseEvent};
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;

use super::command::Context;
use super::effect::Effects;
use super::layout::View;

/// What becomes of a dialog that was told something.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum After {
    /// It stays open.
    Stays,
    /// It is closed.
    Closes,
}

/// A dialog above the panes of a model `M`.
///
/// While a method that changes the model runs, the dialog is off the model's stack: the model looks as it
/// does with the dialog closed.
pub trait Dialog<M>: Any {
    /// Where its keys are; the footer has the hints of that context.
    fn context(&self) -> Context;

    /// Paints it. What the mouse can mean in it goes into the view as
    /// [`Target::Dialog`](super::layout::Target::Dialog).
    fn paint(&self, model: &M, area: Rect, buffer: &mut Buffer, view: &mut View);

    /// Whether it is a line that is typed within the panes or on the footer, and leaves all else on the
    /// screen in sight.
    fn is_prompt(&self) -> bool {
        false
    }

    /// A key that means no command here.
    fn key(&mut self, _model: &mut M, _key: KeyEvent, _effects: &mut Effects) -> After {
        After::Stays
    }

    /// Pasted text.
    fn paste(&mut self, _model: &mut M, _text: &str, _effects: &mut Effects) -> After {
        After::Stays
    }

    /// The mouse was pressed on a spot that it painted.
    fn click(&mut self, _model: &mut M, _spot: usize, _mouse: MouseEvent, _effects: &mut Effects) -> After {
        After::Stays
    }

    /// The pointer moves with a button down that went down in the dialog, or the button goes up; whether that was
    /// meant for it.
    fn drag(&mut self, _model: &mut M, _mouse: MouseEvent) -> bool {
        false
    }

    /// The wheel was turned by a notch, on a spot or elsewhere in the dialog.
    fn wheel(&mut self, _model: &mut M, _spot: Option<usize>, _down: bool) {}

    /// Enter, where a line is typed.
    fn accept(&mut self, _model: &mut M, _effects: &mut Effects) -> After {
        After::Closes
    }

    /// The mouse is about to do something in the panes while this is open: a line that is typed is taken or given up
    /// first, so that what was typed for one row does not go to another. What lives with the panes stays.
    fn leave(&mut self, _model: &mut M, _effects: &mut Effects) -> After {
        After::Stays
    }

    /// For [`leave`](Self::leave): what was typed counts where it can be taken, and is given up otherwise.
    fn take_or_give_up(&mut self, model: &mut M, effects: &mut Effects) -> After {
        if self.accept(model, effects) == After::Stays {
            self.cancel(model, effects);
        }
        After::Closes
    }

    /// It is given up, and closed thereafter: takes back what it did on the way.
    fn cancel(&mut self, _model: &mut M, _effects: &mut Effects) {}

    /// A message was taken in: what is shown of the model may have changed.
    fn refresh(&mut self, _model: &M) {}
}

/// The open dialogs, the topmost last.
pub struct Dialogs<M>(Vec<Box<dyn Dialog<M>>>);

impl<M> Default for Dialogs<M> {
    fn default() -> Self {
        Self(Vec::new())
    }
}

impl<M: 'static> Dialogs<M> {
    /// How many are open.
    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// Whether none is open.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// All, from the lowest to the topmost.
    pub fn iter(&self) -> impl Iterator<Item = &dyn Dialog<M>> {
        self.0.iter().map(|dialog| &**dialog)
    }

    /// The topmost.
    pub fn last(&self) -> Option<&dyn Dialog<M>> {
        self.0.last().map(|dialog| &**dialog)
    }

    /// Opens a dialog above the others.
    pub fn open(&mut self, dialog: impl Dialog<M>) {
        self.0.push(Box::new(dialog));
    }

    /// The topmost one, when it is of a type.
    pub fn top<T: Dialog<M>>(&self) -> Option<&T> {
        self.0.last().and_then(|dialog| typed(&**dialog))
    }

    /// The topmost one, when it is of a type, to be changed.
    pub fn top_mut<T: Dialog<M>>(&mut self) -> Option<&mut T> {
        self.0.last_mut().and_then(|dialog| typed_mut(&mut **dialog))
    }

    /// The lowest one of a type.
    pub fn find<T: Dialog<M>>(&self) -> Option<&T> {
        self.0.iter().find_map(|dialog| typed(&**dialog))
    }

    /// The lowest one of a type, to be changed.
    pub fn find_mut<T: Dialog<M>>(&mut self) -> Option<&mut T> {
        self.0.iter_mut().find_map(|dialog| typed_mut(&mut **dialog))
    }

    /// Closes all of a type.
    pub fn close<T: Dialog<M>>(&mut self) {
        self.0.retain(|dialog| typed::<M, T>(&**dialog).is_none());
    }

    /// Takes the topmost one off, with its place on the stack.
    pub fn take(&mut self) -> Option<(usize, Box<dyn Dialog<M>>)> {
        let dialog = self.0.pop()?;
        Some((self.0.len(), dialog))
    }

    /// Puts one back that was taken, below those that were opened meanwhile.
    pub fn put_back(&mut self, place: usize, dialog: Box<dyn Dialog<M>>) {
        self.0.insert(place.min(self.0.len()), dialog);
    }
}

fn typed<M: 'static, T: Dialog<M>>(dialog: &dyn Dialog<M>) -> Option<&T> {
    (dialog as &dyn Any).downcast_ref()
}

fn typed_mut<M: 'static, T: Dialog<M>>(dialog: &mut dyn Dialog<M>) -> Option<&mut T> {
    (dialog as &mut dyn Any).downcast_mut()
}
