//! Reads points as rows of numbers: `x y z`, with any further columns; CSV and PTS are such files too.

use glam::DVec3;

use super::cloud::Columns;
use super::table::Layout;
use super::{Cloud, InputError, ROWS_PER_CHECK, coordinate, lines, make_room, quoted, text_of};
use crate::memory::bytes_of;
use crate::monitor::Monitor;

/// Reads rows of three or more numbers between spaces, tabs, commas or semicolons; columns after
/// the third are passed over, as are blank lines and comments (`#`, `//`). Before the first row
/// there may be a line with the number of rows, and one line of any text (a header, a title). A header or comment that
/// names `x`, `y` and `z` says which columns they are, and which tell trees apart (`treeID`, `tree` …). A comma
/// between digits is a decimal one where other signs part the columns. After as many rows as were announced another
/// number may announce more (PTS).
///
/// # Errors
/// [`InputError`] with the line: not UTF-8, fewer than three numbers, numbers that are not finite;
/// fewer rows than announced; no rows at all; no memory; cancelled.
pub fn read_xyz(bytes: &[u8], monitor: &dyn Monitor) -> Result<Cloud, InputError> {
    let mut points = Vec::new();
    let mut columns = Columns::default();
    let mut announced = None;
    let mut header_seen = false;
    let (mut header, mut layout): (Option<Layout>, Option<Layout>) = (None, None);
    for (line, row) in lines(text_of(bytes)?) {
        if line % ROWS_PER_CHECK == 0 {
            monitor.check()?;
        }
        let row = row.trim();
        if row.is_empty() {
            continue;
        }
        if points.is_empty() && header.is_none() {
            header = Layout::of_header(row);
        }
        if is_comment(row) {
            continue;
        }
        if points.is_empty() {
            let of_header = header.as_ref().and_then(|header| header.with_row(row));
            layout = of_header.or_else(|| Layout::of_decimal_commas(row)).filter(|layout| !layout.is_usual());
            columns = Columns::new(layout.iter().flat_map(Layout::trees));
        }
        let read =
            layout.as_ref().map_or_else(|| Ok((position(row)?, Vec::new())), |layout| layout.point(row));
        match read {
            Ok((point, of_trees)) => {
                columns.make_room(bytes_of::<DVec3>(points.capacity()), monitor)?;
                make_room(&points, points.capacity(), 0, monitor)?;
                points.push(point);
                for (column, value) in of_trees.into_iter().enumerate() {
                    columns.push(column, value);
                }
            }
            Err(_)
                if points.is_empty() && announced.is_none() && !header_seen && row.parse::<u64>().is_ok() =>
            {
                announced = row.parse::<u64>().ok();
            }
            Err(_) if points.is_empty() && !header_seen && is_words(row) => header_seen = true,
            Err(_) if announced == Some(points.len() as u64) && row.parse::<u64>().is_ok() => {
                announced = row.parse::<u64>().ok().and_then(|more| more.checked_add(points.len() as u64));
            }
            Err(expected) => return Err(error(line, &expected, row)),
        }
    }
    let whole = |problem: String| InputError::Whole { format: "XYZ", problem };
    if points.is_empty() {
        return Err(whole("it holds no points; expected rows of three numbers x y z".to_owned()));
    }
    match announced {
        Some(rows) if (points.len() as u64) < rows => {
            let found = points.len();
            Err(whole(format!("its first line announces {rows} points, {found} follow: it may be cut off")))
        }
        _ => {
            let (trees, leaves) = columns.finish();
            Ok(Cloud { positions: points, trees, leaves, ..Cloud::default() })
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
