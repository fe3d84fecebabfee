//! What tables of cylinders of all dialects become: trees in metres, whose rows name their parents by their places.

use std::collections::BTreeMap;

use glam::DVec3;

use super::cylinder_header::CylinderDialect;
use super::unit::{CENTIMETRES, HIGHEST_TREE_M, likely_scale};
use super::{InputError, Up, quoted};
use crate::monitor::Monitor;

/// What errors call it.
pub(super) const FORMAT: &str = "cylinders";

/// Thicker and longer ones are none.
const MOST_RADIUS_M: f64 = 100.0;
const MOST_LENGTH_M: f64 = 1000.0;

/// No tree is thicker, from its middle to the bark, metres: the Árbol del Tule has 7 m.
const THICKEST_M: f64 = 10.0;

/// The greatest radius of a tree is between these parts of its height.
const SLIMMEST: f64 = 0.001;
const STOUTEST: f64 = 0.25;

/// A cylinder that ends this near to where the one above begins ends there: what is left is rounding, metres.
const ROUNDING_M: f64 = 0.002;

/// Models of `TreeQSM` whose feet are nearer to each other than this, metres, are of one tree: the cover sets of each run begin
/// anew, so that they differ by some centimetres.
const SAME_FOOT_M: f64 = 0.3;

/// A table of cylinders.
#[derive(Clone, Debug, PartialEq)]
pub struct CylinderTable {
    /// Whose it is.
    pub dialect: CylinderDialect,
    /// Metres for a unit of the file: 1, or less where no tree is so large in metres.
    pub scale: f64,
    /// The cylinders of each tree; parents before children.
    pub trees: Vec<Vec<CylinderRow>>,
}

impl CylinderTable {
    /// How many cylinders there are.
    pub fn count(&self) -> usize {
        self.trees.iter().map(Vec::len).sum()
    }

    /// For each tree, the first one of which it is another model, in metres of the same foot: `TreeQSM` makes several models of a
    /// tree, since its runs differ, and keeps them in one array. In other tables each tree is itself.
    pub fn models_of(&self) -> Vec<usize> {
        let foot = |tree: usize| self.trees[tree].first().map(|row| row.start);
        let mut firsts: Vec<usize> = Vec::new();
        let mut models_of = Vec::with_capacity(self.trees.len());
        for tree in 0..self.trees.len() {
            let is_same = |&first: &usize| match (foot(tree), foot(first)) {
                (Some(a), Some(b)) => a.distance(b) <= SAME_FOOT_M,
                _ => false,
            };
            let is_of_runs = self.dialect == CylinderDialect::TreeQsm;
            let first = firsts.iter().copied().find(is_same).filter(|_| is_of_runs);
            firsts.extend(if first.is_none() { Some(tree) } else { None });
            models_of.push(first.unwrap_or(tree));
        }
        models_of
    }
}

/// One cylinder, in the file's axes, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CylinderRow {
    /// Index of the one below in its tree, less than its own.
    pub parent: Option<u32>,
    /// Centre of the lower end.
    pub start: DVec3,
    /// Centre of the upper end.
    pub end: DVec3,
    /// The unit vector and the length that the table gives instead of the upper end, where no cylinder above says where that is.
    pub along: Option<(DVec3, f64)>,
    /// Zero or more.
    pub radius_m: f64,
    /// At the lower and at the upper end, where the table has both.
    pub end_radii_m: Option<[f64; 2]>,
    /// The number of its branch.
    pub branch: Option<i64>,
    /// When it appeared.
    pub birth: Option<u32>,
    /// The numbers of the nodes at its lower and upper end.
    pub nodes: Option<[u32; 2]>,
}

/// A row as it stands in the file.
pub(super) struct Found {
    pub line: usize,
    pub id: i64,
    /// `None`: certainly none.
    pub parent: Option<i64>,
    pub tree: Option<i64>,
    pub row: CylinderRow,
}

/// What is of no size that a cylinder can have.
pub(super) struct TooLarge {
    pub part: Part,
    pub expected: String,
    /// In the file's unit.
    pub found: String,
}

/// A part of a cylinder.
#[derive(Clone, Copy)]
pub(super) enum Part {
    Radius,
    LowerRadius,
    UpperRadius,
    Length,
    Axis,
}

impl Part {
    pub const fn name(self) -> &'static str {
        match self {
            Self::Radius => "radius",
            Self::LowerRadius => "radius of the lower end",
            Self::UpperRadius => "radius of the upper end",
            Self::Length => "length",
            Self::Axis => "axis",
        }
    }
}

impl CylinderRow {
    /// Checks the sizes of a cylinder in the file's unit, of which one is `scale` metres.
    pub(super) fn check(&self, scale: f64) -> Result<(), TooLarge> {
        let ends =
            self.end_radii_m.map(|[lower, upper]| [(Part::LowerRadius, lower), (Part::UpperRadius, upper)]);
        for (part, radius) in ends.into_iter().flatten().chain([(Part::Radius, self.radius_m)]) {
            if !(0.0..=MOST_RADIUS_M).contains(&(radius * scale)) {
                let expected = format!("metres from 0 to {MOST_RADIUS_M}");
                return Err(TooLarge { part, expected, found: radius.to_string() });
            }
        }
        let (expected, length) = match self.along {
            Some((unit, length)) if unit == DVec3::ZERO && length > 0.0 => {
                let (expected, found) = ("a direction other than 0, 0, 0".to_owned(), "0, 0, 0".to_owned());
                return Err(TooLarge { part: Part::Axis, expected, found });
            }
            Some((_, length)) => (format!("metres from 0 to {MOST_LENGTH_M}"), length),
            None => (format!("a cylinder of at most {MOST_LENGTH_M} metres"), self.start.distance(self.end)),
        };
        if !(0.0..=MOST_LENGTH_M).contains(&(length * scale)) {
            return Err(TooLarge { part: Part::Length, expected, found: length.to_string() });
        }
        Ok(())
    }

    fn scaled(self, scale: f64) -> Self {
        Self {
            start: self.start * scale,
            end: self.end * scale,
            along: self.along.map(|(unit, length)| (unit, length * scale)),
            radius_m: self.radius_m * scale,
            end_radii_m: self.end_radii_m.map(|radii| radii.map(|radius| radius * scale)),
            ..self
        }
    }
}

impl CylinderTable {
    /// The trees of rows in the file's unit; `check` says what is wrong with one in a unit of so many metres.
    pub(super) fn of(
        dialect: CylinderDialect,
        groups: &[Vec<Found>],
        check: impl Fn(&Found, f64) -> Result<(), InputError>,
        monitor: &dyn Monitor,
    ) -> Result<Self, InputError> {
        let mut trees = Vec::with_capacity(groups.len());
        for group in groups {
            monitor.check()?;
            trees.push(joined(group)?);
        }
        let scale = scale_of(&trees, dialect.up());
        groups.iter().flatten().try_for_each(|found| check(found, scale))?;
        for tree in &mut trees {
            if scale != 1.0 {
                for row in &mut *tree {
                    *row = row.scaled(scale);
                }
            }
            meet(tree);
        }
        Ok(Self { dialect, scale, trees })
    }
}

/// Metres for a unit of trees: 1, or what centimetres or millimetres are where no tree is so high or so thick in metres, and
/// these are trees then.
fn scale_of(trees: &[Vec<CylinderRow>], up: Up) -> f64 {
    let rows = || trees.iter().flatten();
    let height = trees.iter().map(|tree| height_of(tree, up)).fold(0.0, f64::max);
    let radius = rows().map(|row| row.radius_m).fold(0.0, f64::max);
    let longest = rows().map(|row| row.start.distance(row.end)).fold(0.0, f64::max);
    if height <= HIGHEST_TREE_M && radius <= THICKEST_M {
        return 1.0;
    }
    let scale = likely_scale(height).min(CENTIMETRES);
    let is_tree = height.max(longest) * scale <= HIGHEST_TREE_M
        && radius * scale <= THICKEST_M
        && (SLIMMEST..=STOUTEST).contains(&(radius / height));
    if is_tree { scale } else { 1.0 }
}

/// The height of the highest of what stands on roots of its own, parents before children: a plot may lie on a slope.
fn height_of(rows: &[CylinderRow], up: Up) -> f64 {
    let mut spans: Vec<[f64; 2]> = Vec::new();
    let mut span_of: Vec<usize> = Vec::with_capacity(rows.len());
    for row in rows {
        let at = row.parent.map_or_else(
            || {
                spans.push([f64::INFINITY, f64::NEG_INFINITY]);
                spans.len() - 1
            },
            |parent| span_of[parent as usize],
        );
        span_of.push(at);
        for place in [row.start, row.end] {
            let height = if up == Up::Y { place.y } else { place.z };
            spans[at] = [spans[at][0].min(height), spans[at][1].max(height)];
        }
    }
    spans.iter().map(|[low, high]| high - low).fold(0.0, f64::max)
}

/// No place in a list yet.
const UNSEEN: u32 = u32::MAX;
/// The same, on the way down to what it stands on.
const WAITING: u32 = u32::MAX - 1;

/// The rows of one tree with parents by their places, before their children.
fn joined(found: &[Found]) -> Result<Vec<CylinderRow>, InputError> {
    let mut by_id: BTreeMap<i64, usize> = BTreeMap::new();
    for (index, row) in found.iter().enumerate() {
        if let Some(first) = by_id.insert(row.id, index) {
            let expected = format!("another id than that of line {}", found[first].line);
            return Err(wrong(row.line, expected, &row.id.to_string()));
        }
    }
    let mut parents: Vec<Option<usize>> = Vec::with_capacity(found.len());
    for row in found {
        parents.push(match row.parent {
            // Where ids count from 0, none is below.
            Some(parent) if parent > 0 || parent == 0 && by_id.contains_key(&0) => {
                let place = by_id.get(&parent).copied();
                Some(place.ok_or_else(|| {
                    wrong(row.line, "the id of a cylinder as parent".to_owned(), &parent.to_string())
                })?)
            }
            _ => None,
        });
    }
    let mut places = vec![UNSEEN; found.len()];
    let mut rows: Vec<CylinderRow> = Vec::with_capacity(found.len());
    let mut way = Vec::new();
    for index in 0..found.len() {
        let mut at = Some(index);
        while let Some(here) = at.filter(|&here| places[here] >= WAITING) {
            if places[here] == WAITING {
                let expected = "a parent that does not stand on its own child".to_owned();
                return Err(wrong(found[here].line, expected, &found[here].id.to_string()));
            }
            places[here] = WAITING;
            way.push(here);
            at = parents[here];
        }
        while let Some(here) = way.pop() {
            places[here] = rows.len() as u32;
            rows.push(CylinderRow { parent: parents[here].map(|parent| places[parent]), ..found[here].row });
        }
    }
    Ok(rows)
}

/// Takes an upper end that was computed to where the next cylinder begins; metres.
fn meet(rows: &mut [CylinderRow]) {
    for index in 0..rows.len() {
        let CylinderRow { parent: Some(parent), start, .. } = rows[index] else { continue };
        let below = &mut rows[parent as usize];
        if below.along.is_some() && below.end.distance(start) <= ROUNDING_M {
            below.end = start;
            below.along = None;
        }
    }
}

pub(super) fn wrong(line: usize, expected: String, found: &str) -> InputError {
    InputError::Line { format: FORMAT, line, expected, found: quoted(found) }
}
