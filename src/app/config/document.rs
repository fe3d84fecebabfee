//! A TOML file of the user's, read as far as it goes: what is wrong is complained about, the rest
//! stays in force.

use std::ops::Range;
use std::path::Path;

use linden::knob::{did_you_mean, excerpt, nearest};
use linden::preset::TextPlace;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::{Complaint, files};

/// No settings, theme or keymap of a person is larger.
const MAX_BYTES: u64 = 1 << 20;
/// Complaints about one file that are said; more say nothing new.
const MAX_COMPLAINTS: usize = 20;

/// Collects what is wrong with a text.
#[derive(Debug)]
pub struct TomlDocument<'t> {
    file: &'t Path,
    text: &'t str,
    complaints: Vec<Complaint>,
    unsaid: usize,
}

/// A key, where it stands, and its value.
pub type TomlEntry<'d, 't> = (&'d str, Range<usize>, &'d Spanned<DeValue<'t>>);

/// The text of a file, empty when there is none.
pub fn text_of(file: &Path) -> Result<String, Complaint> {
    Ok(files::read_text(file, MAX_BYTES)?.unwrap_or_default())
}

impl<'t> TomlDocument<'t> {
    /// Reads TOML. Lines that are none are complained about and left out.
    pub fn parse(file: &'t Path, text: &'t str) -> (Self, DeTable<'t>) {
        let mut document = Self { file, text, complaints: Vec::new(), unsaid: 0 };
        let (table, errors) = DeTable::parse_recoverable(text);
        let mut last_line = None;
        for error in errors {
            let span = error.span().unwrap_or_default();
            // The parser stumbles on over the rest of a line; its first fault says what is wrong.
            let before = &text.as_bytes()[..span.start.min(text.len())];
            let line_start = before.iter().rposition(|&byte| byte == b'\n');
            if last_line.replace(line_start) != Some(line_start) {
                document.complain(&span, error.message().trim().replace('\n', ", "));
            }
        }
        (document, table.into_inner())
    }

    /// Notes what is wrong at a range of bytes.
    pub fn complain(&mut self, span: &Range<usize>, message: impl AsRef<str>) {
        if self.complaints.len() < MAX_COMPLAINTS {
            let place = TextPlace::at(self.text, span.start);
            self.complaints.push(Complaint::at(self.file, Some(place), message));
        } else {
            self.unsaid += 1;
        }
    }

    /// Notes a key that is none, with the one that may have been meant.
    pub fn unknown<'n>(
        &mut self,
        span: &Range<usize>,
        what: &str,
        key: &str,
        names: impl IntoIterator<Item = &'n str>,
    ) {
        if self.complaints.len() >= MAX_COMPLAINTS {
            // It will not be read: no need to look for what was meant.
            self.unsaid += 1;
            return;
        }
        let names: Vec<&str> = names.into_iter().collect();
        let shown = excerpt(key);
        let hint = match nearest(key, names.iter().copied()) {
            None => format!("; expected one of: {}", names.join(", ")),
            found => did_you_mean(found),
        };
        self.complain(span, format!("there is no {what} '{shown}'{hint}"));
    }

    /// Notes a value of the wrong kind.
    pub fn mismatch(&mut self, key: &str, value: &Spanned<DeValue<'_>>, expected: &str) {
        let kind = match value.get_ref() {
            DeValue::String(_) => "text",
            DeValue::Integer(_) | DeValue::Float(_) => "a number",
            DeValue::Boolean(_) => "true or false",
            DeValue::Datetime(_) => "a date",
            DeValue::Array(_) => "a list",
            DeValue::Table(_) => "a table",
        };
        self.complain(&value.span(), format!("'{}' is {kind}, expected {expected}", excerpt(key)));
    }

    /// A table that may be missing; `None` also where something else stands in its place.
    pub fn table<'d>(&mut self, key: &str, value: &'d Spanned<DeValue<'t>>) -> Option<&'d DeTable<'t>> {
        let table = value.get_ref().as_table();
        if table.is_none() {
            self.mismatch(key, value, &format!("a table [{key}]"));
        }
        table
    }

    /// How much is wrong so far.
    pub fn len(&self) -> usize {
        self.complaints.len() + self.unsaid
    }

    /// All that was wrong.
    pub fn finish(mut self) -> Vec<Complaint> {
        if self.unsaid > 0 {
            let more = format!("and {} more of this kind", self.unsaid);
            self.complaints.push(Complaint::new(self.file, more));
        }
        self.complaints
    }
}

/// A table's entries in the order of the file; the table itself has them by name.
pub fn entries<'d, 't>(table: &'d DeTable<'t>) -> Vec<TomlEntry<'d, 't>> {
    let mut entries: Vec<TomlEntry<'d, 't>> =
        table.iter().map(|(key, value)| (key.get_ref().as_ref(), key.span(), value)).collect();
    entries.sort_by_key(|(_, span, _)| span.start);
    entries
}

/// A text, number or switch as a command line would have it; `None` for anything else.
pub fn scalar(value: &DeValue<'_>) -> Option<String> {
    match value {
        DeValue::String(text) => Some(text.to_string()),
        DeValue::Integer(n) if n.radix() == 10 => Some(n.as_str().to_owned()),
        DeValue::Float(x) => Some(x.as_str().to_owned()),
        DeValue::Boolean(on) => Some(on.to_string()),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_that_are_no_toml_cost_only_themselves() {
        let text = "a = 1\nb = = 2\n\nc = 3\na = 4\n";
        let (document, table) = TomlDocument::parse(Path::new("x.toml"), text);
        let names: Vec<&str> = entries(&table).iter().map(|(key, ..)| *key).collect();
        assert!(names.contains(&"a") && names.contains(&"c"), "{names:?}");
        assert_eq!(scalar(table["a"].get_ref()).as_deref(), Some("1"));
        let places: Vec<_> = document.finish().iter().map(|c| c.place.unwrap().0).collect();
        assert_eq!(places, [2, 5]);
    }

    #[test]
    fn a_file_full_of_mistakes_is_summed_up() {
        let text: Vec<String> = (0..50_000).map(|i| format!("k{i} = [")).collect();
        let text = text.join("\n");
        let (document, _) = TomlDocument::parse(Path::new("x.toml"), &text);
        let complaints = document.finish();
        assert!((1..=MAX_COMPLAINTS + 1).contains(&complaints.len()));
    }
}
