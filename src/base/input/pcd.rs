//! Reads PCD, the format of the Point Cloud Library: ASCII, binary, and binary compressed by LZF.
//!
//! `VIEWPOINT` is where the scanner stood and moves nothing; rows with NaN are places without an echo and are left out; other
//! fields are passed over, but for those that tell trees apart, like `label`. What the header announces is held against the bytes that follow.

use glam::DVec3;

use super::cloud::is_read;
use super::gather::Gathering;
use super::{Cloud, InputError, READING, READING_ADVICE, ROWS_PER_CHECK, in_range, quoted};
use crate::memory::bytes_of;
use crate::monitor::Monitor;

/// How the points are written.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Encoding {
    Ascii,
    /// Point after point.
    Binary,
    /// LZF, field after field.
    Compressed,
}

/// A column of the points.
struct Field {
    name: String,
    size: usize,
    kind: char,
    count: usize,
}

struct Header {
    fields: Vec<Field>,
    points: usize,
    encoding: Encoding,
    /// Where the data begin, and on which line.
    data: usize,
    line: usize,
}

/// Most fields and values of one: far more than any cloud has.
const MOST: usize = 4096;

/// Reads the points of a PCD file; Z is up.
///
/// # Errors
/// [`InputError`] with the line: a header that lacks something, has no fields x, y, z or announces more than the file
/// holds; damaged data; no points; no memory; cancelled.
pub fn read_pcd(bytes: &[u8], monitor: &dyn Monitor) -> Result<Cloud, InputError> {
    thin_pcd(bytes, None, monitor)
}

/// The same; of each cube with sides `cube` one point is kept.
pub(super) fn thin_pcd(bytes: &[u8], cube: Option<f64>, monitor: &dyn Monitor) -> Result<Cloud, InputError> {
    let header = Header::read(bytes)?;
    let columns = header.columns()?;
    header.check_kinds(&columns)?;
    let mut points = Points::of(&header, cube, monitor);
    let body = &bytes[header.data..];
    match header.encoding {
        Encoding::Ascii => read_ascii(body, &header, columns, &mut points)?,
        Encoding::Binary => {
            let row = header.row_bytes();
            let needed = header.points.saturating_mul(row);
            if body.len() < needed {
                return Err(whole(&format!(
                    "{} points of {row} bytes are announced, {} bytes follow: it is cut off",
                    header.points,
                    body.len()
                )));
            }
            let place = |column: usize, point: usize| point * row + header.bytes_before(column);
            read_binary(body, &header, (columns, &place), &mut points)?;
        }
        Encoding::Compressed => {
            let raw = unpacked(body, header.points.saturating_mul(header.row_bytes()), monitor)?;
            let place = |column: usize, point: usize| {
                let Field { size, count, .. } = header.fields[column];
                header.bytes_before(column) * header.points + point * size * count
            };
            points.all = points.all.holding(bytes_of::<u8>(raw.len()));
            read_binary(&raw, &header, (columns, &place), &mut points)?;
        }
    }
    if points.all.came() == 0 {
        return Err(whole(&format!("none of its {} points has a place", header.points)));
    }
    Ok(points.all.finish())
}

/// What is read of the points.
struct Points<'m> {
    all: Gathering<'m>,
    /// The fields of its columns.
    fields: Vec<usize>,
}

impl<'m> Points<'m> {
    /// None yet, with the columns that tell trees apart.
    fn of(header: &Header, cube: Option<f64>, monitor: &'m dyn Monitor) -> Self {
        let fields = header.of_trees();
        let names = fields.iter().map(|&at| header.fields[at].name.clone());
        Self { all: Gathering::new(names, cube, monitor), fields }
    }

    /// Adds a point and what it says of its tree, unless its place is the NaN of one without an echo.
    fn push(&mut self, point: [f64; 3], of_tree: impl Fn(usize) -> f64) -> Result<(), Fault> {
        if point.iter().any(|x| x.is_nan()) {
            return Ok(());
        }
        for x in point {
            in_range(x).map_err(Fault::Place)?;
        }
        let added = self.all.push(DVec3::from(point), |column| of_tree(self.fields[column]));
        added.map_err(|error| Fault::Other(InputError::Memory(error)))
    }
}

impl Header {
    fn read(bytes: &[u8]) -> Result<Self, InputError> {
        let (mut names, mut sizes, mut kinds, mut counts): (Vec<String>, _, Vec<char>, Option<Vec<usize>>) =
            (Vec::new(), Vec::new(), Vec::new(), None);
        let (mut width, mut height, mut points) = (None, None, None);
        let mut at = 0;
        for line in 1.. {
            let rest = &bytes[at..];
            let Some(end) = rest.iter().position(|&byte| byte == b'\n') else { break };
            let text = String::from_utf8_lossy(&rest[..end]);
            at += end + 1;
            let text = text.trim();
            let (word, values) = text.split_once(char::is_whitespace).unwrap_or((text, ""));
            let numbers = || -> Result<Vec<usize>, InputError> {
                let of = |value: &str| value.parse().map_err(|_| error(line, "whole numbers", value));
                values.split_whitespace().map(of).collect()
            };
            let number = || numbers().map(|numbers| numbers.first().copied());
            match word.to_ascii_uppercase().as_str() {
                "FIELDS" | "COLUMNS" => names = values.split_whitespace().map(str::to_lowercase).collect(),
                "SIZE" => sizes = numbers()?,
                "TYPE" => kinds = values.split_whitespace().filter_map(|word| word.chars().next()).collect(),
                "COUNT" => counts = Some(numbers()?),
                "WIDTH" => width = number()?,
                "HEIGHT" => height = number()?,
                "POINTS" => points = number()?,
                "DATA" => {
                    let encoding = match values.trim() {
                        "ascii" => Encoding::Ascii,
                        "binary" => Encoding::Binary,
                        "binary_compressed" => Encoding::Compressed,
                        other => return Err(error(line, "ascii, binary or binary_compressed", other)),
                    };
                    let counts = counts.unwrap_or_else(|| vec![1; names.len()]);
                    let lengths = [sizes.len(), kinds.len(), counts.len()];
                    if names.is_empty() || lengths.iter().any(|&length| length != names.len()) {
                        return Err(whole("FIELDS, SIZE, TYPE and COUNT of its header differ in length"));
                    }
                    let is_usable = |n: &usize| (1..=MOST).contains(n);
                    if names.len() > MOST || !sizes.iter().chain(&counts).all(is_usable) {
                        return Err(whole("a SIZE or COUNT of its header is 0 or far too large"));
                    }
                    let product = || width.zip(height).map(|(w, h): (usize, usize)| w.saturating_mul(h));
                    let Some(points) = points.or_else(product) else {
                        return Err(whole("its header has neither POINTS nor WIDTH and HEIGHT"));
                    };
                    let fields = names.into_iter().zip(sizes).zip(kinds.into_iter().zip(counts));
                    let fields =
                        fields.map(|((name, size), (kind, count))| Field { name, size, kind, count });
                    return Ok(Self { fields: fields.collect(), points, encoding, data: at, line });
                }
                _ => {}
            }
        }
        Err(whole("its header has no line DATA; it is cut off"))
    }

    fn columns(&self) -> Result<[usize; 3], InputError> {
        let mut columns = [0; 3];
        for (column, name) in columns.iter_mut().zip(["x", "y", "z"]) {
            let found = self.fields.iter().position(|field| field.name == name);
            let Some(found) = found else {
                return Err(whole(&format!("it has no field {name}; FIELDS must name x, y and z")));
            };
            *column = found;
        }
        Ok(columns)
    }

    /// The fields that tell trees apart.
    fn of_trees(&self) -> Vec<usize> {
        let is_one = |&at: &usize| self.fields[at].count == 1 && is_read(&self.fields[at].name);
        (0..self.fields.len()).filter(is_one).collect()
    }

    /// Whether the numbers of all fields that are read are of a kind that there is; as text they are of any.
    fn check_kinds(&self, columns: &[usize]) -> Result<(), InputError> {
        for at in columns.iter().copied().chain(self.of_trees()) {
            let Field { name, size, kind, .. } = &self.fields[at];
            let is_known = matches!((kind, size), ('F', 4 | 8) | ('I' | 'U', 1 | 2 | 4 | 8));
            if self.encoding != Encoding::Ascii && !is_known {
                return Err(whole(&format!(
                    "its field {} is of type {} of {size} bytes; expected F of 4 or 8, or I or U of 1, 2, 4 or 8: \
                     save it again",
                    quoted(name),
                    quoted(&kind.to_string())
                )));
            }
        }
        Ok(())
    }

    fn row_bytes(&self) -> usize {
        self.bytes_before(self.fields.len())
    }

    fn bytes_before(&self, column: usize) -> usize {
        self.fields[..column].iter().map(|field| field.size * field.count).sum()
    }
}

fn read_ascii(
    body: &[u8],
    header: &Header,
    columns: [usize; 3],
    points: &mut Points<'_>,
) -> Result<(), InputError> {
    let monitor = points.all.monitor();
    let before = |column: usize| header.fields[..column].iter().map(|field| field.count).sum::<usize>();
    let places = columns.map(before);
    let mut rows = 0;
    for (line, row) in (header.line + 1..).zip(body.split(|&byte| byte == b'\n')) {
        if line % ROWS_PER_CHECK == 0 {
            monitor.check()?;
        }
        let row = String::from_utf8_lossy(row);
        if row.trim().is_empty() {
            continue;
        }
        if rows == header.points {
            break;
        }
        rows += 1;
        let words: Vec<&str> = row.split_whitespace().collect();
        let mut point = [0.0; 3];
        for (x, place) in point.iter_mut().zip(places) {
            let word = words.get(place).copied().unwrap_or_default();
            *x = word.parse().map_err(|_| error(line, &format!("a number in column {}", place + 1), &row))?;
        }
        let of_tree =
            |field: usize| words.get(before(field)).and_then(|word| word.parse().ok()).unwrap_or(f64::NAN);
        points.push(point, of_tree).map_err(|fault| fault.on(|expected| error(line, expected, &row)))?;
    }
    if rows < header.points {
        return Err(whole(&format!("{} points are announced, {rows} follow: it is cut off", header.points)));
    }
    Ok(())
}

fn read_binary(
    body: &[u8],
    header: &Header,
    (columns, place): ([usize; 3], &dyn Fn(usize, usize) -> usize),
    points: &mut Points<'_>,
) -> Result<(), InputError> {
    let monitor = points.all.monitor();
    for point in 0..header.points {
        if point % ROWS_PER_CHECK == 0 {
            monitor.check()?;
        }
        let value = |column: usize| {
            let Field { size, kind, .. } = header.fields[column];
            let at = place(column, point);
            body.get(at..at + size).and_then(|bytes| scalar(bytes, kind))
        };
        let mut position = [0.0; 3];
        for (x, column) in position.iter_mut().zip(columns) {
            *x =
                value(column).ok_or_else(|| whole(&format!("point {point}: the data end; it is cut off")))?;
        }
        let fault = |expected: &str| whole(&format!("point {point}: expected {expected}"));
        let of_tree = |field: usize| value(field).unwrap_or(f64::NAN);
        points.push(position, of_tree).map_err(|found| found.on(fault))?;
    }
    Ok(())
}

fn scalar(bytes: &[u8], kind: char) -> Option<f64> {
    Some(match (kind, bytes.len()) {
        ('F', 4) => f32::from_le_bytes(bytes.try_into().ok()?).into(),
        ('F', 8) => f64::from_le_bytes(bytes.try_into().ok()?),
        ('I', 1) => i8::from_le_bytes(bytes.try_into().ok()?).into(),
        ('I', 2) => i16::from_le_bytes(bytes.try_into().ok()?).into(),
        ('I', 4) => i32::from_le_bytes(bytes.try_into().ok()?).into(),
        ('I', 8) => i64::from_le_bytes(bytes.try_into().ok()?) as f64,
        ('U', 1) => bytes[0].into(),
        ('U', 2) => u16::from_le_bytes(bytes.try_into().ok()?).into(),
        ('U', 4) => u32::from_le_bytes(bytes.try_into().ok()?).into(),
        ('U', 8) => u64::from_le_bytes(bytes.try_into().ok()?) as f64,
        _ => return None,
    })
}

/// Why a point was not added.
enum Fault {
    Place(&'static str),
    Other(InputError),
}

impl Fault {
    fn on(self, place: impl FnOnce(&str) -> InputError) -> InputError {
        match self {
            Self::Place(expected) => place(expected),
            Self::Other(error) => error,
        }
    }
}

/// Decompresses LZF (M. Lehmann's liblzf): runs of literal bytes, and copies from before. Two numbers of 32 bits come first: of
/// bytes packed, of bytes unpacked, which must be `wanted`.
fn unpacked(body: &[u8], wanted: usize, monitor: &dyn Monitor) -> Result<Vec<u8>, InputError> {
    let cut_off = || whole("its compressed data end too early; it is cut off");
    let number = |at: usize| {
        body.get(at..at + 4)
            .and_then(|bytes| bytes.try_into().ok())
            .map(u32::from_le_bytes)
            .ok_or_else(cut_off)
    };
    let (packed, raw) = (number(0)? as usize, number(4)? as usize);
    if raw != wanted {
        return Err(whole(&format!("its data unpack to {raw} bytes, its header announces {wanted}")));
    }
    let packed = body.get(8..8_usize.saturating_add(packed)).ok_or_else(cut_off)?;
    // Three bytes become 264 at most.
    if raw / 88 > packed.len() {
        return Err(cut_off());
    }
    monitor.admit(READING, bytes_of::<u8>(raw), READING_ADVICE)?;
    let mut out: Vec<u8> = Vec::with_capacity(raw);
    let mut bytes = packed.iter().map(|&byte| usize::from(byte));
    let mut next = || bytes.next().ok_or_else(cut_off);
    while out.len() < raw {
        let control = next()?;
        if control < 32 {
            for _ in 0..=control {
                out.push(next()? as u8);
            }
            continue;
        }
        let length = if control >> 5 == 7 { 7 + next()? } else { control >> 5 } + 2;
        let back = ((control & 31) << 8 | next()?) + 1;
        let from = out.len().checked_sub(back).ok_or_else(|| whole("its compressed data are damaged"))?;
        for i in from..from + length {
            out.push(out[i]);
        }
    }
    if out.len() == raw { Ok(out) } else { Err(whole("its compressed data are damaged")) }
}

fn error(line: usize, expected: &str, found: &str) -> InputError {
    InputError::Line { format: "PCD", line, expected: expected.to_owned(), found: quoted(found) }
}

fn whole(problem: &str) -> InputError {
    InputError::Whole { format: "PCD", problem: problem.to_owned() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::monitor::Quiet;

    fn header(points: usize, data: &str) -> Vec<u8> {
        format!(
            "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS label x y z _\nSIZE 1 4 4 8 2\n\
             TYPE U F F F U\nCOUNT 1 1 1 1 3\nWIDTH {points}\nHEIGHT 1\nVIEWPOINT 9 9 9 1 0 0 0\nPOINTS {points}\nDATA {data}\n"
        )
        .into_bytes()
    }

    fn points(count: usize) -> Vec<DVec3> {
        (0..count).map(|i| DVec3::new(i as f64, 0.5 * i as f64, -(i as f64))).collect()
    }

    fn columns(point: &DVec3) -> [Vec<u8>; 5] {
        let (x, y) = (point.x as f32, point.y as f32);
        [
            vec![7],
            x.to_le_bytes().to_vec(),
            y.to_le_bytes().to_vec(),
            point.z.to_le_bytes().to_vec(),
            vec![0; 6],
        ]
    }

    fn binary(points: &[DVec3]) -> Vec<u8> {
        let rows = points.iter().flat_map(|point| columns(point).concat());
        header(points.len(), "binary").into_iter().chain(rows).collect()
    }

    /// Field after field, packed as literals only, or with copies where a byte stands four times.
    fn compressed(points: &[DVec3]) -> Vec<u8> {
        let raw: Vec<u8> =
            (0..5).flat_map(|field| points.iter().flat_map(move |p| columns(p)[field].clone())).collect();
        let mut packed = Vec::new();
        let mut at = 0;
        while at < raw.len() {
            let run = raw[at..].iter().take_while(|&&byte| byte == raw[at]).count().min(9);
            packed.extend([0, raw[at]]);
            at += 1;
            // A copy of what stands one before, of three to eight.
            if run >= 4 {
                packed.extend([((run - 3) as u8) << 5, 0]);
                at += run - 1;
            }
        }
        let mut bytes = header(points.len(), "binary_compressed");
        bytes.extend((packed.len() as u32).to_le_bytes());
        bytes.extend((raw.len() as u32).to_le_bytes());
        bytes.extend(packed);
        bytes
    }

    #[test]
    fn three_encodings_hold_the_same_points() {
        let points = points(50);
        let rows: Vec<String> = points.iter().map(|p| format!("7 {} {} {} 0 0 0\n", p.x, p.y, p.z)).collect();
        let rows = rows.concat();
        let ascii = [header(51, "ascii"), rows.into_bytes(), b"7 nan nan nan 0 0 0\n".to_vec()].concat();
        for (name, bytes) in [("ascii", ascii), ("binary", binary(&points)), ("lzf", compressed(&points))] {
            let cloud = read_pcd(&bytes, &Quiet).unwrap();
            assert_eq!(cloud.positions, points, "{name}");
            let trees: Vec<_> = cloud.trees.iter().map(|column| (&*column.name, column.counts())).collect();
            assert_eq!(trees, [("label", vec![(7, 50)])], "{name}");
            for length in 0..bytes.len() - 20 {
                assert!(read_pcd(&bytes[..length], &Quiet).is_err(), "{name} {length}");
            }
            for at in 0..bytes.len() {
                let mut bytes = bytes.clone();
                bytes[at] ^= 0x31;
                let _ = read_pcd(&bytes, &Quiet);
            }
        }
    }

    #[test]
    fn labels_are_read_whatever_whole_numbers_they_are() {
        let points = points(3);
        let read = |size: usize, kind: &str| {
            let head = String::from_utf8(header(3, "binary")).unwrap();
            let head = head
                .replace("SIZE 1", &format!("SIZE {size}"))
                .replace("TYPE U F", &format!("TYPE {kind} F"));
            let rows = points.iter().flat_map(|point| {
                let [label, place @ ..] = columns(point);
                [&[label, vec![0; size - 1]].concat()[..], &place.concat()].concat()
            });
            read_pcd(&head.into_bytes().into_iter().chain(rows).collect::<Vec<_>>(), &Quiet)
        };
        for (size, kind) in [(1, "I"), (1, "U"), (2, "I"), (2, "U"), (4, "I"), (4, "U"), (8, "I"), (8, "U")] {
            let cloud = read(size, kind).unwrap();
            assert_eq!(cloud.positions, points, "{kind} {size}");
            assert_eq!(cloud.trees[0].counts(), vec![(7, 3)], "{kind} {size}");
        }
        for (size, kind) in [(3, "U"), (16, "I"), (2, "F"), (4, "X")] {
            let error = read(size, kind).unwrap_err().to_string();
            let said = format!("its field 'label' is of type '{kind}' of {size} bytes; expected F of 4 or 8");
            assert!(error.contains(&said), "{error}");
        }
    }

    #[test]
    fn what_a_header_announces_must_be_there() {
        let bytes = header(1_000_000_000_000, "binary");
        let error = read_pcd(&bytes, &Quiet).unwrap_err().to_string();
        assert!(error.contains("1000000000000 points of 23 bytes"), "{error}");
        let text = String::from_utf8(header(1, "ascii")).unwrap();
        let error = read_pcd(text.replace(" x y", " a y").as_bytes(), &Quiet).unwrap_err().to_string();
        assert!(error.contains("no field x"), "{error}");
    }
}
