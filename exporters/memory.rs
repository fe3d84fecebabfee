//! How much memory writing takes beside the scene: told before it is taken.

use linden::Monitor;
use linden::memory::bytes_of;
use linden::picture::PNG_BYTES_PER_PIXEL;
use linden::scene::Mesh;
use linden::stage::Stage;

use crate::cast::Cast;
use crate::picture::Named;
use crate::{ExportError, chunks};

/// Asks for what a format takes: the stage, its pictures as files, and `own` beside them.
pub(crate) fn admit(
    stage: &Stage<'_>,
    pictures: &[Named<'_>],
    own: u64,
    monitor: &dyn Monitor,
) -> Result<(), ExportError> {
    let compressing: u64 =
        pictures.iter().map(|named| named.picture.rgba().len() as u64 / 4 * PNG_BYTES_PER_PIXEL).sum();
    let bytes = stage.bytes().saturating_add(compressing).saturating_add(own);
    Ok(monitor.admit("writing the files", bytes, "lower sides or bark_size, or grow a smaller tree")?)
}

/// Bytes of the text while the records of one list after the other are formatted.
pub(crate) fn formatting(cast: &Cast<'_>) -> u64 {
    let records = cast.pieces().map(|piece| piece.mesh.positions.len().max(piece.mesh.triangles.len()));
    let placements = cast.pieces().filter_map(|piece| Some(piece.copies.as_ref()?.placements.len()));
    let nodes = cast.models.iter().map(|model| model.scene.skeleton.positions.len());
    chunks::bytes(records.chain(nodes).chain(placements.max()).max().unwrap_or(0))
}

/// The most that a mesh takes, where meshes are written one after the other.
pub(crate) fn largest(cast: &Cast<'_>, bytes: impl Fn(&Mesh) -> u64) -> u64 {
    cast.pieces().map(|piece| bytes(&piece.mesh)).max().unwrap_or(0)
}

/// Bytes of a list with one item for each vertex.
pub(crate) fn per_vertex<T>(mesh: &Mesh) -> u64 {
    bytes_of::<T>(mesh.positions.len())
}
