//! The palette: every command, knob, age, preset, format and setting by its name, and files by their paths.
//!
//! Commands are judged as they will run: with the palette closed. A knob takes what follows its name, as
//! `season 0.8`, and so does a setting, as `theme light`.

use std::sync::Arc;

use crossterm::event::{KeyCode, KeyEvent, KeyModifiers, MouseEvent};
use linden::knob::Value;
use linden::preset::PresetKnob;
use linden::recipe::Recipe;
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use tui_input::Input;
use unicode_width::UnicodeWidthStr;

use super::footer::key_label;
use super::popup::{popup, scrollbar};
use super::prompt::{self, edit, paint, paste};
use crate::config::settings::{SETTINGS, Setting};
use crate::paths::begins_path;
use crate::tui::command::Context;
use crate::tui::dialog::{After, Dialog};
use crate::tui::effect::{Effect, Effects};
use crate::tui::export;
use crate::tui::layout::{Pane, Target, View, centered, first_row, inside};
use crate::tui::library::{open_path, show_selected};
use crate::tui::model::{Command, FormSpot, Model, has_tags, split_tags};
use crate::tui::ranking::{Closeness, Ranking};
use crate::tui::shape;
use crate::tui::tree::TreePlace;
use crate::wrap::{clipped, wrapped_within};

/// Cells of a command's name.
const NAME: usize = 22;
/// Columns of the palette, and the share of a wide screen that it has.
const COLUMNS: u16 = 86;
const SHARE: (u16, u16) = (3, 5);
/// Rows that say all of what the row at the cursor is, with a rule above; and the height that they want.
const ABOUT: u16 = 3;
const WITH_ABOUT: u16 = 12;
/// What an age is typed behind.
const AGE: &str = "age";

/// The palette.
pub struct Palette {
    /// What was typed.
    pub input: Input,
    /// The row that Enter runs.
    pub selected: usize,
    /// All that can be meant where the palette was opened.
    choices: Vec<Choice>,
    /// What a path means that is typed.
    file: Choice,
    /// What an age means that is typed, and no choice is called so.
    age: Choice,
    /// The tree that it would be of.
    recipe: Option<Arc<Recipe>>,
}

/// What can be chosen.
struct Choice {
    what: What,
    title: String,
    about: String,
    /// Why it cannot be used now.
    hindrance: Option<String>,
    /// Of a preset: its tags.
    tags: Vec<String>,
    /// Of a preset: what is told of it.
    told: [String; 2],
}

impl Choice {
    /// That can be used now, and is no preset.
    fn new(what: What, title: String, about: String) -> Self {
        Self { what, title, about, hindrance: None, tags: Vec::new(), told: Default::default() }
    }
}

#[derive(Clone)]
enum What {
    Command(&'static Command),
    Knob(&'static str),
    /// By its name.
    Age(String),
    Preset(TreePlace),
    Format(&'static str),
    Setting(&'static Setting),
    /// A path as it was typed.
    File,
}

/// A row of the palette.
struct Found<'p> {
    choice: &'p Choice,
    /// What a knob is to be turned to.
    value: Option<&'p str>,
    /// The letters of its title that match what was typed.
    marks: Vec<u32>,
    /// Why it cannot be done with that value.
    refusal: Option<String>,
}

impl<'p> Found<'p> {
    fn new(choice: &'p Choice, value: Option<&'p str>) -> Self {
        Self { choice, value, marks: Vec::new(), refusal: None }
    }

    /// Why it cannot be used now.
    fn hindrance(&self) -> Option<&str> {
        self.refusal.as_deref().or(self.choice.hindrance.as_deref())
    }

    /// What it is or would do, or why it cannot.
    fn about(&self) -> String {
        let Choice { what, about, .. } = self.choice;
        match (self.hindrance(), self.value, what) {
            (Some(why), ..) => why.to_owned(),
            (None, None, _) => about.clone(),
            (None, Some(value), What::File | What::Age(_)) => {
                format!("{}: {about}", linden::knob::printable(value))
            }
            (None, Some(value), _) => format!("becomes {value}, was {about}"),
        }
    }
}

impl Palette {
    /// With nothing typed, above what is open now.
    pub fn new(model: &Model) -> Self {
        let about = "a preset, a grammar, a mesh, a scan, or an export with its recipe".to_owned();
        let file = Choice::new(What::File, "open".to_owned(), about);
        let about = "shows the tree at that age; Undo takes it back".to_owned();
        let age = Choice::new(What::Age(String::new()), AGE.to_owned(), about);
        let (input, recipe) = (Input::default(), recipe(model));
        Self { input, selected: 0, choices: choices(model), file, age, recipe }
    }

    /// What matches, the best first; everything when nothing is typed.
    fn found(&self) -> Vec<Found<'_>> {
        let typed = self.input.value().trim();
        if self.choices.iter().any(|choice| matches!(choice.what, What::Preset(_))) && begins_path(typed) {
            return vec![Found::new(&self.file, Some(typed))];
        }
        if let Some(turned) = self.aged().or_else(|| self.turned()) {
            return vec![turned];
        }
        let (wanted, words) = split_tags(self.input.value());
        let mut ranking = Ranking::of(&words);
        let mut found: Vec<((Closeness, u32), Found<'_>)> = Vec::new();
        let is_tagged = |choice: &&Choice| {
            let tags: Vec<&str> = choice.tags.iter().map(String::as_str).collect();
            has_tags(&tags, &wanted)
        };
        for choice in self.choices.iter().filter(is_tagged) {
            let (title, marks) = ranking.marked(&choice.title).unzip();
            let other = match &choice.what {
                What::Command(command) => ranking.score(command.id),
                What::Preset(_) => ranking.score(&choice.about),
                What::Knob(_) | What::Age(_) | What::Format(_) | What::Setting(_) | What::File => None,
            };
            // A title is meant more often than another name of the same.
            let score = title.map(|score| 3 * score).into_iter().chain(other.map(|score| 2 * score)).max();
            let Choice { title, about, told: [summary, source], .. } = choice;
            let is_told = || {
                matches!(choice.what, What::Preset(_)) && ranking.is_told(&[title, about, summary, source])
            };
            // What is told of a preset comes after all names.
            if score.is_some() || is_told() {
                found.push((
                    (ranking.closeness(title), score.unwrap_or(0)),
                    Found { marks: marks.unwrap_or_default(), ..Found::new(choice, None) },
                ));
            }
        }
        // Stable: equals keep their order, commands first.
        found.sort_by_key(|(score, _)| std::cmp::Reverse(*score));
        found.into_iter().map(|(_, found)| found).collect()
    }

    /// A knob or a setting by its whole name, with what it is to be turned to.
    fn turned(&self) -> Option<Found<'_>> {
        let typed = self.input.value().trim_start();
        let (name, value) = typed.split_once([' ', '='])?;
        let is_age = |choice: &Choice| matches!(choice.what, What::Age(_)) && choice.title.starts_with(typed);
        if !value.is_empty() && self.choices.iter().any(is_age) {
            return None;
        }
        let choice = self.choices.iter().find(|choice| match choice.what {
            What::Knob(knob) => knob == name || choice.title == name,
            What::Setting(setting) => setting.name == name,
            _ => false,
        })?;
        let value = value.trim_start_matches([' ', '=']).trim_end();
        Some(Found::new(choice, Some(value).filter(|value| !value.is_empty())))
    }

    /// An age that is no choice and no value of the knob: as `--age` takes it, or why there is none.
    fn aged(&self) -> Option<Found<'_>> {
        let typed = self.input.value().trim();
        let age = typed.strip_prefix(AGE)?.strip_prefix([' ', '='])?.trim();
        let preset = &self.recipe.as_ref()?.preset;
        let is_begun =
            |choice: &Choice| matches!(choice.what, What::Age(_)) && choice.title.starts_with(typed);
        let is_value = || preset.find_knob(AGE).is_some_and(|row| row.knob.kind.parse(age).is_ok());
        if age.is_empty() || self.choices.iter().any(is_begun) || is_value() {
            return None;
        }
        let refusal = shape::ages::typed_age(preset, age).err();
        Some(Found { refusal, ..Found::new(&self.age, Some(age)) })
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

    fn paint(&self, model: &Model, _body: Rect, buffer: &mut Buffer, view: &mut View) {
        let theme = &model.config.theme;
        let outer = area(model);
        let area = popup(model, "Commands", outer, buffer, view);
        if area.is_empty() {
            return;
        }
        buffer.set_stringn(area.x, area.y, ": ", area.width.into(), theme.key);
        let input =
            Rect { x: area.x + 2.min(area.width), width: area.width.saturating_sub(2), height: 1, ..area };
        paint(&self.input, input, buffer, view, theme);
        let found = self.found();
        let list = list(area);
        if found.is_empty() && !list.is_empty() {
            buffer.set_stringn(list.x, list.y, " nothing matches", list.width.into(), theme.popup_dim);
        }
        let first = first_row(self.selected, found.len(), list.height.into());
        for (y, (i, found)) in (list.y..list.bottom()).zip(found.iter().enumerate().skip(first)) {
            let row = Rect { y, height: 1, ..list };
            view.regions.push((row, Target::Dialog(Some(i))));
            palette_row(model, found, i == self.selected, row, buffer);
        }
        if let Some(found) = found.get(self.selected) {
            explain(
                model,
                found,
                Rect { y: list.bottom(), height: area.bottom() - list.bottom(), ..area },
                buffer,
            );
        }
        if outer != area && found.len() > list.height.into() {
            scrollbar(model, Rect { x: list.right(), width: 1, ..list }, first, found.len(), buffer);
        }
    }

    /// A key that edits or moves.
    fn key(&mut self, model: &mut Model, key: KeyEvent, _effects: &mut Effects) -> After {
        // A page less a row, so that the eye finds where it was.
        let page = usize::from(list(inside(area(model))).height).saturating_sub(1).max(1);
        match (key.code, key.modifiers.contains(KeyModifiers::CONTROL)) {
            (KeyCode::Up, _) | (KeyCode::Char('p'), true) => self.step(false, 1),
            (KeyCode::Down, _) | (KeyCode::Char('n'), true) => self.step(true, 1),
            (KeyCode::PageUp, _) => self.step(false, page),
            (KeyCode::PageDown, _) => self.step(true, page),
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

    /// Does what is selected, with the palette closed. What cannot be done says why, and the palette stays.
    fn accept(&mut self, model: &mut Model, effects: &mut Effects) -> After {
        let (what, value) = match self.found().get(self.selected) {
            Some(found) => (found.choice.what.clone(), found.value.map(str::to_owned)),
            None => return After::Stays,
        };
        match (what, value) {
            (What::Command(command), _) => {
                let is_hindered = (command.hindrance)(model).is_some();
                model.run(command, effects);
                if is_hindered {
                    return After::Stays;
                }
            }
            (What::Knob(name), Some(value)) => {
                if !shape::value::take(model, name, &value) {
                    return After::Stays;
                }
            }
            (What::Knob(name), None) => {
                model.focus_on(Pane::Shape);
                model.form.selected = Some(FormSpot::Knob(name));
            }
            (What::Age(name), age) => {
                if !shape::ages::show(model, age.as_deref().unwrap_or(&name)) {
                    return After::Stays;
                }
            }
            (What::Format(id), _) => export::open_with(model, id),
            (What::Setting(setting), value) => {
                let Some(value) = value else {
                    self.input = Input::new(format!("{} ", setting.name));
                    return After::Stays;
                };
                if !set(model, setting, &value, effects) {
                    return After::Stays;
                }
            }
            (What::File, path) => open_path(model, path.as_deref().unwrap_or_default(), effects),
            (What::Preset(place), _) => {
                model.library.filter_by("");
                model.library.select_place(&place);
                show_selected(model, effects);
            }
        }
        After::Closes
    }

    /// What can be used may have changed.
    fn refresh(&mut self, model: &Model) {
        (self.choices, self.recipe) = (choices(model), recipe(model));
    }
}

/// The tree whose ages can be typed: panes lie behind a dialog.
fn recipe(model: &Model) -> Option<Arc<Recipe>> {
    let tree = model.tree.as_ref().filter(|_| model.dialogs.is_empty());
    tree.map(|tree| Arc::clone(tree.recipe()))
}

/// Where the palette is: with some air around it, but beside a picture, where it takes all of the room.
fn area(model: &Model) -> Rect {
    let body = model.popup_body();
    let air = if body == model.dialog_body() { (body.height / 12).max(1) } else { 0 };
    let columns = (body.width * SHARE.0 / SHARE.1).max(COLUMNS);
    centered(columns, body.height.saturating_sub(2 * air).max(body.height.min(5)), body)
}

/// The rows of what can be chosen, below the line that is typed.
fn list(inner: Rect) -> Rect {
    let below = inner.height.saturating_sub(1);
    let about = if inner.height >= WITH_ABOUT { ABOUT } else { 0 };
    Rect { y: inner.y + inner.height - below, height: below - about, ..inner }
}

/// All of what the row at the cursor says, which has less room itself.
fn explain(model: &Model, found: &Found<'_>, area: Rect, buffer: &mut Buffer) {
    if area.height < 2 {
        return;
    }
    let theme = &model.config.theme;
    let width = usize::from(area.width);
    buffer.set_string(area.x, area.y, "─".repeat(width), theme.popup_border);
    let style = if found.hindrance().is_none() { theme.popup_dim } else { theme.warning };
    let rows = wrapped_within(&found.about(), width.saturating_sub(2), usize::from(area.height) - 1);
    for (row, y) in rows.iter().zip(area.y + 1..area.bottom()) {
        buffer.set_stringn(area.x + 1, y, row, width.saturating_sub(1), theme.popup.patch(style));
    }
}

/// What can be chosen, what it does or why it cannot, and its keys.
fn palette_row(model: &Model, found: &Found<'_>, chosen: bool, row: Rect, buffer: &mut Buffer) {
    let theme = &model.config.theme;
    let Choice { what, title, .. } = found.choice;
    let hindrance = found.hindrance();
    let base = if chosen { theme.selected } else { theme.popup };
    let dimmed = |style| if chosen { base } else { theme.popup.patch(style) };
    buffer.set_style(row, base);
    let width = usize::from(row.width);
    let name = if hindrance.is_none() { base } else { base.patch(theme.disabled) };
    buffer.set_stringn(row.x + 1, row.y, title, width.saturating_sub(1), name);
    for &mark in &found.marks {
        if let Some(cell) = buffer.cell_mut((row.x + 1 + mark as u16, row.y))
            && (mark as usize) + 1 < width
        {
            cell.set_style(theme.matched);
        }
    }
    let tail = match what {
        What::Command(command) => {
            let keys = model.config.keymap.keys_of(command.id).iter().take(2);
            keys.map(|key| key_label(model, &key.to_string())).collect::<Vec<_>>().join(" ")
        }
        What::Knob(_) => "knob".to_owned(),
        What::Age(_) => "age".to_owned(),
        What::Preset(_) => "preset".to_owned(),
        What::Format(_) => "format".to_owned(),
        What::Setting(_) => "setting".to_owned(),
        What::File => "file".to_owned(),
    };
    let about = found.about();
    let style = dimmed(if hindrance.is_none() { theme.popup_dim } else { theme.warning });
    let from = NAME.max(title.width()) + 2;
    let room = width.saturating_sub(from + tail.width() + 2);
    if room >= 8 {
        buffer.set_stringn(row.x + from as u16, row.y, clipped(&about, room), room, style);
    }
    let wide = tail.width() as u16 + 1;
    if usize::from(wide) + title.width() + 2 <= width {
        let style = if matches!(what, What::Command(_)) { theme.key } else { theme.popup_dim };
        buffer.set_stringn(row.right() - wide, row.y, &tail, width, dimmed(style));
    }
}

/// What can be meant where the topmost dialog is, or the panes are.
fn choices(model: &Model) -> Vec<Choice> {
    let here = model.context();
    let is_meant = |context: Context| {
        context == Context::ALWAYS
            || if context.is_below_dialogs() { model.dialogs.is_empty() } else { context == here }
    };
    let command = |command: &'static Command| Choice {
        hindrance: (command.hindrance)(model),
        ..Choice::new(What::Command(command), command.title.to_owned(), command.help.to_owned())
    };
    let commands = model.commands().filter(|command| is_meant(command.context)).map(command);
    // Panes lie behind a dialog.
    let (tree, library) = (model.tree.as_ref(), &model.library);
    let panes = tree.filter(|_| model.dialogs.is_empty());
    let with_preset = |(row, value)| panes.map(|tree| (tree.preset(), row, value));
    let knobs = panes.into_iter().flat_map(|tree| tree.preset().all_knobs()).filter_map(with_preset);
    let knobs = knobs.map(|(preset, row, value): (_, PresetKnob, Value)| {
        let about = format!("{value}: {}", row.knob.help);
        Choice::new(What::Knob(row.knob.name), shape::called(preset, &row), about)
    });
    let ages = panes.into_iter().flat_map(|tree| shape::ages::ages(tree.preset()));
    let ages = ages.map(|(name, about)| {
        let title = format!("age {}", name.replace('_', " "));
        Choice::new(What::Age(name), title, about)
    });
    let forest = model.forest.as_ref().filter(|_| model.dialogs.is_empty());
    let of_forest = forest.into_iter().flat_map(|forest| forest.wanted().layout.knobs());
    let of_forest = of_forest.map(|(row, value)| {
        let about = format!("{value}: {}", row.knob.help);
        Choice::new(What::Knob(row.knob.name), row.knob.name.to_owned(), about)
    });
    let presets = library.entries.iter().filter(|_| model.dialogs.is_empty()).map(|entry| Choice {
        tags: library.tags_of(entry).into_iter().map(str::to_owned).collect(),
        told: [entry.summary.clone(), entry.source.clone()],
        ..Choice::new(
            What::Preset(entry.place.clone()),
            linden::knob::printable(&entry.id),
            linden::knob::printable(&entry.name),
        )
    });
    let formats = export::formats().into_iter().filter(|_| panes.is_some()).map(|exporter| {
        let format = exporter.format();
        Choice::new(What::Format(format.id), format.id.to_owned(), format!("exports {}", format.name))
    });
    let settings = SETTINGS.iter().filter(|_| model.dialogs.is_empty()).map(|setting| {
        let about = format!("{}: {}", setting.value(&model.config.settings), setting.help);
        Choice::new(What::Setting(setting), setting.name.to_owned(), about)
    });
    commands.chain(ages).chain(knobs).chain(of_forest).chain(presets).chain(formats).chain(settings).collect()
}

/// Changes a setting for this session, and says where it is kept; whether the value was one.
fn set(model: &mut Model, setting: &'static Setting, value: &str, effects: &mut Effects) -> bool {
    match setting.set(&mut model.config.settings, value) {
        Ok(()) => {
            model.say(format!("{} is {value} until you leave; config.toml keeps it", setting.name));
            effects.push(Effect::ApplySettings);
            true
        }
        Err(why) => {
            model.say_warning(format!("{}: {why}", setting.name));
            false
        }
    }
}

#[cfg(test)]
#[path = "palette_tests.rs"]
mod tests;
