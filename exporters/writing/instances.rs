//! Foliage as few meshes in many places, for formats that have instances.
//!
//! A part's mesh ends in copies of a few shapes ([`Instances`]). Here each shape becomes a piece that
//! stands in many places, and of the part's mesh stays what is before: outlines, which are no copies.

use std::borrow::Cow;

use linden_pipeline::Monitor;
use linden_pipeline::foliage::{Copies, Instances, Placement};
use linden_pipeline::scene::{Mesh, Part};
use linden_pipeline::stage::Stage;

use crate::writing::distinct::{DistinctMeshes, MeshCopies, MeshPart};
use crate::{Bundle, ExportError};

/// What becomes of foliage that moves in the wind.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Moving {
    /// It stays as it is, copy by copy in one mesh.
    Baked,
    /// It is instances too, each with the joints that it is bound to.
    Bound,
}

/// Puts instances in the place of baked foliage, where a plant stands alone: in a forest the trees
/// themselves are the instances.
///
/// # Errors
/// [`ExportError::Memory`] and [`ExportError::Cancelled`].
pub fn unbake(
    distinct: &mut DistinctMeshes<'_>,
    stage: &Stage<'_>,
    moving: Moving,
    bundle: &mut Bundle,
    monitor: &dyn Monitor,
) -> Result<(), ExportError> {
    let stays = |part: &Part| part.wind.is_some() && moving == Moving::Baked;
    if !stage.is_single() {
        return Ok(());
    }
    let all: u64 = in_parts(distinct).map(|(_, instances)| instances.most() as u64 * Instances::BYTES).sum();
    monitor.admit("placing the leaves", stage.bytes() + all, "write without instances")?;
    if in_parts(distinct).next().is_none() {
        bundle.note("instances: nothing on this plant stands in many places");
    }
    if in_parts(distinct).any(|(part, _)| stays(part)) {
        bundle.note("instances: leaves that move in the wind are written one by one");
    }
    if in_parts(distinct).any(|(part, instances)| !stays(part) && instances.has_dome_normals()) {
        bundle.note(
            "instances: leaves have the normals of their own faces; those that point out of the crown \
             (leaf_normals=dome) differ from copy to copy",
        );
    }
    for model in &mut distinct.models {
        let mut pieces = Vec::with_capacity(model.parts.len());
        for (part, piece) in model.scene.parts.iter().zip(std::mem::take(&mut model.parts)) {
            monitor.check()?;
            match &part.instances {
                Some(instances) if !stays(part) => split(part, instances, piece, &mut pieces),
                _ => pieces.push(piece),
            }
        }
        model.parts = pieces;
    }
    Ok(())
}

/// Parts that have instances.
fn in_parts<'a>(distinct: &DistinctMeshes<'a>) -> impl Iterator<Item = (&'a Part, &'a Instances)> {
    let parts = distinct.models.iter().flat_map(|model| &model.scene.parts);
    parts.filter_map(|part| Some((part, part.instances.as_ref()?)))
}

/// Bytes of all placements.
pub fn bytes(distinct: &DistinctMeshes<'_>) -> u64 {
    distinct.placements() as u64 * Instances::BYTES
}

fn split<'a>(part: &'a Part, instances: &'a Instances, piece: MeshPart<'a>, pieces: &mut Vec<MeshPart<'a>>) {
    let copies = instances.copies();
    let sum = |count: fn(&Mesh) -> usize| -> usize {
        copies.iter().map(|copies_of| copies_of.placements.len() * count(copies_of.mesh)).sum()
    };
    let [vertices, triangles] = [
        part.mesh.positions.len().checked_sub(sum(|mesh| mesh.positions.len())),
        part.mesh.triangles.len().checked_sub(sum(|mesh| mesh.triangles.len())),
    ];
    let (Some(vertices), Some(triangles)) = (vertices, triangles) else {
        // The mesh has been changed since.
        return pieces.push(piece);
    };
    let material = piece.material;
    if triangles > 0 {
        let mesh = start(&part.mesh, vertices, triangles);
        let bounds = mesh.bounds().unwrap_or(piece.bounds);
        pieces.push(MeshPart { mesh: Cow::Owned(mesh), bounds, ..piece });
    }
    let bindings = part.wind.as_ref().map_or(&[][..], |wind| &wind.bindings);
    for Copies { name, mesh, placements, firsts } in copies {
        let Some(bounds) = mesh.bounds() else { continue };
        let Some(seen) = Placement::bounds(&placements, bounds) else { continue };
        pieces.push(MeshPart {
            name: Cow::Owned(format!("{}_{name}", part.name)),
            mesh: Cow::Borrowed(mesh),
            bounds,
            material,
            wind: None,
            copies: Some(MeshCopies {
                part: &part.name,
                placements,
                seen,
                // All of a copy goes with the twig that bears it.
                bindings: firsts
                    .iter()
                    .filter_map(|first| bindings.get(vertices + *first as usize))
                    .copied()
                    .collect(),
            }),
            lightmap: None,
        });
    }
}

/// The first vertices and triangles of a mesh.
fn start(mesh: &Mesh, vertices: usize, triangles: usize) -> Mesh {
    Mesh {
        positions: mesh.positions[..vertices].to_vec(),
        normals: mesh.normals[..vertices].to_vec(),
        uvs: mesh.uvs[..vertices].to_vec(),
        triangles: mesh.triangles[..triangles].to_vec(),
    }
}
