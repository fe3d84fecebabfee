//! One block of cells: its corners' signs, its cells' sheets, a vertex for each sheet.

use glam::{IVec3, Vec3};

use super::cells::{self, NO_SHEET, Sheets};
use super::field::{Nearest, Piece};
use super::{BLOCK, Lattice, each};

/// Corners along an edge of the block, with one more cell on either side.
const CORNERS: i32 = BLOCK + 3;

/// A vertex of the solid.
#[derive(Clone, Copy, Debug)]
pub(super) struct Vertex {
    pub place: Vec3,
    pub normal: Vec3,
    /// The nearest piece.
    pub piece: u32,
}

/// A cell with the surface in it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cell {
    /// Within the block: `x + 16 (y + 16 z)`.
    pub index: u16,
    /// Bits of the corners inside.
    pub inside: u8,
    pub sheets: Sheets,
    /// Its first vertex, among the block's.
    pub first: u32,
}

/// A block that the surface passes through.
#[derive(Clone, Debug)]
pub(super) struct Block {
    pub place: IVec3,
    /// By index.
    pub cells: Vec<Cell>,
    pub vertices: Vec<Vertex>,
}

impl Block {
    /// Contours a block; `None` where the surface does not pass.
    pub fn contour(place: IVec3, indices: &[u32], pieces: &[Piece], lattice: &Lattice) -> Option<Self> {
        let corners = Corners::new(place, indices, pieces, lattice)?;
        let mut block = Self { place, cells: Vec::new(), vertices: Vec::new() };
        for cell in each(IVec3::ZERO, IVec3::splat(BLOCK - 1)) {
            let inside = corners.inside(cell);
            if inside == 0 || inside == u8::MAX {
                continue;
            }
            let unflipped = cells::sheets(inside, 0);
            let mut flipped = 0;
            for face in 0..6 {
                if cells::is_ambiguous(inside, face) && cells::is_pinched(&unflipped, face) {
                    let mut beyond = cell;
                    beyond[face / 2] += if face % 2 == 0 { -1 } else { 1 };
                    let theirs = cells::sheets(corners.inside(beyond), 0);
                    flipped |= u8::from(cells::is_pinched(&theirs, face ^ 1)) << face;
                }
            }
            let sheets = if flipped == 0 { unflipped } else { cells::sheets(inside, flipped) };
            let first = block.vertices.len() as u32;
            for sheet in 0..sheets.count {
                block.vertices.push(corners.vertex(cell, &sheets, sheet, indices, pieces));
            }
            let index = (cell.x + BLOCK * (cell.y + BLOCK * cell.z)) as u16;
            block.cells.push(Cell { index, inside, sheets, first });
        }
        (!block.cells.is_empty()).then_some(block)
    }

    /// The vertex of a cell's sheet at one of its edges, among the block's.
    pub fn vertex_at(&self, index: u16, edge: usize) -> Option<u32> {
        let at = self.cells.binary_search_by_key(&index, |cell| cell.index).ok()?;
        let cell = &self.cells[at];
        let sheet = cell.sheets.of_edge[edge];
        (sheet != NO_SHEET).then(|| cell.first + u32::from(sheet))
    }
}

/// The field at the corners of a block's cells, and of those around it.
struct Corners<'a> {
    /// The lattice's corner that comes first.
    origin: IVec3,
    values: Vec<f32>,
    lattice: &'a Lattice,
}

impl<'a> Corners<'a> {
    fn new(place: IVec3, indices: &[u32], pieces: &[Piece], lattice: &'a Lattice) -> Option<Self> {
        let origin = place * BLOCK - 1;
        let middle = (place.as_vec3() + 0.5) * lattice.block_m();
        let corner_m = 0.5 * 3.0_f32.sqrt() * (lattice.block_m() + 3.0 * lattice.cell_m);
        // Deep within thick wood nothing shows. A flare's ridges bend distances, so they do not count.
        let is_deep = |&index: &u32| {
            let piece = &pieces[index as usize];
            piece.flare.is_none() && piece.near(middle).distance_m < -1.2 * corner_m
        };
        if indices.iter().any(is_deep) {
            return None;
        }
        let mut nearest = vec![Nearest::default(); (CORNERS * CORNERS * CORNERS) as usize];
        for &index in indices {
            let piece = &pieces[index as usize];
            let reach = piece.reach_m(lattice.collar, lattice.cell_m);
            let (center, radius) = piece.sphere();
            let last = IVec3::splat(CORNERS - 1);
            let bound = |at: Vec3| (at / lattice.cell_m).floor().as_ivec3() - origin;
            let low = bound(center - radius - reach).clamp(IVec3::ZERO, last);
            let high = (bound(center + radius + reach) + 1).clamp(IVec3::ZERO, last);
            for corner in each(low, high) {
                let near = piece.near((origin + corner).as_vec3() * lattice.cell_m);
                // The same pieces count at a corner whichever block it is looked at from.
                if near.distance_m < reach {
                    nearest[corner_index(corner)].meet(pieces, index, near);
                }
            }
        }
        let values = nearest.iter().map(|indices| indices.field(lattice.collar).0).collect();
        Some(Self { origin, values, lattice })
    }

    fn value(&self, corner: IVec3) -> f32 {
        self.values[corner_index(corner + 1)]
    }

    /// Which of a cell's corners are inside, a bit each. The cell may be one beyond the block.
    fn inside(&self, cell: IVec3) -> u8 {
        (0..8).fold(0, |bits, k| bits | u8::from(self.value(cell + offset(k)) < 0.0) << k)
    }

    /// The middle of where a sheet crosses the cell's edges, and from there onto the surface, within
    /// the cell.
    fn vertex(&self, cell: IVec3, sheets: &Sheets, sheet: u8, indices: &[u32], pieces: &[Piece]) -> Vertex {
        /// Vertices keep off the faces, so that no two come to lie in one place.
        const MARGIN: f32 = 0.04;
        let (mut sum, mut count) = (Vec3::ZERO, 0.0);
        for edge in (0..12).filter(|&edge| sheets.of_edge[edge] == sheet) {
            let [a, b] = cells::ends(edge).map(offset);
            let (from, to) = (self.value(cell + a), self.value(cell + b));
            let share = from / (from - to);
            // Beyond the reach of all pieces the field is infinite.
            let t = if share.is_finite() { share } else { 0.5 };
            sum += a.as_vec3().lerp(b.as_vec3(), t);
            count += 1.0;
        }
        let low = (self.origin + 1 + cell).as_vec3();
        let mut within = sum / count;
        let mut piece = indices.first().copied().unwrap_or(0);
        let mut normal = Vec3::Y;
        let rounds = if sheets.count == 1 { 2 } else { 0 };
        for round in 0..=rounds {
            let place = (low + within) * self.lattice.cell_m;
            let mut nearest = Nearest::default();
            for &index in indices {
                let near = pieces[index as usize].near(place);
                if near.distance_m < pieces[index as usize].reach_m(self.lattice.collar, self.lattice.cell_m)
                {
                    nearest.meet(pieces, index, near);
                }
            }
            let (distance, gradient) = nearest.field(self.lattice.collar);
            piece = nearest.piece().map_or(piece, |(index, _)| index);
            normal = gradient.normalize_or(normal);
            if round < rounds && distance.is_finite() {
                within -= normal * (distance / self.lattice.cell_m).clamp(-0.5, 0.5);
            }
            within = within.clamp(Vec3::splat(MARGIN), Vec3::splat(1.0 - MARGIN));
        }
        Vertex { place: (low + within) * self.lattice.cell_m, normal, piece }
    }
}

/// From a cell to one of its corners.
fn offset(corner: usize) -> IVec3 {
    IVec3::new((corner & 1) as i32, (corner >> 1 & 1) as i32, (corner >> 2) as i32)
}

/// Of a corner, counted from the first of all.
fn corner_index(corner: IVec3) -> usize {
    (corner.x + CORNERS * (corner.y + CORNERS * corner.z)) as usize
}
