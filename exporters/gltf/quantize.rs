//! Vertices in fewer bits (`KHR_mesh_quantization`): positions in 16 bits of a cube around the plant,
//! normals and tangents in 8, texture coordinates in 16 of the range that their material uses.
//!
//! The cube is the nodes' business (translation and one scale, so that normals need no other), the range
//! the textures' (`KHR_texture_transform`).

use glam::{Vec2, Vec3};
use linden_pipeline::scene::{Bounds, Mesh};

use super::byte_sink::ByteSink;
use super::tangents::tangents;
use crate::ExportError;
use crate::writing::distinct::{DistinctMeshes, MeshPart};
use crate::writing::pictures::{self, NamedPicture};

/// What readers need for positions, and for texture coordinates.
pub(super) const EXTENSIONS: [&str; 2] = ["KHR_mesh_quantization", "KHR_texture_transform"];

/// Steps of 16 bits.
const STEPS: f32 = 65535.0;

/// The cube that positions are told in, and the ranges of texture coordinates.
pub(super) struct Quanta {
    /// By plant.
    cubes: Vec<Cube>,
    /// By material; `None` where no picture is seen.
    ranges: Vec<Option<Range>>,
}

/// A cube: stored 0 to 1 each way.
#[derive(Clone, Copy)]
pub(super) struct Cube {
    pub corner: Vec3,
    /// Metres.
    pub side: f32,
}

/// A range of texture coordinates, V down: stored 0 to 1 each way.
#[derive(Clone, Copy)]
pub(super) struct Range {
    pub offset: Vec2,
    pub scale: Vec2,
}

impl Quanta {
    pub fn new(distinct: &DistinctMeshes<'_>, pictures: &[NamedPicture<'_>]) -> Self {
        let cube = |plant: usize| {
            let pieces = distinct.models_of(plant).iter().flat_map(|model| &model.parts);
            let bounds = pieces.filter(|piece| piece.copies.is_none()).map(|piece| piece.bounds);
            let bounds = bounds.reduce(Bounds::union);
            Cube::around(bounds.unwrap_or(Bounds { min: Vec3::ZERO, max: Vec3::ONE }))
        };
        let range = |material: usize| {
            let named = &distinct.materials[material];
            let shown = [&named.material.base_color_picture, &named.material.normal_picture];
            shown.into_iter().find_map(|picture| pictures::index_of(pictures, picture.as_ref()))?;
            let pieces = distinct
                .models
                .iter()
                .flat_map(|model| &model.parts)
                .filter(|piece| piece.material == material);
            let uvs = pieces.flat_map(|piece| &piece.mesh.uvs).map(|uv| down(*uv));
            let (low, high) = uvs.fold(None, |range: Option<(Vec2, Vec2)>, uv| {
                Some(range.map_or((uv, uv), |(low, high)| (low.min(uv), high.max(uv))))
            })?;
            Some(Range { offset: low, scale: (high - low).max(Vec2::splat(f32::MIN_POSITIVE)) })
        };
        Self {
            cubes: (0..distinct.plants()).map(cube).collect(),
            ranges: (0..distinct.materials.len()).map(range).collect(),
        }
    }

    /// That of a plant's pieces, but for those that are in units of their own.
    pub fn cube(&self, plant: usize) -> Cube {
        self.cubes[plant]
    }

    /// That of a plant's piece.
    pub fn cube_of(&self, plant: usize, piece: &MeshPart<'_>) -> Cube {
        if piece.copies.is_some() { Cube::around(piece.bounds) } else { self.cube(plant) }
    }

    pub fn range(&self, material: usize) -> Option<Range> {
        self.ranges[material]
    }
}

impl Cube {
    fn around(Bounds { min, max }: Bounds) -> Self {
        Self { corner: min, side: (max - min).max_element().max(f32::MIN_POSITIVE) }
    }

    /// A place, and a distance from it, in units of the cube.
    pub fn pivot(self, [x, y, z, distance]: [f32; 4]) -> [f32; 4] {
        let [x, y, z] = ((Vec3::new(x, y, z) - self.corner) / self.side).to_array();
        [x, y, z, distance / self.side]
    }

    /// As it is stored.
    pub fn steps(self, point: Vec3) -> [u16; 3] {
        ((point - self.corner) / self.side * STEPS).to_array().map(|x| libm::roundf(x) as u16)
    }
}

/// A part of 1 as it is stored.
pub(super) fn step(part: f32) -> u16 {
    libm::roundf(part * STEPS) as u16
}

/// V runs down in glTF.
fn down(uv: Vec2) -> Vec2 {
    Vec2::new(uv.x, 1.0 - uv.y)
}

/// A unit vector in 8 bits a component.
fn bytes(vector: Vec3) -> [i8; 3] {
    vector.to_array().map(|x| libm::roundf(x.clamp(-1.0, 1.0) * 127.0) as i8)
}

/// Writes a mesh's vertices, every item padded to four bytes.
pub(super) fn write(
    mesh: &Mesh,
    cube: Cube,
    range: Option<Range>,
    with_tangents: bool,
    out: &mut impl ByteSink,
) -> Result<(), ExportError> {
    const PIECE: usize = 1 << 15;
    for positions in mesh.positions.chunks(PIECE) {
        let steps: Vec<[u16; 4]> = positions
            .iter()
            .map(|&point| {
                let [x, y, z] = cube.steps(point);
                [x, y, z, 0]
            })
            .collect();
        out.put(bytemuck::cast_slice(&steps))?;
    }
    for normals in mesh.normals.chunks(PIECE) {
        let padded: Vec<[i8; 4]> = normals
            .iter()
            .map(|&normal| {
                let [x, y, z] = bytes(normal);
                [x, y, z, 0]
            })
            .collect();
        out.put(bytemuck::cast_slice(&padded))?;
    }
    for uvs in mesh.uvs.chunks(PIECE) {
        match range {
            Some(Range { offset, scale }) => {
                let steps: Vec<[u16; 2]> = uvs
                    .iter()
                    .map(|&uv| {
                        ((down(uv) - offset) / scale * STEPS).to_array().map(|x| libm::roundf(x) as u16)
                    })
                    .collect();
                out.put(bytemuck::cast_slice(&steps))?;
            }
            None => {
                let plain: Vec<Vec2> = uvs.iter().map(|&uv| down(uv)).collect();
                out.put(bytemuck::cast_slice(&plain))?;
            }
        }
    }
    if with_tangents {
        let packed: Vec<[i8; 4]> = tangents(mesh)
            .iter()
            .map(|tangent| {
                let [x, y, z] = bytes(tangent.truncate());
                [x, y, z, if tangent.w < 0.0 { -127 } else { 127 }]
            })
            .collect();
        out.put(bytemuck::cast_slice(&packed))?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_at_most_half_a_step_off() {
        let cube = Cube { corner: Vec3::new(-3.0, 0.0, -2.0), side: 12.0 };
        for point in [cube.corner, Vec3::new(9.0, 12.0, 10.0), Vec3::new(0.123, 4.567, -1.999)] {
            let back = cube.corner + Vec3::from_array(cube.steps(point).map(f32::from)) / STEPS * cube.side;
            assert!((back - point).abs().max_element() <= 0.51 * cube.side / STEPS, "{point} as {back}");
        }
        for i in 0..100 {
            let (sin, cos) = libm::sincosf(i as f32);
            let normal = Vec3::new(sin, cos, libm::sinf(3.0 * i as f32)).normalize();
            let back = Vec3::from_array(bytes(normal).map(f32::from)).normalize();
            // Half a step each way is a quarter of a degree, or three eighths across.
            assert!(back.dot(normal) > libm::cosf(0.007), "{normal} as {back}");
        }
    }
}
