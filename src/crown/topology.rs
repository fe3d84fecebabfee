//! What a triangle soup's edges say: whether it is closed, and which way its faces look.

use glam::DVec3;

/// A mesh with vertices welded by exact position, without triangles that have no corners of their
/// own, and with neighbours looking the same way wherever that is possible.
pub(super) struct Surface {
    pub positions: Vec<DVec3>,
    pub triangles: Vec<[u32; 3]>,
    /// Whether each edge is passed as often one way as the other: then, and only then, winding
    /// numbers are whole.
    pub closed: bool,
    /// Edges of one triangle.
    pub boundary_edges: usize,
    /// Edges of more than two triangles.
    pub non_manifold_edges: usize,
    /// Parts that share no edge.
    pub components: usize,
    /// Triangles left out: without area of their own, or the same three corners again.
    pub dropped_triangles: usize,
    /// Triangles turned around to agree with their neighbours.
    pub turned_triangles: usize,
}

/// One triangle's use of one edge.
#[derive(Clone, Copy)]
struct Side {
    edge: (u32, u32),
    triangle: u32,
    /// Whether the triangle passes it from the lower vertex to the higher.
    up: bool,
}

impl Surface {
    pub fn new(positions: &[DVec3], triangles: &[[u32; 3]]) -> Self {
        let (positions, welded) = weld(positions);
        let mut kept: Vec<[u32; 3]> = triangles.iter().map(|t| t.map(|v| welded[v as usize])).collect();
        drop_repeated(&mut kept);
        let dropped_triangles = triangles.len() - kept.len();
        let mut surface = Self {
            positions,
            triangles: kept,
            closed: false,
            boundary_edges: 0,
            non_manifold_edges: 0,
            components: 0,
            dropped_triangles,
            turned_triangles: 0,
        };
        surface.orient();
        surface
    }

    /// Turns triangles to agree with the majority of their part, and counts.
    fn orient(&mut self) {
        let mut sides = sides(&self.triangles);
        sides.sort_unstable_by_key(|side| (side.edge, side.triangle));
        let by_edge: Vec<&[Side]> = sides.chunk_by(|a, b| a.edge == b.edge).collect();
        self.boundary_edges = by_edge.iter().filter(|uses| uses.len() == 1).count();
        self.non_manifold_edges = by_edge.iter().filter(|uses| uses.len() > 2).count();

        let neighbours = Neighbours::new(self.triangles.len(), &by_edge);
        let turn = neighbours.turns();
        self.components = neighbours.components();
        self.turned_triangles = turn.iter().filter(|&&turn| turn).count();
        self.closed = by_edge.iter().all(|uses| {
            let way = |side: &Side| if side.up == turn[side.triangle as usize] { -1 } else { 1 };
            uses.iter().map(way).sum::<i64>() == 0
        });
        for (triangle, turn) in self.triangles.iter_mut().zip(&turn) {
            if *turn {
                triangle.swap(1, 2);
            }
        }
    }

    /// The triangles of each part, in the order of their first ones.
    pub fn parts(&self) -> Vec<Vec<u32>> {
        let mut sides = sides(&self.triangles);
        sides.sort_unstable_by_key(|side| (side.edge, side.triangle));
        let by_edge: Vec<&[Side]> = sides.chunk_by(|a, b| a.edge == b.edge).collect();
        Neighbours::new(self.triangles.len(), &by_edge).parts(|_| true, |_, _| ())
    }

    /// The volume by the divergence theorem, below zero for a surface turned inside out. Means
    /// something for a closed surface only.
    pub fn signed_volume_m3(&self) -> f64 {
        let tetrahedron = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|v| self.positions[v as usize]);
            a.dot(b.cross(c)) / 6.0
        };
        self.triangles.iter().map(tetrahedron).sum()
    }
}

/// Distinct positions and, for each old index, the new one. OBJ and PLY writers split vertices at
/// texture seams and hard edges; the copies have the same bits.
fn weld(positions: &[DVec3]) -> (Vec<DVec3>, Vec<u32>) {
    // Adding zero makes -0 and 0 the same.
    let key = |i: u32| (positions[i as usize] + 0.0).to_array().map(f64::to_bits);
    let mut order: Vec<u32> = (0..positions.len() as u32).collect();
    order.sort_unstable_by_key(|&i| (key(i), i));
    let mut distinct = Vec::new();
    let mut welded = vec![0; positions.len()];
    for same in order.chunk_by(|&a, &b| key(a) == key(b)) {
        for &i in same {
            welded[i as usize] = distinct.len() as u32;
        }
        distinct.push(positions[same[0] as usize]);
    }
    (distinct, welded)
}

/// Removes triangles with a corner twice, and all but the first with the same three corners:
/// surfaces saved with both their sides would cancel themselves.
fn drop_repeated(triangles: &mut Vec<[u32; 3]>) {
    let corners = |t: [u32; 3]| {
        let mut corners = t;
        corners.sort_unstable();
        corners
    };
    triangles.retain(|&[a, b, c]| a != b && b != c && c != a);
    let mut order: Vec<usize> = (0..triangles.len()).collect();
    order.sort_unstable_by_key(|&i| (corners(triangles[i]), i));
    let mut repeated = vec![false; triangles.len()];
    for pair in order.windows(2) {
        repeated[pair[1]] = corners(triangles[pair[0]]) == corners(triangles[pair[1]]);
    }
    let mut repeated = repeated.into_iter();
    triangles.retain(|_| repeated.next() != Some(true));
}

fn sides(triangles: &[[u32; 3]]) -> Vec<Side> {
    let side = |triangle: usize, from: u32, to: u32| Side {
        edge: (from.min(to), from.max(to)),
        triangle: triangle as u32,
        up: from < to,
    };
    let of_triangle = |(i, &[a, b, c]): (usize, &[u32; 3])| [side(i, a, b), side(i, b, c), side(i, c, a)];
    triangles.iter().enumerate().flat_map(of_triangle).collect()
}

/// Which triangles meet at edges. Where just two meet, they should pass the edge in opposite ways.
struct Neighbours {
    /// Where each triangle's links start.
    starts: Vec<u32>,
    links: Vec<Link>,
}

#[derive(Clone, Copy)]
struct Link {
    to: u32,
    /// Whether only these two meet; `agree` means something then.
    manifold: bool,
    agree: bool,
}

impl Neighbours {
    fn new(triangles: usize, by_edge: &[&[Side]]) -> Self {
        let mut pairs: Vec<(u32, Link)> = Vec::new();
        for uses in by_edge {
            let manifold = uses.len() == 2;
            for pair in uses.windows(2) {
                let link = |to: &Side| Link { to: to.triangle, manifold, agree: pair[0].up != pair[1].up };
                pairs.push((pair[0].triangle, link(&pair[1])));
                pairs.push((pair[1].triangle, link(&pair[0])));
            }
        }
        pairs.sort_by_key(|pair| pair.0);
        let starts = (0..=triangles).map(|t| pairs.partition_point(|pair| (pair.0 as usize) < t) as u32);
        Self { starts: starts.collect(), links: pairs.iter().map(|pair| pair.1).collect() }
    }

    fn of(&self, triangle: u32) -> &[Link] {
        let t = triangle as usize;
        &self.links[self.starts[t] as usize..self.starts[t + 1] as usize]
    }

    /// The parts linked by edges of any kind.
    fn components(&self) -> usize {
        self.parts(|_| true, |_, _| ()).len()
    }

    /// Which triangles must turn so that neighbours agree: the minority of each part that
    /// manifold edges link.
    fn turns(&self) -> Vec<bool> {
        let mut turn = vec![false; self.starts.len() - 1];
        let parts = self.parts(
            |link| link.manifold,
            |from, link| {
                turn[link.to as usize] = turn[from as usize] == link.agree;
            },
        );
        // `turn` above says "differs from its part's first triangle" through the chain of links.
        for part in &parts {
            let turned = part.iter().filter(|&&t| turn[t as usize]).count();
            if 2 * turned > part.len() {
                for &t in part {
                    turn[t as usize] = !turn[t as usize];
                }
            }
        }
        turn
    }

    /// Triangles grouped by the links that `follow` allows; `reach` sees each link that finds a
    /// triangle first.
    fn parts(&self, follow: impl Fn(&Link) -> bool, mut reach: impl FnMut(u32, &Link)) -> Vec<Vec<u32>> {
        let count = self.starts.len() - 1;
        let mut seen = vec![false; count];
        let mut parts = Vec::new();
        for first in 0..count {
            if seen[first] {
                continue;
            }
            seen[first] = true;
            let mut part = vec![first as u32];
            let mut next = 0;
            while let Some(&triangle) = part.get(next) {
                next += 1;
                for link in self.of(triangle).iter().filter(|link| follow(link)) {
                    if !std::mem::replace(&mut seen[link.to as usize], true) {
                        reach(triangle, link);
                        part.push(link.to);
                    }
                }
            }
            parts.push(part);
        }
        parts
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CUBE: [[u32; 3]; 12] = [
        [0, 3, 1],
        [0, 2, 3],
        [4, 5, 7],
        [4, 7, 6],
        [0, 1, 5],
        [0, 5, 4],
        [2, 7, 3],
        [2, 6, 7],
        [0, 4, 6],
        [0, 6, 2],
        [1, 3, 7],
        [1, 7, 5],
    ];

    fn corners() -> Vec<DVec3> {
        (0..8).map(|i| DVec3::new(f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2))).collect()
    }

    #[test]
    fn a_cube_is_closed_and_has_its_volume() {
        let cube = Surface::new(&corners(), &CUBE);
        assert!(cube.closed);
        assert_eq!((cube.boundary_edges, cube.non_manifold_edges, cube.components), (0, 0, 1));
        assert!((cube.signed_volume_m3() - 1.0).abs() < 1e-12);
    }

    #[test]
    fn split_vertices_turned_and_doubled_faces_are_mended() {
        let mut positions = Vec::new();
        let mut triangles = Vec::new();
        for (i, triangle) in CUBE.iter().enumerate() {
            let first = positions.len() as u32;
            positions.extend(triangle.map(|v| corners()[v as usize] * DVec3::new(1.0, -1.0, 1.0)));
            triangles.push(if i % 3 == 0 {
                [first, first + 2, first + 1]
            } else {
                [first, first + 1, first + 2]
            });
        }
        triangles.push(triangles[4]);
        triangles.push([triangles[7][1], triangles[7][0], triangles[7][2]]);
        triangles.push([0, 0, 1]);
        let cube = Surface::new(&positions, &triangles);
        assert!(cube.closed);
        assert_eq!((cube.positions.len(), cube.dropped_triangles, cube.turned_triangles), (8, 3, 4));
        // Mirrored: most faces look inward, and the majority decides.
        assert!((cube.signed_volume_m3() + 1.0).abs() < 1e-12);
    }

    #[test]
    fn holes_walls_and_parts_are_counted() {
        let open = Surface::new(&corners(), &CUBE[1..]);
        assert!(!open.closed);
        assert_eq!(open.boundary_edges, 3);
        // A wall through the diagonal: four of its edges have three triangles.
        let mut walled = CUBE.to_vec();
        walled.extend([[0, 1, 7], [0, 7, 6]]);
        let walled = Surface::new(&corners(), &walled);
        assert!(!walled.closed && walled.non_manifold_edges > 0);
        let mut two = corners();
        two.extend(corners().iter().map(|p| *p + 5.0));
        let far = CUBE.map(|t| t.map(|v| v + 8));
        let two = Surface::new(&two, &[CUBE, far].concat());
        assert!(two.closed);
        assert_eq!(two.components, 2);
    }

    #[test]
    fn a_moebius_strip_cannot_agree_and_is_open() {
        let ring = |i: u32| {
            let (sin, cos) = libm::sincos(f64::from(i) / 8.0 * std::f64::consts::TAU);
            DVec3::new(cos, 0.0, sin)
        };
        let positions: Vec<DVec3> = (0..16).map(|i| ring(i / 2) * (1.0 + 0.2 * f64::from(i % 2))).collect();
        let mut triangles = Vec::new();
        for i in 0..8 {
            let (a, b) = (2 * i, 2 * i + 1);
            let (c, d) = if i == 7 { (1, 0) } else { (a + 2, b + 2) };
            triangles.extend([[a, b, c], [b, d, c]]);
        }
        let strip = Surface::new(&positions, &triangles);
        assert!(!strip.closed);
        assert_eq!((strip.boundary_edges, strip.components), (16, 1));
    }
}
