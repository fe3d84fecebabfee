//! Reads the models that `TreeQSM` saves in MATLAB's files (MAT-File Level 5): structures with a field `cylinder`, wherever
//! they stand in the file; or the flat variables of its version 2.0.
//!
//! Of the format (`MathWorks`, MAT-File Format, 2019) what such files hold is read: numbers of all types, structures, cells,
//! compressed variables, either order of bytes. Files of `-v7.3` are HDF5, and refused with advice.

use std::io::Read;

use flate2::read::ZlibDecoder;
use glam::DVec3;

use super::cylinder_header::CylinderDialect;
use super::cylinder_table::{CylinderRow, CylinderTable, Found, TooLarge};
use super::{InputError, READING, READING_ADVICE, in_range};
use crate::memory::{bytes_grown, bytes_of};
use crate::monitor::Monitor;

/// How a file of level 5 begins.
pub(super) const OPENING: &[u8] = b"MATLAB 5.0 MAT-file";
/// How a file of `-v7.3` begins, which is HDF5 behind that.
pub(super) const OPENING_HDF5: &[u8] = b"MATLAB 7.3 MAT-file";

const FORMAT: &str = "MAT";
const HEADER: usize = 128;

/// Structures in structures: far more than models have.
const MOST_DEPTH: u32 = 12;

/// The longest name of a field in bytes, with the zero behind it: MATLAB's has 63 letters at most.
const LONGEST_NAME: usize = 64;

/// No element of an array takes fewer bytes in the file.
const LEAST_ELEMENT: usize = 8;

/// Bytes that are unpacked between two looks at the monitor.
const CHUNK: usize = 1 << 16;

/// Types of data.
mod kind {
    pub const INT8: u32 = 1;
    pub const UINT8: u32 = 2;
    pub const INT16: u32 = 3;
    pub const UINT16: u32 = 4;
    pub const INT32: u32 = 5;
    pub const UINT32: u32 = 6;
    pub const SINGLE: u32 = 7;
    pub const DOUBLE: u32 = 9;
    pub const INT64: u32 = 12;
    pub const UINT64: u32 = 13;
    pub const MATRIX: u32 = 14;
    pub const COMPRESSED: u32 = 15;
}

/// Classes of arrays.
mod class {
    pub const CELL: u8 = 1;
    pub const STRUCT: u8 = 2;
    pub const DOUBLE: u8 = 6;
    pub const UINT64: u8 = 15;
}

/// Variables that hold models, the best first.
const BEST: [&str; 3] = ["OptQSM", "OptQSMs", "QSM"];

/// Names of a model's columns: of the structure, and of version 2.0.
const COLUMNS: [[&str; 2]; 6] = [
    ["radius", "Rad"],
    ["length", "Len"],
    ["start", "Sta"],
    ["axis", "Axe"],
    ["parent", "CPar"],
    ["branch", "BoC"],
];

/// Columns that a model cannot be without.
const NEEDED: usize = 5;

fn whole(problem: impl Into<String>) -> InputError {
    InputError::Whole { format: FORMAT, problem: problem.into() }
}

fn cut() -> InputError {
    whole("it ends before all that it announces; it may be cut off: copy or save it again")
}

/// A variable, or a part of one.
enum Array<'a> {
    Numbers(Numbers<'a>),
    Structures(Structures<'a>),
    Cells(Vec<Array<'a>>),
    Other,
}

/// Structures of the same fields.
struct Structures<'a> {
    names: Vec<&'a str>,
    /// Element after element, in the order of the names.
    values: Vec<Array<'a>>,
}

/// What of a variable is held while it is read.
struct Held<'m> {
    bytes: u64,
    monitor: &'m dyn Monitor,
}

impl Held<'_> {
    /// A list of as many items as the file announces, if its `rest` of so many bytes can have them.
    fn list<T>(&mut self, count: usize, rest: usize, least: usize) -> Result<Vec<T>, InputError> {
        if count > rest / least {
            return Err(cut());
        }
        self.monitor.check()?;
        self.bytes = self.bytes.saturating_add(bytes_of::<T>(count));
        self.monitor.admit(READING, self.bytes, READING_ADVICE)?;
        Ok(Vec::with_capacity(count))
    }
}

/// Numbers as they stand in the file.
#[derive(Clone, Copy)]
struct Numbers<'a> {
    rows: usize,
    columns: usize,
    kind: u32,
    data: &'a [u8],
    is_big: bool,
}

impl Numbers<'_> {
    /// Column by column.
    fn at(&self, row: usize, column: usize) -> Option<f64> {
        let index = column.checked_mul(self.rows)?.checked_add(row)?;
        let bytes = |size: usize| {
            let from = index.checked_mul(size)?;
            self.data.get(from..from.checked_add(size)?)
        };
        macro_rules! number {
            ($type:ty) => {{
                let bytes = bytes(size_of::<$type>())?.try_into().ok()?;
                if self.is_big { <$type>::from_be_bytes(bytes) } else { <$type>::from_le_bytes(bytes) }
            }};
        }
        Some(match self.kind {
            kind::INT8 => number!(i8).into(),
            kind::UINT8 => number!(u8).into(),
            kind::INT16 => number!(i16).into(),
            kind::UINT16 => number!(u16).into(),
            kind::INT32 => number!(i32).into(),
            kind::UINT32 => number!(u32).into(),
            kind::SINGLE => number!(f32).into(),
            kind::DOUBLE => number!(f64),
            kind::INT64 => number!(i64) as f64,
            kind::UINT64 => number!(u64) as f64,
            _ => return None,
        })
    }
}

/// Bytes that are read from the front.
#[derive(Clone, Copy)]
struct Bytes<'a> {
    rest: &'a [u8],
    is_big: bool,
}

impl<'a> Bytes<'a> {
    fn take(&mut self, count: usize) -> Result<&'a [u8], InputError> {
        let (taken, rest) = self.rest.split_at_checked(count).ok_or_else(cut)?;
        self.rest = rest;
        Ok(taken)
    }

    fn word(&mut self) -> Result<u32, InputError> {
        let bytes = self.take(4)?.try_into().map_err(|_| cut())?;
        Ok(if self.is_big { u32::from_be_bytes(bytes) } else { u32::from_le_bytes(bytes) })
    }

    /// The next element: its type and its data. Data of up to four bytes may stand in the tag.
    fn element(&mut self) -> Result<(u32, &'a [u8]), InputError> {
        let first = self.word()?;
        let (small_kind, small_size) = (first & 0xffff, (first >> 16) as usize);
        if small_size > 0 {
            let data = self.take(4)?;
            return Ok((small_kind, data.get(..small_size).ok_or_else(cut)?));
        }
        let size = self.word()? as usize;
        let data = self.take(size)?;
        // To the next eighth byte, which the last element of a file may lack.
        let padding = if first == kind::COMPRESSED { 0 } else { size.next_multiple_of(8) - size };
        self.rest = &self.rest[padding.min(self.rest.len())..];
        Ok((first, data))
    }

    fn of(self, data: &'a [u8]) -> Self {
        Self { rest: data, ..self }
    }

    /// The words of an element of whole numbers.
    fn words(self, data: &'a [u8]) -> Result<Vec<u32>, InputError> {
        let mut bytes = self.of(data);
        (0..data.len() / 4).map(|_| bytes.word()).collect()
    }

    /// An array: its name and what is in it.
    fn array(
        self,
        data: &'a [u8],
        depth: u32,
        held: &mut Held<'_>,
    ) -> Result<(String, Array<'a>), InputError> {
        if data.is_empty() {
            return Ok((String::new(), Array::Other));
        }
        if depth > MOST_DEPTH {
            return Err(whole("its structures are nested too deeply for a model of a tree"));
        }
        let mut bytes = self.of(data);
        let (_, flags) = bytes.element()?;
        let class = self.words(flags)?.first().map_or(0, |flags| (flags & 0xff) as u8);
        let (_, dimensions) = bytes.element()?;
        let dimensions: Vec<usize> = self.words(dimensions)?.into_iter().map(|n| n as usize).collect();
        let count = dimensions.iter().try_fold(1_usize, |all, &n| all.checked_mul(n)).ok_or_else(cut)?;
        let (_, name) = bytes.element()?;
        let name = String::from_utf8_lossy(name).into_owned();
        let array = match class {
            class::STRUCT => bytes.structures(count, depth, held)?,
            class::CELL => {
                let mut cells = held.list(count, bytes.rest.len(), LEAST_ELEMENT)?;
                for _ in 0..count {
                    let (_, data) = bytes.element()?;
                    cells.push(self.array(data, depth + 1, held)?.1);
                }
                Array::Cells(cells)
            }
            class::DOUBLE..=class::UINT64 => {
                let (kind, data) = bytes.element()?;
                let rows = dimensions.first().copied().unwrap_or(0);
                let columns = count.checked_div(rows).unwrap_or(0);
                Array::Numbers(Numbers { rows, columns, kind, data, is_big: self.is_big })
            }
            _ => Array::Other,
        };
        Ok((name, array))
    }

    fn structures(mut self, count: usize, depth: u32, held: &mut Held<'_>) -> Result<Array<'a>, InputError> {
        let (_, length) = self.element()?;
        let length = self.words(length)?.first().copied().unwrap_or(0) as usize;
        let (_, letters) = self.element()?;
        if length == 0 || letters.len() < length {
            return Ok(Array::Other);
        }
        if length > LONGEST_NAME {
            return Err(whole(format!(
                "names of fields take {length} bytes each, where MATLAB has {LONGEST_NAME} at most; it is damaged: \
                 copy or save it again"
            )));
        }
        let mut names = held.list(letters.len() / length, letters.len(), 1)?;
        for name in letters.chunks_exact(length) {
            let end = name.iter().position(|&byte| byte == 0).unwrap_or(length);
            // Names are ASCII; what is not is none that is looked for.
            names.push(std::str::from_utf8(&name[..end]).unwrap_or_default());
        }
        let all = count.checked_mul(names.len()).ok_or_else(cut)?;
        let mut values = held.list(all, self.rest.len(), LEAST_ELEMENT)?;
        for _ in 0..all {
            let (_, data) = self.element()?;
            values.push(self.array(data, depth + 1, held)?.1);
        }
        Ok(Array::Structures(Structures { names, values }))
    }
}

/// Unpacks a variable.
fn unpacked(data: &[u8], held: u64, monitor: &dyn Monitor) -> Result<Vec<u8>, InputError> {
    let mut decoder = ZlibDecoder::new(data);
    let mut bytes: Vec<u8> = Vec::new();
    let mut chunk = vec![0; CHUNK];
    loop {
        monitor.check()?;
        let count = decoder
            .read(&mut chunk)
            .map_err(|error| whole(format!("a variable cannot be unpacked ({error})")))?;
        if count == 0 {
            return Ok(bytes);
        }
        if bytes.len() + count > bytes.capacity() {
            let more = bytes_grown::<u8>(bytes.len() + count).saturating_add(held);
            monitor.admit(READING, more, READING_ADVICE)?;
        }
        bytes.extend_from_slice(&chunk[..count]);
    }
}

/// Reads the models of a file.
///
/// # Errors
/// [`InputError`]: HDF5, a file that is cut, no model, a model that is none, no memory, cancelled.
pub(super) fn read(bytes: &[u8], monitor: &dyn Monitor) -> Result<CylinderTable, InputError> {
    if bytes.starts_with(OPENING_HDF5) {
        return Err(whole(
            "it is of MATLAB's -v7.3, which is HDF5; save it with save('qsm.mat', 'QSM', '-v7')",
        ));
    }
    let order = bytes.get(HEADER - 2..HEADER).ok_or_else(cut)?;
    let is_big = match order {
        b"IM" => false,
        b"MI" => true,
        _ => return Err(whole("its header does not tell the order of its bytes")),
    };
    let mut rest = Bytes { rest: bytes.get(HEADER..).ok_or_else(cut)?, is_big };
    let mut of_variables: Vec<(String, Vec<Vec<Found>>)> = Vec::new();
    // Variables of version 2.0, which is read when nothing else is found: they stand side by side.
    let mut flat: Vec<(String, Vec<u8>)> = Vec::new();
    while !rest.rest.is_empty() {
        monitor.check()?;
        let (kind, data) = rest.element()?;
        let held: u64 = flat.iter().map(|(_, bytes)| bytes.len() as u64).sum();
        let own;
        let data = match kind {
            kind::COMPRESSED => {
                own = unpacked(data, held, monitor)?;
                let (kind, data) = Bytes { rest: &own, is_big }.element()?;
                if kind != kind::MATRIX {
                    continue;
                }
                data
            }
            kind::MATRIX => data,
            _ => continue,
        };
        // What was unpacked is held too, but counted before.
        let mut in_variable = Held { bytes: held, monitor };
        let (name, array) = rest.array(data, 0, &mut in_variable)?;
        let mut trees = Vec::new();
        if COLUMNS.iter().any(|names| names[1] == name) {
            monitor.admit(READING, held + data.len() as u64, READING_ADVICE)?;
            flat.push((name, data.to_vec()));
        } else {
            models(&array, &mut trees, monitor)?;
            of_variables.push((name, trees));
        }
    }
    let place = |name: &str| BEST.iter().position(|best| *best == name).unwrap_or(BEST.len());
    of_variables.retain(|(_, trees)| !trees.is_empty());
    let best = of_variables.iter().map(|(name, _)| place(name)).min();
    let is_best = |(name, _): &(String, Vec<Vec<Found>>)| Some(place(name)) == best;
    let mut trees: Vec<Vec<Found>> =
        of_variables.into_iter().filter(is_best).flat_map(|(_, trees)| trees).collect();
    if trees.is_empty() {
        let mut held = Held { bytes: flat.iter().map(|(_, bytes)| bytes.len() as u64).sum(), monitor };
        let names: Vec<&str> = flat.iter().map(|(name, _)| name.as_str()).collect();
        let mut values = Vec::with_capacity(flat.len());
        for (_, data) in &flat {
            values.push(Bytes { rest: &[], is_big }.array(data, 0, &mut held)?.1);
        }
        trees.extend(model(&names, &values, monitor)?);
    }
    if trees.is_empty() {
        return Err(whole(
            "no variable of it holds a model: expected a structure with the field cylinder, as TreeQSM has it (radius, \
             length, start, axis, parent)",
        ));
    }
    let check = |found: &Found, scale| {
        let error = |TooLarge { part, expected, found: size }: TooLarge| {
            let (row, name) = (found.line, part.name());
            whole(format!("cylinder {row}: expected {expected} as {name}, found {size}"))
        };
        found.row.check(scale).map_err(error)
    };
    let said = |error| match error {
        InputError::Line { line, expected, found, .. } => {
            whole(format!("cylinder {line}: expected {expected}, found {found}"))
        }
        other => other,
    };
    CylinderTable::of(CylinderDialect::TreeQsm, &trees, check, monitor).map_err(said)
}

/// All models in an array, however deep.
fn models(array: &Array<'_>, trees: &mut Vec<Vec<Found>>, monitor: &dyn Monitor) -> Result<(), InputError> {
    match array {
        Array::Structures(Structures { names, values }) => {
            // Models of one file are numbered in the order of the fields' names.
            let mut order: Vec<usize> = (0..names.len()).collect();
            order.sort_by_key(|&at| names[at]);
            for fields in values.chunks_exact(names.len()) {
                match model(names, fields, monitor)? {
                    Some(rows) => trees.push(rows),
                    None => {
                        for &at in &order {
                            models(&fields[at], trees, monitor)?;
                        }
                    }
                }
            }
        }
        Array::Cells(cells) => {
            for cell in cells {
                models(cell, trees, monitor)?;
            }
        }
        Array::Numbers(_) | Array::Other => {}
    }
    Ok(())
}

/// The cylinders that fields name; `None` where they are of something else, or there are none.
fn model(
    fields: &[&str],
    values: &[Array<'_>],
    monitor: &dyn Monitor,
) -> Result<Option<Vec<Found>>, InputError> {
    let find = |names: &[&str; 2]| {
        let found = fields.iter().zip(values).find(|(name, _)| names.contains(name));
        found.and_then(|(&name, array)| match array {
            Array::Numbers(numbers) => Some((name, *numbers)),
            _ => None,
        })
    };
    let found: Vec<Option<(&str, Numbers<'_>)>> = COLUMNS.iter().map(find).collect();
    let Some(needed) = found[..NEEDED].iter().copied().collect::<Option<Vec<_>>>() else { return Ok(None) };
    let [(_, radius), (_, length), (_, start), (_, axis), (_, parent)] = needed[..] else { return Ok(None) };
    let count = radius.rows.max(radius.columns);
    if count == 0 {
        return Ok(None);
    }
    monitor.admit(READING, bytes_grown::<(Found, CylinderRow)>(count), READING_ADVICE)?;
    for (name, numbers) in found.iter().flatten() {
        // Of version 2.0 BoC: the branch, its order, the place in it.
        let has_three = matches!(*name, "start" | "axis" | "Sta" | "Axe" | "BoC");
        let fits = if has_three {
            (numbers.rows, numbers.columns) == (count, 3)
        } else {
            numbers.rows.max(numbers.columns) == count && numbers.rows.min(numbers.columns) == 1
        };
        if !fits {
            let expected = format!("{count} x {}", if has_three { 3 } else { 1 });
            let (rows, columns) = (numbers.rows, numbers.columns);
            return Err(whole(format!("{name} is {rows} x {columns}, but radius says {expected}")));
        }
    }
    let cell = |(name, numbers): (&str, Numbers<'_>), row: usize, column: usize| {
        let number = if numbers.rows == count { numbers.at(row, column) } else { numbers.at(column, row) };
        let number = number.ok_or_else(cut)?;
        in_range(number).map_err(|expected| {
            whole(format!("cylinder {}: expected {expected} as {name}, found {number}", row + 1))
        })
    };
    let mut rows = Vec::with_capacity(count);
    for row in 0..count {
        let place = |numbers| -> Result<DVec3, InputError> {
            Ok(DVec3::new(cell(numbers, row, 0)?, cell(numbers, row, 1)?, cell(numbers, row, 2)?))
        };
        let (start, axis) = (place(("start", start))?, place(("axis", axis))?);
        let (radius_m, length_m) = (cell(("radius", radius), row, 0)?, cell(("length", length), row, 0)?);
        let id = |named, numbers| {
            let number = cell((named, numbers), row, 0)?;
            if number.fract() == 0.0 {
                return Ok(number as i64);
            }
            Err(whole(format!("cylinder {}: expected a whole number as {named}, found {number}", row + 1)))
        };
        let branch = found[NEEDED].map(|(_, branch)| id("branch", branch)).transpose()?;
        let unit = axis.try_normalize().filter(|_| length_m > 0.0).unwrap_or(DVec3::ZERO);
        let along = CylinderRow {
            parent: None,
            start,
            end: start + unit * length_m,
            along: Some((unit, length_m)),
            radius_m,
            end_radii_m: None,
            branch,
            birth: None,
            nodes: None,
        };
        let parent = Some(id("parent", parent)?);
        rows.push(Found { line: row + 1, id: row as i64 + 1, parent, tree: None, row: along });
    }
    Ok(Some(rows))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::monitor::testing::Limited;

    fn element(kind: u32, data: &[u8]) -> Vec<u8> {
        let mut bytes = [kind.to_le_bytes(), (data.len() as u32).to_le_bytes()].concat();
        bytes.extend(data);
        bytes.resize(bytes.len().next_multiple_of(8), 0);
        bytes
    }

    fn matrix(class: u8, count: u32, rest: &[Vec<u8>]) -> Vec<u8> {
        let dimensions = [1_u32.to_le_bytes(), count.to_le_bytes()].concat();
        let head = [
            element(kind::UINT32, &[class, 0, 0, 0, 0, 0, 0, 0]),
            element(kind::INT32, &dimensions),
            element(kind::INT8, b"QSM"),
        ];
        element(kind::MATRIX, &[head.concat(), rest.concat()].concat())
    }

    /// A file of an array of structures, whose fields are empty.
    fn structures(count: u32, length: u32, names: &[u8]) -> Vec<u8> {
        let fields = names.len() as u32 / length;
        let empty = element(kind::MATRIX, b"");
        let rest = [
            element(kind::INT32, &length.to_le_bytes()),
            element(kind::INT8, names),
            empty.repeat((count * fields) as usize),
        ];
        let mut bytes = OPENING.to_vec();
        bytes.resize(HEADER - 4, b' ');
        bytes.extend([0, 1]);
        bytes.extend(b"IM");
        bytes.extend(matrix(class::STRUCT, count, &rest));
        bytes
    }

    #[test]
    fn names_of_fields_are_no_longer_than_those_of_matlab() {
        let said = |length: u32| {
            let bytes = structures(2, length, &vec![b'a'; length as usize]);
            read(&bytes, &Limited(1 << 30)).unwrap_err().to_string()
        };
        assert!(said(64).contains("no variable of it holds a model"), "{}", said(64));
        assert!(said(65).contains("names of fields take 65 bytes each, where MATLAB has 64"), "{}", said(65));
        assert!(said(1 << 20).contains("names of fields take 1048576 bytes"), "{}", said(1 << 20));
    }

    #[test]
    fn many_structures_are_admitted_before_they_are_held() {
        let bytes = structures(20_000, 32, &[b'a'; 64]);
        let error = |limit: u64| read(&bytes, &Limited(limit)).unwrap_err();
        let needed = bytes_of::<Array<'_>>(40_000);
        assert!(matches!(error(needed), InputError::Memory(_)), "{:?}", error(needed));
        let said = error(2 * needed).to_string();
        assert!(said.contains("no variable of it holds a model"), "{said}");
        // More than the file can have.
        let mut cut = bytes.clone();
        cut.truncate(bytes.len() - 8);
        let error = read(&cut, &Limited(1 << 30)).unwrap_err().to_string();
        assert!(error.contains("it may be cut off"), "{error}");
    }
}
