//! `keymap.toml`: which key runs which command.
//!
//! The table of commands is given, so that it stands in one place. What the user binds comes before
//! defaults, what stands first before what follows; a binding that loses is complained about with both
//! names, and everything else stays in force. A key that is bound in a context and globally runs the
//! context's command there and the global one elsewhere.

use std::collections::BTreeMap;
use std::ops::Range;
use std::path::Path;

use linden::knob::excerpt;
use linden_terminal::input::Shortcut;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::Complaint;
use super::document::{TomlDocument, entries, text_of};

/// A command: its id, which stands once in the table, the context that it belongs to, and the keys that it has from the start.
pub type KeyRow = (&'static str, &'static str, &'static [&'static str]);

/// The context of commands that can be run everywhere.
pub const GLOBAL: &str = "global";

/// Cancels and quits, whatever a keymap says: the way out of a mistaken one.
pub const CANCEL: Shortcut = Shortcut::ctrl('c');

/// Which key runs which command.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Keymap {
    commands: BTreeMap<(&'static str, Shortcut), &'static str>,
    keys: BTreeMap<&'static str, Vec<Shortcut>>,
}

/// What a file says of one command.
struct Wish {
    row: KeyRow,
    keys: Vec<(Shortcut, Range<usize>)>,
    span: Range<usize>,
}

impl Wish {
    fn has_cancel(&self) -> bool {
        self.keys.iter().any(|(key, _)| *key == CANCEL)
    }
}

impl Keymap {
    /// As the table of commands has it. A name there that is no key binds nothing; the table's own
    /// test looks for that.
    pub fn defaults(table: &[KeyRow]) -> Self {
        let mut keymap = Self::default();
        for &(id, context, names) in table {
            for key in names.iter().filter_map(|name| name.parse().ok()) {
                keymap.bind(id, context, key);
            }
        }
        keymap
    }

    /// The keymap in a file ([`Dirs::keymap`](super::dirs::Dirs::keymap)), defaults where there is none.
    pub fn load(file: Option<&Path>, table: &[KeyRow]) -> (Self, Vec<Complaint>) {
        let Some(file) = file else { return (Self::defaults(table), Vec::new()) };
        match text_of(file) {
            Ok(text) => Self::read(file, &text, table),
            Err(complaint) => (Self::defaults(table), vec![complaint]),
        }
    }

    /// The keymap in a text; `file` is for the complaints.
    pub fn read(file: &Path, text: &str, table: &[KeyRow]) -> (Self, Vec<Complaint>) {
        let (mut document, root) = TomlDocument::parse(file, text);
        let mut wishes = Vec::new();
        for (key, span, value) in entries(&root) {
            if key != "keys" {
                document.unknown(&span, "table", key, ["keys"]);
            } else if let Some(keys) = document.table(key, value) {
                collect(&mut document, table, "", keys, &mut wishes);
            }
        }
        let mut keymap = Self::default();
        for wish in &wishes {
            keymap.grant(&mut document, wish);
        }
        for &(id, context, names) in table {
            // A command that got none of the keys it was to have keeps those it had.
            let wish = wishes.iter().find(|wish| wish.row.0 == id);
            let wish =
                wish.filter(|wish| wish.keys.is_empty() || wish.has_cancel() || keymap.keys.contains_key(id));
            for key in names.iter().filter_map(|name| name.parse::<Shortcut>().ok()) {
                if key == CANCEL {
                    keymap.bind(id, context, key);
                } else if wish.is_none() {
                    keymap.keep_default(&mut document, &wishes, (id, context), key);
                }
            }
        }
        (keymap, document.finish())
    }

    /// What a key runs in exactly this context.
    pub fn lookup(&self, context: &str, key: Shortcut) -> Option<&'static str> {
        self.commands.get(&(context, key)).copied()
    }

    /// The keys of a command, the first for hints; none for one that is unbound or unknown.
    pub fn keys_of(&self, id: &str) -> &[Shortcut] {
        self.keys.get(id).map_or(&[], Vec::as_slice)
    }

    fn bind(&mut self, id: &'static str, context: &'static str, key: Shortcut) {
        // The first one stays.
        if *self.commands.entry((context, key)).or_insert(id) == id {
            let keys = self.keys.entry(id).or_default();
            if !keys.contains(&key) {
                keys.push(key);
            }
        }
    }

    /// Binds what a file asks for.
    fn grant(&mut self, document: &mut TomlDocument<'_>, wish: &Wish) {
        let (id, context, defaults) = wish.row;
        if wish.keys.is_empty() && has_cancel(defaults) {
            document.complain(
                &wish.span,
                format!("'{id}' keeps {CANCEL}, which always cancels and quits; its other keys are unbound"),
            );
        }
        for (key, span) in &wish.keys {
            if *key == CANCEL {
                continue;
            }
            match self.commands.get(&(context, *key)) {
                Some(other) if *other != id => {
                    document.complain(
                        span,
                        format!(
                            "{key} is bound twice: to '{other}', which keeps it, and to '{id}'; choose another key"
                        ),
                    );
                }
                _ => self.bind(id, context, *key),
            }
            let elsewhere = self.commands.iter().find(|((there, bound), other)| {
                bound == key && *there != context && (context == GLOBAL || *there == GLOBAL) && **other != id
            });
            if let Some(((there, _), other)) = elsewhere {
                let (inner, global, place) =
                    if context == GLOBAL { (*other, id, *there) } else { (id, *other, context) };
                document.complain(
                    span,
                    format!("{key} is bound twice: '{place}' runs '{inner}', everything else '{global}'"),
                );
            }
        }
    }

    /// Binds a default, unless the file gave the key away.
    fn keep_default(
        &mut self,
        document: &mut TomlDocument<'_>,
        wishes: &[Wish],
        (id, context): (&'static str, &'static str),
        key: Shortcut,
    ) {
        let takers = wishes.iter().flat_map(|wish| {
            wish.keys.iter().filter(|(of, _)| *of == key).map(|(_, span)| (wish.row.0, wish.row.1, span))
        });
        for (taker, taken_in, span) in takers {
            // A global key of the user's goes before a default of any context.
            if taken_in == context || taken_in == GLOBAL {
                document.complain(
                    span,
                    format!(
                        "{key} now runs '{taker}' and no longer '{id}', whose default it is; give '{id}' another \
                         key, or [] for none"
                    ),
                );
                return;
            }
            if context == GLOBAL {
                document.complain(
                    span,
                    format!("{key} now runs '{taker}' in '{taken_in}'; elsewhere it still runs '{id}'"),
                );
            }
        }
        self.bind(id, context, key);
    }
}

/// Reads the table of keys. `camera.reset = "r"` without quotes is a table in a table and means the
/// same as with them.
fn collect(
    document: &mut TomlDocument<'_>,
    table: &[KeyRow],
    above: &str,
    keys: &DeTable<'_>,
    wishes: &mut Vec<Wish>,
) {
    for (name, span, value) in entries(keys) {
        let full = if above.is_empty() { name.to_owned() } else { format!("{above}.{name}") };
        if let DeValue::Table(inner) = value.get_ref() {
            collect(document, table, &full, inner, wishes);
            continue;
        }
        let Some(row) = table.iter().find(|(id, ..)| *id == full) else {
            document.unknown(&span, "command", &full, table.iter().map(|(id, ..)| *id));
            continue;
        };
        if wishes.iter().any(|wish| wish.row.0 == row.0) {
            document.complain(&span, format!("'{}' stands twice; keep one", row.0));
            continue;
        }
        let items: Vec<&Spanned<DeValue<'_>>> = match value.get_ref() {
            DeValue::Array(items) => items.iter().collect(),
            _ => vec![value],
        };
        let before = document.len();
        let keys: Vec<_> =
            items.iter().filter_map(|item| Some((key(document, row, item)?, item.span()))).collect();
        // Nothing but mistakes: the command keeps its defaults.
        if !keys.is_empty() || document.len() == before {
            wishes.push(Wish { row: *row, keys, span });
        }
    }
}

/// Reads a key's name.
fn key(
    document: &mut TomlDocument<'_>,
    &(id, _, defaults): &KeyRow,
    value: &Spanned<DeValue<'_>>,
) -> Option<Shortcut> {
    let Some(name) = value.get_ref().as_str() else {
        document.mismatch(id, value, "a key like \"ctrl-r\", or a list of keys");
        return None;
    };
    let key: Shortcut = match name.parse() {
        Ok(key) => key,
        Err(error) => {
            document.complain(&value.span(), error.to_string());
            return None;
        }
    };
    if let Some(sent) = key.sent_instead() {
        let message = format!(
            "no terminal sends '{}'; it sends '{sent}' when that is pressed, so write that",
            excerpt(name)
        );
        document.complain(&value.span(), message);
        return None;
    }
    if key == CANCEL && !has_cancel(defaults) {
        let message =
            format!("{CANCEL} always cancels and quits, so '{id}' cannot have it; choose another key");
        document.complain(&value.span(), message);
        return None;
    }
    Some(key)
}

/// Whether a command is one that [`CANCEL`] runs.
fn has_cancel(defaults: &[&str]) -> bool {
    defaults.iter().any(|name| name.parse() == Ok(CANCEL))
}

/// A `keymap.toml` with every command and its default keys, commented out.
pub fn example(table: &[KeyRow]) -> String {
    let mut text = format!(
        "# linden's keys. A line counts once its '#' is removed. A key, a list of keys, or [] for none.\n\
         # Keys are written like q, G, ?, space, enter, esc, tab, f1, up, pagedown, ctrl-r, alt-left, shift-tab.\n\
         # {CANCEL} always cancels and quits.\n\n[keys]\n"
    );
    let mut contexts: Vec<&str> = Vec::new();
    for (_, context, _) in table {
        if !contexts.contains(context) {
            contexts.push(context);
        }
    }
    for context in contexts {
        text += &format!("\n# {context}\n");
        for (id, place, keys) in table {
            if *place != context {
                continue;
            }
            let keys: Vec<String> = keys.iter().map(|key| quoted(key)).collect();
            let keys =
                if let [one] = keys.as_slice() { one.clone() } else { format!("[{}]", keys.join(", ")) };
            text += &format!("#{} = {keys}\n", quoted(id));
        }
    }
    text
}

/// A TOML string.
fn quoted(text: &str) -> String {
    toml::Value::String(text.to_owned()).to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    const TABLE: &[KeyRow] = &[
        ("quit", GLOBAL, &["q", "ctrl-c"]),
        ("help", GLOBAL, &["?", "f1"]),
        ("undo", "form", &["u"]),
        ("redo", "form", &["ctrl-r"]),
        ("reset", "form", &["r"]),
        ("camera.reset", "picture", &["r", "\\"]),
        ("seed", "picture", &[]),
    ];

    fn key(name: &str) -> Shortcut {
        name.parse().unwrap()
    }

    fn read(text: &str) -> (Keymap, Vec<Complaint>) {
        Keymap::read(Path::new("keymap.toml"), text, TABLE)
    }

    /// What a key runs where it is pressed: the context's command, else the global one.
    fn command(keymap: &Keymap, context: &str, key: Shortcut) -> Option<&'static str> {
        keymap.lookup(context, key).or_else(|| keymap.lookup(GLOBAL, key))
    }

    #[test]
    fn defaults_are_found_by_context_then_globally() {
        let keymap = Keymap::defaults(TABLE);
        assert_eq!(command(&keymap, "form", key("r")), Some("reset"));
        assert_eq!(command(&keymap, "picture", key("r")), Some("camera.reset"));
        assert_eq!(command(&keymap, "picture", key("q")), Some("quit"));
        assert_eq!(command(&keymap, GLOBAL, key("r")), None);
        assert_eq!(keymap.keys_of("help"), [key("?"), key("f1")]);
        assert_eq!(keymap.keys_of("nothing"), []);
        assert_eq!(read(""), (keymap, vec![]));
    }

    #[test]
    fn commands_are_bound_rebound_and_unbound() {
        let (keymap, complaints) =
            read("[keys]\nundo = [\"u\", \"ctrl-z\"]\nhelp = []\n\"camera.reset\" = \"0\"\nseed = \"n\"\n");
        assert_eq!(complaints, []);
        assert_eq!(keymap.keys_of("undo"), [key("u"), key("ctrl-z")]);
        assert_eq!(command(&keymap, "form", key("ctrl-z")), Some("undo"));
        assert_eq!(command(&keymap, "form", key("?")), None);
        assert_eq!(keymap.keys_of("camera.reset"), [key("0")]);
        assert_eq!(command(&keymap, "picture", key("r")), None);
        assert_eq!(command(&keymap, "picture", key("n")), Some("seed"));
        assert_eq!(read("[keys]\ncamera.reset = \"0\"").0.keys_of("camera.reset"), [key("0")]);
        let (keymap, complaints) = read("[keys]\n\"camera.reset\" = \"0\"\ncamera.reset = \"1\"");
        assert_eq!((keymap.keys_of("camera.reset"), complaints.len()), (&[key("0")][..], 1));
    }

    #[test]
    fn what_is_wrong_is_said_with_its_place_and_the_rest_counts() {
        let (keymap, complaints) =
            read("[keys]\nundoo = \"z\"\nredo = \"Ctrl-R\"\nhelp = 1\nreset = [\"ctrl-i\", \"x\"]\n[kys]\n");
        let places: Vec<_> = complaints.iter().map(|c| c.place.unwrap()).collect();
        assert_eq!(places, [(2, 1), (3, 8), (4, 8), (5, 10), (6, 2)]);
        assert!(complaints[0].message.contains("did you mean 'undo'"), "{}", complaints[0]);
        assert!(complaints[3].message.contains("'tab'"), "{}", complaints[3]);
        assert!(complaints[4].message.contains("did you mean 'keys'"), "{}", complaints[4]);
        let defaults = Keymap::defaults(TABLE);
        for id in ["undo", "redo", "help"] {
            assert_eq!(keymap.keys_of(id), defaults.keys_of(id), "{id}");
        }
        assert_eq!(keymap.keys_of("reset"), [key("x")]);
    }

    #[test]
    fn a_key_that_is_bound_twice_is_reported_with_both_names() {
        let both = |complaints: &[Complaint], names: [&str; 2]| {
            assert_eq!(complaints.len(), 1, "{complaints:?}");
            for name in names {
                assert!(complaints[0].message.contains(&format!("'{name}'")), "{}", complaints[0]);
            }
        };
        // Both in the file: the first one keeps it, the second one its other keys.
        let (keymap, complaints) = read("[keys]\nundo = \"x\"\nredo = [\"x\", \"y\"]");
        both(&complaints, ["undo", "redo"]);
        assert_eq!(command(&keymap, "form", key("x")), Some("undo"));
        assert_eq!(keymap.keys_of("redo"), [key("y")]);
        let (keymap, complaints) = read("[keys]\nundo = \"x\"\nredo = \"x\"");
        both(&complaints, ["undo", "redo"]);
        assert_eq!(keymap.keys_of("redo"), [key("ctrl-r")]);
        // The file takes a default away.
        let (keymap, complaints) = read("[keys]\nundo = \"r\"");
        both(&complaints, ["undo", "reset"]);
        assert_eq!(command(&keymap, "form", key("r")), Some("undo"));
        assert_eq!(keymap.keys_of("reset"), []);
        // A context's command hides a global one, there only.
        let (keymap, complaints) = read("[keys]\nundo = \"q\"");
        both(&complaints, ["undo", "quit"]);
        assert_eq!(command(&keymap, "form", key("q")), Some("undo"));
        assert_eq!(command(&keymap, "picture", key("q")), Some("quit"));
        // A global one of the user's goes before a context's default.
        let (keymap, complaints) = read("[keys]\nhelp = \"u\"");
        both(&complaints, ["help", "undo"]);
        assert_eq!(command(&keymap, "form", key("u")), Some("help"));
        // Both in the file, one of them global.
        let (keymap, complaints) = read("[keys]\nhelp = \"x\"\nundo = \"x\"");
        both(&complaints, ["help", "undo"]);
        assert_eq!(command(&keymap, "form", key("x")), Some("undo"));
        assert_eq!(command(&keymap, "picture", key("x")), Some("help"));
        // Freed in the same file: nothing to report. Other contexts are no conflict.
        assert_eq!(read("[keys]\nundo = \"r\"\nreset = []").1, []);
        assert_eq!(read("[keys]\nundo = \"x\"\nseed = \"x\"").1, []);
    }

    #[test]
    fn ctrl_c_cannot_be_taken_or_unbound() {
        for (text, said) in
            [("quit = []", 1), ("quit = \"x\"", 0), ("undo = \"ctrl-c\"", 1), ("quit = \"ctrl-c\"", 0)]
        {
            let (keymap, complaints) = read(&format!("[keys]\n{text}"));
            assert_eq!(complaints.len(), said, "{text}: {complaints:?}");
            assert!(complaints.iter().all(|c| c.message.contains("always cancels")), "{complaints:?}");
            assert_eq!(command(&keymap, "form", CANCEL), Some("quit"), "{text}");
        }
        assert_eq!(read("[keys]\nquit = []").0.keys_of("quit"), [CANCEL]);
        assert_eq!(read("[keys]\nundo = \"ctrl-c\"").0.keys_of("undo"), [key("u")]);
    }

    #[test]
    fn a_keymap_that_is_not_there_is_the_default_and_one_that_is_no_text_too() {
        let dir = tempfile::tempdir().unwrap();
        let file = dir.path().join("keymap.toml");
        for missing in [None, Some(file.as_path())] {
            assert_eq!(Keymap::load(missing, TABLE), (Keymap::defaults(TABLE), vec![]));
        }
        std::fs::write(&file, b"[keys]\nundo = \"\xff\"").unwrap();
        let (keymap, complaints) = Keymap::load(Some(&file), TABLE);
        assert_eq!(keymap, Keymap::defaults(TABLE));
        assert_eq!(complaints[0].place, Some((2, 9)));
    }

    #[test]
    fn the_example_is_commented_out_and_says_the_defaults() {
        let example = example(TABLE);
        assert_eq!(read(&example), (Keymap::defaults(TABLE), vec![]));
        let active = example.replace("\n#\"", "\n\"");
        assert_eq!(read(&active), (Keymap::defaults(TABLE), vec![]));
        assert!(TABLE.iter().all(|(id, ..)| active.contains(&format!("\n{} = ", quoted(id)))));
    }
}
