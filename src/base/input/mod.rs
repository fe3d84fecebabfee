//! What users bring: crown meshes, scanned points and pictures, as bytes.
//!
//! [`sniff`] tells by the content what a file is; [`read_obj`] and [`read_ply`] read meshes, [`read_ply`], [`read_xyz`],
//! [`read_las`], [`read_e57`], [`read_pcd`], [`read_ptx`], [`read_grid`] and [`read_geotiff`] points, [`read_cylinders`] tables of cylinders, [`read_picture`] pixels. Bytes come in, values go out: no file is opened here. Nothing that a
//! header or an index claims is believed before the bytes for it have been seen, so memory stays within a
//! small multiple of the file (of a picture: of its pixels, which are asked for), and any sequence of bytes
//! gives a value or an [`InputError`].
//!
//! Positions are `f64` as the file has them; [`Up::to_y_up`] turns them and [`recenter`] takes them
//! near the origin, where growth's `f32` resolves tenths of a millimetre.

mod cloud;
mod crs;
mod cylinder_header;
mod cylinder_table;
mod cylinders;
mod e57;
mod gather;
mod geotiff;
mod grid;
mod inputs;
mod las;
mod mat;
mod mixing;
mod obj;
mod pcd;
mod picture;
mod ply;
mod ptx;
mod sniff;
mod table;
mod unit;
mod xyz;

use glam::DVec3;

pub use cloud::{Cloud, LeafColumn, Thinned, TreeColumn, UnnumberedColumn};
pub use crs::MapUnits;
pub use cylinder_header::CylinderDialect;
pub use cylinder_table::{CylinderRow, CylinderTable};
pub use cylinders::read_cylinders;
pub use e57::read_e57;
pub use gather::ThinError;
pub use geotiff::read_geotiff;
pub use grid::read_grid;
pub use inputs::{Geometry, Input, Inputs};
pub use las::read_las;
pub use obj::read_obj;
pub use pcd::read_pcd;
pub use picture::{A_PICTURE, UserPicture, UserPictureError, is_picture, read_picture};
pub use ply::{PlyColumns, PlyData, read_ply, read_ply_with};
pub use ptx::read_ptx;
pub use sniff::{InputKind, sniff};
pub use unit::{HIGHEST_TREE_M, likely_scale, unit_name};
pub use xyz::read_xyz;

use crate::knob::{FARTHEST, excerpt};
use crate::memory::{OverMemory, bytes_grown};
use crate::monitor::{Cancelled, Monitor};

/// Triangles over shared vertices, as a file has them: neither closed nor oriented nor welded.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TriangleMesh {
    /// In the file's units and axes.
    pub positions: Vec<DVec3>,
    /// Indices of `positions`, each in range.
    pub triangles: Vec<[u32; 3]>,
}

/// Why a file cannot be used.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum InputError {
    /// No bytes, or nothing but white space.
    #[error("the file is empty; expected a preset, a grammar, a mesh or points")]
    Empty,
    /// Text that is not UTF-8.
    #[error("line {line} is not UTF-8 text (byte {byte} of the file); save the file as UTF-8")]
    NotUtf8 {
        /// From 1.
        line: usize,
        /// From 0.
        byte: usize,
    },
    /// A known format that linden does not read, or none that it knows.
    #[error("cannot read this file: it {looks}")]
    Unknown {
        /// What it looks like and what to do.
        looks: &'static str,
    },
    /// A line is not what it must be.
    #[error("reading {format}, line {line}: expected {expected}, found {found}")]
    Line {
        /// `OBJ`, `PLY`, `XYZ`, `LAS` …
        format: &'static str,
        /// From 1.
        line: usize,
        /// What must stand there.
        expected: String,
        /// What stands there, printable and quoted.
        found: String,
    },
    /// Binary data is not what it must be.
    #[error("reading PLY, element '{element}', row {row} of {rows}: {problem}")]
    Row {
        /// The element's name, printable.
        element: String,
        /// From 0.
        row: u64,
        /// How many the header announces.
        rows: u64,
        /// What is wrong.
        problem: String,
    },
    /// The file as a whole does not hold what it must.
    #[error("reading {format}: {problem}")]
    Whole {
        /// `OBJ`, `PLY`, `XYZ`, `LAS` …
        format: &'static str,
        /// What is wrong, and what to do.
        problem: String,
    },
    /// The system could not read on.
    #[error("reading it failed: {problem}")]
    Stream {
        /// What the system says.
        problem: String,
    },
    /// A picture that is none.
    #[error(transparent)]
    Picture(#[from] UserPictureError),
    /// There is no memory for what it holds.
    #[error(transparent)]
    Memory(#[from] OverMemory),
    /// Nobody wants it any more.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// Which way is up in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Up {
    /// As inside linden; the habit of OBJ and PLY.
    Y,
    /// The habit of surveying: XYZ, LAS, E57.
    Z,
}

impl Up {
    /// Turns positions so that Y is up: `(x, y, z)` becomes `(x, z, -y)` where Z was. A rotation:
    /// nothing is mirrored.
    pub fn to_y_up(self, positions: &mut [DVec3]) {
        if self == Self::Z {
            for p in positions {
                *p = DVec3::new(p.x, p.z, -p.y);
            }
        }
    }
}

/// Moves positions so that `origin` becomes the origin, in `f64`; adding `origin` to a result moves
/// it back to where the file has it.
pub fn recenter(positions: &mut [DVec3], origin: DVec3) {
    for p in positions {
        *p -= origin;
    }
}

/// Rows between two looks at the monitor.
const ROWS_PER_CHECK: usize = 8192;

/// For messages about memory.
const READING: &str = "reading points or a mesh";
const READING_ADVICE: &str = "thin it out";

/// Asks for memory whenever a list is about to move to a larger place; `held` bytes are held beside it.
fn make_room<T>(list: &[T], capacity: usize, held: u64, monitor: &dyn Monitor) -> Result<(), OverMemory> {
    if list.len() < capacity {
        return Ok(());
    }
    monitor.admit(READING, bytes_grown::<T>(list.len() + 1).saturating_add(held), READING_ADVICE)
}

/// A coordinate, or what was expected instead.
fn coordinate(token: &str) -> Result<f64, &'static str> {
    in_range(token.parse().map_err(|_| "a number")?)
}

/// The coordinate, if it is one.
fn in_range(x: f64) -> Result<f64, &'static str> {
    if !x.is_finite() {
        Err("a finite number")
    } else if x.abs() > FARTHEST {
        Err("a coordinate within ±1e9")
    } else {
        Ok(x)
    }
}

/// The bytes as text without a byte order mark.
fn text_of(bytes: &[u8]) -> Result<&str, InputError> {
    if bytes.starts_with(&[0xff, 0xfe]) || bytes.starts_with(&[0xfe, 0xff]) {
        return Err(InputError::Unknown { looks: "is UTF-16 text; save it as UTF-8" });
    }
    let text = std::str::from_utf8(bytes).map_err(|error| {
        let byte = error.valid_up_to();
        InputError::NotUtf8 { line: line_at(bytes, byte), byte }
    })?;
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    if text.trim().is_empty() { Err(InputError::Empty) } else { Ok(text) }
}

/// The number of the line, from 1, that a byte lies in.
fn line_at(bytes: &[u8], byte: usize) -> usize {
    bytes[..byte.min(bytes.len())].split(|&b| b == b'\n').count()
}

/// Lines and their numbers from 1, whichever system wrote them: `\n`, `\r\n`, or `\r` alone.
fn lines(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let end = if text.contains('\n') { '\n' } else { '\r' };
    text.split(end).enumerate().map(|(i, line)| (i + 1, line.strip_suffix('\r').unwrap_or(line)))
}

/// What stands in a file, short and printable, in quotes.
fn quoted(text: &str) -> String {
    let text = text.trim();
    if text.is_empty() { "nothing".to_owned() } else { format!("'{}'", excerpt(text)) }
}

/// A polygon as a fan around its first corner.
///
/// Right for concave planar polygons too, for what crowns need: the fan's triangles overlap with
/// opposite orientations where the polygon is not, and cancel in winding numbers and volumes.
fn fan(polygon: &[u32], triangles: &mut Vec<[u32; 3]>) {
    triangles.extend(polygon.windows(2).skip(1).map(|pair| [polygon[0], pair[0], pair[1]]));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::memory::bytes_of;
    use crate::monitor::testing::Limited;

    #[test]
    fn z_up_turns_without_mirroring() {
        let mut axes = [DVec3::X, DVec3::Y, DVec3::Z];
        Up::Z.to_y_up(&mut axes);
        assert_eq!(axes[2], DVec3::Y);
        assert_eq!(axes[0].cross(axes[1]), axes[2]);
        let mut same = [DVec3::new(1.0, 2.0, 3.0)];
        Up::Y.to_y_up(&mut same);
        assert_eq!(same[0], DVec3::new(1.0, 2.0, 3.0));
    }

    #[test]
    fn recentring_keeps_a_surveys_decimals() {
        // A UTM place; f32 would round its northing to half metres.
        let mut points = [DVec3::new(446_000.512_3, 5_428_000.007, 312.25)];
        recenter(&mut points, DVec3::new(446_000.0, 5_428_000.0, 312.0));
        assert!((points[0] - DVec3::new(0.512_3, 0.007, 0.25)).length() < 2e-9);
    }

    #[test]
    fn lines_of_any_system_count_alike() {
        for text in ["a\nb\n\nc", "a\r\nb\r\n\r\nc", "a\rb\r\rc"] {
            assert_eq!(lines(text).collect::<Vec<_>>(), [(1, "a"), (2, "b"), (3, ""), (4, "c")]);
        }
    }

    #[test]
    fn text_must_be_utf8_and_something() {
        assert_eq!(text_of(b""), Err(InputError::Empty));
        assert_eq!(text_of(b" \r\n\t"), Err(InputError::Empty));
        assert_eq!(text_of(b"a\nb\nc\xff"), Err(InputError::NotUtf8 { line: 3, byte: 5 }));
        assert!(matches!(text_of(b"\xff\xfea\0"), Err(InputError::Unknown { .. })));
        assert_eq!(text_of("\u{feff}v".as_bytes()), Ok("v"));
    }

    type Read<'a> = &'a dyn Fn(&dyn Monitor) -> Result<u64, InputError>;

    #[test]
    fn what_is_read_asks_for_its_memory() {
        let count = 10_000;
        let points = "1 2 3\n".repeat(count);
        let mesh = "v 1 2 3\nf 1 1 1 1\n".repeat(count);
        let ply = format!(
            "ply\nformat ascii 1.0\nelement vertex {count}\nproperty int x\nproperty int y\nproperty int z\n\
             element face {count}\nproperty list uchar int vertex_indices\nend_header\n{points}{}",
            "4 0 0 0 0\n".repeat(count)
        );
        let mesh_bytes = |mesh: &TriangleMesh| {
            bytes_of::<DVec3>(mesh.positions.capacity()) + bytes_of::<[u32; 3]>(mesh.triangles.capacity())
        };
        let reads: [(&str, Read<'_>); 3] = [
            ("XYZ", &|poor| Ok(read_xyz(points.as_bytes(), poor)?.bytes())),
            ("OBJ", &|poor| Ok(mesh_bytes(&read_obj(mesh.as_bytes(), poor)?))),
            ("PLY", &|poor| {
                let PlyData { positions, faces: triangles, .. } = read_ply(ply.as_bytes(), poor)?;
                Ok(mesh_bytes(&TriangleMesh { positions, triangles }))
            }),
        ];
        for (format, read) in reads {
            let held = read(&Limited(u64::MAX)).unwrap();
            assert!(matches!(read(&Limited(held - 1)), Err(InputError::Memory(_))), "{format}");
            // While a list moves it is there twice, and no more.
            assert_eq!(read(&Limited(2 * held)), Ok(held), "{format}");
        }
    }

    #[test]
    fn what_is_shown_is_short_and_harmless() {
        assert_eq!(quoted("\u{1b}[2J"), "'\\u{1b}[2J'");
        assert!(quoted(&"ä".repeat(1000)).chars().count() < 70);
    }
}
