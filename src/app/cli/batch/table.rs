//! A table of places: which tree stands where.
//!
//! CSV with a header. Columns `x` and `z` have to be there; `y`, `turn` (degrees about the vertical), `scale`, `tree` (a
//! number of the batch) and `source` may be. A line without a tree is given the next one of its source, and one without
//! both the next of all, in the order of their numbers, again from the first after the last.

use std::collections::BTreeMap;
use std::path::Path;

use anyhow::Context;
use csv::{ReaderBuilder, StringRecord, Trim};
use glam::DVec3;
use linden::Monitor;
use linden::knob::excerpt;
use linden::memory::bytes_of;
use linden_exporters::{Member, MemberPlace};

use super::plan::Plan;
use crate::exit::{say, usage};
use crate::paths::show;
use crate::progress::Progress;
use crate::{reading, source};

/// Columns, in the order of their meaning.
const COLUMNS: [&str; 7] = ["x", "z", "y", "turn", "scale", "tree", "source"];
/// How many of these must be there.
const NEEDED: usize = 2;

/// Places of trees.
pub struct Table {
    lines: Vec<Line>,
    shown: String,
}

/// A place.
struct Line {
    position: DVec3,
    turn_rad: f64,
    scale: f64,
    wanted: Wanted,
}

/// Which tree stands there.
enum Wanted {
    Tree(usize),
    OfSource(String),
    Any,
}

impl Table {
    /// Reads a table for the trees of a plan.
    pub fn read(path: &Path, plan: &Plan, progress: &Progress) -> anyhow::Result<Self> {
        let shown = show(path);
        let read = || reading::open(path, progress)?.bytes(progress);
        let bytes = read().with_context(|| format!("reading {shown}"))?;
        let text = source::utf8(&bytes, &shown)?;
        let lines = text.lines().count();
        progress.admit("reading places", bytes_of::<Line>(lines), "divide the table")?;
        let mut reader = ReaderBuilder::new()
            .trim(Trim::All)
            .comment(Some(b'#'))
            .from_reader(text.trim_start_matches('\u{feff}').as_bytes());
        let located =
            |error: &csv::Error| usage(format!("{shown}: {}", linden::knob::printable(&error.to_string())));
        let columns = Columns::of(reader.headers().map_err(|error| located(&error))?, &shown)?;
        let mut table = Self { lines: Vec::with_capacity(lines), shown: shown.clone() };
        for record in reader.records() {
            progress.check()?;
            let record = record.map_err(|error| located(&error))?;
            let number = record.position().map_or(0, csv::Position::line);
            let line = columns.line(&record, plan);
            table.lines.push(line.map_err(|fault| usage(format!("{shown}:{number}: {fault}")))?);
        }
        if table.lines.is_empty() {
            return Err(usage(format!("{shown} has no places: a line for each below the header, like x,z")));
        }
        Ok(table)
    }

    /// Where these trees stand. What is to stand somewhere and is not among them is said.
    pub fn places(&self, members: &[Member]) -> Vec<MemberPlace> {
        let mut of_source: BTreeMap<&str, Vec<usize>> = BTreeMap::new();
        let mut of_number = BTreeMap::new();
        for (at, member) in members.iter().enumerate() {
            of_source.entry(&member.source).or_default().push(at);
            of_number.insert(member.index, at);
        }
        let (mut next_of, mut next) = (BTreeMap::<&str, usize>::new(), 0);
        let place = |line: &Line, member| MemberPlace {
            member,
            position: line.position,
            turn_rad: line.turn_rad,
            scale: line.scale,
        };
        let placed = self.lines.iter().filter_map(|line| {
            let member = match &line.wanted {
                Wanted::Tree(number) => of_number.get(&(*number as u64)).copied()?,
                Wanted::OfSource(source) => {
                    let (source, all) = of_source.get_key_value(source.as_str())?;
                    let turn = next_of.entry(source).or_default();
                    *turn += 1;
                    all[(*turn - 1) % all.len()]
                }
                Wanted::Any => {
                    next += 1;
                    (next - 1) % members.len().max(1)
                }
            };
            Some(place(line, member))
        });
        let places: Vec<MemberPlace> = placed.collect();
        let empty = self.lines.len() - places.len();
        if empty > 0 {
            let places_of = if empty == 1 { "place of" } else { "places of" };
            let stays = if empty == 1 { "stays" } else { "stay" };
            say(&format!(
                "note: {empty} {places_of} {} {stays} empty: no file of such a tree is there",
                self.shown
            ));
        }
        places
    }
}

/// Which column of a table has what; in the order of [`COLUMNS`].
struct Columns([Option<usize>; COLUMNS.len()]);

impl Columns {
    fn of(header: &StringRecord, shown: &str) -> anyhow::Result<Self> {
        let find = |name: &str| header.iter().position(|title| title.eq_ignore_ascii_case(name));
        let columns = Self(COLUMNS.map(find));
        if let Some(missing) = COLUMNS.iter().take(NEEDED).find(|name| find(name).is_none()) {
            return Err(usage(format!(
                "{shown} has no column '{missing}'; its first line names the columns: {}",
                COLUMNS.join(",")
            )));
        }
        let unknown: Vec<String> = header
            .iter()
            .filter(|title| !COLUMNS.iter().any(|name| title.eq_ignore_ascii_case(name)))
            .map(excerpt)
            .collect();
        if !unknown.is_empty() {
            say(&format!("note: columns of {shown} that say nothing here: {}", unknown.join(", ")));
        }
        Ok(columns)
    }

    fn line(&self, record: &StringRecord, plan: &Plan) -> Result<Line, String> {
        let field =
            |column: usize| self.0[column].and_then(|at| record.get(at)).filter(|text| !text.is_empty());
        let number = |column: usize, default: Option<f64>| match (field(column), default) {
            (None, Some(default)) => Ok(default),
            (text, _) => {
                let text = text.unwrap_or_default();
                let parsed = text.parse::<f64>().ok().filter(|x| x.is_finite());
                parsed.ok_or_else(|| {
                    format!("{} is '{}', where a number belongs", COLUMNS[column], excerpt(text))
                })
            }
        };
        let position = DVec3::new(number(0, None)?, number(2, Some(0.0))?, number(1, None)?);
        let (turn_deg, scale) = (number(3, Some(0.0))?, number(4, Some(1.0))?);
        if scale <= 0.0 {
            return Err(format!("scale is {scale}; it must be above 0"));
        }
        let wanted = match (field(5), field(6)) {
            (Some(text), _) => {
                let count = plan.len();
                let tree = text.parse().ok().filter(|tree| *tree < count);
                Wanted::Tree(tree.ok_or_else(|| {
                    format!("there is no tree '{}': they are numbered from 0 to {}", excerpt(text), count - 1)
                })?)
            }
            (None, Some(source)) if plan.has_source(source) => Wanted::OfSource(source.to_owned()),
            (None, Some(source)) => {
                return Err(format!("the manifest has no source '{}'", excerpt(source)));
            }
            (None, None) => Wanted::Any,
        };
        Ok(Line { position, turn_rad: turn_deg.to_radians(), scale, wanted })
    }
}
