//! Editing the wood: an axis is picked, by keys or with the mouse, and edited; edits are part of the preset.
//!
//! Paths name axes of the tree as it grew, so that the cursor stays on its axis when an edit takes others away.

mod commands;
mod curve;
mod line;

use std::sync::Arc;

use crossterm::event::{KeyEvent, MouseEvent};
use glam::Vec3;
use linden::Skeleton;
use linden::preset::Preset;
use linden::skeleton::NO_PARENT;
use linden::skeleton::edit::{AxisPath, AxisPaths, Edit, Operation};
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;

pub use commands::{CAMERA, COMMANDS, CURVE, CURVE_CAMERA};

use self::line::EditLine;
use super::command::Context;
use super::dialog::{After, Dialog};
use super::effect::Effects;
use super::layout::View;
use super::model::Model;
use super::picture;
use super::shape;
use super::tree::Tree;
use crate::figures::{metres, thousands};
use crate::jobs::{Marks, ShownTree};

/// Where the keys of the pick are listened to.
pub const CONTEXT: Context = Context::new(55, "wood", "While editing the wood");

/// The axis that is picked, above the panes.
pub struct WoodPick {
    /// The tree that the axis is of.
    shown: Arc<ShownTree>,
    /// The paths of the tree as it grew.
    paths: AxisPaths,
    /// The laterals of the tree as it is.
    current: AxisPaths,
    /// The axis.
    axis: u32,
    /// Its path.
    path: AxisPath,
    /// From where it leaves to its tip.
    line: Arc<Vec<Vec<Vec3>>>,
    /// Whether leaves are drawn.
    leaves: bool,
}

impl WoodPick {
    /// On the first stem; `None` for a tree without one.
    fn new(shown: &Arc<ShownTree>) -> Option<Self> {
        let (paths, current) = (shown.grown.axis_paths(), AxisPaths::new(&shown.grown.skeleton));
        let path = shown.grown.axis_path(0, &paths)?;
        let line = Arc::new(vec![line_of(&shown.grown.skeleton, 0)]);
        Some(Self { shown: Arc::clone(shown), paths, current, axis: 0, path, line, leaves: false })
    }

    /// Puts the cursor on an axis.
    fn go_to(&mut self, axis: u32) {
        if let Some(path) = self.shown.grown.axis_path(axis, &self.paths) {
            (self.axis, self.path) = (axis, path);
            self.line = Arc::new(vec![line_of(&self.shown.grown.skeleton, axis)]);
        }
    }

    /// The axis that bears this one.
    fn parent(&self) -> Option<u32> {
        self.current.parent(self.axis)
    }

    /// The longest axis that this one bears.
    fn longest(&self) -> Option<u32> {
        let skeleton = &self.shown.grown.skeleton;
        let length = |axis: &&u32| skeleton.axis_length_m(**axis);
        self.current.laterals(self.axis).iter().max_by(|a, b| length(a).total_cmp(&length(b))).copied()
    }

    /// The axis that leaves next above or below, from the same one; of a stem, another stem.
    fn beside(&self, up: bool) -> Option<u32> {
        let stems: Vec<u32>;
        let all = match self.parent() {
            Some(parent) => self.current.laterals(parent),
            None => {
                let axes = &self.shown.grown.skeleton.axes;
                stems =
                    (0..).zip(axes).filter(|(_, axis)| axis.parent == NO_PARENT).map(|(i, _)| i).collect();
                &stems
            }
        };
        let at = all.iter().position(|axis| *axis == self.axis)?;
        let to = if up { at + 1 } else { at.checked_sub(1)? };
        all.get(to).copied()
    }

    /// Another tree is on screen: the cursor stays on the axis of its path, or goes to what bears it.
    fn follow(&mut self, shown: &Arc<ShownTree>) {
        let Some(next) = Self::new(shown) else { return };
        let (path, leaves) = (self.path.clone(), self.leaves);
        *self = Self { leaves, ..next };
        let mut sought = Some(path);
        while let Some(path) = sought {
            let axes = 0..self.shown.grown.skeleton.axes.len() as u32;
            let found = axes
                .into_iter()
                .find(|axis| self.shown.grown.axis_path(*axis, &self.paths).as_ref() == Some(&path));
            if let Some(axis) = found {
                return self.go_to(axis);
            }
            sought = path.parent();
        }
    }

    /// An edit of the axis as it is typed in short.
    fn text(&self, word: &str) -> String {
        let path = &self.path;
        match word {
            "cut" => format!("cut {path} 0.5"),
            "bend" => format!("bend {path} 30 at=0.2 towards=0,1,0"),
            "scale" => format!("scale {path} 0.8 thickness=0.9"),
            "add" => format!("add {path} {} at=0.5", metres(0.4 * self.length_m())),
            _ => format!("{word} {path}"),
        }
    }

    fn length_m(&self) -> f64 {
        self.shown.grown.skeleton.axis_length_m(self.axis)
    }

    /// What the axis is, in a row.
    fn words(&self) -> String {
        let skeleton = &self.shown.grown.skeleton;
        let Some(axis) = skeleton.axes.get(self.axis as usize) else { return self.path.to_string() };
        let nodes = skeleton.nodes_of(axis);
        let foot = skeleton.beginning(self.axis).map_or(0.0, |at| at.y);
        let thick_mm = nodes.first().map_or(0.0, |node| 2e3 * f64::from(skeleton.radii[*node as usize]));
        let bears = self.current.laterals(self.axis).len() as u64;
        format!(
            "{} · {} m long · {} mm thick · begins at {} m · bears {}",
            self.path,
            metres(self.length_m()),
            metres(thick_mm),
            metres(foot),
            thousands(bears),
        )
    }
}

/// An axis from where it leaves to its tip, metres.
fn line_of(skeleton: &Skeleton, axis: u32) -> Vec<Vec3> {
    let Some(axis) = skeleton.axes.get(axis as usize) else { return Vec::new() };
    let from = Some(axis.parent).filter(|parent| *parent != NO_PARENT);
    let nodes = from.into_iter().chain(skeleton.nodes_of(axis).iter().copied());
    nodes.map(|node| skeleton.positions[node as usize]).collect()
}

/// What pictures of a tree mark: nothing while another tree is on its way.
pub fn marks(model: &Model, shown: &Arc<ShownTree>) -> Option<Marks> {
    if let Some(marks) = curve::marks(model) {
        return Some(marks);
    }
    let pick = model.dialogs.find::<WoodPick>()?;
    let lines = if Arc::ptr_eq(&pick.shown, shown) { Arc::clone(&pick.line) } else { Arc::default() };
    Some(Marks { lines, bare: !pick.leaves, ..Marks::default() })
}

/// Begins to edit.
fn open(model: &mut Model) {
    let shown = model.tree.as_ref().and_then(|tree| tree.shown.clone());
    match shown.as_ref().and_then(WoodPick::new) {
        Some(pick) => {
            model.growth.stop();
            model.wind.stop();
            model.dialogs.open(pick);
        }
        None => model.say_warning("this tree has no wood to edit"),
    }
}

/// Adds an edit that was typed to the preset, or puts it in the place of another; why not.
fn add(model: &mut Model, text: &str, replaces: Option<usize>) -> Result<(), String> {
    let Some(tree) = &mut model.tree else { return Err("no preset is chosen".to_owned()) };
    let preset = edited(tree, text, replaces)?;
    tree.replace(preset);
    model.say(format!("edited: {text}; Undo takes it back"));
    Ok(())
}

/// The preset with an edit that was typed, in the place of another where one is named; why there is none.
fn edited(tree: &Tree, text: &str, replaces: Option<usize>) -> Result<Preset, String> {
    let mut preset = tree.preset().clone();
    let place = replaces.filter(|place| *place < preset.edits.len());
    if let Some(place) = place {
        preset.edits.remove(place);
    }
    preset.edit(text).map_err(|error| error.problem)?;
    if let (Some(last), Some(shown)) = (preset.edits.pop(), &tree.shown) {
        let grown = &shown.grown;
        let named = grown.axis_paths();
        // That it is found again when other knobs change the tree a little.
        preset.edits.push(Edit::witnessed(last, &grown.as_grown.skeleton, &named));
    }
    if let Some(place) = place {
        preset.edits[place..].rotate_right(1);
    }
    Ok(preset)
}

/// Takes the axis that is picked away. The one that leaves next above is picked then, or else the one below, or what
/// bore it.
fn remove(model: &mut Model) {
    let Some(pick) = model.dialogs.top::<WoodPick>() else { return };
    let text = pick.text(Operation::Remove.word());
    let next = pick.beside(true).or_else(|| pick.beside(false)).or_else(|| pick.parent());
    match add(model, &text, None) {
        Ok(()) => go(model, |_| next),
        Err(why) => model.say_warning(why),
    }
}

/// Asks how the axis that is picked is to be edited.
fn ask(model: &mut Model, word: &str) {
    let Some(pick) = model.dialogs.top::<WoodPick>() else { return };
    let line = EditLine::new(&pick.text(word), None);
    model.dialogs.open(line);
}

/// Types an edit of the preset anew.
pub fn type_again(model: &mut Model, edit: usize) {
    let text = model.tree.as_ref().and_then(|tree| tree.preset().edits.get(edit));
    if let Some(text) = text.map(ToString::to_string) {
        model.dialogs.open(EditLine::new(&text, Some(edit)));
    }
}

/// Takes an edit out of the preset.
pub fn take_away(model: &mut Model, edit: usize) {
    let Some(tree) = &mut model.tree else { return };
    let mut preset = tree.preset().clone();
    if edit < preset.edits.len() {
        let text = preset.edits.remove(edit).to_string();
        tree.replace(preset);
        model.say(format!("taken away: {text}; Undo gives it back"));
    }
}

/// Changes the pick.
fn with(model: &mut Model, act: impl FnOnce(&mut WoodPick)) {
    if let Some(pick) = model.dialogs.top_mut::<WoodPick>() {
        act(pick);
    }
}

/// Moves the pick to another axis, where there is one.
fn go(model: &mut Model, to: impl FnOnce(&WoodPick) -> Option<u32>) {
    with(model, |pick| {
        if let Some(axis) = to(pick) {
            pick.go_to(axis);
        }
    });
}

/// The axis of which a segment is drawn nearest to a place of the screen.
fn nearest(model: &Model, shown: &ShownTree, column: u16, row: u16) -> Option<u32> {
    let (view, place) = picture::pointed_at(model, column, row)?;
    let skeleton = &shown.grown.skeleton;
    let axis_of = skeleton.axis_of_nodes();
    // Of wood that lies over each other, the thicker one: a trunk can be hit, and a twig beside it, too.
    let cost = |node: usize| {
        let seen = view.project(skeleton.positions[node]);
        let parent = skeleton.positions.get(skeleton.parents[node] as usize);
        let from = parent.map_or(seen.at, |&parent| view.project(parent).at);
        (picture::distance_px(place, from, seen.at) - seen.scale * skeleton.radii[node]).max(0.0)
    };
    let thicker = |a: usize, b: usize| skeleton.radii[b].total_cmp(&skeleton.radii[a]);
    let found =
        (0..skeleton.positions.len()).min_by(|&a, &b| cost(a).total_cmp(&cost(b)).then(thicker(a, b)))?;
    Some(axis_of[found])
}

impl Dialog<Model> for WoodPick {
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
        let found = nearest(model, &self.shown, mouse.column, mouse.row);
        if let Some(axis) = found {
            self.go_to(axis);
        }
        After::Stays
    }

    fn refresh(&mut self, model: &Model) {
        let shown = model.tree.as_ref().and_then(|tree| tree.shown.as_ref());
        if let Some(shown) = shown.filter(|shown| !Arc::ptr_eq(shown, &self.shown)) {
            self.follow(shown);
        }
    }
}

#[cfg(test)]
mod tests;
