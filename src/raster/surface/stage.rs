//! Stages: many plants at their places, each in the level of detail that its size in the picture asks for.

use glam::Vec3;
use linden_pipeline::memory::bytes_of;
use linden_pipeline::monitor::Holding;
use linden_pipeline::picture::Picture;
use linden_pipeline::scene::{Material, Mesh, Part};
use linden_pipeline::stage::{Level, Place, Plant, Stage};
use linden_pipeline::{Monitor, Skeleton};

use super::{Surface, draw_on_ground, ground_m};
use crate::memory::Ledger;
use crate::{Camera, Extent, RasterError, Size, Style, View};

/// What pictures frame of a stage, in its first season: all plants in their finest level. `None` where
/// nothing stands.
pub fn stage_extent(stage: &Stage<'_>) -> Option<Extent> {
    Extent::of(&Skeleton::default(), &stage.outermost())
}

/// Draws the plants of a stage at their places, in their first season, as [`draw_surface`](super::draw_surface) draws one. A plant
/// that is small in the picture is drawn in a coarser level, where it has such; all are in the coarsest where
/// [`Style::draft`] is.
///
/// # Errors
/// As [`draw_surface`](super::draw_surface); parts count plant by plant, level by level.
pub fn draw_stage(
    stage: &Stage<'_>,
    camera: &Camera,
    style: &Style<'_>,
    size: Size,
    monitor: &dyn Monitor,
) -> Result<Picture, RasterError> {
    let extent = stage_extent(stage).ok_or(RasterError::Empty)?;
    let view = camera.view(extent, size);
    let heights: Vec<f32> = stage.plants.iter().map(height_m).collect();
    let chosen: Vec<usize> = stage
        .places
        .iter()
        .map(|place| match stage.plants.get(place.plant) {
            Some(plant) if style.draft => plant.levels().len().saturating_sub(1),
            Some(plant) => level_for(plant.levels(), share(place, heights[place.plant], &view, size)),
            None => 0,
        })
        .collect();
    let ledger = Ledger::new(monitor);
    let mut parts = Vec::new();
    let mut materials: Vec<Material> = Vec::new();
    let mut held = 0;
    for (index, plant) in stage.plants.iter().enumerate() {
        for (at, level) in plant.levels().iter().enumerate() {
            let stands = |(place, level): &(&Place, &usize)| place.plant == index && **level == at;
            let places: Vec<&Place> =
                stage.places.iter().zip(&chosen).filter(stands).map(|(place, _)| place).collect();
            if places.is_empty() {
                continue;
            }
            for part in &level.scene.parts {
                monitor.check()?;
                let bytes = mesh_bytes(&part.mesh) * places.len() as u64;
                ledger.take(bytes)?;
                held += bytes;
                let corners = part.mesh.positions.len() * places.len();
                if u32::try_from(corners).is_err() {
                    return Err(RasterError::Mesh(parts.len()));
                }
                parts.push(Part::new(
                    part.name.clone(),
                    materials.len() + part.material,
                    standing(&part.mesh, &places),
                ));
            }
            materials.extend(level.scene.materials.iter().cloned());
        }
    }
    let surface = Surface { parts: &parts, materials: &materials, skeleton: &Skeleton::default() };
    let camera = Camera { extent: camera.extent.or(Some(extent)), ..*camera };
    let stands = |place: &Place| {
        let level = stage.plants.get(place.plant)?.levels().first()?;
        Some(place.position.y + place.scale * ground_m(&level.scene.skeleton)?)
    };
    let grounds: Option<Vec<f32>> = stage.places.iter().map(stands).collect();
    let ground_m = grounds.and_then(|grounds| grounds.into_iter().reduce(f32::min));
    draw_on_ground(&surface, ground_m, &camera, style, size, &Holding::new(monitor, held))
}

fn height_m(plant: &Plant<'_>) -> f32 {
    let positions = plant.levels().first().into_iter().flat_map(|level| &level.scene.parts);
    let heights = positions.flat_map(|part| &part.mesh.positions).map(|p| p.y);
    let (low, high) =
        heights.fold((f32::INFINITY, f32::NEG_INFINITY), |(low, high), y| (low.min(y), high.max(y)));
    (high - low).max(0.0)
}

/// The share of the picture's height that a plant takes.
fn share(place: &Place, height_m: f32, view: &View, size: Size) -> f32 {
    let middle = place.position + Vec3::Y * (height_m * place.scale / 2.0);
    view.project(middle).scale * height_m * place.scale / size.height() as f32
}

/// The finest level that a plant of this share of the picture's height needs; levels are asked from the finest.
fn level_for(levels: &[Level<'_>], share: f32) -> usize {
    levels.iter().position(|level| share >= level.coverage).unwrap_or(levels.len().saturating_sub(1))
}

fn mesh_bytes(mesh: &Mesh) -> u64 {
    bytes_of::<Vec3>(2 * mesh.positions.len())
        + bytes_of::<[f32; 2]>(mesh.uvs.len())
        + bytes_of::<[u32; 3]>(mesh.triangles.len())
}

/// A mesh as it stands at several places, in one.
fn standing(mesh: &Mesh, places: &[&Place]) -> Mesh {
    let count = mesh.positions.len();
    let mut all = Mesh {
        positions: Vec::with_capacity(count * places.len()),
        normals: Vec::with_capacity(count * places.len()),
        uvs: mesh.uvs.repeat(places.len()),
        triangles: Vec::with_capacity(mesh.triangles.len() * places.len()),
    };
    for place in places {
        let before = all.positions.len() as u32;
        match place.motion() {
            None => {
                all.positions.extend_from_slice(&mesh.positions);
                all.normals.extend_from_slice(&mesh.normals);
            }
            Some(motion) => {
                all.positions.extend(mesh.positions.iter().map(|&p| motion.point(p)));
                all.normals.extend(mesh.normals.iter().map(|&n| motion.direction(n)));
            }
        }
        all.triangles.extend(mesh.triangles.iter().map(|t| t.map(|corner| corner + before)));
    }
    all
}
