//! A forest on screen, in the place of a tree: its picture, and a form of the knobs that lay it out.

pub mod save;
pub mod view;

use std::path::{Path, PathBuf};
use std::sync::Arc;

use linden::forest::{FOREST_KNOBS, Forest, LayoutError};
use linden::knob::{Kind, Knob, Value};

use super::effect::{Effect, Effects};
use super::model::{FormSpot, Model};
use super::picture;
use super::tree::TreePlace;
use crate::jobs::{HowFar, ShownForest};
use crate::source::forest::ForestSource;

/// A forest on screen.
pub struct ForestOnScreen {
    /// Where its document is.
    pub place: TreePlace,
    files: Vec<PathBuf>,
    /// As its document has it.
    saved: Arc<Forest>,
    /// As it is now.
    current: Arc<Forest>,
    past: Vec<Arc<Forest>>,
    future: Vec<Arc<Forest>>,
    /// The last that grew. Stays on screen while another grows, and when another cannot.
    pub shown: Option<Arc<ShownForest>>,
    /// Why the forest did not grow.
    pub fault: Option<String>,
    /// How far the growing is.
    pub growing: Option<HowFar>,
}

impl ForestOnScreen {
    /// A forest as its document has it.
    pub fn new(place: TreePlace, source: ForestSource) -> Self {
        let ForestSource { forest, files, .. } = source;
        let forest = Arc::new(forest);
        Self {
            place,
            files,
            saved: Arc::clone(&forest),
            current: forest,
            past: Vec::new(),
            future: Vec::new(),
            shown: None,
            fault: None,
            growing: None,
        }
    }

    /// What should be on screen.
    pub fn wanted(&self) -> &Arc<Forest> {
        &self.current
    }

    /// The files that it was read from.
    pub fn files(&self) -> &[PathBuf] {
        &self.files
    }

    /// Whether it was read from a file.
    pub fn is_from(&self, path: &Path) -> bool {
        self.files.iter().any(|file| file == path)
    }

    /// Whether anything differs from the document.
    pub fn is_modified(&self) -> bool {
        self.current.layout != self.saved.layout
    }

    /// Whether a knob differs from the document.
    pub fn is_turned(&self, name: &str) -> bool {
        self.saved_value(name) != value(&self.current, name)
    }

    /// What the document has of a knob.
    pub fn saved_value(&self, name: &str) -> Option<Value> {
        value(&self.saved, name)
    }

    /// The knobs that differ from the document, as `linden forest` takes them.
    pub fn overrides(&self) -> Vec<(&'static str, String)> {
        let knobs = self.current.layout.knobs();
        knobs
            .filter(|(row, _)| self.is_turned(row.knob.name))
            .map(|(row, value)| (row.knob.name, value.to_string()))
            .collect()
    }

    /// What is wrong with a value for a knob, `None` where it can be set.
    pub fn problem(&self, name: &str, text: &str) -> Option<String> {
        self.current.layout.clone().set(name, text).err().map(|error| error.to_string())
    }

    /// Turns a knob to what was typed, as one step of undo.
    ///
    /// # Errors
    /// What the knob does not take.
    pub fn set(&mut self, name: &str, text: &str) -> Result<(), LayoutError> {
        let mut forest = (*self.current).clone();
        forest.layout.set(name, text)?;
        self.change(forest);
        Ok(())
    }

    /// Gives all knobs the document's values back, as one step of undo.
    pub fn revert(&mut self) {
        let saved = (*self.saved).clone();
        self.change(saved);
    }

    /// What is on screen was saved: nothing differs from the document.
    fn was_saved(&mut self, path: PathBuf) {
        // Those of its kinds stay, so that what changes in them is seen.
        if let TreePlace::File(before) = &self.place {
            self.files.retain(|file| file != before);
        }
        self.files.push(path.clone());
        self.place = TreePlace::File(path);
        self.saved = Arc::clone(&self.current);
    }

    /// Its document is called otherwise, and says the same but for its id, and its name where that was the id.
    pub fn renamed(&mut self, place: TreePlace, id: &str) {
        let files = self.files.iter_mut();
        if let (TreePlace::File(before), TreePlace::File(path)) = (&self.place, &place) {
            files.filter(|file| *file == before).for_each(|file| file.clone_from(path));
        }
        let steps = self.past.iter_mut().chain(&mut self.future).chain([&mut self.current, &mut self.saved]);
        for step in steps {
            let forest = Arc::make_mut(step);
            if forest.name == forest.id {
                id.clone_into(&mut forest.name);
            }
            id.clone_into(&mut forest.id);
        }
        self.place = place;
    }

    fn change(&mut self, forest: Forest) {
        if forest.layout != self.current.layout {
            self.past.push(std::mem::replace(&mut self.current, Arc::new(forest)));
            self.future.clear();
        }
    }

    /// Whether there is something to undo.
    pub fn can_undo(&self) -> bool {
        !self.past.is_empty()
    }

    /// Whether there is something to redo.
    pub fn can_redo(&self) -> bool {
        !self.future.is_empty()
    }

    /// One step back.
    pub fn undo(&mut self) {
        if let Some(before) = self.past.pop() {
            self.future.push(std::mem::replace(&mut self.current, before));
        }
    }

    /// One step forward again.
    pub fn redo(&mut self) {
        if let Some(after) = self.future.pop() {
            self.past.push(std::mem::replace(&mut self.current, after));
        }
    }
}

fn value(forest: &Forest, name: &str) -> Option<Value> {
    forest.layout.knobs().find(|(row, _)| row.knob.name == name).map(|(_, value)| value)
}

/// Where the cursor can be in the form.
pub fn spots() -> Vec<FormSpot> {
    FOREST_KNOBS.iter().map(|row| FormSpot::Knob(row.knob.name)).collect()
}

/// The knob that the cursor is on, with its value: the first where it is on none of these.
pub fn selected(model: &Model) -> Option<(&'static Knob, Value)> {
    let forest = model.forest.as_ref()?;
    let is_chosen = |knob: &Knob| model.form.selected == Some(FormSpot::Knob(knob.name));
    let mut knobs = forest.current.layout.knobs();
    let first = knobs.next();
    let chosen = first.iter().cloned().chain(knobs).find(|(row, _)| is_chosen(&row.knob));
    chosen.or(first).map(|(row, value)| (&row.knob, value))
}

/// How a knob is nudged: what is counted as whole numbers are.
pub fn counted(knob: &Knob, value: Value) -> (Kind, Value) {
    match (linden::forest::counted(knob), value) {
        (Some(kind), Value::Real(n)) => (kind, Value::Integer(n as u64)),
        (_, value) => (knob.kind, value),
    }
}

/// The wanted forest grew, or why not.
pub fn grown(model: &mut Model, grown: Result<Arc<ShownForest>, String>) {
    let Some(forest) = &mut model.forest else { return };
    match grown {
        Ok(shown) if !Arc::ptr_eq(&shown.forest, &forest.current) => {}
        Ok(shown) => {
            let is_first = forest.shown.is_none();
            (forest.growing, forest.fault) = (None, None);
            forest.shown = Some(shown);
            if is_first {
                picture::first_look_at_forest(model);
            }
        }
        Err(why) => {
            (forest.growing, forest.fault) = (None, Some(why.clone()));
            model.say_error(why);
        }
    }
}

/// A forest was saved, or why not.
pub fn saved(model: &mut Model, saved: Result<PathBuf, String>, effects: &mut Effects) {
    match saved {
        Ok(path) => {
            model.say(format!("saved in {}", crate::paths::show(&path)));
            if let Some(forest) = &mut model.forest {
                let from = forest.place.clone();
                forest.was_saved(path.clone());
                let place = forest.place.clone();
                model.exporting.moved(Some(&from), &place);
                // The list has it at once; its name is read from the file.
                model.library.add_forest(path, forest.wanted(), "");
                model.library.select_place(&place);
                model.loading = Some(place.clone());
                effects.push(Effect::Load(place));
            }
            effects.push(Effect::Reconfigure);
        }
        Err(why) => model.say_error(why),
    }
}

#[cfg(test)]
mod tests;
