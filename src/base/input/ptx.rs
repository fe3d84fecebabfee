//! Reads PTX, the text format of Leica's programs: one stand after another, each with its place.
//!
//! A stand has ten lines (columns, rows, its place, three axes, a matrix of four rows) and columns · rows points in its
//! frame: `x y z intensity [r g b]`. The matrix is for row vectors: its last row is the translation, and `p' = p·R + t`. Rows
//! `0 0 0` are pulses that nothing came back of, and are left out.

use glam::DVec3;

use super::gather::Gathering;
use super::{Cloud, InputError, ROWS_PER_CHECK, in_range, lines, quoted, text_of, xyz};
use crate::monitor::Monitor;

/// Whether a text begins as PTX does: two lines of a whole number each, then three lines or more of three numbers.
pub(super) fn is_ptx(text: &str) -> bool {
    let mut rows = text.lines().map(str::trim).filter(|row| !row.is_empty());
    let is_count = |row: Option<&str>| row.is_some_and(|row| row.parse::<u64>().is_ok());
    if !is_count(rows.next()) || !is_count(rows.next()) {
        return false;
    }
    let words = |row: Option<&str>| row.map_or(0, |row| row.split_whitespace().count());
    (0..4).all(|_| words(rows.next()) == 3) && (0..4).all(|_| words(rows.next()) == 4)
}

/// Reads the points of all stands; Z is up.
///
/// # Errors
/// [`InputError`] with the line: numbers that are none, fewer points than a stand announces, no points at all; not UTF-8; no
/// memory; cancelled.
pub fn read_ptx(bytes: &[u8], monitor: &dyn Monitor) -> Result<Cloud, InputError> {
    thin_ptx(bytes, None, monitor)
}

/// The same; of each cube with sides `cube` one point is kept.
pub(super) fn thin_ptx(bytes: &[u8], cube: Option<f64>, monitor: &dyn Monitor) -> Result<Cloud, InputError> {
    let mut points = Gathering::new([], cube, monitor);
    let mut rows = lines(text_of(bytes)?).filter(|(_, row)| !row.trim().is_empty()).peekable();
    let mut stand = 0;
    while rows.peek().is_some() {
        stand += 1;
        let mut next = |expected: &str| {
            rows.next().ok_or_else(|| whole(format!("stand {stand} ends before {expected}: it is cut off")))
        };
        let mut announced = 1_u64;
        for expected in ["its number of columns", "its number of rows"] {
            let (line, row) = next(expected)?;
            let number: u64 = row.trim().parse().map_err(|_| error(line, expected, row))?;
            announced = announced.saturating_mul(number);
        }
        for _ in 0..4 {
            let (line, row) = next("its place and axes")?;
            numbers::<3>(line, row)?;
        }
        let mut matrix = [[0.0; 4]; 4];
        for matrix_row in &mut matrix {
            let (line, row) = next("its matrix")?;
            *matrix_row = numbers(line, row)?;
        }
        let [x_axis, y_axis, z_axis, translation] = matrix.map(|[x, y, z, _]| DVec3::new(x, y, z));
        for count in 0..announced {
            let Some((line, row)) = rows.next() else {
                return Err(whole(format!(
                    "stand {stand} announces {announced} points, {count} follow: it is cut off"
                )));
            };
            if line % ROWS_PER_CHECK == 0 {
                monitor.check()?;
            }
            let point = xyz::position(row).map_err(|expected| error(line, &expected, row))?;
            if point == DVec3::ZERO {
                continue;
            }
            let placed = x_axis * point.x + y_axis * point.y + z_axis * point.z + translation;
            for x in placed.to_array() {
                in_range(x).map_err(|expected| error(line, &format!("{expected} after its matrix"), row))?;
            }
            points.push(placed, |_| f64::NAN)?;
        }
    }
    if points.came() == 0 {
        return Err(whole("no pulse of it came back: all its points are 0 0 0".to_owned()));
    }
    Ok(points.finish())
}

/// The numbers of a line, exactly so many or more.
fn numbers<const N: usize>(line: usize, row: &str) -> Result<[f64; N], InputError> {
    let mut words = row.split_whitespace();
    let mut found = [0.0; N];
    for x in &mut found {
        let number = words.next().and_then(|word| word.parse().ok());
        *x = number.ok_or_else(|| error(line, &format!("{N} numbers"), row))?;
    }
    Ok(found)
}

fn error(line: usize, expected: &str, found: &str) -> InputError {
    InputError::Line { format: "PTX", line, expected: expected.to_owned(), found: quoted(found) }
}

fn whole(problem: String) -> InputError {
    InputError::Whole { format: "PTX", problem }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::monitor::Quiet;

    /// The second stand is turned by a quarter about Z, and moved to a surveyed place.
    const TWO: &str = "2\n2\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n1 2 3 0.5 1 2 3\n\
                       0 0 0 0.5 0 0 0\n4 5 6 0.5 1 2 3\n7 8 9 0.5 0 0 0\n\
                       1\n2\n500000 0 0\n0 1 0\n-1 0 0\n0 0 1\n0 1 0 0\n-1 0 0 0\n0 0 1 0\n500000 10 1 1\n1 2 3 0.5\n0 0 0 0.5\n";

    #[test]
    fn stands_are_put_by_their_matrices() {
        assert!(is_ptx(TWO));
        let points = read_ptx(TWO.as_bytes(), &Quiet).unwrap().positions;
        assert_eq!(points.len(), 4);
        assert_eq!(points[1], DVec3::new(4.0, 5.0, 6.0));
        // (x, y) becomes (-y, x).
        assert_eq!(points[3], DVec3::new(499_998.0, 11.0, 4.0));
    }

    #[test]
    fn what_is_missing_is_said() {
        // Between two stands a file may end; a row may be cut behind its place.
        let second = TWO.find("1\n2\n500000").unwrap();
        let first_is_whole = TWO.find("7 8 9").unwrap() + "7 8 9".len()..=second;
        let both_are_whole = TWO.rfind("0 0 0 0.5").unwrap() + "0 0 0".len()..;
        for length in 0..=TWO.len() {
            let found = read_ptx(&TWO.as_bytes()[..length], &Quiet);
            let is_whole = first_is_whole.contains(&length) || both_are_whole.contains(&length);
            assert_eq!(found.is_ok(), is_whole, "{length}: {found:?}");
            let points = found.map_or(0, |cloud| cloud.positions.len());
            assert!(!is_whole || points == if length <= second { 3 } else { 4 }, "{length}: {points}");
        }
        let error = read_ptx(TWO.replace("4 5 6", "4 five 6").as_bytes(), &Quiet).unwrap_err().to_string();
        assert!(error.contains("line 13") && error.contains("column 2"), "{error}");
        assert!(!is_ptx("12\n1 2 3\n4 5 6\n") && !is_ptx("x y z\n1 2 3\n"));
    }
}
