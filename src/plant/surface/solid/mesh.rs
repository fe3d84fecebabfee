//! Blocks joined: a quad for each edge of the lattice that the surface crosses, and bark on it.

use std::f32::consts::TAU;

use glam::{IVec3, Vec2, Vec3};
use rayon::prelude::*;

use super::block::{Block, Vertex};
use super::field::Piece;
use super::{BLOCK, DOING};
use crate::surface::{ADVICE, SurfaceError, crowded_edges, topology, tube};
use linden_base::memory::bytes_of;
use linden_base::mesh::Mesh;
use linden_base::monitor::Monitor;
use linden_base::topology::topology_bytes;

/// Joins the blocks, which are in order of their places, and checks the result.
pub(super) fn assemble(
    blocks: &[Block],
    pieces: &[Piece],
    tile_m: f32,
    monitor: &dyn Monitor,
) -> Result<Mesh, SurfaceError> {
    let mut firsts = Vec::with_capacity(blocks.len());
    let mut vertices: Vec<Vertex> = Vec::new();
    for block in blocks {
        firsts.push(vertices.len() as u32);
        vertices.extend(&block.vertices);
    }
    let quads = blocks
        .par_iter()
        .map(|block| {
            monitor.check()?;
            Ok(quads(block, blocks, &firsts))
        })
        .collect::<Result<Vec<Vec<[u32; 4]>>, SurfaceError>>()?;
    let triangles: Vec<[u32; 3]> = quads.iter().flatten().flat_map(|quad| halves(quad, &vertices)).collect();
    drop(quads);
    // Vertices twice or thrice where pictures meet, at worst.
    let most = Mesh::bytes_for(vertices.len() * 2, triangles.len());
    let held = bytes_of::<Vertex>(vertices.len()) + bytes_of::<[u32; 3]>(triangles.len());
    monitor.admit(DOING, held + most + topology_bytes(vertices.len() * 2, triangles.len()), ADVICE)?;
    let mesh = barked(&vertices, &triangles, pieces, tile_m, monitor)?;
    let found = topology(&mesh, monitor)?;
    let crowded = crowded_edges(&mesh, monitor)?;
    if !found.watertight() || crowded > 0 {
        let edges = found.open_edges + crowded;
        return Err(SurfaceError::NotWatertight { edges, triangles: found.degenerate });
    }
    Ok(mesh)
}

/// The quads of the lattice's edges that start at corners of a block.
fn quads(block: &Block, blocks: &[Block], firsts: &[u32]) -> Vec<[u32; 4]> {
    let mut quads = Vec::new();
    for cell in &block.cells {
        let index = i32::from(cell.index);
        let at = IVec3::new(index % BLOCK, index / BLOCK % BLOCK, index / (BLOCK * BLOCK));
        for axis in 0..3 {
            let is_inside = cell.inside & 1 == 1;
            if is_inside == ((cell.inside >> (1 << axis)) & 1 == 1) {
                continue;
            }
            let (b, c) = (IVec3::AXES[(axis + 1) % 3], IVec3::AXES[(axis + 2) % 3]);
            // Round the edge, counter-clockwise seen against its direction, each cell with the name
            // that it has for the edge.
            let around = [(IVec3::ZERO, 0), (b, 1), (b + c, 3), (c, 2)];
            let found = around.map(|(step, rest)| vertex(block, at - step, 4 * axis + rest, blocks, firsts));
            // All four cells have the edge's ends, and with them the surface.
            if let [Some(p), Some(q), Some(r), Some(s)] = found {
                quads.push(if is_inside { [p, q, r, s] } else { [p, s, r, q] });
            }
        }
    }
    quads
}

/// The vertex of a cell, which may be in a block beside, at one of its edges.
fn vertex(block: &Block, cell: IVec3, edge: usize, blocks: &[Block], firsts: &[u32]) -> Option<u32> {
    let shift = cell.div_euclid(IVec3::splat(BLOCK));
    let within = cell - shift * BLOCK;
    let place = (block.place + shift).to_array();
    let at = blocks.binary_search_by_key(&place, |other| other.place.to_array()).ok()?;
    let index = (within.x + BLOCK * (within.y + BLOCK * within.z)) as u16;
    blocks[at].vertex_at(index, edge).map(|vertex| firsts[at] + vertex)
}

/// A quad along its shorter diagonal.
fn halves(&[p, q, r, s]: &[u32; 4], vertices: &[Vertex]) -> [[u32; 3]; 2] {
    let place = |i: u32| vertices[i as usize].place;
    if place(p).distance_squared(place(r)) <= place(q).distance_squared(place(s)) {
        [[p, q, r], [p, r, s]]
    } else {
        [[p, q, s], [q, r, s]]
    }
}

/// Lays the bark of the nearest axis on each triangle: pictures round the girth, and along the axis. A
/// vertex stands once for each pair of coordinates that its triangles ask for.
fn barked(
    vertices: &[Vertex],
    triangles: &[[u32; 3]],
    pieces: &[Piece],
    tile_m: f32,
    monitor: &dyn Monitor,
) -> Result<Mesh, SurfaceError> {
    let coordinates: Vec<[Vec2; 3]> = triangles
        .par_iter()
        .map(|triangle| {
            let corners = triangle.map(|i| &vertices[i as usize]);
            let guide = &pieces[corners[0].piece as usize];
            let wraps = wraps(guide, tile_m);
            let first = angle(guide, corners[0].place);
            corners.map(|corner| {
                let at_corner = &pieces[corner.piece as usize];
                let piece = if at_corner.tube == guide.tube { at_corner } else { guide };
                // The turn that is nearest to the first corner's.
                let turn = angle(piece, corner.place) - first;
                let turn = turn - TAU * (turn / TAU).round();
                let v = piece.near(corner.place).along_m / tile_m;
                Vec2::new(wraps * (first + turn) / TAU, v)
            })
        })
        .collect();
    monitor.check()?;
    let bits = |corner: usize| {
        let uv = coordinates[corner / 3][corner % 3].to_array().map(f32::to_bits);
        (triangles[corner / 3][corner % 3], uv)
    };
    let mut order: Vec<usize> = (0..3 * triangles.len()).collect();
    order.par_sort_unstable_by_key(|&corner| (bits(corner), corner));
    monitor.check()?;
    let mut indices = vec![[0; 3]; triangles.len()];
    let mut mesh = Mesh::default();
    for same in order.chunk_by(|&a, &b| bits(a) == bits(b)) {
        let index = mesh.positions.len() as u32;
        let Vertex { place, normal, .. } = vertices[bits(same[0]).0 as usize];
        mesh.positions.push(place);
        mesh.normals.push(normal);
        mesh.uvs.push(coordinates[same[0] / 3][same[0] % 3]);
        for &corner in same {
            indices[corner / 3][corner % 3] = index;
        }
    }
    mesh.triangles = indices;
    Ok(mesh)
}

fn wraps(piece: &Piece, tile_m: f32) -> f32 {
    tube::wraps(f32::midpoint(piece.from.radius, piece.to_radius_m), tile_m)
}

/// Round the axis, radians.
fn angle(piece: &Piece, place: Vec3) -> f32 {
    let from = place - piece.from.center;
    let across = piece.from.tangent.cross(piece.from.side);
    libm::atan2f(from.dot(across), from.dot(piece.from.side))
}
