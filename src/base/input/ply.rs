//! Reads PLY (the Stanford polygon format, Turk 1994): ASCII, binary little- and big-endian.
//!
//! Our own reader rather than the crate ply-rs-bw 4.0.1, after trying that: an element without
//! properties lets 130 bytes make it push as many rows as the header says (30 million in 5 s, 4e9 and
//! the machine is out of memory); numbers like `.5` and `1.`, which other programs write, and
//! comments in Latin-1 stop it; and a generic row per vertex makes it a fifth as fast (20 MB/s of ASCII
//! against 106).
//!
//! What a header announces is held against the bytes that follow before anything is reserved: a row
//! of binary data takes at least its scalars and its lists' counts, a value of ASCII data two bytes.

use glam::DVec3;

use super::cloud::{Columns, Told, is_read};
use super::{
    InputError, LeafColumn, READING, READING_ADVICE, ROWS_PER_CHECK, TreeColumn, UnnumberedColumn, fan,
    in_range, line_at, make_room, quoted,
};
use crate::knob::printable;
use crate::memory::{OverMemory, bytes_grown, bytes_of};
use crate::monitor::{Cancelled, Monitor};

/// What linden uses of a PLY file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PlyData {
    /// The element `vertex`: its properties `x`, `y`, `z`, whatever their types.
    pub positions: Vec<DVec3>,
    /// The elements `face`, polygons as fans, and `tristrips`; indices of `positions`, each in range. Empty
    /// for points.
    pub faces: Vec<[u32; 3]>,
    /// Properties of the vertices that tell trees apart, the likeliest first.
    pub trees: Vec<TreeColumn>,
    /// As in [`Cloud::classes`](super::Cloud::classes).
    pub classes: Vec<TreeColumn>,
    /// As in [`Cloud::unnumbered`](super::Cloud::unnumbered).
    pub unnumbered: Vec<UnnumberedColumn>,
    /// The property of the vertices that tells wood from leaves.
    pub leaves: Option<LeafColumn>,
}

/// Values of vertices, a column for each property that was asked for.
pub type PlyColumns = Vec<Option<Vec<f32>>>;

/// The same with further scalar properties of the vertices, in the order of their names; `None` for those that the
/// file has not.
///
/// # Errors
/// As [`read_ply`].
pub fn read_ply_with(
    bytes: &[u8],
    names: &[&str],
    monitor: &dyn Monitor,
) -> Result<(PlyData, PlyColumns), InputError> {
    let mut columns: Vec<Column> = names.iter().map(|name| Column::new(name)).collect();
    let data = read(bytes, &mut columns, monitor)?;
    Ok((data, columns.into_iter().map(|column| column.index.map(|_| column.values)).collect()))
}

/// Further values of the vertices.
struct Column {
    name: String,
    /// Which property it is.
    index: Option<usize>,
    values: Vec<f32>,
}

impl Column {
    fn new(name: &str) -> Self {
        Self { name: name.to_owned(), index: None, values: Vec::new() }
    }

    fn find(&mut self, element: &Element) {
        let is_it =
            |property: &Property| property.name == self.name && matches!(property.kind, Kind::Scalar(_));
        self.index = element.properties.iter().position(is_it);
        if self.index.is_some() {
            self.values.reserve_exact(element.rows as usize);
        }
    }
}

/// Reads vertices, faces and triangle strips; further elements and properties, lists too, are passed over.
///
/// # Errors
/// [`InputError`] with the line or the row: a header that is none, announces more than the file
/// holds, knows unknown types, or has no scalar `x`, `y`, `z`; numbers that are not finite; indices of
/// no vertex; data that ends early; no memory; cancelled.
pub fn read_ply(bytes: &[u8], monitor: &dyn Monitor) -> Result<PlyData, InputError> {
    read(bytes, &mut [], monitor)
}

fn read(bytes: &[u8], columns: &mut [Column], monitor: &dyn Monitor) -> Result<PlyData, InputError> {
    let header = Header::read(bytes)?;
    let mut data = PlyData::default();
    let mut body = Body { bytes, at: header.end, encoding: header.encoding };
    for element in &header.elements {
        body.can_hold(element)?;
        match element.name.as_str() {
            "vertex" => read_vertices(&mut body, element, &mut data, columns, monitor)?,
            "face" | "tristrips" => {
                let held = bytes_of::<DVec3>(data.positions.capacity());
                read_faces(&mut body, element, &mut data.faces, held, monitor)?;
            }
            _ => skip(&mut body, element, monitor)?,
        }
    }
    let count = data.positions.len();
    if count == 0 {
        return Err(whole("it has no vertices"));
    }
    if let Some(index) = data.faces.iter().flatten().find(|&&index| index as usize >= count) {
        return Err(whole(&format!("a face names vertex {index}, the file has 0 to {}", count - 1)));
    }
    Ok(data)
}

/// Whether the header announces faces.
pub(super) fn announces_faces(bytes: &[u8]) -> Result<bool, InputError> {
    let is_surface = |element: &Element| matches!(&*element.name, "face" | "tristrips") && element.rows > 0;
    Ok(Header::read(bytes)?.elements.iter().any(is_surface))
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Encoding {
    Ascii,
    LittleEndian,
    BigEndian,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl Scalar {
    /// By the names of the format's paper, and by those with the number of bits.
    fn named(name: &str) -> Option<Self> {
        Some(match name {
            "char" | "int8" => Self::I8,
            "uchar" | "uint8" => Self::U8,
            "short" | "int16" => Self::I16,
            "ushort" | "uint16" => Self::U16,
            "int" | "int32" => Self::I32,
            "uint" | "uint32" => Self::U32,
            "float" | "float32" => Self::F32,
            "double" | "float64" => Self::F64,
            _ => return None,
        })
    }

    const fn bytes(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }

    const fn is_integer(self) -> bool {
        !matches!(self, Self::F32 | Self::F64)
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Scalar(Scalar),
    List { count: Scalar, item: Scalar },
}

struct Property {
    name: String,
    kind: Kind,
}

struct Element {
    name: String,
    rows: u64,
    properties: Vec<Property>,
}

impl Element {
    fn error(&self, row: u64, problem: impl Into<String>) -> InputError {
        InputError::Row { element: printable(&self.name), row, rows: self.rows, problem: problem.into() }
    }
}

struct Header {
    encoding: Encoding,
    elements: Vec<Element>,
    /// Where the data starts.
    end: usize,
}

/// Longer lines are no header; this ends the search in binary junk early.
const LINE_LIMIT: usize = 1 << 16;

/// Elements and properties together; names are compared with all before, so there must be an end.
const DECLARATION_LIMIT: usize = 4096;

impl Header {
    fn read(bytes: &[u8]) -> Result<Self, InputError> {
        let mut at = 0;
        let mut encoding = None;
        let mut elements: Vec<Element> = Vec::new();
        let mut declarations = 0;
        for line in 1.. {
            let (text, next) = header_line(bytes, at)
                .ok_or_else(|| whole("its header has no line 'end_header': it is cut off, or no PLY file"))?;
            at = next;
            let wrong = |expected: &str| line_error(line, expected, &text);
            let words: Vec<&str> = text.split_ascii_whitespace().collect();
            declarations += usize::from(matches!(words[..], ["element" | "property", ..]));
            if declarations > DECLARATION_LIMIT {
                return Err(wrong("no more than 4096 elements and properties"));
            }
            match words[..] {
                ["ply"] if line == 1 => {}
                _ if line == 1 => return Err(wrong("'ply'")),
                [] | ["comment" | "obj_info", ..] => {}
                ["format", name, "1.0"] => {
                    encoding = Some(match name {
                        "ascii" => Encoding::Ascii,
                        "binary_little_endian" => Encoding::LittleEndian,
                        "binary_big_endian" => Encoding::BigEndian,
                        _ => return Err(wrong("ascii, binary_little_endian or binary_big_endian")),
                    });
                }
                ["format", ..] => return Err(wrong("'format NAME 1.0'")),
                ["element", name, rows] => {
                    let rows = rows.parse().map_err(|_| wrong("'element NAME COUNT', a whole number"))?;
                    if elements.iter().any(|element| element.name == name) {
                        return Err(wrong("an element that was not there before"));
                    }
                    elements.push(Element { name: name.to_owned(), rows, properties: Vec::new() });
                }
                ["property", ref rest @ ..] => {
                    let element =
                        elements.last_mut().ok_or_else(|| wrong("an element before its properties"))?;
                    let (name, kind) = property(rest).map_err(wrong)?;
                    if element.properties.iter().any(|property| property.name == name) {
                        return Err(wrong("a property that was not there before"));
                    }
                    element.properties.push(Property { name: name.to_owned(), kind });
                }
                ["end_header"] => break,
                _ => return Err(wrong("format, comment, obj_info, element, property or end_header")),
            }
        }
        let encoding = encoding.ok_or_else(|| whole("its header has no line 'format'"))?;
        if elements.iter().all(|element| element.name != "vertex") {
            return Err(whole("its header has no element 'vertex'"));
        }
        Ok(Self { encoding, elements, end: at })
    }
}

/// One line of the header and where the next one starts. Comments may be in any encoding.
fn header_line(bytes: &[u8], at: usize) -> Option<(String, usize)> {
    let rest = &bytes[at..bytes.len().min(at + LINE_LIMIT)];
    let end = rest.iter().position(|&b| b == b'\n' || b == b'\r')?;
    let pair = rest[end] == b'\r' && bytes.get(at + end + 1) == Some(&b'\n');
    Some((String::from_utf8_lossy(&rest[..end]).into_owned(), at + end + 1 + usize::from(pair)))
}

fn property<'a>(words: &[&'a str]) -> Result<(&'a str, Kind), &'static str> {
    const TYPES: &str = "a type: char, uchar, short, ushort, int, uint, float, double";
    let scalar = |name: &str| Scalar::named(name).ok_or(TYPES);
    match *words {
        ["list", count, item, name] => {
            let (count, item) = (scalar(count)?, scalar(item)?);
            if !count.is_integer() {
                return Err("a list whose count is a whole number");
            }
            Ok((name, Kind::List { count, item }))
        }
        [kind, name] => Ok((name, Kind::Scalar(scalar(kind)?))),
        _ => Err("'property TYPE NAME' or 'property list TYPE TYPE NAME'"),
    }
}

/// The data behind the header, read value by value.
struct Body<'a> {
    bytes: &'a [u8],
    at: usize,
    encoding: Encoding,
}

impl<'a> Body<'a> {
    fn left(&self) -> usize {
        self.bytes.len() - self.at
    }

    /// Refuses an element for which the file is too short whatever its lists hold.
    fn can_hold(&self, element: &Element) -> Result<(), InputError> {
        let least = |property: &Property| match (self.encoding, property.kind) {
            // A digit and a separator.
            (Encoding::Ascii, _) => 2,
            (_, Kind::Scalar(scalar) | Kind::List { count: scalar, .. }) => scalar.bytes(),
        };
        let row: usize = element.properties.iter().map(least).sum();
        // The last value of a file needs no separator behind it.
        let left = self.left() as u64 + 1;
        if element.rows.checked_mul(row as u64).is_some_and(|needed| needed <= left) {
            return Ok(());
        }
        Err(whole(&format!(
            "its header announces {} of the element '{}', at least {row} bytes each, and {} bytes are left: \
             it is cut off, or its header is wrong",
            element.rows,
            printable(&element.name),
            self.left(),
        )))
    }

    fn take<const N: usize>(&mut self) -> Result<[u8; N], String> {
        let bytes = self.bytes[self.at..].first_chunk().ok_or("the data ends here")?;
        self.at += N;
        Ok(*bytes)
    }

    fn word(&mut self) -> Result<&'a str, String> {
        let rest = &self.bytes[self.at..];
        let start = rest.iter().position(|b| !b.is_ascii_whitespace()).ok_or("the data ends here")?;
        let rest = &rest[start..];
        let end = rest.iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len());
        self.at += start + end;
        std::str::from_utf8(&rest[..end]).map_err(|_| "expected a number, found no text".to_owned())
    }

    /// The next value; every type of the format fits in `f64` exactly.
    fn number(&mut self, scalar: Scalar) -> Result<f64, String> {
        match self.encoding {
            Encoding::Ascii => {
                let word = self.word()?;
                let number = word.parse::<f64>();
                number.map_err(|_| format!("expected a number, found {}", quoted(word)))
            }
            Encoding::LittleEndian => Ok(match scalar {
                Scalar::I8 => i8::from_le_bytes(self.take()?).into(),
                Scalar::U8 => u8::from_le_bytes(self.take()?).into(),
                Scalar::I16 => i16::from_le_bytes(self.take()?).into(),
                Scalar::U16 => u16::from_le_bytes(self.take()?).into(),
                Scalar::I32 => i32::from_le_bytes(self.take()?).into(),
                Scalar::U32 => u32::from_le_bytes(self.take()?).into(),
                Scalar::F32 => f32::from_le_bytes(self.take()?).into(),
                Scalar::F64 => f64::from_le_bytes(self.take()?),
            }),
            Encoding::BigEndian => Ok(match scalar {
                Scalar::I8 => i8::from_be_bytes(self.take()?).into(),
                Scalar::U8 => u8::from_be_bytes(self.take()?).into(),
                Scalar::I16 => i16::from_be_bytes(self.take()?).into(),
                Scalar::U16 => u16::from_be_bytes(self.take()?).into(),
                Scalar::I32 => i32::from_be_bytes(self.take()?).into(),
                Scalar::U32 => u32::from_be_bytes(self.take()?).into(),
                Scalar::F32 => f32::from_be_bytes(self.take()?).into(),
                Scalar::F64 => f64::from_be_bytes(self.take()?),
            }),
        }
    }

    /// A list's length.
    fn count(&mut self, scalar: Scalar) -> Result<usize, String> {
        let count = self.number(scalar)?;
        if count >= 0.0 && count <= f64::from(u32::MAX) && count.fract() == 0.0 {
            Ok(count as usize)
        } else {
            Err(format!("a list announces {count} values"))
        }
    }

    fn skip_values(&mut self, scalar: Scalar, count: usize) -> Result<(), String> {
        if self.encoding == Encoding::Ascii {
            return (0..count).try_for_each(|_| self.word().map(|_| ()));
        }
        match count.checked_mul(scalar.bytes()).filter(|&bytes| bytes <= self.left()) {
            Some(bytes) => self.at += bytes,
            None => return Err(format!("a list announces {count} values, and the data ends before")),
        }
        Ok(())
    }

    fn skip_property(&mut self, kind: Kind) -> Result<(), String> {
        match kind {
            Kind::Scalar(scalar) => self.skip_values(scalar, 1),
            Kind::List { count, item } => {
                let count = self.count(count)?;
                self.skip_values(item, count)
            }
        }
    }

    /// The place of a problem: the line of a text, the row of binary data.
    fn error(&self, element: &Element, row: u64, problem: &str) -> InputError {
        let place = match self.encoding {
            Encoding::Ascii => format!(" (line {})", line_at(self.bytes, self.at)),
            _ => format!(" (byte {})", self.at),
        };
        element.error(row, format!("{problem}{place}"))
    }
}

/// Why a property is not read.
enum Fault {
    /// What is wrong with it.
    Said(String),
    /// No memory, or cancelled.
    Stopped(InputError),
}

impl From<String> for Fault {
    fn from(problem: String) -> Self {
        Self::Said(problem)
    }
}

impl From<OverMemory> for Fault {
    fn from(error: OverMemory) -> Self {
        Self::Stopped(error.into())
    }
}

impl From<Cancelled> for Fault {
    fn from(error: Cancelled) -> Self {
        Self::Stopped(error.into())
    }
}

/// Reads an element row by row; `read` takes the value of each property.
fn each_property(
    body: &mut Body<'_>,
    element: &Element,
    monitor: &dyn Monitor,
    mut read: impl FnMut(&mut Body<'_>, usize, Kind) -> Result<(), Fault>,
    mut end_row: impl FnMut(),
) -> Result<(), InputError> {
    if element.properties.is_empty() {
        return Ok(());
    }
    for row in 0..element.rows {
        if row % ROWS_PER_CHECK as u64 == 0 {
            monitor.check()?;
        }
        for (i, property) in element.properties.iter().enumerate() {
            read(body, i, property.kind).map_err(|fault| match fault {
                Fault::Said(problem) => {
                    let problem = format!("property '{}': {problem}", printable(&property.name));
                    body.error(element, row, &problem)
                }
                Fault::Stopped(error) => error,
            })?;
        }
        end_row();
    }
    Ok(())
}

fn skip(body: &mut Body<'_>, element: &Element, monitor: &dyn Monitor) -> Result<(), InputError> {
    each_property(body, element, monitor, |body, _, kind| Ok(body.skip_property(kind)?), || {})
}

fn read_vertices(
    body: &mut Body<'_>,
    element: &Element,
    data: &mut PlyData,
    columns: &mut [Column],
    monitor: &dyn Monitor,
) -> Result<(), InputError> {
    let axis = |name: &str| {
        let index = element.properties.iter().position(|property| property.name == name);
        let index = index.ok_or_else(|| whole(&format!("its vertices have no property '{name}'")))?;
        match element.properties[index].kind {
            Kind::Scalar(_) => Ok(index),
            Kind::List { .. } => {
                Err(whole(&format!("its vertices' property '{name}' is a list, not a number")))
            }
        }
    };
    let axes = [axis("x")?, axis("y")?, axis("z")?];
    let is_of_trees =
        |property: &Property| matches!(property.kind, Kind::Scalar(_)) && is_read(&property.name);
    let of_trees: Vec<usize> =
        (0..element.properties.len()).filter(|&i| is_of_trees(&element.properties[i])).collect();
    let mut trees = Columns::new(of_trees.iter().map(|&i| element.properties[i].name.clone()));
    // Bounded by the file's size: `can_hold` has seen the bytes.
    let values = (columns.len() + of_trees.len()) * element.rows as usize;
    let held = bytes_of::<DVec3>(element.rows as usize) + bytes_of::<f32>(values);
    monitor.admit(READING, held, READING_ADVICE)?;
    for column in columns.iter_mut() {
        column.find(element);
    }
    trees.reserve_exact(element.rows as usize);
    let positions = &mut data.positions;
    positions.reserve_exact(element.rows as usize);
    let position = std::cell::Cell::new(DVec3::ZERO);
    each_property(
        body,
        element,
        monitor,
        |body, i, kind| match (axes.iter().position(|&axis| axis == i), kind) {
            (Some(axis), Kind::Scalar(scalar)) => {
                let x = in_range(body.number(scalar)?).map_err(|expected| format!("expected {expected}"))?;
                let mut whole = position.get();
                whole[axis] = x;
                position.set(whole);
                Ok(())
            }
            (None, Kind::Scalar(scalar)) => {
                let column = columns.iter_mut().find(|column| column.index == Some(i));
                let of_tree = of_trees.iter().position(|&tree| tree == i);
                if column.is_none() && of_tree.is_none() {
                    return Ok(body.skip_property(kind)?);
                }
                let value = body.number(scalar)?;
                if let Some(column) = column {
                    column.values.push(value as f32);
                }
                if let Some(column) = of_tree {
                    trees.take(column, value, true);
                }
                Ok(())
            }
            _ => Ok(body.skip_property(kind)?),
        },
        || positions.push(position.get()),
    )?;
    let Told { trees, classes, unnumbered, leaves } = trees.finish(positions, None);
    (data.trees, data.classes, data.unnumbered, data.leaves) = (trees, classes, unnumbered, leaves);
    Ok(())
}

/// The elements `face` and `tristrips`.
fn read_faces(
    body: &mut Body<'_>,
    element: &Element,
    faces: &mut Vec<[u32; 3]>,
    held: u64,
    monitor: &dyn Monitor,
) -> Result<(), InputError> {
    let is_corners = |property: &Property| matches!(&*property.name, "vertex_indices" | "vertex_index");
    let corners = element.properties.iter().position(is_corners);
    let (corners, count, item) = match corners.map(|i| (i, element.properties[i].kind)) {
        Some((i, Kind::List { count, item })) if item.is_integer() => (i, count, item),
        None if element.rows == 0 => return Ok(()),
        _ => return Err(whole("its faces or strips have no list 'vertex_indices' of whole numbers")),
    };
    let is_strips = element.name == "tristrips";
    let mut polygon = Vec::new();
    each_property(
        body,
        element,
        monitor,
        |body, i, kind| {
            if i != corners {
                return Ok(body.skip_property(kind)?);
            }
            let list = Corners { left: body.count(count)?, item, body, monitor };
            if is_strips {
                add_strips(list, faces, held)
            } else {
                add_polygon(list, &mut polygon, faces, held)
            }
        },
        || {},
    )
}

/// The indices of one list, each looked at.
struct Corners<'a, 'b> {
    left: usize,
    item: Scalar,
    body: &'a mut Body<'b>,
    monitor: &'a dyn Monitor,
}

impl Corners<'_, '_> {
    /// The next corner; `None` for −1 in strips. Outside: there are no more.
    fn next(&mut self, in_strips: bool) -> Option<Result<Option<u32>, Fault>> {
        self.left = self.left.checked_sub(1)?;
        Some(self.read(in_strips))
    }

    fn read(&mut self, in_strips: bool) -> Result<Option<u32>, Fault> {
        // A whole mesh may be one strip.
        if self.left.is_multiple_of(ROWS_PER_CHECK) {
            self.monitor.check()?;
        }
        let index = self.body.number(self.item)?;
        if in_strips && index == -1.0 {
            return Ok(None);
        }
        if !(index >= 0.0 && index < f64::from(u32::MAX) && index.fract() == 0.0) {
            return Err(format!("expected the index of a vertex, found {index}").into());
        }
        Ok(Some(index as u32))
    }
}

/// A polygon as a fan; `polygon` is room for its corners.
fn add_polygon(
    mut list: Corners<'_, '_>,
    polygon: &mut Vec<u32>,
    faces: &mut Vec<[u32; 3]>,
    held: u64,
) -> Result<(), Fault> {
    polygon.clear();
    while let Some(corner) = list.next(false) {
        make_room(polygon, polygon.capacity(), held + bytes_of::<[u32; 3]>(faces.capacity()), list.monitor)?;
        polygon.extend(corner?);
    }
    if faces.capacity() - faces.len() < polygon.len() {
        let all = bytes_grown::<[u32; 3]>(faces.len() + polygon.len());
        let held = held + bytes_of::<u32>(polygon.capacity());
        list.monitor.admit(READING, all.saturating_add(held), READING_ADVICE)?;
    }
    fan(polygon, faces);
    Ok(())
}

/// Strips of triangles; a −1 ends one and begins another.
fn add_strips(mut list: Corners<'_, '_>, faces: &mut Vec<[u32; 3]>, held: u64) -> Result<(), Fault> {
    let mut strip = Strip::default();
    while let Some(corner) = list.next(true) {
        let Some(corner) = corner? else {
            strip = Strip::default();
            continue;
        };
        make_room(faces, faces.capacity(), held, list.monitor)?;
        faces.extend(strip.go(corner));
    }
    Ok(())
}

/// The end of a strip of triangles: each corner from the third on makes one with the two before it, and every
/// second triangle is turned, so that all look to the same side.
#[derive(Default)]
struct Strip {
    last: [Option<u32>; 2],
    is_turned: bool,
}

impl Strip {
    /// The triangle that ends at a corner. None at the first two, nor where two corners are the same: strips
    /// are joined so.
    fn go(&mut self, corner: u32) -> Option<[u32; 3]> {
        let [a, b] = self.last;
        self.last = [b, Some(corner)];
        let (a, b) = (a?, b?);
        let triangle = if self.is_turned { [b, a, corner] } else { [a, b, corner] };
        self.is_turned = !self.is_turned;
        (a != b && b != corner && corner != a).then_some(triangle)
    }
}

fn whole(problem: &str) -> InputError {
    InputError::Whole { format: "PLY", problem: problem.to_owned() }
}

fn line_error(line: usize, expected: &str, found: &str) -> InputError {
    InputError::Line { format: "PLY", line, expected: expected.to_owned(), found: quoted(found) }
}
