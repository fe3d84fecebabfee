//! Headers of tables of cylinders: which column is what, whose table it is, and what it lacks.

use super::{Up, quoted};
use crate::knob::excerpt;

/// Names that are taken, without unit and in small letters.
const PARENT: [&str; 3] = ["parentid", "parent_id", "parent"];
const RADIUS: [&str; 3] = ["radius_m", "radius", "radius_cyl"];
const LENGTH: [&str; 2] = ["length_m", "length"];

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
    /// The program's name.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Linden => "linden",
            Self::SimpleForest => "SimpleForest",
            Self::Rtwig => "rTwig",
            Self::Archi => "aRchi",
            Self::TreeQsm => "TreeQSM",
            Self::Raycloudtools => "raycloudtools",
        }
    }

    /// Which way is up in it.
    pub const fn up(self) -> Up {
        if matches!(self, Self::Linden) { Up::Y } else { Up::Z }
    }
}

/// Which column is what.
pub(super) struct Header {
    pub dialect: CylinderDialect,
    pub delimiter: Option<char>,
    /// The names of the columns as the file has them, printable.
    pub titles: Vec<String>,
    pub start: [usize; 3],
    pub end: Option<[usize; 3]>,
    pub axis: Option<[usize; 3]>,
    pub length: Option<usize>,
    pub radius: usize,
    pub id: Option<usize>,
    pub parent: Option<usize>,
    pub branch: Option<usize>,
    pub tree: Option<usize>,
    pub birth: Option<usize>,
    pub nodes: Option<[usize; 2]>,
    pub lower_radius: Option<usize>,
    pub upper_radius: Option<usize>,
}

/// What a header of cylinders lacks.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Lack {
    pub expected: String,
    /// What stands there, quoted.
    pub found: String,
}

impl Header {
    /// The columns that a line names. `None`: it is no header of a table of cylinders. Otherwise, that it is one without some
    /// column that such a table cannot be without.
    pub fn of(line: &str) -> Option<Result<Self, Lack>> {
        let names = Names::of(line);
        let columns = match names.cylinders().or_else(|| names.segments_of_trees())? {
            Ok(columns) => columns,
            Err(expected) => return Some(Err(Lack { expected, found: names.instead_of_radius(line) })),
        };
        let Columns { dialect, start, radius } = columns;
        let find = |known: &[&str]| names.find(known);
        Some(Ok(Self {
            dialect,
            start,
            radius,
            delimiter: names.delimiter,
            end: all(names.three("end")),
            axis: all(names.three("axis")),
            length: find(&LENGTH),
            id: find(&["id", "cyl_id"]),
            parent: find(&PARENT),
            branch: find(&["branchid", "axis_id", "branch_id", "branch"]),
            tree: find(&["treeid", "tree_id", "tree"]),
            birth: find(&["birth"]),
            nodes: find(&["parent_node"]).zip(find(&["node"])).map(|(lower, upper)| [lower, upper]),
            lower_radius: find(&["start_radius_m"]),
            upper_radius: find(&["end_radius_m"]),
            titles: names.titles,
        }))
    }
}

/// Columns that every table has.
struct Columns {
    dialect: CylinderDialect,
    start: [usize; 3],
    radius: usize,
}

/// The names of the columns of a table.
struct Names {
    delimiter: Option<char>,
    /// As the file has them.
    titles: Vec<String>,
    /// Without unit and in small letters.
    plain: Vec<String>,
    /// Some of them stand over three numbers.
    is_treeqsm: bool,
}

impl Names {
    fn of(line: &str) -> Self {
        let delimiter = ['\t', ';', ','].into_iter().find(|&sign| line.contains(sign));
        let (mut titles, mut plain, mut is_treeqsm) = (Vec::new(), Vec::new(), false);
        for title in fields(line, delimiter) {
            let name = title.split(['(', '[']).next().unwrap_or_default().trim().to_ascii_lowercase();
            let three = match name.as_str() {
                "start_point" => Some(["startx", "starty", "startz"]),
                "axis_direction" => Some(["axisx", "axisy", "axisz"]),
                _ => None,
            };
            is_treeqsm |= three.is_some();
            match three {
                Some(three) => plain.extend(three.map(str::to_owned)),
                None => plain.push(name),
            }
            titles.resize(plain.len(), excerpt(title));
        }
        Self { delimiter, titles, plain, is_treeqsm }
    }

    fn find(&self, known: &[&str]) -> Option<usize> {
        known.iter().find_map(|known| self.plain.iter().position(|name| name == known))
    }

    /// The columns of a place or a direction, as far as they are there.
    fn three(&self, prefix: &str) -> [Option<usize>; 3] {
        ["x", "y", "z"].map(|axis| {
            let names = spellings(prefix, axis);
            self.find(&[&names[0], &names[1], &names[2]])
        })
    }

    /// The columns of a table with a row for each cylinder, or what it lacks; `None` where this is no such table.
    fn cylinders(&self) -> Option<Result<Columns, String>> {
        let [start, end, axis] = ["start", "end", "axis"].map(|prefix| self.three(prefix));
        let (radius, parent, length) = (self.find(&RADIUS), self.find(&PARENT), self.find(&LENGTH));
        let count = |columns: [Option<usize>; 3]| columns.iter().flatten().count();
        let has_direction = count(axis) == 3;
        let is_one = count(start) + count(end) > 3
            || count(start) == 3 && (has_direction || radius.is_some() || parent.is_some())
            || has_direction && radius.is_some() && parent.is_some();
        if !is_one {
            return None;
        }
        let mut lacks = lacking("start", start);
        if all(end).is_none() && (all(axis).is_none() || length.is_none()) {
            if count(end) > 0 {
                lacks.extend(lacking("end", end));
            } else if count(axis) > 0 {
                lacks.extend(lacking("axis", axis));
                lacks.extend(length.is_none().then(|| LENGTH.join(" or ")));
            } else {
                lacks.push("endX, endY and endZ, or axis_x, axis_y, axis_z and length".to_owned());
            }
        }
        lacks.extend(radius.is_none().then(|| RADIUS.join(" or ")));
        lacks.extend(parent.is_none().then(|| "parentID or parent_id or parent".to_owned()));
        let dialect = self.dialect();
        match (all(start), radius) {
            (Some(start), Some(radius)) if lacks.is_empty() => Some(Ok(Columns { dialect, start, radius })),
            _ => Some(Err(expected(&lacks.join(", and one named "), dialect))),
        }
    }

    /// The same of a table with a line for each tree.
    fn segments_of_trees(&self) -> Option<Result<Columns, String>> {
        let x = self.find(&["x"])?;
        let parent = self.find(&PARENT)?;
        let is_one = self.plain.get(x..x + 3)? == ["x", "y", "z"]
            && matches!(self.delimiter, Some(',' | ';'))
            && parent > x;
        let dialect = CylinderDialect::Raycloudtools;
        if is_one && self.plain.get(x + 3).is_some_and(|name| name == "radius") {
            return Some(Ok(Columns { dialect, start: [x, x + 1, x + 2], radius: x + 3 }));
        }
        // Points may have parents too.
        let is_like_one = is_one && self.plain[parent] == "parent_id" && self.like_radius().is_some();
        is_like_one.then(|| Err(expected("radius right after x, y and z", dialect)))
    }

    fn dialect(&self) -> CylinderDialect {
        let has = |known: &[&str]| self.find(known).is_some();
        if has(&["start_x_m", "start_y_m"]) {
            CylinderDialect::Linden
        } else if self.is_treeqsm {
            CylinderDialect::TreeQsm
        } else if has(&["cyl_id"]) {
            CylinderDialect::Archi
        } else if has(&["parentid"]) {
            CylinderDialect::SimpleForest
        } else {
            CylinderDialect::Rtwig
        }
    }

    /// A column that may be meant for the radius.
    fn like_radius(&self) -> Option<usize> {
        let is_like = |name: &String| {
            name.contains("diam")
                || name.starts_with("rad")
                || name == "d"
                || name == "r"
                || name.starts_with("r_")
        };
        self.plain.iter().position(is_like)
    }

    /// What is found where something is missing: most often the radius under another name.
    fn instead_of_radius(&self, line: &str) -> String {
        match (self.find(&RADIUS), self.like_radius()) {
            (None, Some(column)) => {
                let (name, title) = (&self.plain[column], &self.titles[column]);
                let is_radius = name.starts_with('r');
                format!("'{title}'{}", if is_radius { "" } else { ", of which a radius is half" })
            }
            _ => quoted(line),
        }
    }
}

fn all([x, y, z]: [Option<usize>; 3]) -> Option<[usize; 3]> {
    Some([x?, y?, z?])
}

fn spellings(prefix: &str, axis: &str) -> [String; 3] {
    [format!("{prefix}{axis}"), format!("{prefix}_{axis}"), format!("{prefix}_{axis}_m")]
}

/// The names of those columns that are not there.
fn lacking(prefix: &str, columns: [Option<usize>; 3]) -> Vec<String> {
    let lacking = ["x", "y", "z"].into_iter().zip(columns).filter(|(_, column)| column.is_none());
    let names =
        |axis: &str| format!("{prefix}{} or {prefix}_{axis} or {prefix}_{axis}_m", axis.to_ascii_uppercase());
    lacking.map(|(axis, _)| names(axis)).collect()
}

fn expected(names: &str, dialect: CylinderDialect) -> String {
    format!("a column named {names} (the others are those of a table of cylinders of {})", dialect.name())
}

/// The fields of a row, or of a part of it.
pub(super) fn fields(row: &str, delimiter: Option<char>) -> impl Iterator<Item = &str> {
    let parts = row.split(move |c: char| delimiter.map_or(c.is_whitespace(), |sign| c == sign));
    parts
        .map(|part| part.trim().trim_matches('"').trim())
        .filter(move |part| delimiter.is_some() || !part.is_empty())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_without_a_column_that_it_needs_says_which() {
        let radius = "a column named radius_m or radius or radius_cyl";
        for (header, named, dialect, found) in [
            (
                "\"startX\",\"startY\",\"startZ\",\"endX\",\"endY\",\"endZ\",\"cyl_ID\",\"parent_ID\",\"Diameter\"",
                radius,
                "aRchi",
                "'Diameter', of which a radius is half",
            ),
            (
                "id,parent,start_x_m,start_y_m,start_z_m,axis_x,axis_y,axis_z,length_m,r_m",
                radius,
                "linden",
                "'r_m'",
            ),
            ("type,ID,parentID,startX,startY,startZ,endX,endY,endZ,r", radius, "SimpleForest", "'r'"),
            ("length (m)\tstart_point\taxis_direction\tparent\tR (m)", radius, "TreeQSM", "'R (m)'"),
            (
                "id,parent,start_x,start_y,start_z,end_x,end_y,end_z,thick",
                radius,
                "rTwig",
                "'id,parent,start_x",
            ),
            (
                "height,x,y,z,r,parent_id",
                "a column named radius right after x, y and z",
                "raycloudtools",
                "'r'",
            ),
            (
                "startX;startZ;endX;endY;endZ;radius;parentID",
                "a column named startY or start_y or start_y_m (",
                "SimpleForest",
                "'startX;startZ",
            ),
            (
                "start_x,start_y,start_z,end_x,end_y,radius,id",
                "a column named endZ or end_z or end_z_m, and one named parentID or parent_id or parent",
                "rTwig",
                "'start_x",
            ),
            (
                "start_x,start_y,start_z,axis_x,axis_y,axis_z,radius,parent",
                "a column named length_m or length (",
                "rTwig",
                "'start_x",
            ),
            ("start_x,start_y,start_z,radius,parent", "a column named endX, endY and endZ, or", "rTwig", ""),
        ] {
            let Some(Err(Lack { expected, found: instead })) = Header::of(header) else { panic!("{header}") };
            assert!(expected.starts_with(named), "{header}: {expected}");
            assert!(expected.contains(&format!("of cylinders of {dialect})")), "{header}: {expected}");
            assert!(instead.starts_with(found), "{header}: {instead}");
        }
        for header in [
            "x,y,z,r,g,b",
            "x,y,z,radius",
            "x,y,z,intensity,parent_id",
            "x y z radius parent_id",
            "start_x,start_y,start_z",
            "1,2,3",
            "",
        ] {
            assert!(Header::of(header).is_none(), "{header}");
        }
    }
}
