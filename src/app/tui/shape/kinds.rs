//! Kinds of foliage in the form: added, named and taken away. Their knobs are rows like all others.

use crossterm::event::KeyEvent;
use linden::preset::{Form, LeafKind, MOST_KINDS, Preset, PresetKnob, Section};
use linden::texture::leaf::Outline;
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;

use super::{FormRow, listed, spot};
use crate::tui::chrome::prompt::{self, Prompt};
use crate::tui::command::Context;
use crate::tui::dialog::{After, Dialog};
use crate::tui::effect::Effects;
use crate::tui::layout::{Pane, View};
use crate::tui::model::{FormSpot, Model};

/// The further kind whose heading the cursor is on.
pub fn selected_kind(model: &Model) -> Option<usize> {
    match spot(model, &listed(model, model.tree.as_ref()?))? {
        FormSpot::Kind(kind) => Some(kind),
        _ => None,
    }
}

/// The further kind whose heading or knob the cursor is on.
fn around(model: &Model) -> Option<usize> {
    let rows = listed(model, model.tree.as_ref()?);
    let at = spot(model, &rows)?;
    rows.iter().find(|row| row.spot() == Some(at)).and_then(|row| match row {
        FormRow::Kind(kind, _) => Some(*kind),
        FormRow::Knob(knob, _) => match knob.section {
            Section::Kind(kind) => Some(kind),
            _ => None,
        },
        _ => None,
    })
}

/// Why no kind can be added.
pub fn is_full(model: &Model) -> Option<String> {
    let kinds = model.tree.as_ref()?.preset().dressing.foliage.kinds().count();
    (kinds >= MOST_KINDS).then(|| format!("a plant has {MOST_KINDS} kinds of foliage at most"))
}

/// A kind to begin with: few blossoms on places of their own.
fn blossom() -> LeafKind {
    let outline = Outline::named("blossom").unwrap_or(Outline::Ovate);
    LeafKind { form: Form::Curved, outline, length_m: 0.04, per_m: 6.0, level: 0.0, ..LeafKind::default() }
}

/// Adds a kind, and goes to its heading: a copy of the one that the cursor is in, else blossoms.
pub fn add(model: &mut Model) {
    let from = around(model);
    let Some(tree) = &mut model.tree else { return };
    let mut preset = tree.preset().clone();
    let copied = from.and_then(|kind| preset.dressing.foliage.also.get(kind).cloned());
    let what = if copied.is_some() { "a copy" } else { "blossoms" };
    let kind = LeafKind { name: None, ..copied.unwrap_or_else(blossom) };
    match preset.add_kind(kind) {
        Ok(kind) => {
            let label = preset.kind_labels().get(kind).cloned().unwrap_or_default();
            tree.replace(preset);
            model.form.only_turned = false;
            model.focus_on(Pane::Shape);
            model.form.selected = Some(FormSpot::Kind(kind));
            model.say(format!(
                "added: {what}, {label}; Enter names it, its knobs stand below, Undo takes it away"
            ));
        }
        Err(why) => model.say_warning(why.to_string()),
    }
}

/// Takes a kind away; its files go with it.
pub fn take_away(model: &mut Model, kind: usize) {
    let Some(tree) = &mut model.tree else { return };
    let mut preset = tree.preset().clone();
    let label = preset.kind_labels().get(kind).cloned().unwrap_or_default();
    match preset.remove_kind(kind) {
        Ok(_) => {
            tree.replace(preset);
            model.say(format!("taken away: the kind of foliage {label}; Undo gives it back"));
        }
        Err(why) => model.say_warning(why.to_string()),
    }
}

/// What a knob is called on screen and everywhere that it is typed: `blossom.leaf_keep` where it is of a kind that the
/// form calls so.
pub fn called(preset: &Preset, row: &PresetKnob) -> String {
    match row.section {
        Section::Kind(kind) => match preset.kind_labels().get(kind) {
            Some(label) => format!("{label}.{}", row.short_name()),
            None => row.knob.name.to_owned(),
        },
        _ => row.knob.name.to_owned(),
    }
}

/// What the heading of a kind says: its label, and its number where that is another.
pub fn headings(preset: &Preset) -> Vec<String> {
    let heading = |(i, label): (usize, String)| {
        let number = format!("also.{}", i + 1);
        if label == number { format!("Foliage {number}") } else { format!("Foliage {number}: {label}") }
    };
    preset.kind_labels().into_iter().enumerate().map(heading).collect()
}

/// The line of a kind's name.
pub struct KindLine {
    prompt: Prompt,
    kind: usize,
}

impl KindLine {
    /// With the name that it has.
    pub fn new(model: &Model, kind: usize) -> Self {
        let kinds = model.tree.as_ref().map(|tree| &tree.preset().dressing.foliage.also);
        let name = kinds.and_then(|kinds| kinds.get(kind)?.name.clone()).unwrap_or_default();
        Self { prompt: Prompt::selected(&name), kind }
    }

    fn named(&self, model: &Model) -> Option<Result<Preset, String>> {
        let mut preset = model.tree.as_ref()?.preset().clone();
        let named = preset.name_kind(self.kind, self.prompt.text());
        Some(named.map(|()| preset).map_err(|why| why.to_string()))
    }

    fn judge(&mut self, model: &Model) {
        self.prompt.problem = self.named(model).and_then(Result::err);
    }
}

impl Dialog<Model> for KindLine {
    fn context(&self) -> Context {
        prompt::CONTEXT
    }

    fn is_prompt(&self) -> bool {
        true
    }

    fn paint(&self, model: &Model, screen: Rect, buffer: &mut Buffer, view: &mut View) {
        let remark = match &self.prompt.problem {
            Some(problem) => prompt::Remark { text: problem.clone(), warns: true },
            None => prompt::Remark {
                text: "what the kind is called: --set NAME.leaf_keep=0; empty: by its outline".to_owned(),
                warns: false,
            },
        };
        self.prompt.paint_at_bottom(model, "name", Some(&remark), screen, buffer, view);
    }

    fn key(&mut self, model: &mut Model, key: KeyEvent, _effects: &mut Effects) -> After {
        if self.prompt.key(key) {
            self.judge(model);
        }
        After::Stays
    }

    fn paste(&mut self, model: &mut Model, text: &str, _effects: &mut Effects) -> After {
        self.prompt.paste(text);
        self.judge(model);
        After::Stays
    }

    fn accept(&mut self, model: &mut Model, _effects: &mut Effects) -> After {
        match self.named(model) {
            Some(Ok(preset)) => {
                if let Some(tree) = &mut model.tree {
                    tree.replace(preset);
                }
                After::Closes
            }
            Some(Err(why)) => {
                self.prompt.problem = Some(why);
                After::Stays
            }
            None => After::Closes,
        }
    }

    fn leave(&mut self, model: &mut Model, effects: &mut Effects) -> After {
        self.take_or_give_up(model, effects)
    }
}
