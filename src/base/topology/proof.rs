//! Many small surfaces, one after the other: which are closed is proved once for all that are joined alike.

use std::collections::BTreeMap;

use glam::{Vec2, Vec3};
use xxhash_rust::xxh3::xxh3_64;

use super::{Topology, fault, open_edges, topology_bytes, weld};
use crate::monitor::{Cancelled, Monitor};

/// Bytes of proofs that are kept. Then the rest is measured as if it were the first of its kind.
const KEPT_BYTES: usize = 8 << 20;

/// A surface that lies somewhere in larger lists. The first three are of equal length.
#[derive(Clone, Copy, Debug)]
pub struct SurfaceRef<'a> {
    /// Metres.
    pub positions: &'a [Vec3],
    /// Unit vectors, pointing out.
    pub normals: &'a [Vec3],
    /// Texture coordinates.
    pub uvs: &'a [Vec2],
    /// Indices of these vertices, counter-clockwise seen from outside.
    pub triangles: &'a [[u32; 3]],
}

/// Surfaces that were found closed.
///
/// Let a surface be closed: each edge runs as often one way as the other once some pairs of vertices are
/// made one. Then every surface with the same triangles is closed in which these pairs are at one place each,
/// wherever its vertices are: to make further vertices one takes nothing from the balance of any edge. So the
/// edges are counted for the first of its kind alone, and of the others each vertex of a pair is compared.
/// What depends on places alone (triangles without area, or turned over) is measured of each.
#[derive(Debug, Default)]
pub struct Proofs {
    /// By the hash of the triangles.
    known: BTreeMap<u64, Vec<Proof>>,
    bytes: usize,
}

#[derive(Debug)]
struct Proof {
    triangles: Vec<[u32; 3]>,
    /// Vertices that have to be at one place.
    pairs: Vec<[u32; 2]>,
}

impl Proof {
    fn bytes(&self) -> usize {
        size_of_val(&self.triangles[..]) + size_of_val(&self.pairs[..])
    }

    fn holds(&self, surface: SurfaceRef<'_>) -> bool {
        self.triangles == surface.triangles
            && self.pairs.iter().all(|pair| {
                let [a, b] = pair.map(|vertex| surface.positions[vertex as usize]);
                a == b
            })
    }
}

impl Proofs {
    /// Measures a surface: what [`topology`](super::topology()) says of it alone.
    ///
    /// # Errors
    /// [`Cancelled`].
    pub fn topology(
        &mut self,
        surface: SurfaceRef<'_>,
        monitor: &dyn Monitor,
    ) -> Result<Topology, Cancelled> {
        let not_finite = not_finite(surface);
        // Without a place vertices cannot be compared by it.
        let (degenerate, flipped) =
            if not_finite == 0 { faults(surface) } else { faults_of_any(surface, monitor)? };
        let hash = xxh3_64(bytemuck::cast_slice(surface.triangles));
        let is_proved =
            || self.known.get(&hash).is_some_and(|alike| alike.iter().any(|proof| proof.holds(surface)));
        if not_finite == 0 && is_proved() {
            return Ok(Topology { open_edges: 0, degenerate, flipped, not_finite });
        }
        let welded = weld(surface.positions, monitor)?;
        let open_edges = open_edges(surface.triangles, &welded, monitor)?;
        if open_edges == 0 && not_finite == 0 {
            let pairs = (0..).zip(&welded).filter(|(vertex, first)| vertex != *first).map(|(a, &b)| [a, b]);
            let proof = Proof { triangles: surface.triangles.to_vec(), pairs: pairs.collect() };
            if self.bytes + proof.bytes() <= KEPT_BYTES {
                self.bytes += proof.bytes();
                self.known.entry(hash).or_default().push(proof);
            }
        }
        Ok(Topology { open_edges, degenerate, flipped, not_finite })
    }

    /// What proofs take at most, with the proof of a surface of this size on its way.
    pub const fn bytes_for(vertices: usize, triangles: usize) -> u64 {
        KEPT_BYTES as u64 + topology_bytes(vertices, triangles)
    }
}

fn not_finite(surface: SurfaceRef<'_>) -> usize {
    let SurfaceRef { positions, normals, uvs, .. } = surface;
    // What is no number, or without end, makes no number of any sum times zero.
    let sum = |list: &[Vec3]| list.iter().fold(Vec3::ZERO, |sum, v| sum + *v * 0.0);
    let flat = uvs.iter().fold(Vec2::ZERO, |sum, v| sum + *v * 0.0);
    if (sum(positions) + sum(normals)).is_finite() && flat.is_finite() {
        return 0;
    }
    positions.iter().chain(normals).filter(|v| !v.is_finite()).count()
        + uvs.iter().filter(|v| !v.is_finite()).count()
}

/// Triangles without area, and those that look the other way than their normals. All places are finite.
fn faults(surface: SurfaceRef<'_>) -> (usize, usize) {
    let (mut degenerate, mut flipped) = (0, 0);
    for triangle in surface.triangles {
        let corners = triangle.map(|vertex| surface.positions[vertex as usize]);
        let leaning: Vec3 = triangle.iter().map(|&vertex| surface.normals[vertex as usize]).sum();
        if !is_sound(corners, leaning) {
            let [p, q, r] = corners;
            // Finite places are one if they are equal.
            let welded = [
                0,
                u32::from(p != q),
                if r == p {
                    0
                } else if r == q {
                    1
                } else {
                    2
                },
            ];
            let found = fault(welded, corners, leaning);
            (degenerate, flipped) = (degenerate + found.0, flipped + found.1);
        }
    }
    (degenerate, flipped)
}

/// The same where some places are not finite, and are one if their bits are.
fn faults_of_any(surface: SurfaceRef<'_>, monitor: &dyn Monitor) -> Result<(usize, usize), Cancelled> {
    let welded = weld(surface.positions, monitor)?;
    let of = |triangle: &[u32; 3]| {
        let corners = triangle.map(|vertex| surface.positions[vertex as usize]);
        let leaning = triangle.iter().map(|&vertex| surface.normals[vertex as usize]).sum();
        fault(triangle.map(|vertex| welded[vertex as usize]), corners, leaning)
    };
    Ok(surface.triangles.iter().map(of).fold((0, 0), |a, b| (a.0 + b.0, a.1 + b.1)))
}

/// What [`is_sound`] goes by: the square of the margin that rounding may take, of triangles' products; the square of
/// the shortest edge, a micrometre, for products of much shorter ones would vanish; the square of the longest leaning.
pub const SOUND: [f32; 3] = {
    const MARGIN: f32 = 64.0 * 0.5 * f32::EPSILON;
    [MARGIN * MARGIN, 1e-12, 16.0]
};

/// Whether single precision is enough to say that a triangle has area and looks where its normals do, whose sum is
/// `leaning`.
///
/// With unit roundoff u, edges are off by u of their length, a component of their product by 4 u of the product of
/// their lengths, and its scalar product with a vector of length 4 or less by 49 u of that.
#[inline]
pub fn is_sound([p, q, r]: [Vec3; 3], leaning: Vec3) -> bool {
    let [margin, least_squared, most_squared] = SOUND;
    let (a, b) = (q - p, r - p);
    let [a2, b2] = [a, b].map(Vec3::length_squared);
    let facing = a.cross(b).dot(leaning);
    a2.min(b2) > least_squared
        && leaning.length_squared() < most_squared
        && facing > 0.0
        && facing * facing > margin * (a2 * b2)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::Mesh;
    use crate::monitor::Quiet;
    use crate::random::Key;
    use crate::topology::topology;

    fn view(mesh: &Mesh) -> SurfaceRef<'_> {
        let Mesh { positions, normals, uvs, triangles } = mesh;
        SurfaceRef { positions, normals, uvs, triangles }
    }

    /// A tube of some sides with a seam: the first vertex of each ring stands twice, and both ends are discs with
    /// vertices of their own.
    fn tube(sides: u32, length_m: f32) -> Mesh {
        let mut mesh = Mesh::default();
        let ring = |mesh: &mut Mesh, y: f32, count: u32, normal: Option<Vec3>| {
            let first = mesh.positions.len() as u32;
            for k in 0..count {
                let (sin, cos) = libm::sincosf(std::f32::consts::TAU * (k % sides) as f32 / sides as f32);
                mesh.positions.push(Vec3::new(cos, y, -sin));
                mesh.normals.push(normal.unwrap_or(Vec3::new(cos, 0.0, -sin)));
                mesh.uvs.push(Vec2::new(k as f32, y));
            }
            first
        };
        let (below, above) =
            (ring(&mut mesh, 0.0, sides + 1, None), ring(&mut mesh, length_m, sides + 1, None));
        for k in 0..sides {
            let [a, b] = [below + k, above + k];
            mesh.triangles.extend([[a, a + 1, b], [a + 1, b + 1, b]]);
        }
        let base = ring(&mut mesh, 0.0, sides, Some(Vec3::NEG_Y));
        let top = ring(&mut mesh, length_m, sides, Some(Vec3::Y));
        for k in 1..sides - 1 {
            mesh.triangles.extend([[base, base + k + 1, base + k], [top, top + k, top + k + 1]]);
        }
        mesh
    }

    fn proved(proofs: &mut Proofs, mesh: &Mesh) -> Topology {
        proofs.topology(view(mesh), &Quiet).unwrap()
    }

    #[test]
    fn what_is_joined_as_a_closed_tube_is_closed_wherever_it_lies() {
        let mut proofs = Proofs::default();
        for sides in 3..9 {
            for length_m in [1.0, 2.0, 0.25] {
                let found = proved(&mut proofs, &tube(sides, length_m));
                assert_eq!(found, Topology::default(), "{sides} sides, {length_m} m");
            }
        }
        assert_eq!(proofs.known.len(), 6, "each number of sides is proved once");
    }

    type Damage = (&'static str, fn(&mut Mesh));

    /// A check that knows the sound tube must still see each damage to one like it.
    #[test]
    fn a_broken_tube_is_open_although_its_like_was_proved() {
        let sound = tube(8, 2.0);
        let last = sound.positions.len() - 1;
        let damages: [Damage; 7] = [
            ("a vertex of the seam is elsewhere", |mesh| mesh.positions[8].x += 1e-3),
            ("by one step of single precision", |mesh| mesh.positions[8].x = mesh.positions[8].x.next_up()),
            ("a corner of an end", |mesh| mesh.positions[20].y -= 0.1),
            ("a triangle is gone", |mesh| mesh.triangles.truncate(25)),
            ("one stands twice", |mesh| mesh.triangles.push(mesh.triangles[3])),
            ("one looks inward", |mesh| mesh.triangles[7].swap(0, 1)),
            ("a place is no number", |mesh| mesh.positions[3].y = f32::NAN),
        ];
        let mut proofs = Proofs::default();
        assert_eq!(proved(&mut proofs, &sound), Topology::default());
        for (what, damage) in damages {
            let mut broken = sound.clone();
            damage(&mut broken);
            let found = proved(&mut proofs, &broken);
            assert_eq!(found, topology(&broken, &Quiet).unwrap(), "{what}");
            assert!(!found.watertight(), "{what}: {found:?}");
        }
        // All of one ring on one place: closed, and without area.
        let mut pointed = sound.clone();
        pointed.positions[9..18].fill(Vec3::Y * 2.0);
        pointed.positions[last - 7..].fill(Vec3::Y * 2.0);
        let found = proved(&mut proofs, &pointed);
        assert_eq!((found.open_edges, found.degenerate), (0, 8 + 6));
        assert_eq!(proved(&mut proofs, &sound), Topology::default());
    }

    /// Soups with places so few that proofs are met again with vertices made one that were apart.
    #[test]
    fn with_proofs_or_without_the_same_is_found() {
        let mut proofs = Proofs::default();
        for seed in 0..200 {
            let key = Key::new(seed);
            let mut mesh = tube(3 + (seed % 3) as u32, 1.0);
            for (i, place) in (0_u64..).zip(&mut mesh.positions) {
                let key = key.child(i);
                if key.unit() < 0.1 * (seed % 5) as f64 {
                    let x = |axis| (key.child(axis).unit() * 3.0).floor() as f32 - 1.0;
                    *place = Vec3::new(x(0), x(1), x(2));
                }
            }
            assert_eq!(proved(&mut proofs, &mesh), topology(&mesh, &Quiet).unwrap(), "seed {seed}");
        }
    }

    /// Slivers about the limit of single precision, and far below it.
    #[test]
    fn triangles_are_judged_as_in_double_precision() {
        let mut judged = [0; 2];
        for seed in 0..20_000 {
            let key = Key::new(seed);
            let vector = |k: Key| Vec3::from([0, 1, 2].map(|axis| k.child(axis).between(-1.0, 1.0) as f32));
            let (at, along) = (vector(key.child(0)), vector(key.child(1)));
            let thin = libm::exp(-40.0 * key.child(2).unit()) as f32;
            let corners = [at, at + along, at + along * 0.4 + vector(key.child(3)) * thin];
            let leaning = vector(key.child(4)) * 1.7;
            let welded =
                [0, 1, 2].map(|i: u32| (0..3).find(|&j| corners[j] == corners[i as usize]).unwrap() as u32);
            let exact = fault(welded, corners, leaning);
            judged[usize::from(is_sound(corners, leaning))] += 1;
            assert!(!is_sound(corners, leaning) || exact == (0, 0), "seed {seed}: {corners:?}");
        }
        assert!(judged[0] > 5000 && judged[1] > 2000, "{judged:?}");
    }
}
