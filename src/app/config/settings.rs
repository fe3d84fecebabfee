//! `config.toml`: what can be set. One table, [`SETTINGS`], that reading, `linden doctor` and the
//! example are made from.

use std::fmt;
use std::path::Path;

use linden::knob::{Kind, Value, excerpt};
use linden_terminal::probe::Overrides;
use linden_terminal::{ColorDepth, Glyphs};

use super::Complaint;
use super::document::{TomlDocument, entries, scalar, text_of};
use crate::cache::{self, CacheSize};
use crate::memory;

/// What the user has set, defaults for the rest.
#[derive(Clone, Debug, PartialEq)]
#[expect(clippy::struct_excessive_bools, reason = "each is a switch of its own, in any combination")]
pub struct Settings {
    /// A theme's name, or `auto`. From outside: show it through `printable`.
    pub theme: String,
    /// How pictures are sent; `None`: by what the terminal answers.
    pub graphics: Option<Graphics>,
    /// How many colours; `None`: by what the terminal says.
    pub colors: Option<ColorDepth>,
    /// Whether clicks, the wheel and drags are heard.
    pub mouse: bool,
    /// A command line; `None`: `$VISUAL`, else `$EDITOR`. From outside.
    pub editor: Option<String>,
    /// Whether a person stands beside the tree.
    pub person: bool,
    /// Whether the picture has a scale bar.
    pub scale_bar: bool,
    /// What is behind the tree.
    pub scenery: Scenery,
    /// How fast the turntable turns, degrees per second; below 0 clockwise seen from above.
    pub turntable_deg_per_s: f64,
    /// Whether files are read again when they change.
    pub reload: bool,
    /// Whether the session of last time is restored.
    pub restore: bool,
    /// Bytes that work may hold at once; `None`: half of what there is.
    pub memory_bytes: Option<u64>,
    /// How much of drawn pictures is kept.
    pub cache: CacheSize,
}

/// How pictures are sent to the terminal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Graphics {
    /// The kitty graphics protocol.
    Kitty,
    /// DEC sixel.
    Sixel,
    /// iTerm2's inline images.
    Iterm2,
    /// As characters.
    Cells(Glyphs),
}

/// What is behind the tree on screen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scenery {
    /// Ground and sky.
    Lit,
    /// The terminal's own background.
    Plain,
}

/// One of [`SETTINGS`].
#[derive(Clone, Copy, Debug)]
pub struct Setting {
    /// Its key in `config.toml`.
    pub name: &'static str,
    /// What values it takes.
    pub takes: Takes,
    /// `deg/s`, or empty.
    pub unit: &'static str,
    /// One line: what it does.
    pub help: &'static str,
    read: fn(&Settings) -> Value,
    write: fn(&mut Settings, &Value),
}

/// What values a setting takes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Takes {
    /// Those of a knob.
    Kind(Kind),
    /// An amount of memory.
    Memory,
    /// How much is kept in the cache.
    Cache,
    /// Any text of one line; what it stands for.
    Text(&'static str),
}

const GRAPHICS: [(&str, Option<Graphics>); 8] = [
    ("auto", None),
    ("kitty", Some(Graphics::Kitty)),
    ("sixel", Some(Graphics::Sixel)),
    ("iterm2", Some(Graphics::Iterm2)),
    ("quadrants", Some(Graphics::Cells(Glyphs::Quadrants))),
    ("halves", Some(Graphics::Cells(Glyphs::Halves))),
    ("braille", Some(Graphics::Cells(Glyphs::Braille))),
    ("ascii", Some(Graphics::Cells(Glyphs::Ascii))),
];

const COLORS: [(&str, Option<ColorDepth>); 5] = [
    ("auto", None),
    ("truecolor", Some(ColorDepth::True)),
    ("256", Some(ColorDepth::Ansi256)),
    ("16", Some(ColorDepth::Ansi16)),
    ("none", Some(ColorDepth::None)),
];

const SCENERY: [(&str, Scenery); 2] = [("lit", Scenery::Lit), ("plain", Scenery::Plain)];

/// The words of a table, for [`Kind::Choice`].
const fn words<T: Copy, const N: usize>(table: [(&'static str, T); N]) -> [&'static str; N] {
    let mut words = [""; N];
    let mut i = 0;
    while i < N {
        words[i] = table[i].0;
        i += 1;
    }
    words
}

const GRAPHICS_WORDS: [&str; GRAPHICS.len()] = words(GRAPHICS);
const COLORS_WORDS: [&str; COLORS.len()] = words(COLORS);
const SCENERY_WORDS: [&str; SCENERY.len()] = words(SCENERY);

/// The word of a value.
fn word_of<T: Copy + PartialEq>(table: &[(&'static str, T)], value: T) -> Value {
    let found = table.iter().find(|(_, known)| *known == value);
    Value::Word(found.map_or("auto", |(word, _)| word).to_owned())
}

/// The value of a word that [`Kind::Choice`] has let pass.
fn of_word<T: Copy>(table: &[(&'static str, T)], value: &Value, slot: &mut T) {
    if let Value::Word(word) = value
        && let Some((_, found)) = table.iter().find(|(known, _)| known == word)
    {
        *slot = *found;
    }
}

/// A row for a switch.
macro_rules! switch {
    ($field:ident, $help:literal) => {
        Setting {
            name: stringify!($field),
            takes: Takes::Kind(Kind::Switch),
            unit: "",
            help: $help,
            read: |settings| Value::Switch(settings.$field),
            write: |settings, value| {
                if let Value::Switch(on) = value {
                    settings.$field = *on;
                }
            },
        }
    };
}

/// All that can be set.
pub const SETTINGS: &[Setting] = &[
    Setting {
        name: "theme",
        takes: Takes::Text("auto, dark, light, plain, or the name of a file in themes/"),
        unit: "",
        help: "colours; auto is light or dark by the terminal's background",
        read: |settings| Value::Word(settings.theme.clone()),
        write: |settings, value| {
            if let Value::Word(name) = value {
                settings.theme.clone_from(name);
            }
        },
    },
    Setting {
        name: "graphics",
        takes: Takes::Kind(Kind::Choice(&GRAPHICS_WORDS)),
        unit: "",
        help: "how pictures are sent; auto asks the terminal",
        read: |settings| word_of(&GRAPHICS, settings.graphics),
        write: |settings, value| of_word(&GRAPHICS, value, &mut settings.graphics),
    },
    Setting {
        name: "colors",
        takes: Takes::Kind(Kind::Choice(&COLORS_WORDS)),
        unit: "",
        help: "how many colours are used; auto asks the terminal and the environment",
        read: |settings| word_of(&COLORS, settings.colors),
        write: |settings, value| of_word(&COLORS, value, &mut settings.colors),
    },
    switch!(mouse, "hear clicks, the wheel and drags; false leaves selecting text to the terminal"),
    Setting {
        name: "editor",
        takes: Takes::Text("a command line; empty for $VISUAL, else $EDITOR"),
        unit: "",
        help: "what grammars are edited with outside linden",
        read: |settings| Value::Word(settings.editor.clone().unwrap_or_default()),
        write: |settings, value| {
            if let Value::Word(command) = value {
                settings.editor = Some(command.trim().to_owned()).filter(|command| !command.is_empty());
            }
        },
    },
    switch!(person, "a person beside the tree, for its size"),
    switch!(scale_bar, "a scale bar in the picture"),
    Setting {
        name: "scenery",
        takes: Takes::Kind(Kind::Choice(&SCENERY_WORDS)),
        unit: "",
        help: "what is behind the tree: lit is ground and sky in keeping with the background, plain is the background",
        read: |settings| word_of(&SCENERY, settings.scenery),
        write: |settings, value| of_word(&SCENERY, value, &mut settings.scenery),
    },
    Setting {
        name: "turntable",
        takes: Takes::Kind(Kind::Real { min: -360.0, max: 360.0, auto: false, names: &[] }),
        unit: "deg/s",
        help: "how fast the turntable turns; below 0 the other way round",
        read: |settings| Value::Real(settings.turntable_deg_per_s),
        write: |settings, value| {
            if let Value::Real(speed) = value {
                settings.turntable_deg_per_s = *speed;
            }
        },
    },
    switch!(reload, "read presets and these files again when they change"),
    switch!(restore, "begin where the last session ended"),
    Setting {
        name: "memory",
        takes: Takes::Memory,
        unit: "",
        help: "the most memory that work may hold at once; auto is half of what there is",
        read: |settings| {
            let mebibytes = |bytes: u64| format!("{}M", bytes >> 20);
            Value::Word(settings.memory_bytes.map_or_else(|| "auto".to_owned(), mebibytes))
        },
        write: |settings, value| {
            if let Value::Word(text) = value
                && let Ok(bytes) = memory::parse(text)
            {
                settings.memory_bytes = bytes;
            }
        },
    },
    Setting {
        name: "cache",
        takes: Takes::Cache,
        unit: "",
        help: "how much of drawn pictures is kept on the disk for the next time ('linden cache')",
        read: |settings| Value::Word(settings.cache.to_string()),
        write: |settings, value| {
            if let Value::Word(text) = value
                && let Ok(size) = CacheSize::parse(text)
            {
                settings.cache = size;
            }
        },
    },
];

impl Default for Settings {
    fn default() -> Self {
        Self {
            theme: "auto".to_owned(),
            graphics: None,
            colors: None,
            mouse: true,
            editor: None,
            person: true,
            scale_bar: true,
            scenery: Scenery::Lit,
            turntable_deg_per_s: 30.0,
            reload: true,
            restore: true,
            memory_bytes: None,
            cache: CacheSize::Auto,
        }
    }
}

impl fmt::Display for Takes {
    /// What a user may write.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Kind(kind) => kind.fmt(f),
            Self::Memory => f.write_str(memory::TAKES),
            Self::Cache => f.write_str(cache::TAKES),
            Self::Text(what) => f.write_str(what),
        }
    }
}

impl Setting {
    /// Its value in some settings. Texts are from outside.
    pub fn value(&self, settings: &Settings) -> Value {
        (self.read)(settings)
    }

    /// Sets it to what was typed.
    ///
    /// # Errors
    /// What it takes instead.
    pub fn set(&self, settings: &mut Settings, text: &str) -> Result<(), String> {
        (self.write)(settings, &self.parse(text)?);
        Ok(())
    }

    fn parse(&self, text: &str) -> Result<Value, String> {
        match self.takes {
            Takes::Kind(kind) => kind.parse(text),
            Takes::Memory => memory::parse(text).map(|_| Value::Word(text.to_owned())),
            Takes::Cache => CacheSize::parse(text).map(|_| Value::Word(text.to_owned())),
            Takes::Text(what) if text.chars().any(char::is_control) => {
                Err(format!("'{}' has control characters; expected {what}", excerpt(text)))
            }
            Takes::Text(_) => Ok(Value::Word(text.to_owned())),
        }
    }
}

impl Settings {
    /// The settings in a file ([`Dirs::settings`](super::dirs::Dirs::settings)), defaults where there is none.
    pub fn load(file: Option<&Path>) -> (Self, Vec<Complaint>) {
        let Some(file) = file else { return (Self::default(), Vec::new()) };
        match text_of(file) {
            Ok(text) => Self::read(file, &text),
            Err(complaint) => (Self::default(), vec![complaint]),
        }
    }

    /// What they say of the terminal.
    pub fn overrides(&self) -> Overrides {
        const FILE: &str = "config.toml";
        let mut overrides = Overrides::default();
        // Every word of the two tables is one that is understood; a test tries them.
        let _ = overrides.set_graphics(&word_of(&GRAPHICS, self.graphics).to_string(), FILE);
        let _ = overrides.set_colors(&word_of(&COLORS, self.colors).to_string(), FILE);
        overrides
    }

    /// The settings in a text; `file` is for the complaints.
    pub fn read(file: &Path, text: &str) -> (Self, Vec<Complaint>) {
        let mut settings = Self::default();
        let (mut document, table) = TomlDocument::parse(file, text);
        for (key, span, value) in entries(&table) {
            let Some(setting) = SETTINGS.iter().find(|setting| setting.name == key) else {
                document.unknown(&span, "setting", key, SETTINGS.iter().map(|setting| setting.name));
                continue;
            };
            match scalar(value.get_ref()).map(|text| setting.parse(&text)) {
                Some(Ok(value)) => (setting.write)(&mut settings, &value),
                Some(Err(problem)) => {
                    document.complain(&value.span(), format!("'{}': {problem}", setting.name));
                }
                None => document.mismatch(key, value, &setting.takes.to_string()),
            }
        }
        (settings, document.finish())
    }
}

/// A `config.toml` with every setting at its default, commented out.
pub fn example() -> String {
    let defaults = Settings::default();
    let mut text = "# linden's settings. A line counts once its '#' is removed.\n".to_owned();
    for setting in SETTINGS {
        let unit = if setting.unit.is_empty() { String::new() } else { format!(", {}", setting.unit) };
        let value = match setting.value(&defaults) {
            Value::Word(word) => toml::Value::String(word).to_string(),
            value => value.to_string(),
        };
        text += &format!("\n# {}.\n# {}{unit}\n#{} = {value}\n", setting.help, setting.takes, setting.name);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> (Settings, Vec<Complaint>) {
        Settings::read(Path::new("config.toml"), text)
    }

    #[test]
    fn every_setting_can_be_set() {
        let text = "theme = \"moor\"\ngraphics = \"halves\"\ncolors = 256\nmouse = false\neditor = \"hx -c x\"\n\
                    person = false\nscale_bar = false\nscenery = \"plain\"\nmemory = \"512M\"\n\
                    cache = \"off\"\n\
                    turntable = -12.5\nreload = false\nrestore = false\n";
        let (settings, complaints) = read(text);
        assert_eq!(complaints, []);
        let expected = Settings {
            theme: "moor".into(),
            graphics: Some(Graphics::Cells(Glyphs::Halves)),
            colors: Some(ColorDepth::Ansi256),
            mouse: false,
            editor: Some("hx -c x".into()),
            person: false,
            scale_bar: false,
            scenery: Scenery::Plain,
            turntable_deg_per_s: -12.5,
            reload: false,
            restore: false,
            memory_bytes: Some(512 << 20),
            cache: CacheSize::Off,
        };
        assert_eq!(settings, expected);
        // A setting that the text above forgets would still stand at its default.
        for setting in SETTINGS {
            assert_ne!(setting.value(&settings), setting.value(&Settings::default()), "{}", setting.name);
        }
    }

    #[test]
    fn every_word_is_taken_and_shown_as_it_was_written() {
        for (key, words) in [("graphics", &GRAPHICS_WORDS[..]), ("colors", &COLORS_WORDS[..])] {
            for word in words {
                let (settings, complaints) = read(&format!("{key} = \"{word}\""));
                assert_eq!(complaints, []);
                let setting = SETTINGS.iter().find(|setting| setting.name == key).unwrap();
                assert_eq!(setting.value(&settings).to_string(), *word);
                assert_eq!(settings.overrides() == Overrides::default(), *word == "auto", "{key} = {word}");
            }
        }
    }

    #[test]
    fn what_is_wrong_is_said_with_its_place_and_the_rest_counts() {
        let text =
            "mouse = \"maybe\"\n  grafics = \"kitty\"\nturntable = 1e9\nperson = [1]\nscale_bar = false\n";
        let (settings, complaints) = read(text);
        assert_eq!(settings, Settings { scale_bar: false, ..Settings::default() });
        let places: Vec<_> = complaints.iter().map(|c| c.place.unwrap()).collect();
        assert_eq!(places, [(1, 9), (2, 3), (3, 13), (4, 10)]);
        assert!(complaints[0].message.contains("'maybe' is not true | false"), "{}", complaints[0]);
        assert!(complaints[1].message.contains("did you mean 'graphics'"), "{}", complaints[1]);
        assert!(complaints[2].message.contains("outside the range"), "{}", complaints[2]);
        assert!(complaints[3].message.contains("'person' is a list"), "{}", complaints[3]);
    }

    #[test]
    fn a_text_of_several_lines_is_no_name() {
        let (settings, complaints) = read("theme = \"a\\u001b[2J\"\n");
        assert_eq!(settings, Settings::default());
        assert!(complaints[0].message.contains("\\u{1b}"), "{}", complaints[0]);
    }

    #[test]
    fn no_file_is_no_complaint_and_a_directory_is_one() {
        let dir = tempfile::tempdir().unwrap();
        assert_eq!(Settings::load(Some(&dir.path().join("none"))), (Settings::default(), vec![]));
        assert_eq!(Settings::load(None), (Settings::default(), vec![]));
        assert_eq!(Settings::load(Some(dir.path())).1.len(), 1);
    }

    #[test]
    fn the_example_is_commented_out_and_says_the_defaults() {
        assert_eq!(read(&example()), (Settings::default(), vec![]));
        let lines = example();
        let active: String = lines
            .lines()
            .map(|line| match line.strip_prefix('#') {
                Some(text) if !text.starts_with(' ') => format!("{text}\n"),
                _ => format!("{line}\n"),
            })
            .collect();
        assert_eq!(read(&active), (Settings::default(), vec![]));
        assert!(SETTINGS.iter().all(|setting| active.contains(&format!("\n{} = ", setting.name))));
    }
}
