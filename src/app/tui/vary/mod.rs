//! Seeds, galleries, sweeps.
//!
//! A gallery is one knob turned many ways: the seed, or any other. It keeps no trees and no recipes;
//! what it shows follows from the tree on screen, the knob and the room that there is, so a resize or
//! a file that is read again needs no care. What is wanted is compared with what comes by value.

mod chance;
mod commands;
mod grid;
mod sweep;
pub mod view;

use std::sync::Arc;

use linden::knob::{Knob, Value};
use linden::preset::{PresetKnob, Section};
use linden_raster::Camera;
use linden_terminal::input::{Mouse, MouseAction};
use ratatui::layout::Rect;

pub use commands::COMMANDS;

use self::grid::Grid;
use self::sweep::{SEED, SPREADS, Series, USUAL_SPREAD};
use super::effect::Effects;
use super::frame::{self, Layout};
use super::model::{Layer, Model};
use super::{picture, shape};
use crate::jobs::{GalleryRequest, Medium, Thumbnail};

/// A grid of live pictures.
pub struct Gallery {
    /// The knob that is turned.
    knob: &'static str,
    /// Where the page begins among the knob's values.
    first: u64,
    /// What Enter takes; by value, so that it stays when the page changes.
    chosen: Value,
    /// How far a sweep reaches, a place in [`SPREADS`].
    spread: usize,
    /// Whether all trees are in one scale.
    one_scale: bool,
    /// From where they are looked at.
    camera: Camera,
    /// Pictures that have come, in any order.
    pictures: Vec<Thumbnail>,
}

/// What is on screen of a gallery.
struct Page {
    knob: Knob,
    section: Section,
    grid: Grid,
    series: Series,
    /// The place of the first value.
    first: u64,
    values: Vec<Value>,
    /// Which of them Enter takes.
    chosen: usize,
    /// What the knob is set to.
    current: Value,
}

/// The gallery on top.
fn gallery(model: &Model) -> Option<&Gallery> {
    if let Some(Layer::Gallery(gallery)) = model.layers.last() { Some(gallery) } else { None }
}

fn gallery_mut(model: &mut Model) -> Option<&mut Gallery> {
    if let Some(Layer::Gallery(gallery)) = model.layers.last_mut() { Some(gallery) } else { None }
}

/// A knob of the tree on screen, with its value.
fn knob(model: &Model, name: &str) -> Result<(PresetKnob, Value), String> {
    let tree = model.tree.as_ref().ok_or("no preset is chosen")?;
    let found = tree.preset().knobs().into_iter().find(|(row, _)| row.knob.name == name);
    found.ok_or_else(|| format!("this tree has no {name} any more"))
}

/// The screen without the footer, which has the gallery's hints.
fn sheet(model: &Model) -> Rect {
    let (width, height) = model.size;
    Rect::new(0, 0, width, height - Layout::of(model).footer.height.min(height))
}

/// Where the pictures are.
fn room(model: &Model) -> Rect {
    frame::inside(sheet(model))
}

/// Lays pictures of a knob out over the screen.
fn open(model: &mut Model, name: &'static str) {
    let Ok((row, current)) = knob(model, name) else { return };
    let most = Grid::most(room(model));
    let Ok(series) = Series::of(&row.knob, &current, USUAL_SPREAD, most) else { return };
    let place = series.place(&current).unwrap_or(0);
    let first = match series {
        Series::Seeds => place,
        Series::Listed(_) => place.saturating_sub(most as u64 / 2),
    };
    // What moves beneath would only take time from the pictures.
    model.picture.turn(None);
    model.wind.stop();
    if model.growth.is_playing() {
        model.growth.stop();
    }
    let Camera { yaw_deg, pitch_deg, .. } = model.picture.camera;
    model.layers.push(Layer::Gallery(Box::new(Gallery {
        knob: name,
        first,
        chosen: current,
        spread: USUAL_SPREAD,
        one_scale: true,
        camera: Camera::orbit(yaw_deg, pitch_deg),
        pictures: Vec::new(),
    })));
}

impl Gallery {
    /// What is on screen, or why there is nothing.
    fn page(&self, model: &Model) -> Result<Page, String> {
        let (PresetKnob { knob, section, .. }, current) = knob(model, self.knob)?;
        let room = room(model);
        let most = Grid::most(room);
        let series = Series::of(&knob, &current, self.spread, most)?;
        let last = series.last();
        let count = last.saturating_add(1).min(most as u64);
        let chosen = series.place(&self.chosen).or_else(|| series.place(&current)).unwrap_or(0);
        // The page is full where it can be, and the chosen value is on it.
        let first = self.first.min(last - (count - 1)).clamp(chosen.saturating_sub(count - 1), chosen);
        let values: Vec<Value> =
            (first..=first.saturating_add(count - 1)).filter_map(|at| series.at(at)).collect();
        let chosen = (chosen - first) as usize;
        let grid = Grid::new(room, values.len());
        Ok(Page { knob, section, grid, series, first, values, chosen, current })
    }

    /// The picture of a value, if one has come for the tree on screen.
    fn picture(&self, model: &Model, value: &Value) -> Option<&Thumbnail> {
        let base = model.tree.as_ref()?.recipe();
        self.pictures.iter().find(|own| Arc::ptr_eq(&own.request.base, base) && own.value() == value)
    }
}

/// The pictures that should be on screen, `None` when there is no gallery or no room.
pub fn wanted(model: &Model) -> Option<GalleryRequest> {
    let gallery = gallery(model)?;
    let tree = model.tree.as_ref()?;
    let page = gallery.page(model).ok()?;
    let picture = Grid::parts(page.grid.cell(0)).picture;
    if picture.is_empty() {
        return None;
    }
    // Skeletons are alike whatever covers them.
    let covers = page.section.covers();
    Some(GalleryRequest {
        base: Arc::clone(tree.recipe()),
        knob: gallery.knob,
        values: page.values,
        known: tree.shown.clone().filter(|shown| Arc::ptr_eq(&shown.recipe, tree.recipe())),
        camera: gallery.camera,
        look: if covers { picture::Look::Surface } else { model.picture.look },
        one_scale: gallery.one_scale,
        cells: (picture.width, picture.height),
        // Terminals show one picture of pixels at a time.
        medium: Medium { graphics: None, ..Medium::of(&model.terminal) },
    })
}

/// A picture is there. One that nobody waits for any more is dropped.
pub fn thumbnail(model: &mut Model, thumbnail: Thumbnail) {
    let Some(wanted) = wanted(model) else { return };
    if !wanted.is_of(&thumbnail.request) {
        return;
    }
    if let Some(gallery) = gallery_mut(model) {
        // Those of another size stay until better ones come, those of another page go.
        gallery.pictures.retain(|own| {
            own.value() != thumbnail.value()
                && Arc::ptr_eq(&own.request.base, &wanted.base)
                && wanted.values.contains(own.value())
        });
        gallery.pictures.push(thumbnail);
    }
}

/// How many pictures of a page have come, of those that are wanted.
fn progress(model: &Model, gallery: &Gallery, page: &Page) -> (usize, usize) {
    let wanted = wanted(model);
    let is_there = |own: &&Thumbnail| wanted.as_ref().is_some_and(|wanted| wanted.is_of(&own.request));
    (gallery.pictures.iter().filter(is_there).count(), page.values.len())
}

/// The mouse on a picture: the first click chooses it, the second takes it; the wheel turns pages.
pub fn clicked(model: &mut Model, cell: usize, mouse: Mouse, _effects: &mut Effects) {
    match mouse.action {
        MouseAction::Press(_) => {
            let chosen = gallery(model).and_then(|own| own.page(model).ok()).map(|page| page.chosen);
            if chosen == Some(cell) { take(model) } else { choose(model, cell) }
        }
        MouseAction::WheelUp => turn_page(model, false),
        MouseAction::WheelDown => turn_page(model, true),
        _ => {}
    }
}

/// Chooses a picture of the page.
fn choose(model: &mut Model, cell: usize) {
    let value =
        gallery(model).and_then(|own| own.page(model).ok()).and_then(|page| page.values.get(cell).cloned());
    if let (Some(value), Some(gallery)) = (value, gallery_mut(model)) {
        gallery.chosen = value;
    }
}

/// A way to go on the page.
#[derive(Clone, Copy)]
enum Way {
    Left,
    Right,
    Up,
    Down,
}

/// Goes one picture on; over the edge of a page to the next one.
fn go(model: &mut Model, way: Way) {
    let Some(Ok(page)) = gallery(model).map(|own| own.page(model)) else { return };
    let (columns, last) = (page.grid.columns as u64, page.series.last());
    let here = page.first + page.chosen as u64;
    let rows_below = (page.values.len() - 1) / page.grid.columns - page.chosen / page.grid.columns;
    let to = match way {
        Way::Left => here.saturating_sub(1),
        Way::Right => here.saturating_add(1).min(last),
        Way::Up => here.checked_sub(columns).unwrap_or(here),
        Way::Down if last - here >= columns => here + columns,
        // The last row may be shorter.
        Way::Down if rows_below > 0 => last,
        Way::Down => here,
    };
    go_to(model, &page, to);
}

/// Chooses a value by its place; where it is not on the page, a whole page is turned.
fn go_to(model: &mut Model, page: &Page, to: u64) {
    let count = page.values.len() as u64;
    let Some(gallery) = gallery_mut(model) else { return };
    let Some(value) = page.series.at(to) else { return };
    gallery.chosen = value;
    gallery.first = if to < page.first {
        page.first.saturating_sub(count)
    } else if to - page.first >= count {
        page.first.saturating_add(count)
    } else {
        page.first
    };
}

/// Turns to the next page, or the one before; the same cell stays chosen.
fn turn_page(model: &mut Model, on: bool) {
    let Some(Ok(page)) = gallery(model).map(|own| own.page(model)) else { return };
    let (count, last) = (page.values.len() as u64, page.series.last());
    let first = if on {
        page.first.saturating_add(count).min(last - (count - 1))
    } else {
        page.first.saturating_sub(count)
    };
    let value = page.series.at(first + page.chosen as u64);
    if let (Some(value), Some(gallery)) = (value, gallery_mut(model)) {
        gallery.first = first;
        gallery.chosen = value;
    }
}

/// Widens or narrows the range of a sweep; what is set stays chosen.
fn spread_by(model: &mut Model, wider: bool) {
    let Some(gallery) = gallery(model) else { return };
    let Ok((_, current)) = knob(model, gallery.knob) else { return };
    let Some(gallery) = gallery_mut(model) else { return };
    let spread = if wider { gallery.spread + 1 } else { gallery.spread.saturating_sub(1) };
    gallery.spread = spread.min(SPREADS.len() - 1);
    gallery.chosen = current;
}

/// Back to what is set.
fn go_back(model: &mut Model) {
    let Some(Ok(page)) = gallery(model).map(|own| own.page(model)) else { return };
    let Some(place) = page.series.place(&page.current) else { return };
    if let Some(gallery) = gallery_mut(model) {
        gallery.first = match page.series {
            Series::Seeds => place,
            Series::Listed(_) => place.saturating_sub(page.values.len() as u64 / 2),
        };
        gallery.chosen = page.current;
    }
}

/// Takes the chosen value, as one step of undo, and closes the gallery.
fn take(model: &mut Model) {
    let Some(page) = gallery(model).map(|own| own.page(model)) else { return };
    model.layers.pop();
    let (Ok(page), Some(tree)) = (page, &mut model.tree) else { return };
    let Some(value) = page.values.get(page.chosen).filter(|value| **value != page.current) else { return };
    let mut preset = tree.preset().clone();
    match preset.set(page.knob.name, &value.to_string()) {
        Ok(()) => {
            // Never one step with a nudge of the same knob a moment ago.
            tree.replace(preset);
            model.say(view::label(&page.knob, value));
        }
        Err(error) => model.say_warning(error.to_string()),
    }
}

/// Rolls the dice again, or back: the next seed is as unlike this one as any other.
fn reroll(model: &mut Model, on: bool) {
    let Some(seed) = model.tree.as_ref().map(|tree| tree.preset().seed) else { return };
    let next = if on { seed.checked_add(1) } else { seed.checked_sub(1) };
    if let Some(next) = next {
        shape::turn(model, SEED, &next.to_string());
        model.say(format!("seed {next}"));
    }
}

#[cfg(test)]
mod tests;
