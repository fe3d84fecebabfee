//! The picture, and how it is looked at.

mod commands;
pub mod hold;
pub mod view;

use std::sync::Arc;
use std::time::{Duration, Instant};

use crossterm::event::{KeyModifiers, MouseButton, MouseEvent, MouseEventKind};
use glam::Vec2;
use linden::grow::Obstruction;
use linden_raster::{Camera, Paint, Size, View};
use linden_terminal::Encoded;
use linden_terminal::probe::Graphics;
use ratatui::layout::Rect;

pub use commands::{COMMANDS, camera_rows};

use super::crown;
use super::derivation;
use super::layout::Pane;
use super::model::{Model, PictureState, QUIET};
use super::wood;
use crate::jobs::{
    Detail, DrawRequest, FOREST_PITCH_DEG, FOREST_YAW_DEG, Framed, Medium, Painted, PictureLook, ShownForest,
    ShownTree, Subject,
};

/// Frames a second of what moves by itself: here, and where each costs bytes on a network.
const FRAME: Duration = Duration::from_millis(66);
const FRAME_REMOTE: Duration = Duration::from_millis(250);
/// A full picture that takes less is drawn at once, without a draft before it.
const FAST: Duration = Duration::from_millis(14);
/// How long the picture of the tree before stands as it is: what comes sooner would flicker.
const GREYS: Duration = Duration::from_millis(250);
/// Nodes of a tree whose surface takes seconds.
const LARGE: usize = 5000;
/// Degrees a cell of dragging.
const DRAG_DEG: f32 = 3.0;

/// Whether something moves by itself.
fn is_moving(model: &Model) -> bool {
    model.picture.is_turning() || model.growth.is_playing() || model.wind.is_blowing()
}

/// Whether a better picture is to be drawn as soon as nothing happens.
pub fn waits_for_quiet(model: &Model) -> bool {
    let painted = model.picture.painted.as_ref();
    !is_moving(model)
        && model.now < model.last_input + QUIET
        && painted.is_some_and(|painted| painted.request.detail == Detail::Draft)
}

/// From this height on, the lowest row tells the scale.
const WITH_SCALE: u16 = 8;

/// The cells of the picture, and the row of the scale below (empty where there is no room).
fn split(inner: Rect) -> (Rect, Rect) {
    if inner.height < WITH_SCALE {
        return (inner, Rect { height: 0, ..inner });
    }
    let picture = Rect { height: inner.height - 1, ..inner };
    (picture, Rect { y: picture.bottom(), height: 1, ..inner })
}

/// The cells of the picture itself, `None` when it is not on screen.
pub fn area(model: &Model) -> Option<Rect> {
    let (picture, _) = split(model.layout().text(Pane::Picture)?);
    Some(picture).filter(|area| !area.is_empty())
}

/// The pause between frames of what moves by itself.
pub fn frame_time(model: &Model) -> Duration {
    if model.terminal.remote.value { FRAME_REMOTE } else { FRAME }
}

/// When the turntable moves next.
pub fn next_frame(model: &Model) -> Option<Instant> {
    model.picture.turning.map(|last| last + frame_time(model))
}

/// Turns the turntable.
pub fn tick(model: &mut Model) {
    if let Some(last) = model.picture.turning
        && next_frame(model).is_some_and(|due| due <= model.now)
    {
        let seconds = model.now.saturating_duration_since(last).as_secs_f32().min(0.5);
        let speed = model.config.settings.turntable_deg_per_s as f32;
        turn_by(&mut model.picture.camera, speed * seconds);
        model.picture.turning = Some(model.now);
    }
}

/// Turns round the tree.
fn turn_by(camera: &mut Camera, degrees: f32) {
    camera.yaw_deg = (camera.yaw_deg + degrees).rem_euclid(360.0);
}

/// Another tree is on screen: the whole of it, from its broad side once it has grown.
pub fn reset(model: &mut Model) {
    let now = model.now;
    let picture = &mut model.picture;
    if !(picture.is_of_before && picture.painted.is_some()) {
        picture.left_at = Some(now);
    }
    picture.is_of_before = picture.painted.is_some();
    picture.has_failed = false;
    (picture.drag, picture.level, picture.frozen, picture.slice_m) = (None, None, None, None);
    if picture.keeps_camera {
        return;
    }
    picture.camera.zoom = 1.0;
    picture.camera.pan = Vec2::ZERO;
}

/// The picture that should be on screen, `None` when there is nothing to draw or no room.
pub fn wanted(model: &Model) -> Option<DrawRequest> {
    let area = area(model)?;
    if let Some(forest) = &model.forest {
        return Some(of_forest(model, forest.shown.as_ref()?, area));
    }
    if let Some((word, marks)) = derivation::shown(model) {
        let camera = Camera { extent: word.extent, ..model.picture.camera };
        let look = PictureLook::Skeleton(Paint::Wood);
        let plain = plain(model, Subject::Word(Arc::clone(word)), area);
        return Some(DrawRequest { camera, look, marks: Some(marks), ..plain });
    }
    let shown = model.tree.as_ref()?.shown.as_ref()?;
    let picture = &model.picture;
    let marks = wood::marks(model, shown).or_else(|| crown::marks(model));
    // What is pointed at is somewhere else, and what grows or sways is seen whole.
    let is_still = model.growth.step().is_none() && model.wind.frame().is_none();
    let slice = picture.slice_m.filter(|_| marks.is_none() && is_still).map(|height_m| shown.slice(height_m));
    let person = picture.scale && model.config.settings.person && slice.is_none();
    Some(DrawRequest {
        subject: Subject::Tree(Arc::clone(shown)),
        stage: model.growth.step(),
        wind: model.wind.frame().filter(|_| model.growth.step().is_none()),
        level: level(model),
        camera: Camera {
            extent: Some(picture.frozen.unwrap_or_else(|| shown.extent(framed(picture), person))),
            ..picture.camera
        },
        look: picture.look,
        slice,
        points: picture.points,
        outline: picture.outline,
        obstructions: picture.obstructions,
        person,
        marks,
        area,
        medium: Medium::of(&model.terminal, model.config.settings.scenery),
        detail: detail(model),
    })
}

/// What stands beside the tree or the trees on screen.
fn beside(model: &Model) -> &[Obstruction] {
    let tree = model.tree.as_ref().and_then(|tree| tree.shown.as_ref()).map(|shown| &shown.obstructions[..]);
    let forest = model.forest.as_ref().and_then(|forest| forest.shown.as_ref());
    tree.or_else(|| forest.map(|shown| &shown.obstructions[..])).unwrap_or_default()
}

/// What is framed with what is shown.
fn framed(picture: &PictureState) -> Framed {
    match (picture.points || picture.outline, picture.obstructions) {
        (true, _) => Framed::All,
        (false, true) => Framed::Beside,
        (false, false) => Framed::Tree,
    }
}

/// The picture of a forest: its surfaces, whatever look is chosen for trees.
fn of_forest(model: &Model, shown: &Arc<ShownForest>, area: Rect) -> DrawRequest {
    let plain = plain(model, Subject::Forest(Arc::clone(shown)), area);
    let obstructions = model.picture.obstructions;
    let extent = if obstructions { shown.beside } else { shown.extent };
    DrawRequest { obstructions, camera: Camera { extent, ..plain.camera }, ..plain }
}

/// The picture of something as it is, with nothing beside it.
fn plain(model: &Model, subject: Subject, area: Rect) -> DrawRequest {
    DrawRequest {
        camera: Camera { extent: subject.extent(), ..model.picture.camera },
        subject,
        stage: None,
        wind: None,
        level: None,
        look: PictureLook::Surface,
        slice: None,
        points: false,
        outline: false,
        obstructions: false,
        person: false,
        marks: None,
        area,
        medium: Medium::of(&model.terminal, model.config.settings.scenery),
        detail: detail(model),
    }
}

/// How the picture is seen, in pixels, and the pixel in the middle of a cell of the screen.
pub fn pointed_at(model: &Model, column: u16, row: u16) -> Option<(View, Vec2)> {
    let request = wanted(model)?;
    let (area, (wide, high)) = (request.area, request.medium.cell_px);
    let view = seen(&request)?;
    let middle = |cell: u16, from: u16, px: u16| (f32::from(cell.saturating_sub(from)) + 0.5) * f32::from(px);
    Some((view, Vec2::new(middle(column, area.x, wide), middle(row, area.y, high))))
}

/// How a picture is seen, in pixels of the cells that it fills.
fn seen(request: &DrawRequest) -> Option<View> {
    let (area, (wide, high)) = (request.area, request.medium.cell_px);
    let size =
        Size::new(u32::from(area.width) * u32::from(wide), u32::from(area.height) * u32::from(high)).ok()?;
    Some(request.camera.view(request.subject.extent()?, size))
}

/// How far a pixel is from a line between two others.
pub fn distance_px(place: Vec2, from: Vec2, to: Vec2) -> f32 {
    let along = to - from;
    let share = ((place - from).dot(along) / along.length_squared().max(f32::MIN_POSITIVE)).clamp(0.0, 1.0);
    place.distance(from + along * share)
}

/// The level of detail that is shown: none where the tree has no such level any more, or moves.
fn level(model: &Model) -> Option<usize> {
    let is_still = model.wind.frame().is_none() && model.growth.step().is_none();
    model.picture.level.filter(|level| *level < levels(model) && is_still)
}

/// How many levels of detail the tree on screen has; 0 without a tree.
fn levels(model: &Model) -> usize {
    model.tree.as_ref().map_or(0, |tree| tree.wanted().preset.dressing.detail.levels())
}

fn detail(model: &Model) -> Detail {
    let is_recent = model.now < model.last_input + QUIET;
    let hurried = !model.picture.fast && (is_moving(model) || is_recent || lacks_its_own(model));
    if hurried { Detail::Draft } else { Detail::Full }
}

/// Whether nothing of what is chosen was drawn yet: a draft of it comes before all else. On a network, where it costs
/// bytes, that of a tree alone whose full picture takes seconds, and no pixels.
fn lacks_its_own(model: &Model) -> bool {
    let picture = &model.picture;
    let is_worth_it = || {
        let is_large = |shown: &Arc<ShownTree>| shown.grown.skeleton.positions.len() > LARGE;
        let tree = model.tree.as_ref().and_then(|tree| tree.shown.as_ref());
        model.terminal.graphics.value == Graphics::Cells && tree.is_some_and(is_large)
    };
    (picture.is_of_before || picture.painted.is_none()) && (!model.terminal.remote.value || is_worth_it())
}

/// When the picture of the tree before is greyed; `None` where there is none, and on a network.
fn greys_at(model: &Model) -> Option<Instant> {
    let picture = &model.picture;
    let since = picture.left_at.filter(|_| picture.is_of_before && !model.terminal.remote.value);
    since.map(|left| left + GREYS)
}

/// When that happens by itself.
pub fn next_grey(model: &Model) -> Option<Instant> {
    greys_at(model).filter(|at| *at > model.now)
}

/// Whether the picture on screen is that of another tree, and stands so long that it might be taken for this one's.
fn is_grey(model: &Model) -> bool {
    greys_at(model).is_some_and(|at| at <= model.now)
}

/// What is on screen: until the next tree's picture is there, that of the one before, which a slow line would
/// carry twice if it went meanwhile. `None` where a tree did not grow, and says why.
fn standing(model: &Model) -> Option<&Painted> {
    let tree = model.tree.as_ref().map(|tree| tree.shown.is_none() && tree.fault.is_some());
    let forest = model.forest.as_ref().map(|forest| forest.shown.is_none() && forest.fault.is_some());
    let has_failed = tree.or(forest)?;
    model.picture.painted.as_deref().filter(|_| !has_failed)
}

/// The picture as pixels, where there are such, and the cells that it covers.
pub fn graphic(model: &Model) -> Option<(Rect, Arc<Encoded>)> {
    // Pixels cannot be greyed: the cells below them are.
    let painted = standing(model).filter(|_| !is_grey(model))?;
    let area = area(model)?;
    let data = painted.graphic.as_ref().filter(|_| painted.request.area == area)?;
    Some((area, Arc::clone(data)))
}

/// A picture is there.
pub fn painted(model: &mut Model, painted: Painted) {
    if painted.request.detail == Detail::Full {
        model.picture.fast = painted.took < FAST && !model.terminal.remote.value;
    }
    let subject = &painted.request.subject;
    let is_shown = match subject {
        Subject::Word(_) => true,
        Subject::Tree(_) | Subject::Forest(_) => wanted_subject(model).is_some_and(|shown| shown.is(subject)),
    };
    model.picture.is_of_before &= !is_shown;
    model.picture.has_failed = false;
    model.picture.painted = Some(Box::new(painted));
}

/// What has grown of what is chosen.
fn wanted_subject(model: &Model) -> Option<Subject> {
    let tree = model.tree.as_ref().and_then(|tree| tree.shown.clone()).map(Subject::Tree);
    tree.or_else(|| model.forest.as_ref().and_then(|forest| forest.shown.clone()).map(Subject::Forest))
}

/// A tree grew for the first time: it is looked at from its broad side.
pub fn first_look(model: &mut Model, shown: &ShownTree) {
    if std::mem::take(&mut model.picture.keeps_camera) {
        return;
    }
    model.picture.camera.yaw_deg = shown.broad_side_deg();
    model.picture.camera.pitch_deg = 8.0;
}

/// A forest grew for the first time: it is looked at from a hill.
pub fn first_look_at_forest(model: &mut Model) {
    if !std::mem::take(&mut model.picture.keeps_camera) {
        let camera = &mut model.picture.camera;
        (camera.yaw_deg, camera.pitch_deg) = (FOREST_YAW_DEG, FOREST_PITCH_DEG);
    }
}

/// The pointer moves with a button down that went down in the picture: orbit, or pan with Shift or
/// another button. Whether that was it.
pub fn dragged(model: &mut Model, mouse: MouseEvent) -> bool {
    let Some(from) = model.picture.drag else { return false };
    let MouseEventKind::Drag(button) = mouse.kind else {
        model.picture.drag = None;
        return false;
    };
    let right = f32::from(mouse.column) - f32::from(from.0);
    let down = f32::from(mouse.row) - f32::from(from.1);
    model.picture.drag = Some((mouse.column, mouse.row));
    let camera = &mut model.picture.camera;
    if button != MouseButton::Left || mouse.modifiers.contains(KeyModifiers::SHIFT) {
        let area = area(model).unwrap_or_default();
        let half = f32::from(area.width.min(2 * area.height).max(2)) / 2.0;
        let camera = &mut model.picture.camera;
        camera.pan += Vec2::new(right, -2.0 * down) / half;
    } else {
        turn_by(camera, -right * DRAG_DEG);
        camera.pitch_deg = (camera.pitch_deg + 2.0 * down * DRAG_DEG).clamp(-90.0, 90.0);
    }
    true
}

/// The mouse in the picture.
pub fn mouse(model: &mut Model, mouse: MouseEvent) {
    match mouse.kind {
        MouseEventKind::Down(_) => {
            model.picture.turn(None);
            model.picture.drag = Some((mouse.column, mouse.row));
        }
        MouseEventKind::ScrollUp => zoom_by(model, 1.15),
        MouseEventKind::ScrollDown => zoom_by(model, 1.0 / 1.15),
        _ => {}
    }
}

/// Comes closer, or goes away.
pub fn zoom_by(model: &mut Model, factor: f32) {
    let camera = &mut model.picture.camera;
    let zoom = (camera.zoom * factor).clamp(0.1, 200.0);
    // What is in the middle stays there, also where it comes no closer.
    camera.pan *= zoom / camera.zoom;
    camera.zoom = zoom;
}

#[cfg(test)]
mod tests;
