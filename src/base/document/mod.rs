//! Documents as trees of values with places: TOML as people write it, JSON as recipes carry it.

mod file_key;
mod list;

use std::collections::BTreeSet;
use std::fmt;

use serde::de::{self, Deserialize, Deserializer, MapAccess, SeqAccess, Visitor};

use crate::knob::{Kind, Value, excerpt};

pub use file_key::{FileKey, NamesFiles};
pub use list::List;

/// A place in a text, counted from 1; columns in characters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TextPlace {
    /// Line.
    pub line: usize,
    /// Character within the line.
    pub column: usize,
}

impl TextPlace {
    /// The place of a byte offset.
    pub fn at(text: &str, offset: usize) -> Self {
        let mut end = offset.min(text.len());
        while !text.is_char_boundary(end) {
            end -= 1;
        }
        let before = &text[..end];
        let start = before.rfind('\n').map_or(0, |newline| newline + 1);
        Self { line: before.matches('\n').count() + 1, column: before[start..].chars().count() + 1 }
    }

    /// The place of what follows a character that stands here.
    const fn behind(self, character: char) -> Self {
        match character {
            '\n' => Self { line: self.line + 1, column: 1 },
            _ => Self { column: self.column + 1, ..self },
        }
    }
}

/// The places of a text that is asked for many: each answer reads [`Places::STRIDE`] bytes at most,
/// where [`TextPlace::at`] reads all that stands before.
struct Places<'a> {
    text: &'a str,
    /// The place of the first character at or behind each multiple of the stride, and its offset.
    marks: Vec<(usize, TextPlace)>,
}

impl<'a> Places<'a> {
    const STRIDE: usize = 256;

    fn of(text: &'a str) -> Self {
        let mut marks = Vec::with_capacity(text.len() / Self::STRIDE + 1);
        let mut place = TextPlace { line: 1, column: 1 };
        for (offset, character) in text.char_indices() {
            if offset >= marks.len() * Self::STRIDE {
                marks.push((offset, place));
            }
            place = place.behind(character);
        }
        Self { text, marks }
    }

    /// The place of a byte offset.
    fn at(&self, offset: usize) -> TextPlace {
        let mark = self.marks.partition_point(|(start, _)| *start <= offset).checked_sub(1);
        let (start, place) = mark.map_or((0, TextPlace { line: 1, column: 1 }), |mark| self.marks[mark]);
        let before = self.text[start..].char_indices().take_while(|(at, _)| start + at < offset);
        before.fold(place, |place, (_, character)| place.behind(character))
    }
}

impl fmt::Display for TextPlace {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}", self.line, self.column)
    }
}

/// What is wrong with a document and where.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}{message}", Before(.place))]
pub struct Fault {
    /// `None` where the text has no lines to speak of (JSON) or the fault is something missing.
    pub place: Option<TextPlace>,
    /// What was found and what was expected.
    pub message: String,
}

/// The place before the message, if there is one.
struct Before<'a>(&'a Option<TextPlace>);

impl fmt::Display for Before<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.map_or(Ok(()), |place| write!(f, "{place}: "))
    }
}

impl Fault {
    /// A fault at a place, where there is one to speak of.
    pub fn new(place: Option<TextPlace>, message: impl Into<String>) -> Self {
        Self { place, message: message.into() }
    }
}

/// A value and where it stands.
#[derive(Clone, Debug)]
pub struct Node {
    /// Where it stands; `None` in JSON.
    pub place: Option<TextPlace>,
    /// What it is.
    pub datum: Datum,
}

/// What stands at a place.
#[derive(Clone, Debug)]
pub enum Datum {
    /// Text in quotes.
    Text(String),
    /// A number with a fraction, or below 0.
    Real(f64),
    /// A whole number.
    Integer(u64),
    /// `true` or `false`.
    Switch(bool),
    /// `[a, b]`.
    List(Vec<Node>),
    /// A table: entries with keys.
    Table(Vec<Entry>),
}

/// A key with its value.
#[derive(Clone, Debug)]
pub struct Entry {
    /// Its key.
    pub key: String,
    /// Where the key stands.
    pub place: Option<TextPlace>,
    /// Its value.
    pub node: Node,
}

/// A table of a document.
#[derive(Clone, Copy, Debug)]
pub struct Table<'a> {
    /// What stands in it.
    pub entries: &'a [Entry],
    /// Where it stands.
    pub place: Option<TextPlace>,
    /// The document's text, where it has lines to speak of.
    pub text: Option<&'a str>,
}

impl<'a> Table<'a> {
    /// The entry of a key.
    pub fn find(&self, key: &str) -> Option<&'a Entry> {
        self.entries.iter().find(|entry| entry.key == key)
    }

    /// The text of a key, `None` without such a key.
    ///
    /// # Errors
    /// [`Fault`]: something else than text.
    pub fn text(&self, key: &str) -> Result<Option<&'a str>, Fault> {
        self.find(key).map(|entry| entry.node.text(key)).transpose()
    }

    /// The place of the `column`-th character, from 1, of the text that stands at `node`. Strings over several
    /// lines are pointed at as a whole.
    pub fn inside(&self, node: &Node, column: usize) -> Option<TextPlace> {
        match (node.place, self.text) {
            (Some(start), Some(text)) => Some(inside(text, start, column)),
            (place, _) => place,
        }
    }
}

/// The place of a string's `column`-th character, where the string's opening quote is at `start`.
fn inside(text: &str, start: TextPlace, column: usize) -> TextPlace {
    let line = text.lines().nth(start.line - 1).unwrap_or_default();
    let mut raw = line.chars().skip(start.column - 1);
    let quote = raw.next().unwrap_or('"');
    let rest: Vec<char> = raw.collect();
    if rest.starts_with(&[quote, quote]) {
        return start;
    }
    let mut at = 0;
    for _ in 1..column {
        // An escape is several characters of the file and one of the string.
        at += match (quote, rest.get(at), rest.get(at + 1)) {
            ('"', Some('\\'), Some('u')) => 6,
            ('"', Some('\\'), Some('U')) => 10,
            ('"', Some('\\'), _) => 2,
            _ => 1,
        };
    }
    TextPlace { line: start.line, column: start.column + 1 + at }
}

impl Node {
    /// Reads TOML.
    ///
    /// # Errors
    /// [`Fault`]: where it is no TOML.
    pub fn from_toml(text: &str) -> Result<Self, Fault> {
        let table = toml::de::DeTable::parse(text).map_err(|error| {
            let place = error.span().map(|span| TextPlace::at(text, span.start));
            let message = error.message().trim().replace('\n', ", ");
            let hint = if message.contains("escape") { ESCAPE_HINT } else { "" };
            Fault::new(place, message + hint)
        })?;
        let place = Some(TextPlace { line: 1, column: 1 });
        Ok(Self { place, datum: Datum::Table(toml_entries(&Places::of(text), table.get_ref())?) })
    }

    /// Reads JSON.
    ///
    /// # Errors
    /// [`Fault`]: where it is no JSON, or a key stands twice.
    pub fn from_json(text: &str) -> Result<Self, Fault> {
        serde_json::from_str(text).map_err(|error| {
            let place = TextPlace { line: error.line(), column: error.column() };
            // The place stands before the message already.
            let message = error.to_string();
            let message = message.rsplit_once(" at line ").map_or(message.as_str(), |(message, _)| message);
            Fault::new(Some(place), message)
        })
    }

    /// What it is, for messages: `a number`.
    pub fn kind(&self) -> &'static str {
        match self.datum {
            Datum::Text(_) => "text",
            Datum::Real(_) | Datum::Integer(_) => "a number",
            Datum::Switch(_) => "true or false",
            Datum::List(_) => "a list",
            Datum::Table(_) => "a table",
        }
    }

    /// The text that the key `name` has.
    ///
    /// # Errors
    /// [`Fault`]: something else.
    pub fn text(&self, name: &str) -> Result<&str, Fault> {
        match &self.datum {
            Datum::Text(text) => Ok(text),
            _ => Err(self.mismatch(name, "text in quotes")),
        }
    }

    fn number(&self) -> Option<f64> {
        match self.datum {
            Datum::Real(x) => Some(x),
            Datum::Integer(n) => Some(n as f64),
            _ => None,
        }
    }

    /// The fault that the key `name` has something else than what was `expected`.
    pub fn mismatch(&self, name: &str, expected: &str) -> Fault {
        Fault::new(self.place, format!("'{}' is {}, expected {expected}", excerpt(name), self.kind()))
    }

    /// The node as a value of a knob. Text is read as the command line reads it.
    ///
    /// # Errors
    /// [`Fault`]: a value that the knob does not take.
    pub fn value(&self, name: &str, kind: &Kind) -> Result<Value, Fault> {
        let fault = |message: String| Fault::new(self.place, format!("knob '{name}': {message}"));
        let value = match (&self.datum, kind) {
            (Datum::Text(text), _) => return kind.parse(text).map_err(fault),
            // 1e6 is a whole number, whatever TOML and JSON call it.
            (Datum::Real(x), Kind::Integer { .. }) => return kind.parse(&x.to_string()).map_err(fault),
            // One number is a list of one.
            (Datum::Real(x), Kind::Reals { .. }) => Value::Reals(vec![*x]),
            (Datum::Integer(n), Kind::Reals { .. }) => Value::Reals(vec![*n as f64]),
            (Datum::Real(x), _) => Value::Real(*x),
            (Datum::Integer(n), Kind::Integer { .. }) => Value::Integer(*n),
            (Datum::Integer(n), _) => Value::Real(*n as f64),
            (Datum::Switch(on), _) => Value::Switch(*on),
            (Datum::List(items), Kind::Vector { .. }) => {
                Value::Vector(numbers(items).ok_or_else(|| self.mismatch(name, "three numbers [x, y, z]"))?)
            }
            (Datum::List(items), Kind::Profile { .. }) => {
                let pair = |item: &Self| match &item.datum {
                    Datum::List(pair) => numbers(pair),
                    _ => None,
                };
                let pairs = items.iter().map(pair).collect::<Option<_>>();
                Value::Profile(pairs.ok_or_else(|| self.mismatch(name, "pairs [[height, radius], …]"))?)
            }
            (Datum::List(items), Kind::Reals { .. }) => {
                let numbers = items.iter().map(Self::number).collect::<Option<_>>();
                Value::Reals(numbers.ok_or_else(|| self.mismatch(name, "numbers [x, y, …]"))?)
            }
            (Datum::List(items), Kind::Words(_) | Kind::Sequence { .. } | Kind::Colors { .. }) => {
                let words = items.iter().map(|item| item.text(name)).collect::<Result<Vec<_>, _>>()?;
                let listed = if words.is_empty() { "none".to_owned() } else { words.join(" ") };
                return kind.parse(&listed).map_err(fault);
            }
            (Datum::List(_) | Datum::Table(_), _) => return Err(self.mismatch(name, &kind.to_string())),
        };
        kind.check(&value).map_err(fault)?;
        Ok(value)
    }
}

/// Exactly `N` numbers.
fn numbers<const N: usize>(items: &[Node]) -> Option<[f64; N]> {
    items.iter().map(Node::number).collect::<Option<Vec<f64>>>()?.try_into().ok()
}

fn toml_entries(places: &Places<'_>, table: &toml::de::DeTable<'_>) -> Result<Vec<Entry>, Fault> {
    let mut entries = Vec::new();
    for (key, value) in table {
        let place = Some(places.at(key.span().start));
        entries.push(Entry { key: key.get_ref().to_string(), place, node: toml_node(places, value)? });
    }
    Ok(entries)
}

fn toml_node(places: &Places<'_>, value: &toml::Spanned<toml::de::DeValue<'_>>) -> Result<Node, Fault> {
    use toml::de::DeValue;
    let place = Some(places.at(value.span().start));
    let not_read = |what: &str| Fault::new(place, format!("{what} cannot be read as a number"));
    let datum = match value.get_ref() {
        DeValue::String(text) => Datum::Text(text.to_string()),
        DeValue::Integer(n) => match u64::from_str_radix(n.as_str(), n.radix()) {
            Ok(n) => Datum::Integer(n),
            // Negative numbers are no counts; as lengths and angles they are.
            Err(_) => Datum::Real(n.as_str().parse().map_err(|_| not_read(&excerpt(n.as_str())))?),
        },
        DeValue::Float(x) => Datum::Real(x.as_str().parse().map_err(|_| not_read(&excerpt(x.as_str())))?),
        DeValue::Boolean(on) => Datum::Switch(*on),
        DeValue::Datetime(_) => return Err(Fault::new(place, "a date, where no knob takes one")),
        DeValue::Array(items) => {
            Datum::List(items.iter().map(|item| toml_node(places, item)).collect::<Result<_, _>>()?)
        }
        DeValue::Table(table) => Datum::Table(toml_entries(places, table)?),
    };
    Ok(Node { place, datum })
}

impl<'de> Deserialize<'de> for Node {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let datum = deserializer.deserialize_any(JsonDatum)?;
        Ok(Self { place: None, datum })
    }
}

/// Makes data of JSON. Unlike a map, it notices a key that stands twice.
struct JsonDatum;

impl<'de> Visitor<'de> for JsonDatum {
    type Value = Datum;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("text, a number, true, false, a list or an object")
    }

    fn visit_str<E>(self, text: &str) -> Result<Datum, E> {
        Ok(Datum::Text(text.to_owned()))
    }

    fn visit_bool<E>(self, on: bool) -> Result<Datum, E> {
        Ok(Datum::Switch(on))
    }

    fn visit_u64<E>(self, n: u64) -> Result<Datum, E> {
        Ok(Datum::Integer(n))
    }

    fn visit_i64<E>(self, n: i64) -> Result<Datum, E> {
        Ok(Datum::Real(n as f64))
    }

    fn visit_f64<E>(self, x: f64) -> Result<Datum, E> {
        Ok(Datum::Real(x))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut items: A) -> Result<Datum, A::Error> {
        let mut list = Vec::new();
        while let Some(item) = items.next_element()? {
            list.push(item);
        }
        Ok(Datum::List(list))
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Datum, A::Error> {
        let mut seen = BTreeSet::new();
        let mut entries = Vec::new();
        while let Some((key, node)) = map.next_entry::<String, Node>()? {
            if !seen.insert(key.clone()) {
                return Err(de::Error::custom(format!("'{}' stands twice; keep one", excerpt(&key))));
            }
            entries.push(Entry { key, place: None, node });
        }
        Ok(Datum::Table(entries))
    }
}

/// What to do about a `\` in a text of TOML that is no escape.
const ESCAPE_HINT: &str = "; in a text in \"…\" a '\\' is written twice, in one in '…' as it is";

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_backslash_that_is_no_escape_is_told_how_to_be_written() {
        let said = |toml: &str| Node::from_toml(toml).map(drop).map_err(|fault| fault.to_string());
        let error = said("rule = \"F -> \\F\"").unwrap_err();
        assert!(error.ends_with(ESCAPE_HINT), "{error}");
        assert!(!said("rule = F").unwrap_err().contains(ESCAPE_HINT));
        assert_eq!(said("a = \"F -> \\\\F\"\nb = 'F -> \\F'"), Ok(()));
    }

    #[test]
    fn many_places_are_those_of_one_at_a_time() {
        let long = "x = [1, é, 𝄞]\r\n".repeat(40) + &"1,é".repeat(700) + "\n\n" + &"a\n".repeat(300);
        for text in ["", "a", "\n", &long] {
            let places = Places::of(text);
            for offset in (0..=text.len()).filter(|offset| text.is_char_boundary(*offset)) {
                assert_eq!(places.at(offset), TextPlace::at(text, offset), "{offset}");
            }
        }
    }

    #[test]
    fn the_time_to_read_grows_with_the_text_not_with_its_square() {
        // With every value's place counted from the beginning this takes hours.
        let list = format!("x = [{}]", "1,".repeat(2_000_000));
        let Datum::Table(entries) = Node::from_toml(&list).unwrap().datum else { panic!("a table") };
        let Datum::List(items) = &entries[0].node.datum else { panic!("a list") };
        assert_eq!(items.last().unwrap().place, Some(TextPlace { line: 1, column: 4_000_004 }));
    }
}
