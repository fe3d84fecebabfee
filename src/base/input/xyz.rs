//! Reads points as rows of numbers: `x y z`, with any further columns; CSV and PTS are such files too.

use std::io::{BufRead, Read};

use glam::DVec3;

use super::gather::Gathering;
use super::table::{Layout, Titles, lacks_place};
use super::{Cloud, InputError, ROWS_PER_CHECK, coordinate, lines, quoted, text_of};
use crate::monitor::Monitor;

/// Reads rows of three or more numbers between spaces, tabs, commas or semicolons; columns after
/// the third are passed over, as are blank lines and comments (`#`, `//`). Before the first row
/// there may be a line with the number of rows, and one line of any text (a header, a title). A header or comment that
/// names `x`, `y` and `z`, or easting, northing and height, says which columns they are, and which tell trees apart
/// (`treeID`, `tree` …); [`Cloud::unnamed`] are the first three columns of one that names none of them. A comma
/// between digits is a decimal one where other signs part the columns. Rows whose coordinates are empty, NA or NaN are left
/// out and counted. Without a header, where the first of four columns counts rows, the other three are x, y and z. After as many rows as were announced another
/// number may announce more (PTS).
///
/// # Errors
/// [`InputError`] with the line: not UTF-8, fewer than three numbers, numbers that are infinite, a header that names two
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

/// So many rows must be numbered by their first column to be counted by it, or as many as there are,
const NUMBERED: usize = 64;

/// which are at least so many.
const LEAST_NUMBERED: usize = 8;

/// Rows that are numbered one after another so far, with their lines.
struct Numbered {
    rows: Vec<(usize, String)>,
    next: u64,
}

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
    /// Whether that is a line of its own and no comment: rows have no more columns than it has names.
    is_header_sure: bool,
    layout: Option<Layout>,
    /// Those that are not read before it is known whether their first column counts them.
    numbered: Option<Numbered>,
    has_row_numbers: bool,
}

impl<'m> Rows<'m> {
    fn new(cube: Option<f64>, monitor: &'m dyn Monitor) -> Self {
        let points = Gathering::new([], cube, monitor);
        Self {
            points,
            announced: None,
            title: None,
            unnamed: None,
            header: None,
            is_header_sure: false,
            layout: None,
            numbered: Some(Numbered { rows: Vec::new(), next: 0 }),
            has_row_numbers: false,
        }
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
            self.is_header_sure = self.header.is_some() && !is_comment(row);
        }
        if is_comment(row) || self.hold(line, row)? {
            return Ok(());
        }
        self.read(line, row)
    }

    /// Whether a row is held back, since its first column may count rows.
    fn hold(&mut self, line: usize, row: &str) -> Result<bool, InputError> {
        let Some(numbered) = &mut self.numbered else { return Ok(false) };
        let is_first = numbered.rows.is_empty();
        let has_begun = self.points.came() + self.points.placeless() > 0 || self.header.is_some();
        if let Some((number, _)) = Layout::of_numbered_row(row)
            && !has_begun
            && (is_first || number == numbered.next)
        {
            numbered.rows.push((line, row.to_owned()));
            numbered.next = number.saturating_add(1);
            if numbered.rows.len() == NUMBERED {
                self.release()?;
            }
            return Ok(true);
        }
        if (has_begun || !is_first)
            && let Some(numbered) = self.numbered.take()
        {
            self.read_held(&numbered.rows)?;
        }
        Ok(false)
    }

    /// Reads what was held back as rows that are counted by their first column, if these are enough.
    fn release(&mut self) -> Result<(), InputError> {
        let Some(Numbered { rows, .. }) = self.numbered.take() else { return Ok(()) };
        let titled = match (rows.first(), &self.title) {
            (Some((_, row)), Some((_, title))) => Titles::of(title, row).is_some(),
            _ => false,
        };
        self.has_row_numbers = rows.len() >= LEAST_NUMBERED && !titled;
        if let Some((_, row)) = rows.first().filter(|_| self.has_row_numbers) {
            self.header = Layout::of_numbered_row(row).map(|(_, layout)| layout);
        }
        self.read_held(&rows)
    }

    fn read_held(&mut self, rows: &[(usize, String)]) -> Result<(), InputError> {
        rows.iter().try_for_each(|(line, row)| self.read(*line, row))
    }

    /// Reads a row that is no comment.
    fn read(&mut self, line: usize, row: &str) -> Result<(), InputError> {
        let came = self.points.came() + self.points.placeless();
        if let Some(header) = self.header.as_ref().filter(|_| self.is_header_sure)
            && let Some(expected) = header.surplus(row)
        {
            return Err(error(line, &expected, row));
        }
        if came == 0 {
            let of_header = match &self.header {
                Some(header) if self.has_row_numbers => Some(header.clone()),
                header => header.as_ref().and_then(|header| header.with_row(row)),
            };
            let layout = of_header.or_else(|| Layout::of_decimal_commas(row));
            self.layout = layout.filter(|layout| !layout.is_usual());
            self.points.set_columns(self.layout.iter().flat_map(Layout::trees));
            self.unnamed = self.columns_of_title(row)?;
        }
        let usual =
            || Ok((if row.contains('"') { quoted_position(row)? } else { position(row)? }, Vec::new()));
        match self.layout.as_ref().map_or_else(usual, |layout| layout.point(row)) {
            Ok((point, of_trees)) => self.points.push(point, |column| of_trees[column])?,
            Err(_) if self.layout.as_ref().map_or_else(|| lacks_place(row), |it| it.lacks_place(row)) => {
                self.points.pass_over();
            }
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

    fn finish(mut self) -> Result<Cloud, InputError> {
        self.release()?;
        let placeless = self.points.placeless();
        let found = self.points.came() + placeless;
        if found == 0 {
            return Err(whole("it holds no points; expected rows of three numbers x y z".to_owned()));
        }
        if found == placeless {
            return Err(whole(format!(
                "none of its {placeless} rows has three coordinates: some are empty, NA or NaN in each"
            )));
        }
        match self.announced {
            Some(rows) if found < rows => Err(whole(format!(
                "its first line announces {rows} points, {found} follow: it may be cut off"
            ))),
            _ => Ok(Cloud {
                unnamed: self.unnamed,
                has_row_numbers: self.has_row_numbers,
                ..self.points.finish()
            }),
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
        let mut signs = 0;
        while at < bytes.len() && separator(bytes[at]) {
            signs += usize::from(!bytes[at].is_ascii_whitespace());
            at += 1;
        }
        let start = at;
        while at < bytes.len() && !separator(bytes[at]) {
            at += 1;
        }
        if start == at {
            return Err(format!("3 numbers or more, there are {i}"));
        }
        // One sign parts two columns: between two there is nothing.
        if signs > usize::from(i > 0) {
            return Err(format!("a number in column {}", i + 1));
        }
        // Separators are ASCII, so the ends lie between characters.
        *x = coordinate(row[start..at].trim_matches('"'))
            .map_err(|expected| format!("{expected} in column {}", i + 1))?;
    }
    Ok(DVec3::from(position))
}

/// The same of a row with quotes.
fn quoted_position(row: &str) -> Result<DVec3, String> {
    Layout::usual(row).point(row).map(|(position, _)| position)
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
            "x,y,z\n\"1,5\",\"-2,0\",\"3,0\"\n\"4,0\",\"0,005\",\"-6,25\"\n",
            "\"1,5\",\"-2,0\",\"3,0\"\n\"4,0\",\"0,005\",\"-6,25\"\n",
            "x;y;z\n\"1,5\";\"-2,0\";\"3,0\"\n4;\"0,005\";\"-6,25\"\n",
            "x\ty\tz\n\"1,5\"\t\"-2,0\"\t\"3,0\"\n\"4,0\"\t\"0,005\"\t\"-6,25\"\n",
            "name,x,y,z\n\"oak, old\",1.5,-2,3\noak,4,0.005,-6.25\n",
            "\"1.5\",\"-2\",\"3\"\n\"4\",\"0.005\",\"-6.25\",\"a, b\"\n",
            "x,y,z,\n1.5,-2,3,\n4,0.005,-6.25\n",
            "x,y,z\n1.5,-2,3,\n4,0.005,-6.25,\n",
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
        let names = ["id", "a", "b"].map(str::to_owned);
        assert_eq!(unnamed("id,a,b,h\n1,2,3,4\n"), Some(names));
        for text in ["1 2 3\n", "x,y,z\n1,2,3\n", "a title\n1 2 3\n", "# a b c\n1 2 3\n"] {
            assert_eq!(unnamed(text), None, "{text}");
        }
        let thin = thin_xyz(b"id,a,b\n1,2,3\n", None, &Quiet).unwrap().thin(0.5, &Quiet).unwrap();
        assert!(thin.unnamed.is_some());
    }

    #[test]
    fn rows_without_a_place_are_left_out_and_counted() {
        for (text, rows) in [
            ("1 2 3\n\n# c\n1 nan 3\nNA 1 2\n4 5 6\n", 2),
            ("nan nan nan\n1 2 3\n4 5 6\n", 1),
            ("x,y,z,treeID\n1,2,3,1\n,,,2\n1,,3,1\nNaN,1,1,3\n4,5,6,1\n", 3),
            ("1,2,3,9\n1,,3,9\n4,5,6,9\n7,8,\n", 2),
            ("x;y;z\n1,0;2,0;3,0\n1,5;;2,0\n4,0;5,0;6,0\n", 1),
            ("\"x\",\"y\",\"z\"\n\"1\",\"2\",\"3\"\n\"1\",\"NA\",\"3\"\n\"4\",\"5\",\"6\"\n", 1),
        ] {
            let cloud = read_xyz(text.as_bytes(), &Quiet).unwrap();
            assert_eq!(cloud.positions, [DVec3::new(1.0, 2.0, 3.0), DVec3::new(4.0, 5.0, 6.0)], "{text}");
            assert_eq!(cloud.placeless_rows, rows, "{text}");
            assert_eq!(cloud.thin(0.5, &Quiet).unwrap().placeless_rows, rows, "{text}");
        }
        // As many rows as are announced.
        assert!(read_xyz(b"3\n1 2 3\n4 nan 6\n7 8 9\n", &Quiet).is_ok());
        let said = read_xyz(b"x,y,z\n1,,2\nNA,NA,NA\n", &Quiet).unwrap_err().to_string();
        assert!(said.contains("none of its 2 rows has three coordinates"), "{said}");
    }

    #[test]
    fn quoted_numbers_are_numbers() {
        let quoted = b"\"448123.2684\" \"5428000.5\" \"3\"\n\"1\" \"2\" \"3\"\n";
        assert_eq!(
            read_xyz(quoted, &Quiet).unwrap().positions[0],
            DVec3::new(448_123.268_4, 5_428_000.5, 3.0)
        );
        assert_eq!(read("\"1\",\"2.5\",\"3\"\n").as_deref(), Ok(&[DVec3::new(1.0, 2.5, 3.0)][..]));
    }

    #[test]
    fn a_first_column_that_counts_rows_is_no_coordinate() {
        let table = |count: usize, row: &dyn Fn(usize) -> String| -> String { (0..count).map(row).collect() };
        let place = |i: usize| DVec3::new(0.5 * i as f64, 0.25, 3.0);
        for (from, sign, count) in [(0, " ", 8), (1, ",", 64), (17, ";", 200), (1, "\t", 65)] {
            let row = |i: usize| {
                let p = place(i);
                [(from + i).to_string(), p.x.to_string(), p.y.to_string(), p.z.to_string()].join(sign) + "\n"
            };
            let cloud = read_xyz(table(count, &row).as_bytes(), &Quiet).unwrap();
            assert!(cloud.has_row_numbers, "{from}");
            assert_eq!(cloud.positions, (0..count).map(place).collect::<Vec<_>>(), "{from}");
            let thin = thin_xyz(table(count, &row).as_bytes(), Some(0.1), &Quiet).unwrap();
            assert_eq!(cloud.thin(0.1, &Quiet).unwrap(), thin);
            // As spreadsheets of many countries write it.
            if [";", "\t"].contains(&sign) {
                let with_fractions = |i: usize| {
                    let (index, place) = (from + i, place(i));
                    format!("{index}{sign}{:.2}{sign}{:.2}{sign}{:.2}\n", place.x, place.y, place.z)
                };
                let commas = table(count, &with_fractions).replace('.', ",");
                assert_eq!(read_xyz(commas.as_bytes(), &Quiet).unwrap(), cloud, "{commas}");
            }
        }
        // Too few, of a gap, of three or five columns, of whole numbers alone (a lattice), below a header.
        let usual: [(usize, &dyn Fn(usize) -> String); 6] = [
            (7, &|i| format!("{i} 0.5 1 2\n")),
            (30, &|i| format!("{} 0.5 1 2\n", if i == 20 { 99 } else { i })),
            (30, &|i| format!("{i} 0.5 1\n")),
            (30, &|i| format!("{i} 0.5 1 2 3\n")),
            (30, &|i| format!("{i} 1 2 3\n")),
            (30, &|i| if i == 0 { "x y z i\n".to_owned() } else { format!("{i} 0.5 1 2\n") }),
        ];
        for (count, row) in usual {
            let text = table(count, row);
            let cloud = read_xyz(text.as_bytes(), &Quiet).unwrap();
            assert!(!cloud.has_row_numbers && cloud.positions[1].x >= 1.0, "{text}");
        }
        // Errors keep their lines.
        let wrong = table(10, &|i| format!("{i} 0.5 1 2\n")) + "10 a 1 2\n";
        assert!(matches!(read(&wrong), Err(InputError::Line { line: 11, .. })));
    }

    #[test]
    fn errors_carry_the_line_and_what_was_expected() {
        for (text, line, expected) in [
            ("1 2 3\n1 2\n", 2, "3 numbers or more, there are 2"),
            ("1 2 inf\n", 1, "a finite number in column 3"),
            ("1 2 3\n1 nan inf\n", 2, "a finite number in column 2"),
            ("1 2 3\n1 2 1e999\n", 2, "a finite number in column 3"),
            ("1 2 3\nC 1 2 3\n", 2, "a number in column 1"),
            ("a b c\nd e f\n1 2 3\n", 2, "a number in column 1"),
            ("1 2 3\n2e10 0 0\n", 2, "a coordinate within ±1e9 in column 1"),
            ("id,x,y,z\n1,2,3,4\n1,2,-,4\n", 3, "a number in column 3"),
            ("id,x,y,z\n1,2,3,4\n1,2\n", 3, "a number in column 3"),
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
    fn rows_with_more_fields_than_the_header_are_refused_by_their_line() {
        for (text, line, count) in [
            ("x,y,z\n0,090,0,093,-0,001\n", 2, 6),
            ("x,y,z\n1,2,3\n1,2,3,4\n", 3, 4),
            ("x y z\n1 0.5 2 3\n", 2, 4),
            ("id;x;y;z\n1;1,5;2;3;4\n", 2, 5),
        ] {
            let found = read(text).unwrap_err().to_string();
            let expected = format!("there are {count}");
            assert!(
                found.contains(&format!("line {line}")) && found.contains(&expected),
                "{text:?}: {found}"
            );
        }
        // A comment may say less.
        assert!(read("# x y z\n1 2 3 255\n").is_ok());
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
