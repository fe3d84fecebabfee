//! Reads points as rows of numbers: `x y z`, with any further columns; CSV and PTS are such files too.

use std::io::{BufRead, Read};

use glam::DVec3;

use super::gather::Gathering;
use super::table::{Layout, Titles};
use super::{Cloud, InputError, ROWS_PER_CHECK, coordinate, lines, quoted, text_of};
use crate::monitor::Monitor;

/// Reads rows of three or more numbers between spaces, tabs, commas or semicolons; columns after
/// the third are passed over, as are blank lines and comments (`#`, `//`). Before the first row
/// there may be a line with the number of rows, and one line of any text (a header, a title). A header or comment that
/// names `x`, `y` and `z`, or easting, northing and height, says which columns they are, and which tell trees apart
/// (`treeID`, `tree` …); [`Cloud::unnamed`] are the first three columns of one that names none of them. A comma
/// between digits is a decimal one where other signs part the columns. After as many rows as were announced another
/// number may announce more (PTS).
///
/// # Errors
/// [`InputError`] with the line: not UTF-8, fewer than three numbers, numbers that are not finite, a header that names two
/// of x, y and z; fewer rows than announced; no rows at all; no memory; cancelled.
pub fn read_xyz(bytes: &[u8], monitor: &dyn Monitor) -> Result<Cloud, InputError> {
    thin_xyz(bytes, None, monitor)
}

/// The same; of each cube with sides `cube` one point is kept.
pub(super) fn thin_xyz(bytes: &[u8], cube: Option<f64>, monitor: &dyn Monitor) -> Result<Cloud, InputError> {
    let mut rows = Rows::new(cube, monitor);
    for (line, row) in lines(text_of(bytes)?) {
        rows.row(line, row)?;
    }
    rows.finish()
}

/// The same of a stream, which is never held whole: lines end in line feeds.
pub(super) fn stream_xyz(
    mut stream: impl BufRead,
    cube: Option<f64>,
    monitor: &dyn Monitor,
) -> Result<Cloud, InputError> {
    let mut rows = Rows::new(cube, monitor);
    let mut row = Vec::new();
    let (mut done, mut line) = (0, 1);
    loop {
        row.clear();
        // No row is longer; what is would be held whole.
        let read = stream.by_ref().take(LONGEST_ROW).read_until(b'\n', &mut row);
        let read = read.map_err(|error| whole(format!("line {line}: {error}")))?;
        if read == 0 {
            return rows.finish();
        }
        if read as u64 == LONGEST_ROW {
            return Err(error(line, "a line feed within a million bytes", ""));
        }
        let opening: &[u8] = if line == 1 { "\u{feff}".as_bytes() } else { b"" };
        let bytes = row.strip_prefix(opening).unwrap_or(&row);
        let text = std::str::from_utf8(bytes).map_err(|error| InputError::NotUtf8 {
            line,
            byte: done + row.len() - bytes.len() + error.valid_up_to(),
        })?;
        rows.row(line, text)?;
        done += read;
        line += 1;
    }
}

/// More bytes than any row of a table has.
const LONGEST_ROW: u64 = 1 << 20;

/// Rows as they come.
struct Rows<'m> {
    points: Gathering<'m>,
    announced: Option<u64>,
    /// The line of any text, with its number.
    title: Option<(usize, String)>,
    /// The names of the columns that are taken for coordinates though nothing says so.
    unnamed: Option<[String; 3]>,
    /// What a header says, and how rows are to be read where that is not usual.
    header: Option<Layout>,
    layout: Option<Layout>,
}

impl<'m> Rows<'m> {
    fn new(cube: Option<f64>, monitor: &'m dyn Monitor) -> Self {
        let points = Gathering::new([], cube, monitor);
        Self { points, announced: None, title: None, unnamed: None, header: None, layout: None }
    }

    /// Takes a line, numbered from 1.
    fn row(&mut self, line: usize, row: &str) -> Result<(), InputError> {
        if line.is_multiple_of(ROWS_PER_CHECK) {
            self.points.monitor().check()?;
        }
        let row = row.trim();
        if row.is_empty() {
            return Ok(());
        }
        let came = self.points.came();
        if came == 0 && self.header.is_none() {
            self.header = Layout::of_header(row);
        }
        if is_comment(row) {
            return Ok(());
        }
        if came == 0 {
            let of_header = self.header.as_ref().and_then(|header| header.with_row(row));
            let layout = of_header.or_else(|| Layout::of_decimal_commas(row));
            self.layout = layout.filter(|layout| !layout.is_usual());
            self.points.set_columns(self.layout.iter().flat_map(Layout::trees));
            self.unnamed = self.columns_of_title(row)?;
        }
        let usual = || Ok((position(row)?, Vec::new()));
        match self.layout.as_ref().map_or_else(usual, |layout| layout.point(row)) {
            Ok((point, of_trees)) => self.points.push(point, |column| of_trees[column])?,
            Err(_)
                if came == 0
                    && self.announced.is_none()
                    && self.title.is_none()
                    && row.parse::<u64>().is_ok() =>
            {
                self.announced = row.parse::<u64>().ok();
            }
            Err(_) if came == 0 && self.title.is_none() && is_words(row) => {
                self.title = Some((line, row.to_owned()));
            }
            Err(_) if self.announced == Some(came) && row.parse::<u64>().is_ok() => {
                self.announced = row.parse::<u64>().ok().and_then(|more| more.checked_add(came));
            }
            Err(expected) => return Err(error(line, &expected, row)),
        }
        Ok(())
    }

    /// The first three columns by the line of text above `row`, the first of the table, if it names no coordinates.
    fn columns_of_title(&self, row: &str) -> Result<Option<[String; 3]>, InputError> {
        let (None, Some((line, title))) = (&self.header, &self.title) else { return Ok(None) };
        match Titles::of(title, row) {
            Some(Titles::Lack(expected)) => Err(error(*line, &expected, title)),
            Some(Titles::First(names)) => Ok(Some(names)),
            None => Ok(None),
        }
    }

    fn finish(self) -> Result<Cloud, InputError> {
        let found = self.points.came();
        if found == 0 {
            return Err(whole("it holds no points; expected rows of three numbers x y z".to_owned()));
        }
        match self.announced {
            Some(rows) if found < rows => Err(whole(format!(
                "its first line announces {rows} points, {found} follow: it may be cut off"
            ))),
            _ => Ok(Cloud { unnamed: self.unnamed, ..self.points.finish() }),
        }
    }
}

/// Whether a line is a comment.
pub(super) fn is_comment(line: &str) -> bool {
    line.starts_with('#') || line.starts_with("//")
}

/// The first three numbers of a row, or what was expected.
pub(super) fn position(row: &str) -> Result<DVec3, String> {
    let separator = |b: u8| b.is_ascii_whitespace() || b == b',' || b == b';';
    let bytes = row.as_bytes();
    let mut position = [0.0; 3];
    let mut at = 0;
    for (i, x) in position.iter_mut().enumerate() {
        while at < bytes.len() && separator(bytes[at]) {
            at += 1;
        }
        let start = at;
        while at < bytes.len() && !separator(bytes[at]) {
            at += 1;
        }
        if start == at {
            return Err(format!("3 numbers or more, there are {i}"));
        }
        // Separators are ASCII, so the ends lie between characters.
        *x = coordinate(&row[start..at]).map_err(|expected| format!("{expected} in column {}", i + 1))?;
    }
    Ok(DVec3::from(position))
}

/// Whether a line is a header and no broken row: its first word is no number, not even `nan`.
fn is_words(row: &str) -> bool {
    let first = row.split([' ', '\t', ',', ';']).next().unwrap_or_default();
    !starts_as_number(first) && first.parse::<f64>().is_err()
}

fn starts_as_number(row: &str) -> bool {
    row.starts_with(|c: char| c.is_ascii_digit() || matches!(c, '-' | '+' | '.'))
}

fn whole(problem: String) -> InputError {
    InputError::Whole { format: "XYZ", problem }
}

fn error(line: usize, expected: &str, found: &str) -> InputError {
    InputError::Line { format: "XYZ", line, expected: expected.to_owned(), found: quoted(found) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::monitor::Quiet;

    fn read(text: &str) -> Result<Vec<DVec3>, InputError> {
        Ok(read_xyz(text.as_bytes(), &Quiet)?.positions)
    }

    #[test]
    fn every_habit_gives_the_same_points() {
        let expected = [DVec3::new(1.5, -2.0, 3.0), DVec3::new(4.0, 5e-3, -6.25)];
        for text in [
            "1.5 -2 3\n4 5e-3 -6.25\n",
            "1.5\t-2\t3\t255\t0\t0\n4\t.005\t-6.25\t1\t2\t3",
            "x,y,z,intensity\n1.5,-2.0,3,0.5\n4,0.005,-6.25,abc\n",
            "//X;Y;Z\r\n1.5;-2;3\r\n\r\n4;5E-3;-6.25\r\n",
            "# made by a scanner\n  1.5 , -2 , 3  \n 4, 0.005, -6.25\n",
            "2\n1.5 -2 3\n4 0.005 -6.25\n",
            "2\na title\n1.5 -2 3 7\n4 0.005 -6.25 7\n",
            "1.5 -2 3\r4 0.005 -6.25\r",
            "1,5;-2;3,0\n4,0;0,005;-6,25\n",
            "1,5 -2,0 3,0\n4,0 0,005 -6,25\n",
            "id,z,x,y\n1,3,1.5,-2\n2,-6.25,4,0.005\n",
            "//R G B X Y Z\n0 0 0 1.5 -2 3\n0 0 0 4 0.005 -6.25\n",
            "name;\"X [m]\";\"Y [m]\";\"Z [m]\"\noak;1,5;-2;3\noak;4;0,005;-6,25\n",
            "1\n1.5 -2 3 0.5\n1\n4 0.005 -6.25 0.5\n",
        ] {
            assert_eq!(read(text).as_deref(), Ok(&expected[..]), "{text:?}");
        }
    }

    #[test]
    fn a_header_tells_which_column_tells_trees_apart() {
        for text in [
            "x,y,z,treeID\n1,2,3,4\n5,6,7,-1\n",
            "treeID;x;y;z\n4;1;2;3\n0;5;6;7\n",
            "//X Y Z intensity scalar_treeID\n1 2 3 0.5 4.0\n5 6 7 0.5 nan\n",
            "x;y;z;tree id\n1,0;2,0;3,0;4\n5,0;6,0;7,0;none\n",
        ] {
            let cloud = read_xyz(text.as_bytes(), &Quiet).unwrap();
            assert_eq!(cloud.positions, [DVec3::new(1.0, 2.0, 3.0), DVec3::new(5.0, 6.0, 7.0)], "{text}");
            assert_eq!(cloud.trees.first().map(|column| &column.numbers[..]), Some(&[4, 0][..]), "{text}");
        }
        let cloud = read_xyz(b"x,y,z,intensity\n1,2,3,4\n", &Quiet).unwrap();
        assert_eq!(cloud.trees, []);
    }

    #[test]
    fn columns_that_nothing_names_are_known_by_their_titles() {
        let unnamed = |text: &str| read_xyz(text.as_bytes(), &Quiet).unwrap().unnamed;
        let names = ["id", "lat", "lon"].map(str::to_owned);
        assert_eq!(unnamed("id,lat,lon,h\n1,2,3,4\n"), Some(names));
        for text in ["1 2 3\n", "x,y,z\n1,2,3\n", "a title\n1 2 3\n", "# a b c\n1 2 3\n"] {
            assert_eq!(unnamed(text), None, "{text}");
        }
        let thin = thin_xyz(b"id,lat,lon\n1,2,3\n", None, &Quiet).unwrap().thin(0.5, &Quiet).unwrap();
        assert!(thin.unnamed.is_some());
    }

    #[test]
    fn errors_carry_the_line_and_what_was_expected() {
        for (text, line, expected) in [
            ("1 2 3\n1 2\n", 2, "3 numbers or more, there are 2"),
            ("1 2 3\n\n# c\n1 nan 3\n", 4, "a finite number in column 2"),
            ("1 2 inf\n", 1, "a finite number in column 3"),
            ("nan nan nan\n1 2 3\n", 1, "a finite number in column 1"),
            ("1 2 3\n1 2 1e999\n", 2, "a finite number in column 3"),
            ("1 2 3\nC 1 2 3\n", 2, "a number in column 1"),
            ("a b c\nd e f\n1 2 3\n", 2, "a number in column 1"),
            ("1 2 3\n2e10 0 0\n", 2, "a coordinate within ±1e9 in column 1"),
            ("id,x,y,z\n1,2,3,4\n1,2,,4\n", 3, "a number in column 3"),
            ("1,5;2,25;3,0\n1,5;2.5.5;3\n", 2, "a number in column 2"),
            (
                "# of a plot\nid,X,Y\n1,2,3\n",
                2,
                "a column named z or height or elevation or altitude in the header, beside 'X' and 'Y'",
            ),
        ] {
            let found = read(text).unwrap_err();
            let InputError::Line { line: at, expected: said, .. } = &found else { panic!("{found}") };
            assert_eq!((*at, said.as_str()), (line, expected), "{text:?}");
        }
    }

    #[test]
    fn empty_cut_off_and_foreign_files() {
        assert_eq!(read(""), Err(InputError::Empty));
        assert!(matches!(read("# nothing\n"), Err(InputError::Whole { .. })));
        let error = read("3\n1 2 3\n4 5 6\n").unwrap_err();
        assert!(error.to_string().contains("announces 3 points, 2 follow"), "{error}");
        assert!(matches!(
            read_xyz(b"1 2 3\n4 5 \xe4\n", &Quiet),
            Err(InputError::NotUtf8 { line: 2, byte: 10 })
        ));
    }
}
