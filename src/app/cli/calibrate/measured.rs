//! A table of measured trees.

use std::path::Path;

use anyhow::Context;
use csv::{ReaderBuilder, Trim};
use linden::Monitor;
use linden::knob::{excerpt, printable};
use linden::memory::bytes_of;
use linden::report::{NUMBERS, Number, Sample};

use super::no_columns;
use crate::exit::usage;
use crate::paths::show;
use crate::progress::Progress;
use crate::{reading, source};

/// Units of lengths, in metres. The international foot and inch.
const LENGTHS: [(&str, f64); 5] =
    [("_m", 1.0), ("_cm", 0.01), ("_mm", 0.001), ("_ft", 0.3048), ("_in", 0.0254)];

/// What was measured.
pub struct Measured {
    /// Lines of the table.
    pub trees: usize,
    /// The numbers that it has, in its order; each has a value at least.
    pub columns: Vec<(&'static Number, Sample)>,
    /// Headings of what is no number.
    pub left_out: Vec<String>,
}

/// A column that is compared.
struct Column {
    at: usize,
    number: &'static Number,
    /// Metres of its unit.
    scale: f64,
    values: Vec<f64>,
    /// What is said of the first cell that is no number.
    fault: Option<String>,
}

impl Measured {
    pub fn read(path: &Path, progress: &Progress) -> anyhow::Result<Self> {
        let shown = show(path);
        let read = || reading::open(path, progress)?.bytes(progress);
        let bytes = read().with_context(|| format!("reading {shown}"))?;
        let text = source::utf8(&bytes, &shown)?;
        let mut reader = ReaderBuilder::new()
            .trim(Trim::All)
            .comment(Some(b'#'))
            .from_reader(text.trim_start_matches('\u{feff}').as_bytes());
        let located = |error: &csv::Error| usage(format!("{shown}: {}", printable(&error.to_string())));
        let header = reader.headers().map_err(|error| located(&error))?;
        let (mut columns, mut left_out) = (Vec::<Column>::new(), Vec::new());
        for (at, title) in header.iter().enumerate() {
            let Some((number, scale)) = meant(title) else {
                left_out.push(excerpt(title));
                continue;
            };
            if columns.iter().any(|other| other.number.name == number.name) {
                return Err(usage(format!("{shown}: two columns are {}; keep one", number.name)));
            }
            columns.push(Column { at, number, scale, values: Vec::new(), fault: None });
        }
        if columns.is_empty() {
            return Err(no_columns(&shown));
        }
        let cells = text.lines().count().saturating_mul(columns.len());
        progress.admit("reading measured trees", bytes_of::<f64>(cells), "divide the table")?;
        let mut trees = 0;
        for record in reader.records() {
            progress.check()?;
            let record = record.map_err(|error| located(&error))?;
            let line = record.position().map_or(0, csv::Position::line);
            trees += 1;
            for column in &mut columns {
                let cell = record.get(column.at).unwrap_or_default();
                // What was not measured of a tree.
                if cell.is_empty() || ["na", "nan", "-"].contains(&cell.to_ascii_lowercase().as_str()) {
                    continue;
                }
                match cell.parse::<f64>().ok().filter(|x| x.is_finite()) {
                    Some(value) => column.values.push(value * column.scale),
                    None if column.fault.is_some() => {}
                    None => {
                        let (name, cell) = (column.number.name, excerpt(cell));
                        let expected = "expected a number like 12.5, or nothing";
                        column.fault = Some(format!("{shown}:{line}: {name} is '{cell}', {expected}"));
                    }
                }
            }
        }
        let mut sampled = Vec::new();
        for Column { number, values, fault, .. } in columns {
            match (Sample::of(values), fault) {
                (Some(sample), None) => sampled.push((number, sample)),
                (Some(_), Some(fault)) => return Err(usage(fault)),
                // Words and lists all the way down, as 'linden sweep' writes some.
                (None, _) => left_out.push(number.name.to_owned()),
            }
        }
        let columns = sampled;
        if columns.is_empty() {
            return Err(usage(format!("{shown} has no measured tree: a line for each below the header")));
        }
        Ok(Self { trees, columns, left_out })
    }
}

/// The number that a heading means, and what its values are multiplied by.
fn meant(title: &str) -> Option<(&'static Number, f64)> {
    let title = title.to_ascii_lowercase();
    let named = |name: &str| NUMBERS.iter().find(|number| number.name == name);
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
}
