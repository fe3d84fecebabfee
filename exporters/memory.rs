//! How much memory writing takes beside the scene: told before it is taken.

use linden::Monitor;
use linden::memory::bytes_of;
use linden::scene::{Part, Scene};

use crate::picture::Named;
use crate::{ExportError, chunks};

/// Bytes a pixel while a picture is compressed: its three colours, filtered, and the file, which moves
/// to a larger place while it grows (measured).
const BYTES_PER_PIXEL: u64 = 8;

/// Asks for what a format takes: the scene, its pictures as files, and `own` beside them.
pub(crate) fn admit(
    scene: &Scene,
    pictures: &[Named<'_>],
    own: u64,
    monitor: &dyn Monitor,
) -> Result<(), ExportError> {
    let compressing: u64 =
        pictures.iter().map(|named| named.picture.rgba().len() as u64 / 4 * BYTES_PER_PIXEL).sum();
    let bytes = scene.bytes().saturating_add(compressing).saturating_add(own);
    Ok(monitor.admit("writing the files", bytes, "lower sides or bark_size, or grow a smaller tree")?)
}

/// Bytes of the text while the records of one list after the other are formatted.
pub(crate) fn formatting(scene: &Scene) -> u64 {
    let records =
        scene.parts.iter().map(|part| part.mesh.positions.len().max(part.mesh.triangles.len())).max();
    chunks::bytes(records.unwrap_or(0).max(scene.skeleton.positions.len()))
}

/// The most that a part takes, where parts are written one after the other.
pub(crate) fn largest(scene: &Scene, bytes: impl Fn(&Part) -> u64) -> u64 {
    scene.parts.iter().map(bytes).max().unwrap_or(0)
}

/// Bytes of a list with one item for each vertex.
pub(crate) fn per_vertex<T>(part: &Part) -> u64 {
    bytes_of::<T>(part.mesh.positions.len())
}
