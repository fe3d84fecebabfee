//! Memory that writing takes beside the scene: asked for before it is taken.

use linden_pipeline::Monitor;
use linden_pipeline::memory::bytes_of;
use linden_pipeline::scene::Mesh;
use linden_pipeline::stage::Stage;

use crate::ExportError;
use crate::writing::distinct::DistinctMeshes;
use crate::writing::pictures::NamedPicture;
use crate::writing::records;

/// Asks for what a format takes: the stage, its pictures as files, and `more` bytes beside them.
///
/// # Errors
/// [`ExportError::Memory`] where there may not be so much.
pub fn admit(
    stage: &Stage<'_>,
    pictures: &[NamedPicture<'_>],
    more: u64,
    monitor: &dyn Monitor,
) -> Result<(), ExportError> {
    let each = |named: &NamedPicture<'_>| {
        named.picture.rgba().len() as u64 / 4 * named.format.encoding_bytes_per_pixel()
    };
    let compressing: u64 = pictures.iter().map(each).sum();
    let bytes = stage.bytes().saturating_add(compressing).saturating_add(more);
    Ok(monitor.admit("writing the files", bytes, "lower sides or bark_size, or grow a smaller tree")?)
}

/// Bytes of the text while the records of one list after the other are formatted.
pub fn formatting(distinct: &DistinctMeshes<'_>) -> u64 {
    let records = distinct.parts().map(|piece| piece.mesh.positions.len().max(piece.mesh.triangles.len()));
    let placements = distinct.parts().filter_map(|piece| Some(piece.copies.as_ref()?.placements.len()));
    let nodes = distinct.models.iter().map(|model| model.scene.skeleton.positions.len());
    records::bytes(records.chain(nodes).chain(placements.max()).max().unwrap_or(0))
}

/// The most that a mesh takes, where meshes are written one after the other.
pub fn largest(distinct: &DistinctMeshes<'_>, bytes: impl Fn(&Mesh) -> u64) -> u64 {
    distinct.parts().map(|piece| bytes(&piece.mesh)).max().unwrap_or(0)
}

/// Bytes of a list with one item for each vertex.
pub fn per_vertex<T>(mesh: &Mesh) -> u64 {
    bytes_of::<T>(mesh.positions.len())
}
