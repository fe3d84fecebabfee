//! A generator's table in a document, but for its knobs.

use linden_base::knob::{Knob, Value};

/// A key of a generator's table that is no knob.
#[derive(Clone, Copy)]
pub struct TableKey {
    /// The key.
    pub name: &'static str,
    /// One line of help.
    pub help: &'static str,
    /// The type of its value.
    pub content: KeyContent,
}

/// The type of a value in a generator's table.
#[derive(Clone, Copy)]
pub enum KeyContent {
    /// Text.
    Text,
    /// A list of texts.
    Texts,
    /// The name of a file, relative to the document.
    File,
    /// A list of tables.
    Tables(Tables),
}

/// A list of tables in a document, as a schema describes it.
#[derive(Clone, Copy)]
pub struct Tables {
    /// The knobs that each may have.
    pub knobs: fn() -> Vec<Knob>,
    /// Keys that each must have.
    pub required: &'static [&'static str],
    /// Keys of which each must have exactly one, if there are any.
    pub one_of: &'static [&'static str],
    /// Keys that name files, with a line of help.
    pub files: &'static [(&'static str, &'static str)],
    /// The most tables.
    pub most: usize,
}

/// An entry of a table that is no knob.
#[derive(Clone, Debug, PartialEq)]
pub enum Written {
    /// Text, or a file's name.
    Text(String),
    /// A list of texts.
    Texts(Vec<String>),
    /// A list of tables: names and values.
    Tables(Vec<Vec<(&'static str, Value)>>),
}

/// Lines of a page under a heading. Text of a document's is in them as it is: a terminal needs it made
/// printable.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Passage {
    /// In lower case.
    pub heading: &'static str,
    /// Without indents but those that tell lines from lines of theirs.
    pub lines: Vec<String>,
}
