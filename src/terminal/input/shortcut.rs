//! Keys as keymaps and help write them: `ctrl-r`, `shift-up`, `G`, `space`.

use std::cmp::Ordering;
use std::fmt;
use std::str::FromStr;

use crossterm::event::{KeyCode, KeyEvent, KeyModifiers};

/// What a keymap binds: a key, and what is held beside it.
///
/// A [`KeyEvent`] says the same in several ways, and more: whether `G` comes with Shift depends on the
/// terminal. Here each combination is one value.
///
/// ```
/// use crossterm::event::{KeyCode, KeyEvent, KeyModifiers};
/// use linden_terminal::input::Shortcut;
/// let back: Shortcut = "shift-tab".parse()?;
/// assert_eq!(back, KeyEvent::new(KeyCode::BackTab, KeyModifiers::SHIFT).into());
/// assert_eq!(back.to_string(), "shift-tab");
/// # Ok::<(), linden_terminal::input::ShortcutError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Shortcut {
    code: KeyCode,
    /// Never Shift beside a character, which tells.
    modifiers: KeyModifiers,
}

/// What can be held, as names have it.
const HELD: [(KeyModifiers, &str); 3] =
    [(KeyModifiers::CONTROL, "ctrl-"), (KeyModifiers::ALT, "alt-"), (KeyModifiers::SHIFT, "shift-")];

/// The keys that have names.
const NAMES: [(KeyCode, &str); 16] = [
    (KeyCode::Char(' '), "space"),
    (KeyCode::Enter, "enter"),
    (KeyCode::Esc, "esc"),
    (KeyCode::Tab, "tab"),
    // With Shift alone.
    (KeyCode::BackTab, "tab"),
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
pub struct ShortcutError(String);

impl Shortcut {
    /// A key with nothing held.
    pub const fn plain(code: KeyCode) -> Self {
        Self { code, modifiers: KeyModifiers::NONE }
    }

    /// A character.
    pub const fn char(c: char) -> Self {
        Self::plain(KeyCode::Char(c))
    }

    /// Ctrl and a character.
    pub const fn ctrl(c: char) -> Self {
        Self { code: KeyCode::Char(c), modifiers: KeyModifiers::CONTROL }
    }

    /// What terminals send when this is pressed, where that is something else: Ctrl clears the three
    /// upper bits of an ASCII character.
    pub fn sent_instead(self) -> Option<Self> {
        let without_ctrl = |code| Some(Self { code, modifiers: self.modifiers - KeyModifiers::CONTROL });
        match self.code {
            _ if !self.modifiers.contains(KeyModifiers::CONTROL) => None,
            KeyCode::Char(c) if c.is_ascii_uppercase() => {
                Some(Self { code: KeyCode::Char(c.to_ascii_lowercase()), ..self })
            }
            KeyCode::Char('i') => without_ctrl(KeyCode::Tab),
            KeyCode::Char('m') => without_ctrl(KeyCode::Enter),
            KeyCode::Char('[') => without_ctrl(KeyCode::Esc),
            _ => None,
        }
    }
}

impl From<KeyEvent> for Shortcut {
    fn from(key: KeyEvent) -> Self {
        let modifiers = key.modifiers;
        match key.code {
            KeyCode::Char(_) => Self { code: key.code, modifiers: modifiers - KeyModifiers::SHIFT },
            KeyCode::Tab if modifiers.contains(KeyModifiers::SHIFT) => {
                Self { code: KeyCode::BackTab, modifiers }
            }
            KeyCode::BackTab => Self { code: key.code, modifiers: modifiers | KeyModifiers::SHIFT },
            code => Self { code, modifiers },
        }
    }
}

impl From<KeyCode> for Shortcut {
    fn from(code: KeyCode) -> Self {
        KeyEvent::from(code).into()
    }
}

/// As the parser says it.
impl From<Shortcut> for KeyEvent {
    fn from(Shortcut { code, modifiers }: Shortcut) -> Self {
        let shifted = matches!(code, KeyCode::Char(c) if c.is_uppercase());
        Self::new(code, if shifted { modifiers | KeyModifiers::SHIFT } else { modifiers })
    }
}

impl PartialOrd for Shortcut {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Shortcut {
    fn cmp(&self, other: &Self) -> Ordering {
        // Codes are numbers and characters, which can all be compared.
        let codes = self.code.partial_cmp(&other.code).unwrap_or(Ordering::Equal);
        codes.then(self.modifiers.bits().cmp(&other.modifiers.bits()))
    }
}

impl fmt::Display for Shortcut {
    /// As [`Shortcut::from_str`] reads it back.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (_, name) in HELD.iter().filter(|(held, _)| self.modifiers.contains(*held)) {
            f.write_str(name)?;
        }
        let name = NAMES.iter().find(|(named, _)| *named == self.code);
        match (name, self.code) {
            (Some((_, name)), _) => f.write_str(name),
            (None, KeyCode::F(n)) => write!(f, "f{n}"),
            (None, KeyCode::Char(c)) => write!(f, "{c}"),
            (None, _) => Ok(()),
        }
    }
}

impl FromStr for Shortcut {
    type Err = ShortcutError;

    fn from_str(text: &str) -> Result<Self, ShortcutError> {
        let unknown = || ShortcutError(text.chars().filter(|c| !c.is_control()).take(40).collect());
        let mut modifiers = KeyModifiers::NONE;
        let mut rest = text;
        while let Some((held, after)) = HELD
            .into_iter()
            .find_map(|(held, name)| rest.strip_prefix(name).map(|after| (held, after)))
            .filter(|(_, after)| !after.is_empty())
        {
            modifiers |= held;
            rest = after;
        }
        let function = || rest.strip_prefix('f')?.parse().ok().filter(|n| (1..=12).contains(n));
        let mut one = rest.chars();
        let code = if let Some((code, _)) = NAMES.iter().find(|(_, name)| *name == rest) {
            *code
        } else if let (Some(c), None) = (one.next(), one.next()) {
            KeyCode::Char(c)
        } else {
            KeyCode::F(function().ok_or_else(unknown)?)
        };
        // Shift is in the character.
        if let KeyCode::Char(c) = code
            && (c.is_control() || modifiers.contains(KeyModifiers::SHIFT))
        {
            return Err(unknown());
        }
        Ok(KeyEvent::new(code, modifiers).into())
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
            "ctrl-shift-tab",
            "f1",
            "f12",
            "pagedown",
            "f",
            "ctrl-alt-x",
        ] {
            let key: Shortcut = name.parse().unwrap();
            assert_eq!(key.to_string(), name, "{key:?}");
            assert_eq!(Shortcut::from(KeyEvent::from(key)), key, "{name}");
        }
    }

    #[test]
    fn what_is_no_key_is_refused() {
        for name in ["", "ctrl-", "f0", "f13", "qq", "shift-a", "Ctrl-R", "\u{1b}"] {
            assert!(name.parse::<Shortcut>().is_err(), "{name:?}");
        }
    }

    #[test]
    fn what_terminals_say_differently_is_the_same_key() {
        let said = |code, modifiers| Shortcut::from(KeyEvent::new(code, modifiers));
        let shift = KeyModifiers::SHIFT;
        assert_eq!(said(KeyCode::Char('G'), shift), Shortcut::char('G'));
        assert_eq!(said(KeyCode::Char('?'), shift), Shortcut::char('?'));
        assert_eq!(said(KeyCode::Tab, shift), said(KeyCode::BackTab, KeyModifiers::NONE));
    }
}
