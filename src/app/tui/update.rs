//! Takes messages into the model: what each changes, and the effects that follow.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant;

use crossterm::event::{Event, KeyEvent, MouseEvent, MouseEventKind};
use linden_terminal::probe::Capabilities;
use ratatui::layout::Position;

use super::dialog::After;
use super::effect::{Effect, Effects};
use super::layout::{Pane, Target};
use super::model::{Config, Model, QUIET};
use super::tree::TreePlace;
use super::{derivation, export, forest, growth, library, picture, shape, statistics, vary, wind};
use crate::config::Complaint;
use crate::config::presets::UserPreset;
use crate::jobs::{Derivation, ExportNews, HowFar, Measured, Painted, ShownForest, ShownTree, Thumbnail};
use crate::source::forest::AnySource;

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
    Loaded(TreePlace, Result<AnySource, String>),
    /// A preset's file is not there, and what was said of that.
    Gone(TreePlace, String),
    /// How far the growing is.
    Growing(HowFar),
    /// The wanted recipe grew, or why not.
    Grown(Result<Arc<ShownTree>, String>),
    /// The wanted forest grew, or why not.
    ForestGrown(Result<Arc<ShownForest>, String>),
    /// A picture is there.
    Painted(Box<Painted>),
    /// No picture can be had, and why.
    NotPainted(String),
    /// A job panicked: what it was doing, and what it said.
    Broken(&'static str, String),
    /// A picture of the gallery is there.
    Thumbnail(Box<Thumbnail>),
    /// The tree on screen was measured.
    Measured(Box<Measured>),
    /// A word was derived, or why not.
    Derived(Box<Derivation>),
    /// An export's progress or end.
    Export(ExportNews),
    /// A preset was saved, or why not.
    Saved(Result<(String, PathBuf), String>),
    /// There is no folder to save in, and what saves there once it may be made.
    NoFolder(PathBuf, Box<Effect>),
    /// A forest was saved, or why not.
    ForestSaved(Result<PathBuf, String>),
    /// A preset's file was put away, and where it is now; or why not.
    Removed(Result<(PathBuf, Option<PathBuf>), String>),
    /// A preset's file has another name, from which to which; or why not.
    Renamed(Result<(PathBuf, PathBuf), String>),
    /// A preset's file is where it was before it was put away; or why not.
    PutBack(Result<PathBuf, String>),
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
            let (open, said, acts) = (model.dialogs.len(), model.message.clone(), is_act(&event));
            input(model, event, &mut effects);
            // What was said before does not lie over the keys of what is open now, and has nothing to do with what was
            // done since; it is on the page of messages.
            let is_read = acts && said.as_ref().is_some_and(|said| said.read_by <= now);
            if model.message == said && (is_read || model.dialogs.len() > open) {
                model.message = None;
            }
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
        Msg::Gone(place, why) => library::gone(model, place, why, &mut effects),
        Msg::Growing(growing) => {
            if let Some(tree) = &mut model.tree {
                tree.growing = Some(growing);
            } else if let Some(forest) = &mut model.forest {
                forest.growing = Some(growing);
            }
        }
        Msg::Grown(grown) => shape::grown(model, grown),
        Msg::ForestGrown(grown) => forest::grown(model, grown),
        Msg::Painted(painted) => {
            picture::painted(model, *painted);
            growth::seen(model);
            wind::seen(model);
        }
        Msg::NotPainted(why) => {
            model.growth.pause();
            model.wind.stop();
            model.picture.has_failed = true;
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
            if let Some(forest) = &mut model.forest {
                forest.growing = None;
            }
            model.say_error(format!("{doing} failed, which is a fault in linden: {why}; please report it"));
        }
        Msg::Thumbnail(thumbnail) => vary::thumbnail(model, *thumbnail),
        Msg::Measured(measured) => statistics::measured(model, *measured),
        Msg::Derived(derivation) => derivation::derived(model, *derivation),
        Msg::Export(news) => export::news(model, news, &mut effects),
        Msg::Saved(saved) => shape::saved(model, saved, &mut effects),
        Msg::NoFolder(folder, order) => shape::ask_for_folder(model, folder, *order),
        Msg::ForestSaved(saved) => forest::saved(model, saved, &mut effects),
        Msg::Removed(removed) => library::file_removed(model, removed, &mut effects),
        Msg::Renamed(renamed) => library::file_renamed(model, renamed, &mut effects),
        Msg::PutBack(back) => library::put_back(model, back, &mut effects),
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
    model.tell(|dialog, model| {
        dialog.refresh(model);
        After::Stays
    });
    effects
}

/// Whether something is done by it: a key, a click, the wheel, pasted text.
fn is_act(event: &Event) -> bool {
    match event {
        Event::Key(_) | Event::Paste(_) => true,
        Event::Mouse(mouse) => {
            !matches!(mouse.kind, MouseEventKind::Up(_) | MouseEventKind::Drag(_) | MouseEventKind::Moved)
        }
        Event::FocusGained | Event::FocusLost | Event::Resize(..) => false,
    }
}

fn input(model: &mut Model, event: Event, effects: &mut Effects) {
    match event {
        Event::Key(key) => on_key(model, key, effects),
        Event::Mouse(mouse) => on_mouse(model, mouse, effects),
        Event::Paste(text) => on_paste(model, &text, effects),
        // Neither the focus nor the size is the model's: the runtime hears them.
        Event::FocusGained | Event::FocusLost | Event::Resize(..) => {}
    }
}

/// A key: a command, or else something for the topmost dialog.
fn on_key(model: &mut Model, key: KeyEvent, effects: &mut Effects) {
    match model.command_of(key.into()) {
        Some(id) => run(model, id, effects),
        None => drop(model.tell(|dialog, model| dialog.key(model, key, effects))),
    }
}

fn on_paste(model: &mut Model, text: &str, effects: &mut Effects) {
    match library::dropped_path(text).filter(|_| model.dialogs.is_empty()) {
        Some(path) => library::open_path(model, &path, effects),
        None => drop(model.tell(|dialog, model| dialog.paste(model, text, effects))),
    }
}

fn run(model: &mut Model, id: &str, effects: &mut Effects) {
    if let Some(command) = model.command(id) {
        model.run(command, effects);
    }
}

/// The mouse in the topmost dialog, on a spot of it or elsewhere.
fn on_dialog(model: &mut Model, spot: Option<usize>, mouse: MouseEvent, effects: &mut Effects) {
    let wheel = |model: &mut Model, down| {
        model.tell(|dialog, model| {
            dialog.wheel(model, spot, down);
            After::Stays
        });
    };
    match (mouse.kind, spot) {
        (MouseEventKind::Down(_), Some(spot)) => {
            model.tell(|dialog, model| dialog.click(model, spot, mouse, effects));
        }
        (MouseEventKind::ScrollUp, _) => wheel(model, false),
        (MouseEventKind::ScrollDown, _) => wheel(model, true),
        _ => {}
    }
}

/// The pointer moves with a button down, or a button goes up, and the topmost dialog is what is dragged in.
fn dragged(model: &mut Model, mouse: MouseEvent) -> bool {
    if !matches!(mouse.kind, MouseEventKind::Drag(_) | MouseEventKind::Up(_)) {
        return false;
    }
    let mut is_meant = false;
    model.tell(|dialog, model| {
        is_meant = dialog.drag(model, mouse);
        After::Stays
    });
    is_meant
}

fn on_mouse(model: &mut Model, mouse: MouseEvent, effects: &mut Effects) {
    // A drag goes on where it began, wherever the pointer is now.
    if picture::dragged(model, mouse) || dragged(model, mouse) {
        return;
    }
    let at = Position::new(mouse.column, mouse.row);
    let Some(&(_, target)) = model.regions.iter().rev().find(|(area, _)| area.contains(at)) else { return };
    let presses = matches!(mouse.kind, MouseEventKind::Down(_));
    let moves = matches!(mouse.kind, MouseEventKind::ScrollUp | MouseEventKind::ScrollDown);
    // What the row is now: a value that is taken may bring other knobs.
    let row = if let Target::Knob(row) = target { shape::spot_of_row(model, row) } else { None };
    let is_of_list =
        matches!(target, Target::Preset(_) | Target::Knob(_) | Target::Pane(Pane::Presets | Pane::Shape));
    if is_of_list && (presses || moves) {
        model.tell(|dialog, model| dialog.leave(model, effects));
    }
    match target {
        Target::Command(id) if presses => run(model, id, effects),
        Target::Pane(pane) => {
            if presses {
                model.focus_on(pane);
            }
            match pane {
                Pane::Presets => library::wheel(model, mouse, effects),
                Pane::Picture => picture::mouse(model, mouse),
                Pane::Shape => shape::wheel(model, mouse),
            }
        }
        Target::Preset(row) => library::clicked(model, row, mouse, effects),
        Target::Knob(_) => shape::clicked(model, row, mouse),
        Target::Growth(step) if presses => {
            model.growth.stop();
            model.wind.stop();
            growth::go_to(model, step);
        }
        Target::Dialog(spot) => on_dialog(model, spot, mouse, effects),
        Target::Command(_) | Target::Growth(_) => {}
    }
}

/// When something changes by itself next: an animation's frame, a message that leaves, the full picture
/// after the draft. `None`: nothing does, and the program sleeps.
pub fn wake_at(model: &Model) -> Option<Instant> {
    let message = model.message.as_ref().map(|message| message.until);
    let quiet = picture::waits_for_quiet(model).then(|| model.last_input + QUIET);
    let frames = [picture::next_frame(model), model.growth.next_frame(), wind::next_frame(model)];
    let grey = picture::next_grey(model);
    [message, quiet, grey].into_iter().chain(frames).flatten().min()
}
