//! Undo and redo: what each of them changed is said, and the cursor goes there.

use std::cmp::Ordering;

use linden::preset::{LeafKind, Preset, Section};
use linden::skeleton::edit::Edit;

use super::kinds::called;
use crate::tui::model::{FormSpot, Model};
use crate::tui::tree::grammar_of;
use crate::wrap::clipped;

/// Cells of a value in what is said.
const VALUE: usize = 24;
/// The same of an edit of the wood.
const EDIT: usize = 32;

/// What differs after a step.
struct Difference {
    /// In words: `seed 3 → 1`.
    words: String,
    /// Where it is in the form.
    spot: FormSpot,
}

/// Takes the last change back, or makes it again.
pub fn walk(model: &mut Model, is_undo: bool) {
    let differences = match (&mut model.forest, &mut model.tree) {
        (Some(forest), _) => {
            let before = forest.wanted().clone();
            if is_undo {
                forest.undo();
            } else {
                forest.redo();
            }
            let pairs = before.layout.knobs().zip(forest.wanted().layout.knobs());
            let turned = pairs.filter(|((_, was), (_, is))| was != is);
            turned
                .map(|((row, was), (_, is))| Difference {
                    words: turn(row.knob.name, &was.to_string(), &is.to_string()),
                    spot: FormSpot::Knob(row.knob.name),
                })
                .collect()
        }
        (None, Some(tree)) => {
            let before = tree.recipe().clone();
            if is_undo {
                tree.undo();
            } else {
                tree.redo();
            }
            differences(&before.preset, tree.preset(), is_undo)
        }
        (None, None) => return,
    };
    let verb = if is_undo { "undone" } else { "done again" };
    let Some((first, rest)) = differences.split_first() else {
        return model.say(verb);
    };
    model.form.selected = Some(first.spot);
    model.say(match rest {
        [] => format!("{verb}: {}", first.words),
        [second] => format!("{verb}: {}, {}", first.words, second.words),
        [second, rest @ ..] => format!("{verb}: {}, {} and {} more", first.words, second.words, rest.len()),
    });
}

fn turn(name: &str, was: &str, is: &str) -> String {
    format!("{name} {} → {}", clipped(was, VALUE), clipped(is, VALUE))
}

/// What was done to the kinds of foliage as wholes: one is there or gone, or has another name.
fn of_kinds(before: &Preset, after: &Preset) -> Option<Difference> {
    let [was, is] = [before, after].map(|preset| &preset.dressing.foliage.also);
    let label = |preset: &Preset, kind: usize| preset.kind_labels().get(kind).cloned().unwrap_or_default();
    let differs = |(was, is): (&LeafKind, &LeafKind)| was != is;
    let at = was.iter().zip(is).position(differs).unwrap_or(was.len().min(is.len()));
    let words = match was.len().cmp(&is.len()) {
        Ordering::Less => format!("the kind of foliage {} is there", label(after, at)),
        Ordering::Greater => format!("the kind of foliage {} is gone", label(before, at)),
        Ordering::Equal if was.get(at)?.name != is[at].name => {
            format!("the kind of foliage {} → {}", label(before, at), label(after, at))
        }
        Ordering::Equal => return None,
    };
    // Where none is left, the knobs of the first are next to it.
    let of_first = || after.knobs().into_iter().find(|(row, _)| row.section == Section::Foliage);
    let spot = match is.len().checked_sub(1) {
        Some(last) => FormSpot::Kind(at.min(last)),
        None => FormSpot::Knob(of_first()?.0.knob.name),
    };
    Some(Difference { words, spot })
}

/// What was done to the edits of the wood, as it was said when it was done.
fn of_edits(was: &[Edit], is: &[Edit]) -> String {
    let beyond = |edits: &[Edit], others: &[Edit]| -> Vec<String> {
        let new = edits.iter().filter(|edit| !others.contains(edit));
        new.map(|edit| clipped(&edit.plain().to_string(), EDIT)).collect()
    };
    match (&beyond(was, is)[..], &beyond(is, was)[..]) {
        ([], [one]) => one.clone(),
        ([], [one, rest @ ..]) => format!("{one} and {} more", rest.len()),
        ([one], []) => format!("taken away: {one}"),
        ([one], [other]) => format!("{one} → {other}"),
        _ => "the edits of the wood".to_owned(),
    }
}

/// What differs, in the order of the form.
fn differences(before: &Preset, after: &Preset, is_undo: bool) -> Vec<Difference> {
    let mut found = Vec::new();
    if grammar_of(before) != grammar_of(after) {
        found.push(Difference { words: "the grammar".to_owned(), spot: FormSpot::Rule(0) });
    }
    let of_kinds = of_kinds(before, after);
    // Where a kind came or went, the others have other numbers.
    let kinds_stay = before.dressing.foliage.also.len() == after.dressing.foliage.also.len();
    for (row, _) in after.all_knobs() {
        let is_comparable = kinds_stay || !matches!(row.section, Section::Kind(_));
        if is_comparable && before.differs(&row, after) {
            // A choice brings knobs along, which were not there.
            let [was, is] =
                [before, after].map(|preset| preset.text_of(&row).unwrap_or_else(|| "none".to_owned()));
            found.push(Difference {
                words: turn(&called(after, &row), &was, &is),
                spot: FormSpot::Knob(row.knob.name),
            });
        }
    }
    found.extend(of_kinds);
    if before.edits != after.edits {
        let same = before.edits.iter().zip(&after.edits).take_while(|(was, is)| was == is).count();
        let last = after.edits.len().saturating_sub(1);
        found.push(Difference {
            words: if is_undo {
                of_edits(&after.edits, &before.edits)
            } else {
                of_edits(&before.edits, &after.edits)
            },
            spot: FormSpot::Edit(same.min(last)),
        });
    }
    found
}
