//! Reads Esri's ASCII grids (`.asc`): heights of a canopy above ground on a square grid, as airborne surveys have them.
//!
//! Six lines of a name and a number (`ncols`, `nrows`, `xllcorner` or `xllcenter`, `yllcorner` or `yllcenter`, `cellsize`,
//! and perhaps `NODATA_value`, −9999 without; NaN has no value in any case), then the values, row by row from the north. What a header announces is held
//! against the bytes that follow.

use glam::DVec3;

use super::{Cloud, InputError, READING, READING_ADVICE, ROWS_PER_CHECK, in_range, quoted, text_of};
use crate::memory::bytes_of;
use crate::monitor::Monitor;

/// Whether a text begins as such grids do.
pub(super) fn is_grid(text: &str) -> bool {
    let mut words = text.split_whitespace().map(str::to_ascii_lowercase);
    let mut is_count = |name| {
        words.next().is_some_and(|word| word == name)
            && words.next().is_some_and(|word| word.parse::<u64>().is_ok())
    };
    is_count("ncols") && is_count("nrows")
}

/// The lines before the values.
struct Header {
    columns: u64,
    rows: u64,
    /// The middle of the first cell of the last row.
    low: [f64; 2],
    cell: f64,
    no_data: f64,
}

/// Reads the cells that have a value, as points at their middles; Z is up.
///
/// # Errors
/// [`InputError`] with the line: a header that lacks something, numbers that are none, fewer or more values than it
/// announces, none at all; not UTF-8; no memory; cancelled.
pub fn read_grid(bytes: &[u8], monitor: &dyn Monitor) -> Result<Cloud, InputError> {
    let text = text_of(bytes)?;
    let mut lines = text.lines().enumerate().map(|(at, line)| (at + 1, line)).peekable();
    let header = Header::read(&mut lines)?;
    let count = header.columns.saturating_mul(header.rows);
    // A digit and a blank.
    if count > bytes.len() as u64 / 2 + 1 {
        return Err(whole(format!("it announces {count} cells and has fewer; it is cut off")));
    }
    monitor.admit(READING, bytes_of::<DVec3>(count as usize), READING_ADVICE)?;
    let mut positions = Vec::with_capacity(count as usize);
    let mut at = 0;
    for (line, row) in lines {
        for word in row.split_whitespace() {
            if at % ROWS_PER_CHECK as u64 == 0 {
                monitor.check()?;
            }
            if at == count {
                return Err(error(line, &format!("no more than {count} values"), word));
            }
            let height = word.parse::<f64>().map_err(|_| error(line, "a number", word))?;
            // What stands for none may be a number that no height can be: −3.4e38 is usual.
            if !height.is_nan() && height != header.no_data {
                let height = in_range(height).map_err(|expected| error(line, expected, word))?;
                let (column, row) = (at % header.columns, at / header.columns);
                let x = header.low[0] + column as f64 * header.cell;
                let y = header.low[1] + (header.rows - 1 - row) as f64 * header.cell;
                positions.push(DVec3::new(x, y, height));
            }
            at += 1;
        }
    }
    if at < count {
        return Err(whole(format!("it announces {count} cells, {at} follow: it is cut off")));
    }
    if positions.is_empty() {
        return Err(whole(format!("none of its {count} cells has a value")));
    }
    Ok(Cloud { positions, cell: Some(header.cell), ..Cloud::default() })
}

impl Header {
    fn read<'a>(
        lines: &mut std::iter::Peekable<impl Iterator<Item = (usize, &'a str)>>,
    ) -> Result<Self, InputError> {
        let (mut columns, mut rows, mut x, mut y, mut cell) = (None, None, None, None, None);
        let mut no_data = -9999.0;
        // `nan` and `inf` are values.
        let is_name = |row: &str| {
            let word = row.split_whitespace().next().unwrap_or_default();
            word.starts_with(|letter: char| letter.is_ascii_alphabetic()) && word.parse::<f64>().is_err()
        };
        while let Some((line, row)) = lines.next_if(|(_, row)| row.trim().is_empty() || is_name(row)) {
            let mut words = row.split_whitespace();
            let (Some(name), value) = (words.next(), words.next().unwrap_or_default()) else { continue };
            let count = || match value.parse::<u64>() {
                Ok(count) if (1..=u64::from(u32::MAX)).contains(&count) => Ok(Some(count)),
                _ => Err(error(line, "a whole number from 1", value)),
            };
            let number = || match value.parse::<f64>() {
                Ok(number) => in_range(number).map_err(|expected| error(line, expected, value)),
                Err(_) => Err(error(line, "a number", value)),
            };
            match name.to_ascii_lowercase().as_str() {
                "ncols" => columns = count()?,
                "nrows" => rows = count()?,
                "xllcorner" => x = Some((number()?, 0.5)),
                "xllcenter" => x = Some((number()?, 0.0)),
                "yllcorner" => y = Some((number()?, 0.5)),
                "yllcenter" => y = Some((number()?, 0.0)),
                "cellsize" => cell = Some(number()?),
                // Some programs write `nan`, which no cell equals: NaN is none in any case.
                "nodata_value" => no_data = value.parse().unwrap_or(no_data),
                "dx" | "dy" => {
                    return Err(whole("its cells are not square; resample it to one cellsize".to_owned()));
                }
                _ => {
                    return Err(error(
                        line,
                        "ncols, nrows, xllcorner, yllcorner, cellsize or NODATA_value",
                        name,
                    ));
                }
            }
        }
        let lacks = |name: &str| whole(format!("its header lacks {name}"));
        let cell = cell.ok_or_else(|| lacks("cellsize"))?;
        if cell <= 0.0 {
            return Err(whole(format!("its cellsize is {cell}; it must be above 0")));
        }
        let low = |from: Option<(f64, f64)>, name: &str| {
            from.map(|(at, cells)| at + cells * cell).ok_or_else(|| lacks(name))
        };
        Ok(Self {
            columns: columns.ok_or_else(|| lacks("ncols"))?,
            rows: rows.ok_or_else(|| lacks("nrows"))?,
            low: [low(x, "xllcorner")?, low(y, "yllcorner")?],
            cell,
            no_data,
        })
    }
}

fn whole(problem: String) -> InputError {
    InputError::Whole { format: "ASC", problem }
}

fn error(line: usize, expected: &str, found: &str) -> InputError {
    InputError::Line { format: "ASC", line, expected: expected.to_owned(), found: quoted(found) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::input::{InputKind, sniff};
    use crate::monitor::Quiet;

    const GRID: &str =
        "ncols 3\nnrows 2\nxllcorner 100\nyllcorner 50\ncellsize 2\nNODATA_value -1\n1 2.5 -1\n4 5 6\n";

    #[test]
    fn rows_run_from_the_north_and_cells_without_a_value_are_left_out() {
        let corner = read_grid(GRID.as_bytes(), &Quiet).unwrap();
        let expected = [
            [101.0, 53.0, 1.0],
            [103.0, 53.0, 2.5],
            [101.0, 51.0, 4.0],
            [103.0, 51.0, 5.0],
            [105.0, 51.0, 6.0],
        ];
        assert_eq!(corner.positions, expected.map(DVec3::from));
        assert_eq!(corner.cell, Some(2.0));
        // GDAL writes everything in one line, other programs the middle of the corner's cell.
        let centre = GRID.replace("xllcorner 100", "XLLCENTER 101").replace("yllcorner 50", "YLLCENTER 51");
        let centre = centre.replace("-1\n4", "-1 4").replace('\n', "\r\n");
        assert_eq!(read_grid(centre.as_bytes(), &Quiet).unwrap(), corner);
        assert_eq!(sniff(centre.as_bytes(), "chm.txt"), Ok(InputKind::HeightGrid));
        assert_eq!(sniff(b"ncols = 3\n", "a.toml"), Ok(InputKind::Preset));
    }

    #[test]
    fn cells_of_nan_have_no_value_whatever_stands_for_none() {
        let all = |text: &str| read_grid(text.as_bytes(), &Quiet).map(|cloud| cloud.positions);
        let expected = all(GRID).unwrap();
        for none in ["nan", "NaN", "-3.4028234663852886e+38", "inf", "-9999"] {
            let text = GRID.replace("NODATA_value -1", &format!("NODATA_value {none}"));
            assert_eq!(all(&text.replace("2.5 -1", &format!("2.5 {none}"))).unwrap(), expected, "{none}");
            assert_eq!(all(&text.replace("2.5 -1", "2.5 nan")).unwrap(), expected, "{none}");
            let empty = text.replace("1 2.5 -1\n4 5 6", "nan nan nan nan nan nan");
            let error = all(&empty).unwrap_err().to_string();
            assert!(error.contains("none of its 6 cells has a value"), "{none}: {error}");
        }
    }

    #[test]
    fn what_is_wrong_is_said_with_its_line() {
        for (from, to, said) in [
            ("5 6", "5", "it announces 6 cells, 5 follow"),
            ("5 6", "5 6 7", "line 8: expected no more than 6 values, found '7'"),
            ("2.5", "high", "line 7: expected a number, found 'high'"),
            ("ncols 3", "ncols 0", "line 1: expected a whole number from 1, found '0'"),
            ("nrows 2", "nrows 99999999", "it announces 299999997 cells and has fewer"),
            ("cellsize 2", "cellsize 0", "its cellsize is 0"),
            ("cellsize 2\n", "", "its header lacks cellsize"),
            ("cellsize 2", "dx 2\ndy 1", "not square"),
            ("xllcorner", "xll", "line 3: expected ncols, nrows"),
            ("1 2.5 -1\n4 5 6", "-1 -1 -1 -1 nan -1", "none of its 6 cells has a value"),
        ] {
            let text = GRID.replacen(from, to, 1);
            let error = read_grid(text.as_bytes(), &Quiet).unwrap_err().to_string();
            assert!(error.contains(said), "{text}: {error}");
        }
        for length in 0..GRID.len() - 7 {
            assert!(read_grid(&GRID.as_bytes()[..length], &Quiet).is_err(), "{length}");
        }
    }
}
