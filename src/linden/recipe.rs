//! A recipe: a preset, resolved, with the files it needs. Everything to grow the same tree again.

use std::sync::Arc;

use glam::DVec3;
use serde::ser::{Serialize, SerializeMap, Serializer};
use xxhash_rust::xxh3::xxh3_128;

use crate::input::{InputError, InputKind, PlyData, TriangleMesh, Up, read_obj, read_ply, read_xyz, sniff};
use crate::knob::printable;
use crate::memory::bytes_of;
use crate::monitor::Monitor;
use crate::preset::Preset;
use crate::texture::{OwnPicture, own_picture};

/// How a PNG begins.
const PNG: &[u8] = b"\x89PNG";

/// The version of linden that a recipe names: another one may grow another tree.
pub const VERSION: &str = env!("CARGO_PKG_VERSION");

/// Everything that decides a tree.
#[derive(Clone, Debug)]
pub struct Recipe {
    /// With all overrides applied.
    pub preset: Preset,
    /// The meshes or points that the preset names, in the order of [`Preset::files`]. What is missing
    /// is reported when the tree is to grow.
    pub inputs: Vec<Input>,
}

/// A file that was read: a crown envelope, a mesh of a part or a leaf, attraction points, a picture.
#[derive(Clone, Debug)]
pub struct Input {
    /// The file's name without folders, printable.
    pub name: String,
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
    /// Places.
    Points(Arc<Vec<DVec3>>),
    /// Pixels.
    Picture(Arc<OwnPicture>),
}

impl Input {
    /// Bytes that its geometry takes.
    pub fn bytes(&self) -> u64 {
        match &self.geometry {
            Geometry::Mesh(mesh) => {
                bytes_of::<DVec3>(mesh.positions.capacity()) + bytes_of::<[u32; 3]>(mesh.triangles.capacity())
            }
            Geometry::Points(points) => bytes_of::<DVec3>(points.capacity()),
            Geometry::Picture(own) => own.picture.rgba().len() as u64,
        }
    }

    /// Reads a mesh (OBJ, PLY with faces), points (PLY without, XYZ) or a picture (PNG).
    ///
    /// # Errors
    /// Anything that is wrong with the file, and files of other kinds.
    pub fn read(name: &str, bytes: &[u8], monitor: &dyn Monitor) -> Result<Self, InputError> {
        // Whatever claims to be a picture is read as one: the picture's reader says best what it is not.
        if bytes.starts_with(PNG) || name.to_ascii_lowercase().ends_with(".png") {
            let geometry = Geometry::Picture(Arc::new(own_picture(bytes, monitor)?));
            return Ok(Self { name: printable(name), hash: xxh3_128(bytes), up: Up::Y, geometry });
        }
        let (up, geometry) = match sniff(bytes, name)? {
            InputKind::ObjMesh => (Up::Y, Geometry::Mesh(Arc::new(read_obj(bytes, monitor)?))),
            InputKind::PlyMesh | InputKind::PlyPoints => {
                let PlyData { positions, faces: triangles } = read_ply(bytes, monitor)?;
                let geometry = if triangles.is_empty() {
                    Geometry::Points(Arc::new(positions))
                } else {
                    Geometry::Mesh(Arc::new(TriangleMesh { positions, triangles }))
                };
                (Up::Y, geometry)
            }
            InputKind::XyzPoints => (Up::Z, Geometry::Points(Arc::new(read_xyz(bytes, monitor)?))),
            InputKind::Preset | InputKind::Grammar | InputKind::Recipe => {
                let looks = "is a preset, grammar or recipe; expected a mesh (OBJ, PLY), points (PLY, XYZ) or a picture (PNG)";
                return Err(InputError::Unknown { looks });
            }
        };
        Ok(Self { name: printable(name), hash: xxh3_128(bytes), up, geometry })
    }

    /// The hash as recipes carry it: 32 hexadecimal digits.
    pub fn hash_text(&self) -> String {
        format!("{:032x}", self.hash)
    }

    const fn kind(&self) -> &'static str {
        match self.geometry {
            Geometry::Mesh(_) => "mesh",
            Geometry::Points(_) => "points",
            Geometry::Picture(_) => "picture",
        }
    }
}

impl Recipe {
    /// What a file held that the preset names.
    pub fn input(&self, file: &str) -> Option<&Input> {
        let index = self.preset.files().iter().position(|own| *own == file)?;
        self.inputs.get(index)
    }

    /// Gives a key that names a file ([`Preset::file_keys`]) another one, `file`, which held `input`.
    /// Whether there is such a key.
    pub fn put_file(&mut self, key: &str, file: &str, input: &Input) -> bool {
        let names = |preset: &Preset| preset.files().into_iter().map(str::to_owned).collect::<Vec<_>>();
        let before = names(&self.preset);
        if !self.preset.put_file(key, file) {
            return false;
        }
        let old = std::mem::take(&mut self.inputs);
        let find = |name: &String| old.get(before.iter().position(|own| own == name)?).cloned();
        let one = |name: &String| if name == file { Some(input.clone()) } else { find(name) };
        self.inputs = names(&self.preset).iter().filter_map(one).collect();
        true
    }

    /// One line of printable ASCII (JSON), as every exported file carries it. It is a preset
    /// document too: [`Preset::from_json`] reads it.
    pub fn to_line(&self) -> String {
        ascii_line(self)
    }
}

/// JSON as one line of printable ASCII.
pub(crate) fn ascii_line(value: &impl Serialize) -> String {
    // Neither maps with other keys than text nor failing writers: there is nothing to fail.
    let json = serde_json::to_string(value).unwrap_or_default();
    let mut line = String::with_capacity(json.len());
    for c in json.chars() {
        if (' '..='~').contains(&c) {
            line.push(c);
        } else {
            for unit in c.encode_utf16(&mut [0; 2]) {
                line.push_str(&format!("\\u{unit:04x}"));
            }
        }
    }
    line
}

impl Serialize for Recipe {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(None)?;
        map.serialize_entry("linden", VERSION)?;
        self.preset.serialize_into(&mut map)?;
        if !self.inputs.is_empty() {
            map.serialize_entry("inputs", &self.inputs)?;
        }
        map.end()
    }
}

impl Serialize for Input {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(None)?;
        map.serialize_entry("file", &self.name)?;
        map.serialize_entry("kind", self.kind())?;
        map.serialize_entry("xxh3", &self.hash_text())?;
        map.end()
    }
}
