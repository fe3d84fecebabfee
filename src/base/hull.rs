//! Convex hulls of points, in the plane and in space, with the measures of them.
//!
//! Which side a point lies on is decided exactly (Shewchuk 1997, *Adaptive precision floating-point arithmetic and
//! fast robust geometric predicates*), so that no input breaks a hull: repeated points, points in a row and in a
//! plane included. Points must be finite.

use std::collections::{BTreeMap, BTreeSet};

use glam::{DVec2, DVec3};
use rayon::prelude::*;
use robust::{Coord, Coord3D, orient2d, orient3d};

/// Points whose hull is taken by one task.
const PER_TASK: usize = 1 << 13;

/// The convex hull of points in a plane.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct HullPolygon {
    /// Counter-clockwise; two for points in a row, one for a single place, none for no points.
    pub corners: Vec<DVec2>,
}

impl HullPolygon {
    /// The hull of some points (Andrew 1979, *Another efficient algorithm for convex hulls in two dimensions*).
    ///
    /// ```
    /// use linden_base::glam::DVec2;
    /// use linden_base::hull::HullPolygon;
    /// let points = [(0.0, 0.0), (2.0, 0.0), (1.0, 0.5), (2.0, 1.0), (0.0, 1.0)].map(DVec2::from);
    /// let hull = HullPolygon::of(&points);
    /// assert_eq!((hull.corners.len(), hull.area(), hull.perimeter()), (4, 2.0, 6.0));
    /// ```
    pub fn of(points: &[DVec2]) -> Self {
        if points.len() > 2 * PER_TASK {
            let parts: Vec<Self> = points.par_chunks(PER_TASK).map(Self::of).collect();
            return Self::of_few(parts.into_iter().flat_map(|part| part.corners).collect());
        }
        Self::of_few(points.to_vec())
    }

    fn of_few(mut points: Vec<DVec2>) -> Self {
        if let Some(corners) = ends_of_row(&points) {
            return Self { corners };
        }
        drop_inner(&mut points);
        points.sort_unstable_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
        points.dedup();
        if points.len() < 3 {
            return Self { corners: points };
        }
        let mut corners = chain(points.iter().copied());
        let upper = chain(points.iter().rev().copied());
        // Each begins where the other ends.
        corners.pop();
        corners.extend(&upper[..upper.len() - 1]);
        Self { corners }
    }

    /// Unit squared; 0 for points in a row.
    pub fn area(&self) -> f64 {
        self.edges().fold(0.0, |sum, (a, b)| sum + a.perp_dot(b)) / 2.0
    }

    /// The way round, for points in a row there and back.
    pub fn perimeter(&self) -> f64 {
        self.edges().fold(0.0, |sum, (a, b)| sum + a.distance(b))
    }

    /// Its width between two parallel lines, averaged over all directions: perimeter ÷ π (Cauchy 1841).
    pub fn mean_width(&self) -> f64 {
        self.perimeter() / std::f64::consts::PI
    }

    /// The distance of the two parallel lines that enclose it most narrowly; one of them lies along an edge.
    pub fn least_width(&self) -> f64 {
        let across = |(a, b): (DVec2, DVec2)| {
            let side = (b - a).normalize_or_zero().perp();
            self.corners.iter().map(|&corner| side.dot(corner - a)).fold(0.0, f64::max)
        };
        self.edges().map(across).reduce(f64::min).unwrap_or(0.0)
    }

    /// The greatest distance of two corners, which is the greatest width too.
    pub fn most_width(&self) -> f64 {
        let pairs = self.corners.iter().enumerate().flat_map(|(i, a)| {
            let others = &self.corners[i + 1..];
            others.iter().map(move |b| a.distance(*b))
        });
        pairs.fold(0.0, f64::max)
    }

    /// From each corner to the next, the last to the first included.
    fn edges(&self) -> impl Iterator<Item = (DVec2, DVec2)> {
        self.corners.iter().copied().zip(self.corners.iter().copied().cycle().skip(1))
    }
}

/// The two ends of points in a row along an axis, as a flat plant has them seen from above: no order of all is needed.
fn ends_of_row(points: &[DVec2]) -> Option<Vec<DVec2>> {
    let first = *points.first()?;
    let is_same = |of: fn(&DVec2) -> f64| points.iter().all(|p| of(p).to_bits() == of(&first).to_bits());
    let along: fn(&DVec2) -> f64 = match () {
        () if is_same(|p| p.y) => |p| p.x,
        () if is_same(|p| p.x) => |p| p.y,
        () => return None,
    };
    let by = |a: &&DVec2, b: &&DVec2| along(a).total_cmp(&along(b));
    let mut ends: Vec<DVec2> =
        [points.iter().min_by(by), points.iter().max_by(by)].into_iter().flatten().copied().collect();
    ends.dedup();
    Some(ends)
}

/// Takes out points that are no corners for certain: those well within the octagon of the farthest points in eight
/// directions (Akl & Toussaint 1978, *A fast convex hull algorithm*). Sorting the rest is what a hull takes longest for.
fn drop_inner(points: &mut Vec<DVec2>) {
    /// Fewer are sorted as fast.
    const FEW: usize = 64;
    /// In squares of the farthest coordinate: far more than rounding adds to a product of two differences.
    const MARGIN: f64 = 1e-12;
    let Some(&first) = points.first().filter(|_| points.len() > FEW) else { return };
    let ways = [
        [1.0, 0.0],
        [1.0, 1.0],
        [0.0, 1.0],
        [-1.0, 1.0],
        [-1.0, 0.0],
        [-1.0, -1.0],
        [0.0, -1.0],
        [1.0, -1.0],
    ];
    let ways = ways.map(DVec2::from_array);
    let mut farthest = ways.map(|way| (way.dot(first), first));
    let mut largest = 0.0_f64;
    for &point in &*points {
        largest = largest.max(point.abs().max_element());
        for (way, best) in ways.iter().zip(&mut farthest) {
            let far = way.dot(point);
            if far > best.0 {
                *best = (far, point);
            }
        }
    }
    let corners = farthest.map(|(_, point)| point);
    let edges: Vec<(DVec2, DVec2)> = (0..8)
        .map(|i| (corners[i], corners[(i + 1) % 8]))
        .filter(|(from, to)| from != to)
        .map(|(from, to)| (from, to - from))
        .collect();
    if edges.len() < 3 {
        return;
    }
    let margin = MARGIN * largest * largest;
    points.retain(|&point| !edges.iter().all(|&(from, along)| along.perp_dot(point - from) > margin));
}

/// The corners on the right of sorted points, first and last included.
fn chain(points: impl Iterator<Item = DVec2>) -> Vec<DVec2> {
    let coord = |p: DVec2| Coord { x: p.x, y: p.y };
    let mut corners: Vec<DVec2> = Vec::new();
    for point in points {
        while let [.., a, b] = corners[..] {
            if orient2d(coord(a), coord(b), coord(point)) > 0.0 {
                break;
            }
            corners.pop();
        }
        corners.push(point);
    }
    corners
}

/// The convex hull of points in space.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct HullSolid {
    /// Those of the points that are corners. For points in a plane, which enclose nothing, some that span it.
    pub corners: Vec<DVec3>,
    /// Indices of corners, counter-clockwise seen from outside; none for points in a plane.
    pub triangles: Vec<[u32; 3]>,
}

impl HullSolid {
    /// The hull of some points by Quickhull (Barber, Dobkin & Huhdanpaa 1996, *The Quickhull algorithm for convex
    /// hulls*).
    ///
    /// ```
    /// use linden_base::glam::DVec3;
    /// use linden_base::hull::HullSolid;
    /// let cube: Vec<DVec3> = (0..8_u8).map(|i| DVec3::from([0, 1, 2].map(|axis| f64::from(i >> axis & 1)))).collect();
    /// let hull = HullSolid::of(&cube);
    /// assert_eq!((hull.corners.len(), hull.triangles.len(), hull.volume()), (8, 12, 1.0));
    /// ```
    pub fn of(points: &[DVec3]) -> Self {
        if points.len() > 2 * PER_TASK {
            let parts: Vec<Self> = points.par_chunks(PER_TASK).map(Self::of).collect();
            let corners: Vec<DVec3> = parts.into_iter().flat_map(|part| part.corners).collect();
            // Points in a plane, or on a sphere, are not made fewer in this way.
            return Quickhull::of(&corners);
        }
        Quickhull::of(points)
    }

    /// The same of points that come one by one: of many, a few are held at a time.
    pub fn of_all(mut points: impl Iterator<Item = DVec3>) -> Self {
        const AT_ONCE: usize = 32 * PER_TASK;
        let mut some: Vec<DVec3> = points.by_ref().take(AT_ONCE).collect();
        if some.len() < AT_ONCE {
            return Self::of(&some);
        }
        let mut corners = Vec::new();
        while !some.is_empty() {
            // Of the same pieces as if all were there.
            let parts: Vec<Self> = some.par_chunks(PER_TASK).map(Self::of).collect();
            corners.extend(parts.into_iter().flat_map(|part| part.corners));
            some.clear();
            some.extend(points.by_ref().take(AT_ONCE));
        }
        Quickhull::of(&corners)
    }

    /// Unit cubed.
    pub fn volume(&self) -> f64 {
        let Some(&from) = self.corners.first() else { return 0.0 };
        let of = |&[a, b, c]: &[u32; 3]| {
            let [a, b, c] = [a, b, c].map(|corner| self.corners[corner as usize] - from);
            a.dot(b.cross(c))
        };
        self.triangles.iter().map(of).fold(0.0, |sum, part| sum + part) / 6.0
    }
}

/// A triangle of a hull that grows.
struct Face {
    corners: [usize; 3],
    /// The faces beyond the edges from each corner to the next.
    beyond: [usize; 3],
    /// Points that are in front of it, and of no other face's list.
    outside: Vec<usize>,
    is_gone: bool,
}

struct Quickhull<'a> {
    points: &'a [DVec3],
    faces: Vec<Face>,
}

impl<'a> Quickhull<'a> {
    fn of(points: &'a [DVec3]) -> HullSolid {
        let Some(first) = simplex(points) else {
            return HullSolid { corners: spanning(points), triangles: Vec::new() };
        };
        let mut hull = Self { points, faces: Vec::new() };
        hull.begin(first);
        let mut waiting: Vec<usize> = (0..hull.faces.len()).collect();
        while let Some(face) = waiting.pop() {
            if !hull.faces[face].is_gone
                && let Some(farthest) = hull.farthest(face)
            {
                let before = hull.faces.len();
                hull.raise(face, farthest);
                waiting.extend(before..hull.faces.len());
            }
        }
        hull.finish()
    }

    /// A tetrahedron of four points, and all others in the lists of its faces.
    fn begin(&mut self, [a, b, c, d]: [usize; 4]) {
        // Its outside is where the fourth is not.
        let (b, c) = if self.is_before([a, b, c], d) { (c, b) } else { (b, c) };
        for (corners, beyond) in
            [([a, b, c], [1, 2, 3]), ([b, a, d], [0, 3, 2]), ([c, b, d], [0, 1, 3]), ([a, c, d], [0, 2, 1])]
        {
            self.faces.push(Face { corners, beyond, outside: Vec::new(), is_gone: false });
        }
        let all = 0..self.points.len();
        self.share_out(all.filter(|point| ![a, b, c, d].contains(point)), 0);
    }

    /// Puts points into the lists of the first of the faces from `from` on that they are in front of.
    fn share_out(&mut self, points: impl Iterator<Item = usize>, from: usize) {
        for point in points {
            let seen = (from..self.faces.len()).find(|&face| self.is_before(self.faces[face].corners, point));
            if let Some(face) = seen {
                self.faces[face].outside.push(point);
            }
        }
    }

    /// Whether a point is in front of three others, which are counter-clockwise seen from there.
    fn is_before(&self, corners: [usize; 3], point: usize) -> bool {
        let [a, b, c] = corners.map(|corner| coord(self.points[corner]));
        orient3d(a, b, c, coord(self.points[point])) < 0.0
    }

    /// The point in front of a face that is farthest from it; the first among equals.
    fn farthest(&self, face: usize) -> Option<usize> {
        let Face { corners, outside, .. } = &self.faces[face];
        let [a, b, c] = corners.map(|corner| self.points[corner]);
        let normal = (b - a).cross(c - a);
        let height = |point: usize| normal.dot(self.points[point] - a);
        let mut all = outside.iter().copied();
        let first = all.next()?;
        Some(all.fold(first, |best, point| if height(point) > height(best) { point } else { best }))
    }

    /// Replaces all faces that see a point by a fan of faces to it.
    fn raise(&mut self, from: usize, apex: usize) {
        // What sees it is connected: a disc.
        let mut seen = vec![from];
        self.faces[from].is_gone = true;
        let mut rim: BTreeMap<usize, (usize, usize)> = BTreeMap::new();
        let mut next = 0;
        while next < seen.len() {
            let face = seen[next];
            next += 1;
            for side in 0..3 {
                let beyond = self.faces[face].beyond[side];
                if self.faces[beyond].is_gone {
                    continue;
                }
                if self.is_before(self.faces[beyond].corners, apex) {
                    self.faces[beyond].is_gone = true;
                    seen.push(beyond);
                } else {
                    let [a, b] = [side, (side + 1) % 3].map(|i| self.faces[face].corners[i]);
                    rim.insert(a, (b, beyond));
                }
            }
        }
        let first = self.faces.len();
        let place: BTreeMap<usize, usize> =
            rim.keys().enumerate().map(|(i, &corner)| (corner, first + i)).collect();
        for (&a, &(b, below)) in &rim {
            let new = self.faces.len();
            let side = (0..3).find(|&side| {
                let corners = self.faces[below].corners;
                (corners[side], corners[(side + 1) % 3]) == (b, a)
            });
            if let Some(side) = side {
                self.faces[below].beyond[side] = new;
            }
            // A rim is closed: each of its corners begins one edge. That of `b` follows, and `a` ends another.
            let after = place.get(&b).copied().unwrap_or(new);
            self.faces.push(Face {
                corners: [a, b, apex],
                beyond: [below, after, new],
                outside: Vec::new(),
                is_gone: false,
            });
        }
        for face in first..self.faces.len() {
            let after = self.faces[face].beyond[1];
            self.faces[after].beyond[2] = face;
        }
        for face in seen {
            let outside = std::mem::take(&mut self.faces[face].outside);
            self.share_out(outside.into_iter().filter(|&point| point != apex), first);
        }
    }

    fn finish(self) -> HullSolid {
        let kept = || self.faces.iter().filter(|face| !face.is_gone);
        let used: BTreeSet<usize> = kept().flat_map(|face| face.corners).collect();
        let index: BTreeMap<usize, u32> = used.iter().copied().zip(0..).collect();
        HullSolid {
            corners: used.iter().map(|&point| self.points[point]).collect(),
            triangles: kept().map(|face| face.corners.map(|corner| index[&corner])).collect(),
        }
    }
}

fn coord(p: DVec3) -> Coord3D<f64> {
    Coord3D { x: p.x, y: p.y, z: p.z }
}

/// Four points that do not lie in a plane, far apart.
fn simplex(points: &[DVec3]) -> Option<[usize; 4]> {
    let far = |of: &dyn Fn(DVec3) -> f64| {
        let mut best = 0;
        for (i, &point) in points.iter().enumerate() {
            if of(point) > of(points[best]) {
                best = i;
            }
        }
        best
    };
    let first = *points.first()?;
    // In a plane across an axis, as flat plants are: what is the same for all needs no arithmetic.
    if (0..3).any(|axis| points.iter().all(|p| p[axis] == first[axis])) {
        return None;
    }
    let a = far(&|p| p.distance_squared(first));
    let b = far(&|p| p.distance_squared(points[a]));
    let along = points[b] - points[a];
    let c = far(&|p| along.cross(p - points[a]).length_squared());
    let normal = along.cross(points[c] - points[a]);
    let d = far(&|p| normal.dot(p - points[a]).abs());
    let lies_off = |d: usize| {
        let [a, b, c, d] = [a, b, c, d].map(|i| coord(points[i]));
        orient3d(a, b, c, d) != 0.0
    };
    if lies_off(d) {
        return Some([a, b, c, d]);
    }
    // Rounding may have hidden one that is off the plane by little; or the three are in a row.
    (0..points.len()).find(|&d| lies_off(d)).map(|d| [a, b, c, d])
}

/// Of points in a plane, those that stay corners whatever is added outside the plane: of each of the three views
/// along the axes the hull.
fn spanning(points: &[DVec3]) -> Vec<DVec3> {
    let mut kept: Vec<DVec3> = Vec::new();
    for view in [DVec3::truncate, |p: DVec3| DVec2::new(p.y, p.z), |p: DVec3| DVec2::new(p.z, p.x)] {
        let flat: Vec<DVec2> = points.iter().map(|&p| view(p)).collect();
        let corners = HullPolygon::of_few(flat).corners;
        kept.extend(points.iter().filter(|&&point| corners.contains(&view(point))));
    }
    kept.sort_unstable_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)).then(a.z.total_cmp(&b.z)));
    kept.dedup();
    kept
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Key;

    /// Gift wrapping: of all points the one that all others are on the left of, by exact signs.
    fn wrapped(points: &[DVec2]) -> BTreeSet<[u64; 2]> {
        let coord = |p: DVec2| Coord { x: p.x, y: p.y };
        let is_edge = |a: DVec2, b: DVec2| {
            a != b
                && points.iter().all(|&p| {
                    let side = orient2d(coord(a), coord(b), coord(p));
                    side > 0.0 || side == 0.0 && (p - a).dot(p - b) <= 0.0
                })
        };
        let begins_edge = |&&a: &&DVec2| points.iter().any(|&b| is_edge(a, b));
        points.iter().filter(begins_edge).map(|p| p.to_array().map(f64::to_bits)).collect()
    }

    #[test]
    fn what_is_left_out_unsorted_is_no_corner() {
        for seed in 0..60 {
            let key = Key::new(seed);
            // Coarse places repeat and lie in rows, fine ones lie anywhere; some clouds are thin.
            let steps = if seed % 3 == 0 { 7.0 } else { 1e9 };
            let size = [1.0, if seed % 4 == 1 { 1e-9 } else { 1.0 }];
            let x = |k: Key, axis: usize| (k.child(axis as u64).unit() * steps).floor() / steps * size[axis];
            let points: Vec<DVec2> =
                (0..150).map(|i| DVec2::new(x(key.child(i), 0), x(key.child(i), 1))).collect();
            let hull = HullPolygon::of(&points);
            let found: BTreeSet<[u64; 2]> =
                hull.corners.iter().map(|p| p.to_array().map(f64::to_bits)).collect();
            assert_eq!(found, wrapped(&points), "seed {seed}");
            assert_eq!(found.len(), hull.corners.len());
            assert!(hull.area() >= 0.0);
            let mut few = points.clone();
            drop_inner(&mut few);
            assert!(few.len() < 100 || steps == 7.0 || size[1] < 1.0, "seed {seed}: {} are left", few.len());
        }
    }

    #[test]
    fn points_in_a_row_are_their_ends() {
        let row: Vec<DVec2> = [3.0, -1.0, 2.0, 7.5, -1.0, 7.5].map(|x| DVec2::new(x, 4.0)).to_vec();
        assert_eq!(HullPolygon::of(&row).corners, [DVec2::new(-1.0, 4.0), DVec2::new(7.5, 4.0)]);
        let upright: Vec<DVec2> = row.iter().map(|p| DVec2::new(p.y, p.x)).collect();
        assert_eq!(HullPolygon::of(&upright).corners, [DVec2::new(4.0, -1.0), DVec2::new(4.0, 7.5)]);
        assert_eq!(HullPolygon::of(&[DVec2::ONE; 5]).corners, [DVec2::ONE]);
    }

    #[test]
    fn points_one_by_one_have_the_hull_of_the_list() {
        for count in [3, 1000, 32 * PER_TASK - 1, 32 * PER_TASK, 70 * PER_TASK + 5] {
            for flat in [1.0, 0.0] {
                let place = |i| Key::new(5).child(i as u64).in_ball() * DVec3::new(1.0, 2.0, flat);
                let points: Vec<DVec3> = (0..count).map(place).collect();
                assert_eq!(HullSolid::of_all(points.iter().copied()), HullSolid::of(&points), "{count}");
            }
        }
    }
}
