//! Leaves that have fallen.

use std::sync::Arc;

use glam::{Quat, Vec2, Vec3};

use super::{GroundCover, GroundPatch, Meadow, lying, variant};
use crate::foliage::{FallenLeaf, Placement, RIM};
use crate::scene::{Material, Scene, Wrap};
use crate::stage::Stage;
use crate::texture::leaf::LeafError;
use linden_base::color::{decode, encode, luminance};
use linden_base::mesh::{Bounds, Mesh};
use linden_base::monitor::Monitor;
use linden_base::picture::Picture;
use linden_base::random::Key;

/// Different patches of a plant.
const VARIANTS: usize = 2;
/// Leaves of a patch at most, and its triangles.
const MOST_LEAVES: f32 = 160.0;
const MOST_TRIANGLES: f32 = 4000.0;
/// The share of the ground that leaves hide below a crown.
const HIDDEN: f32 = 0.5;
/// How far they lie from the stem, in radii of the crown.
const SPREAD: f32 = 1.25;
/// No more plants than this give leaves: those of a forest are much alike.
const MOST_PLANTS: usize = 4;
/// Linear colours of dead leaves, dark and light.
const DARK: [f32; 3] = [0.035, 0.018, 0.009];
const LIGHT: [f32; 3] = [0.24, 0.13, 0.06];
/// How much they keep of the colours in which they fell.
const FRESH: f32 = 0.3;

/// Patches below the crowns of plants that have leaves.
pub(super) fn patches(
    stage: &Stage<'_>,
    key: Key,
    monitor: &dyn Monitor,
) -> Result<Vec<GroundPatch>, LeafError> {
    let mut patches: Vec<GroundPatch> = Vec::new();
    for (plant, of) in stage.plants.iter().enumerate() {
        let Some(scene) = of.levels().first().map(|level| level.scene) else { continue };
        let Some(leaf) = scene.organs.fallen_leaf(monitor)? else { continue };
        let Some(crown_m) = crown_radius_m(scene) else { continue };
        if patches.len() >= MOST_PLANTS * VARIANTS {
            break;
        }
        let places: Vec<_> = stage.places.iter().filter(|place| place.plant == plant).collect();
        // Plants that stand often share the number of places of a kind.
        let share = libm::sqrtf(places.len().max(1) as f32);
        let mut meadow = Meadow::new(Vec2::ZERO, SPREAD * crown_m);
        meadow.spacing_m *= share;
        let mut placements: Vec<Vec<Placement>> = vec![Vec::new(); VARIANTS];
        for (number, place) in places.iter().enumerate() {
            let key = key.child(plant as u64).child(number as u64);
            for (at, share, key) in meadow.places(key) {
                // All of the ground below the crown, then less and less.
                if key.named("kept").unit() > f64::from((1.0 - share) * 3.0) {
                    continue;
                }
                let at = Vec2::new(place.position.x, place.position.z) + at * place.scale;
                placements[variant(key, VARIANTS)].push(lying(at, key));
            }
        }
        let material = material(&leaf, patches.len() / VARIANTS);
        for (index, placements) in placements.into_iter().enumerate() {
            if placements.is_empty() {
                continue;
            }
            patches.push(GroundPatch {
                kind: GroundCover::Litter,
                name: format!("Ground_litter_{}", patches.len() + 1),
                mesh: patch(&leaf, meadow.reach_m(), key.named("patch").child(index as u64)),
                material: material.clone(),
                placements,
            });
        }
    }
    Ok(patches)
}

/// How far a plant reaches from its foot, on average, metres.
fn crown_radius_m(scene: &Scene) -> Option<f32> {
    let boxes = scene.parts.iter().filter_map(|part| part.mesh.bounds());
    let Bounds { min, max } = boxes.reduce(Bounds::union)?;
    Some((0.25 * (max.x - min.x + max.z - min.z)).max(0.1))
}

/// Leaves that lie about, as many as hide a share of the ground.
fn patch(leaf: &FallenLeaf, reach_m: f32, key: Key) -> Mesh {
    let area_m2 = std::f32::consts::PI * reach_m * reach_m;
    let wanted = HIDDEN * area_m2 / leaf.area_m2.max(1e-6);
    let triangles = leaf.meshes.iter().map(|mesh| mesh.triangles.len()).max().unwrap_or(1).max(1);
    let most = MOST_LEAVES.min(MOST_TRIANGLES / triangles as f32).max(1.0);
    let mut mesh = Mesh::default();
    for number in 0..wanted.clamp(1.0, most) as u64 {
        let key = key.child(number);
        let leaf_mesh = &leaf.meshes[variant(key, leaf.meshes.len())];
        let at = key.named("at").in_disc().as_vec2() * reach_m;
        let turn = key.named("turn").between(0.0, std::f64::consts::TAU) as f32;
        let size_m = leaf.size_m * key.named("size").between(0.75, 1.1) as f32;
        // Either side up, tilted a little.
        let flip = if key.named("side").unit() < 0.5 { 1.0 } else { -1.0 };
        let tilt = key.named("tilt").on_circle().as_vec2() * key.named("slope").between(0.0, 0.4) as f32;
        let rotation = Quat::from_scaled_axis(Vec3::new(tilt.x, 0.0, tilt.y))
            * Quat::from_rotation_y(turn)
            * Quat::from_rotation_x(-0.5 * std::f32::consts::PI * flip);
        let first = mesh.positions.len() as u32;
        let points: Vec<Vec3> = leaf_mesh.positions.iter().map(|&p| rotation * (p * size_m)).collect();
        let low = points.iter().map(|p| p.y).fold(f32::INFINITY, f32::min);
        let lift = 0.004 - low;
        mesh.positions.extend(points.iter().map(|p| *p + Vec3::new(at.x, lift, at.y)));
        mesh.normals.extend(leaf_mesh.normals.iter().map(|&normal| rotation * normal));
        mesh.uvs.extend_from_slice(&leaf_mesh.uvs);
        mesh.triangles.extend(leaf_mesh.triangles.iter().map(|triangle| triangle.map(|v| v + first)));
    }
    mesh
}

/// The leaf's picture in autumn turned brown; its veins and its outline are kept.
fn material(leaf: &FallenLeaf, number: usize) -> Material {
    let brown = |light: f32| [0, 1, 2].map(|i| DARK[i] + (LIGHT[i] - DARK[i]) * light);
    let picture = leaf.picture.as_ref().map(|picture| {
        let opaque = |pixel: &[u8]| pixel[3] >= 128;
        let light =
            |pixel: &[u8]| luminance([0, 1, 2].map(|channel| decode(f32::from(pixel[channel]) / 255.0)));
        let lights = picture.rgba().chunks_exact(4).filter(|pixel| opaque(pixel)).map(light);
        let (sum, count) = lights.fold((0.0_f64, 0_u32), |(sum, n), x| (sum + f64::from(x), n + 1));
        let mean = (sum / f64::from(count.max(1))).max(1e-3) as f32;
        let brown = |pixel: &[u8]| {
            let dry = brown((0.45 * light(pixel) / mean).clamp(0.0, 1.0));
            let [r, g, b] = [0, 1, 2].map(|channel| {
                let fresh = decode(f32::from(pixel[channel]) / 255.0);
                libm::roundf(255.0 * encode(dry[channel] + FRESH * (fresh - dry[channel]))) as u8
            });
            [r, g, b, pixel[3]]
        };
        let rgba = picture.rgba().chunks_exact(4).flat_map(brown).collect();
        Arc::new(Picture::new(picture.width(), picture.height(), rgba))
    });
    Material {
        name: if number == 0 { "litter".to_owned() } else { format!("litter_{}", number + 1) },
        base_color: brown(0.45),
        cutout: picture.is_some().then_some(RIM),
        base_color_picture: picture,
        normal_picture: None,
        roughness: 0.9,
        double_sided: true,
        wrap: Wrap::Clamp,
        translucency: None,
        passing_picture: None,
    }
}
