//! All wood as one solid: a single closed surface without edges of more than two triangles.
//!
//! The signed distance from all tubes (`field`) is sampled on a lattice and contoured: a vertex for
//! each sheet of the surface in a cell, a quad for each edge of the lattice that it crosses (dual
//! marching cubes, Nielson 2004), with the faces that would pinch it flipped (`cells`). So it is closed
//! and manifold by construction, whatever the tubes do to one another. Only blocks of cells near the
//! wood exist. A block depends on the tubes alone, so that any number of threads gives the same bits.

mod block;
mod cells;
mod field;
mod mesh;

use std::ops::Range;

use glam::IVec3;
use rayon::prelude::*;

use self::block::Block;
use self::field::Piece;
use super::features::Ends;
use super::plan::{Course, Plan};
use super::{ADVICE, SurfaceError};
use linden_base::memory::bytes_of;
use linden_base::mesh::Mesh;
use linden_base::monitor::Holding;
use linden_base::monitor::{Monitor, Phase};

/// A solid of more triangles, by the area of its wood, is refused before work begins.
pub const MOST_SOLID_TRIANGLES: usize = 20_000_000;

const DOING: &str = "making the wood one solid";

/// Least thickness of wood, in edges of a cell: a thinner twig would slip between the lattice's corners.
const THINNEST_CELLS: f32 = 1.0;

/// Cells along the edge of a block.
const BLOCK: i32 = 16;

/// What the solid is made with.
struct Lattice {
    cell_m: f32,
    collar: f32,
}

impl Lattice {
    fn block_m(&self) -> f32 {
        self.cell_m * BLOCK as f32
    }
}

/// The solid of all axes' tubes.
pub(super) fn solidify(course: &Course<'_>, monitor: &dyn Monitor) -> Result<Mesh, SurfaceError> {
    let tubes = course.tubes;
    let thickest_m = course.roundness.thickest_m;
    let lattice = Lattice {
        cell_m: 2.0 * thickest_m / tubes.junction_detail.max(4) as f32,
        collar: tubes.features.collar,
    };
    if course.skeleton.axes.is_empty() || !(lattice.cell_m > 0.0) {
        return Ok(Mesh::default());
    }
    let plan = Plan::new(course, 0..course.skeleton.axes.len());
    let pieces = pieces(&plan, &lattice);
    let triangles = forecast(&pieces, &lattice) as u64;
    let extent_m = pieces.iter().fold(0.0_f32, |most, p| most.max(p.from.center.abs().max_element()));
    // Beyond, lattice indices and single precision end.
    if triangles > MOST_SOLID_TRIANGLES as u64 || extent_m > lattice.cell_m * 1e6 {
        return Err(SurfaceError::TooFine { triangles, limit: MOST_SOLID_TRIANGLES });
    }
    // Quads, cells and vertices on their way, then the mesh.
    let on_the_way = triangles * 80 + bytes_of::<Piece>(pieces.len()) + plan.bytes();
    monitor.admit(DOING, on_the_way, ADVICE)?;
    let groups = spread(&pieces, &lattice, monitor)?;
    let bytes = bytes_of::<(IVec3, u32)>(groups.iter().map(|(_, indices)| indices.len()).sum());
    let monitor: &dyn Monitor = &Holding::new(monitor, on_the_way + bytes);
    monitor.admit(DOING, 0, ADVICE)?;

    let done = std::sync::atomic::AtomicU64::new(0);
    let all = groups.len() as u64;
    let blocks = groups
        .par_iter()
        .map(|(place, indices)| {
            monitor.check()?;
            let block = Block::contour(*place, indices, &pieces, &lattice);
            let before = done.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
            monitor.advance(Phase::Solidify, before + 1, Some(all));
            Ok::<Option<Block>, SurfaceError>(block)
        })
        .collect::<Result<Vec<Option<Block>>, SurfaceError>>()?;
    let blocks: Vec<Block> = blocks.into_iter().flatten().collect();
    mesh::assemble(&blocks, &pieces, tubes.bark_tile_m, monitor)
}

/// The round cones of all tubes, none thinner than the lattice can hold.
fn pieces(plan: &Plan, lattice: &Lattice) -> Vec<Piece> {
    let least_m = THINNEST_CELLS * lattice.cell_m;
    let mut pieces = Vec::new();
    for (number, (rings, form)) in (0..).zip(plan.axes()) {
        let first = pieces.len();
        // The foot is flat, however close rings are there.
        let stands = form.collar.is_none() && form.is_stem;
        let foot = rings.first().filter(|_| stands).map(|base| [base.center, base.tangent]);
        pieces.extend(rings.windows(2).map(|pair| {
            let (mut from, to) = (pair[0], &pair[1]);
            from.radius = from.onward.max(least_m);
            Piece {
                from,
                to: to.center,
                to_radius_m: to.radius.max(least_m),
                length_m: to.along - from.along,
                tube: number,
                is_flat: [false; 2],
                flare: form.flare.filter(|flare| flare.shapes(from.along)),
                floor: foot.filter(|_| from.along > 0.0 && from.along < 1.5 * from.radius),
            }
        }));
        if let [base, ..] = &mut pieces[first..]
            && stands
        {
            base.is_flat[0] = true;
        }
        if let [.., apex] = &mut pieces[first..] {
            apex.is_flat[1] = form.ends != Ends::Bud;
        }
    }
    pieces
}

/// Triangles of the solid, about: two to a cell's edge squared, half as many again where it is oblique.
fn forecast(pieces: &[Piece], lattice: &Lattice) -> f64 {
    let area = |piece: &Piece| {
        let girth = std::f64::consts::PI * f64::from(piece.from.radius + piece.to_radius_m);
        girth * f64::from(piece.length_m)
    };
    let cell = f64::from(lattice.cell_m);
    3.0 * pieces.iter().map(area).sum::<f64>() / (cell * cell)
}

/// The pieces that have a say in each block, by block.
fn spread(
    pieces: &[Piece],
    lattice: &Lattice,
    monitor: &dyn Monitor,
) -> Result<Vec<(IVec3, Vec<u32>)>, SurfaceError> {
    let block_m = lattice.block_m();
    // From a block's middle to its farthest corner, neighbouring cells included.
    let corner_m = 0.5 * 3.0_f32.sqrt() * (block_m + 2.0 * lattice.cell_m);
    let mut pairs: Vec<(IVec3, u32)> = Vec::new();
    for (index, piece) in (0..).zip(pieces) {
        if index % 1024 == 0 {
            monitor.check()?;
            monitor.admit(DOING, bytes_of::<(IVec3, u32)>(pairs.len()) * 3, ADVICE)?;
        }
        let reach = piece.reach_m(lattice.collar, lattice.cell_m);
        let (center, radius) = piece.sphere();
        let low = ((center - radius - reach) / block_m - 0.2).floor().as_ivec3();
        let high = ((center + radius + reach) / block_m + 0.2).floor().as_ivec3();
        for place in each(low, high) {
            let middle = (place.as_vec3() + 0.5) * block_m;
            if piece.near(middle).distance_m <= reach + corner_m * 1.5 {
                pairs.push((place, index));
            }
        }
    }
    pairs.par_sort_unstable_by_key(|&(place, index)| (place.to_array(), index));
    Ok(pairs
        .chunk_by(|a, b| a.0 == b.0)
        .map(|group| (group[0].0, group.iter().map(|&(_, index)| index).collect()))
        .collect())
}

/// All places of a box, both ends included, x fastest.
fn each(low: IVec3, high: IVec3) -> impl Iterator<Item = IVec3> {
    let range = |from: i32, to: i32| -> Range<i32> { from..to + 1 };
    range(low.z, high.z).flat_map(move |z| {
        range(low.y, high.y).flat_map(move |y| (low.x..=high.x).map(move |x| IVec3::new(x, y, z)))
    })
}

#[cfg(test)]
mod tests;
