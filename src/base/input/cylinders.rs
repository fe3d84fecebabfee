//! Reads tables of cylinders, which forestry calls quantitative structure models (QSM), in the dialects of the programs that
//! write them. The header tells which; numbers are metres, unless no tree is so high or so thick in metres.
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
//! Columns go by their names, in any order and case; further ones are passed over. Between semicolons, tabs or blanks `1,5` is
//! one and a half.

use std::collections::BTreeMap;

use glam::DVec3;

use super::cylinder_header::{CylinderDialect, Header, Lack, fields};
use super::cylinder_table::{CylinderRow, CylinderTable, FORMAT, Found, Part, TooLarge, wrong};
use super::{InputError, ROWS_PER_CHECK, in_range, lines, make_room, mat, text_of};
use crate::memory::bytes_of;
use crate::monitor::Monitor;

/// Whether a line is the header of a table of cylinders, and whether that has radii at both ends. What it lacks is for the
/// reader to say.
pub(super) fn header_tells(line: &str) -> Option<bool> {
    let header = Header::of(line)?;
    Some(header.is_ok_and(|header| header.lower_radius.is_some() && header.upper_radius.is_some()))
}

/// Reads a table of cylinders.
///
/// # Errors
/// [`InputError`] with line and column: no header, or one without a column that it cannot be without; cut rows, what is no number
/// or no metre, a cylinder twice, a parent that is not there, parents in a circle; no memory; cancelled.
pub fn read_cylinders(bytes: &[u8], monitor: &dyn Monitor) -> Result<CylinderTable, InputError> {
    if bytes.starts_with(mat::OPENING) || bytes.starts_with(mat::OPENING_HDF5) {
        return mat::read(bytes, monitor);
    }
    let mut header: Option<Header> = None;
    let mut found: Vec<Found> = Vec::new();
    let mut groups: Vec<Vec<Found>> = Vec::new();
    let mut held = 0;
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
            let lacks = |Lack { expected, found }| InputError::Line { format: FORMAT, line, expected, found };
            header = Some(read.map_err(lacks)?);
            continue;
        };
        if header.dialect == CylinderDialect::Raycloudtools {
            let segments = header.line_of_tree(line, row, held, monitor)?;
            held += bytes_of::<Found>(segments.capacity());
            groups.extend(Some(segments).filter(|segments| !segments.is_empty()));
        } else {
            make_room(&found, found.capacity(), 0, monitor)?;
            found.push(header.row(line, row, found.len() as i64 + 1)?);
        }
    }
    let whole = |problem: &str| InputError::Whole { format: FORMAT, problem: problem.to_owned() };
    let Some(header) = header else { return Err(whole("it has no header")) };
    // In the order in which trees come up.
    let mut of_tree: BTreeMap<Option<i64>, usize> = BTreeMap::new();
    for row in found {
        let group = *of_tree.entry(row.tree).or_insert_with(|| {
            groups.push(Vec::new());
            groups.len() - 1
        });
        groups[group].push(row);
    }
    if groups.is_empty() {
        return Err(whole("it has a header, but no cylinders; it may be cut off"));
    }
    let check = |found: &Found, scale| {
        let error = |TooLarge { part, expected, found: size }: TooLarge| {
            let column = match part {
                Part::Radius => Some(header.radius),
                Part::LowerRadius => header.lower_radius,
                Part::UpperRadius => header.upper_radius,
                Part::Length => header.length.filter(|_| found.row.along.is_some()),
                Part::Axis => None,
            };
            let column = column.map(|column| format!(" in column '{}'", header.titles[column]));
            // All segments of a tree stand in one line.
            let is_segment = header.dialect == CylinderDialect::Raycloudtools;
            let segment = is_segment.then(|| format!(" for segment {}", found.id));
            let place = [column, segment].into_iter().flatten().collect::<Vec<_>>().concat();
            wrong(found.line, expected + &place, &size)
        };
        found.row.check(scale).map_err(error)
    };
    CylinderTable::of(header.dialect, &groups, check, monitor)
}

impl Header {
    fn row(&self, line: usize, text: &str, number: i64) -> Result<Found, InputError> {
        let fields: Vec<&str> = fields(text, self.delimiter).collect();
        let count = self.titles.len();
        if fields.len() < count {
            let expected = format!("{count} columns as in the header");
            return Err(wrong(line, expected, &format!("{}", fields.len())));
        }
        let cells = self.cells(&fields, 0, line);
        let start = cells.place(self.start)?;
        let mut along = None;
        let end = match (self.end, self.axis, self.length) {
            (Some(end), _, _) => cells.place(end)?,
            (None, Some(axis), Some(length)) => {
                let length_m = cells.number(length)?;
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
        let end_radii_m = match (self.lower_radius, self.upper_radius) {
            (Some(lower), Some(upper)) => Some([cells.number(lower)?, cells.number(upper)?]),
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
            radius_m: cells.number(self.radius)?,
            end_radii_m,
            branch: of(self.branch)?,
            birth: self.birth.map(small).transpose()?,
            nodes,
        };
        Ok(Found { line, id, parent: of(self.parent)?, tree: of(self.tree)?, row })
    }

    /// The segments of a line of raycloudtools: none of a tree that is a root alone. So many bytes are held beside.
    fn line_of_tree(
        &self,
        line: usize,
        text: &str,
        held: u64,
        monitor: &dyn Monitor,
    ) -> Result<Vec<Found>, InputError> {
        let fields: Vec<&str> = fields(text.trim_end_matches([',', ';', ' ']), self.delimiter).collect();
        let attributes = self.start[0];
        let width = self.titles.len() - attributes;
        let count = fields.len().saturating_sub(attributes);
        if count == 0 || !count.is_multiple_of(width) {
            let expected = format!("{attributes} columns of the tree, then {width} for each segment");
            return Err(wrong(line, expected, &format!("{} columns", fields.len())));
        }
        let mut tips: Vec<DVec3> = Vec::new();
        let mut found: Vec<Found> = Vec::new();
        for (number, segment) in (0_i64..).zip(fields[attributes..].chunks(width)) {
            make_room(&found, found.capacity(), held, monitor)?;
            let cells = self.cells(segment, attributes, line);
            let local = |column: usize| column - attributes;
            let tip = cells.place(self.start.map(local))?;
            let radius_m = cells.number(local(self.radius))?;
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
        }
        Ok(found)
    }

    /// Fields of a row from column `first` on.
    fn cells<'a>(&'a self, fields: &'a [&'a str], first: usize, line: usize) -> Cells<'a> {
        let decimal_comma = self.delimiter != Some(',');
        Cells { fields, titles: &self.titles[first..], decimal_comma, line }
    }
}

/// The fields of a row, or of a part of it.
struct Cells<'a> {
    fields: &'a [&'a str],
    titles: &'a [String],
    /// `1,5` is one and a half.
    decimal_comma: bool,
    line: usize,
}

impl Cells<'_> {
    fn text(&self, column: usize) -> &str {
        self.fields.get(column).copied().unwrap_or_default()
    }

    fn wrong(&self, column: usize, expected: &str) -> InputError {
        let title = self.titles.get(column).map_or("", String::as_str);
        wrong(self.line, format!("{expected} in column '{title}'"), self.text(column))
    }

    fn number(&self, column: usize) -> Result<f64, InputError> {
        let text = self.text(column);
        let number = if self.decimal_comma { text.replacen(',', ".", 1).parse() } else { text.parse() };
        let number = number.map_err(|_| "a number").and_then(in_range);
        number.map_err(|expected| self.wrong(column, expected))
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
    fn errors_name_columns_as_the_file_does() {
        let head = "ID;parentID;startX;startY;startZ;endX;endY;endZ;Radius [m]\n";
        for (row, part) in [
            ("0;-1;0;0;0;0;0;a;0,1\n", "a number in column 'endZ', found 'a'"),
            ("0;-1;0;0;0;0;0;1;-0,1\n", "metres from 0 to 100 in column 'Radius [m]', found '-0.1'"),
            ("0;-1;0;0;0;0;0;1;0,1,2\n", "a number in column 'Radius [m]', found '0,1,2'"),
        ] {
            let error = read(&format!("{head}{row}")).unwrap_err().to_string();
            assert!(error.contains(&format!("line 2: expected {part}")), "{error}");
        }
        let error = read("a,x,y,z,radius,parent_id\n0,0,0,0,.1,-1,0,0,5000,.1,0\n").unwrap_err().to_string();
        assert!(error.contains("at most 1000 metres for segment 1, found '5000'"), "{error}");
        let error = read("ID,parentID,startX,startY,startZ,endX,endY,endZ,r\n").unwrap_err().to_string();
        assert!(
            error.contains("line 1: expected a column named radius_m") && error.ends_with("found 'r'"),
            "{error}"
        );
    }

    #[test]
    fn commas_are_decimal_where_others_part_the_columns() {
        let with_points = "id,parent,start_x,start_y,start_z,end_x,end_y,end_z,radius\n\
                           1,0,0.5,0,0,0.25,0,1.5,0.1\n2,1,0.25,0,1.5,0,0,2,0.05\n";
        let table = read(with_points).unwrap();
        for sign in [";", "\t"] {
            let text = with_points.replace(',', sign).replace('.', ",");
            assert_eq!(read(&text).as_ref(), Ok(&table), "{text}");
        }
        let ray = "height,x,y,z,radius,parent_id\n1.5,0,0,0,.1,-1,0,0,1.5,.1,0\n";
        let text = ray.replace(',', ";").replace('.', ",");
        assert_eq!(read(&text), read(ray));
    }

    #[test]
    fn trees_that_are_too_large_are_in_another_unit() {
        // A tree of 20 m, on a slope with a sapling 200 m below.
        let table = |unit: f64, radius_unit: f64| {
            let [half, thick, thin, below] = [10.0, 0.25, 0.1, -200.0].map(|x| x * unit);
            let [thick, thin] = [thick, thin].map(|radius| radius / unit * radius_unit);
            read(&format!(
                "id,parent,start_x,start_y,start_z,axis_x,axis_y,axis_z,length,radius\n\
                 1,0,0,0,0,0,0,1,{half},{thick}\n2,1,0,0,{half},0,0,1,{half},{thin}\n\
                 3,0,0,0,{below},0,0,1,{thick},{thin}\n"
            ))
        };
        let metres = table(1.0, 1.0).unwrap();
        assert_eq!((metres.scale, metres.trees[0][1].radius_m), (1.0, 0.1));
        for (unit, scale) in [(100.0, 0.01), (1000.0, 0.001)] {
            let found = table(unit, unit).unwrap();
            assert_eq!(found.scale, scale);
            for (a, b) in found.trees[0].iter().zip(&metres.trees[0]) {
                assert!((a.start - b.start).length() < 1e-9 && (a.end - b.end).length() < 1e-9, "{unit}");
                assert!((a.radius_m - b.radius_m).abs() < 1e-12, "{unit}");
            }
        }
        // A unit in which both are those of a tree there is not: sizes are checked as metres.
        assert_eq!(table(100.0, 1.0).unwrap().scale, 1.0);
        assert_eq!(table(1.0, 100.0).unwrap().scale, 1.0);
        assert!(
            table(1000.0, 1.0).unwrap_err().to_string().contains("metres from 0 to 1000 in column 'length'")
        );
        assert!(
            table(1.0, 1000.0).unwrap_err().to_string().contains("metres from 0 to 100 in column 'radius'")
        );
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
