//! A table of measured trees.

use std::path::Path;

use anyhow::Context;
use csv::{Reader, ReaderBuilder, Trim};
use linden::Monitor;
use linden::knob::{excerpt, printable};
use linden::memory::bytes_of;
use linden::report::{Group, NUMBERS, Number, Sample};

use super::no_columns;
use crate::exit::usage;
use crate::paths::show;
use crate::progress::Progress;
use crate::{reading, source};

/// Units of lengths, in metres. The international foot and inch.
const LENGTHS: [(&str, f64); 5] =
    [("_m", 1.0), ("_cm", 0.01), ("_mm", 0.001), ("_ft", 0.3048), ("_in", 0.0254)];

/// What parts the columns of a table. Commas may be decimal where columns are parted by another sign; a table of one column
/// counts as such a one.
const SEPARATORS: [u8; 3] = [b';', b'\t', b','];

/// What no tree has, in metres, and the units that such a value is likely in, the likeliest first. The tallest living tree
/// is 116 m high (Hyperion), the thickest 11.6 m at breast height (Árbol del Tule).
const LIMITS: [(&str, f64, &[&str]); 3] = [
    ("height_m", 150.0, &["_ft", "_cm", "_mm"]),
    ("dbh_m", 20.0, &["_cm", "_mm"]),
    ("trunk_diameter_m", 20.0, &["_cm", "_mm"]),
];

/// What was measured.
pub struct Measured {
    /// Lines of the table.
    pub trees: usize,
    /// The numbers that it has, in its order; each has a value at least.
    pub columns: Vec<(&'static Number, Sample)>,
    /// Headings of what is no number.
    pub left_out: Vec<String>,
    /// What the user should know: what is missing, and what may be in another unit.
    pub notes: Vec<String>,
}

/// A column that is compared.
struct Column {
    at: usize,
    /// As the table has it, printable.
    title: String,
    number: &'static Number,
    /// Metres of its unit.
    scale: f64,
    values: Vec<f64>,
    /// Cells that say that nothing was measured.
    missing: usize,
    /// The first cell that is no number.
    fault: Option<Fault>,
    beyond: Option<Beyond>,
    /// Of the line that was read last, metres.
    latest_m: Option<f64>,
}

/// A cell that is no number.
struct Fault {
    /// Where it is, and what was expected.
    said: String,
    /// Whether it would be a number if commas were decimal.
    is_decimal_comma: bool,
}

/// Values that no tree has.
struct Beyond {
    count: usize,
    /// Of the first of them.
    line: u64,
    /// As the table has it.
    cell: f64,
}

/// Trees that are thicker for their height than any but a baobab: likely a column in another unit.
#[derive(Default)]
struct Stout {
    count: usize,
    /// Line, title of the diameter, diameter and height of the first, metres.
    first: Option<(u64, String, f64, f64)>,
}

impl Stout {
    /// Height by diameter below which a tree is told.
    const LEAST_SLENDER: f64 = 5.0;

    /// Looks at the line that was read last.
    fn take(&mut self, columns: &[Column], line: u64) {
        let of = |name: &str| columns.iter().find(|column| column.number.name == name);
        let (Some(height), Some(dbh)) = (of("height_m"), of("dbh_m")) else { return };
        if let (Some(height_m), Some(dbh_m)) = (height.latest_m, dbh.latest_m)
            && dbh_m * Self::LEAST_SLENDER > height_m
        {
            self.count += 1;
            self.first.get_or_insert((line, dbh.title.clone(), dbh_m, height_m));
        }
    }

    fn note(&self, shown: &str, trees: usize) -> Option<String> {
        let (line, title, dbh_m, height_m) = self.first.as_ref()?;
        Some(format!(
            "{shown}: {title} is more than a fifth of the height for {} of {trees} trees (line {line}: {dbh_m} m of \
             {height_m} m), which few trees are; if the column is in cm, name it dbh_cm",
            self.count
        ))
    }
}

/// A table as text.
struct Sheet<'a> {
    shown: &'a str,
    text: &'a str,
    separator: u8,
}

impl Measured {
    pub fn read(path: &Path, progress: &Progress) -> anyhow::Result<Self> {
        let shown = show(path);
        let read = || reading::open(path, progress)?.bytes(progress);
        let bytes = read().with_context(|| format!("reading {shown}"))?;
        let text = source::utf8(&bytes, &shown)?.trim_start_matches('\u{feff}');
        let sheet = Sheet { shown: &shown, text, separator: separator(text) };
        let (mut columns, mut left_out) = sheet.columns()?;
        let cells = text.lines().count().saturating_mul(columns.len());
        progress.admit("reading measured trees", bytes_of::<f64>(cells), "divide the table")?;
        let mut stout = Stout::default();
        let trees = sheet.fill(&mut columns, &mut stout, progress)?;
        if trees == 0 {
            return Err(usage(format!("{shown} has no measured tree: a line for each below the header")));
        }
        let mut notes = missing_note(&shown, &columns, trees).into_iter().collect::<Vec<String>>();
        notes.extend(columns.iter().filter_map(|column| column.beyond_note(&shown, trees)));
        notes.extend(
            stout.note(&shown, trees).filter(|_| columns.iter().all(|column| column.beyond.is_none())),
        );
        let (mut sampled, mut faults) = (Vec::new(), Vec::new());
        for Column { title, number, values, fault, .. } in columns {
            match (Sample::of(values), fault) {
                (Some(sample), None) => sampled.push((number, sample)),
                (None, None) => left_out.push(title),
                // Words and lists all the way down, as 'linden sweep' writes some.
                (None, Some(Fault { said, is_decimal_comma: false })) => {
                    left_out.push(title);
                    faults.push(said);
                }
                (_, Some(fault)) => return Err(usage(fault.said)),
            }
        }
        if sampled.is_empty() {
            let nothing =
                || format!("{shown}: none of its {trees} trees has a number in {}", left_out.join(", "));
            return Err(usage(faults.into_iter().next().unwrap_or_else(nothing)));
        }
        Ok(Self { trees, columns: sampled, left_out, notes })
    }
}

impl Sheet<'_> {
    fn error(&self, error: &csv::Error) -> anyhow::Error {
        usage(format!("{}: {}", self.shown, printable(&error.to_string())))
    }

    /// The columns that are compared, still empty, and the headings of the others.
    fn columns(&self) -> anyhow::Result<(Vec<Column>, Vec<String>)> {
        let mut reader = reader(self.text, self.separator);
        let header = reader.headers().map_err(|error| self.error(&error))?;
        let (mut columns, mut left_out) = (Vec::<Column>::new(), Vec::new());
        for (at, title) in header.iter().enumerate() {
            let Some((number, scale)) = meant(title) else {
                left_out.push(excerpt(title));
                continue;
            };
            if columns.iter().any(|other| other.number.name == number.name) {
                return Err(usage(format!("{}: two columns are {}; keep one", self.shown, number.name)));
            }
            columns.push(Column::new(at, title, number, scale));
        }
        if columns.is_empty() {
            return Err(no_columns(self.shown));
        }
        Ok((columns, left_out))
    }

    /// Reads the trees; how many there are.
    fn fill(&self, columns: &mut [Column], stout: &mut Stout, progress: &Progress) -> anyhow::Result<usize> {
        let mut reader = reader(self.text, self.separator);
        let titles = reader.headers().map_err(|error| self.error(&error))?.len();
        let mut trees = 0;
        for record in reader.records() {
            progress.check()?;
            let record = record.map_err(|error| self.error(&error))?;
            // Spreadsheets end in rows and columns of nothing.
            if record.iter().all(str::is_empty) {
                continue;
            }
            let line = record.position().map_or(0, csv::Position::line);
            if record.len() < titles || record.iter().skip(titles).any(|cell| !cell.is_empty()) {
                return Err(usage(self.other_length(line, record.len(), titles)));
            }
            trees += 1;
            for column in &mut *columns {
                column.take(record.get(column.at).unwrap_or_default(), line, self)?;
            }
            stout.take(columns, line);
        }
        Ok(trees)
    }

    /// What is said of a line that has more or fewer fields than the header.
    fn other_length(&self, line: u64, fields: usize, titles: usize) -> String {
        let s = if fields == 1 { "" } else { "s" };
        let hint = if fields > titles && self.separator == b',' { DECIMAL_COMMAS } else { "" };
        format!("{}:{line} has {fields} field{s}, the header has {titles}{hint}", self.shown)
    }
}

/// An end for messages about tables with commas between columns.
const DECIMAL_COMMAS: &str = ": decimal commas are read where ';' or tabs stand between columns";

impl Column {
    fn new(at: usize, title: &str, number: &'static Number, scale: f64) -> Self {
        let title = excerpt(title);
        Self {
            at,
            title,
            number,
            scale,
            values: Vec::new(),
            missing: 0,
            fault: None,
            beyond: None,
            latest_m: None,
        }
    }

    /// Takes the cell of a line.
    fn take(&mut self, cell: &str, line: u64, sheet: &Sheet<'_>) -> anyhow::Result<()> {
        self.latest_m = None;
        // What was not measured of a tree.
        if cell.is_empty() || ["na", "nan", "-"].contains(&cell.to_ascii_lowercase().as_str()) {
            self.missing += 1;
            return Ok(());
        }
        let plain = number(cell);
        let with_point = || number(&cell.replacen(',', ".", 1));
        let value = if sheet.separator == b',' { plain } else { plain.or_else(with_point) };
        let Some(value) = value else {
            if self.fault.is_none() {
                let is_decimal_comma = with_point().is_some();
                let hint = if is_decimal_comma { DECIMAL_COMMAS } else { "" };
                let expected = format!("expected a number like 12.5, or nothing{hint}");
                let (shown, title, cell) = (sheet.shown, &self.title, excerpt(cell));
                let said = format!("{shown}:{line}: {title} is '{cell}', {expected}");
                self.fault = Some(Fault { said, is_decimal_comma });
            }
            return Ok(());
        };
        if let Some(least) = self.refused(value) {
            let (shown, title, cell) = (sheet.shown, &self.title, excerpt(cell));
            return Err(usage(format!(
                "{shown}:{line}: {title} is {cell}, which is {least}; correct it, or leave it empty where nothing was measured"
            )));
        }
        if self.limit().is_some_and(|(limit, _)| value * self.scale > limit) {
            self.beyond.get_or_insert(Beyond { count: 0, line, cell: value }).count += 1;
        }
        self.values.push(value * self.scale);
        self.latest_m = Some(value * self.scale);
        Ok(())
    }

    /// Why a number can be no size of a tree.
    fn refused(&self, value: f64) -> Option<&'static str> {
        let is_size =
            matches!(self.number.group, Group::Size | Group::Stem | Group::Crown) && self.number.unit == "m";
        if is_size && value < 0.0 {
            return Some("below 0");
        }
        (self.limit().is_some() && value == 0.0).then_some("no size of a tree")
    }

    /// What no tree has, in metres, and the units that such a value is likely in.
    fn limit(&self) -> Option<(f64, &'static [&'static str])> {
        let row = LIMITS.iter().find(|(name, ..)| *name == self.number.name)?;
        Some((row.1, row.2))
    }

    /// What is said of values that no tree has.
    fn beyond_note(&self, shown: &str, trees: usize) -> Option<String> {
        let (Beyond { count, line, cell }, (limit, units)) = (self.beyond.as_ref()?, self.limit()?);
        let metres_of = |unit: &str| LENGTHS.iter().find(|row| row.0 == unit).map(|row| row.1);
        let likely = units.iter().find(|unit| metres_of(unit).is_some_and(|metres| cell * metres <= limit));
        let guess = likely.map_or_else(String::new, |unit| {
            let (name, short) = (self.number.name.trim_end_matches("_m"), unit.trim_start_matches('_'));
            format!("; if the column is in {short}, name it {name}{unit}")
        });
        Some(format!(
            "{shown}: {} is more than {limit} m for {count} of {trees} trees, which no tree has (line {line}: {cell}){guess}",
            self.title
        ))
    }
}

/// What is said of cells that say nothing.
fn missing_note(shown: &str, columns: &[Column], trees: usize) -> Option<String> {
    let with_gaps = columns.iter().filter(|column| column.missing > 0);
    let gaps: Vec<String> =
        with_gaps.map(|column| format!("{} {} of {trees}", column.title, column.missing)).collect();
    (!gaps.is_empty()).then(|| {
        format!("{shown}: trees without a value (empty, NA, NaN or -) are left out: {}", gaps.join(", "))
    })
}

/// A finite number.
fn number(cell: &str) -> Option<f64> {
    cell.parse::<f64>().ok().filter(|x| x.is_finite())
}

fn reader(text: &str, separator: u8) -> Reader<&[u8]> {
    ReaderBuilder::new()
        .trim(Trim::All)
        .comment(Some(b'#'))
        .delimiter(separator)
        // Lines of another length are an error of ours, which says what to do.
        .flexible(true)
        .from_reader(text.as_bytes())
}

/// What parts the columns: the sign between which the header names the most numbers. A heading may hold the other signs.
fn separator(text: &str) -> u8 {
    let named = |separator: u8| {
        let mut reader = reader(text, separator);
        reader.headers().map_or(0, |header| header.iter().filter(|title| meant(title).is_some()).count())
    };
    // Of equals the first.
    SEPARATORS.into_iter().rev().max_by_key(|separator| named(*separator)).unwrap_or(b';')
}

/// The number that a heading means, and what its values are multiplied by.
fn meant(title: &str) -> Option<(&'static Number, f64)> {
    let title = title.to_ascii_lowercase();
    // Which tree it is is no number: a column `tree` of a table is an id.
    let named = |name: &str| NUMBERS.iter().find(|number| number.name == name && number.group != Group::Tree);
    if let Some(number) = named(&title) {
        return Some((number, 1.0));
    }
    LENGTHS.iter().find_map(|(unit, metres)| {
        let number = named(&format!("{}_m", title.strip_suffix(unit)?))?;
        Some((number, *metres))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn headings_mean_numbers_in_their_unit() {
        let of = |title: &str| meant(title).map(|(number, scale)| (number.name, scale));
        assert_eq!(of("height_m"), Some(("height_m", 1.0)));
        assert_eq!(of("DBH_cm"), Some(("dbh_m", 0.01)));
        assert_eq!(of("crown_width_ft"), Some(("crown_width_m", 0.3048)));
        assert_eq!(of("nodes"), Some(("nodes", 1.0)));
        assert_eq!((of("height"), of("species"), of("nodes_cm")), (None, None, None));
    }

    #[test]
    fn the_header_tells_what_parts_columns() {
        for (text, expected) in [
            ("height_m,dbh_cm\n", b','),
            ("# a comment; with signs\nheight_m;dbh_cm\n15,2;40\n", b';'),
            ("height_m\tdbh_cm\n15,2\t40\n", b'\t'),
            ("species;\"height_m\"\n", b';'),
            ("height_m,dbh_cm,what was seen; where\n", b','),
            ("height_m;what was seen, where;dbh_m\n", b';'),
            // Neither, so that commas are decimal.
            ("height_m\n15,2\n", b';'),
            ("", b';'),
        ] {
            assert_eq!(separator(text), expected, "{text}");
        }
    }
}
