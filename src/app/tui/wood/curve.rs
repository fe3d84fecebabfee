//! Drawing the curve of an axis: its control points are dragged in the picture, in the picture's plane through each.
//!
//! What is drawn is the edit `do = "curve"` of the axis, as it is typed too: the one that the preset has of that axis,
//! or a new one as soon as a point has moved.

use std::sync::Arc;

use crossterm::event::{KeyEvent, MouseEvent};
use glam::{DVec3, Vec3};
use linden::recipe::Recipe;
use linden::skeleton::edit::{AxisPath, Edit, MOST_POINTS, Operation, curve_through};
use linden_raster::Handle;
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;

use super::line::EditLine;
use super::{WoodPick, edited};
use crate::figures::metres;
use crate::jobs::Marks;
use crate::tui::command::Context;
use crate::tui::dialog::{After, Dialog};
use crate::tui::effect::Effects;
use crate::tui::layout::View;
use crate::tui::model::Model;
use crate::tui::picture;
use crate::tui::picture::hold::{self, Hold, Pull};
use crate::tui::shape;
use crate::tui::tree::Tree;

/// Where the keys are listened to.
pub const CONTEXT: Context = Context::new(56, "curve", "While drawing a curve");

/// Points of an axis that was not on a curve before.
const POINTS: usize = 3;
/// How far a key moves a point, in lengths of the axis.
const STEP: f64 = 0.02;
/// To which share of the axis' length places are written.
const GRAIN: f64 = 1e-3;

/// The curve that is drawn, above the pick of its axis.
pub struct CurvePick {
    axis: AxisPath,
    /// Where the axis leaves, metres.
    base: DVec3,
    /// Its length when drawing began, metres.
    length_m: f64,
    /// The control points, metres from the base.
    points: Vec<DVec3>,
    picked: usize,
    hold: Option<Hold>,
    /// The preset's edits when drawing began.
    before: Vec<Edit>,
    /// What the points are those of.
    recipe: Arc<Recipe>,
}

/// The last edit of a preset that leads an axis along a curve, with its points.
fn curve_of<'a>(tree: &'a Tree, path: &AxisPath) -> Option<(usize, &'a [[f64; 3]])> {
    let edits = tree.preset().edits.iter().enumerate().rev();
    edits.filter(|(_, edit)| edit.axis == *path).find_map(|(place, edit)| match &edit.operation {
        Operation::Curve { points } => Some((place, &points[..])),
        _ => None,
    })
}

/// Begins to draw the curve of the axis that is picked.
pub fn open(model: &mut Model) {
    let (Some(pick), Some(tree)) = (model.dialogs.top::<WoodPick>(), &model.tree) else { return };
    let line: Vec<DVec3> = pick.line.first().into_iter().flatten().map(|place| place.as_dvec3()).collect();
    let (Some(&base), true) = (line.first(), pick.length_m() > 0.0) else {
        model.say_warning("this axis has no length that a curve could lead along");
        return;
    };
    let points = match curve_of(tree, &pick.path) {
        Some((_, points)) => points.iter().map(|&point| DVec3::from(point)).collect(),
        None => along(&line, POINTS),
    };
    let drawn = CurvePick {
        axis: pick.path.clone(),
        base,
        length_m: pick.length_m(),
        picked: points.len().saturating_sub(1),
        points,
        hold: None,
        before: tree.preset().edits.clone(),
        recipe: Arc::clone(tree.recipe()),
    };
    model.dialogs.open(drawn);
}

/// Points of a line at equal shares of its length, from its first one; the last is its end.
fn along(line: &[DVec3], count: usize) -> Vec<DVec3> {
    let length_m: f64 = line.windows(2).map(|pair| pair[0].distance(pair[1])).sum();
    let at = |wanted_m: f64| {
        let mut way_m = 0.0;
        for pair in line.windows(2) {
            let piece_m = pair[0].distance(pair[1]);
            if piece_m > 0.0 && way_m + piece_m >= wanted_m {
                return pair[0].lerp(pair[1], (wanted_m - way_m) / piece_m) - line[0];
            }
            way_m += piece_m;
        }
        line.last().map_or(DVec3::ZERO, |end| *end - line[0])
    };
    (1..=count).map(|i| at(length_m * i as f64 / count as f64)).collect()
}

/// Leaves; the curve stays.
pub fn accept(model: &mut Model) {
    model.picture.frozen = None;
    model.dialogs.close::<CurvePick>();
}

/// Types the points.
pub fn type_points(model: &mut Model) {
    let (Some(pick), Some(tree)) = (model.dialogs.top::<CurvePick>(), &model.tree) else { return };
    let line = EditLine::new(&pick.text(), curve_of(tree, &pick.axis).map(|(place, _)| place));
    model.dialogs.open(line);
}

/// What pictures of the tree mark: the curve, and its points.
pub fn marks(model: &Model) -> Option<Marks> {
    let pick = model.dialogs.find::<CurvePick>()?;
    let mut through = vec![pick.base];
    through.extend(pick.points.iter().map(|&point| pick.base + point));
    let line = curve_through(&through).into_iter().map(DVec3::as_vec3).collect();
    let handle = |(i, at)| Handle { at, is_picked: i == pick.picked };
    let handles = pick.places().into_iter().enumerate().map(handle).collect();
    Some(Marks { lines: Arc::new(vec![line]), handles: Arc::new(handles), bare: true })
}

impl CurvePick {
    fn places(&self) -> Vec<Vec3> {
        self.points.iter().map(|&point| (self.base + point).as_vec3()).collect()
    }

    /// The edit as it is typed in short.
    fn text(&self) -> String {
        // A thousandth of the axis tells places apart, and reads well.
        let scale = libm::pow(10.0, -libm::floor(libm::log10(self.length_m * GRAIN))).min(1e9);
        let numbers = self.points.iter().flat_map(DVec3::to_array);
        let numbers: Vec<String> =
            numbers.map(|x| libm::round(x * scale) / scale + 0.0).map(|x| x.to_string()).collect();
        format!("curve {} {}", self.axis, numbers.join(","))
    }

    /// What is picked, in a row.
    fn words(&self) -> String {
        let point = self.points.get(self.picked).copied().unwrap_or_default();
        let [x, y, z] = point.to_array().map(metres);
        format!("point {} of {}: {x}, {y}, {z} m · {}", self.picked + 1, self.points.len(), self.axis)
    }

    /// Whether it has as many points as it may have.
    pub fn is_full(&self) -> bool {
        self.points.len() >= MOST_POINTS
    }

    /// Whether no point may go.
    pub fn has_one_point(&self) -> bool {
        self.points.len() <= 1
    }

    /// Picks another point.
    pub fn go(&mut self, by: isize) {
        let count = self.points.len().max(1) as isize;
        self.picked = (self.picked as isize + by).rem_euclid(count) as usize;
    }

    /// Puts other points in force, by one of the ways in which trees change; whether they can be.
    fn take(&mut self, model: &mut Model, points: Vec<DVec3>, change: Change) -> bool {
        let Some(tree) = &mut model.tree else { return false };
        let last = std::mem::replace(&mut self.points, points);
        let place = curve_of(tree, &self.axis).map(|(place, _)| place);
        match edited(tree, &self.text(), place) {
            Ok(preset) => {
                match change {
                    Change::Drag => tree.drag(preset),
                    Change::Nudge => tree.nudge(preset, model.now),
                    Change::Whole => tree.replace(preset),
                }
                self.recipe = Arc::clone(tree.recipe());
                true
            }
            Err(why) => {
                self.points = last;
                model.say_warning(why);
                false
            }
        }
    }

    fn move_to(&mut self, model: &mut Model, place: DVec3, change: Change) {
        let mut points = self.points.clone();
        if let Some(point) = points.get_mut(self.picked) {
            *point = place - self.base;
            self.take(model, points, change);
        }
    }

    /// Moves the point that is picked by keys: steps to the right and up in the picture.
    pub fn step(&mut self, model: &mut Model, right: f64, up: f64) {
        let Some(&point) = self.points.get(self.picked) else { return };
        let camera = &model.picture.camera;
        let way = camera.right().as_dvec3() * right + camera.up().as_dvec3() * up;
        self.move_to(model, self.base + point + way * (STEP * self.length_m), Change::Nudge);
    }

    /// Adds a point behind the one that is picked: half of the way to the next one, or from the one before the last.
    pub fn add_point(&mut self, model: &mut Model) {
        let at = |i: Option<usize>| i.and_then(|i| self.points.get(i)).copied().unwrap_or(DVec3::ZERO);
        let is_last = self.picked + 1 >= self.points.len();
        let new = if is_last { self.picked } else { self.picked + 1 };
        let middle = at(new.checked_sub(1)).midpoint(at(Some(new)));
        let mut points = self.points.clone();
        points.insert(new, middle);
        if self.take(model, points, Change::Whole) {
            self.picked = new;
        }
    }

    /// Takes the point that is picked away.
    pub fn remove_point(&mut self, model: &mut Model) {
        let mut points = self.points.clone();
        if self.picked < points.len() && points.len() > 1 {
            points.remove(self.picked);
            if self.take(model, points, Change::Whole) {
                self.picked = self.picked.min(self.points.len() - 1);
            }
        }
    }
}

/// How a change of points is undone.
#[derive(Clone, Copy)]
enum Change {
    /// With the drag that it is part of.
    Drag,
    /// With the keys around it.
    Nudge,
    /// By itself.
    Whole,
}

impl Dialog<Model> for CurvePick {
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
        if let Some((picked, hold)) = hold::take(model, mouse, &self.places()) {
            (self.picked, self.hold) = (picked, Some(hold));
            if let Some(tree) = &mut model.tree {
                tree.begin_drag();
            }
        }
        After::Stays
    }

    fn drag(&mut self, model: &mut Model, mouse: MouseEvent) -> bool {
        let held = self.hold;
        match (hold::pull(model, &mut self.hold, mouse), held) {
            (Pull::Nothing, _) => return false,
            (Pull::To(view, at), Some(held)) => {
                self.move_to(model, held.place(&view, at).as_dvec3(), Change::Drag);
            }
            _ => {}
        }
        true
    }

    /// The wood is what it was before.
    fn cancel(&mut self, model: &mut Model, _effects: &mut Effects) {
        model.picture.frozen = None;
        let Some(tree) = &mut model.tree else { return };
        if tree.preset().edits != self.before {
            let mut preset = tree.preset().clone();
            preset.edits.clone_from(&self.before);
            tree.replace(preset);
            model.say("the axis is as it was; Undo gives the curve back");
        }
    }

    /// What was undone or typed: the points are those of what is there now.
    fn refresh(&mut self, model: &Model) {
        let Some(tree) = model.tree.as_ref().filter(|tree| !Arc::ptr_eq(tree.recipe(), &self.recipe)) else {
            return;
        };
        self.recipe = Arc::clone(tree.recipe());
        if let Some((_, points)) = curve_of(tree, &self.axis) {
            self.points = points.iter().map(|&point| DVec3::from(point)).collect();
            self.picked = self.picked.min(self.points.len().saturating_sub(1));
        }
    }
}
