//! Cylinders as `TreeQSM` keeps them: the structure `QSM` with its field `cylinder` in a file of MATLAB's (MAT-File Level 5,
//! `MathWorks`, MAT-File Format, 2019), which rTwig, MATLAB, Octave and scipy read.
//!
//! ```text
//! linden_recipe   char      the recipe, in the files of one stage
//! QSM             1 x trees structure: cylinder
//!     cylinder    radius length start axis parent extension added UnmodRadius branch SurfCov mad BranchOrder
//!                 PositionInBranch: a row each, metres, Z up; ids from 1, parent 0: none
//! ```
//!
//! Nothing is packed, so that the size of all is known before the first byte is written. Without a crate: those that write
//! such files have no structures.

use std::io::{self, Read};

use linden_pipeline::Monitor;
use linden_pipeline::skeleton::Forks;
use linden_pipeline::stage::Stage;

use super::dialects::{Sheet, z_up};
use crate::options::{OptionSpec, Options};
use crate::writing::{fit, memory, trees, validate};
use crate::{Bundle, Encoding, ExportError, Exporter, Format, GENERATOR, Holds, Readable, recipe};

/// Cylinders for MATLAB.
pub(crate) struct Mat;

static FORMAT: Format = Format {
    id: "mat",
    name: "TreeQSM structure (MAT)",
    extensions: &["mat"],
    media_type: "application/x-matlab-data",
    self_contained: true,
    help: "cylinders as TreeQSM keeps them, for MATLAB, Octave, R and scipy: QSM.cylinder, metres, Z up",
    options: &[OptionSpec::switch("recipe", true, "the recipe too, as the variable linden_recipe")],
    holds: Holds::SKELETON,
    levels_by: None,
    encoding: |_| Encoding::Binary,
    estimate: Some(|amounts, options| {
        let recipe = if options.is_on("recipe") { 2 * amounts.recipe_bytes + 100 } else { 0 };
        HEADER as u64 + recipe + 2000 + u64::from(ROW) * amounts.nodes
    }),
};

/// Bytes before the first variable.
const HEADER: usize = 128;

/// Types of data.
mod kind {
    pub const INT8: u32 = 1;
    pub const UINT8: u32 = 2;
    pub const UINT16: u32 = 4;
    pub const INT32: u32 = 5;
    pub const UINT32: u32 = 6;
    pub const SINGLE: u32 = 7;
    pub const MATRIX: u32 = 14;
}

/// Classes of arrays.
mod class {
    pub const STRUCT: u32 = 2;
    pub const CHAR: u32 = 4;
    pub const SINGLE: u32 = 7;
    pub const UINT8: u32 = 9;
    pub const UINT32: u32 = 13;
    /// Of an array of bytes: what is in it is true or false.
    pub const LOGICAL: u32 = 0x0200;
}

/// Bytes of a field's name, the last of them 0.
const NAME: usize = 32;

const RECIPE: &str = "linden_recipe";

/// A field of `cylinder`: its name, columns, class, type, bytes of a number.
struct Column {
    name: &'static str,
    columns: u32,
    class: u32,
    kind: u32,
    size: u32,
    /// The numbers of a row, of all columns.
    of: fn(&Sheet, usize) -> Numbers,
}

/// What stands in a row.
enum Numbers {
    Real(f32),
    Place([f32; 3]),
    Whole(u32),
    Byte(u8),
}

const fn single(name: &'static str, columns: u32, of: fn(&Sheet, usize) -> Numbers) -> Column {
    Column { name, columns, class: class::SINGLE, kind: kind::SINGLE, size: 4, of }
}

const fn id(name: &'static str, of: fn(&Sheet, usize) -> Numbers) -> Column {
    Column { name, columns: 1, class: class::UINT32, kind: kind::UINT32, size: 4, of }
}

fn above(place: Option<u32>) -> Numbers {
    Numbers::Whole(place.map_or(0, |place| place + 1))
}

/// As `TreeQSM` 2.4 has them. What was never fitted has no `mad`, and `SurfCov` 1.
const COLUMNS: [Column; 13] = [
    single("radius", 1, |sheet, row| Numbers::Real(sheet.cylinders[row].radius_m)),
    single("length", 1, |sheet, row| Numbers::Real(sheet.cylinders[row].length_m)),
    single("start", 3, |sheet, row| Numbers::Place(z_up(sheet.cylinders[row].start.to_array()))),
    single("axis", 3, |sheet, row| Numbers::Place(z_up(sheet.cylinders[row].direction.to_array()))),
    id("parent", |sheet, row| above(sheet.cylinders[row].parent)),
    id("extension", |sheet, row| above(sheet.extensions[row])),
    Column {
        name: "added",
        columns: 1,
        class: class::UINT8 | class::LOGICAL,
        kind: kind::UINT8,
        size: 1,
        of: |_, _| Numbers::Byte(0),
    },
    single("UnmodRadius", 1, |sheet, row| Numbers::Real(sheet.cylinders[row].radius_m)),
    id("branch", |sheet, row| Numbers::Whole(sheet.cylinders[row].axis + 1)),
    single("SurfCov", 1, |_, _| Numbers::Real(1.0)),
    single("mad", 1, |_, _| Numbers::Real(0.0)),
    Column {
        name: "BranchOrder",
        columns: 1,
        class: class::UINT8,
        kind: kind::UINT8,
        size: 1,
        of: |sheet, row| Numbers::Byte(u8::try_from(sheet.orders[row]).unwrap_or(u8::MAX)),
    },
    id("PositionInBranch", |sheet, row| Numbers::Whole(sheet.cylinders[row].place + 1)),
];

/// Bytes of a row in all columns.
const ROW: u32 = {
    let (mut bytes, mut i) = (0, 0);
    while i < COLUMNS.len() {
        bytes += COLUMNS[i].columns * COLUMNS[i].size;
        i += 1;
    }
    bytes
};

/// To the next eighth byte.
const fn padded(bytes: u64) -> u64 {
    bytes.next_multiple_of(8)
}

/// Bytes of an array without its tag: flags, dimensions, name and what follows.
const fn array_bytes(name: usize, data: u64) -> u64 {
    16 + 16 + 8 + padded(name as u64) + data
}

/// Bytes of a structure's names of fields, and of the tags of their values.
const fn fields_bytes(fields: usize) -> u64 {
    8 + 8 + padded((fields * NAME) as u64)
}

/// Bytes of `cylinder` without its tag.
fn cylinder_bytes(rows: u64) -> u64 {
    let column = |column: &Column| {
        8 + array_bytes(0, 8 + padded(rows * u64::from(column.columns) * u64::from(column.size)))
    };
    array_bytes(0, fields_bytes(COLUMNS.len()) + COLUMNS.iter().map(column).sum::<u64>())
}

/// A part of the file.
#[derive(Default)]
struct Bytes(Vec<u8>);

impl Bytes {
    fn words(&mut self, words: &[u32]) {
        self.0.extend(words.iter().flat_map(|word| word.to_le_bytes()));
    }

    fn pad(&mut self) {
        self.0.resize(self.0.len().next_multiple_of(8), 0);
    }

    /// Flags, dimensions and name of an array of so many bytes.
    fn array(&mut self, bytes: u64, class: u32, dimensions: [u32; 2], name: &str) {
        self.words(&[kind::MATRIX, bytes as u32, kind::UINT32, 8, class, 0, kind::INT32, 8]);
        self.words(&dimensions);
        self.words(&[kind::INT8, name.len() as u32]);
        self.0.extend(name.bytes());
        self.pad();
    }

    /// The names of a structure's fields.
    fn fields<'n>(&mut self, names: impl ExactSizeIterator<Item = &'n str>) {
        // Four bytes or less stand in the tag.
        self.words(&[(4 << 16) | kind::INT32, NAME as u32, kind::INT8, (names.len() * NAME) as u32]);
        for name in names {
            let end = self.0.len() + NAME;
            self.0.extend(name.bytes());
            self.0.resize(end, 0);
        }
        self.pad();
    }

    fn column(&mut self, column: &Column, sheet: &Sheet) {
        let rows = sheet.len();
        let bytes = rows as u64 * u64::from(column.columns) * u64::from(column.size);
        self.array(array_bytes(0, 8 + padded(bytes)), column.class, [rows as u32, column.columns], "");
        self.words(&[column.kind, bytes as u32]);
        // Column by column.
        for at in 0..column.columns as usize {
            for row in 0..rows {
                match (column.of)(sheet, row) {
                    Numbers::Real(number) => self.0.extend(number.to_le_bytes()),
                    Numbers::Place(place) => self.0.extend(place[at].to_le_bytes()),
                    Numbers::Whole(number) => self.0.extend(number.to_le_bytes()),
                    Numbers::Byte(byte) => self.0.push(byte),
                }
            }
        }
        self.pad();
    }
}

fn header() -> Vec<u8> {
    let mut text = format!("MATLAB 5.0 MAT-file, {GENERATOR}, metres, Z up").into_bytes();
    text.truncate(HEADER - 12);
    text.resize(HEADER - 12, b' ');
    // No data of subsystems; version; the order of bytes.
    text.extend([0; 8]);
    text.extend(0x0100_u16.to_le_bytes());
    text.extend(b"IM");
    text
}

impl Exporter for Mat {
    fn format(&self) -> &'static Format {
        &FORMAT
    }

    fn recipe(&self, file: &mut dyn Readable) -> io::Result<Option<String>> {
        read_recipe(file)
    }

    fn write(
        &self,
        stage: &Stage<'_>,
        options: &Options,
        bundle: &mut Bundle,
        monitor: &dyn Monitor,
    ) -> Result<(), ExportError> {
        let stage = &fit(stage, &FORMAT, bundle);
        let plants = validate::trees(stage, monitor)?;
        let more = plants.iter().map(|(_, scene)| {
            let nodes = scene.skeleton.positions.len();
            Forks::bytes_for(&scene.skeleton) + Sheet::bytes(nodes) + 2 * cylinder_bytes(nodes as u64)
        });
        memory::admit(stage, &[], trees::bytes(&plants) + more.max().unwrap_or(0), monitor)?;
        let (_, text) = recipe::of_stage(stage);
        let text: Vec<u16> = text.encode_utf16().collect();
        let counts: Vec<u64> = trees::numbered(&plants).map(|tree| tree.skeleton.segments() as u64).collect();
        let models: u64 = counts.iter().map(|&rows| 8 + cylinder_bytes(rows)).sum();
        let models = array_bytes("QSM".len(), fields_bytes(1) + models);
        let letters = array_bytes(RECIPE.len(), 8 + padded(2 * text.len() as u64));
        if models.max(letters) > u64::from(u32::MAX) {
            return Err(ExportError::TooLarge {
                format: FORMAT.id,
                amount: format!("{} cylinders", counts.iter().sum::<u64>()),
                limit: "4 GiB a variable",
                advice: "write them as qsm",
            });
        }
        let with_recipe = options.is_on("recipe");
        let total = HEADER as u64 + if with_recipe { 8 + letters } else { 0 } + 8 + models;
        bundle.write_main(Some(total), monitor, |out| {
            let mut bytes = Bytes(header());
            if with_recipe {
                bytes.array(letters, class::CHAR, [1, text.len() as u32], RECIPE);
                bytes.words(&[kind::UINT16, 2 * text.len() as u32]);
                bytes.0.extend(text.iter().flat_map(|letter| letter.to_le_bytes()));
                bytes.pad();
            }
            bytes.array(models, class::STRUCT, [1, counts.len() as u32], "QSM");
            bytes.fields(std::iter::once("cylinder"));
            out.write(&bytes.0)?;
            for tree in trees::numbered(&plants) {
                let sheet = Sheet::new(&tree.skeleton, tree.place);
                let mut bytes = Bytes::default();
                bytes.array(cylinder_bytes(sheet.len() as u64), class::STRUCT, [1, 1], "");
                bytes.fields(COLUMNS.iter().map(|column| column.name));
                for column in &COLUMNS {
                    monitor.check()?;
                    bytes.column(column, &sheet);
                }
                out.write(&bytes.0)?;
            }
            Ok(())
        })
    }
}

/// The recipe, where it is the first variable as it is written here.
fn read_recipe(file: &mut dyn Readable) -> io::Result<Option<String>> {
    /// No recipe is longer.
    const LONGEST: u64 = 32 << 20;
    let mut head = vec![0; HEADER + 48 + padded(RECIPE.len() as u64) as usize + 8];
    file.read_exact(&mut head)?;
    let mut expected = Bytes(vec![]);
    expected.words(&[kind::INT8, RECIPE.len() as u32]);
    expected.0.extend(RECIPE.bytes());
    expected.pad();
    let name = &head[HEADER + 40..head.len() - 8];
    if !head.starts_with(b"MATLAB 5.0 MAT-file") || name != expected.0 {
        return Ok(None);
    }
    let word = |at: usize| u32::from_le_bytes([head[at], head[at + 1], head[at + 2], head[at + 3]]);
    let (kind, size) = (word(head.len() - 8), u64::from(word(head.len() - 4)));
    if kind != kind::UINT16 || size > LONGEST {
        return Ok(None);
    }
    let mut bytes = Vec::new();
    file.take(size).read_to_end(&mut bytes)?;
    let letters: Vec<u16> = bytes.chunks_exact(2).map(|two| u16::from_le_bytes([two[0], two[1]])).collect();
    Ok(String::from_utf16(&letters).ok())
}
