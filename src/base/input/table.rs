//! How the rows of a table of points are to be read: which columns are x, y and z, and what a decimal comma is.

use std::borrow::Cow;

use glam::DVec3;

use super::cloud::is_read;
use super::coordinate;
use crate::knob::excerpt;

/// What x, y and z are called in headers, the likeliest first, without units and in small letters.
const NAMES: [&[&str]; 3] =
    [&["x", "easting"], &["y", "northing"], &["z", "height", "elevation", "altitude"]];

/// What degrees are called there.
const DEGREES: [&str; 6] = ["lon", "longitude", "long", "lng", "lat", "latitude"];

/// The layout of a table that is not just `x y z` and further columns.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Layout {
    /// Where x, y and z stand.
    columns: [usize; 3],
    /// What stands between columns; `None`: white space.
    delimiter: Option<char>,
    /// `1,5` is one and a half.
    decimal_comma: bool,
    /// Columns that the header names.
    named: usize,
    /// Columns that tell trees apart, with their names.
    trees: Vec<(usize, String)>,
}

impl Layout {
    /// The layout that a header tells: a line that names x, y and z, or easting, northing and height. `//X Y Z` of
    /// `CloudCompare` is one too.
    pub fn of_header(row: &str) -> Option<Self> {
        let row = row.trim_start_matches(['/', '#']).trim();
        let delimiter = delimiter(row, false);
        let names: Vec<String> = fields(row, delimiter).map(plain).collect();
        let [x, y, z] = coordinate_columns(&names);
        let titles = fields(row, delimiter).map(|title| title.trim_matches('"').trim().to_owned());
        let trees = titles.enumerate().filter(|(_, title)| is_read(title)).collect();
        Some(Self { columns: [x?, y?, z?], delimiter, decimal_comma: false, named: names.len(), trees })
    }

    /// The same for the rows below the header: their decimal commas may tell that what parts columns is another sign. `None`
    /// for a row of another number of columns, which the header says nothing of.
    pub fn with_row(&self, row: &str) -> Option<Self> {
        let layout = match Self::of_decimal_commas(row) {
            Some(found) => {
                Self { delimiter: found.delimiter, decimal_comma: found.decimal_comma, ..self.clone() }
            }
            None => Self { delimiter: delimiter(row, false), ..self.clone() },
        };
        (fields(row, layout.delimiter).count() == self.named).then_some(layout)
    }

    /// What is wrong with a row that has more fields than the header has names: nothing says which of them are x, y and z. An
    /// empty one at the end is none.
    pub fn surplus(&self, row: &str) -> Option<String> {
        let count = count(row, delimiter_of(row, self.delimiter));
        (self.named > 0 && count > self.named).then(|| {
            format!("{} columns as in the header, there are {count}: name them all, or put decimal commas in quotes", self.named)
        })
    }

    /// Whether x, y and z come first and nothing else counts, as without a header.
    pub fn is_usual(&self) -> bool {
        self.columns == [0, 1, 2] && !self.decimal_comma && self.trees.is_empty()
    }

    /// x, y and z between what parts the columns of a row.
    pub fn usual(row: &str) -> Self {
        let delimiter = delimiter(row, false);
        Self { columns: [0, 1, 2], delimiter, decimal_comma: false, named: 0, trees: Vec::new() }
    }

    /// The names of the columns that tell trees apart.
    pub fn trees(&self) -> impl Iterator<Item = String> {
        self.trees.iter().map(|(_, title)| title.clone())
    }

    /// The layout of rows with decimal commas, if this is one: between other separators, or in quotes between commas, digits on
    /// both sides of a comma.
    pub fn of_decimal_commas(row: &str) -> Option<Self> {
        let between_commas = row.contains('"') && delimiter(row, false) == Some(',');
        let delimiter = if between_commas { Some(',') } else { delimiter(row, true) };
        let is_decimal = |field: &str| {
            let parts = field.split_once(',');
            parts.is_some_and(|(whole, part)| {
                whole.ends_with(|c: char| c.is_ascii_digit())
                    && part.starts_with(|c: char| c.is_ascii_digit())
            })
        };
        let fields: Vec<&str> = fields(row, delimiter).collect();
        let looked_at = if between_commas { fields.len() } else { 3 };
        let decimals = fields.iter().take(looked_at).filter(|field| is_decimal(field)).count();
        // Between semicolons, and in quotes, a comma can be nothing else; between blanks, all three must have one.
        let least = if between_commas || delimiter == Some(';') { 1 } else { 3 };
        let is_one = fields.len() >= 3 && decimals >= least;
        is_one.then_some(Self {
            columns: [0, 1, 2],
            delimiter,
            decimal_comma: true,
            named: 0,
            trees: Vec::new(),
        })
    }

    /// The number of a row that stands first of four columns of numbers, if the others have fractions, by points or by
    /// decimal commas; with the layout of such rows.
    pub fn of_numbered_row(row: &str) -> Option<(u64, Self)> {
        let of = |decimal_comma: bool| {
            let delimiter = delimiter(row, decimal_comma);
            let parts: Vec<&str> = fields(row, delimiter).map(|field| field.trim_matches('"')).collect();
            let [number, place @ ..] = &parts[..] else { return None };
            let is_place = place.len() == 3
                && place.iter().all(|field| coordinate(&with_point(field, decimal_comma)).is_ok());
            let sign = if decimal_comma { ',' } else { '.' };
            let fractions = place.iter().filter(|field| field.contains(sign)).count();
            // Between semicolons a comma can be nothing else; between blanks, all must have one.
            let least = if decimal_comma && delimiter != Some(';') { 3 } else { 1 };
            let number = (is_place && fractions >= least).then(|| number.parse().ok()).flatten()?;
            let layout = Self { columns: [1, 2, 3], delimiter, decimal_comma, named: 0, trees: Vec::new() };
            Some((number, layout))
        };
        of(false).or_else(|| of(true))
    }

    /// Whether a row has all columns of x, y and z, some of them without a value, and is right otherwise.
    pub fn lacks_place(&self, row: &str) -> bool {
        let fields: Vec<&str> = fields(row, self.delimiter).collect();
        let mut lacks = false;
        self.columns.iter().all(|&column| {
            fields.get(column).is_some_and(|field| {
                let field = field.trim_matches('"').trim();
                let is_missing = is_missing(field);
                lacks |= is_missing;
                is_missing || coordinate(&field.replace(',', ".")).is_ok()
            })
        }) && lacks
    }

    /// The point of a row with what it says in the columns of [`Layout::trees`], NaN where that is no number; or what was
    /// expected.
    pub fn point(&self, row: &str) -> Result<(DVec3, Vec<f64>), String> {
        let mut position = [0.0; 3];
        let fields: Vec<&str> = fields(row, self.delimiter).collect();
        for (x, &column) in position.iter_mut().zip(&self.columns) {
            let field = fields.get(column).copied().unwrap_or_default().trim_matches('"');
            let found = coordinate(&with_point(field, self.decimal_comma));
            *x = found.map_err(|expected| format!("{expected} in column {}", column + 1))?;
        }
        let number = |(column, _): &(usize, String)| {
            let field = fields.get(*column).copied().unwrap_or_default().trim_matches('"');
            with_point(field, self.decimal_comma).parse().unwrap_or(f64::NAN)
        };
        Ok((DVec3::from(position), self.trees.iter().map(number).collect()))
    }
}

/// Whether a row without a header starts with x, y and z, some of them without a value.
pub(super) fn lacks_place(row: &str) -> bool {
    Layout::usual(row).lacks_place(row)
}

/// A number's text with a point where it has a decimal comma.
fn with_point(field: &str, decimal_comma: bool) -> Cow<'_, str> {
    if decimal_comma { field.replace(',', ".").into() } else { field.into() }
}

/// Whether a field says that there is no value, as programs write it.
fn is_missing(field: &str) -> bool {
    const WORDS: [&str; 9] = ["", "nan", "-nan", "na", "n/a", "null", "none", "nan(ind)", "-nan(ind)"];
    WORDS.iter().any(|word| field.eq_ignore_ascii_case(word))
}

/// What a line of words above a table that is no header of x, y and z says of the columns below it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Titles {
    /// It names two of x, y and z: what is expected for the third.
    Lack(String),
    /// It names no coordinates: the names of the first three columns, which are taken for them.
    First([String; 3]),
}

impl Titles {
    /// What `header` says of the first row below it. `None`: it is a title of the file and not of its columns, of which
    /// there are more or fewer.
    pub fn of(header: &str, row: &str) -> Option<Self> {
        let of_header = delimiter(header, false);
        let titles: Vec<&str> = fields(header, of_header).collect();
        let of_row =
            Layout::of_decimal_commas(row).map_or_else(|| delimiter(row, false), |row| row.delimiter);
        if titles.len() != fields(row, of_row).count() {
            return None;
        }
        let shown = |title: &str| excerpt(title.trim_matches('"').trim());
        let names: Vec<String> = titles.iter().copied().map(plain).collect();
        let columns = coordinate_columns(&names);
        let named: Vec<String> = columns.iter().flatten().map(|&column| shown(titles[column])).collect();
        let is_degrees = |name: &&String| DEGREES.contains(&name.as_str());
        if named.len() < 2
            && let Some(at) = names.iter().position(|name| is_degrees(&name))
        {
            return Some(Self::Lack(format!(
                "lengths instead of '{}', which is in degrees: reproject it to a map in metres first (pdal translate … \
                 filters.reprojection, cs2cs)",
                shown(titles[at])
            )));
        }
        match (columns.iter().position(Option::is_none), &named[..]) {
            (Some(lacking), [first, second]) => Some(Self::Lack(format!(
                "a column named {} in the header, beside '{first}' and '{second}'",
                NAMES[lacking].join(" or ")
            ))),
            (None, _) => None,
            _ => titles.get(..3).map(|first| Self::First([first[0], first[1], first[2]].map(shown))),
        }
    }
}

/// The columns of x, y and z among names without units, in small letters.
fn coordinate_columns(names: &[String]) -> [Option<usize>; 3] {
    NAMES.map(|known| known.iter().find_map(|name| names.iter().position(|found| found == name)))
}

/// What parts the columns of a row; signs in quotes part nothing.
fn delimiter(row: &str, decimal_comma: bool) -> Option<char> {
    let candidates: &[char] = if decimal_comma { &[';', '\t'] } else { &[';', ',', '\t'] };
    candidates.iter().copied().find(|&sign| row.contains(sign) && fields(row, Some(sign)).nth(1).is_some())
}

/// What parts the columns of a row, which below a header may be another sign than there.
fn delimiter_of(row: &str, of_header: Option<char>) -> Option<char> {
    match Layout::of_decimal_commas(row) {
        Some(found) => found.delimiter,
        None => of_header.filter(|&sign| row.contains(sign)).or_else(|| delimiter(row, false)),
    }
}

/// How many fields a row has, without an empty last one.
fn count(row: &str, delimiter: Option<char>) -> usize {
    let (mut count, mut is_last_empty) = (0, false);
    for field in fields(row, delimiter) {
        (count, is_last_empty) = (count + 1, field.is_empty());
    }
    count - usize::from(is_last_empty)
}

/// The fields of a row, with their quotes: what stands in these is one field, whatever signs are in it (RFC 4180).
fn fields(row: &str, delimiter: Option<char>) -> impl Iterator<Item = &str> {
    // With a sign between columns an empty one counts; between blanks there is none.
    let is_blank = delimiter.is_none();
    // Whether this is the beginning of a field, and whether that was opened by quotes. Two in a row, which stand for one
    // inside, close and open them.
    let (mut is_start, mut is_quoted) = (true, false);
    let parts = row.split(move |c: char| {
        if c == '"' && (is_start || is_quoted) {
            (is_start, is_quoted) = (is_quoted, !is_quoted);
        } else if !is_quoted {
            let is_end = delimiter.map_or(c.is_whitespace(), |sign| c == sign);
            is_start = is_end || is_start && c.is_whitespace();
            return is_end;
        }
        false
    });
    parts.map(str::trim).filter(move |field| !is_blank || !field.is_empty())
}

/// A name without quotes and unit, in small letters: `"X [m]"` and `x_m` are x.
fn plain(name: &str) -> String {
    let name = name.trim_matches('"').trim().to_ascii_lowercase();
    let end = name.find([' ', '[', '(', '_']).unwrap_or(name.len());
    match &name[end..] {
        "" | "_m" => name[..end].to_owned(),
        rest if rest.trim_start().starts_with(['[', '(']) => name[..end].to_owned(),
        _ => name,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn headers_tell_the_columns() {
        for (header, row, expected) in [
            ("id,x,y,z,intensity", "7,1.5,2,3,9", [1.5, 2.0, 3.0]),
            ("\"Z [m]\";\"X [m]\";\"Y [m]\"", "3;1,5;2,25", [1.5, 2.25, 3.0]),
            ("//X Y Z R G B", "1 2 3 0 0 0", [1.0, 2.0, 3.0]),
            ("tree\tx_m\ty_m\tz_m", "oak 7\t1\t2\t3", [1.0, 2.0, 3.0]),
            ("name,,x,y,z", "a,,1,2,3", [1.0, 2.0, 3.0]),
            ("id,Easting,Northing,Height", "7,1,2,3", [1.0, 2.0, 3.0]),
            ("ALTITUDE [m];northing (m);Easting_m", "3,5;2,0;1,0", [1.0, 2.0, 3.5]),
            ("X,Y,elevation", "1,2,3", [1.0, 2.0, 3.0]),
            // What is named z is z.
            ("height,X[m],Y[m],Z[m]", "9,1,2,3", [1.0, 2.0, 3.0]),
        ] {
            let layout = Layout::of_header(header).unwrap().with_row(row).unwrap();
            assert_eq!(layout.point(row).map(|(point, _)| point), Ok(DVec3::from(expected)), "{header}");
        }
        assert_eq!(Layout::of_header("columns: x y z").unwrap().with_row("1 2 3"), None);
        for header in ["a title", "1 2 3", "x y", "xx yy zz"] {
            assert_eq!(Layout::of_header(header), None, "{header}");
        }
    }

    #[test]
    fn what_stands_in_quotes_is_one_field() {
        for (row, sign, expected) in [
            (r#""0,090","0,093","-0,001""#, ',', &[r#""0,090""#, r#""0,093""#, r#""-0,001""#][..]),
            (r#"1, "a ""b"", c" ,2"#, ',', &["1", r#""a ""b"", c""#, "2"]),
            (r#""a;b";1;"#, ';', &[r#""a;b""#, "1", ""]),
            ("5\" pipe,1", ',', &["5\" pipe", "1"]),
            ("\"a\tb\"\t1", '\t', &["\"a\tb\"", "1"]),
        ] {
            assert_eq!(fields(row, Some(sign)).collect::<Vec<_>>(), expected, "{row}");
            assert_eq!(delimiter(row, false), Some(sign), "{row}");
        }
        assert_eq!(fields(r#""X [m]" "Y [m]" Z"#, None).count(), 3);
    }

    #[test]
    fn titles_without_coordinates_say_what_is_missing_or_taken() {
        let lacks = |expected: &str| Some(Titles::Lack(format!("a column named {expected}")));
        let first = |names: [&str; 3]| Some(Titles::First(names.map(str::to_owned)));
        for (header, row, expected) in [
            (
                "id,X,Y,intensity",
                "1,2,3,4",
                lacks("z or height or elevation or altitude in the header, beside 'X' and 'Y'"),
            ),
            (
                "\"Easting [m]\";Height;n",
                "1,5;2;3",
                lacks("y or northing in the header, beside 'Easting [m]' and 'Height'"),
            ),
            ("y z", "1 2", lacks("x or easting in the header, beside 'y' and 'z'")),
            ("id,a,b,h", "1,2,3,4", first(["id", "a", "b"])),
            ("a b c", "1,5 2,5 3,5", first(["a", "b", "c"])),
            // Of other columns than the table has, or of all three.
            ("a title", "1 2 3", None),
            ("a plot by x and y", "1 2 3", None),
            ("id,x,y,z", "1,2,3,4", None),
        ] {
            assert_eq!(Titles::of(header, row), expected, "{header}");
        }
    }

    #[test]
    fn degrees_are_no_lengths() {
        for (header, row) in
            [("lon,lat,height", "8.4,49.0,3"), ("id;Latitude [deg];Longitude;n", "1;49,0;8,4;3")]
        {
            let found = Titles::of(header, row);
            assert!(
                matches!(&found, Some(Titles::Lack(said)) if said.contains("degrees")),
                "{header}: {found:?}"
            );
        }
        // Beside lengths they are further columns.
        assert_eq!(Titles::of("x,y,z,lon,lat", "1,2,3,4,5"), None);
    }

    #[test]
    fn the_first_of_four_columns_may_count_rows() {
        for (row, number) in [
            ("7 0.5 0.25 3", Some(7)),
            ("7,0.5,0.25,3.0", Some(7)),
            ("7;0,5;0,25;3", Some(7)),
            ("7\t0,5\t0,25\t3,0", Some(7)),
            ("7 0,5 0,25 3,0", Some(7)),
            // Of whole numbers alone, of a fraction, of another number of columns.
            ("7;1;2;3", None),
            ("7\t0,5\t0,25\t3", None),
            ("7,5;0,5;0,25;3", None),
            ("7;0,5;0,25", None),
            ("7;0,5;0,25;3;1", None),
        ] {
            let found = Layout::of_numbered_row(row);
            assert_eq!(found.as_ref().map(|(number, _)| *number), number, "{row}");
            let point = found.map(|(_, layout)| layout.point(row).unwrap().0);
            assert_eq!(point, number.map(|_| DVec3::new(0.5, 0.25, 3.0)), "{row}");
        }
    }

    #[test]
    fn commas_between_digits_are_decimal_where_nothing_else_fits() {
        for (row, is_decimal) in [
            ("1,5;2,5;3,5", true),
            ("1,5;2;3", true),
            ("1,5 2,5 3,5 7", true),
            ("1,5\t2,5\t3,5", true),
            ("1,2,3", false),
            ("1.5, 2.5, 3.5", false),
            ("1;2;3", false),
        ] {
            assert_eq!(Layout::of_decimal_commas(row).is_some(), is_decimal, "{row}");
        }
    }
}
