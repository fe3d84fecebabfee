//! Variations of a tree: other seeds, galleries of them, sweeps of a knob.
//!
//! A gallery is one knob turned many ways: the seed, or any other. It keeps no trees and no recipes;
//! what it shows follows from the tree on screen, the knob and the room that there is, so a resize or
//! a file that is read again needs no care. What is wanted is compared with what comes by value.

mod chance;
mod commands;
mod grid;
mod sweep;
mod view;

use std::sync::Arc;

use linden::knob::{Knob, Value};
use linden::preset::{PresetKnob, Section};
use linden_raster::Camera;
use linden_terminal::Encoded;
use ratatui::layout::Rect;

pub use commands::COMMANDS;

use self::grid::Grid;
use self::sweep::{SEED, SPREADS, USUAL_SPREAD, ValueSeries};
use super::command::Context;
use super::dialog::After;
use super::layout::inside;
use super::model::Model;
use super::shape;
use crate::jobs::{GalleryRequest, Medium, PictureLook, Thumbnail};

/// Where a gallery's keys are listened to.
const CONTEXT: Context = Context::new(40, "gallery", "In the gallery");

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
struct GalleryPage {
    knob: Knob,
    /// What it is called on screen.
    called: String,
    section: Section,
    grid: Grid,
    series: ValueSeries,
    /// The place of the first value.
    first: u64,
    values: Vec<Value>,
    /// Which of them Enter takes.
    chosen: usize,
    /// What the knob is set to.
    current: Value,
}

/// A knob of the tree on screen, with its value.
fn knob(model: &Model, name: &str) -> Result<(PresetKnob, Value), String> {
    let tree = model.tree.as_ref().ok_or("no preset is chosen")?;
    let found = tree.preset().all_knobs().into_iter().find(|(row, _)| row.knob.name == name);
    found.ok_or_else(|| format!("this tree has no {name} any more"))
}

/// Where the pictures are.
fn room(model: &Model) -> Rect {
    inside(model.dialog_body())
}

/// Lays pictures of a knob out over the screen.
fn open(model: &mut Model, name: &'static str) {
    let Ok((row, current)) = knob(model, name) else { return };
    let most = Grid::most(room(model));
    let Ok(series) = ValueSeries::of(&row.knob, &current, USUAL_SPREAD, most) else { return };
    let place = series.place(&current).unwrap_or(0);
    let first = match series {
        ValueSeries::Seeds => place,
        ValueSeries::Listed(_) => place.saturating_sub(most as u64 / 2),
    };
    // What moves beneath would only take time from the pictures.
    model.picture.turn(None);
    model.wind.stop();
    if model.growth.is_playing() {
        model.growth.stop();
    }
    let Camera { yaw_deg, pitch_deg, .. } = model.picture.camera;
    model.dialogs.open(Gallery {
        knob: name,
        first,
        chosen: current,
        spread: USUAL_SPREAD,
        one_scale: false,
        camera: Camera::orbit(yaw_deg, pitch_deg),
        pictures: Vec::new(),
    });
}

impl Gallery {
    /// What is on screen, or why there is nothing.
    fn page(&self, model: &Model) -> Result<GalleryPage, String> {
        let (row, current) = knob(model, self.knob)?;
        let PresetKnob { knob, section, .. } = row;
        let called = model.tree.as_ref().map_or_else(String::new, |tree| shape::called(tree.preset(), &row));
        let room = room(model);
        let most = Grid::most(room);
        let series = ValueSeries::of(&knob, &current, self.spread, most)?;
        let last = series.last();
        let count = last.saturating_add(1).min(most as u64);
        let chosen = series.place(&self.chosen).or_else(|| series.place(&current)).unwrap_or(0);
        // The page is full where it can be, and the chosen value is on it.
        let first = self.first.min(last - (count - 1)).clamp(chosen.saturating_sub(count - 1), chosen);
        let values: Vec<Value> =
            (first..=first.saturating_add(count - 1)).filter_map(|at| series.at(at)).collect();
        let chosen = (chosen - first) as usize;
        let grid = Grid::new(room, values.len());
        Ok(GalleryPage { knob, called, section, grid, series, first, values, chosen, current })
    }

    /// The picture of a value, if one has come for the tree on screen.
    fn picture(&self, model: &Model, value: &Value) -> Option<&Thumbnail> {
        let base = model.tree.as_ref()?.recipe();
        self.pictures
            .iter()
            .find(|picture| Arc::ptr_eq(&picture.request.base, base) && picture.value() == value)
    }

    /// How many pictures of a page have come, of those that are wanted.
    fn progress(&self, model: &Model, page: &GalleryPage) -> (usize, usize) {
        let wanted = self.wanted(model);
        let is_there =
            |picture: &&Thumbnail| wanted.as_ref().is_some_and(|wanted| wanted.is_of(&picture.request));
        (self.pictures.iter().filter(is_there).count(), page.values.len())
    }

    /// The pictures that should be on screen, `None` when there is no room.
    fn wanted(&self, model: &Model) -> Option<GalleryRequest> {
        let tree = model.tree.as_ref()?;
        let page = self.page(model).ok()?;
        let picture = Grid::parts(page.grid.cell(0)).picture;
        if picture.is_empty() {
            return None;
        }
        let medium = Medium::of(&model.terminal, model.config.settings.scenery);
        // In so few characters a tree stands out best before nothing.
        let medium = Medium { landscape: medium.landscape && medium.graphics.is_some(), ..medium };
        // Skeletons are alike whatever covers them.
        let covers = page.section.covers();
        Some(GalleryRequest {
            base: Arc::clone(tree.recipe()),
            knob: self.knob,
            values: page.values,
            known: tree.shown.clone().filter(|shown| Arc::ptr_eq(&shown.recipe, tree.recipe())),
            camera: self.camera,
            look: if covers { PictureLook::Surface } else { model.picture.look },
            one_scale: self.one_scale,
            cells: (picture.width, picture.height),
            medium,
        })
    }

    /// Chooses a picture of the page.
    fn choose(&mut self, model: &Model, cell: usize) {
        let value = self.page(model).ok().and_then(|page| page.values.get(cell).cloned());
        if let Some(value) = value {
            self.chosen = value;
        }
    }

    /// Goes one picture on; over the edge of a page to the next one.
    fn go(&mut self, model: &Model, way: Way) {
        let Ok(page) = self.page(model) else { return };
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
        self.go_to(&page, to);
    }

    /// Chooses a value by its place; where it is not on the page, a whole page is turned.
    fn go_to(&mut self, page: &GalleryPage, to: u64) {
        let count = page.values.len() as u64;
        let Some(value) = page.series.at(to) else { return };
        self.chosen = value;
        self.first = if to < page.first {
            page.first.saturating_sub(count)
        } else if to - page.first >= count {
            page.first.saturating_add(count)
        } else {
            page.first
        };
    }

    /// Turns to the next page, or the one before; the same cell stays chosen.
    fn turn_page(&mut self, model: &Model, on: bool) {
        let Ok(page) = self.page(model) else { return };
        let (count, last) = (page.values.len() as u64, page.series.last());
        let first = if on {
            page.first.saturating_add(count).min(last - (count - 1))
        } else {
            page.first.saturating_sub(count)
        };
        if let Some(value) = page.series.at(first + page.chosen as u64) {
            self.first = first;
            self.chosen = value;
        }
    }

    /// Widens or narrows the range of a sweep; what is set stays chosen.
    fn spread_by(&mut self, model: &Model, wider: bool) {
        let Ok((_, current)) = knob(model, self.knob) else { return };
        let spread = if wider { self.spread + 1 } else { self.spread.saturating_sub(1) };
        self.spread = spread.min(SPREADS.len() - 1);
        self.chosen = current;
    }

    /// Back to what is set.
    fn go_back(&mut self, model: &Model) {
        let Ok(page) = self.page(model) else { return };
        let Some(place) = page.series.place(&page.current) else { return };
        self.first = match page.series {
            ValueSeries::Seeds => place,
            ValueSeries::Listed(_) => place.saturating_sub(page.values.len() as u64 / 2),
        };
        self.chosen = page.current;
    }

    /// Takes the chosen value, as one step of undo, and closes the gallery.
    fn take(&mut self, model: &mut Model) -> After {
        let (Ok(page), Some(tree)) = (self.page(model), &mut model.tree) else { return After::Closes };
        let value = page.values.get(page.chosen).filter(|value| **value != page.current);
        let Some(value) = value else { return After::Closes };
        let mut preset = tree.preset().clone();
        match preset.set(page.knob.name, &value.to_string()) {
            Ok(()) => {
                // Never one step with a nudge of the same knob a moment ago.
                tree.replace(preset);
                model.say(page.label(value));
            }
            Err(error) => model.say_warning(error.to_string()),
        }
        After::Closes
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

impl GalleryPage {
    /// The knob's value in words: `seed 17`, `kill 2D`, `angle 25.7 deg`.
    fn label(&self, value: &Value) -> String {
        let Self { knob, called, .. } = self;
        let has_unit = matches!(value, Value::Real(_) | Value::Integer(_)) && knob.unit != knob.name;
        let unit = if has_unit && !knob.unit.is_empty() { format!(" {}", knob.unit) } else { String::new() };
        format!("{called} {value}{unit}")
    }
}

/// The pictures of the gallery as pixels, and the cells that they cover; `None` when no gallery is on top.
pub fn graphics(model: &Model) -> Option<Vec<(Rect, Arc<Encoded>)>> {
    let gallery = model.dialogs.top::<Gallery>()?;
    let Ok(page) = gallery.page(model) else { return Some(Vec::new()) };
    let shown = page.values.iter().enumerate().filter_map(|(index, value)| {
        let area = Grid::parts(page.grid.cell(index)).picture;
        let picture = gallery.picture(model, value)?;
        // One of another size has yet to be drawn for this one.
        let fits = picture.request.cells == (area.width, area.height);
        let graphic = picture.result.as_ref().ok()?.graphic.as_ref().filter(|_| fits)?;
        Some((area, Arc::clone(graphic)))
    });
    Some(shown.collect())
}

/// The pictures that should be on screen, `None` when there is no gallery or no room.
pub fn wanted(model: &Model) -> Option<GalleryRequest> {
    model.dialogs.top::<Gallery>()?.wanted(model)
}

/// A picture is there. One that is not waited for any more is dropped.
pub fn thumbnail(model: &mut Model, thumbnail: Thumbnail) {
    let Some(wanted) = wanted(model) else { return };
    if !wanted.is_of(&thumbnail.request) {
        return;
    }
    if let Some(gallery) = model.dialogs.top_mut::<Gallery>() {
        // Those of another size stay until better ones come, those of another page go.
        gallery.pictures.retain(|picture| {
            picture.value() != thumbnail.value()
                && Arc::ptr_eq(&picture.request.base, &wanted.base)
                && wanted.values.contains(picture.value())
        });
        gallery.pictures.push(thumbnail);
    }
}

/// The seed of what is on screen.
fn seed(model: &Model) -> Option<u64> {
    let of_forest = model.forest.as_ref().map(|forest| forest.wanted().layout.seed);
    model.tree.as_ref().map(|tree| tree.preset().seed()).or(of_forest)
}

/// Rolls the dice again, or back: the next seed is as unlike this one as any other.
fn reroll(model: &mut Model, on: bool) {
    let Some(seed) = seed(model) else { return };
    let next = if on { seed.checked_add(1) } else { seed.checked_sub(1) };
    if let Some(next) = next {
        // Each is a tree to come back to, however fast one goes through them.
        if let Some(tree) = &mut model.tree {
            tree.begin_step();
        }
        shape::turn(model, SEED, &next.to_string());
        model.say(format!("seed {next}"));
    }
}

#[cfg(test)]
mod tests;
