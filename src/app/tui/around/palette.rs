//! The palette: every command by its name.
//!
//! Commands are judged as they will run: with the palette closed.

use linden_terminal::input::{Key, KeyCode, Mouse, MouseAction};
use nucleo_matcher::pattern::{CaseMatching, Normalization, Pattern};
use nucleo_matcher::{Config, Matcher, Utf32Str};
use tui_input::Input;

use super::line::{edit, paste};
use crate::tui::command::{self, Command, Context};
use crate::tui::effect::Effects;
use crate::tui::model::{Layer, Model};

/// Rows that a key for a page moves by.
const PAGE: usize = 8;

/// The palette.
pub struct Palette {
    /// What was typed.
    pub input: Input,
    /// The row that Enter runs.
    pub selected: usize,
    /// Every command that can be meant where the palette was opened, and why it cannot be used now.
    commands: Vec<(&'static Command, Option<String>)>,
}

/// A row of the palette.
pub struct Found<'p> {
    /// The command.
    pub command: &'static Command,
    /// Why it cannot be used now.
    pub hindrance: Option<&'p str>,
    /// The letters of its title that match what was typed.
    pub marks: Vec<u32>,
}

impl Palette {
    /// With nothing typed, above what is open now.
    pub fn new(model: &Model) -> Self {
        Self { input: Input::default(), selected: 0, commands: judged(model) }
    }

    /// The commands that match, the best first; all when nothing is typed.
    pub fn found(&self) -> Vec<Found<'_>> {
        let pattern = Pattern::parse(self.input.value(), CaseMatching::Ignore, Normalization::Smart);
        let mut matcher = Matcher::new(Config::DEFAULT);
        let mut buffer = Vec::new();
        let mut found: Vec<(u32, Found<'_>)> = Vec::new();
        for (command, hindrance) in &self.commands {
            let mut marks = Vec::new();
            let title = pattern.indices(Utf32Str::new(command.title, &mut buffer), &mut matcher, &mut marks);
            if title.is_none() {
                marks.clear();
            }
            let id = pattern.score(Utf32Str::new(command.id, &mut buffer), &mut matcher);
            let help = pattern.score(Utf32Str::new(command.help, &mut buffer), &mut matcher);
            // A name is meant more often than a description.
            let score = title.map(|score| 3 * score).into_iter().chain(id.map(|score| 2 * score)).chain(help);
            if let Some(score) = score.max() {
                let hindrance = hindrance.as_deref();
                found.push((score, Found { command, hindrance, marks }));
            }
        }
        // Stable: equals keep the table's order.
        found.sort_by_key(|(score, _)| std::cmp::Reverse(*score));
        found.into_iter().map(|(_, found)| found).collect()
    }

    /// A key that edits or moves.
    pub fn typed(&mut self, key: Key) {
        match (key.code, key.ctrl) {
            (KeyCode::Up, _) | (KeyCode::Char('p'), true) => self.step(false, 1),
            (KeyCode::Down, _) | (KeyCode::Char('n'), true) => self.step(true, 1),
            (KeyCode::PageUp, _) => self.step(false, PAGE),
            (KeyCode::PageDown, _) => self.step(true, PAGE),
            _ => {
                if edit(&mut self.input, key) {
                    self.selected = 0;
                }
            }
        }
    }

    /// Pasted text.
    pub fn pasted(&mut self, text: &str) {
        paste(&mut self.input, text);
        self.selected = 0;
    }

    fn step(&mut self, down: bool, by: usize) {
        let last = self.found().len().saturating_sub(1);
        let to = if down { self.selected.saturating_add(by) } else { self.selected.saturating_sub(by) };
        self.selected = to.min(last);
    }
}

/// The commands that can be meant where the topmost dialog is, or the panes are.
fn judged(model: &Model) -> Vec<(&'static Command, Option<String>)> {
    let here = model.context();
    let is_meant = |context: Context| match context {
        Context::Always => true,
        Context::Global | Context::Presets | Context::Picture | Context::Shape => model.layers.is_empty(),
        _ => context == here,
    };
    command::all()
        .filter(|command| is_meant(command.context))
        .map(|command| (command, (command.hindrance)(model)))
        .collect()
}

/// Something happened while the palette is open: what can be used may have changed.
pub fn refresh(model: &mut Model) {
    if !matches!(model.layers.last(), Some(Layer::Palette(_))) {
        return;
    }
    if let Some(Layer::Palette(mut palette)) = model.layers.pop() {
        palette.commands = judged(model);
        model.layers.push(Layer::Palette(palette));
    }
}

/// Enter: closes the palette and runs the selected command. One that cannot be used says why, and the
/// palette stays.
pub fn accept(model: &mut Model, effects: &mut Effects) {
    let Some(Layer::Palette(palette)) = model.layers.pop() else { return };
    let chosen = palette.found().get(palette.selected).map(|found| found.command);
    let Some(command) = chosen else { return model.layers.push(Layer::Palette(palette)) };
    let is_hindered = (command.hindrance)(model).is_some();
    command::run(command, model, effects);
    if is_hindered {
        model.layers.push(Layer::Palette(palette));
    }
}

/// The mouse on a row.
pub fn clicked(model: &mut Model, row: usize, mouse: Mouse, effects: &mut Effects) {
    if !matches!(mouse.action, MouseAction::Press(_)) {
        return wheel(model, mouse);
    }
    if let Some(Layer::Palette(palette)) = model.layers.last_mut() {
        palette.selected = row;
        accept(model, effects);
    }
}

/// The wheel over the palette.
pub fn wheel(model: &mut Model, mouse: Mouse) {
    if let Some(Layer::Palette(palette)) = model.layers.last_mut() {
        match mouse.action {
            MouseAction::WheelUp => palette.step(false, 1),
            MouseAction::WheelDown => palette.step(true, 1),
            _ => {}
        }
    }
}
