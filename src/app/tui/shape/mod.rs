//! The form of knobs, made from the preset's own table; undo, comparison, saving; the grammar.

mod commands;
pub mod grammar;
pub mod view;

use std::path::PathBuf;
use std::sync::Arc;

use linden::knob::Value;
use linden::preset::{Generator, Preset, PresetKnob, Section};
use linden_terminal::input::{Key, Mouse, MouseAction};

pub use commands::COMMANDS;
pub use grammar::GrammarEditor;

use super::effect::Effects;
use super::model::{Model, Pane};
use super::picture;
use super::tree::{Nudge, Place, nudged};
use crate::jobs::Shown;

/// Where the cursor is in the form.
#[derive(Debug, Default)]
pub struct Form {
    /// The name of the knob that the cursor is on; by name, so that it stays when a choice brings
    /// other knobs.
    selected: Option<&'static str>,
}

/// A row of the form.
#[derive(Clone)]
pub enum Row {
    /// A section's heading.
    Heading(Section),
    /// A line of the grammar.
    Rule(String),
    /// A knob with its value.
    Knob(PresetKnob, Value),
}

impl Form {
    /// To the first knob.
    pub fn reset(&mut self) {
        self.selected = None;
    }
}

/// The rows for a preset.
pub fn rows(preset: &Preset) -> Vec<Row> {
    let knobs = preset.knobs();
    let mut rows = Vec::new();
    for section in Section::ALL {
        let own: Vec<_> = knobs.iter().filter(|(row, _)| row.section == section).collect();
        if own.is_empty() {
            continue;
        }
        if section != Section::Tree {
            rows.push(Row::Heading(section));
        }
        if let (Section::LSystem, Generator::LSystem(lsystem)) = (section, &preset.generator) {
            rows.extend(grammar::lines(&lsystem.grammar).into_iter().map(Row::Rule));
        }
        rows.extend(own.into_iter().map(|(row, value)| Row::Knob(*row, value.clone())));
    }
    rows
}

/// The knob that the cursor is on, with its value.
pub fn selected(model: &Model) -> Option<(PresetKnob, Value)> {
    let knobs = model.tree.as_ref()?.preset().knobs();
    let at = knobs.iter().position(|(row, _)| Some(row.knob.name) == model.form.selected).unwrap_or(0);
    knobs.into_iter().nth(at)
}

/// Moves the cursor by so many knobs.
fn step(model: &mut Model, by: isize) {
    let Some(tree) = &model.tree else { return };
    let names: Vec<_> = in_order(tree.preset());
    let at = names.iter().position(|name| Some(*name) == model.form.selected).unwrap_or(0);
    let to = at.saturating_add_signed(by).min(names.len().saturating_sub(1));
    model.form.selected = names.get(to).copied();
}

/// The knobs as the form has them, section by section.
fn in_order(preset: &Preset) -> Vec<&'static str> {
    let knob = |row| if let Row::Knob(own, _) = row { Some(own.knob.name) } else { None };
    rows(preset).into_iter().filter_map(knob).collect()
}

/// Nudges the selected knob.
fn nudge(model: &mut Model, up: bool, how: Nudge) {
    let Some((row, value)) = selected(model) else { return };
    let Some(text) = nudged(&row.knob.kind, &value, up, how) else {
        model.say(format!("{} is typed: press Enter ({})", row.knob.name, row.knob.kind));
        return;
    };
    turn(model, row.knob.name, &text);
}

/// Turns a knob to what was typed; says why not.
pub fn turn(model: &mut Model, name: &'static str, text: &str) {
    let now = model.now;
    if let Some(tree) = &mut model.tree
        && let Err(error) = tree.set(name, text, now)
    {
        model.say_warning(error.to_string());
    }
}

/// The wanted recipe grew, or why not.
pub fn grown(model: &mut Model, grown: Result<Arc<Shown>, String>) {
    let Some(tree) = &mut model.tree else { return };
    tree.growing = None;
    match grown {
        // What grew for another recipe comes too late.
        Ok(shown) if !Arc::ptr_eq(&shown.recipe, tree.wanted()) => {}
        Ok(shown) => {
            tree.fault = None;
            let is_first = tree.shown.is_none();
            for note in &shown.grown.notes {
                tracing::debug!(note, "growing");
            }
            tree.shown = Some(Arc::clone(&shown));
            if is_first {
                picture::first_look(model, &shown);
            }
        }
        Err(why) => {
            tree.fault = Some(why.clone());
            model.say_error(why);
        }
    }
}

/// A preset was saved, or why not.
pub fn saved(model: &mut Model, saved: Result<(String, PathBuf), String>, effects: &mut Effects) {
    match saved {
        Ok((id, path)) => {
            let shown = crate::source::show(&path);
            model.say(format!("saved as '{id}' in {shown}"));
            if let Some(tree) = &mut model.tree {
                let mut recipe = (**tree.recipe()).clone();
                recipe.preset.id = id;
                tree.saved_as(Place::File(path), Arc::new(recipe));
            }
            effects.push(super::effect::Effect::Reconfigure);
        }
        Err(why) => model.say_error(why),
    }
}

/// Text comes back from `$EDITOR`.
pub fn edited(model: &mut Model, text: Result<String, String>) {
    match text {
        Ok(text) => grammar::take_text(model, &text),
        Err(why) => model.say_error(why),
    }
}

/// A key for the grammar's editor.
pub fn typed(model: &mut Model, key: Key) {
    grammar::typed(model, key);
}

/// Pasted text for the grammar's editor.
pub fn pasted(model: &mut Model, text: &str) {
    grammar::pasted(model, text);
}

/// The mouse over the form.
pub fn wheel(model: &mut Model, mouse: Mouse) {
    match mouse.action {
        MouseAction::WheelUp => step(model, -1),
        MouseAction::WheelDown => step(model, 1),
        _ => {}
    }
}

/// The mouse on a row of the form: selects; the wheel turns the knob with Ctrl, else moves on.
pub fn clicked(model: &mut Model, row: usize, mouse: Mouse, _effects: &mut Effects) {
    let Some(tree) = &model.tree else { return };
    let Some(Row::Knob(own, _)) = rows(tree.preset()).into_iter().nth(row) else {
        return wheel(model, mouse);
    };
    match mouse.action {
        MouseAction::Press(_) => {
            model.focus_on(Pane::Shape);
            model.form.selected = Some(own.knob.name);
        }
        MouseAction::WheelUp | MouseAction::WheelDown if mouse.ctrl => {
            model.form.selected = Some(own.knob.name);
            nudge(model, mouse.action == MouseAction::WheelUp, Nudge::Usual);
        }
        _ => wheel(model, mouse),
    }
}
