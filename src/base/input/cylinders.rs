//! Reads tables of cylinders, which forestry calls quantitative structure models (QSM), in the dialects of the programs that
//! write them. The header tells which; numbers are metres.
//!
//! | dialect | told by | says |
//! |---|---|---|
//! | linden | `start_x_m`, `axis_x`, `length_m`, `radius_m` | Y up; both radii, nodes, trees |
//! | `SimpleForest` | `startX` … `endZ`, `radius`, `ID`, `parentID` | parent −1: none; `treeID` |
//! | rTwig | `start_x` …, `end_x` … (or `axis_x` … and `length`), `radius`, `id`, `parent` | parent 0: none |
//! | aRchi | `startX` … `endZ`, `cyl_ID`, `parent_ID`, `radius_cyl` | parent 0: none |
//! | `TreeQSM`, text | `radius (m)`, `length (m)`, `start_point`, `axis_direction`, `parent` | the row's number is its id |
//! | `TreeQSM`, MATLAB | the structure `QSM.cylinder` in a MAT file | as its text; several models of one file are several trees |
//! | raycloudtools | `x,y,z,radius,parent_id` | a line a tree; each segment runs from its parent's tip to its own |
//!
//! Columns go by their names, in any order and case; further ones are passed over.

use std::collections::BTreeMap;

use glam::DVec3;

use super::{InputError, ROWS_PER_CHECK, Up, in_range, lines, make_room, mat, quoted, text_of};
use crate::monitor::Monitor;

/// The program whose habits a table of cylinders follows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CylinderDialect {
    /// Ours.
    Linden,
    /// `SimpleForest`'s detailed table.
    SimpleForest,
    /// rTwig's standard table.
    Rtwig,
    /// aRchi's table of a QSM.
    Archi,
    /// `TreeQSM`'s text.
    TreeQsm,
    /// The tree file of raycloudtools.
    Raycloudtools,
}

impl CylinderDialect {
    /// Which way is up in it.
    pub const fn up(self) -> Up {
        if matches!(self, Self::Linden) { Up::Y } else { Up::Z }
    }
}

/// A table of cylinders.
#[derive(Clone, Debug, PartialEq)]
pub struct CylinderTable {
    /// Whose it is.
    pub dialect: CylinderDialect,
    /// The cylinders of each tree; parents before children.
    pub trees: Vec<Vec<CylinderRow>>,
}

impl CylinderTable {
    /// How many cylinders there are.
    pub fn count(&self) -> usize {
        self.trees.iter().map(Vec::len).sum()
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

const FORMAT: &str = "cylinders";

/// Thicker and longer ones are in another unit.
const MOST_RADIUS_M: f64 = 100.0;
const MOST_LENGTH_M: f64 = 1000.0;

/// A cylinder that ends this near to where the one above begins ends there: what is left is rounding, metres.
const ROUNDING_M: f64 = 0.002;

/// Whether a line is the header of a table of cylinders, and whether that has radii at both ends.
pub(super) fn header_tells(line: &str) -> Option<bool> {
    let header = Header::of(line)?;
    Some(header.lower_radius.is_some() && header.upper_radius.is_some())
}

/// Reads a table of cylinders.
///
/// # Errors
/// [`InputError`] with line and column: no header, cut rows, what is no number or no metre, a cylinder twice, a parent that is not
/// there, parents in a circle; no memory; cancelled.
pub fn read_cylinders(bytes: &[u8], monitor: &dyn Monitor) -> Result<CylinderTable, InputError> {
    if bytes.starts_with(mat::OPENING) || bytes.starts_with(mat::OPENING_HDF5) {
        return mat::read(bytes, monitor);
    }
    let mut header: Option<Header> = None;
    let mut found: Vec<Found> = Vec::new();
    let mut trees: Vec<Vec<CylinderRow>> = Vec::new();
    for (line, row) in lines(text_of(bytes)?) {
        if line % ROWS_PER_CHECK == 0 {
            monitor.check()?;
        }
        let row = row.trim();
        if row.is_empty() || row.starts_with('#') || row.starts_with("//") {
            continue;
        }
        let Some(header) = &header else {
            let read = Header::of(row)
                .ok_or_else(|| wrong(line, "a header that names the columns of cylinders".to_owned(), row))?;
            header = Some(read);
            continue;
        };
        if header.dialect == CylinderDialect::Raycloudtools {
            trees.extend(header.line_of_tree(line, row, monitor)?);
        } else {
            make_room(&found, found.capacity(), 0, monitor)?;
            found.push(header.row(line, row, found.len() as i64 + 1)?);
        }
    }
    let whole = |problem: &str| InputError::Whole { format: FORMAT, problem: problem.to_owned() };
    let Some(header) = header else { return Err(whole("it has no header")) };
    // In the order in which trees come up.
    let mut of_tree: BTreeMap<Option<i64>, usize> = BTreeMap::new();
    let mut groups: Vec<Vec<Found>> = Vec::new();
    for row in found {
        let group = *of_tree.entry(row.tree).or_insert_with(|| {
            groups.push(Vec::new());
            groups.len() - 1
        });
        groups[group].push(row);
    }
    for group in groups {
        monitor.check()?;
        trees.push(joined(&group)?);
    }
    if trees.is_empty() {
        return Err(whole("it has a header, but no cylinders; it may be cut off"));
    }
    Ok(CylinderTable { dialect: header.dialect, trees })
}

fn wrong(line: usize, expected: String, found: &str) -> InputError {
    InputError::Line { format: FORMAT, line, expected, found: quoted(found) }
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

/// What is expected of a cylinder that is none, for its size.
pub(super) fn check(row: &CylinderRow) -> Result<(), String> {
    if !(0.0..=MOST_RADIUS_M).contains(&row.radius_m) {
        return Err(format!("metres from 0 to {MOST_RADIUS_M} as radius, found {}", row.radius_m));
    }
    match row.along {
        Some((_, length_m)) if !(0.0..=MOST_LENGTH_M).contains(&length_m) => {
            Err(format!("metres from 0 to {MOST_LENGTH_M} as length, found {length_m}"))
        }
        Some((unit, length_m)) if unit == DVec3::ZERO && length_m > 0.0 => {
            Err("a direction other than 0, 0, 0 as axis".to_owned())
        }
        _ => Ok(()),
    }
}

/// Which column is what.
struct Header {
    dialect: CylinderDialect,
    delimiter: Option<char>,
    /// Columns of a row.
    count: usize,
    names: Vec<String>,
    start: [usize; 3],
    end: Option<[usize; 3]>,
    axis: Option<[usize; 3]>,
    length: Option<usize>,
    radius: usize,
    id: Option<usize>,
    parent: Option<usize>,
    branch: Option<usize>,
    tree: Option<usize>,
    birth: Option<usize>,
    nodes: Option<[usize; 2]>,
    lower_radius: Option<usize>,
    upper_radius: Option<usize>,
}

impl Header {
    fn of(line: &str) -> Option<Self> {
        let delimiter = ['\t', ';', ','].into_iter().find(|&sign| line.contains(sign));
        let mut names = Vec::new();
        for name in fields(line, delimiter) {
            let name = name.split('(').next().unwrap_or_default().trim().to_ascii_lowercase();
            match name.as_str() {
                // One name for three numbers.
                "start_point" => names.extend(["startx", "starty", "startz"].map(str::to_owned)),
                "axis_direction" => names.extend(["axisx", "axisy", "axisz"].map(str::to_owned)),
                _ => names.push(name),
            }
        }
        let is_treeqsm = names.len() > fields(line, delimiter).count();
        let find =
            |known: &[&str]| known.iter().find_map(|known| names.iter().position(|name| name == known));
        let three = |prefix: &str| {
            let place = |axis: &str| {
                find(&[
                    &format!("{prefix}{axis}"),
                    &format!("{prefix}_{axis}"),
                    &format!("{prefix}_{axis}_m"),
                ])
            };
            Some([place("x")?, place("y")?, place("z")?])
        };
        let parent = find(&["parentid", "parent_id", "parent"]);
        let radius = find(&["radius_m", "radius", "radius_cyl"])?;
        let (end, axis, length) = (three("end"), three("axis"), find(&["length_m", "length"]));
        let pair = |[a, b]: [&str; 2]| Some([find(&[a])?, find(&[b])?]);
        let id = find(&["id", "cyl_id"]);
        let (dialect, start) = match three("start") {
            Some(start) => {
                parent?;
                if end.is_none() && (axis.is_none() || length.is_none()) {
                    return None;
                }
                let dialect = if find(&["start_x_m"]).is_some() {
                    CylinderDialect::Linden
                } else if is_treeqsm {
                    CylinderDialect::TreeQsm
                } else if find(&["cyl_id"]).is_some() {
                    CylinderDialect::Archi
                } else if find(&["parentid"]).is_some() {
                    CylinderDialect::SimpleForest
                } else {
                    CylinderDialect::Rtwig
                };
                (dialect, start)
            }
            None => {
                let x = find(&["x"])?;
                let opens = names.get(x..x + 4)? == ["x", "y", "z", "radius"];
                if !opens || delimiter != Some(',') || parent? < x {
                    return None;
                }
                (CylinderDialect::Raycloudtools, [x, x + 1, x + 2])
            }
        };
        Some(Self {
            dialect,
            delimiter,
            count: names.len(),
            start,
            end,
            axis,
            length,
            radius,
            id,
            parent,
            branch: find(&["branchid", "axis_id", "branch_id", "branch"]),
            tree: find(&["treeid", "tree_id", "tree"]),
            birth: find(&["birth"]),
            nodes: pair(["parent_node", "node"]),
            lower_radius: find(&["start_radius_m"]),
            upper_radius: find(&["end_radius_m"]),
            names,
        })
    }

    fn row(&self, line: usize, text: &str, number: i64) -> Result<Found, InputError> {
        let fields: Vec<&str> = fields(text, self.delimiter).collect();
        if fields.len() < self.count {
            let expected = format!("{} columns as in the header", self.count);
            return Err(wrong(line, expected, &format!("{}", fields.len())));
        }
        let cells = Cells { fields: &fields, names: &self.names, line };
        let start = cells.place(self.start)?;
        let mut along = None;
        let end = match (self.end, self.axis, self.length) {
            (Some(end), _, _) => cells.place(end)?,
            (None, Some(axis), Some(length)) => {
                let length_m = cells.within(length, MOST_LENGTH_M)?;
                let axis_given = cells.place(axis)?;
                let unit = axis_given.try_normalize();
                if unit.is_none() && length_m > 0.0 {
                    return Err(cells.wrong(axis[0], "a direction other than 0, 0, 0"));
                }
                let unit = unit.unwrap_or(DVec3::ZERO);
                along = Some((unit, length_m));
                start + unit * length_m
            }
            _ => start,
        };
        if start.distance(end) > MOST_LENGTH_M {
            return Err(wrong(line, format!("a cylinder of at most {MOST_LENGTH_M} metres"), text));
        }
        let end_radii_m = match (self.lower_radius, self.upper_radius) {
            (Some(lower), Some(upper)) => {
                Some([cells.within(lower, MOST_RADIUS_M)?, cells.within(upper, MOST_RADIUS_M)?])
            }
            _ => None,
        };
        let small = |column: usize| -> Result<u32, InputError> {
            let whole = cells.whole(column)?;
            u32::try_from(whole.unwrap_or(-1)).map_err(|_| cells.wrong(column, "a whole number from 0"))
        };
        let nodes = match self.nodes {
            Some([lower, upper]) => Some([small(lower)?, small(upper)?]),
            None => None,
        };
        let id = match self.id {
            Some(id) => cells.whole(id)?.ok_or_else(|| cells.wrong(id, "a whole number"))?,
            None => number,
        };
        let of = |column: Option<usize>| column.map_or(Ok(None), |column| cells.whole(column));
        let row = CylinderRow {
            parent: None,
            start,
            end,
            along,
            radius_m: cells.within(self.radius, MOST_RADIUS_M)?,
            end_radii_m,
            branch: of(self.branch)?,
            birth: self.birth.map(small).transpose()?,
            nodes,
        };
        Ok(Found { line, id, parent: of(self.parent)?, tree: of(self.tree)?, row })
    }

    /// The tree of a line of raycloudtools; `None` for one that is a root alone.
    fn line_of_tree(
        &self,
        line: usize,
        text: &str,
        monitor: &dyn Monitor,
    ) -> Result<Option<Vec<CylinderRow>>, InputError> {
        let fields: Vec<&str> = fields(text.trim_end_matches([',', ' ']), self.delimiter).collect();
        let attributes = self.start[0];
        let width = self.count - attributes;
        let count = fields.len().saturating_sub(attributes);
        if count == 0 || !count.is_multiple_of(width) {
            let expected = format!("{attributes} columns of the tree, then {width} for each segment");
            return Err(wrong(line, expected, &format!("{} columns", fields.len())));
        }
        let mut tips: Vec<DVec3> = Vec::new();
        let mut found: Vec<Found> = Vec::new();
        for (number, segment) in (0_i64..).zip(fields[attributes..].chunks(width)) {
            make_room(&found, found.capacity(), 0, monitor)?;
            let cells = Cells { fields: segment, names: &self.names[attributes..], line };
            let local = |column: usize| column - attributes;
            let tip = cells.place(self.start.map(local))?;
            let radius_m = cells.within(local(self.radius), MOST_RADIUS_M)?;
            let parent = match self.parent {
                Some(parent) => cells.whole(local(parent))?.unwrap_or(-1),
                None => number - 1,
            };
            tips.push(tip);
            if (parent < 0) != (number == 0) {
                let expected = if number == 0 {
                    "-1 as parent_id of a tree's first segment".to_owned()
                } else {
                    format!("a parent_id from 0 for segment {number}")
                };
                return Err(wrong(line, expected, &parent.to_string()));
            }
            if number > 0 {
                let row = CylinderRow {
                    parent: None,
                    start: DVec3::ZERO,
                    end: tip,
                    along: None,
                    radius_m,
                    end_radii_m: None,
                    branch: None,
                    birth: None,
                    nodes: None,
                };
                found.push(Found { line, id: number, parent: Some(parent), tree: None, row });
            }
        }
        for segment in &mut found {
            let tip = segment.parent.and_then(|parent| tips.get(usize::try_from(parent).ok()?));
            let Some(&tip) = tip else {
                let expected = format!("a parent_id below {} for segment {}", tips.len(), segment.id);
                return Err(wrong(line, expected, &segment.parent.unwrap_or(-1).to_string()));
            };
            segment.row.start = tip;
            if tip.distance(segment.row.end) > MOST_LENGTH_M {
                let expected = format!("a segment {} of at most {MOST_LENGTH_M} metres", segment.id);
                return Err(wrong(line, expected, "more"));
            }
        }
        if found.is_empty() { Ok(None) } else { joined(&found).map(Some) }
    }
}

/// The fields of a row, or of a part of it.
struct Cells<'a> {
    fields: &'a [&'a str],
    names: &'a [String],
    line: usize,
}

impl Cells<'_> {
    fn text(&self, column: usize) -> &str {
        self.fields.get(column).copied().unwrap_or_default()
    }

    fn wrong(&self, column: usize, expected: &str) -> InputError {
        let name = self.names.get(column).map_or("", String::as_str);
        wrong(self.line, format!("{expected} in column '{name}'"), self.text(column))
    }

    fn number(&self, column: usize) -> Result<f64, InputError> {
        let number = self.text(column).parse::<f64>().map_err(|_| "a number").and_then(in_range);
        number.map_err(|expected| self.wrong(column, expected))
    }

    fn within(&self, column: usize, most: f64) -> Result<f64, InputError> {
        let number = self.number(column)?;
        if (0.0..=most).contains(&number) {
            return Ok(number);
        }
        Err(self.wrong(column, &format!("metres from 0 to {most}")))
    }

    fn place(&self, columns: [usize; 3]) -> Result<DVec3, InputError> {
        Ok(DVec3::new(self.number(columns[0])?, self.number(columns[1])?, self.number(columns[2])?))
    }

    /// A whole number; `None` where R or a table has none.
    fn whole(&self, column: usize) -> Result<Option<i64>, InputError> {
        if matches!(self.text(column), "" | "NA" | "NaN") {
            return Ok(None);
        }
        let number = self.number(column)?;
        if number.fract() != 0.0 {
            return Err(self.wrong(column, "a whole number"));
        }
        Ok(Some(number as i64))
    }
}

fn fields(row: &str, delimiter: Option<char>) -> impl Iterator<Item = &str> {
    let parts = row.split(move |c: char| delimiter.map_or(c.is_whitespace(), |sign| c == sign));
    parts
        .map(|part| part.trim().trim_matches('"').trim())
        .filter(move |part| delimiter.is_some() || !part.is_empty())
}

/// No place in a list yet.
const UNSEEN: u32 = u32::MAX;
/// The same, on the way down to what it stands on.
const WAITING: u32 = u32::MAX - 1;

/// The rows of one tree with parents by their places, before their children.
pub(super) fn joined(found: &[Found]) -> Result<Vec<CylinderRow>, InputError> {
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
    // An upper end that was computed is where the next cylinder begins.
    for index in 0..rows.len() {
        let CylinderRow { parent: Some(parent), start, .. } = rows[index] else { continue };
        let below = &mut rows[parent as usize];
        if below.along.is_some() && below.end.distance(start) <= ROUNDING_M {
            below.end = start;
            below.along = None;
        }
    }
    Ok(rows)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::monitor::Quiet;

    fn read(text: &str) -> Result<CylinderTable, InputError> {
        read_cylinders(text.as_bytes(), &Quiet)
    }

    #[test]
    fn rows_are_sorted_parents_first_and_trees_told_apart() {
        let table = read(
            "id,parent,start_x,start_y,start_z,end_x,end_y,end_z,radius,tree\n\
             2,1,0,0,1,0,0,2,.1,7\n1,0,0,0,0,0,0,1,.2,7\n1,0,5,0,0,5,0,3,.3,4\n",
        )
        .unwrap();
        assert_eq!(table.dialect, CylinderDialect::Rtwig);
        let radii: Vec<Vec<f64>> =
            table.trees.iter().map(|t| t.iter().map(|r| r.radius_m).collect()).collect();
        assert_eq!(radii, [vec![0.2, 0.1], vec![0.3]]);
        assert_eq!(table.trees[0][1].parent, Some(0));
    }

    #[test]
    fn what_is_broken_is_said_with_its_line() {
        let head = "id,parent,start_x,start_y,start_z,end_x,end_y,end_z,radius\n";
        for (rows, line, part) in [
            ("1,0,0,0,0,0,0,1\n", 2, "9 columns"),
            ("1,0,0,0,0,0,0,1,thick\n", 2, "a number in column 'radius', found 'thick'"),
            ("1,0,0,0,0,0,0,NaN,.1\n", 2, "a finite number in column 'end_z'"),
            ("1,0,0,0,0,0,0,1,1e300\n", 2, "column 'radius'"),
            ("1,0,0,0,0,0,0,1,-1\n", 2, "metres from 0"),
            ("1,0,0,0,0,0,0,99999,.1\n", 2, "at most 1000 metres"),
            ("1,0,0,0,0,0,0,1,.1\n2,9,0,0,1,0,0,2,.1\n", 3, "as parent, found '9'"),
            ("1,2,0,0,0,0,0,1,.1\n2,1,0,0,1,0,0,2,.1\n", 2, "own child"),
            ("1,1,0,0,0,0,0,1,.1\n", 2, "own child"),
            ("1,0,0,0,0,0,0,1,.1\n1,0,0,0,1,0,0,2,.1\n", 3, "than that of line 2"),
            ("1.5,0,0,0,0,0,0,1,.1\n", 2, "a whole number in column 'id'"),
        ] {
            let error = read(&format!("{head}{rows}")).unwrap_err().to_string();
            assert!(error.contains(&format!("line {line}:")) && error.contains(part), "{rows}: {error}");
        }
        assert!(read(head).unwrap_err().to_string().contains("no cylinders"));
        let head = "height,x,y,z,radius,parent_id\n";
        for (row, part) in [
            ("2,0,0,0,.1,-1,0,0,1\n", "5 for each segment"),
            ("2,0,0,0,.1,0\n", "-1 as parent_id"),
            ("2,0,0,0,.1,-1,0,0,1,.1,-1\n", "segment 1"),
            ("2,0,0,0,.1,-1,0,0,1,.1,7\n", "below 2"),
            ("2,0,0,0,.1,-1,0,0,1,.1,1\n", "own child"),
        ] {
            let error = read(&format!("{head}{row}")).unwrap_err().to_string();
            assert!(error.contains("line 2:") && error.contains(part), "{row}: {error}");
        }
    }

    #[test]
    fn cut_anywhere_it_never_panics() {
        let text = "radius (m)\tlength (m)\tstart_point\taxis_direction\tparent\textension\n\
                    0.1\t1\t0\t0\t0\t0\t0\t1\t0\t2\n0.05\t1\t0\t0\t1\t0\t0\t1\t1\t0\n";
        assert_eq!(read(text).unwrap().dialect, CylinderDialect::TreeQsm);
        for end in 0..text.len() {
            let _ = read(&text[..end]);
        }
    }
}
