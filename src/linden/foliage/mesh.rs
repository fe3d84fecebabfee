//! Organs → meshes, one for each colour.

use glam::Vec3;
use rayon::prelude::*;

use super::outline::Filler;
use super::{Organs, PROTOTYPES};
use crate::memory::OverMemory;
use crate::monitor::{Cancelled, Monitor};
use crate::scene::Mesh;

/// Organs that one task makes triangles of.
const PER_TASK: usize = 1024;

/// All organs of one colour.
#[derive(Clone, Debug, PartialEq)]
pub struct Foliage {
    /// Index of the colour.
    pub color: usize,
    /// Their triangles; not empty.
    pub mesh: Mesh,
}

/// Why there is no foliage.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum FoliageError {
    /// The result was no longer wanted.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// There is no memory for it.
    #[error(transparent)]
    Memory(#[from] OverMemory),
    /// More vertices than an index of 32 bits can name.
    #[error(
        "the foliage would have {vertices} vertices, more than the 4294967294 that mesh formats can index; use fewer derivations"
    )]
    TooLarge {
        /// How many there would be.
        vertices: u64,
    },
}

/// Makes triangles of all organs. There are `colors` colours, at least one; organs with a higher index
/// have the last. A colour that no organ has is left out.
///
/// The triangles are counter-clockwise seen from an organ's upper side, and the normals point there:
/// the backs are to be drawn too.
///
/// # Errors
/// [`FoliageError`]: too large, or cancelled.
pub fn meshes(organs: &Organs, colors: usize, monitor: &dyn Monitor) -> Result<Vec<Foliage>, FoliageError> {
    let (vertices, triangles) = organs.amount();
    // The largest index is left out: glTF reserves it.
    if vertices >= u32::MAX.into() {
        return Err(FoliageError::TooLarge { vertices });
    }
    // The pieces of all tasks, grown one by one, and then the whole.
    let bytes = Mesh::bytes_for(vertices as usize, triangles as usize);
    monitor.admit("shaping the leaves", bytes.saturating_mul(4), "use fewer derivations")?;
    let tasks = organs.len().div_ceil(PER_TASK);
    let pieces = (0..tasks).into_par_iter().map(|task| {
        monitor.check()?;
        let mut pieces = Pieces { last: colors.saturating_sub(1), of: Vec::new() };
        let mut shaper = Shaper::default();
        for organ in task * PER_TASK..organs.len().min((task + 1) * PER_TASK) {
            shaper.add(organs, organ, pieces.mesh(organs.growth(organ).color));
        }
        // Outlines without an inside may have been the only ones of a colour.
        pieces.of.retain(|piece| !piece.mesh.triangles.is_empty());
        Ok(pieces.of)
    });
    let pieces = pieces.collect::<Result<Vec<_>, Cancelled>>()?;
    let mut all: Vec<Foliage> = Vec::new();
    for piece in pieces.into_iter().flatten() {
        match all.iter_mut().find(|known| known.color == piece.color) {
            Some(known) => append(&mut known.mesh, &piece.mesh),
            None => all.push(piece),
        }
    }
    all.sort_by_key(|foliage| foliage.color);
    Ok(all)
}

/// What one task has made.
struct Pieces {
    /// The last colour.
    last: usize,
    of: Vec<Foliage>,
}

impl Pieces {
    fn mesh(&mut self, color: u32) -> &mut Mesh {
        let color = (color as usize).min(self.last);
        let at = self.of.iter().position(|piece| piece.color == color).unwrap_or_else(|| {
            self.of.push(Foliage { color, mesh: Mesh::default() });
            self.of.len() - 1
        });
        &mut self.of[at].mesh
    }
}

/// Makes triangles of one organ after the other.
#[derive(Default)]
pub struct Shaper {
    filler: Filler,
}

impl Shaper {
    /// Adds an organ (the polygons come first, see [`Organs::growth`]) to a mesh. An outline without an
    /// inside adds nothing.
    pub fn add(&mut self, organs: &Organs, organ: usize, mesh: &mut Mesh) {
        match organ.checked_sub(organs.polygons.ends.len()) {
            None => self.polygon(organs, organ, mesh),
            Some(placed) => place(organs, placed, mesh),
        }
    }

    fn polygon(&mut self, organs: &Organs, polygon: usize, mesh: &mut Mesh) {
        let own = &organs.polygons;
        let corners = organs.corners_of(polygon);
        let filled = self.filler.fill(corners, own.headings[polygon], own.ups[polygon]);
        let Some(filled) = filled else { return };
        let first = mesh.positions.len() as u32;
        for &(corner, uv) in &filled.corners {
            mesh.positions.push(corners[corner as usize]);
            mesh.normals.push(filled.normal);
            mesh.uvs.push(uv);
        }
        mesh.triangles.extend(filled.triangles.as_chunks().0.iter().map(|t: &[u32; 3]| t.map(|v| first + v)));
    }
}

fn place(organs: &Organs, placed: usize, mesh: &mut Mesh) {
    let prototype = PROTOTYPES[organs.placed.prototypes[placed] as usize].mesh();
    let first = mesh.positions.len() as u32;
    mesh.positions.extend(prototype.positions.iter().map(|&p| organs.place(placed, p)));
    mesh.normals.extend(prototype.normals.iter().map(|&n| organs.turn(placed, n).normalize_or(Vec3::Y)));
    mesh.uvs.extend_from_slice(&prototype.uvs);
    mesh.triangles.extend(prototype.triangles.iter().map(|t| t.map(|v| first + v)));
}

fn append(mesh: &mut Mesh, other: &Mesh) {
    let first = mesh.positions.len() as u32;
    mesh.positions.extend_from_slice(&other.positions);
    mesh.normals.extend_from_slice(&other.normals);
    mesh.uvs.extend_from_slice(&other.uvs);
    mesh.triangles.extend(other.triangles.iter().map(|t| t.map(|v| first + v)));
}
