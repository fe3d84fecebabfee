//! What viewports draw of a plant: its coarsest level, thinned to a budget where it has more triangles than that.
//!
//! Levels are for pictures, and the coarsest of a large tree may have a hundred thousand triangles. A proxy says where a
//! plant stands and how wide it is: of wood the largest pieces stay (a piece is what hangs together: a tube of an axis),
//! of leaves every so many, larger by as much as they became fewer, so that the crown stays as closed.

use std::borrow::Cow;

use linden_pipeline::Vec3;
use linden_pipeline::foliage::Placement;
use linden_pipeline::scene::Mesh;

use crate::writing::distinct::{MeshCopies, MeshPart};
use crate::writing::lightmap::components;

/// The triangles of a proxy, roughly: wood that hangs together as one piece stays whole.
pub(super) const MOST_TRIANGLES: usize = 5000;
/// The most that leaves become larger.
const MOST_GROWTH: f32 = 4.0;

/// The pieces of a level within the budget, without wind; `None` where it has no more than that. `is_leaf` tells leaves
/// from wood.
pub(super) fn thinned<'a>(
    pieces: &'a [MeshPart<'a>],
    is_leaf: impl Fn(&MeshPart<'_>) -> bool,
) -> Option<Vec<MeshPart<'a>>> {
    let count = |leaves: bool| -> usize {
        pieces.iter().filter(|piece| is_leaf(piece) == leaves).map(triangles).sum()
    };
    let (wood, leaves) = (count(false), count(true));
    if wood + leaves <= MOST_TRIANGLES {
        return None;
    }
    let for_wood = wood.min((MOST_TRIANGLES / 2).max(MOST_TRIANGLES.saturating_sub(leaves)));
    let thin = |piece: &'a MeshPart<'a>| match (&piece.copies, is_leaf(piece)) {
        (_, false) => largest(piece, share(for_wood, wood)),
        (None, true) => fewer(piece, share(MOST_TRIANGLES - for_wood, leaves)),
        (Some(copies), true) => fewer_copies(piece, copies, share(MOST_TRIANGLES - for_wood, leaves)),
    };
    Some(pieces.iter().filter_map(thin).collect())
}

/// Triangles of a piece, wherever it stands.
fn triangles(piece: &MeshPart<'_>) -> usize {
    piece.mesh.triangles.len() * piece.copies.as_ref().map_or(1, |copies| copies.placements.len())
}

/// A budget as a share of what there is, at most 1.
fn share(budget: usize, all: usize) -> f64 {
    (budget as f64 / all.max(1) as f64).min(1.0)
}

/// How much larger leaves are of which a share is left.
fn growth(share: f64) -> f32 {
    ((1.0 / share).sqrt() as f32).min(MOST_GROWTH)
}

/// Whether the `index`-th of many is kept, where a share of them is: evenly.
fn is_kept(index: usize, share: f64) -> bool {
    ((index + 1) as f64 * share).floor() > (index as f64 * share).floor()
}

/// Wood without its smaller pieces; the largest stays.
fn largest<'a>(piece: &'a MeshPart<'a>, share: f64) -> Option<MeshPart<'a>> {
    let islands = islands(&piece.mesh);
    let mut order: Vec<(f32, usize)> =
        islands.iter().map(|island| extent(&piece.mesh, island)).zip(0..).collect();
    order.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    let mut left = (piece.mesh.triangles.len() as f64 * share) as usize;
    let mut kept = Vec::new();
    for (rank, (_, index)) in order.into_iter().enumerate() {
        let size = islands[index].len();
        if rank > 0 && size > left {
            break;
        }
        left = left.saturating_sub(size);
        kept.push(index);
    }
    kept.sort_unstable();
    part(piece, kept.into_iter().map(|index| islands[index].as_slice()), 1.0)
}

/// Leaves as every so many of them, larger.
fn fewer<'a>(piece: &'a MeshPart<'a>, share: f64) -> Option<MeshPart<'a>> {
    let islands = islands(&piece.mesh);
    let kept = islands.iter().enumerate().filter(|(index, _)| is_kept(*index, share));
    part(piece, kept.map(|(_, island)| island.as_slice()), growth(share))
}

/// The same of copies of one mesh.
fn fewer_copies<'a>(piece: &'a MeshPart<'a>, copies: &MeshCopies<'a>, share: f64) -> Option<MeshPart<'a>> {
    let larger = |at: &Placement| Placement { scale: at.scale * growth(share), ..*at };
    let kept = copies.placements.iter().enumerate().filter(|(index, _)| is_kept(*index, share));
    let placements: Vec<Placement> = kept.map(|(_, at)| larger(at)).collect();
    let seen = Placement::bounds(&placements, piece.bounds)?;
    let copies = MeshCopies { part: copies.part, placements, seen, bindings: Vec::new() };
    Some(MeshPart {
        name: Cow::Borrowed(&piece.name),
        mesh: Cow::Borrowed(&piece.mesh),
        bounds: piece.bounds,
        material: piece.material,
        wind: None,
        copies: Some(copies),
        lightmap: None,
    })
}

/// Triangles that hang together by their vertices, in the order of their first ones.
fn islands(mesh: &Mesh) -> Vec<Vec<usize>> {
    let (of_vertices, count) = components(mesh);
    let mut numbers = vec![usize::MAX; count];
    let mut islands: Vec<Vec<usize>> = Vec::new();
    for (index, &[first, ..]) in mesh.triangles.iter().enumerate() {
        let number = &mut numbers[of_vertices[first as usize] as usize];
        if *number == usize::MAX {
            *number = islands.len();
            islands.push(Vec::new());
        }
        islands[*number].push(index);
    }
    islands
}

/// The square of the diagonal of the box around some triangles.
fn extent(mesh: &Mesh, triangles: &[usize]) -> f32 {
    let points = || corners(mesh, triangles);
    let (least, most) = points().fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(least, most), point| {
        (least.min(point), most.max(point))
    });
    (most - least).length_squared()
}

fn corners<'a>(mesh: &'a Mesh, triangles: &'a [usize]) -> impl Iterator<Item = Vec3> + 'a {
    triangles.iter().flat_map(|&index| mesh.triangles[index]).map(|vertex| mesh.positions[vertex as usize])
}

/// Some islands of a mesh as a piece, each larger about its middle; `None` of none.
fn part<'a, 'i>(
    piece: &'a MeshPart<'a>,
    islands: impl Iterator<Item = &'i [usize]>,
    growth: f32,
) -> Option<MeshPart<'a>> {
    let from = &piece.mesh;
    let mut mesh =
        Mesh { positions: Vec::new(), normals: Vec::new(), uvs: Vec::new(), triangles: Vec::new() };
    let mut new = vec![u32::MAX; from.positions.len()];
    for island in islands {
        let middle = corners(from, island).sum::<Vec3>() / (3 * island.len()) as f32;
        for &index in island {
            mesh.triangles.push(from.triangles[index].map(|vertex| {
                let old = vertex as usize;
                if new[old] == u32::MAX {
                    new[old] = mesh.positions.len() as u32;
                    let at = from.positions[old];
                    mesh.positions.push(if growth > 1.0 { middle + (at - middle) * growth } else { at });
                    mesh.normals.push(from.normals[old]);
                    mesh.uvs.push(from.uvs[old]);
                }
                new[old]
            }));
        }
    }
    let bounds = mesh.bounds()?;
    Some(MeshPart {
        name: Cow::Borrowed(&piece.name),
        mesh: Cow::Owned(mesh),
        bounds,
        material: piece.material,
        wind: None,
        copies: None,
        lightmap: None,
    })
}

#[cfg(test)]
mod tests {
    use linden_pipeline::Vec2;
    use linden_pipeline::scene::Bounds;

    use super::*;

    /// `count` ribbons of `length` quads that do not touch; the i-th is `size(i)` wide.
    fn ribbons(count: usize, length: usize, size: impl Fn(usize) -> f32) -> Mesh {
        let mut mesh = Mesh { positions: vec![], normals: vec![], uvs: vec![], triangles: vec![] };
        for ribbon in 0..count {
            let first = mesh.positions.len() as u32;
            for step in 0..=length as u32 {
                for side in [0.0, 1.0] {
                    mesh.positions.push(Vec3::new(
                        side * size(ribbon),
                        step as f32 * size(ribbon),
                        10.0 * ribbon as f32,
                    ));
                    mesh.normals.push(Vec3::Z);
                    mesh.uvs.push(Vec2::new(side, step as f32));
                }
            }
            for at in (0..length as u32).map(|step| first + 2 * step) {
                mesh.triangles.extend([[at, at + 1, at + 2], [at + 2, at + 1, at + 3]]);
            }
        }
        mesh
    }

    fn piece(name: &'static str, mesh: Mesh) -> MeshPart<'static> {
        let bounds = mesh.bounds().unwrap();
        MeshPart {
            name: Cow::Borrowed(name),
            mesh: Cow::Owned(mesh),
            bounds,
            material: 0,
            wind: None,
            copies: None,
            lightmap: None,
        }
    }

    fn is_leaf(piece: &MeshPart<'_>) -> bool {
        piece.name == "leaves"
    }

    #[test]
    fn a_level_within_the_budget_stays_as_it_is() {
        let pieces = [piece("wood", ribbons(10, 200, |_| 1.0)), piece("leaves", ribbons(400, 1, |_| 1.0))];
        assert!(thinned(&pieces, is_leaf).is_none());
    }

    #[test]
    fn of_wood_the_largest_stays_and_leaves_become_fewer_and_larger() {
        // The thirteenth bough is the largest.
        let boughs = ribbons(100, 100, |bough| if bough == 13 { 9.0 } else { 1.0 + 0.01 * bough as f32 });
        let pieces = [piece("wood", boughs), piece("leaves", ribbons(20_000, 1, |_| 0.1))];
        let thin = thinned(&pieces, is_leaf).unwrap();
        let [wood, leaves] = thin.as_slice() else { panic!("{} pieces", thin.len()) };
        assert_eq!((wood.mesh.triangles.len(), leaves.mesh.triangles.len()), (2400, 2500));
        let depths: Vec<usize> =
            wood.mesh.positions.iter().map(|at| (at.z / 10.0).round() as usize).collect();
        assert!(depths.contains(&13) && depths.contains(&99) && !depths.contains(&0), "{depths:?}");
        // An area of a sixteenth of the leaves, each sixteen times as large.
        let Bounds { min, max } = leaves.bounds;
        assert!((max.x - min.x - 0.4).abs() < 1e-5, "{:?}", leaves.bounds);
        assert_eq!(leaves.mesh.bounds(), Some(leaves.bounds));
    }

    #[test]
    fn wood_of_one_piece_stays_whole_and_copies_become_fewer() {
        let at = |x: usize| Placement {
            position: Vec3::new(x as f32, 0.0, 0.0),
            rotation: glam::Quat::IDENTITY,
            scale: 1.0,
        };
        let mut leaves = piece("leaves", ribbons(1, 10, |_| 1.0));
        let placements: Vec<Placement> = (0..1000).map(at).collect();
        let seen = Placement::bounds(&placements, leaves.bounds).unwrap();
        leaves.copies = Some(MeshCopies { part: "leaves", placements, seen, bindings: Vec::new() });
        let pieces = [piece("wood", ribbons(1, 4000, |_| 1.0)), leaves];
        let thin = thinned(&pieces, is_leaf).unwrap();
        assert_eq!(thin[0].mesh.triangles.len(), 8000);
        let copies = thin[1].copies.as_ref().unwrap();
        assert_eq!((copies.placements.len(), thin[1].mesh.triangles.len()), (125, 20));
        assert!((copies.placements[0].scale - 8.0_f32.sqrt()).abs() < 1e-5);
        assert_eq!(copies.seen, Placement::bounds(&copies.placements, thin[1].bounds).unwrap());
    }
}
