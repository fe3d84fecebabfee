//! The tree on screen: the document it comes from, what was changed since, and what it grew into.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

use linden::lsystem::Grammar;
use linden::preset::{KnobError, LSystem, Preset, PresetKnob};
use linden::recipe::Recipe;

use super::merge::merged;
use crate::jobs::{HowFar, ShownTree};

/// Nudges of one knob that follow each other faster are one step of undo.
const ONE_STEP: Duration = Duration::from_millis(700);

/// Where a tree comes from: what SOURCE is on a command line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum TreePlace {
    /// A built-in preset's id.
    Builtin(&'static str),
    /// A file.
    File(PathBuf),
}

/// The tree on screen.
pub struct Tree {
    /// Where its document is.
    pub place: TreePlace,
    /// As the document has it.
    saved: Arc<Recipe>,
    /// As it is now.
    current: Arc<Recipe>,
    past: Vec<Arc<Recipe>>,
    future: Vec<Arc<Recipe>>,
    /// The changes that were made last, when more may join them as one step of undo.
    series: Option<UndoSeries>,
    draft: Option<Draft>,
    /// Whether the saved one is looked at for comparison (A/B).
    pub compares: bool,
    /// Whether its document is gone: nothing but this tree knows what it says.
    pub is_orphan: bool,
    /// Whether its document was changed by others while it had changes that are not saved.
    pub is_overtaken: bool,
    /// The last that grew. Stays on screen while another grows, and when another cannot.
    pub shown: Option<Arc<ShownTree>>,
    /// Why the recipe on screen did not grow.
    pub fault: Option<String>,
    /// How far the growing is.
    pub growing: Option<HowFar>,
}

/// What is to be changed of a tree as soon as its document is read.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Changes {
    /// Knobs, as `--set` has them.
    pub knobs: Vec<(String, String)>,
    /// A whole recipe instead, where knobs cannot say it.
    pub whole: Option<String>,
}

/// Changes that are one step of undo together, by what they have in common.
#[derive(Clone, Copy, PartialEq)]
enum UndoSeries {
    /// Nudges of one knob; when the last one was.
    Knob(&'static str, Instant),
    /// One editing of the grammar.
    Grammar,
    /// One drag in the picture.
    Drag,
    /// Keys that move one thing in the picture; when the last one was.
    Nudge(Instant),
}

/// The grammar as it was typed, with its comments and its mistakes.
struct Draft {
    text: String,
    /// What grew when it was typed: the draft is shown again as long as that does.
    grammar: Grammar,
}

impl Tree {
    /// A tree as its document has it.
    pub fn new(place: TreePlace, recipe: Recipe) -> Self {
        let recipe = Arc::new(recipe);
        Self {
            place,
            saved: Arc::clone(&recipe),
            current: recipe,
            past: Vec::new(),
            future: Vec::new(),
            series: None,
            draft: None,
            compares: false,
            is_orphan: false,
            is_overtaken: false,
            shown: None,
            fault: None,
            growing: None,
        }
    }

    /// Whether its document is that file.
    pub fn is_from(&self, path: &Path) -> bool {
        matches!(&self.place, TreePlace::File(own) if own == path)
    }

    /// The files that it was read from.
    pub fn files(&self) -> Vec<PathBuf> {
        let TreePlace::File(path) = &self.place else { return Vec::new() };
        let folder = path.parent().unwrap_or(Path::new(""));
        let beside = self.saved.preset.files().into_iter().map(|file| folder.join(file));
        std::iter::once(path.clone()).chain(beside).collect()
    }

    /// What should be on screen: the current recipe, or the saved one while comparing.
    pub fn wanted(&self) -> &Arc<Recipe> {
        if self.compares { &self.saved } else { &self.current }
    }

    /// Whether a tree that grew is shown: the wanted one, or one on the way to it. While a key is
    /// held each tree is overtaken before it has grown, and none would ever be seen.
    pub fn takes(&self, grown: &ShownTree) -> bool {
        let is_wanted = |shown: &ShownTree| Arc::ptr_eq(&shown.recipe, self.wanted());
        let is_late = self.shown.as_ref().is_none_or(|shown| is_wanted(shown));
        let is_on_the_way = self.series.is_some() && !is_late && grown.recipe.preset.id == self.preset().id;
        is_wanted(grown) || is_on_the_way
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

    /// Whether anything differs from the document, or that is gone.
    pub fn is_modified(&self) -> bool {
        self.is_orphan || self.current.preset != self.saved.preset
    }

    /// Whether a knob differs from the document.
    pub fn is_turned(&self, knob: &PresetKnob) -> bool {
        self.saved.preset.differs(knob, &self.current.preset)
    }

    /// The names of the knobs that differ from the document.
    pub fn turned(&self) -> Vec<&'static str> {
        let knobs = self.current.preset.all_knobs().into_iter();
        knobs.filter(|(knob, _)| self.is_turned(knob)).map(|(knob, _)| knob.knob.name).collect()
    }

    /// Turns a knob to what was typed.
    ///
    /// # Errors
    /// What the knob does not take.
    pub fn set(&mut self, name: &'static str, text: &str, now: Instant) -> Result<(), KnobError> {
        let mut preset = self.current.preset.clone();
        preset.set(name, text)?;
        let follows = matches!(self.series, Some(UndoSeries::Knob(last, at))
            if last == name && now.saturating_duration_since(at) < ONE_STEP);
        self.change(preset, follows, Some(UndoSeries::Knob(name, now)));
        Ok(())
    }

    /// Makes changes that were asked for before the document was read: one step of undo. What cannot
    /// be made is said, and the rest is made.
    pub fn apply(&mut self, changes: &Changes) -> Vec<String> {
        let mut complaints = Vec::new();
        let mut preset = self.current.preset.clone();
        if let Some(text) = &changes.whole {
            match Preset::from_json(text) {
                Ok(turned) => preset = turned,
                Err(fault) => complaints.push(format!("the tree of last time: {}", fault.message)),
            }
        }
        for (name, value) in &changes.knobs {
            if let Err(error) = preset.set(name, value) {
                complaints.push(error.to_string());
            }
        }
        self.replace(preset);
        complaints
    }

    /// What is changed next is a step of undo of its own.
    pub fn begin_step(&mut self) {
        self.series = None;
    }

    /// Replaces the whole preset (a variation, all knobs as saved), as one step of undo.
    pub fn replace(&mut self, preset: Preset) {
        self.change(preset, false, None);
    }

    /// Begins a drag: what is [dragged](Self::drag) from here on is one step of undo.
    pub fn begin_drag(&mut self) {
        self.series = None;
    }

    /// Replaces the whole preset while something of it is dragged.
    pub fn drag(&mut self, preset: Preset) {
        let follows = self.series == Some(UndoSeries::Drag);
        self.change(preset, follows, Some(UndoSeries::Drag));
    }

    /// Replaces the whole preset by a key that moves something a little: keys that follow each other fast are one
    /// step of undo, until a [drag begins](Self::begin_drag).
    pub fn nudge(&mut self, preset: Preset, now: Instant) {
        let follows = matches!(self.series, Some(UndoSeries::Nudge(at))
            if now.saturating_duration_since(at) < ONE_STEP);
        self.change(preset, follows, Some(UndoSeries::Nudge(now)));
    }

    /// The grammar, `None` for a tree that grows by colonization.
    pub fn grammar(&self) -> Option<&Grammar> {
        grammar_of(self.preset())
    }

    /// Begins an editing of the grammar: what is [typed](Self::type_grammar) from here on is one step
    /// of undo.
    pub fn begin_editing(&mut self) {
        self.series = None;
    }

    /// Takes a grammar's text as it is being typed. A text that can be read grows; of one that cannot
    /// the text is kept, and the last good grammar stays. A tree without a grammar stays as it is.
    pub fn type_grammar(&mut self, text: &str, read: Option<Grammar>) {
        if let Some(grammar) = read {
            let mut preset = self.current.preset.clone();
            let Some(lsystem) = preset.settings_mut::<LSystem>() else { return };
            lsystem.grammar = grammar;
            lsystem.unfit.clear();
            let follows = self.series == Some(UndoSeries::Grammar);
            self.change(preset, follows, Some(UndoSeries::Grammar));
        }
        if let Some(grammar) = self.grammar().cloned() {
            self.draft = Some(Draft { text: text.to_owned(), grammar });
        }
    }

    /// Gives the grammar of the document back, as one step of undo.
    pub fn reset_grammar(&mut self) {
        let mut preset = self.current.preset.clone();
        if let (Some(lsystem), Some(saved)) =
            (preset.settings_mut::<LSystem>(), grammar_of(&self.saved.preset))
        {
            lsystem.grammar = saved.clone();
            lsystem.unfit.clear();
            self.replace(preset);
        }
    }

    /// The grammar's text as it was typed, when what grew from it then still does.
    pub fn draft(&self) -> Option<&str> {
        let draft = self.draft.as_ref()?;
        (self.grammar() == Some(&draft.grammar)).then_some(&draft.text)
    }

    fn change(&mut self, preset: Preset, follows: bool, series: Option<UndoSeries>) {
        self.compares = false;
        if preset == self.current.preset {
            return;
        }
        if follows && self.past.last().is_some_and(|before| before.preset == preset) {
            // Back where the series began: there is nothing to undo.
            self.series = None;
            self.current = self.past.pop().unwrap_or_else(|| Arc::clone(&self.current));
        } else {
            let next = Arc::new(self.current.with_preset(preset));
            self.series = series;
            let last = std::mem::replace(&mut self.current, next);
            if !follows {
                self.past.push(last);
            }
        }
        self.future.clear();
    }

    /// How many steps can be undone.
    pub fn steps(&self) -> usize {
        self.past.len()
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
            self.series = None;
            self.compares = false;
        }
    }

    /// One step forward again.
    pub fn redo(&mut self) {
        if let Some(after) = self.future.pop() {
            self.past.push(std::mem::replace(&mut self.current, after));
            self.series = None;
            self.compares = false;
        }
    }

    /// Its document is called otherwise, and says the same but for its id, and its name where that was the id.
    pub fn renamed(&mut self, place: TreePlace, id: &str) {
        let steps = self.past.iter_mut().chain(&mut self.future).chain([&mut self.current, &mut self.saved]);
        for step in steps {
            let preset = &mut Arc::make_mut(step).preset;
            if preset.name == preset.id {
                id.clone_into(&mut preset.name);
            }
            id.clone_into(&mut preset.id);
        }
        self.place = place;
    }

    /// The document was read again, and changes were made here: what differs from it is counted anew,
    /// and nothing that was changed is lost.
    ///
    /// What was changed here is made to what it says now, so that nothing is taken back that others changed; a tree
    /// of which that cannot be made stays as it is.
    pub fn saved_as(&mut self, place: TreePlace, recipe: Arc<Recipe>) {
        let steps = self.past.iter_mut().chain(&mut self.future).chain([&mut self.current]);
        for step in steps.filter(|_| recipe.preset != self.saved.preset) {
            if let Some(preset) = merged(&self.saved.preset, &step.preset, &recipe.preset) {
                *step = Arc::new(recipe.with_preset(preset));
            }
        }
        self.is_overtaken |= recipe.preset != self.saved.preset;
        self.place = place;
        self.is_orphan = false;
        self.saved = recipe;
        self.series = None;
    }

    /// What is on screen was saved: nothing differs from the document, and what undo leads back to
    /// are changes of that preset.
    ///
    /// `renamed` makes of a recipe what the document has of it, its name and the name of its file.
    pub fn was_saved(&mut self, place: TreePlace, renamed: impl Fn(&Recipe) -> Recipe) {
        for recipe in self.past.iter_mut().chain(&mut self.future).chain([&mut self.current]) {
            let now = renamed(recipe);
            // What stays the same stays the same tree, which need not grow again.
            if now.preset != recipe.preset {
                *recipe = Arc::new(now);
            }
        }
        self.place = place;
        (self.is_orphan, self.is_overtaken) = (false, false);
        self.saved = Arc::clone(&self.current);
        self.series = None;
        self.compares = false;
    }

    /// The document was read again, and nothing was changed here: the new one grows, and one undo
    /// leads back.
    pub fn reloaded(&mut self, recipe: Recipe) {
        self.is_overtaken = false;
        let hash = |recipe: &Recipe| {
            recipe.inputs.iter().map(|(name, input)| (name.to_owned(), input.hash)).collect::<Vec<_>>()
        };
        if recipe.preset == self.current.preset {
            // A mesh beside it may have changed all the same; where nothing has, nothing grows anew.
            if hash(&recipe) != hash(&self.current) {
                self.current = Arc::new(recipe);
            }
        } else {
            self.past.push(std::mem::replace(&mut self.current, Arc::new(recipe)));
        }
        self.future.clear();
        self.series = None;
        self.saved = Arc::clone(&self.current);
    }

    /// The knobs that differ from the document, as `--set` takes them; `None` when knobs alone do
    /// not lead there (the grammar was edited, the document is gone).
    pub fn overrides(&self) -> Option<Vec<(&'static str, String)>> {
        if self.is_orphan {
            return None;
        }
        let mut preset = self.saved.preset.clone();
        let mut set = Vec::new();
        // A choice (the crown's shape) brings knobs along: what comes after it in the table is
        // compared with what the choice made of it.
        for (row, _) in self.current.preset.all_knobs() {
            if preset.differs(&row, &self.current.preset) {
                let text = self.current.preset.text_of(&row)?;
                preset.set(row.knob.name, &text).ok()?;
                set.push((row.knob.name, text));
            }
        }
        (preset == self.current.preset).then_some(set)
    }
}

/// A preset's grammar.
pub fn grammar_of(preset: &Preset) -> Option<&Grammar> {
    preset.settings::<LSystem>().map(|lsystem| &lsystem.grammar)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fir() -> Tree {
        let preset = linden::preset::builtin("fir").unwrap().load().unwrap();
        Tree::new(TreePlace::Builtin("fir"), Recipe::new(preset))
    }

    #[test]
    fn undo_and_redo_walk_the_same_path() {
        let mut tree = fir();
        let start = Instant::now();
        let mut states = vec![tree.preset().clone()];
        for (i, (name, value)) in [("seed", "3"), ("points", "500"), ("seed", "2")].into_iter().enumerate() {
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
}
