//! What the environment says of the terminal.

use std::collections::BTreeMap;
use std::fmt;

use crate::system;

/// The variables that tell of a terminal, as values.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Environment(BTreeMap<String, String>);

/// Every variable that is looked at.
const NAMES: [&str; 27] = [
    "CLICOLOR",
    "CLICOLOR_FORCE",
    "COLORFGBG",
    "COLORTERM",
    "FORCE_COLOR",
    "KITTY_WINDOW_ID",
    "KONSOLE_VERSION",
    "LANG",
    "LC_ALL",
    "LC_CTYPE",
    "LC_TERMINAL",
    "LC_TERMINAL_VERSION",
    super::overrides::COLORS,
    super::overrides::GRAPHICS,
    "NO_COLOR",
    "SSH_CLIENT",
    "SSH_CONNECTION",
    "SSH_TTY",
    "STY",
    "TERM",
    "TERM_PROGRAM",
    "TERM_PROGRAM_VERSION",
    "TMUX",
    "VTE_VERSION",
    "WEZTERM_PANE",
    "WT_SESSION",
    "ZELLIJ",
];

/// A program between us and the terminal, which answers in its place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Multiplexer {
    /// tmux.
    Tmux,
    /// GNU screen.
    Screen,
    /// Zellij.
    Zellij,
}

impl fmt::Display for Multiplexer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Tmux => "tmux",
            Self::Screen => "screen",
            Self::Zellij => "zellij",
        })
    }
}

impl Environment {
    /// That of this process. What is not Unicode counts as not set.
    pub fn of_process() -> Self {
        let of = |name| std::env::var(name).ok().or_else(|| system::stands_for(name).map(str::to_owned));
        Self::from_pairs(NAMES.iter().filter_map(|name| Some((*name, of(name)?))))
    }

    /// One of names and values. A value that is empty counts as not set.
    pub fn from_pairs<V: Into<String>>(pairs: impl IntoIterator<Item = (&'static str, V)>) -> Self {
        let pairs = pairs.into_iter().map(|(name, value)| (name.to_owned(), value.into()));
        Self(pairs.filter(|(_, value)| !value.is_empty()).collect())
    }

    /// A variable, unless it is empty.
    pub fn get(&self, name: &str) -> Option<&str> {
        self.0.get(name).map(String::as_str)
    }

    pub(super) fn term(&self) -> &str {
        self.get("TERM").unwrap_or_default()
    }

    /// A variable as reasons quote it: `TERM=xterm`.
    pub(super) fn quote(&self, name: &str) -> String {
        match self.get(name) {
            Some(value) => format!("{name}={}", printable(value)),
            None => format!("{name} is not set"),
        }
    }

    /// The first of these that is set, as reasons quote it.
    pub(super) fn quote_first(&self, names: &[&str]) -> Option<String> {
        names.iter().find(|name| self.get(name).is_some()).map(|name| self.quote(name))
    }

    /// What is between us and the terminal, and how that is known.
    ///
    /// TERM survives SSH where the others do not; tmux uses `screen…` too, which only its own answer
    /// tells apart.
    pub(super) fn multiplexer(&self) -> Option<(Multiplexer, String)> {
        let set = |name: &str, found| self.get(name).map(|_| (found, format!("{name} is set")));
        let term = |prefix: &str, found| self.term().starts_with(prefix).then(|| (found, self.quote("TERM")));
        set("TMUX", Multiplexer::Tmux)
            .or_else(|| set("ZELLIJ", Multiplexer::Zellij))
            .or_else(|| set("STY", Multiplexer::Screen))
            .or_else(|| term("tmux", Multiplexer::Tmux))
            .or_else(|| term("screen", Multiplexer::Screen))
    }

    /// The terminal's name and version as its variables have them, and which one did. They are
    /// handed down to whatever is started in it, other terminals too: an answer counts for more.
    pub(super) fn program(&self) -> Option<(String, String)> {
        let versioned = |name: &str, version: &str| {
            let program = self.get(name)?;
            let version = self.get(version).map_or_else(String::new, |version| format!(" {version}"));
            Some((format!("{program}{version}"), self.quote(name)))
        };
        let set = |name: &str, program: &str| {
            Some((program.to_owned(), format!("{} is set", self.get(name).map(|_| name)?)))
        };
        let term = |prefix: &str, program: &str| {
            self.term().starts_with(prefix).then(|| (program.to_owned(), self.quote("TERM")))
        };
        term("xterm-kitty", "kitty")
            .or_else(|| term("xterm-ghostty", "ghostty"))
            .or_else(|| term("foot", "foot"))
            .or_else(|| term("linux", "Linux console"))
            .or_else(|| versioned("TERM_PROGRAM", "TERM_PROGRAM_VERSION"))
            .or_else(|| versioned("LC_TERMINAL", "LC_TERMINAL_VERSION"))
            .or_else(|| set("WT_SESSION", "Windows Terminal"))
            .or_else(|| set("KITTY_WINDOW_ID", "kitty"))
            .or_else(|| set("WEZTERM_PANE", "WezTerm"))
            .or_else(|| set("KONSOLE_VERSION", "Konsole"))
            .or_else(|| set("VTE_VERSION", "VTE"))
    }
}

/// Text from outside with what would move the cursor or turn the writing shown as `\u{1b}`, as
/// everywhere in the interface, and cut off where it becomes a page.
pub(super) fn printable(text: &str) -> String {
    const SHOWN: usize = 60;
    let mut shown = String::new();
    for (at, c) in text.chars().enumerate() {
        if at == SHOWN {
            shown.push('…');
            break;
        }
        let is_hidden = c.is_control()
            || matches!(c, '\u{61c}' | '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2060}'..='\u{2069}' | '\u{feff}');
        if is_hidden { shown.extend(c.escape_unicode()) } else { shown.push(c) }
    }
    shown
}
