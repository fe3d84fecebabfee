//! The commands of the form, and of the grammar's editor.

use super::grammar::GrammarEditor;
use super::nudge::Nudge;
use super::save_first::SaveFirstLine;
use super::save_lines::SaveLine;
use super::{
    grammar, kinds, nudge, only_turned, open, save, selected, selected_edit, selected_rule, step, turn,
    undoing, unturnable,
};
use crate::tui::command::Context;
use crate::tui::dialog::After;
use crate::tui::effect::{Effect, Effects};
use crate::tui::forest::{self, ForestOnScreen};
use crate::tui::layout::Pane;
use crate::tui::library;
use crate::tui::model::{Command, Model, Removed, free, without_form, without_preset};
use crate::tui::tree::{Tree, TreePlace, grammar_of};
use crate::tui::wood;

fn unless(model: &Model, can: impl Fn(&Tree) -> bool, why: &str) -> Option<String> {
    without_preset(model)
        .or_else(|| model.tree.as_ref().is_some_and(|tree| !can(tree)).then(|| why.to_owned()))
}

/// The same where a forest may be on screen instead.
fn either(
    model: &Model,
    tree: impl Fn(&Tree) -> bool,
    can: impl Fn(&ForestOnScreen) -> bool,
    why: &str,
) -> Option<String> {
    match &model.forest {
        Some(forest) => (!can(forest)).then(|| why.to_owned()),
        None => unless(model, tree, why),
    }
}

fn is_unmodified(model: &Model) -> Option<String> {
    unless(model, Tree::is_modified, "nothing differs from the saved preset")
}

fn has_no_grammar(model: &Model) -> Option<String> {
    // What is being read will take this tree's place, and with it what is typed.
    let reading = || model.loading.is_some().then(|| "another preset is being read".to_owned());
    let id = || model.tree.as_ref().map(|tree| linden::knob::excerpt(&tree.preset().id)).unwrap_or_default();
    unless(model, |tree| tree.grammar().is_some(), &format!("'{}' grows without a grammar", id()))
        .or_else(reading)
}

/// The file that `$EDITOR` opens when there is no grammar to edit.
fn file_to_edit(tree: &Tree) -> Result<std::path::PathBuf, String> {
    let TreePlace::File(path) = &tree.place else {
        return Err("the preset is built in; save it as one of your own first".to_owned());
    };
    let input = tree.saved().preset.generator.inputs().first().copied();
    if input.is_some() && input == path.file_name().and_then(|name| name.to_str()) {
        return Err("the file is a mesh or a scan, no text; save the tree as a preset first".to_owned());
    }
    Ok(path.clone())
}

const fn editing(
    id: &'static str,
    keys: &'static [&'static str],
    title: &'static str,
    help: &'static str,
    hint: Option<u8>,
    hindrance: fn(&Model) -> Option<String>,
    run: fn(&mut Model, &mut Effects),
) -> Command {
    Command { id, context: grammar::CONTEXT, keys, title, help, hint, hindrance, run }
}

fn unless_typed(model: &Model, can: impl Fn(&GrammarEditor) -> bool, why: &str) -> Option<String> {
    model.dialogs.top::<GrammarEditor>().is_none_or(|editor| !can(editor)).then(|| why.to_owned())
}

fn with(model: &mut Model, act: impl FnOnce(&mut GrammarEditor, &mut Model) -> After) {
    model.with(act);
}

const fn nudging(
    id: &'static str,
    keys: &'static [&'static str],
    title: &'static str,
    help: &'static str,
    hint: Option<u8>,
    run: fn(&mut Model, &mut Effects),
) -> Command {
    let hindrance = |model: &Model| without_form(model).or_else(|| unturnable(model));
    Command { id, context: Context::SHAPE, keys, title, help, hint, hindrance, run }
}

/// The rows.
pub const COMMANDS: &[Command] = &[
    Command {
        id: "knob-next",
        context: Context::SHAPE,
        keys: &["j", "down"],
        title: "Next knob",
        help: "Goes to the knob below",
        hint: None,
        hindrance: without_form,
        run: |model, _| step(model, 1),
    },
    Command {
        id: "knob-previous",
        context: Context::SHAPE,
        keys: &["k", "up"],
        title: "Previous knob",
        help: "Goes to the knob above",
        hint: None,
        hindrance: without_form,
        run: |model, _| step(model, -1),
    },
    Command {
        id: "knob-first",
        context: Context::SHAPE,
        keys: &["g", "home"],
        title: "First knob",
        help: "Goes to the top of the form",
        hint: None,
        hindrance: without_form,
        run: |model, _| step(model, isize::MIN),
    },
    Command {
        id: "knob-last",
        context: Context::SHAPE,
        keys: &["G", "end"],
        title: "Last knob",
        help: "Goes to the bottom of the form",
        hint: None,
        hindrance: without_form,
        run: |model, _| step(model, isize::MAX),
    },
    Command {
        id: "knob-page-down",
        context: Context::SHAPE,
        keys: &["ctrl-d", "pagedown"],
        title: "Knobs: page down",
        help: "Goes eight knobs down",
        hint: None,
        hindrance: without_form,
        run: |model, _| step(model, 8),
    },
    Command {
        id: "knob-page-up",
        context: Context::SHAPE,
        keys: &["ctrl-u", "pageup"],
        title: "Knobs: page up",
        help: "Goes eight knobs up",
        hint: None,
        hindrance: without_form,
        run: |model, _| step(model, -8),
    },
    Command {
        id: "knobs-changed",
        context: Context::SHAPE,
        keys: &["*"],
        title: "Changed knobs alone",
        help: "Lists only what differs from the saved preset, or all again",
        hint: None,
        hindrance: |model| if model.form.only_turned { None } else { is_unmodified(model) },
        run: |model, _| only_turned(model),
    },
    nudging(
        "knob-more",
        &["right", "l"],
        "More",
        "Turns the knob up a little, or to the next choice",
        Some(10),
        |m, _| nudge(m, true, Nudge::Usual),
    ),
    nudging(
        "knob-less",
        &["left", "h"],
        "Less",
        "Turns the knob down a little, or to the choice before",
        Some(11),
        |m, _| nudge(m, false, Nudge::Usual),
    ),
    nudging(
        "knob-more-coarse",
        &["shift-right", "L"],
        "Much more",
        "Turns the knob up ten times as far, whole numbers to a round one",
        None,
        |m, _| nudge(m, true, Nudge::Coarse),
    ),
    nudging(
        "knob-less-coarse",
        &["shift-left", "H"],
        "Much less",
        "Turns the knob down ten times as far, whole numbers to a round one",
        None,
        |m, _| nudge(m, false, Nudge::Coarse),
    ),
    nudging(
        "knob-more-fine",
        &["alt-right"],
        "Slightly more",
        "Turns the knob up a tenth as far",
        None,
        |m, _| nudge(m, true, Nudge::Fine),
    ),
    nudging(
        "knob-less-fine",
        &["alt-left"],
        "Slightly less",
        "Turns the knob down a tenth as far",
        None,
        |m, _| nudge(m, false, Nudge::Fine),
    ),
    Command {
        id: "knob-type",
        context: Context::SHAPE,
        keys: &["enter", "i"],
        title: "Type",
        help: "Types the knob's value, flips a switch, opens the grammar",
        hint: Some(12),
        hindrance: without_form,
        run: |model, _| open(model),
    },
    Command {
        id: "knob-reset",
        context: Context::SHAPE,
        keys: &["r", "backspace"],
        title: "Reset",
        help: "Gives the knob, or the grammar, the saved preset's value back",
        hint: Some(14),
        hindrance: |model| {
            if let Some((knob, _)) = forest::selected(model) {
                let can = |forest: &ForestOnScreen| forest.is_turned(knob.name);
                return either(model, |_| false, can, "this is as saved");
            }
            if selected_edit(model).is_some() {
                return Some("an edit is typed anew, or taken away with its own key".to_owned());
            }
            if kinds::selected_kind(model).is_some() {
                return Some("a kind of foliage is named anew, or taken away with its own key".to_owned());
            }
            let rule = selected_rule(model).is_some();
            let turned = |tree: &Tree| {
                (rule && tree.grammar() != grammar_of(&tree.saved().preset))
                    || selected(model).is_some_and(|(row, _)| tree.is_turned(&row))
            };
            unless(model, turned, "this is as saved")
        },
        run: |model, _| {
            if let Some((knob, _)) = forest::selected(model) {
                let saved = model.forest.as_ref().and_then(|forest| forest.saved_value(knob.name));
                return turn(model, knob.name, &saved.map(|value| value.to_string()).unwrap_or_default());
            }
            let Some((row, _)) = selected(model) else {
                if let Some(tree) = &mut model.tree {
                    tree.reset_grammar();
                }
                return;
            };
            let saved = model.tree.as_ref().and_then(|tree| tree.saved().preset.text_of(&row));
            match saved {
                Some(text) => turn(model, row.knob.name, &text),
                None => model.say_warning("the saved preset does not have this knob"),
            }
        },
    },
    Command {
        id: "kind-add",
        context: Context::SHAPE,
        keys: &["+"],
        title: "Add foliage",
        help: "Adds a kind of foliage: a copy of the one that the cursor is in, else blossoms",
        hint: None,
        hindrance: |model| without_preset(model).or_else(|| kinds::is_full(model)),
        run: |model, _| kinds::add(model),
    },
    Command {
        id: "edit-remove",
        context: Context::SHAPE,
        keys: &["delete"],
        title: "Take away",
        help: "Takes the edit of the wood, or the kind of foliage, whose line the cursor is on out of the preset",
        hint: Some(15),
        hindrance: |model| {
            let why =
                || "the cursor is on no edit of the wood and no heading of a kind of foliage".to_owned();
            let is_on_one = selected_edit(model).is_some() || kinds::selected_kind(model).is_some();
            without_preset(model).or_else(|| (!is_on_one).then(why))
        },
        run: |model, _| {
            if let Some(edit) = selected_edit(model) {
                wood::take_away(model, edit);
            } else if let Some(kind) = kinds::selected_kind(model) {
                kinds::take_away(model, kind);
            }
        },
    },
    Command {
        id: "undo",
        context: Context::GLOBAL,
        keys: &["u"],
        title: "Undo",
        help: "Takes the last change back and says what it was; there is no limit. Brings a preset back that was just removed",
        hint: Some(32),
        hindrance: |model| {
            let why = || either(model, Tree::can_undo, ForestOnScreen::can_undo, "nothing was changed");
            if library::removed_last(model).is_some() { None } else { why() }
        },
        run: |model, effects| match library::removed_last(model).cloned() {
            Some(Removed { path, kept, .. }) => {
                model.library.removed = None;
                effects.push(Effect::PutBack { kept, path });
            }
            None => undoing::walk(model, true),
        },
    },
    Command {
        id: "redo",
        context: Context::GLOBAL,
        keys: &["ctrl-r"],
        title: "Redo",
        help: "Does again what was undone",
        hint: None,
        hindrance: |model| either(model, Tree::can_redo, ForestOnScreen::can_redo, "nothing was undone"),
        run: |model, _| undoing::walk(model, false),
    },
    Command {
        id: "compare",
        context: Context::GLOBAL,
        keys: &["b"],
        title: "Compare",
        help: "Shows the preset as saved, and your changes again (A/B)",
        hint: Some(36),
        hindrance: is_unmodified,
        run: |model, _| {
            if let Some(tree) = &mut model.tree {
                tree.compares = !tree.compares;
            }
        },
    },
    Command {
        id: "revert",
        context: Context::GLOBAL,
        keys: &["R"],
        title: "Revert all",
        help: "Gives all knobs the saved preset's values back; undo leads back. What is set for exports goes, too",
        hint: None,
        hindrance: |model| {
            if model.exporting.kept_of(model.place()).is_some_and(|kept| !kept.knobs.is_empty()) {
                return None;
            }
            either(
                model,
                Tree::is_modified,
                ForestOnScreen::is_modified,
                "nothing differs from the saved preset",
            )
        },
        run: |model, _| {
            if let Some(forest) = &mut model.forest {
                forest.revert();
            }
            if let Some(tree) = &mut model.tree {
                let saved = tree.saved().preset.clone();
                tree.replace(saved);
            }
            model.exporting.kept = None;
            model.say("all as the saved preset has it; 'Undo' brings your changes back");
        },
    },
    Command {
        id: "save-as",
        context: Context::GLOBAL,
        keys: &["s"],
        title: "Save as",
        help: "Saves the tree or the forest as one of yours, an opened document in its file, or at a path that you type",
        hint: Some(38),
        hindrance: |model| {
            // Why there is nothing: a file that is gone, say.
            let fault = || model.library.entry().and_then(|entry| entry.fault.clone());
            let is_empty = model.tree.is_none() && model.forest.is_none();
            without_form(model).map(|why| fault().filter(|_| is_empty).unwrap_or(why)).or_else(|| {
                model
                    .config
                    .dirs
                    .presets()
                    .is_none()
                    .then(|| "there is no folder for presets: set HOME or LINDEN_CONFIG_DIR".to_owned())
            })
        },
        run: |model, _| {
            model.end_comparison();
            if let Some(forest) = &model.forest {
                let id = save::proposed(model, &forest.wanted().id, &forest.place);
                let line = SaveLine::of_forest(forest, &id);
                return model.dialogs.open(line);
            }
            let Some(tree) = &model.tree else { return };
            let line = SaveLine::of_tree(tree, &save::proposed(model, &tree.preset().id, &tree.place));
            model.dialogs.open(line);
        },
    },
    Command {
        id: "grammar",
        context: Context::GLOBAL,
        keys: &["x"],
        title: "Edit grammar",
        help: "Opens the axiom and the rules as text; what is typed grows at once",
        hint: Some(34),
        hindrance: has_no_grammar,
        run: |model, _| {
            let row = selected_rule(model).unwrap_or(0);
            grammar::open(model, row);
        },
    },
    Command {
        id: "external",
        context: Context::GLOBAL,
        keys: &["E"],
        title: "Edit in $EDITOR",
        help: "Opens the grammar in $EDITOR, or the file of a preset of your own that has none, after it asked whether changes are saved into it first",
        hint: None,
        hindrance: |model| match &model.tree {
            Some(tree) if tree.grammar().is_none() => file_to_edit(tree).err(),
            _ => has_no_grammar(model),
        },
        run: |model, effects| {
            let Some(tree) = &model.tree else { return };
            match file_to_edit(tree) {
                Ok(path) if tree.grammar().is_none() && tree.is_modified() && save::is_document(&path) => {
                    model.dialogs.open(SaveFirstLine::new(path));
                }
                Ok(path) if tree.grammar().is_none() => effects.push(Effect::EditFile(path)),
                _ => grammar::hand_over(model, effects),
            }
        },
    },
    editing(
        "grammar-done",
        &["ctrl-s"],
        "Done",
        "Closes the editor; when something is wrong, goes there instead",
        Some(10),
        free,
        |model, _| with(model, GrammarEditor::finish),
    ),
    editing(
        "grammar-close",
        &["esc"],
        "Keep",
        "Closes the editor; what was typed stays, and the last rules that could be read grow",
        Some(11),
        free,
        |model, _| with(model, GrammarEditor::close),
    ),
    editing(
        "grammar-undo",
        &["ctrl-u"],
        "Undo typing",
        "Takes back what was typed last",
        Some(12),
        |model| unless_typed(model, GrammarEditor::can_undo, "nothing was typed"),
        |model, _| with(model, GrammarEditor::undo),
    ),
    editing(
        "grammar-redo",
        &["ctrl-r"],
        "Redo typing",
        "Types again what was taken back",
        None,
        |model| unless_typed(model, GrammarEditor::can_redo, "nothing was taken back"),
        |model, _| with(model, GrammarEditor::redo),
    ),
    editing(
        "grammar-revert",
        &["ctrl-x"],
        "Revert text",
        "Gives the text back that the editor was opened with, and then that of the document; undo leads back",
        Some(14),
        |model| unless_typed(model, |editor| editor.can_revert(model), "the text is that of the document"),
        |model, _| with(model, GrammarEditor::revert),
    ),
    editing(
        "grammar-external",
        &["alt-e"],
        "Text in $EDITOR",
        "Goes on with the text in $EDITOR",
        Some(16),
        free,
        |model, effects| grammar::hand_over(model, effects),
    ),
    Command {
        id: "shape",
        context: Context::PRESETS,
        keys: &["o"],
        title: "To its knobs",
        help: "Moves on to the knobs of the selected preset",
        hint: None,
        hindrance: free,
        run: |model, _| model.focus_on(Pane::Shape),
    },
];
