//! The tree on screen: the document it comes from, what was changed since, and what it grew into.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, Instant};

use linden::knob::{Kind, Value};
use linden::monitor::Stage;
use linden::preset::{KnobError, Preset, PresetKnob};
use linden::recipe::Recipe;

use crate::jobs::Shown;

/// Nudges of one knob that follow each other faster are one step of undo.
const ONE_STEP: Duration = Duration::from_millis(700);

/// What SOURCE is on a command line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Place {
    /// A built-in preset's id.
    Builtin(&'static str),
    /// A file.
    File(PathBuf),
}

/// The tree on screen.
pub struct Tree {
    /// Where its document is.
    pub place: Place,
    /// As the document has it.
    saved: Arc<Recipe>,
    /// As it is now.
    current: Arc<Recipe>,
    past: Vec<Arc<Recipe>>,
    future: Vec<Arc<Recipe>>,
    last_nudge: Option<(&'static str, Instant)>,
    /// Whether the saved one is looked at for comparison (A/B).
    pub compares: bool,
    /// The last that grew. Stays on screen while another grows, and when another cannot.
    pub shown: Option<Arc<Shown>>,
    /// Why the recipe on screen did not grow.
    pub fault: Option<String>,
    /// How far the growing is.
    pub growing: Option<Growing>,
}

/// How far growing is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Growing {
    /// What is being done.
    pub stage: Stage,
    /// Units finished.
    pub done: u64,
    /// Of so many.
    pub total: Option<u64>,
}

impl Tree {
    /// A tree as its document has it.
    pub fn new(place: Place, recipe: Recipe) -> Self {
        let recipe = Arc::new(recipe);
        Self {
            place,
            saved: Arc::clone(&recipe),
            current: recipe,
            past: Vec::new(),
            future: Vec::new(),
            last_nudge: None,
            compares: false,
            shown: None,
            fault: None,
            growing: None,
        }
    }

    /// The files that it was read from.
    pub fn files(&self) -> Vec<PathBuf> {
        let Place::File(path) = &self.place else { return Vec::new() };
        let beside = self.saved.preset.space().and_then(linden::preset::Space::file);
        let beside = beside.and_then(|file| path.parent().map(|folder| folder.join(file)));
        std::iter::once(path.clone()).chain(beside).collect()
    }

    /// What should be on screen: the current recipe, or the saved one while comparing.
    pub fn wanted(&self) -> &Arc<Recipe> {
        if self.compares { &self.saved } else { &self.current }
    }

    /// The recipe with all changes.
    pub fn recipe(&self) -> &Arc<Recipe> {
        &self.current
    }

    /// The recipe as its document has it.
    pub fn saved(&self) -> &Arc<Recipe> {
        &self.saved
    }

    /// The preset with all changes.
    pub fn preset(&self) -> &Preset {
        &self.current.preset
    }

    /// Whether anything differs from the document.
    pub fn is_modified(&self) -> bool {
        self.current.preset != self.saved.preset
    }

    /// Whether a knob differs from the document.
    pub fn is_turned(&self, knob: &PresetKnob) -> bool {
        knob.read(&self.saved.preset) != knob.read(&self.current.preset)
    }

    /// Turns a knob to what was typed.
    ///
    /// # Errors
    /// What the knob does not take.
    pub fn set(&mut self, name: &'static str, text: &str, now: Instant) -> Result<(), KnobError> {
        let mut preset = self.current.preset.clone();
        preset.set(name, text)?;
        let follows = self
            .last_nudge
            .is_some_and(|(last, at)| last == name && now.saturating_duration_since(at) < ONE_STEP);
        self.change(preset, follows);
        self.last_nudge = Some((name, now));
        Ok(())
    }

    /// Replaces the whole preset (an edited grammar, a variation), as one step of undo.
    pub fn replace(&mut self, preset: Preset) {
        self.change(preset, false);
        self.last_nudge = None;
    }

    fn change(&mut self, preset: Preset, follows: bool) {
        self.compares = false;
        if preset == self.current.preset {
            return;
        }
        let next = Arc::new(Recipe { preset, input: self.current.input.clone() });
        let last = std::mem::replace(&mut self.current, next);
        if !follows {
            self.past.push(last);
        }
        self.future.clear();
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
            self.last_nudge = None;
            self.compares = false;
        }
    }

    /// One step forward again.
    pub fn redo(&mut self) {
        if let Some(after) = self.future.pop() {
            self.past.push(std::mem::replace(&mut self.current, after));
            self.last_nudge = None;
            self.compares = false;
        }
    }

    /// The document was saved or read again: what differs from it is counted anew, and nothing that
    /// was changed is lost.
    pub fn saved_as(&mut self, place: Place, recipe: Arc<Recipe>) {
        self.place = place;
        self.saved = recipe;
    }

    /// The document was read again, and nothing was changed here: the new one grows, and one undo
    /// leads back.
    pub fn reloaded(&mut self, recipe: Recipe) {
        if recipe.preset == self.current.preset {
            // A mesh beside it may have changed all the same.
            self.current = Arc::new(recipe);
        } else {
            self.past.push(std::mem::replace(&mut self.current, Arc::new(recipe)));
        }
        self.future.clear();
        self.saved = Arc::clone(&self.current);
    }

    /// The knobs that differ from the document, as `--set` takes them; `None` when knobs alone do
    /// not lead there (the grammar was edited).
    pub fn overrides(&self) -> Option<Vec<(&'static str, String)>> {
        let mut preset = self.saved.preset.clone();
        let mut set = Vec::new();
        // A choice (the crown's shape) brings knobs along: what comes after it in the table is
        // compared with what the choice made of it.
        for (row, value) in self.current.preset.knobs() {
            if row.read(&preset).as_ref() != Some(&value) {
                let text = value.to_string();
                preset.set(row.knob.name, &text).ok()?;
                set.push((row.knob.name, text));
            }
        }
        (preset == self.current.preset).then_some(set)
    }
}

/// How far a key nudges a knob.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Nudge {
    /// Alt: a tenth of the usual.
    Fine,
    /// The usual.
    Usual,
    /// Shift: ten times the usual.
    Coarse,
}

/// The value one nudge up or down from here, as [`Preset::set`] reads it; `None` where there is no
/// such thing (a list of numbers has to be typed).
///
/// Numbers move by about 2 % of themselves on round numbers, within their range, so that
/// 0.02 m and 20 000 points are both some ten keys away from their double.
pub fn nudged(kind: &Kind, value: &Value, up: bool, nudge: Nudge) -> Option<String> {
    let sign = if up { 1.0 } else { -1.0 };
    let real = |x: f64, min: f64, max: f64| -> f64 {
        let step = step_of(x, min, max)
            * match nudge {
                Nudge::Fine => 0.1,
                Nudge::Usual => 1.0,
                Nudge::Coarse => 10.0,
            };
        // On the grid of the step, so that 0.1 + 0.2 stays 0.3.
        let moved = ((x / step + sign).round() * step).clamp(min, max);
        let digits = (-libm::floor(libm::log10(step))).max(0.0) + 1.0;
        format!("{moved:.*}", digits as usize).parse().unwrap_or(moved)
    };
    let value = match (kind, value) {
        (Kind::Real { min, max, .. }, Value::Real(x)) => Value::Real(real(*x, *min, *max)),
        (Kind::Length { min, max, .. }, Value::Real(x)) if x.is_finite() => Value::Real(real(*x, *min, *max)),
        (Kind::Length { min, max, .. }, Value::Steps(x)) if x.is_finite() => {
            Value::Steps(real(*x, *min, *max))
        }
        (Kind::Integer { min, max }, Value::Integer(n)) => {
            let step = match nudge {
                Nudge::Fine => 1,
                Nudge::Usual => (*n / 200).max(1),
                Nudge::Coarse => (*n / 20).max(10),
            };
            let step = if *n >= 200 && nudge != Nudge::Fine { round_down(step) } else { step };
            let moved = if up { n.saturating_add(step) } else { n.saturating_sub(step) };
            Value::Integer(moved.clamp(*min, *max))
        }
        (Kind::Choice(words), Value::Word(word)) => {
            let at = words.iter().position(|w| w == word)?;
            let next = if up { at + 1 } else { at + words.len() - 1 };
            Value::Word(words[next % words.len()].to_owned())
        }
        (Kind::Switch, Value::Switch(on)) => Value::Switch(!on),
        _ => return None,
    };
    Some(value.to_string())
}

/// A round step for a number: 1, 2 or 5 times a power of ten, about 2 % of it.
fn step_of(x: f64, min: f64, max: f64) -> f64 {
    let range = max - min;
    let scale =
        if x == 0.0 { if range.is_finite() { (range / 20.0).min(1.0) } else { 1.0 } } else { x.abs() };
    let about = scale * 0.03;
    let power = libm::pow(10.0, libm::floor(libm::log10(about)));
    let lead = about / power;
    power
        * if lead >= 5.0 {
            5.0
        } else if lead >= 2.0 {
            2.0
        } else {
            1.0
        }
}

/// The largest 1, 2 or 5 times a power of ten that is not above `n`.
fn round_down(n: u64) -> u64 {
    let mut power = 1_u64;
    while n / 10 >= power {
        power *= 10;
    }
    let lead = n / power;
    power
        * if lead >= 5 {
            5
        } else if lead >= 2 {
            2
        } else {
            1
        }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fir() -> Tree {
        let preset = linden::preset::builtin("fir").unwrap().load().unwrap();
        Tree::new(Place::Builtin("fir"), Recipe { preset, input: None })
    }

    #[test]
    fn undo_and_redo_walk_the_same_path() {
        let mut tree = fir();
        let start = Instant::now();
        let mut states = vec![tree.preset().clone()];
        for (i, (name, value)) in [("seed", "5"), ("points", "500"), ("seed", "2")].into_iter().enumerate() {
            tree.set(name, value, start + Duration::from_secs(10 * i as u64)).unwrap();
            states.push(tree.preset().clone());
        }
        for state in states.iter().rev().skip(1) {
            tree.undo();
            assert!(tree.preset() == state);
        }
        assert!(!tree.can_undo() && !tree.is_modified());
        for state in states.iter().skip(1) {
            tree.redo();
            assert!(tree.preset() == state);
        }
        assert!(!tree.can_redo());
        tree.undo();
        tree.set("points", "7", start).unwrap();
        assert!(!tree.can_redo(), "a new change ends what could be redone");
    }

    #[test]
    fn nudges_that_follow_each_other_are_one_step() {
        let mut tree = fir();
        let mut now = Instant::now();
        for points in ["300", "310", "320"] {
            tree.set("points", points, now).unwrap();
            now += Duration::from_millis(50);
        }
        tree.set("seed", "4", now).unwrap();
        tree.undo();
        tree.undo();
        assert!(!tree.is_modified() && !tree.can_undo());
    }

    #[test]
    fn a_failed_change_changes_nothing() {
        let mut tree = fir();
        assert!(tree.set("points", "minus", Instant::now()).is_err());
        assert!(!tree.is_modified() && !tree.can_undo());
    }

    #[test]
    fn overrides_lead_from_the_document_to_the_tree() {
        let mut tree = fir();
        for (name, value) in [("crown", "bezier"), ("seed", "9"), ("points", "777")] {
            tree.set(name, value, Instant::now()).unwrap();
        }
        let set = tree.overrides().unwrap();
        assert_eq!(
            set,
            [("seed", "9".to_owned()), ("crown", "bezier".to_owned()), ("points", "777".to_owned())]
        );
        assert_eq!(fir().overrides(), Some(Vec::new()));
    }

    #[test]
    fn every_knob_of_every_preset_can_be_nudged_and_stays_in_its_range() {
        for builtin in linden::preset::builtins() {
            let preset = builtin.load().unwrap();
            for (row, value) in preset.knobs() {
                for up in [true, false] {
                    for nudge in [Nudge::Fine, Nudge::Usual, Nudge::Coarse] {
                        let mut text = value.to_string();
                        for _ in 0..40 {
                            let Some(next) =
                                nudged(&row.knob.kind, &row.knob.kind.parse(&text).unwrap(), up, nudge)
                            else {
                                break;
                            };
                            assert!(
                                row.knob.kind.parse(&next).is_ok(),
                                "{} {}: {next}",
                                builtin.id,
                                row.knob.name
                            );
                            assert!(next.len() < 14, "{} {text} -> {next}", row.knob.name);
                            text = next;
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn nudges_are_round() {
        let real = Kind::Real { min: 0.0, max: 100.0, auto: false };
        let n = |x: f64, up, nudge| nudged(&real, &Value::Real(x), up, nudge).unwrap();
        assert_eq!(n(25.7, true, Nudge::Usual), "26");
        assert_eq!(n(0.02, true, Nudge::Usual), "0.0205");
        assert_eq!(n(0.1, true, Nudge::Usual), "0.102");
        assert_eq!(n(99.9, true, Nudge::Coarse), "100");
        let whole = Kind::Integer { min: 1, max: 1_000_000 };
        let n = |x: u64, up, nudge| nudged(&whole, &Value::Integer(x), up, nudge).unwrap();
        assert_eq!(n(1, false, Nudge::Coarse), "1");
        assert_eq!(n(5, true, Nudge::Usual), "6");
        assert_eq!(n(2000, true, Nudge::Usual), "2010");
        assert_eq!(n(2000, true, Nudge::Coarse), "2100");
    }
}
