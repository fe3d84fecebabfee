//! Files that were read, by the names that settings have for them.

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::DVec3;
use xxhash_rust::xxh3::xxh3_128;

use super::{
    Cloud, CylinderRow, CylinderTable, InputError, InputKind, PlyData, TriangleMesh, Up, UserPicture,
    picture, read_cylinders, read_e57, read_grid, read_las, read_obj, read_pcd, read_picture, read_ply,
    read_ptx, read_xyz, sniff,
};
use crate::memory::bytes_of;
use crate::monitor::Monitor;

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

    /// Reads a mesh (OBJ, PLY with faces), points (PLY without, XYZ, LAS, E57, PCD, PTX, ASC), a table of cylinders or a
    /// picture (PNG, JPEG, WebP, TGA). The file's name decides only where its content does not: between two kinds, and that
    /// it is TGA.
    ///
    /// # Errors
    /// Anything that is wrong with the file, and files of other kinds.
    pub fn read(name: &str, bytes: &[u8], monitor: &dyn Monitor) -> Result<Self, InputError> {
        // Whatever claims to be a picture is read as one: the picture's reader says best what it is not.
        if picture::claims_to_be_picture(name, bytes) {
            let geometry = Geometry::Picture(Arc::new(read_picture(name, bytes, monitor)?));
            return Ok(Self { hash: xxh3_128(bytes), up: Up::Y, geometry });
        }
        let (up, geometry) = match sniff(bytes, name)? {
            InputKind::ObjMesh => (Up::Y, Geometry::Mesh(Arc::new(read_obj(bytes, monitor)?))),
            InputKind::PlyMesh | InputKind::PlyPoints => {
                let PlyData { positions, faces: triangles, trees, leaves } = read_ply(bytes, monitor)?;
                let geometry = if triangles.is_empty() {
                    Geometry::Points(Arc::new(Cloud { positions, trees, leaves, ..Cloud::default() }))
                } else {
                    Geometry::Mesh(Arc::new(TriangleMesh { positions, triangles }))
                };
                (Up::Y, geometry)
            }
            InputKind::XyzPoints => (Up::Z, Geometry::Points(Arc::new(read_xyz(bytes, monitor)?))),
            InputKind::LasPoints => (Up::Z, Geometry::Points(Arc::new(read_las(bytes, monitor)?))),
            InputKind::E57Points => (Up::Z, Geometry::Points(Arc::new(read_e57(bytes, monitor)?.into()))),
            InputKind::PcdPoints => (Up::Z, Geometry::Points(Arc::new(read_pcd(bytes, monitor)?))),
            InputKind::PtxPoints => (Up::Z, Geometry::Points(Arc::new(read_ptx(bytes, monitor)?.into()))),
            InputKind::HeightGrid => (Up::Z, Geometry::Points(Arc::new(read_grid(bytes, monitor)?))),
            InputKind::Cylinders { .. } => {
                let table = read_cylinders(bytes, monitor)?;
                (table.dialect.up(), Geometry::Cylinders(Arc::new(table)))
            }
            InputKind::Preset | InputKind::Grammar | InputKind::Recipe | InputKind::TreeParameters => {
                let looks = "is a preset, grammar, recipe or parameters of a tree; expected a mesh (OBJ, PLY), points (PLY, XYZ, LAS, E57, PCD, PTX, ASC), cylinders (CSV) or a picture";
                return Err(InputError::Unknown { looks });
            }
        };
        Ok(Self { hash: xxh3_128(bytes), up, geometry })
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
