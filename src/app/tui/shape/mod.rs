//! The form of knobs, made from the preset's table; undo, comparison, saving; the grammar.

pub mod ages;
mod commands;
mod complete;
mod editor;
mod find;
mod forecast;
pub mod grammar;
mod kinds;
pub mod nudge;
pub mod save;
mod save_first;
pub mod save_lines;
mod slider;
mod text;
mod undoing;
pub mod value;
pub mod view;

use std::path::PathBuf;
use std::sync::Arc;

use crossterm::event::{KeyEvent, KeyModifiers, MouseEvent, MouseEventKind};
use linden::knob::{Kind, Value};
use linden::preset::{Preset, PresetKnob, Section};

pub use commands::COMMANDS;
pub use editor::class_style;
pub use kinds::called;
pub use save_lines::ask_for_folder;
pub use value::turn;

use self::nudge::{Nudge, nudged};
use self::value::ValueLine;
use super::command::Context;
use super::effect::Effects;
use super::forest;
use super::layout::Pane;
use super::model::{FormSpot, Model};
use super::picture;
use super::tree::{Tree, TreePlace, grammar_of};
use super::wood;
use crate::jobs::{PictureLook, ShownTree};

/// A row of the form.
#[derive(Clone)]
#[allow(clippy::large_enum_variant, reason = "there are a hundred rows at most, nearly all of them knobs")]
pub enum FormRow {
    /// A section's heading.
    Heading(Section),
    /// The grammar's axiom (0) or one of its rules (from 1), as text.
    Rule(usize, String),
    /// How many rules more there are, which only the editor shows.
    MoreRules(usize),
    /// A knob with its value.
    Knob(PresetKnob, Value),
    /// The heading of a further kind of foliage, by its number from 0.
    Kind(usize, String),
    /// The heading of the edits of the wood.
    Edits,
    /// One of them, in short.
    Edit(usize, String),
}

impl FormRow {
    /// What the cursor is on when it is on this row; `None` where it cannot be.
    pub const fn spot(&self) -> Option<FormSpot> {
        match self {
            Self::Knob(knob, _) => Some(FormSpot::Knob(knob.knob.name)),
            Self::Rule(index, _) => Some(FormSpot::Rule(*index)),
            Self::Edit(index, _) => Some(FormSpot::Edit(*index)),
            Self::Kind(kind, _) => Some(FormSpot::Kind(*kind)),
            Self::Heading(_) | Self::MoreRules(_) | Self::Edits => None,
        }
    }
}

/// Undoes or redoes, for dialogs in which the keys for that are those that they are everywhere.
pub fn undo_or_redo(model: &mut Model, key: KeyEvent, effects: &mut Effects) {
    let id = model.config.keymap.lookup(Context::GLOBAL.id(), key.into());
    if let Some(command) = id.filter(|id| ["undo", "redo"].contains(id)).and_then(|id| model.command(id)) {
        model.run(command, effects);
    }
}

/// The rows for a preset.
pub fn rows(preset: &Preset) -> Vec<FormRow> {
    let knobs = preset.knobs();
    let mut rows = Vec::new();
    for section in Section::all() {
        let members: Vec<_> = knobs.iter().filter(|(row, _)| row.section == section).collect();
        if members.is_empty() {
            continue;
        }
        if section != Section::Tree {
            rows.push(FormRow::Heading(section));
        }
        if let (Section::Generator(_), Some(grammar)) = (section, grammar_of(preset)) {
            let (lines, more) = grammar::lines(grammar);
            rows.extend(lines.into_iter().enumerate().map(|(i, line)| FormRow::Rule(i, line)));
            rows.extend((more > 0).then_some(FormRow::MoreRules(more)));
        }
        rows.extend(members.into_iter().map(|(row, value)| FormRow::Knob(*row, value.clone())));
        if section == Section::Foliage {
            let all = preset.kind_knobs();
            for (kind, heading) in kinds::headings(preset).into_iter().enumerate() {
                rows.push(FormRow::Kind(kind, heading));
                let its = all.iter().filter(|(row, _)| row.section == Section::Kind(kind));
                rows.extend(its.map(|(row, value)| FormRow::Knob(*row, value.clone())));
            }
        }
    }
    if !preset.edits.is_empty() {
        rows.push(FormRow::Edits);
        rows.extend(edit_lines(preset).into_iter().enumerate().map(|(i, line)| FormRow::Edit(i, line)));
    }
    rows
}

/// The edits of the wood in short, a line each.
fn edit_lines(preset: &Preset) -> Vec<String> {
    preset.edits.iter().map(ToString::to_string).collect()
}

/// The rows that are listed of the tree on screen: all, or those that differ from the document with the headings of
/// their sections.
pub fn listed(model: &Model, tree: &Tree) -> Vec<FormRow> {
    let all = rows(&tree.wanted().preset);
    if !model.form.only_turned {
        return all;
    }
    let saved = grammar_of(&tree.saved().preset).map(|grammar| grammar::lines(grammar).0).unwrap_or_default();
    let saved_edits = edit_lines(&tree.saved().preset);
    let saved_kinds = kinds::headings(&tree.saved().preset);
    let is_heading = |row: &FormRow| match row {
        // A kind that is new or was named is listed for itself.
        FormRow::Kind(_, heading) => saved_kinds.contains(heading),
        row => matches!(row, FormRow::Heading(_) | FormRow::Edits),
    };
    let mut kept: Vec<FormRow> = Vec::new();
    for row in all {
        let differs = match &row {
            FormRow::Heading(_) | FormRow::Edits | FormRow::Kind(..) => true,
            FormRow::Edit(_, text) => !saved_edits.contains(text),
            FormRow::Rule(_, text) => !saved.contains(text),
            FormRow::MoreRules(_) => false,
            FormRow::Knob(knob, _) => tree.is_turned(knob),
        };
        if differs {
            // A section without rows has no heading.
            if is_heading(&row) && kept.last().is_some_and(is_heading) {
                kept.pop();
            }
            kept.push(row);
        }
    }
    if kept.last().is_some_and(is_heading) {
        kept.pop();
    }
    kept
}

/// Where the cursor is, among these rows: at the top when what it was on is gone.
pub fn spot(model: &Model, rows: &[FormRow]) -> Option<FormSpot> {
    let mut all = rows.iter().filter_map(FormRow::spot);
    let first = all.clone().next();
    all.find(|spot| Some(*spot) == model.form.selected).or(first)
}

/// The knob that the cursor is on, with its value; `None` on a line of the grammar.
pub fn selected(model: &Model) -> Option<(PresetKnob, Value)> {
    let rows = listed(model, model.tree.as_ref()?);
    let spot = spot(model, &rows)?;
    rows.into_iter().find_map(|row| match row {
        FormRow::Knob(knob, value) if FormSpot::Knob(knob.knob.name) == spot => Some((knob, value)),
        _ => None,
    })
}

/// The line of the grammar that the cursor is on.
fn selected_rule(model: &Model) -> Option<usize> {
    match spot(model, &listed(model, model.tree.as_ref()?))? {
        FormSpot::Rule(index) => Some(index),
        FormSpot::Knob(_) | FormSpot::Edit(_) | FormSpot::Kind(_) => None,
    }
}

/// The edit of the wood that the cursor is on.
fn selected_edit(model: &Model) -> Option<usize> {
    match spot(model, &listed(model, model.tree.as_ref()?))? {
        FormSpot::Edit(index) => Some(index),
        FormSpot::Knob(_) | FormSpot::Rule(_) | FormSpot::Kind(_) => None,
    }
}

/// Moves the cursor by a number of rows.
fn step(model: &mut Model, by: isize) {
    let (spots, chosen) = match &model.tree {
        Some(tree) => {
            let rows = listed(model, tree);
            (rows.iter().filter_map(FormRow::spot).collect(), spot(model, &rows))
        }
        None => (forest::spots(), forest::selected(model).map(|(knob, _)| FormSpot::Knob(knob.name))),
    };
    let at = spots.iter().position(|other| Some(*other) == chosen).unwrap_or(0);
    let to = at.saturating_add_signed(by).min(spots.len().saturating_sub(1));
    model.form.selected = spots.get(to).copied();
}

/// Nudges the selected knob.
fn nudge(model: &mut Model, up: bool, how: Nudge) {
    match nudge_to(model, up, how) {
        Ok((name, text)) => turn(model, name, &text),
        Err(why) => model.say(why),
    }
}

/// Why the selected row cannot be nudged, but is typed; `None` where it can be.
fn unturnable(model: &Model) -> Option<String> {
    nudge_to(model, true, Nudge::Usual).err()
}

/// What nudging the selected knob turns it to, or how it is changed instead.
fn nudge_to(model: &Model, up: bool, how: Nudge) -> Result<(&'static str, String), String> {
    if let Some((knob, value)) = forest::selected(model) {
        let (kind, value) = forest::counted(knob, value);
        let text = nudged(&kind, &value, up, how);
        let typed = || format!("{} is typed: press Enter ({})", knob.name, knob.kind);
        return text.map(|text| (knob.name, text)).ok_or_else(typed);
    }
    let Some((row, value)) = selected(model) else {
        if kinds::selected_kind(model).is_some() {
            let why = "the name of a kind of foliage is typed: press Enter; its knobs stand below";
            return Err(why.to_owned());
        }
        let what = if selected_edit(model).is_some() { "an edit" } else { "a line of the grammar" };
        return Err(format!("{what} is typed: press Enter"));
    };
    let name = row.knob.name;
    let called = || model.tree.as_ref().map_or_else(String::new, |tree| kinds::called(tree.preset(), &row));
    // What each seed draws stays drawn, about another middle.
    if let Some(spread) = model.tree.as_ref().and_then(|tree| tree.preset().spread(&row)) {
        let to = nudged(&row.knob.kind, &spread.middle(), up, how);
        let moved = to.and_then(|text| row.knob.kind.parse(&text).ok()).and_then(|to| spread.about(&to));
        let typed = || format!("the spread of {} is typed: press Enter", called());
        return moved.map(|moved| (name, moved.to_string())).ok_or_else(typed);
    }
    // What is left to linden is nudged from what linden has made of it.
    let now = model.tree.as_ref().and_then(|tree| resolved(tree, &row)).filter(|_| value == Value::Auto);
    let text = nudged(&row.knob.kind, now.as_ref().unwrap_or(&value), up, how);
    text.map(|text| (name, text))
        .ok_or_else(|| format!("{} is typed: press Enter ({})", called(), row.knob.kind))
}

/// What a knob that stands at `auto` is on the tree on screen, where that can be seen.
pub fn resolved(tree: &Tree, row: &PresetKnob) -> Option<Value> {
    if row.knob.name == "bark_relief" {
        let bark = tree.preset().dressing.bark.bark();
        return Some(Value::Real(rounded(bark.relief)));
    }
    let shown = tree.shown.as_ref().filter(|shown| Arc::ptr_eq(&shown.recipe, tree.recipe()))?;
    let skeleton = &shown.grown.skeleton;
    match row.knob.name {
        "base_radius" => skeleton.radii.first().map(|radius| Value::Real(rounded(*radius))),
        "tip_radius" => {
            skeleton.radii.iter().copied().reduce(f32::min).map(|radius| Value::Real(rounded(radius)))
        }
        _ => None,
    }
}

/// Three digits of a number.
fn rounded(x: f32) -> f64 {
    format!("{x:.2e}").parse().unwrap_or(f64::from(x))
}

/// Enter: types the knob's value or an edit, flips a switch, opens the grammar.
fn open(model: &mut Model) {
    if let Some(rule) = selected_rule(model) {
        return grammar::open(model, rule);
    }
    if let Some(edit) = selected_edit(model) {
        return wood::type_again(model, edit);
    }
    if let Some(kind) = kinds::selected_kind(model) {
        let line = kinds::KindLine::new(model, kind);
        return model.dialogs.open(line);
    }
    let text_of = |row: &PresetKnob| model.tree.as_ref()?.wanted().preset.text_of(row);
    let of_tree = selected(model).map(|(row, value)| {
        (row.knob.name, row.knob.kind, text_of(&row).unwrap_or_else(|| value.to_string()))
    });
    let of_forest = || forest::selected(model).map(|(knob, value)| (knob.name, knob.kind, value.to_string()));
    let Some((name, kind, text)) = of_tree.or_else(of_forest) else { return };
    if kind == Kind::Switch {
        return nudge(model, true, Nudge::Usual);
    }
    model.dialogs.open(ValueLine::new(name, &text));
}

/// Lists only what differs from the document, or all again. The cursor stays where it can.
fn only_turned(model: &mut Model) {
    model.form.only_turned = !model.form.only_turned;
    model.say(if model.form.only_turned {
        "only what was changed is listed"
    } else {
        "all knobs are listed"
    });
}

/// Asks for a knob's name.
pub fn find_knob(model: &mut Model) {
    let line = find::FindLine::new(model);
    model.dialogs.open(line);
}

/// The wanted recipe grew, or why not.
pub fn grown(model: &mut Model, grown: Result<Arc<ShownTree>, String>) {
    let Some(tree) = &mut model.tree else { return };
    tree.growing = None;
    match grown {
        Ok(shown) if !tree.takes(&shown) => {}
        Ok(shown) => {
            tree.fault = None;
            let is_first = tree.shown.is_none();
            // What was just edited, and is not as it says.
            let before = tree.shown.as_ref().map(|before| &before.grown.remarks);
            let mut remarks = shown.grown.remarks.iter();
            let new = before.and_then(|before| remarks.find(|remark| !before.contains(remark)));
            let warning = new.map(ToString::to_string);
            for note in &shown.grown.notes {
                tracing::debug!(note, "growing");
            }
            tree.shown = Some(Arc::clone(&shown));
            if !model.picture.is_look_chosen {
                model.picture.look = PictureLook::usual(&shown);
            }
            if is_first {
                picture::first_look(model, &shown);
            }
            if let Some(warning) = warning {
                model.say_warning(warning);
            }
        }
        Err(why) => {
            tree.fault = Some(why.clone());
            // The editor says it where it says all that is wrong with its text.
            if model.dialogs.top::<grammar::GrammarEditor>().is_some() {
                model.keep_error(&why);
            } else {
                model.say_error(why);
            }
        }
    }
}

/// A preset was saved, or why not.
pub fn saved(model: &mut Model, saved: Result<(String, PathBuf), String>, effects: &mut Effects) {
    match saved {
        Ok((id, path)) => {
            let shown = crate::paths::show(&path);
            model.say(format!("saved as '{id}' in {shown}"));
            if let Some(tree) = &mut model.tree {
                let from = tree.place.clone();
                let renamed = |recipe: &_| save::renamed(recipe, &from, &id, &path);
                tree.was_saved(TreePlace::File(path.clone()), renamed);
                model.exporting.moved(Some(&from), &tree.place);
                // The list has it at once, not only when the folder was read again.
                model.library.add_file(path.clone(), tree.preset());
                model.library.select_place(&tree.place);
            }
            effects.push(super::effect::Effect::Reconfigure);
        }
        Err(why) => model.say_error(why),
    }
}

/// Text comes back from `$EDITOR`.
pub fn edited(model: &mut Model, text: Result<String, String>) {
    match text {
        Ok(text) => grammar::take_text(model, &text),
        Err(why) => model.say_error(why),
    }
}

/// The mouse over the form.
pub fn wheel(model: &mut Model, mouse: MouseEvent) {
    match mouse.kind {
        MouseEventKind::ScrollUp => step(model, -1),
        MouseEventKind::ScrollDown => step(model, 1),
        _ => {}
    }
}

/// What a row of the form is about, as it is on screen.
pub fn spot_of_row(model: &Model, row: usize) -> Option<FormSpot> {
    match &model.tree {
        Some(tree) => listed(model, tree).get(row).and_then(FormRow::spot),
        None => forest::spots().get(row).copied(),
    }
}

/// The mouse on a row of the form: selects, and on a selected line of the grammar opens it; the wheel
/// turns the knob with Ctrl, else moves on.
pub fn clicked(model: &mut Model, clicked: Option<FormSpot>, mouse: MouseEvent) {
    let chosen = match &model.tree {
        Some(tree) => spot(model, &listed(model, tree)),
        None => forest::selected(model).map(|(knob, _)| FormSpot::Knob(knob.name)),
    };
    let Some(clicked) = clicked else { return wheel(model, mouse) };
    match mouse.kind {
        MouseEventKind::Down(_) => {
            let again = model.focus == Pane::Shape && chosen == Some(clicked);
            model.focus_on(Pane::Shape);
            model.form.selected = Some(clicked);
            if again {
                open(model);
            }
        }
        MouseEventKind::ScrollUp | MouseEventKind::ScrollDown
            if mouse.modifiers.contains(KeyModifiers::CONTROL) =>
        {
            model.form.selected = Some(clicked);
            nudge(model, mouse.kind == MouseEventKind::ScrollUp, Nudge::Usual);
        }
        _ => wheel(model, mouse),
    }
}

#[cfg(test)]
mod kind_tests;
#[cfg(test)]
mod save_tests;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod undoing_tests;
