//! Text that is edited: a string, a cursor, undo.
//!
//! Grammars are a page, not a book: every step of undo is the whole text, and nothing is indexed.

use crossterm::event::{KeyCode, KeyEvent, KeyModifiers};

/// Bytes of text that undo remembers at most; the oldest steps go first.
const MOST_REMEMBERED: usize = 32 << 20;

/// Text and a cursor in it.
#[derive(Debug, Default)]
pub struct Text {
    content: String,
    /// Byte offset of the cursor, at a character's beginning or the end.
    at: usize,
    /// The column that Up and Down keep to past shorter lines.
    goal: Option<usize>,
    past: Vec<(String, usize)>,
    future: Vec<(String, usize)>,
    /// What the last key did: more of the same is the same step of undo.
    last: Option<Edit>,
}

/// What a key does to the text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Edit {
    Type,
    Erase,
}

impl Text {
    /// A text with the cursor at its beginning.
    pub fn new(text: &str) -> Self {
        Self { content: normal(text), ..Self::default() }
    }

    /// The text, its lines ended by `\n`.
    pub fn as_str(&self) -> &str {
        &self.content
    }

    /// The lines; at least one.
    pub fn lines(&self) -> impl Iterator<Item = &str> {
        self.content.split('\n')
    }

    /// Line and character of the cursor, from 0.
    pub fn cursor(&self) -> (usize, usize) {
        let before = &self.content[..self.at];
        (before.matches('\n').count(), before[self.line_start()..].chars().count())
    }

    /// Puts the cursor on a line and character, from 0, or as near as there are any.
    pub fn go_to(&mut self, line: usize, column: usize) {
        self.last = None;
        self.goal = None;
        self.place(line, column);
    }

    /// A key; whether it changed the text.
    pub fn key(&mut self, key: KeyEvent) -> bool {
        let held = |modifiers| key.modifiers.contains(modifiers);
        match (key.code, held(KeyModifiers::CONTROL), held(KeyModifiers::ALT)) {
            (KeyCode::Char(c), false, false) => {
                // A blank ends a word, and undo takes back a word at a time.
                if c == ' ' {
                    self.last = None;
                }
                return self.insert(c.encode_utf8(&mut [0; 4]), Some(Edit::Type));
            }
            (KeyCode::Enter, ..) => return self.insert("\n", None),
            (KeyCode::Backspace, false, false) | (KeyCode::Char('h'), true, _) => {
                return self.erase(self.before(1)..self.at, Some(Edit::Erase));
            }
            (KeyCode::Backspace, ..) | (KeyCode::Char('w'), true, _) => {
                return self.erase(self.word_before()..self.at, None);
            }
            (KeyCode::Delete, false, false) | (KeyCode::Char('d'), true, _) => {
                return self.erase(self.at..self.after(1), Some(Edit::Erase));
            }
            (KeyCode::Delete, ..) | (KeyCode::Char('d'), _, true) => {
                return self.erase(self.at..self.word_after(), None);
            }
            // At a line's end its break goes, so that repeating it takes whole lines.
            (KeyCode::Char('k'), true, _) => {
                let end = self.line_end();
                return self.erase(self.at..if end == self.at { self.after(1) } else { end }, None);
            }
            _ => {}
        }
        let (line, column) = self.cursor();
        let goal = self.goal.take();
        self.last = None;
        match (key.code, held(KeyModifiers::CONTROL), held(KeyModifiers::ALT)) {
            (KeyCode::Left, false, false) | (KeyCode::Char('b'), true, _) => self.at = self.before(1),
            (KeyCode::Right, false, false) | (KeyCode::Char('f'), true, _) => self.at = self.after(1),
            (KeyCode::Left, ..) | (KeyCode::Char('b'), _, true) => self.at = self.word_before(),
            (KeyCode::Right, ..) | (KeyCode::Char('f'), _, true) => self.at = self.word_after(),
            (KeyCode::Home, true, _) => self.at = 0,
            (KeyCode::End, true, _) => self.at = self.content.len(),
            (KeyCode::Home, ..) | (KeyCode::Char('a'), true, _) => self.at = self.line_start(),
            (KeyCode::End, ..) | (KeyCode::Char('e'), true, _) => self.at = self.line_end(),
            (KeyCode::Up | KeyCode::Down | KeyCode::PageUp | KeyCode::PageDown, ..) => {
                let by = match key.code {
                    KeyCode::Up => -1,
                    KeyCode::Down => 1,
                    KeyCode::PageUp => -10,
                    _ => 10,
                };
                let goal = goal.unwrap_or(column);
                self.place(line.saturating_add_signed(by), goal);
                self.goal = Some(goal);
            }
            _ => {}
        }
        false
    }

    /// Inserts pasted text as one step of undo; whether there was anything in it.
    pub fn paste(&mut self, text: &str) -> bool {
        self.insert(&normal(text), None)
    }

    /// Replaces everything, as one step of undo; whether that changed anything. The cursor stays on
    /// its line and character if it can.
    pub fn replace(&mut self, text: &str) -> bool {
        let text = normal(text);
        if text == self.content {
            return false;
        }
        let (line, column) = self.cursor();
        self.remember(None);
        self.content = text;
        self.at = 0;
        self.place(line, column);
        true
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
        if let Some((text, at)) = self.past.pop() {
            let now = std::mem::replace(&mut self.content, text);
            self.future.push((now, std::mem::replace(&mut self.at, at)));
            self.settle();
        }
    }

    /// One step forward again.
    pub fn redo(&mut self) {
        if let Some((text, at)) = self.future.pop() {
            let now = std::mem::replace(&mut self.content, text);
            self.past.push((now, std::mem::replace(&mut self.at, at)));
            self.settle();
        }
    }

    fn settle(&mut self) {
        self.last = None;
        self.goal = None;
    }

    fn insert(&mut self, text: &str, edit: Option<Edit>) -> bool {
        if text.is_empty() {
            return false;
        }
        self.remember(edit);
        self.content.insert_str(self.at, text);
        self.at += text.len();
        true
    }

    fn erase(&mut self, range: std::ops::Range<usize>, edit: Option<Edit>) -> bool {
        if range.is_empty() {
            return false;
        }
        self.remember(edit);
        self.at = range.start;
        self.content.replace_range(range, "");
        true
    }

    /// Keeps the text for undo, unless the change goes on with the last one.
    fn remember(&mut self, edit: Option<Edit>) {
        if edit.is_none() || self.last != edit {
            self.past.push((self.content.clone(), self.at));
            let mut held: usize = self.past.iter().map(|(text, _)| text.len()).sum();
            while held > MOST_REMEMBERED && self.past.len() > 1 {
                held -= self.past.remove(0).0.len();
            }
        }
        self.future.clear();
        self.last = edit;
        self.goal = None;
    }

    fn place(&mut self, line: usize, column: usize) {
        let mut start = 0;
        for _ in 0..line {
            match self.content[start..].find('\n') {
                Some(end) => start += end + 1,
                None => break,
            }
        }
        self.at = start;
        let end = self.line_end();
        self.at = self.content[start..end].char_indices().nth(column).map_or(end, |(i, _)| start + i);
    }

    fn line_start(&self) -> usize {
        self.content[..self.at].rfind('\n').map_or(0, |end| end + 1)
    }

    fn line_end(&self) -> usize {
        self.content[self.at..].find('\n').map_or(self.content.len(), |end| self.at + end)
    }

    /// The place that is a number of characters before the cursor.
    fn before(&self, characters: usize) -> usize {
        self.content[..self.at].char_indices().rev().take(characters).last().map_or(self.at, |(i, _)| i)
    }

    fn after(&self, characters: usize) -> usize {
        self.content[self.at..]
            .char_indices()
            .nth(characters)
            .map_or(self.content.len(), |(i, _)| self.at + i)
    }

    /// Where the word before the cursor begins: past blanks, then letters or then signs.
    fn word_before(&self) -> usize {
        let before = self.content[..self.at].trim_end();
        let Some(kind) = before.chars().next_back().map(is_letter) else { return 0 };
        before.trim_end_matches(|c: char| !c.is_whitespace() && is_letter(c) == kind).len()
    }

    /// Where the word after the cursor ends.
    fn word_after(&self) -> usize {
        let after = self.content[self.at..].trim_start();
        let Some(kind) = after.chars().next().map(is_letter) else { return self.content.len() };
        let rest = after.trim_start_matches(|c: char| !c.is_whitespace() && is_letter(c) == kind);
        self.content.len() - rest.len()
    }
}

fn is_letter(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

/// Text with `\n` as its only line end, and no tabs, which have no fixed width.
fn normal(text: &str) -> String {
    text.replace("\r\n", "\n").replace('\r', "\n").replace('\t', "  ")
}

#[cfg(test)]
mod tests {
    use linden_terminal::input::Shortcut;
    use proptest::prelude::*;

    use super::*;

    fn key(name: &str) -> KeyEvent {
        name.parse::<Shortcut>().unwrap().into()
    }

    fn keys(text: &mut Text, names: &str) {
        for name in names.split_whitespace() {
            text.key(key(name));
        }
    }

    #[test]
    fn keys_move_and_edit_as_shells_do() {
        let mut text = Text::new("axiom = F\r\nF -> F[+F]F");
        assert_eq!(text.lines().collect::<Vec<_>>(), ["axiom = F", "F -> F[+F]F"]);
        keys(&mut text, "end X down");
        assert_eq!(text.cursor(), (1, 10));
        keys(&mut text, "down down end ctrl-w ctrl-w");
        assert_eq!(text.as_str(), "axiom = FX\nF -> F[+F");
        keys(&mut text, "ctrl-a alt-f alt-f alt-d ctrl-k");
        assert_eq!(text.as_str(), "axiom = FX\nF ->");
        keys(&mut text, "up end ctrl-k");
        assert_eq!(text.as_str(), "axiom = FXF ->");
        keys(&mut text, "ctrl-home delete ctrl-end backspace enter");
        assert_eq!(text.as_str(), "xiom = FXF -\n");
        assert_eq!(text.cursor(), (1, 0));
    }

    #[test]
    fn up_and_down_keep_to_their_column() {
        let mut text = Text::new("long line\n\nlong line");
        text.go_to(0, 6);
        keys(&mut text, "down down");
        assert_eq!(text.cursor(), (2, 6));
        keys(&mut text, "left up");
        assert_eq!(text.cursor(), (1, 0));
        keys(&mut text, "pageup");
        assert_eq!(text.cursor(), (0, 5));
    }

    #[test]
    fn undo_takes_words_and_pastes_back_at_once() {
        let mut text = Text::new("");
        for key in "ab cd".chars() {
            text.key(KeyCode::Char(key).into());
        }
        text.paste("1\n2");
        text.undo();
        assert_eq!(text.as_str(), "ab cd");
        text.undo();
        assert_eq!(text.as_str(), "ab");
        text.undo();
        assert_eq!((text.as_str(), text.can_undo()), ("", false));
        text.redo();
        text.redo();
        assert_eq!(text.as_str(), "ab cd");
        text.key(KeyCode::Char('!').into());
        assert!(!text.can_redo());
    }

    proptest! {
        /// Any keys: the cursor stays in the text, and undo leads back to where it began.
        #[test]
        fn undo_leads_back(start in "[Fλ🌲 \n]{0,12}", script in prop::collection::vec(0_usize..18, 0..40)) {
            const KEYS: [&str; 16] = [
                "F", "λ", "space", "enter", "backspace", "delete", "left", "right", "up", "down", "home", "end",
                "ctrl-w", "alt-d", "ctrl-k", "alt-left",
            ];
            let mut text = Text::new(&start);
            for step in script {
                match step {
                    16 => text.undo(),
                    17 => text.redo(),
                    i => drop(text.key(key(KEYS[i]))),
                }
                let (line, column) = text.cursor();
                prop_assert!(column <= text.lines().nth(line).unwrap().chars().count());
            }
            let end = text.as_str().to_owned();
            let mut steps = 0;
            while text.can_undo() {
                text.undo();
                steps += 1;
            }
            prop_assert_eq!(text.as_str(), start);
            for _ in 0..steps {
                text.redo();
            }
            prop_assert_eq!(text.as_str(), end);
        }
    }
}
