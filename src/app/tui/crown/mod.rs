//! Shaping the crown: its profile and dimensions are dragged in the picture, by handles.

mod commands;

use std::sync::Arc;

use crossterm::event::{KeyEvent, MouseEvent};
use glam::{Vec2, Vec3};
use linden::preset::{Colonization, CrownDraft, CrownHandle, HandleMoves, Preset};
use linden::recipe::Recipe;
use linden_raster::{Handle, View as PictureView};
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;

pub use commands::{CAMERA, COMMANDS};

use super::command::Context;
use super::dialog::{After, Dialog};
use super::effect::Effects;
use super::layout::View;
use super::model::{Model, without_tree};
use super::picture;
use super::picture::hold::{self, Hold, Pull};
use super::shape;
use crate::jobs::Marks;

/// Where the keys are listened to.
pub const CONTEXT: Context = Context::new(53, "crown", "While shaping the crown");

/// Steps of the draft's grain that a key moves a handle.
const STEPS_A_KEY: f64 = 2.0;

/// The crown that is shaped, above the panes.
pub struct CrownPick {
    /// What it is the crown of.
    recipe: Arc<Recipe>,
    draft: CrownDraft,
    /// The handle that keys move.
    picked: usize,
    hold: Option<Hold>,
    /// Whether the outline was shown before.
    outline: bool,
}

/// Metres, to the millimetre.
fn short(metres: f64) -> String {
    ((metres * 1e3).round() / 1e3 + 0.0).to_string()
}

/// The crown of a preset as it can be dragged, or why it cannot.
fn draft_of(preset: &Preset) -> Result<CrownDraft, String> {
    let settings = preset.settings::<Colonization>();
    let has_none = || "this tree fills no crown shape; one that grows by space colonization does".to_owned();
    settings.ok_or_else(has_none)?.crown_draft()
}

/// Why the crown cannot be shaped.
fn hindrance(model: &Model) -> Option<String> {
    let is_busy = || (!model.dialogs.is_empty()).then(|| "a dialog is open".to_owned());
    let has_none = || draft_of(model.tree.as_ref()?.preset()).err();
    is_busy().or_else(|| without_tree(model)).or_else(has_none)
}

/// Begins to shape.
fn open(model: &mut Model) {
    let Some(tree) = &mut model.tree else { return };
    let Ok(draft) = draft_of(tree.preset()) else { return };
    tree.compares = false;
    let pick = CrownPick {
        recipe: Arc::clone(tree.recipe()),
        draft,
        picked: 0,
        hold: None,
        outline: model.picture.outline,
    };
    model.growth.stop();
    model.wind.stop();
    model.picture.outline = true;
    model.dialogs.open(pick);
}

/// Leaves.
fn close(model: &mut Model) {
    if let Some(pick) = model.dialogs.top::<CrownPick>() {
        model.picture.outline = pick.outline;
        model.picture.frozen = None;
        model.dialogs.close::<CrownPick>();
    }
}

/// What pictures of a tree mark: the profile in their plane, on both sides, and its handles on the right.
pub fn marks(model: &Model) -> Option<Marks> {
    let pick = model.dialogs.find::<CrownPick>()?;
    let right = model.picture.camera.right();
    let at = |[height_m, radius_m]: [f64; 2], side: f32| {
        pick.draft.base.as_vec3() + Vec3::Y * height_m as f32 + right * (side * radius_m as f32)
    };
    let line = |side: f32| pick.draft.profile.iter().map(|&pair| at(pair, side)).collect();
    let places = pick.places(right).into_iter().enumerate();
    let handles = places.map(|(i, at)| Handle { at, is_picked: i == pick.picked }).collect();
    Some(Marks { lines: Arc::new(vec![line(1.0), line(-1.0)]), handles: Arc::new(handles), bare: false })
}

impl CrownPick {
    /// Where the handles are, in a plane through the axis.
    fn places(&self, right: Vec3) -> Vec<Vec3> {
        let base = self.draft.base.as_vec3();
        let place =
            |handle: &CrownHandle| base + Vec3::Y * handle.height_m as f32 + right * handle.radius_m as f32;
        self.draft.handles.iter().map(place).collect()
    }

    fn handle(&self) -> Option<&CrownHandle> {
        self.draft.handles.get(self.picked)
    }

    /// What is picked, in a row.
    fn words(&self) -> String {
        let Some(handle) = self.handle() else { return "no crown".to_owned() };
        let (height, radius) = (short(handle.height_m), short(handle.radius_m));
        let value = match handle.moves {
            HandleMoves::Across => format!("{} {radius} m", handle.knob),
            HandleMoves::Upright if handle.pair.is_none() && handle.height_m == 0.0 => {
                format!("{} {} m", handle.knob, short(self.draft.base.y))
            }
            HandleMoves::Upright => format!("{} {height} m", handle.knob),
            HandleMoves::Both => {
                let pair = handle.pair.map_or(0, |pair| pair + 1);
                format!("{} {pair}: {height} m up, {radius} out", handle.knob)
            }
        };
        format!("{value} · {} of {}", self.picked + 1, self.draft.handles.len())
    }

    /// Picks another handle.
    fn go(&mut self, by: usize) {
        let count = self.draft.handles.len().max(1);
        self.picked = (self.picked + by) % count;
    }

    /// Where a pixel of the picture is in the profile: its height above the base and its distance from the axis.
    fn profile_place(&self, view: &PictureView, at: Vec2) -> Option<(f64, f64)> {
        let (base, handle) = (self.draft.base.as_vec3(), self.handle()?);
        let right = view.right();
        if let Some(place) = view.on_plane(at, base, right.cross(Vec3::Y)) {
            let from_base = place - base;
            return Some((f64::from(from_base.y), f64::from(from_base.dot(right))));
        }
        // From far above heights are not seen: they stay.
        let level = base + Vec3::Y * handle.height_m as f32;
        let place = view.on_plane(at, level, Vec3::Y)?;
        Some((handle.height_m, f64::from((place - base).dot(right))))
    }

    /// Moves the handle that is picked: `drags` as part of a drag, otherwise by a key.
    fn move_to(&mut self, model: &mut Model, height_m: f64, radius_m: f64, drags: bool) {
        let Some(tree) = &mut model.tree else { return };
        let Some(settings) = tree.preset().settings::<Colonization>() else { return };
        let Some(handle) = self.handle() else { return };
        let Some(value) = settings.dragged(&self.draft, self.picked, height_m, radius_m) else { return };
        let mut preset = tree.preset().clone();
        let turned = preset.set(handle.knob, &value.to_string()).map_err(|error| error.to_string());
        match turned.and_then(|()| draft_of(&preset)) {
            // What would enclose nothing is not taken.
            Err(why) => model.say_warning(why),
            Ok(draft) => {
                if drags {
                    tree.drag(preset);
                } else {
                    tree.nudge(preset, model.now);
                }
                self.draft = draft;
                self.recipe = Arc::clone(tree.recipe());
            }
        }
    }

    /// Moves the handle that is picked by keys: steps up, and away from the axis.
    fn step(&mut self, model: &mut Model, up: f64, out: f64) {
        let Some(handle) = self.handle().copied() else { return };
        let step_m = STEPS_A_KEY * self.draft.grain_m();
        self.move_to(model, handle.height_m + up * step_m, handle.radius_m + out * step_m, false);
    }

    /// Gives a profile one pair more or fewer.
    fn change_pairs(&mut self, model: &mut Model, adds: bool) {
        let Some(tree) = &mut model.tree else { return };
        let Some(settings) = tree.preset().settings::<Colonization>() else { return };
        let Some(handle) = self.handle().copied() else { return };
        let (value, pair) = if adds {
            let Some((value, at)) = settings.with_pair(&handle) else { return };
            (value, at)
        } else {
            let Some(value) = settings.without_pair(&handle) else { return };
            (value, handle.pair.unwrap_or(0).saturating_sub(1))
        };
        let mut preset = tree.preset().clone();
        let turned = preset.set(handle.knob, &value.to_string()).map_err(|error| error.to_string());
        match turned.and_then(|()| draft_of(&preset)) {
            Err(why) => model.say_warning(why),
            Ok(draft) => {
                tree.replace(preset);
                self.picked = draft.handles.iter().position(|one| one.pair == Some(pair)).unwrap_or(0);
                self.draft = draft;
                self.recipe = Arc::clone(tree.recipe());
            }
        }
    }
}

impl Dialog<Model> for CrownPick {
    fn context(&self) -> Context {
        CONTEXT
    }

    fn is_prompt(&self) -> bool {
        true
    }

    fn paint(&self, model: &Model, _screen: Rect, buffer: &mut Buffer, view: &mut View) {
        picture::view::banner(model, &self.words(), buffer, view);
    }

    /// Undo and redo, by the keys that they have everywhere.
    fn key(&mut self, model: &mut Model, key: KeyEvent, effects: &mut Effects) -> After {
        shape::undo_or_redo(model, key, effects);
        After::Stays
    }

    fn click(&mut self, model: &mut Model, _spot: usize, mouse: MouseEvent, _effects: &mut Effects) -> After {
        let places = self.places(model.picture.camera.right());
        if let Some((picked, hold)) = hold::take(model, mouse, &places) {
            (self.picked, self.hold) = (picked, Some(hold));
            if let Some(tree) = &mut model.tree {
                tree.begin_drag();
            }
        }
        After::Stays
    }

    fn drag(&mut self, model: &mut Model, mouse: MouseEvent) -> bool {
        match hold::pull(model, &mut self.hold, mouse) {
            Pull::Nothing => return false,
            Pull::Ends => {}
            Pull::To(view, at) => {
                if let Some((height_m, radius_m)) = self.profile_place(&view, at) {
                    self.move_to(model, height_m, radius_m, true);
                }
            }
        }
        true
    }

    fn cancel(&mut self, model: &mut Model, _effects: &mut Effects) {
        model.picture.outline = self.outline;
        model.picture.frozen = None;
    }

    /// What was undone, or read again: the handles are those of what is there now.
    fn refresh(&mut self, model: &Model) {
        let Some(tree) = &model.tree else { return };
        if Arc::ptr_eq(tree.recipe(), &self.recipe) {
            return;
        }
        self.recipe = Arc::clone(tree.recipe());
        if let Ok(draft) = draft_of(tree.preset()) {
            self.picked = self.picked.min(draft.handles.len().saturating_sub(1));
            self.draft = draft;
        } else {
            self.draft.handles.clear();
        }
    }
}

#[cfg(test)]
mod tests;
