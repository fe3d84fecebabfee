//! Files that were read, by the names that settings have for them.

use std::collections::BTreeMap;
use std::io::{BufReader, Read, Seek};
use std::sync::Arc;

use glam::DVec3;
use xxhash_rust::xxh3::{Xxh3, xxh3_128};

use super::e57::stream_e57;
use super::geotiff::is_geotiff;
use super::las::{stream_las, thin_las};
use super::pcd::thin_pcd;
use super::ptx::thin_ptx;
use super::xyz::{stream_xyz, thin_xyz};
use super::{
    Cloud, CylinderRow, CylinderTable, InputError, InputKind, PlyData, ThinError, TriangleMesh, Up,
    UserPicture, picture, read_cylinders, read_geotiff, read_grid, read_obj, read_picture, read_ply, sniff,
};
use crate::memory::bytes_of;
use crate::monitor::{Monitor, Phase};

/// Files that were read, by the names that settings have for them.
///
/// ```
/// use linden_base::input::{Input, Inputs};
/// use linden_base::monitor::Quiet;
/// let tetrahedron = b"v 0 0 0\nv 2 0 0\nv 1 0 2\nv 1 2 1\nf 1 2 3\nf 1 4 2\nf 2 4 3\nf 3 4 1\n";
/// let mut inputs = Inputs::new();
/// inputs.insert("hull.obj", Input::read("hull.obj", tetrahedron, &Quiet).unwrap());
/// assert!(inputs.get("hull.obj").is_some() && inputs.get("hall.obj").is_none());
/// ```
#[derive(Clone, Debug, Default)]
pub struct Inputs(BTreeMap<String, Input>);

impl Inputs {
    /// None.
    pub const fn new() -> Self {
        Self(BTreeMap::new())
    }

    /// Adds a file, or replaces the one of that name.
    pub fn insert(&mut self, name: impl Into<String>, input: Input) {
        self.0.insert(name.into(), input);
    }

    /// The file of that name.
    pub fn get(&self, name: &str) -> Option<&Input> {
        self.0.get(name)
    }

    /// All files with their names, by name.
    pub fn iter(&self) -> impl Iterator<Item = (&str, &Input)> {
        self.0.iter().map(|(name, input)| (name.as_str(), input))
    }

    /// Keeps the files whose names are `wanted`.
    pub fn retain(&mut self, wanted: impl Fn(&str) -> bool) {
        self.0.retain(|name, _| wanted(name));
    }

    /// Gives files other names: `renamed` has the new one of an old one, if it changes.
    pub fn rename(&mut self, renamed: impl Fn(&str) -> Option<String>) {
        let rename = |(name, input): (String, Input)| (renamed(&name).unwrap_or(name), input);
        self.0 = std::mem::take(&mut self.0).into_iter().map(rename).collect();
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Bytes that their geometry takes.
    pub fn bytes(&self) -> u64 {
        self.0.values().map(Input::bytes).sum()
    }
}

impl<N: Into<String>> FromIterator<(N, Input)> for Inputs {
    fn from_iter<I: IntoIterator<Item = (N, Input)>>(inputs: I) -> Self {
        Self(inputs.into_iter().map(|(name, input)| (name.into(), input)).collect())
    }
}

/// A file that was read: a crown envelope, a mesh of a part or a leaf, attraction points, a picture.
#[derive(Clone, Debug)]
pub struct Input {
    /// XXH3 of its bytes.
    pub hash: u128,
    /// Which way is up when nobody says.
    pub up: Up,
    /// What it held.
    pub geometry: Geometry,
}

/// What an input file held, in the file's axes.
#[derive(Clone, Debug)]
pub enum Geometry {
    /// A surface.
    Mesh(Arc<TriangleMesh>),
    /// Places, and which trees they belong to.
    Points(Arc<Cloud>),
    /// Trees as cylinders.
    Cylinders(Arc<CylinderTable>),
    /// Pixels.
    Picture(Arc<UserPicture>),
}

impl Input {
    /// Bytes that its geometry takes.
    pub fn bytes(&self) -> u64 {
        match &self.geometry {
            Geometry::Mesh(mesh) => {
                bytes_of::<DVec3>(mesh.positions.capacity()) + bytes_of::<[u32; 3]>(mesh.triangles.capacity())
            }
            Geometry::Points(cloud) => cloud.bytes(),
            Geometry::Cylinders(table) => bytes_of::<CylinderRow>(table.count()),
            Geometry::Picture(picture) => picture.picture.rgba().len() as u64,
        }
    }

    /// Reads a mesh (OBJ, PLY with faces), points (PLY without, XYZ, LAS, E57, PCD, PTX, ASC, `GeoTIFF`), a table of
    /// cylinders or a picture (PNG, JPEG, WebP, TGA). The file's name decides only where its content does not: between two kinds, and that
    /// it is TGA.
    ///
    /// # Errors
    /// Anything that is wrong with the file, and files of other kinds.
    pub fn read(name: &str, bytes: &[u8], monitor: &dyn Monitor) -> Result<Self, InputError> {
        Self::read_thinned(name, bytes, None, monitor)
    }

    /// The same; of points, the first of each cube with sides `cube` (in the file's units) is kept, if it is given. Grids of
    /// heights stay whole.
    ///
    /// # Errors
    /// As [`Input::read`].
    pub fn read_thinned(
        name: &str,
        bytes: &[u8],
        cube: Option<f64>,
        monitor: &dyn Monitor,
    ) -> Result<Self, InputError> {
        // Whatever claims to be a picture is read as one: the picture's reader says best what it is not.
        if picture::claims_to_be_picture(name, bytes) {
            let geometry = Geometry::Picture(Arc::new(read_picture(name, bytes, monitor)?));
            return Ok(Self { hash: xxh3_128(bytes), up: Up::Y, geometry });
        }
        let points = |cloud| Geometry::Points(Arc::new(cloud));
        let (up, geometry) = match sniff(bytes, name)? {
            InputKind::ObjMesh => (Up::Y, Geometry::Mesh(Arc::new(read_obj(bytes, monitor)?))),
            InputKind::PlyMesh | InputKind::PlyPoints => {
                let PlyData { positions, faces: triangles, trees, classes, unnumbered, leaves } =
                    read_ply(bytes, monitor)?;
                let geometry = if triangles.is_empty() {
                    let cloud = Cloud { positions, trees, classes, unnumbered, leaves, ..Cloud::default() };
                    points(match cube {
                        Some(cube) => cloud.thin(cube, monitor)?,
                        None => cloud,
                    })
                } else {
                    Geometry::Mesh(Arc::new(TriangleMesh { positions, triangles }))
                };
                (Up::Y, geometry)
            }
            InputKind::XyzPoints => (Up::Z, points(thin_xyz(bytes, cube, monitor)?)),
            InputKind::LasPoints => (Up::Z, points(thin_las(bytes, cube, monitor)?)),
            InputKind::E57Points => {
                let stream = std::io::Cursor::new(bytes);
                (Up::Z, points(stream_e57(stream, bytes.len() as u64, cube, monitor)?))
            }
            InputKind::PcdPoints => (Up::Z, points(thin_pcd(bytes, cube, monitor)?)),
            InputKind::PtxPoints => (Up::Z, points(thin_ptx(bytes, cube, monitor)?)),
            InputKind::HeightGrid if is_geotiff(bytes) => (Up::Z, points(read_geotiff(bytes, monitor)?)),
            InputKind::HeightGrid => (Up::Z, points(read_grid(bytes, monitor)?)),
            InputKind::Cylinders { .. } => {
                let table = read_cylinders(bytes, monitor)?;
                (table.dialect.up(), Geometry::Cylinders(Arc::new(table)))
            }
            InputKind::Preset | InputKind::Grammar | InputKind::Recipe | InputKind::TreeParameters => {
                let looks = "is a preset, grammar, recipe or parameters of a tree; expected a mesh (OBJ, PLY), points (PLY, XYZ, LAS, E57, PCD, PTX, ASC, GeoTIFF), cylinders (CSV) or a picture";
                return Err(InputError::Unknown { looks });
            }
        };
        Ok(Self { hash: xxh3_128(bytes), up, geometry })
    }

    /// Bytes of a file by which [`Input::is_streamed`] tells what it is.
    pub const OPENING: u64 = 1 << 14;

    /// Whether a file with this opening is one that [`Input::stream`] reads.
    pub fn is_streamed(name: &str, opening: &[u8]) -> bool {
        streamed_kind(name, opening).is_some()
    }

    /// Reads points as [`Input::read_thinned`] does without ever holding the file: LAS, LAZ, E57, and rows of numbers whose
    /// lines end in line feeds. Memory is what the points that are kept take.
    ///
    /// # Errors
    /// As [`Input::read`]; a file of another kind; what the stream says where it fails.
    pub fn stream(
        name: &str,
        mut stream: impl Read + Seek + Send + Sync + 'static,
        cube: Option<f64>,
        monitor: &dyn Monitor,
    ) -> Result<Self, InputError> {
        let failed = |error: std::io::Error| InputError::Stream { problem: error.to_string() };
        let mut hasher = Xxh3::new();
        let mut piece = vec![0; STREAMED_AT_ONCE];
        let (mut length, mut kind) = (0, None);
        loop {
            monitor.check()?;
            let count = fill(&mut stream, &mut piece).map_err(failed)?;
            if length == 0 {
                kind = streamed_kind(name, &piece[..count.min(Self::OPENING as usize)]);
            }
            length += count as u64;
            monitor.advance(Phase::Read, length, None);
            hasher.update(&piece[..count]);
            if count < piece.len() {
                break;
            }
        }
        drop(piece);
        stream.rewind().map_err(failed)?;
        let cloud = match kind {
            Some(InputKind::LasPoints) => {
                stream_las(BufReader::with_capacity(STREAMED_AT_ONCE, stream), cube, monitor)?
            }
            Some(InputKind::E57Points) => {
                stream_e57(BufReader::with_capacity(STREAMED_AT_ONCE, stream), length, cube, monitor)?
            }
            Some(InputKind::XyzPoints) => {
                stream_xyz(BufReader::with_capacity(STREAMED_AT_ONCE, stream), cube, monitor)?
            }
            _ => return Err(InputError::Unknown { looks: "is no LAS, LAZ, E57 or table of points" }),
        };
        Ok(Self { hash: hasher.digest128(), up: Up::Z, geometry: Geometry::Points(Arc::new(cloud)) })
    }

    /// The hash as recipes carry it: 32 hexadecimal digits.
    pub fn hash_text(&self) -> String {
        format!("{:032x}", self.hash)
    }

    /// How much it holds: `1200 triangles`, `80000 points`, `512×512 pixels`.
    pub fn extent(&self) -> String {
        match &self.geometry {
            Geometry::Mesh(mesh) => format!("{} triangles", mesh.triangles.len()),
            Geometry::Points(cloud) => format!("{} points", cloud.positions.len()),
            Geometry::Cylinders(table) => format!("{} cylinders", table.count()),
            Geometry::Picture(picture) => {
                format!("{}×{} pixels", picture.picture.width(), picture.picture.height())
            }
        }
    }

    /// `mesh`, `points`, `cylinders` or `picture`.
    pub const fn kind(&self) -> &'static str {
        match self.geometry {
            Geometry::Mesh(_) => "mesh",
            Geometry::Points(_) => "points",
            Geometry::Cylinders(_) => "cylinders",
            Geometry::Picture(_) => "picture",
        }
    }
}

/// Bytes of a stream that are held at once.
const STREAMED_AT_ONCE: usize = 1 << 18;

/// What a file with this opening is, if points are streamed from such files.
fn streamed_kind(name: &str, opening: &[u8]) -> Option<InputKind> {
    // Up to the last whole line, as long as the text is not cut within it.
    let kind = match sniff(opening, name) {
        Ok(kind @ (InputKind::LasPoints | InputKind::E57Points)) => Some(kind),
        _ => {
            let end = opening.iter().rposition(|&byte| byte == b'\n')?;
            sniff(&opening[..end], name).ok()
        }
    };
    kind.filter(|kind| matches!(kind, InputKind::LasPoints | InputKind::E57Points | InputKind::XyzPoints))
}

/// Reads until a piece is full or the stream ends; how many bytes.
fn fill(stream: &mut impl Read, piece: &mut [u8]) -> std::io::Result<usize> {
    let mut count = 0;
    while count < piece.len() {
        match stream.read(&mut piece[count..]) {
            Ok(0) => break,
            Ok(read) => count += read,
            Err(error) if error.kind() == std::io::ErrorKind::Interrupted => {}
            Err(error) => return Err(error),
        }
    }
    Ok(count)
}

impl From<ThinError> for InputError {
    fn from(error: ThinError) -> Self {
        match error {
            ThinError::Memory(over) => over.into(),
            ThinError::Cancelled(cancelled) => cancelled.into(),
        }
    }
}
