//! The table that a sweep writes: whole lines, one after the other, so that what is there is always a beginning of
//! what will be there.

use std::fmt::Write as _;
use std::fs::{File, OpenOptions};
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::Path;

use anyhow::{Context, bail};
use linden::report::{NUMBERS, Reading, Report};

use super::Item;
use crate::exit::{ReaderGone, usage};
use crate::paths::show;

/// How rows are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TableKind {
    /// Fields between commas (RFC 4180), a header first.
    Csv,
    /// A JSON object a line.
    JsonLines,
}

impl TableKind {
    /// By a file's ending.
    pub fn of(path: &Path) -> Option<Self> {
        match path.extension()?.to_str()?.to_ascii_lowercase().as_str() {
            "csv" => Some(Self::Csv),
            "jsonl" | "ndjson" => Some(Self::JsonLines),
            _ => None,
        }
    }

    /// The first line; none for JSON.
    pub fn header(self, keys: &[String], timings: bool) -> String {
        if self == Self::JsonLines {
            return String::new();
        }
        let numbers = NUMBERS.iter().map(|number| number.name.to_owned());
        let times = ["grow_s", "measure_s"].into_iter().filter(|_| timings).map(str::to_owned);
        let all =
            keys.iter().cloned().chain(numbers).chain(times).chain(["recipe".to_owned(), "error".to_owned()]);
        all.map(|name| quoted(&name)).collect::<Vec<_>>().join(",") + "\n"
    }

    /// How the line of an item begins: with what tells it from the others.
    pub fn beginning(self, keys: &[String], item: &Item) -> String {
        let values = item.keys();
        let mut line = String::new();
        match self {
            Self::Csv => values.for_each(|value| {
                let _ = write!(line, "{},", quoted(&value));
            }),
            Self::JsonLines => {
                line.push('{');
                for (key, value) in keys.iter().zip(values) {
                    let _ = write!(line, "{}:{},", json(key), number_or_text(&value));
                }
            }
        }
        line
    }

    /// A whole line. `times` are seconds.
    pub fn line(self, keys: &[String], item: &Item, row: &Row, times: Option<[f64; 2]>) -> String {
        let mut line = self.beginning(keys, item);
        for number in NUMBERS {
            let reading = row.measured.as_ref().map_or(Reading::Nothing, |report| (number.reading)(report));
            match self {
                Self::Csv => line += &(quoted(&reading.field()) + ","),
                Self::JsonLines => line += &format!("{}:{},", json(number.name), json(&reading)),
            }
        }
        for (name, seconds) in ["grow_s", "measure_s"].into_iter().zip(times.into_iter().flatten()) {
            match self {
                Self::Csv => line += &format!("{seconds:.4},"),
                Self::JsonLines => line += &format!("{}:{seconds:.4},", json(name)),
            }
        }
        line += &match (self, &row.measured) {
            (Self::Csv, Ok(_)) => format!("{},\n", quoted(&row.recipe)),
            (Self::Csv, Err(error)) => format!("{},{}\n", quoted(&row.recipe), quoted(error)),
            (Self::JsonLines, Ok(_)) => format!("\"recipe\":{},\"error\":null}}\n", row.recipe),
            (Self::JsonLines, Err(error)) => {
                format!("\"recipe\":{},\"error\":{}}}\n", row.recipe, json(error))
            }
        };
        line
    }

    /// Whether a line is of an item with this recipe, and whether it says that the item failed.
    fn is_of(self, keys: &[String], item: &Item, recipe: &str, line: &str) -> Option<bool> {
        let rest = line.strip_prefix(&self.beginning(keys, item))?;
        let recipe = match self {
            Self::Csv => format!(",{},", quoted(recipe)),
            Self::JsonLines => format!("\"recipe\":{recipe},\"error\":"),
        };
        // What is said of an error comes last.
        let error = &rest[rest.rfind(&recipe)? + recipe.len()..];
        Some(!matches!(error, "" | "null}"))
    }
}

/// What became of an item.
pub struct Row {
    /// The numbers, or what went wrong, in one line.
    pub measured: Result<Report, String>,
    /// Everything to grow it again.
    pub recipe: String,
}

/// A field as RFC 4180 has it.
fn quoted(field: &str) -> String {
    if field.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", field.replace('"', "\"\""))
    } else {
        field.to_owned()
    }
}

fn json(value: &(impl serde::Serialize + ?Sized)) -> String {
    // Numbers and texts have no way to fail.
    serde_json::to_string(value).unwrap_or_else(|_| "null".to_owned())
}

/// Decimal numbers as they are written, all else as text.
fn number_or_text(value: &str) -> String {
    let is_number = serde_json::from_str::<serde_json::Number>(value).is_ok();
    if is_number { value.to_owned() } else { json(value) }
}

/// Where the lines go.
pub enum Table {
    /// Standard output.
    Stdout,
    /// A file that was made or begun before.
    File(File, String),
}

/// What is done with a file that is there already.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Existing {
    /// It is left alone.
    Keep,
    /// Its rows stay, and what is missing follows.
    Resume,
    /// It begins anew.
    Replace,
}

/// A table, and how it stands.
pub struct Opened {
    /// Where further lines go.
    pub table: Table,
    /// How many items it has already.
    pub done: usize,
    /// How many of these failed.
    pub failed: usize,
}

impl Table {
    /// Opens a table, with its header.
    pub fn open(
        path: &Path,
        kind: TableKind,
        (keys, header): (&[String], &str),
        existing: Existing,
        items: impl Iterator<Item = (Item, String)>,
    ) -> anyhow::Result<Opened> {
        if super::super::placing::is_dash(path) {
            let mut table = Self::Stdout;
            table.write(header)?;
            return Ok(Opened { table, done: 0, failed: 0 });
        }
        let shown = show(path);
        let opening = || format!("opening {shown}");
        if path.metadata().is_ok_and(|about| !about.is_file()) {
            return Err(usage(format!(
                "{shown} is no regular file, which rows are added to; - is standard output"
            )));
        }
        let file = OpenOptions::new().read(true).write(true).create(true).truncate(false).open(path);
        let mut file = file.with_context(opening)?;
        let mut text = String::new();
        if existing == Existing::Replace {
            file.set_len(0).with_context(opening)?;
        } else {
            file.read_to_string(&mut text).with_context(|| format!("reading {shown}"))?;
        }
        if !text.is_empty() && existing == Existing::Keep {
            return Err(usage(format!(
                "{shown} is there already: --resume keeps its rows and adds what is missing, --overwrite begins anew"
            )));
        }
        // A line that was cut off is written again.
        let whole = text.rfind('\n').map_or(0, |end| end + 1);
        let mut lines = text[..whole].split_inclusive('\n');
        let is_new = whole == 0;
        if !is_new && !header.is_empty() && lines.next() != Some(header) {
            bail!("{shown} has other columns than this sweep: take another file, or --overwrite");
        }
        let (mut done, mut failed) = (0, 0);
        let mut items = items;
        for line in lines {
            let Some((item, recipe)) = items.next() else {
                bail!("{shown} has more rows than this sweep: take another file, or --overwrite");
            };
            let Some(has_failed) = kind.is_of(keys, &item, &recipe, line.trim_end_matches('\n')) else {
                bail!(
                    "row {} of {shown} is of another tree, or of another linden, than this sweep has there: take another file, or --overwrite",
                    done + 1
                );
            };
            done += 1;
            failed += usize::from(has_failed);
        }
        file.set_len(whole as u64).with_context(opening)?;
        file.seek(SeekFrom::End(0)).with_context(opening)?;
        let mut table = Self::File(file, shown);
        if is_new {
            table.write(header)?;
        }
        Ok(Opened { table, done, failed })
    }

    /// Appends whole lines.
    pub fn write(&mut self, lines: &str) -> anyhow::Result<()> {
        match self {
            Self::Stdout => {
                let mut out = io::stdout().lock();
                match out.write_all(lines.as_bytes()).and_then(|()| out.flush()) {
                    Err(error) if error.kind() == io::ErrorKind::BrokenPipe => Err(ReaderGone.into()),
                    done => done.context("writing to standard output"),
                }
            }
            Self::File(file, shown) => {
                file.write_all(lines.as_bytes()).with_context(|| format!("writing {shown}"))
            }
        }
    }

    /// Waits until all is on the disk.
    pub fn finish(self) -> anyhow::Result<()> {
        match self {
            Self::Stdout => Ok(()),
            Self::File(file, shown) => file.sync_all().with_context(|| format!("writing {shown}")),
        }
    }
}
