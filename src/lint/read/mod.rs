//! Files into assets: a module a format. What a format cannot say is noted as unseen.

mod arrange;
mod gltf;
mod obj;
mod picture;
mod ply;
mod usd;

use linden_base::input::InputError;
use linden_base::knob::{excerpt, printable};
use linden_base::memory::OverMemory;
use linden_base::monitor::{Cancelled, Monitor};

use crate::asset::{Asset, FileFormat};

/// Files that lie beside the one that is read: buffers, materials, pictures.
pub trait Beside {
    /// The content of a file by its name, relative to the one that is read; `None` where there is none.
    ///
    /// # Errors
    /// Why it may not be read, or could not.
    fn read(&self, name: &str) -> Result<Option<Vec<u8>>, String>;
}

/// Nothing lies beside.
pub struct NoFiles;

impl Beside for NoFiles {
    fn read(&self, _: &str) -> Result<Option<Vec<u8>>, String> {
        Ok(None)
    }
}

/// Why a file is no asset.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReadError {
    /// Another format, and what to do about it.
    #[error("it is none of the formats that are looked at: glTF, GLB, OBJ, PLY, USD{0}")]
    Format(&'static str),
    /// The file is broken.
    #[error("{format}: {problem}")]
    Broken {
        /// Which one.
        format: &'static str,
        /// For people.
        problem: String,
    },
    /// It may be whole, and is beyond what is read: another version, deeper or more than there may be, a file that is elsewhere.
    #[error("{format}: {problem}")]
    Beyond {
        /// Which one.
        format: &'static str,
        /// For people.
        problem: String,
    },
    /// It is whole, and holds no mesh: points, a skeleton.
    #[error("{0}: there are no triangles in it")]
    NoTriangles(&'static str),
    /// A layer of USD that holds no mesh, and takes its model from files that were not read.
    #[error("USD: there are no triangles in it, they are in its payload {file}, {why}")]
    Elsewhere {
        /// The file, as the layer names it; one of them, if there are several.
        file: String,
        /// Why it was not read, and what to do.
        why: String,
    },
    /// It would take too much memory.
    #[error(transparent)]
    Memory(#[from] OverMemory),
    /// Nobody wants it any more.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

impl ReadError {
    pub(crate) fn broken(format: &'static str, problem: impl AsRef<str>) -> Self {
        Self::Broken { format, problem: printable(problem.as_ref()) }
    }

    pub(crate) fn beyond(format: &'static str, problem: impl AsRef<str>) -> Self {
        Self::Beyond { format, problem: printable(problem.as_ref()) }
    }
}

impl From<InputError> for ReadError {
    fn from(error: InputError) -> Self {
        match error {
            InputError::Cancelled(cancelled) => cancelled.into(),
            InputError::Memory(over) => over.into(),
            other => Self::broken("PLY", other.to_string()),
        }
    }
}

/// How the names of files end that [`read`] may read, in small letters.
pub const ENDINGS: [&str; 8] = ["glb", "gltf", "obj", "ply", "usd", "usda", "usdc", "usdz"];

/// The most places of all meshes together: more than a forest has.
const MOST_PLACES: usize = 2_000_000;

/// For messages about memory.
const READING: &str = "reading a model";
const ADVICE: &str = "look at a smaller one";

/// Reads a file; its content says what it is, and for OBJ its name.
///
/// # Errors
/// [`ReadError`].
pub fn read(
    name: &str,
    bytes: &[u8],
    beside: &dyn Beside,
    monitor: &dyn Monitor,
) -> Result<Asset, ReadError> {
    let format = format(name, bytes)?;
    // Three times as much was measured, of text and of binary files.
    monitor.admit(READING, 6 * bytes.len() as u64, ADVICE)?;
    let mut asset = Asset { name: name.to_owned(), format, ..Asset::default() };
    match format {
        FileFormat::Gltf | FileFormat::Glb => gltf::read(&mut asset, bytes, beside, monitor)?,
        FileFormat::Obj => obj::read(&mut asset, bytes, beside)?,
        FileFormat::Ply => ply::read(&mut asset, bytes, monitor)?,
        FileFormat::Usd => usd::read(&mut asset, bytes, beside, monitor)?,
    }
    if asset.meshes.is_empty() {
        return Err(ReadError::NoTriangles(format.name()));
    }
    Ok(asset)
}

impl FileFormat {
    /// As messages have it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Gltf => "glTF",
            Self::Glb => "GLB",
            Self::Obj => "OBJ",
            Self::Ply => "PLY",
            Self::Usd => "USD",
        }
    }
}

fn format(name: &str, bytes: &[u8]) -> Result<FileFormat, ReadError> {
    let ending = name.rsplit('.').next().unwrap_or_default().to_lowercase();
    let first = bytes.iter().find(|byte| !byte.is_ascii_whitespace());
    Ok(match bytes {
        _ if bytes.starts_with(b"glTF") => FileFormat::Glb,
        _ if bytes.starts_with(b"ply") => FileFormat::Ply,
        _ if bytes.starts_with(b"#usda") || bytes.starts_with(b"PXR-USDC") => FileFormat::Usd,
        _ if bytes.starts_with(b"PK\x03\x04") && ending == "usdz" => FileFormat::Usd,
        _ if first == Some(&b'{') => FileFormat::Gltf,
        _ if ending == "obj" => FileFormat::Obj,
        _ if bytes.starts_with(b"Kaydara FBX") => {
            return Err(ReadError::Format("; write it as GLB, which Blender does"));
        }
        _ => return Err(ReadError::Format("")),
    })
}

/// A name as reports have it.
pub(crate) fn shown(name: &str) -> String {
    excerpt(name)
}
