//! Outlines → triangles.

use earcut::int::EarcutI32;
use glam::{DVec2, DVec3, Vec2, Vec3};

/// The largest coordinate that the triangulation takes.
const LARGEST: f64 = (1 << 19) as f64;
/// Corners nearer than this share of the outline's size are one.
const SAME: f64 = 1e-6;
/// An outline narrower than this share of its length has no inside.
const THINNEST: f64 = 1e-5;

/// Triangulates outlines, one after the other.
///
/// An outline is projected onto its plane and onto a grid of 2²⁰ cells, where all decisions are exact:
/// whatever the outline (it may cross itself, or run along itself), the same corners give the same
/// triangles on every machine.
#[derive(Default)]
pub(super) struct Filler {
    earcut: EarcutI32,
    /// Indices of the distinct corners.
    distinct: Vec<u32>,
    /// The same, in the plane.
    flat: Vec<DVec2>,
    grid: Vec<[i32; 2]>,
    triangles: Vec<u32>,
    /// Where distinct corners went that are in a triangle.
    index: Vec<u32>,
}

/// An outline, filled.
pub(super) struct Filled<'a> {
    /// Unit vector, on the side that counts as upper.
    pub normal: Vec3,
    /// The corners that are in a triangle: index, and texture coordinate (0 to 1, V along the heading).
    pub corners: Vec<(u32, Vec2)>,
    /// Into `corners`, counter-clockwise seen from above; none of them without area.
    pub triangles: &'a [u32],
}

impl Filler {
    /// `None` when the outline has no inside: fewer than three corners, or all on a line.
    pub fn fill(&mut self, corners: &[Vec3], heading: Vec3, up: Vec3) -> Option<Filled<'_>> {
        let first = corners.first()?.as_dvec3();
        // Relative to a corner: far from the origin nothing is lost.
        let at = |index: u32| corners[index as usize].as_dvec3() - first;
        let size = corners.iter().map(|c| (c.as_dvec3() - first).length()).fold(0.0, f64::max);
        self.distinct.clear();
        for index in 0..corners.len() as u32 {
            let is_new = self.distinct.last().is_none_or(|&last| at(index).distance(at(last)) > SAME * size);
            if is_new {
                self.distinct.push(index);
            }
        }
        while let [begin, .., end] = self.distinct[..]
            && at(begin).distance(at(end)) <= SAME * size
        {
            self.distinct.pop();
        }
        if self.distinct.len() < 3 {
            return None;
        }
        let mut normal = self.plane(at, size)?;
        if normal.dot(up.as_dvec3()) < 0.0 {
            normal = -normal;
        }
        let v = heading.as_dvec3().reject_from(normal).try_normalize();
        let v = v.unwrap_or_else(|| normal.any_orthonormal_vector());
        let u = v.cross(normal);
        self.flat.clear();
        self.flat.extend(self.distinct.iter().map(|&i| DVec2::new(at(i).dot(u), at(i).dot(v))));
        let (min, max) = self
            .flat
            .iter()
            .fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(min, max), &p| (min.min(p), max.max(p)));
        let (middle, extent) = ((min + max) / 2.0, max - min);
        let scale = (LARGEST - 1.0) / (extent.max_element() / 2.0);
        let snap = |p: &DVec2| ((p - middle) * scale).round().to_array().map(|x| x as i32);
        self.grid.clear();
        self.grid.extend(self.flat.iter().map(snap));
        self.earcut.earcut_slice(&self.grid, &[], &mut self.triangles);
        self.orient();
        if self.triangles.is_empty() {
            return None;
        }
        let texel = |p: DVec2| ((p - min) / extent.max(DVec2::splat(f64::MIN_POSITIVE))).as_vec2();
        // Corners on a straight edge are in no triangle.
        let mut corners = Vec::with_capacity(self.distinct.len());
        self.index.clear();
        self.index.resize(self.distinct.len(), u32::MAX);
        for vertex in &mut self.triangles {
            let old = *vertex as usize;
            if self.index[old] == u32::MAX {
                self.index[old] = corners.len() as u32;
                corners.push((self.distinct[old], texel(self.flat[old])));
            }
            *vertex = self.index[old];
        }
        Some(Filled { normal: normal.as_vec3(), corners, triangles: &self.triangles })
    }

    /// The normal of the plane that the outline lies in best: its area as a vector (Newell's method;
    /// Sutherland et al. 1974). For an outline whose halves cancel, as those of an 8 do, the widest
    /// triangle over its first corner.
    fn plane(&self, at: impl Fn(u32) -> DVec3, size: f64) -> Option<DVec3> {
        let ring = || self.distinct.iter().copied().zip(self.distinct.iter().copied().cycle().skip(1));
        let area: DVec3 = ring().map(|(a, b)| at(a).cross(at(b))).sum();
        let least = THINNEST * size * size;
        if area.length() > least {
            return area.try_normalize();
        }
        let base = at(*self.distinct.first()?);
        let away = |i: u32| at(i) - base;
        let far = self
            .distinct
            .iter()
            .copied()
            .reduce(|a, b| if away(b).length_squared() > away(a).length_squared() { b } else { a })?;
        let widest = self
            .distinct
            .iter()
            .map(|&i| away(far).cross(away(i)))
            .reduce(|a, b| if b.length_squared() > a.length_squared() { b } else { a })?;
        if widest.length() > least { widest.try_normalize() } else { None }
    }

    /// Turns all triangles counter-clockwise and drops those without area.
    fn orient(&mut self) {
        let area = |[a, b, c]: [u32; 3]| {
            let [a, b, c] = [a, b, c].map(|i| self.grid[i as usize].map(i64::from));
            (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
        };
        let mut kept = 0;
        for i in (0..self.triangles.len()).step_by(3) {
            let [a, b, c] = [0, 1, 2].map(|k| self.triangles[i + k]);
            let turned = match area([a, b, c]) {
                0 => continue,
                area if area > 0 => [a, b, c],
                _ => [a, c, b],
            };
            self.triangles[kept..kept + 3].copy_from_slice(&turned);
            kept += 3;
        }
        self.triangles.truncate(kept);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use linden_base::random::Key;

    /// The triangles' area, and the outline's by the shoelace formula.
    fn areas(corners: &[Vec3], filled: &Filled) -> (f32, f32) {
        let of = |i: u32| corners[filled.corners[i as usize].0 as usize] - corners[0];
        let triangles = filled.triangles.chunks(3);
        let sum = triangles
            .map(|t| (of(t[1]) - of(t[0])).cross(of(t[2]) - of(t[0])).dot(filled.normal) / 2.0)
            .sum();
        let ring = corners.iter().zip(corners.iter().cycle().skip(1));
        let shoelace = ring.map(|(&a, &b)| (a - corners[0]).cross(b - corners[0])).sum::<Vec3>().length();
        (sum, shoelace / 2.0)
    }

    fn star(points: u32, key: Key) -> Vec<Vec3> {
        // In a slanted plane, far from the origin.
        let (x, y) = (Vec3::new(0.6, 0.8, 0.0), Vec3::new(0.0, 0.6, 0.8));
        (0..points)
            .map(|i| {
                let (sin, cos) = libm::sincosf(i as f32 / points as f32 * std::f32::consts::TAU);
                let radius = key.child(i.into()).between(0.2, 1.0) as f32;
                Vec3::new(10.0, 20.0, -5.0) + (x * cos + y * sin) * radius
            })
            .collect()
    }

    #[test]
    fn triangles_have_the_outlines_area() {
        let mut filler = Filler::default();
        for seed in 0..200 {
            let corners = star(3 + (seed % 40) as u32, Key::new(seed));
            let filled = filler.fill(&corners, Vec3::Y, Vec3::Z).unwrap();
            let (sum, shoelace) = areas(&corners, &filled);
            assert!((sum / shoelace - 1.0).abs() < 1e-3, "seed {seed}: {sum} against {shoelace}");
            assert!(filled.normal.dot(Vec3::Z) > 0.0);
            assert!(filled.corners.iter().all(|(_, uv)| (uv - 0.5).abs().max_element() <= 0.5 + 1e-6));
        }
    }

    #[test]
    fn what_has_no_inside_is_nothing() {
        let mut filler = Filler::default();
        let v = |x: f32, y: f32| Vec3::new(x, y, 0.0);
        for corners in [
            vec![],
            vec![v(0., 0.)],
            vec![v(0., 0.), v(1., 0.)],
            vec![v(0., 0.), v(1., 0.), v(0., 0.), v(1., 0.)],
            vec![v(0., 0.), v(1., 1.), v(2., 2.), v(5., 5.)],
            vec![v(3., 3.); 7],
        ] {
            assert!(filler.fill(&corners, Vec3::Y, Vec3::Z).is_none(), "{corners:?}");
        }
    }

    #[test]
    fn outlines_that_cross_or_touch_themselves_are_filled_somehow() {
        let mut filler = Filler::default();
        let v = |x: f32, y: f32| Vec3::new(x, y, 0.0);
        // An 8, whose halves cancel.
        let eight = [v(0., 0.), v(1., 1.), v(1., 0.), v(0., 1.)];
        assert!(filler.fill(&eight, Vec3::Y, Vec3::Z).is_some());
        // A square with a spur that goes out and back, and a corner in the middle of an edge.
        let spur = [v(0., 0.), v(1., 0.), v(2., 0.), v(1., 0.), v(1., 1.), v(0.5, 1.), v(0., 1.)];
        let filled = filler.fill(&spur, Vec3::Y, Vec3::Z).unwrap();
        assert!((areas(&spur, &filled).0 - 1.0).abs() < 1e-4);
        // Whatever the corners: sound indices, and no panic.
        for seed in 0..300 {
            let key = Key::new(seed);
            let coordinate = |i: u64| (key.child(i).unit() * 4.0).floor() as f32;
            let corners: Vec<Vec3> = (0..12)
                .map(|i| Vec3::new(coordinate(3 * i), coordinate(3 * i + 1), coordinate(3 * i + 2)))
                .collect();
            if let Some(filled) = filler.fill(&corners, Vec3::Y, Vec3::Z) {
                assert!(filled.triangles.iter().all(|&i| (i as usize) < filled.corners.len()));
            }
        }
    }

    #[test]
    fn the_picture_stands_upright_on_the_leaf() {
        let square = [(0., 0.), (2., 0.), (2., 1.), (0., 1.)].map(|(x, y)| Vec3::new(x, y, 0.0));
        let mut filler = Filler::default();
        let filled = filler.fill(&square, Vec3::Y, Vec3::Z).unwrap();
        for (corner, uv) in filled.corners {
            assert_eq!(uv, Vec2::new(square[corner as usize].x / 2.0, square[corner as usize].y));
        }
    }
}
