//! Where configuration and state are: where the system has such files, or where the user says.
//!
//! On Linux the XDG base directories (<https://specifications.freedesktop.org/basedir-spec/0.8/>), on a
//! Mac `~/Library/Application Support`, on Windows `%APPDATA%` and `%LOCALAPPDATA%`. XDG's variables count
//! everywhere: who sets them means them. Variables must name absolute paths; others are ignored.
//!
//! No crate is asked: those that know these places read the process's environment, which no test can set.

use std::ffi::OsString;
use std::path::{Path, PathBuf};

use crate::system::{FAMILY, Family};

/// The directories, where they can be known. None needs to exist.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Dirs {
    /// What the user writes: settings, themes, keymap, presets.
    pub config: Option<PathBuf>,
    /// What linden writes: the session.
    pub state: Option<PathBuf>,
    /// What linden keeps to be quicker, and can make again: drawn pictures.
    pub cache: Option<PathBuf>,
}

/// Why there is no [`Dirs::config`], and what to do.
pub const NO_CONFIG: &str = match FAMILY {
    Family::Windows => {
        "there is no directory to look for settings and presets in; set APPDATA, or LINDEN_CONFIG_DIR"
    }
    Family::Apple | Family::Xdg => {
        "there is no home directory to look for settings and presets in; set HOME, or LINDEN_CONFIG_DIR"
    }
};
/// Why there is no [`Dirs::state`], and what to do.
pub const NO_STATE: &str = match FAMILY {
    Family::Windows => "there is no directory to keep the session in; set LOCALAPPDATA, or LINDEN_STATE_DIR",
    Family::Apple | Family::Xdg => {
        "there is no home directory to keep the session in; set HOME, or LINDEN_STATE_DIR"
    }
};

/// Why there is no [`Dirs::cache`], and what to do.
pub const NO_CACHE: &str = match FAMILY {
    Family::Windows => "there is no directory for it; set LOCALAPPDATA, or LINDEN_CACHE_DIR",
    Family::Apple | Family::Xdg => "there is no home directory; set HOME, or LINDEN_CACHE_DIR",
};

/// Where a system keeps what belongs to a user: a variable, and a path below what it names.
#[derive(Clone, Copy, Debug)]
struct Convention {
    config: (&'static str, &'static str),
    state: (&'static str, &'static str),
    cache: (&'static str, &'static str),
}

const LINUX: Convention =
    Convention { config: ("HOME", ".config"), state: ("HOME", ".local/state"), cache: ("HOME", ".cache") };
const MACOS: Convention = Convention {
    config: ("HOME", "Library/Application Support"),
    state: ("HOME", "Library/Application Support"),
    cache: ("HOME", "Library/Caches"),
};
const WINDOWS: Convention =
    Convention { config: ("APPDATA", ""), state: ("LOCALAPPDATA", ""), cache: ("LOCALAPPDATA", "") };

impl Convention {
    /// This system's.
    const fn here() -> Self {
        match FAMILY {
            Family::Windows => WINDOWS,
            Family::Apple => MACOS,
            Family::Xdg => LINUX,
        }
    }
}

impl Dirs {
    /// What the environment says: `LINDEN_CONFIG_DIR` before `$XDG_CONFIG_HOME/linden` before the
    /// system's place (`$HOME/.config/linden`), and `LINDEN_STATE_DIR` before `$XDG_STATE_HOME/linden`
    /// before the system's (`$HOME/.local/state/linden`), and `LINDEN_CACHE_DIR` before `$XDG_CACHE_HOME/linden`
    /// before the system's (`$HOME/.cache/linden`).
    pub fn new(lookup: impl Fn(&str) -> Option<OsString>) -> Self {
        Self::by(Convention::here(), lookup)
    }

    fn by(system: Convention, lookup: impl Fn(&str) -> Option<OsString>) -> Self {
        let path = |name: &str| lookup(name).filter(|value| !value.is_empty()).map(PathBuf::from);
        let find = |variable: &str, xdg: &str, (base, below): (&str, &str)| {
            // What the user names may be relative; it stays what it was when the program started.
            let variable = path(variable).map(|dir| std::path::absolute(&dir).unwrap_or(dir));
            let absolute = |name: &str| path(name).filter(|dir| dir.is_absolute());
            let base = || absolute(xdg).or_else(|| absolute(base).map(|base| base.join(below)));
            variable.or_else(|| base().map(|base| base.join("linden")))
        };
        Self {
            config: find("LINDEN_CONFIG_DIR", "XDG_CONFIG_HOME", system.config),
            state: find("LINDEN_STATE_DIR", "XDG_STATE_HOME", system.state),
            cache: find("LINDEN_CACHE_DIR", "XDG_CACHE_HOME", system.cache),
        }
    }

    /// Of this process.
    pub fn of_environment() -> Self {
        Self::new(|name| std::env::var_os(name))
    }

    /// The settings.
    pub fn settings(&self) -> Option<PathBuf> {
        self.in_config("config.toml")
    }

    /// The keymap.
    pub fn keymap(&self) -> Option<PathBuf> {
        self.in_config("keymap.toml")
    }

    /// The user's presets and grammars.
    pub fn presets(&self) -> Option<PathBuf> {
        self.in_config("presets")
    }

    /// The user's themes, `NAME.toml` each.
    pub fn themes(&self) -> Option<PathBuf> {
        self.in_config("themes")
    }

    /// What was there last time.
    pub fn session(&self) -> Option<PathBuf> {
        self.state.as_deref().map(|dir| dir.join("session.toml"))
    }

    /// Drawn pictures.
    pub fn pictures(&self) -> Option<PathBuf> {
        self.cache.as_deref().map(|dir| dir.join("pictures"))
    }

    fn in_config(&self, name: impl AsRef<Path>) -> Option<PathBuf> {
        self.config.as_deref().map(|dir| dir.join(name))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn on(system: Convention, environment: &[(&str, &str)]) -> Dirs {
        let value = |name: &str| environment.iter().find(|(known, _)| *known == name).map(|(_, value)| value);
        Dirs::by(system, |name| value(name).map(OsString::from))
    }

    fn of(environment: &[(&str, &str)]) -> Dirs {
        on(LINUX, environment)
    }

    fn paths(config: &str, state: &str, cache: &str) -> Dirs {
        Dirs { config: Some(config.into()), state: Some(state.into()), cache: Some(cache.into()) }
    }

    #[test]
    fn the_most_particular_variable_counts() {
        let home = ("HOME", "/h");
        assert_eq!(of(&[home]), paths("/h/.config/linden", "/h/.local/state/linden", "/h/.cache/linden"));
        let xdg = [home, ("XDG_CONFIG_HOME", "/c"), ("XDG_STATE_HOME", "/s"), ("XDG_CACHE_HOME", "/k")];
        assert_eq!(of(&xdg), paths("/c/linden", "/s/linden", "/k/linden"));
        let ours = [("LINDEN_CONFIG_DIR", "/a"), ("LINDEN_STATE_DIR", "/b"), ("LINDEN_CACHE_DIR", "/d")];
        assert_eq!(of(&[xdg.as_slice(), &ours].concat()), paths("/a", "/b", "/d"));
    }

    #[test]
    fn each_system_has_its_places() {
        let home = ("HOME", "/h");
        let library = "/h/Library/Application Support/linden";
        let caches = "/h/Library/Caches/linden";
        assert_eq!(on(MACOS, &[home]), paths(library, library, caches));
        assert_eq!(on(MACOS, &[home, ("XDG_CONFIG_HOME", "/c")]), paths("/c/linden", library, caches));
        let windows = [home, ("APPDATA", "/roaming"), ("LOCALAPPDATA", "/local")];
        assert_eq!(on(WINDOWS, &windows), paths("/roaming/linden", "/local/linden", "/local/linden"));
        assert_eq!(on(WINDOWS, &[home]), Dirs::default());
    }

    #[test]
    fn without_a_home_there_is_what_is_named() {
        assert_eq!(of(&[]), Dirs::default());
        assert_eq!(of(&[("HOME", ""), ("XDG_STATE_HOME", "/s")]).state, Some("/s/linden".into()));
        assert_eq!(of(&[]).presets(), None);
        assert_eq!(of(&[]).session(), None);
    }

    #[test]
    fn relative_paths_are_ignored_in_xdg_and_made_absolute_in_ours() {
        assert_eq!(of(&[("HOME", "/h"), ("XDG_CONFIG_HOME", "c")]).config, Some("/h/.config/linden".into()));
        let here = std::env::current_dir().unwrap();
        assert_eq!(of(&[("LINDEN_CONFIG_DIR", "my")]).config, Some(here.join("my")));
    }

    #[test]
    fn this_process_has_what_its_environment_says() {
        assert_eq!(Dirs::of_environment(), Dirs::new(|name| std::env::var_os(name)));
    }

    #[test]
    fn each_file_has_its_place() {
        let dirs = paths("/c", "/s", "/k");
        let ours = [dirs.settings(), dirs.keymap(), dirs.presets(), dirs.themes()];
        let expected = ["/c/config.toml", "/c/keymap.toml", "/c/presets", "/c/themes"];
        assert_eq!(ours.map(Option::unwrap), expected.map(PathBuf::from));
        let linden = [dirs.session(), dirs.pictures()];
        assert_eq!(linden.map(Option::unwrap), ["/s/session.toml", "/k/pictures"].map(PathBuf::from));
    }
}
