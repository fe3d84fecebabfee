//! Looking at a derivation: the word of a grammar after some steps, module by module, beside what the turtle
//! draws for it. The module under the cursor is marked in the picture, and a click there finds its module.

mod commands;
mod marks;
mod view;

use std::sync::Arc;

use crossterm::event::{KeyEvent, MouseEvent};
use glam::Vec3;
use linden::lsystem::{Grammar, TracedModule};
use linden_raster::Camera;
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;

pub use commands::{CAMERA, COMMANDS};

use super::command::Context;
use super::dialog::{After, Dialog};
use super::effect::Effects;
use super::layout::{Pane, View};
use super::model::Model;
use super::picture;
use super::shape;
use super::tree::grammar_of;
use crate::jobs::{Derivation, DerivedWord, Marks, WordRequest};

/// Where its keys are listened to.
pub const CONTEXT: Context = Context::new(57, "derivation", "While looking at a derivation");
/// The spots that the mouse can mean.
const PICTURE: usize = 0;
const WORD: usize = 1;
/// Lines a notch of the wheel.
const NOTCH: isize = 3;

/// The cursor in a word, above the panes.
pub struct Debugger {
    /// The step that is wanted.
    step: u32,
    /// What was answered last.
    answered: Option<WordRequest>,
    /// The word on screen: of that step, or of one before until that comes.
    word: Option<Arc<DerivedWord>>,
    /// Why there is no word of the wanted step.
    fault: Option<String>,
    /// A module of the word.
    cursor: usize,
    /// What the picture marks for it.
    marked: Arc<Vec<Vec<Vec3>>>,
    /// The first module of each line of the word.
    lines: Vec<usize>,
    /// The cells that lines were broken for.
    width: u16,
    /// Whether organs are drawn.
    leaves: bool,
    /// How the tree was looked at before.
    camera: Camera,
}

impl Debugger {
    fn modules(&self) -> &[TracedModule] {
        self.word.as_ref().map_or(&[], |word| &word.traced.modules)
    }

    fn module(&self) -> Option<&TracedModule> {
        self.modules().get(self.cursor)
    }

    /// Puts the cursor on a module, or on the last one.
    fn go_to(&mut self, module: usize) {
        self.cursor = module.min(self.modules().len().saturating_sub(1));
        self.marked = Arc::new(match &self.word {
            Some(word) => marks::of(word, self.cursor),
            None => Vec::new(),
        });
    }

    /// The line of a module.
    fn line_of(&self, module: usize) -> usize {
        self.lines.partition_point(|first| *first <= module).saturating_sub(1)
    }

    /// The modules of a line.
    fn line(&self, line: usize) -> std::ops::Range<usize> {
        let end = self.lines.get(line + 1).copied().unwrap_or(self.modules().len());
        self.lines.get(line).copied().unwrap_or(end)..end
    }

    /// The module of a line that stands in a column, or the last one before it.
    fn at_column(&self, line: usize, column: usize) -> usize {
        let modules = self.line(line);
        let Some(word) = &self.word else { return 0 };
        let mut x = 0;
        for module in modules.clone() {
            x += usize::from(word.widths[module]);
            if x > column {
                return module;
            }
        }
        modules.end.saturating_sub(1)
    }

    /// The column at which the cursor's module begins.
    fn column(&self) -> usize {
        let from = self.line(self.line_of(self.cursor)).start;
        let Some(word) = &self.word else { return 0 };
        word.widths[from..self.cursor].iter().map(|&width| usize::from(width)).sum()
    }

    /// Some lines on or back, in the same column.
    fn move_lines(&mut self, by: isize) {
        let last = self.lines.len().saturating_sub(1);
        let to = self.line_of(self.cursor).saturating_add_signed(by).min(last);
        if !self.modules().is_empty() {
            self.go_to(self.at_column(to, self.column()));
        }
    }

    /// The next module, or the one before, of the cursor's symbol.
    fn same(&self, on: bool) -> Option<usize> {
        let symbol = self.module()?.symbol;
        let is_it = |module: &TracedModule| module.symbol == symbol;
        let modules = self.modules();
        if on {
            let behind = modules[self.cursor + 1..].iter().position(is_it)?;
            Some(self.cursor + 1 + behind)
        } else {
            modules[..self.cursor].iter().rposition(is_it)
        }
    }

    /// The bracket that belongs to the cursor's; from elsewhere, the one that began the branch.
    fn bracket(&self) -> Option<usize> {
        marks::bracket(self.modules(), self.cursor)
    }

    /// The rule that wrote the module, else the one that rewrites it next.
    fn rule(&self) -> Option<u32> {
        self.module().and_then(|module| module.rule.or(module.next_rule))
    }

    /// A word is there: the cursor goes to what its module became, or to what that came from.
    fn show(&mut self, word: Arc<DerivedWord>) {
        let is_same_grammar =
            self.word.as_ref().is_some_and(|old| Arc::ptr_eq(&old.request.recipe, &word.request.recipe));
        let from = self.word.as_ref().map(|old| (old.request.step, old.traced.modules.len()));
        let modules = &word.traced.modules;
        let cursor = match from {
            Some((step, _)) if is_same_grammar && step + 1 == word.request.step => {
                modules.partition_point(|module| module.parent < Some(self.cursor as u32))
            }
            Some((step, _)) if is_same_grammar && step == word.request.step + 1 => {
                self.module().and_then(|module| module.parent).unwrap_or(0) as usize
            }
            Some((step, count)) if step != word.request.step && count > 0 => {
                self.cursor * modules.len() / count
            }
            Some(_) => self.cursor,
            None => 0,
        };
        self.word = Some(word);
        self.fault = None;
        self.lines.clear();
        self.go_to(cursor);
    }

    /// Breaks the word into lines that end between modules.
    fn break_lines(&mut self, width: u16) {
        let Some(word) = self.word.as_ref().filter(|_| self.lines.is_empty() || self.width != width) else {
            return;
        };
        self.width = width;
        self.lines = vec![0];
        let mut used = 0_usize;
        for (module, &wide) in word.widths.iter().enumerate() {
            if used > 0 && used + usize::from(wide) > usize::from(width) {
                self.lines.push(module);
                used = 0;
            }
            used += usize::from(wide);
        }
    }
}

/// The grammar of the word on screen.
fn grammar(word: &DerivedWord) -> Option<&Grammar> {
    grammar_of(&word.request.recipe.preset)
}

/// The word that is to be derived, while it is not there yet.
pub fn wanted(model: &Model) -> Option<WordRequest> {
    let debugger = model.dialogs.find::<Debugger>()?;
    let request = WordRequest { recipe: Arc::clone(model.tree.as_ref()?.wanted()), step: debugger.step };
    (debugger.answered.as_ref() != Some(&request)).then_some(request)
}

/// A word is there, or is not to be had.
pub fn derived(model: &mut Model, derivation: Derivation) {
    if wanted(model).as_ref() != Some(&derivation.request) {
        return;
    }
    let Some(debugger) = model.dialogs.find_mut::<Debugger>() else { return };
    debugger.answered = Some(derivation.request);
    match derivation.outcome {
        Ok(word) => debugger.show(word),
        Err(no_word) => {
            // Nothing is on screen yet: as far as can be looked at.
            if let (None, Some(fits)) = (&debugger.word, no_word.fits) {
                debugger.step = fits;
            } else {
                debugger.fault = Some(no_word.why.clone());
            }
            model.say_warning(no_word.why);
        }
    }
}

/// The word whose picture is shown, with what that marks.
pub fn shown(model: &Model) -> Option<(&Arc<DerivedWord>, Marks)> {
    let debugger = model.dialogs.find::<Debugger>()?;
    let lines = Arc::clone(&debugger.marked);
    let marks = Marks { lines, bare: !debugger.leaves, ..Marks::default() };
    Some((debugger.word.as_ref()?, marks))
}

/// Begins to look.
fn open(model: &mut Model) {
    let Some(last) = commands::last_step(model) else { return };
    let step = model.growth.step().unwrap_or(last);
    model.growth.stop();
    model.wind.stop();
    if model.layout().pane(Pane::Shape).is_none() {
        model.focus_on(Pane::Shape);
    }
    let camera = model.picture.camera;
    (model.picture.camera.zoom, model.picture.camera.pan) = (1.0, glam::Vec2::ZERO);
    model.dialogs.open(Debugger {
        step,
        answered: None,
        word: None,
        fault: None,
        cursor: 0,
        marked: Arc::default(),
        lines: Vec::new(),
        width: 0,
        leaves: true,
        camera,
    });
}

/// Ends, and looks at the tree as before.
fn close(model: &mut Model) {
    model.with(|debugger: &mut Debugger, model| {
        model.picture.camera = debugger.camera;
        After::Closes
    });
}

/// Changes the cursor.
fn with(model: &mut Model, act: impl FnOnce(&mut Debugger)) {
    if let Some(debugger) = model.dialogs.top_mut::<Debugger>() {
        act(debugger);
    }
}

/// Moves the cursor to a module, where there is one.
fn go(model: &mut Model, to: impl FnOnce(&Debugger) -> Option<usize>) {
    with(model, |debugger| {
        if let Some(module) = to(debugger) {
            debugger.go_to(module);
        }
    });
}

/// Opens the grammar's editor on the rule that wrote the module, or that rewrites it next.
fn edit_rule(model: &mut Model) {
    let rule = model.dialogs.top::<Debugger>().and_then(Debugger::rule);
    shape::grammar::open(model, rule.map_or(0, |rule| rule as usize + 1));
}

impl Dialog<Model> for Debugger {
    fn context(&self) -> Context {
        CONTEXT
    }

    fn is_prompt(&self) -> bool {
        true
    }

    fn paint(&self, model: &Model, _screen: Rect, buffer: &mut Buffer, view: &mut View) {
        view::paint(model, self, buffer, view);
    }

    /// Undo and redo, by the keys that they have everywhere.
    fn key(&mut self, model: &mut Model, key: KeyEvent, effects: &mut Effects) -> After {
        shape::undo_or_redo(model, key, effects);
        After::Stays
    }

    fn click(&mut self, model: &mut Model, spot: usize, mouse: MouseEvent, _effects: &mut Effects) -> After {
        let found = if spot == PICTURE {
            let word = self.word.as_ref();
            picture::pointed_at(model, mouse.column, mouse.row)
                .zip(word)
                .and_then(|((view, place), word)| marks::nearest(word, &view, place))
        } else {
            view::module_at(self, view::areas(model).word, mouse)
        };
        if let Some(module) = found {
            self.go_to(module);
        }
        After::Stays
    }

    fn wheel(&mut self, model: &mut Model, spot: Option<usize>, down: bool) {
        match spot {
            Some(PICTURE) => picture::zoom_by(model, if down { 1.0 / 1.15 } else { 1.15 }),
            Some(_) => self.move_lines(if down { NOTCH } else { -NOTCH }),
            None => {}
        }
    }

    fn refresh(&mut self, model: &Model) {
        self.break_lines(view::areas(model).word.width);
    }
}

#[cfg(test)]
mod tests;
