//! What a message changes, and what is to be done because of it.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant;

use linden_terminal::input::{Event, Key, Mouse, MouseAction};
use linden_terminal::probe::Capabilities;
use ratatui::layout::Position;

use super::command::{self, find};
use super::effect::Effects;
use super::model::{Config, Layer, Model, Target};
use super::tree::{Growing, Place};
use super::{around, export, growth, library, picture, shape, vary, wind};
use crate::config::Complaint;
use crate::config::presets::UserPreset;
use crate::jobs::{Painted, Shown, Thumbnail};
use crate::source::Source;

/// What can happen.
pub enum Msg {
    /// Keys, mouse, pasted text.
    Input(Event),
    /// The terminal has another size: columns, rows.
    Resized(u16, u16),
    /// Time has passed.
    Tick,
    /// The terminal said what it can do.
    Terminal(Box<Capabilities>),
    /// A preset was read, or why not.
    Loaded(Place, Result<Box<Source>, String>),
    /// How far the growing is.
    Growing(Growing),
    /// The wanted recipe grew, or why not.
    Grown(Result<Arc<Shown>, String>),
    /// A picture is there.
    Painted(Box<Painted>),
    /// No picture can be had, and why.
    NotPainted(String),
    /// A job panicked: what it was doing, and what it said.
    Broken(&'static str, String),
    /// A picture of the gallery is there.
    Thumbnail(Box<Thumbnail>),
    /// An export's progress or end.
    Export(export::ExportNews),
    /// A preset was saved, or why not.
    Saved(Result<(String, PathBuf), String>),
    /// Text comes back from `$EDITOR`, or why not.
    Edited(Result<String, String>),
    /// The configuration was read anew.
    Configured(Box<Config>),
    /// The user's presets were read, and what could not be.
    Presets(Vec<UserPreset>, Vec<Complaint>),
    /// Something of the user's cannot be had, one line each.
    Complaints(Vec<String>),
    /// Files changed on disk.
    Changed(Vec<PathBuf>),
}

/// Takes a message into the model.
pub fn update(model: &mut Model, msg: Msg, now: Instant) -> Effects {
    let mut effects = Effects::new();
    model.now = now;
    if model.message.as_ref().is_some_and(|message| message.until <= now) {
        model.message = None;
    }
    match msg {
        Msg::Input(event) => {
            model.last_input = now;
            input(model, event, &mut effects);
        }
        Msg::Resized(columns, rows) => {
            model.size = (columns, rows);
            model.last_input = now;
        }
        Msg::Tick => {
            picture::tick(model);
            growth::tick(model);
            wind::tick(model);
        }
        Msg::Terminal(capabilities) => model.terminal = *capabilities,
        Msg::Loaded(place, source) => library::loaded(model, place, source, &mut effects),
        Msg::Growing(growing) => {
            if let Some(tree) = &mut model.tree {
                tree.growing = Some(growing);
            }
        }
        Msg::Grown(grown) => shape::grown(model, grown),
        Msg::Painted(painted) => {
            picture::painted(model, *painted);
            growth::seen(model);
            wind::seen(model);
        }
        Msg::NotPainted(why) => {
            model.growth.pause();
            model.wind.stop();
            model.say_error(format!("drawing: {why}"));
        }
        Msg::Broken(doing, why) => {
            // Nothing that is waited for comes any more.
            model.loading = None;
            model.growth.pause();
            model.wind.stop();
            if let Some(tree) = &mut model.tree {
                tree.growing = None;
            }
            model.say_error(format!("{doing} failed, which is a fault in linden: {why}; please report it"));
        }
        Msg::Thumbnail(thumbnail) => vary::thumbnail(model, *thumbnail),
        Msg::Export(news) => export::news(model, news, &mut effects),
        Msg::Saved(saved) => shape::saved(model, saved, &mut effects),
        Msg::Edited(text) => shape::edited(model, text),
        Msg::Configured(config) => {
            model.config = *config;
            model.say_complaints();
        }
        Msg::Presets(presets, complaints) => library::listed(model, presets, complaints),
        Msg::Complaints(said) => {
            for complaint in said {
                model.say_warning(complaint);
            }
        }
        Msg::Changed(files) => library::changed(model, &files, &mut effects),
    }
    around::refresh(model);
    effects
}

fn input(model: &mut Model, event: Event, effects: &mut Effects) {
    match event {
        Event::Key(key) => on_key(model, key, effects),
        Event::Mouse(mouse) => on_mouse(model, mouse, effects),
        Event::Paste(text) => on_paste(model, &text, effects),
        Event::Focus(_) | Event::Reply(_) => {}
    }
}

/// A key: to the dialog that takes text, else to the table of commands.
fn on_key(model: &mut Model, key: Key, effects: &mut Effects) {
    if let Some(id) = model.command_of(key) {
        if let Some(command) = find(id) {
            command::run(command, model, effects);
        }
        return;
    }
    match model.layers.last() {
        Some(Layer::Line(_) | Layer::Palette(_)) => around::typed(model, key, effects),
        Some(Layer::Grammar(_)) => shape::typed(model, key),
        Some(Layer::Export(_)) => export::typed(model, key, effects),
        Some(Layer::Page(_) | Layer::Gallery(_)) | None => {}
    }
}

fn on_paste(model: &mut Model, text: &str, effects: &mut Effects) {
    match model.layers.last() {
        Some(Layer::Line(_) | Layer::Palette(_)) => around::pasted(model, text, effects),
        Some(Layer::Grammar(_)) => shape::pasted(model, text),
        Some(Layer::Export(_)) => export::pasted(model, text),
        Some(Layer::Page(_) | Layer::Gallery(_)) | None => {}
    }
}

fn on_mouse(model: &mut Model, mouse: Mouse, effects: &mut Effects) {
    // A drag goes on where it began, wherever the pointer is now.
    if picture::dragged(model, mouse) {
        return;
    }
    let at = Position::new(mouse.column, mouse.row);
    let Some(&(_, target)) = model.regions.iter().rev().find(|(area, _)| area.contains(at)) else { return };
    let presses = matches!(mouse.action, MouseAction::Press(_));
    match target {
        Target::Command(id) if presses => {
            if let Some(command) = find(id) {
                command::run(command, model, effects);
            }
        }
        Target::Pane(pane) => {
            if presses {
                model.focus_on(pane);
            }
            match pane {
                super::model::Pane::Presets => library::wheel(model, mouse, effects),
                super::model::Pane::Picture => picture::mouse(model, mouse),
                super::model::Pane::Shape => shape::wheel(model, mouse),
            }
        }
        Target::Preset(row) => library::clicked(model, row, mouse, effects),
        Target::Knob(row) => shape::clicked(model, row, mouse, effects),
        Target::Grammar => shape::grammar::mouse(model, mouse),
        Target::Thumbnail(cell) => vary::clicked(model, cell, mouse, effects),
        Target::ExportRow(row) => export::clicked(model, row, mouse, effects),
        Target::PaletteRow(row) => around::clicked(model, row, mouse, effects),
        Target::Growth(step) if presses => {
            model.growth.stop();
            model.wind.stop();
            growth::go_to(model, step);
        }
        Target::Dialog => around::wheel(model, mouse),
        Target::Command(_) | Target::Growth(_) => {}
    }
}
