//! The palette: every command by its name.

use linden_terminal::input::{Key, KeyCode, Mouse, MouseAction};
use nucleo_matcher::pattern::{CaseMatching, Normalization, Pattern};
use nucleo_matcher::{Config, Matcher, Utf32Str};
use tui_input::Input;

use super::line::{edit, paste};
use crate::tui::command::{self, Command};
use crate::tui::effect::Effects;
use crate::tui::model::{Layer, Model};

/// The palette.
pub struct Palette {
    /// What was typed.
    pub input: Input,
    /// The row that Enter runs.
    pub selected: usize,
}

impl Palette {
    /// With nothing typed.
    pub fn new() -> Self {
        Self { input: Input::default(), selected: 0 }
    }

    /// The commands that match, the best first; all when nothing is typed.
    pub fn found(&self) -> Vec<&'static Command> {
        let pattern = Pattern::parse(self.input.value(), CaseMatching::Ignore, Normalization::Smart);
        let mut matcher = Matcher::new(Config::DEFAULT);
        let mut buffer = Vec::new();
        let mut found: Vec<(u32, &Command)> = command::all()
            .filter_map(|command| {
                let name = format!("{} {}", command.title, command.id);
                let name =
                    pattern.score(Utf32Str::new(&name, &mut buffer), &mut matcher).map(|score| 2 * score);
                let help = pattern.score(Utf32Str::new(command.help, &mut buffer), &mut matcher);
                name.into_iter().chain(help).max().map(|score| (score, command))
            })
            .collect();
        // Stable: equals keep the table's order.
        found.sort_by_key(|(score, _)| std::cmp::Reverse(*score));
        found.into_iter().map(|(_, command)| command).collect()
    }

    /// A key that edits or moves.
    pub fn typed(&mut self, key: Key) {
        match key.code {
            KeyCode::Up => self.selected = self.selected.saturating_sub(1),
            KeyCode::Down => self.selected = (self.selected + 1).min(self.found().len().saturating_sub(1)),
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
}

/// Enter: runs the selected command where the palette was opened.
pub fn accept(model: &mut Model, effects: &mut Effects) {
    let Some(Layer::Palette(palette)) = model.layers.last() else { return };
    let chosen = palette.found().get(palette.selected).copied();
    model.layers.pop();
    if let Some(command) = chosen {
        command::run(command, model, effects);
    }
}

/// The mouse on a row.
pub fn clicked(model: &mut Model, row: usize, mouse: Mouse, effects: &mut Effects) {
    if let Some(Layer::Palette(palette)) = model.layers.last_mut()
        && matches!(mouse.action, MouseAction::Press(_))
    {
        palette.selected = row;
        accept(model, effects);
    }
}
