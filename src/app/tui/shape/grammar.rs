//! The grammar as text, edited in place or in `$EDITOR`.
//!
//! What is typed grows as soon as it can be read; what cannot be read is pointed at, and the last
//! good tree stays. One editing, from opening to closing, is one step of the form's undo; the editor
//! has another undo. What was typed is kept with the tree, mistakes and comments too, and stands
//! there again when the editor is opened the next time.

use std::fmt::{self, Write as _};

use crossterm::event::MouseEvent;
use linden::knob::printable;
use linden::lsystem::Grammar;
use linden::lsystem::text::{ParseError, parse_grammar, write_grammar};
use ratatui::layout::Rect;

use super::text::Text;
use crate::tui::command::Context;
use crate::tui::dialog::After;
use crate::tui::effect::{Effect, Effects};
use crate::tui::layout::Target;
use crate::tui::model::Model;
use crate::tui::tree::{Tree, grammar_of};

/// Where the editor's keys are listened to.
pub const CONTEXT: Context = Context::new(60, "grammar", "In the grammar").typed();
/// The spot that the text is.
pub(super) const TEXT: usize = 0;

/// Stands above the text in `$EDITOR`, and is taken away again.
const HEADER: &str = "\
// An axiom, and a rule a line: F -> F[+F]F, or with a probability F -> (0.5) F[+F]F
// Lines like this one are comments. What is wrong is shown in linden, with this text.
";
/// Rules that the form lists; the editor has all.
const MOST_LISTED: usize = 100;
/// Characters of a rule that the form looks at.
const MOST_SHOWN: usize = 300;

/// The grammar's editor.
#[derive(Debug)]
pub struct GrammarEditor {
    pub(super) text: Text,
    /// The text when the editor was opened.
    opened: String,
    /// What is wrong with the text.
    pub(super) fault: Option<ParseError>,
    /// The first line and column on screen, as they were left: they move only as far as the cursor
    /// makes them.
    pub(super) scroll: (usize, usize),
}

impl GrammarEditor {
    fn new(text: &str) -> Self {
        let text = Text::new(text);
        Self {
            opened: text.as_str().to_owned(),
            fault: parse_grammar(text.as_str()).err(),
            text,
            scroll: (0, 0),
        }
    }

    /// Puts the cursor where the text is wrong.
    fn go_to_fault(&mut self) {
        if let Some(fault) = &self.fault {
            self.text.go_to(fault.line - 1, fault.column - 1);
        }
    }

    /// Whether there is something to undo in the text.
    pub fn can_undo(&self) -> bool {
        self.text.can_undo()
    }

    /// Whether there is something to redo in the text.
    pub fn can_redo(&self) -> bool {
        self.text.can_redo()
    }

    /// Whether the text differs from what it was when the editor was opened.
    pub fn is_changed(&self) -> bool {
        self.text.as_str() != self.opened
    }

    /// Closes the editor; says what grows when the text cannot be read.
    pub fn close(&mut self, model: &mut Model) -> After {
        if self.fault.is_some() {
            model.say_warning(
                "the last rules that could be read grow; what you typed is there when you come back",
            );
        }
        After::Closes
    }

    /// Closes the editor when all is well, else goes to what is not.
    pub fn finish(&mut self, model: &mut Model) -> After {
        if self.fault.is_none() {
            return After::Closes;
        }
        self.go_to_fault();
        self.keep_scroll(model);
        After::Stays
    }

    /// Undoes in the text.
    pub fn undo(&mut self, model: &mut Model) -> After {
        self.change(model, |text| {
            text.undo();
            true
        })
    }

    /// Redoes in the text.
    pub fn redo(&mut self, model: &mut Model) -> After {
        self.change(model, |text| {
            text.redo();
            true
        })
    }

    /// Gives the text back that the editor was opened with; where nothing was typed since, that of the document.
    pub fn revert(&mut self, model: &mut Model) -> After {
        let saved = if self.is_changed() { None } else { saved_text(model) };
        let before = saved.unwrap_or_else(|| self.opened.clone());
        self.change(model, |text| text.replace(&before))
    }

    /// Whether there is another text to revert to.
    pub fn can_revert(&self, model: &Model) -> bool {
        self.is_changed()
            || self.fault.is_some()
            || model.tree.as_ref().is_some_and(|tree| tree.grammar() != grammar_of(&tree.saved().preset))
    }

    /// Changes the text, and what follows from it.
    pub(super) fn change(&mut self, model: &mut Model, edit: impl FnOnce(&mut Text) -> bool) -> After {
        // Its file may have been read again, and say something else now.
        if model.tree.as_ref().is_none_or(|tree| tree.grammar().is_none()) {
            model.say_warning("the tree on screen has no grammar any more; its editor was closed");
            return After::Closes;
        }
        if edit(&mut self.text) {
            let text = self.text.as_str();
            let read = parse_grammar(text);
            if let Some(tree) = &mut model.tree {
                tree.type_grammar(text, read.as_ref().ok().cloned());
            }
            self.fault = read.err();
        }
        self.keep_scroll(model);
        After::Stays
    }

    /// Puts the cursor where the mouse was pressed.
    pub(super) fn point(&mut self, model: &Model, mouse: MouseEvent) {
        let area = text_area(model);
        let (first, skipped) = self.scrolled(area.width.into(), area.height.into());
        let (x, y) = (mouse.column.saturating_sub(area.x), mouse.row.saturating_sub(area.y));
        self.text.go_to(first + usize::from(y), skipped + usize::from(x));
        self.keep_scroll(model);
    }

    /// A notch of the wheel.
    pub(super) fn roll(&mut self, model: &Model, down: bool) {
        let (line, _) = self.text.cursor();
        self.text.go_to(if down { line + 3 } else { line.saturating_sub(3) }, 0);
        self.keep_scroll(model);
    }

    fn keep_scroll(&mut self, model: &Model) {
        let area = text_area(model);
        if !area.is_empty() {
            self.scroll = self.scrolled(area.width.into(), area.height.into());
        }
    }

    /// The first line and column on screen, for a text area of that width and height.
    pub(super) fn scrolled(&self, width: usize, height: usize) -> (usize, usize) {
        let (line, column) = self.text.cursor();
        let within =
            |scroll: usize, at: usize, cells: usize| scroll.clamp((at + 1).saturating_sub(cells.max(1)), at);
        (within(self.scroll.0, line, height), within(self.scroll.1, column, width))
    }
}

/// The grammar for the form, a line each: the axiom, then the first rules, each cut where it becomes a
/// page; and how many rules there are beyond.
pub fn lines(grammar: &Grammar) -> (Vec<String>, usize) {
    let mut axiom = Cut(String::from("axiom = "));
    // The one error there is: enough was written.
    let _ = grammar.axiom().iter().try_for_each(|module| write!(axiom, "{module}"));
    let productions = grammar.productions();
    let rules = productions.iter().take(MOST_LISTED).map(|rule| {
        let mut line = Cut(String::new());
        let _ = write!(line, "{rule}");
        line.0
    });
    (std::iter::once(axiom.0).chain(rules).collect(), productions.len().saturating_sub(MOST_LISTED))
}

/// Takes text until it is enough.
struct Cut(String);

impl fmt::Write for Cut {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        self.0.push_str(text);
        if self.0.len() > MOST_SHOWN { Err(fmt::Error) } else { Ok(()) }
    }
}

/// The text to edit: as it was typed last, else as the grammar says it.
fn text_of(tree: &Tree) -> Option<String> {
    let written = || tree.grammar().map(write_grammar);
    tree.draft().map(str::to_owned).or_else(written)
}

/// The text of the grammar that the document has.
fn saved_text(model: &Model) -> Option<String> {
    grammar_of(&model.tree.as_ref()?.saved().preset).map(write_grammar)
}

/// Opens the editor, with the cursor on the form's row of the grammar: 0 is the axiom.
pub fn open(model: &mut Model, row: usize) {
    let Some(tree) = &mut model.tree else { return };
    let Some(text) = text_of(tree) else { return };
    tree.begin_editing();
    let mut editor = GrammarEditor::new(&text);
    if editor.fault.is_some() {
        editor.go_to_fault();
    } else if let Some(line) = line_of(&text, row) {
        editor.text.go_to(line, usize::MAX);
    }
    model.dialogs.open(editor);
}

/// The line of a good text that holds the axiom (0) or a rule (from 1).
fn line_of(text: &str, row: usize) -> Option<usize> {
    let counts = |line: &str| !line.trim().is_empty() && !line.trim_start().starts_with("//");
    let is_axiom =
        |line: &str| line.trim_start().strip_prefix("axiom").is_some_and(|rest| rest.contains('='));
    let lines = text.lines().enumerate().filter(|(_, line)| counts(line));
    let of = |axiom: bool| lines.clone().filter(move |(_, line)| is_axiom(line) == axiom);
    let found = if row == 0 { of(true).next() } else { of(false).nth(row - 1) };
    found.map(|(line, _)| line)
}

/// Hands the text to `$EDITOR`.
pub fn hand_over(model: &Model, effects: &mut Effects) {
    let typed = model.dialogs.top::<GrammarEditor>().map(|editor| editor.text.as_str().to_owned());
    if let Some(text) = typed.or_else(|| model.tree.as_ref().and_then(text_of)) {
        effects.push(Effect::Edit(format!("{HEADER}{text}")));
    }
}

/// Takes the text that comes back from `$EDITOR`: as one step of undo, and into linden's editor when
/// something is wrong with it.
pub fn take_text(model: &mut Model, text: &str) {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text).replace("\r\n", "\n");
    let text = HEADER.lines().fold(text.as_str(), |text, line| {
        text.strip_prefix(line).map_or(text, |rest| rest.strip_prefix('\n').unwrap_or(rest))
    });
    let typed = |editor: &mut GrammarEditor, model: &mut Model| {
        let after = editor.change(model, |typed| typed.replace(text));
        editor.go_to_fault();
        editor.keep_scroll(model);
        after
    };
    if model.with(typed).is_some() {
        return;
    }
    let Some(tree) = &mut model.tree else { return };
    let Some(before) = tree.grammar().cloned() else {
        return model.say_warning("the tree on screen has no grammar any more; the text was not taken over");
    };
    tree.begin_editing();
    match parse_grammar(text) {
        Ok(grammar) => {
            let same = grammar == before;
            tree.type_grammar(text, Some(grammar));
            tree.begin_editing();
            model.say(if same { "the grammar is as it was" } else { "the edited grammar grows" });
        }
        Err(fault) => {
            tree.type_grammar(text, None);
            model.say_warning(fault.to_string());
            open(model, 0);
        }
    }
}

/// Where the text was in the last frame.
fn text_area(model: &Model) -> Rect {
    let found = model.regions.iter().rev().find(|(_, target)| *target == Target::Dialog(Some(TEXT)));
    found.map(|(area, _)| *area).unwrap_or_default()
}

/// What is wrong, for the editor's last lines.
pub(super) fn said(fault: &ParseError) -> String {
    printable(&fault.to_string())
}
