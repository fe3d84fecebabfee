//! The palette: every command by its name.
//!
//! Commands are judged as they will run: with the palette closed.

use crossterm::event::{KeyCode, KeyEvent, KeyModifiers, MouseEvent};
use nucleo_matcher::pattern::{CaseMatching, Normalization, Pattern};
use nucleo_matcher::{Config, Matcher, Utf32Str};
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use tui_input::Input;
use unicode_width::UnicodeWidthStr;

use super::footer::key_label;
use super::popup::{popup, scrollbar};
use super::prompt::{self, edit, paint, paste};
use crate::tui::command::Context;
use crate::tui::dialog::{After, Dialog};
use crate::tui::effect::Effects;
use crate::tui::layout::{Target, View, centered, first_row};
use crate::tui::model::{Command, Model};
use crate::wrap::clipped;

/// Cells of a command's name.
const NAME: usize = 22;
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

    fn step(&mut self, down: bool, by: usize) {
        let last = self.found().len().saturating_sub(1);
        let to = if down { self.selected.saturating_add(by) } else { self.selected.saturating_sub(by) };
        self.selected = to.min(last);
    }
}

impl Dialog<Model> for Palette {
    fn context(&self) -> Context {
        prompt::CONTEXT
    }

    fn paint(&self, model: &Model, body: Rect, buffer: &mut Buffer, view: &mut View) {
        let theme = &model.config.theme;
        let mut area = centered(86, body.height.saturating_sub(2).clamp(body.height.min(5), 24), body);
        area.y = body.y + (body.height / 8).min(body.height - area.height);
        let outer = area;
        let area = popup(model, "Commands", area, buffer, view);
        if area.is_empty() {
            return;
        }
        buffer.set_stringn(area.x, area.y, ": ", area.width.into(), theme.key);
        let input =
            Rect { x: area.x + 2.min(area.width), width: area.width.saturating_sub(2), height: 1, ..area };
        paint(&self.input, input, buffer, view, theme);
        let found = self.found();
        let list = Rect { y: area.y + 1, height: area.height - 1, ..area };
        if found.is_empty() && !list.is_empty() {
            buffer.set_stringn(list.x, list.y, " nothing matches", list.width.into(), theme.popup_dim);
        }
        let first = first_row(self.selected, found.len(), list.height.into());
        for (y, (i, command)) in (list.y..list.bottom()).zip(found.iter().enumerate().skip(first)) {
            let row = Rect { y, height: 1, ..list };
            view.regions.push((row, Target::Dialog(Some(i))));
            palette_row(model, command, i == self.selected, row, buffer);
        }
        if outer != area && found.len() > list.height.into() {
            scrollbar(model, Rect { x: list.right(), width: 1, ..list }, first, found.len(), buffer);
        }
    }

    /// A key that edits or moves.
    fn key(&mut self, _model: &mut Model, key: KeyEvent, _effects: &mut Effects) -> After {
        match (key.code, key.modifiers.contains(KeyModifiers::CONTROL)) {
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
        After::Stays
    }

    fn paste(&mut self, _model: &mut Model, text: &str, _effects: &mut Effects) -> After {
        paste(&mut self.input, text);
        self.selected = 0;
        After::Stays
    }

    fn click(&mut self, model: &mut Model, spot: usize, _mouse: MouseEvent, effects: &mut Effects) -> After {
        self.selected = spot;
        self.accept(model, effects)
    }

    fn wheel(&mut self, _model: &mut Model, _spot: Option<usize>, down: bool) {
        self.step(down, 1);
    }

    /// Runs the selected command with the palette closed. One that cannot be used says why, and the
    /// palette stays.
    fn accept(&mut self, model: &mut Model, effects: &mut Effects) -> After {
        let chosen = self.found().get(self.selected).map(|found| found.command);
        let Some(command) = chosen else { return After::Stays };
        let is_hindered = (command.hindrance)(model).is_some();
        model.run(command, effects);
        if is_hindered { After::Stays } else { After::Closes }
    }

    /// What can be used may have changed.
    fn refresh(&mut self, model: &Model) {
        self.commands = judged(model);
    }
}

/// A command, what it does or why it cannot be used, and its keys.
fn palette_row(model: &Model, found: &Found<'_>, chosen: bool, row: Rect, buffer: &mut Buffer) {
    let theme = &model.config.theme;
    let can_be_used = found.hindrance.is_none();
    let base = if chosen { theme.selected } else { theme.popup };
    let dimmed = |style| if chosen { base } else { theme.popup.patch(style) };
    buffer.set_style(row, base);
    let width = usize::from(row.width);
    let name = if can_be_used { base } else { base.patch(theme.disabled) };
    buffer.set_stringn(row.x + 1, row.y, found.command.title, width.saturating_sub(1), name);
    for &mark in &found.marks {
        if let Some(cell) = buffer.cell_mut((row.x + 1 + mark as u16, row.y))
            && (mark as usize) + 1 < width
        {
            cell.set_style(theme.matched);
        }
    }
    let keys: Vec<_> = model
        .config
        .keymap
        .keys_of(found.command.id)
        .iter()
        .take(2)
        .map(|key| key_label(&key.to_string()))
        .collect();
    let keys = keys.join(" ");
    let about = found.hindrance.unwrap_or(found.command.help);
    let style = dimmed(if can_be_used { theme.popup_dim } else { theme.warning });
    let from = NAME + 2;
    let room = width.saturating_sub(from + keys.width() + 2);
    if room >= 8 {
        buffer.set_stringn(row.x + from as u16, row.y, clipped(about, room), room, style);
    }
    let wide = keys.width() as u16 + 1;
    if usize::from(wide) + found.command.title.width() + 2 <= width {
        buffer.set_stringn(row.right() - wide, row.y, &keys, width, dimmed(theme.key));
    }
}

/// The commands that can be meant where the topmost dialog is, or the panes are.
fn judged(model: &Model) -> Vec<(&'static Command, Option<String>)> {
    let here = model.context();
    let is_meant = |context: Context| {
        context == Context::ALWAYS
            || if context.is_below_dialogs() { model.dialogs.is_empty() } else { context == here }
    };
    model
        .commands()
        .filter(|command| is_meant(command.context))
        .map(|command| (command, (command.hindrance)(model)))
        .collect()
}
