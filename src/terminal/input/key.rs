//! Keys and their names, as keymaps and help have them: `ctrl-r`, `shift-up`, `G`, `space`.

use std::fmt;
use std::str::FromStr;

/// A key with what was held beside it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Key {
    /// Which key.
    pub code: KeyCode,
    /// Whether Shift was held; never set beside [`KeyCode::Char`], whose character tells.
    pub shift: bool,
    /// Whether Alt was held.
    pub alt: bool,
    /// Whether Ctrl was held.
    pub ctrl: bool,
}

/// Which key.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum KeyCode {
    /// One that writes a character.
    Char(char),
    /// F1 to F12.
    Function(u8),
    /// Return.
    Enter,
    /// Escape.
    Escape,
    /// Tab; Shift-Tab is this with `shift`.
    Tab,
    /// Deletes to the left.
    Backspace,
    /// Deletes to the right.
    Delete,
    /// Insert.
    Insert,
    /// Cursor up.
    Up,
    /// Cursor down.
    Down,
    /// Cursor left.
    Left,
    /// Cursor right.
    Right,
    /// To the start.
    Home,
    /// To the end.
    End,
    /// A page up.
    PageUp,
    /// A page down.
    PageDown,
}

/// The keys that have names, as keymaps and help have them.
const NAMES: [(KeyCode, &str); 15] = [
    (KeyCode::Char(' '), "space"),
    (KeyCode::Enter, "enter"),
    (KeyCode::Escape, "esc"),
    (KeyCode::Tab, "tab"),
    (KeyCode::Backspace, "backspace"),
    (KeyCode::Delete, "delete"),
    (KeyCode::Insert, "insert"),
    (KeyCode::Up, "up"),
    (KeyCode::Down, "down"),
    (KeyCode::Left, "left"),
    (KeyCode::Right, "right"),
    (KeyCode::Home, "home"),
    (KeyCode::End, "end"),
    (KeyCode::PageUp, "pageup"),
    (KeyCode::PageDown, "pagedown"),
];

/// A key's name that is none.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "'{0}' is no key; keys are written like q, G, ?, space, enter, esc, tab, f1, up, pagedown, ctrl-r, alt-left, shift-tab"
)]
pub struct KeyError(String);

impl Key {
    /// A key with nothing held.
    pub const fn plain(code: KeyCode) -> Self {
        Self { code, shift: false, alt: false, ctrl: false }
    }

    /// A character.
    pub const fn char(c: char) -> Self {
        Self::plain(KeyCode::Char(c))
    }

    /// Ctrl and a character.
    pub const fn ctrl(c: char) -> Self {
        Self { ctrl: true, ..Self::char(c) }
    }
}

impl From<KeyCode> for Key {
    fn from(code: KeyCode) -> Self {
        Self::plain(code)
    }
}

impl fmt::Display for Key {
    /// As [`Key::from_str`] reads it back.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (held, name) in [(self.ctrl, "ctrl-"), (self.alt, "alt-"), (self.shift, "shift-")] {
            if held {
                f.write_str(name)?;
            }
        }
        match self.code {
            KeyCode::Function(n) => write!(f, "f{n}"),
            code => match (NAMES.iter().find(|(named, _)| *named == code), code) {
                (Some((_, name)), _) => f.write_str(name),
                (None, KeyCode::Char(c)) => write!(f, "{c}"),
                (None, _) => Ok(()),
            },
        }
    }
}

impl FromStr for Key {
    type Err = KeyError;

    fn from_str(text: &str) -> Result<Self, KeyError> {
        let unknown = || KeyError(text.chars().filter(|c| !c.is_control()).take(40).collect());
        let mut key = Self::plain(KeyCode::Escape);
        let mut rest = text;
        while let Some((held, after)) = ["ctrl-", "alt-", "shift-"]
            .into_iter()
            .find_map(|held| rest.strip_prefix(held).map(|after| (held, after)))
            .filter(|(_, after)| !after.is_empty())
        {
            match held {
                "ctrl-" => key.ctrl = true,
                "alt-" => key.alt = true,
                _ => key.shift = true,
            }
            rest = after;
        }
        let function = || rest.strip_prefix('f')?.parse().ok().filter(|n| (1..=12).contains(n));
        let mut one = rest.chars();
        key.code = if let Some((code, _)) = NAMES.iter().find(|(_, name)| *name == rest) {
            *code
        } else if let (Some(c), None) = (one.next(), one.next()) {
            KeyCode::Char(c)
        } else {
            KeyCode::Function(function().ok_or_else(unknown)?)
        };
        // Shift is in the character.
        if let KeyCode::Char(c) = key.code
            && (c.is_control() || key.shift)
        {
            return Err(unknown());
        }
        Ok(key)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_read_back() {
        for name in [
            "q",
            "G",
            "?",
            "-",
            "ctrl--",
            "space",
            "ctrl-r",
            "alt-left",
            "shift-tab",
            "f1",
            "f12",
            "pagedown",
            "f",
            "ctrl-alt-x",
        ] {
            let key: Key = name.parse().unwrap();
            assert_eq!(key.to_string(), name, "{key:?}");
        }
    }

    #[test]
    fn what_is_no_key_is_refused() {
        for name in ["", "ctrl-", "f0", "f13", "qq", "shift-a", "Ctrl-R", "\u{1b}"] {
            assert!(name.parse::<Key>().is_err(), "{name:?}");
        }
    }
}
