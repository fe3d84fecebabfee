//! Handles in the picture: which of them the pointer takes hold of, and where it moves it.

use crossterm::event::{MouseButton, MouseEvent, MouseEventKind};
use glam::{Vec2, Vec3};
use linden_raster::View;

use super::{pointed_at, wanted};
use crate::tui::model::Model;

/// Rows of cells around a handle within which the pointer takes hold of it.
const REACH_ROWS: f32 = 1.5;

/// A handle that is held.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hold {
    /// From the pointer to the handle, pixels.
    offset: Vec2,
    /// From the lens to the handle, metres.
    depth_m: f32,
}

/// What the pointer does to a handle that is held.
#[derive(Clone, Copy, Debug)]
pub enum Pull {
    /// It holds one no more, or never did.
    Nothing,
    /// It lets go.
    Ends,
    /// It pulls it to a pixel.
    To(View, Vec2),
}

impl Hold {
    /// The place that a pixel shows at the depth of the handle.
    pub fn place(&self, view: &View, at: Vec2) -> Vec3 {
        view.place(at, self.depth_m)
    }
}

/// Takes hold of the handle at the pointer, and keeps what is framed; where there is none, the tree is turned. Which
/// handle it is.
pub fn take(model: &mut Model, mouse: MouseEvent, handles: &[Vec3]) -> Option<(usize, Hold)> {
    model.picture.turn(None);
    let found = (mouse.kind == MouseEventKind::Down(MouseButton::Left))
        .then(|| nearest(model, mouse, handles))
        .flatten();
    match &found {
        Some(_) => model.picture.frozen = wanted(model).and_then(|request| request.camera.extent),
        None => model.picture.drag = Some((mouse.column, mouse.row)),
    }
    found
}

fn nearest(model: &Model, mouse: MouseEvent, handles: &[Vec3]) -> Option<(usize, Hold)> {
    let (view, pointer) = pointed_at(model, mouse.column, mouse.row)?;
    let (_, high) = wanted(model)?.medium.cell_px;
    let seen = handles.iter().map(|&place| view.project(place)).enumerate();
    let away = |at: Vec2| at.distance(pointer);
    let (i, seen) = seen.min_by(|(_, a), (_, b)| away(a.at).total_cmp(&away(b.at)))?;
    let hold = Hold { offset: seen.at - pointer, depth_m: seen.depth_m };
    (away(seen.at) <= REACH_ROWS * f32::from(high)).then_some((i, hold))
}

/// What the pointer does now.
pub fn pull(model: &mut Model, hold: &mut Option<Hold>, mouse: MouseEvent) -> Pull {
    let Some(held) = *hold else { return Pull::Nothing };
    if matches!(mouse.kind, MouseEventKind::Up(_)) {
        let_go(model, hold);
        return Pull::Ends;
    }
    match pointed_at(model, mouse.column, mouse.row) {
        Some((view, pointer)) => Pull::To(view, pointer + held.offset),
        None => Pull::Ends,
    }
}

/// Lets go of what is held, and frames the whole again.
pub fn let_go(model: &mut Model, hold: &mut Option<Hold>) {
    *hold = None;
    model.picture.frozen = None;
}
