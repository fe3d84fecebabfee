//! Measures whether a surface is closed, from its triangles alone.

mod proof;

use std::sync::atomic::{AtomicU32, Ordering};

use glam::{DVec3, Vec3};
use rayon::prelude::*;
use xxhash_rust::xxh3::xxh3_64;

use crate::memory::bytes_of;
use crate::mesh::Mesh;
use crate::monitor::{Cancelled, Monitor};

pub use proof::{Proofs, SOUND, SurfaceRef, is_sound};

/// What the triangles say about the surface, after vertices at the same place are made one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Topology {
    /// Directed edges without a triangle on the other side: holes, or neighbours wound differently.
    pub open_edges: usize,
    /// Triangles without area.
    pub degenerate: usize,
    /// Triangles that look the other way than their vertices' normals.
    pub flipped: usize,
    /// Positions, normals or coordinates that are not finite.
    pub not_finite: usize,
}

impl Topology {
    /// Both together.
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        Self {
            open_edges: self.open_edges + other.open_edges,
            degenerate: self.degenerate + other.degenerate,
            flipped: self.flipped + other.flipped,
            not_finite: self.not_finite + other.not_finite,
        }
    }

    /// Closed and consistently wound: each tube keeps water in. Tubes may overlap one another.
    pub fn watertight(&self) -> bool {
        self.open_edges == 0 && self.degenerate == 0 && self.not_finite == 0
    }
}

/// Measures a mesh.
///
/// # Errors
/// [`Cancelled`].
pub fn topology(mesh: &Mesh, monitor: &dyn Monitor) -> Result<Topology, Cancelled> {
    let welded = weld(&mesh.positions, monitor)?;
    let sums = mesh.triangles.par_iter().map(|triangle| {
        let corners = triangle.map(|i| mesh.positions[i as usize]);
        let leaning = triangle.iter().map(|&i| mesh.normals[i as usize]).sum();
        fault(triangle.map(|i| welded[i as usize]), corners, leaning)
    });
    monitor.check()?;
    let (degenerate, flipped) = sums.reduce(|| (0, 0), |a, b| (a.0 + b.0, a.1 + b.1));
    let not_finite = mesh.positions.iter().chain(&mesh.normals).filter(|v| !v.is_finite()).count()
        + mesh.uvs.iter().filter(|v| !v.is_finite()).count();
    monitor.check()?;
    let open_edges = open_edges(&mesh.triangles, &welded, monitor)?;
    Ok(Topology { open_edges, degenerate, flipped, not_finite })
}

/// Whether a triangle is without area, or else looks the other way than `leaning`, the sum of its normals. Which
/// of its corners are one, `welded` says.
fn fault([a, b, c]: [u32; 3], corners: [Vec3; 3], leaning: Vec3) -> (usize, usize) {
    let [p, q, r] = corners.map(Vec3::as_dvec3);
    let normal: DVec3 = (q - p).cross(r - p);
    let degenerate = a == b || b == c || c == a || normal.length_squared() == 0.0;
    let flipped = !degenerate && normal.dot(leaning.as_dvec3()) <= 0.0;
    (usize::from(degenerate), usize::from(flipped))
}

/// What [`topology`] takes at its worst, beside the mesh: three edges a triangle, and a few indices a
/// vertex.
pub const fn topology_bytes(vertices: usize, triangles: usize) -> u64 {
    bytes_of::<[(u32, bool); 3]>(triangles) + bytes_of::<[u32; 4]>(vertices)
}

/// Edges that are not run as often one way as the other.
fn open_edges(triangles: &[[u32; 3]], welded: &[u32], monitor: &dyn Monitor) -> Result<usize, Cancelled> {
    // Each edge stands with its lower vertex, as its higher one and whether it rises.
    let edges = || {
        triangles.iter().flat_map(|triangle| {
            let [a, b, c] = triangle.map(|i| welded[i as usize]);
            // From a place to itself there is no edge.
            let edges = [(a, b), (b, c), (c, a)].into_iter().filter(|(from, to)| from != to);
            edges.map(|(from, to)| (from.min(to) as usize, (from.max(to), from < to)))
        })
    };
    let at_vertex = Groups::new(welded.len(), edges);
    monitor.check()?;
    let open = at_vertex.par_sorted(|edges| {
        let ways = |same: &[(u32, bool)]| {
            let rising = same.iter().filter(|(_, rises)| *rises).count();
            rising.abs_diff(same.len() - rising)
        };
        edges.chunk_by(|a, b| a.0 == b.0).map(ways).sum::<usize>()
    });
    Ok(open.sum())
}

/// Edges of more than two triangles, after vertices at the same place are made one: 0 for a surface
/// without touching or crossing sheets.
///
/// # Errors
/// [`Cancelled`].
pub fn crowded_edges(mesh: &Mesh, monitor: &dyn Monitor) -> Result<usize, Cancelled> {
    let welded = weld(&mesh.positions, monitor)?;
    let edges = || {
        mesh.triangles.iter().flat_map(|triangle| {
            let [a, b, c] = triangle.map(|i| welded[i as usize]);
            let edges = [(a, b), (b, c), (c, a)].into_iter().filter(|(from, to)| from != to);
            edges.map(|(from, to)| (from.min(to) as usize, from.max(to)))
        })
    };
    let at_vertex = Groups::new(welded.len(), edges);
    monitor.check()?;
    let crowded = |ends: &mut [u32]| ends.chunk_by(|a, b| a == b).filter(|same| same.len() > 2).count();
    Ok(at_vertex.par_sorted(crowded).sum())
}

/// For each vertex the lowest index of a vertex at exactly the same place.
fn weld(positions: &[Vec3], monitor: &dyn Monitor) -> Result<Vec<u32>, Cancelled> {
    /// Enough for pieces that a cache holds, few enough to be written side by side.
    const MOST_PIECES: usize = 4096;
    /// Vertices of a piece where few make all.
    const PER_PIECE: usize = 64;
    // Adding zero makes -0.0 and 0.0 one place.
    let key = |i: u32| (positions[i as usize] + Vec3::ZERO).to_array().map(f32::to_bits);
    let hash = |i| xxh3_64(bytemuck::cast_slice(&key(i)));
    let hashes: Vec<u64> = (0..positions.len() as u32).into_par_iter().map(hash).collect();
    monitor.check()?;
    // Vertices at the same place have the same hash and so come into the same piece.
    let count = (positions.len() / PER_PIECE).clamp(1, MOST_PIECES);
    let pieces = Groups::new(count, || {
        hashes.iter().zip(0..).map(|(&hash, i): (_, u32)| (hash as usize % count, ((hash >> 32) as u32, i)))
    });
    let welded: Vec<AtomicU32> = (0..positions.len()).into_par_iter().map(|_| AtomicU32::new(0)).collect();
    monitor.check()?;
    pieces
        .par_sorted(|piece| {
            for alike in piece.chunk_by_mut(|a, b| a.0 == b.0) {
                alike.sort_unstable_by_key(|&(_, i)| (key(i), i));
                for same in alike.chunk_by(|a, b| key(a.1) == key(b.1)) {
                    for &(_, i) in same {
                        welded[i as usize].store(same[0].1, Ordering::Relaxed);
                    }
                }
            }
        })
        .collect::<()>();
    Ok(welded.into_iter().map(AtomicU32::into_inner).collect())
}

/// Items in numbered groups: a counting sort, in time and memory proportional to both.
struct Groups<T> {
    /// Where each group starts, and where the last one ends.
    starts: Vec<usize>,
    items: Vec<T>,
}

impl<T: Copy + Default + Ord + Send + Sync> Groups<T> {
    /// Groups what `items` gives, each time the same pairs of group and item.
    fn new<I: Iterator<Item = (usize, T)>>(groups: usize, items: impl Fn() -> I) -> Self {
        // While items are dealt, `starts[group + 1]` is where the group's next one goes.
        let mut starts = vec![0; groups + 2];
        for (group, _) in items() {
            starts[group + 2] += 1;
        }
        let mut total = 0;
        for start in &mut starts {
            total += *start;
            *start = total;
        }
        let mut dealt = vec![T::default(); total];
        for (group, item) in items() {
            dealt[starts[group + 1]] = item;
            starts[group + 1] += 1;
        }
        starts.pop();
        Self { starts, items: dealt }
    }

    /// What `look` makes of each group, given sorted.
    fn par_sorted<R: Send>(
        &self,
        look: impl Fn(&mut [T]) -> R + Sync + Send,
    ) -> impl ParallelIterator<Item = R> {
        self.starts.par_windows(2).map_init(Vec::new, move |group, range| {
            group.clear();
            group.extend_from_slice(&self.items[range[0]..range[1]]);
            group.sort_unstable();
            look(group)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Key;
    use glam::Vec2;

    fn measured(mesh: &Mesh) -> Topology {
        topology(mesh, &crate::monitor::Quiet).unwrap()
    }

    /// A tetrahedron with vertices of its own for each face.
    fn tetrahedron() -> Mesh {
        let corners = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
        let mut mesh = Mesh::default();
        for face in [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]] {
            let [a, b, c] = face.map(|i: usize| corners[i]);
            let first = mesh.positions.len() as u32;
            mesh.positions.extend([a, b, c]);
            mesh.normals.extend([(b - a).cross(c - a).normalize(); 3]);
            mesh.uvs.extend([Vec2::ZERO; 3]);
            mesh.triangles.push([first, first + 1, first + 2]);
        }
        mesh
    }

    #[test]
    fn a_tetrahedron_is_closed_and_each_damage_is_seen() {
        assert_eq!(measured(&tetrahedron()), Topology::default());

        let mut hole = tetrahedron();
        hole.triangles.pop();
        assert_eq!(measured(&hole).open_edges, 3);

        let mut turned = tetrahedron();
        turned.triangles[0].swap(0, 1);
        assert_eq!((measured(&turned).open_edges, measured(&turned).flipped), (6, 1));

        let mut flat = tetrahedron();
        flat.positions[0] = flat.positions[1];
        assert_eq!(measured(&flat).degenerate, 1);

        // An edge that has shrunk to a place opens nothing; its two faces are gone.
        let mut shrunk = tetrahedron();
        shrunk.positions.iter_mut().filter(|place| **place == Vec3::X).for_each(|place| *place = Vec3::ZERO);
        assert_eq!((measured(&shrunk).open_edges, measured(&shrunk).degenerate), (0, 2));

        let mut broken = tetrahedron();
        broken.normals[2].y = f32::NAN;
        assert_eq!(measured(&broken).not_finite, 1);
    }

    /// Counts by looking at every pair.
    fn by_definition(mesh: &Mesh) -> (usize, Vec<u32>) {
        let welded: Vec<u32> = (mesh.positions.iter())
            .map(|p| mesh.positions.iter().position(|q| p == q).unwrap() as u32)
            .collect();
        let edges: Vec<[u32; 2]> = (mesh.triangles.iter())
            .flat_map(|t| [[t[0], t[1]], [t[1], t[2]], [t[2], t[0]]])
            .map(|edge| edge.map(|i| welded[i as usize]))
            .collect();
        let runs = |a: u32, b: u32| edges.iter().filter(|&&edge| edge == [a, b]).count();
        let count = mesh.positions.len() as u32;
        let open = (0..count).flat_map(|a| (a + 1..count).map(move |b| (a, b)));
        (open.map(|(a, b)| runs(a, b).abs_diff(runs(b, a))).sum(), welded)
    }

    #[test]
    fn soups_are_welded_and_counted_as_the_definition_says() {
        for seed in 0..50 {
            let key = Key::new(seed);
            // Few places, so that many vertices share one; 0 and -0 are one place.
            let place =
                |k: Key| (k.unit() * 3.0).floor() as f32 * if k.child(9).unit() < 0.5 { 1.0 } else { -1.0 };
            let positions: Vec<Vec3> =
                (0..40).map(|i| Vec3::from([0, 1, 2].map(|axis| place(key.child(i).child(axis))))).collect();
            let corner = |i: u64, c: u64| (key.named("t").child(i).child(c).unit() * 40.0) as u32;
            let triangles: Vec<[u32; 3]> = (0..60).map(|i| [0, 1, 2].map(|c| corner(i, c))).collect();
            let mesh = Mesh { positions, triangles, ..Mesh::default() };
            let (open, welded) = by_definition(&mesh);
            assert_eq!(weld(&mesh.positions, &crate::monitor::Quiet), Ok(welded.clone()), "seed {seed}");
            let found = open_edges(&mesh.triangles, &welded, &crate::monitor::Quiet);
            assert_eq!(found, Ok(open), "seed {seed}");
        }
    }
}
