//! A crown whose points favour its shell or its top.
//!
//! Leaves live where the light is: near the surface and high up. The density of points is that of a
//! uniform crown times
//!
//! ```text
//! (1 − 0.95 · shell · (1 − (1 − depth)³)) · (1 − 0.95 · top · (1 − height²))
//! ```
//!
//! where `depth` is the distance to the surface as a share of the greatest distance that a place
//! inside has (0 on the surface, 1 at the deepest place), and `height` runs from 0 at the crown's base
//! to 1 at its top. At `shell` 1 the heart of the crown has a twentieth of the density of its surface,
//! at `top` 1 the base a twentieth of that of the top; at 0 neither matters.
//!
//! Depths come from a grid of cubes, 48 along the crown's longest side: each centre's exact distance
//! to the nearest centre outside (Felzenszwalb & Huttenlocher 2012, *Distance Transforms of Sampled
//! Functions*), less half a cube, between centres interpolated. That serves every solid, meshes among
//! them, and is right to about half a cube.

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use super::Crown;
use super::clumps::{Clumps, STRENGTH};
use super::skin::Skin;
use linden_base::mesh::Bounds;
use linden_base::monitor::{Cancelled, Monitor};
use linden_base::random::Key;

/// Cubes along the longest side of the crown.
const CUBES: f64 = 48.0;

/// A squared distance in cubes beyond any.
const FAR: f64 = 1e9;

/// Where the points of a crown gather; both from 0, not at all, to 1.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Favor {
    /// Near the surface.
    pub shell: f64,
    /// High up.
    pub top: f64,
}

impl Favor {
    /// Density at a place, 1 where it is greatest, from its relative depth and height.
    pub fn density(self, depth: f64, height: f64) -> f64 {
        let shallow = 1.0 - depth;
        let shell = 1.0 - STRENGTH * self.shell * (1.0 - shallow * shallow * shallow);
        let top = 1.0 - STRENGTH * self.top * (1.0 - height * height);
        shell * top
    }
}

/// A crown that is denser here than there. Its samples are not uniform, all else is the crown's.
pub struct Favored {
    crown: Box<dyn Crown>,
    favor: Favor,
    clumps: Option<Clumps>,
    /// Absent where depth does not matter.
    depths: Option<Depths>,
}

impl Favored {
    /// # Errors
    /// [`Cancelled`].
    pub fn new(
        crown: Box<dyn Crown>,
        favor: Favor,
        clumps: Option<Clumps>,
        monitor: &dyn Monitor,
    ) -> Result<Self, Cancelled> {
        let depths = if favor.shell > 0.0 { Some(Depths::of(&*crown, monitor)?) } else { None };
        Ok(Self { crown, favor, clumps, depths })
    }

    /// Of the shell and the top: at least as much as there is of all.
    fn favored(&self, p: DVec3) -> f64 {
        let Bounds { min, max } = self.crown.bounds();
        let (low, high) = (f64::from(min.y), f64::from(max.y));
        let height = ((p.y - low) / (high - low)).clamp(0.0, 1.0);
        self.favor.density(self.depths.as_ref().map_or(0.0, |depths| depths.at(p)), height)
    }

    /// Whether a place is taken, where so much of all places is.
    fn takes(&self, p: DVec3, share: f64) -> bool {
        let favored = self.favored(p);
        // Clumps only take away, and take longest to find.
        share < favored && self.clumps.is_none_or(|clumps| share < favored * clumps.density(p))
    }
}

impl Crown for Favored {
    fn bounds(&self) -> Bounds {
        self.crown.bounds()
    }

    fn contains(&self, p: DVec3) -> bool {
        self.crown.contains(p)
    }

    /// The density is nowhere below (1 - 0.95)³, so 8000 attempts at most on average, a few for anything
    /// round.
    fn sample(&self, key: Key) -> DVec3 {
        let mut attempt = 0;
        loop {
            let key = key.child(attempt);
            let p = self.crown.sample(key);
            if self.takes(p, key.named("density").unit()) {
                return p;
            }
            attempt += 1;
        }
    }

    fn outline(&self) -> Vec<Vec<Vec3>> {
        self.crown.outline()
    }

    fn skin(&self) -> Skin {
        self.crown.skin()
    }

    fn volume_m3(&self) -> f64 {
        self.crown.volume_m3()
    }
}

/// Relative depths at the centres of cubes.
struct Depths {
    /// The centre of the first cube.
    first: DVec3,
    cube_m: f64,
    count: [usize; 3],
    shares: Vec<f32>,
}

impl Depths {
    fn of(crown: &dyn Crown, monitor: &dyn Monitor) -> Result<Self, Cancelled> {
        let (min, size) = (crown.bounds().min.as_dvec3(), crown.bounds().size().as_dvec3());
        let cube_m = size.max_element() / CUBES;
        // A layer of cubes outside on all sides.
        let count = (size / cube_m).ceil().to_array().map(|n| n as usize + 2);
        let first = min - 0.5 * cube_m;
        let mut depths = Self { first, cube_m, count, shares: Vec::new() };
        let centre = |index: usize| {
            let [_, ny, nz] = count;
            let at = [index / nz / ny, index / nz % ny, index % nz].map(|i| i as f64);
            first + cube_m * DVec3::from(at)
        };
        // Squared distances in cubes.
        let total = count.iter().product::<usize>();
        let mut squares: Vec<f64> = (0..total)
            .into_par_iter()
            .map(|index| {
                monitor.check()?;
                Ok(if crown.contains(centre(index)) { FAR } else { 0.0 })
            })
            .collect::<Result<_, Cancelled>>()?;
        let [nx, ny, nz] = count;
        for (length, stride, lines) in [(nz, 1, nx * ny), (ny, nz, nx * nz), (nx, ny * nz, ny * nz)] {
            let mut line = vec![0.0; length];
            for number in 0..lines {
                // The first index of a line: those along Y begin in each X anew.
                let start = match stride {
                    1 => number * nz,
                    s if s == nz => number / nz * ny * nz + number % nz,
                    _ => number,
                };
                for (i, square) in line.iter_mut().enumerate() {
                    *square = squares[start + i * stride];
                }
                for (i, square) in nearest_squares(&line).into_iter().enumerate() {
                    squares[start + i * stride] = square;
                }
            }
            monitor.check()?;
        }
        let distance = |square: &f64| (square.sqrt() - 0.5).max(0.0);
        let deepest = squares.iter().map(distance).fold(0.0, f64::max);
        // A solid thinner than a cube is shell throughout.
        let share = |square| if deepest > 0.0 { (distance(square) / deepest) as f32 } else { 0.0 };
        depths.shares = squares.iter().map(share).collect();
        Ok(depths)
    }

    fn at(&self, p: DVec3) -> f64 {
        let most = DVec3::from(self.count.map(|n| n as f64 - 2.0));
        let place = ((p - self.first) / self.cube_m).clamp(DVec3::ZERO, most + 1.0);
        let low = place.floor().min(most);
        let part = place - low;
        let [_, ny, nz] = self.count;
        let corner = ((low.x as usize * ny) + low.y as usize) * nz + low.z as usize;
        let depth = |x: usize, y: usize, z: usize| f64::from(self.shares[corner + (x * ny + y) * nz + z]);
        let between = |a: f64, b: f64, t: f64| a + (b - a) * t;
        let row = |x: usize, y: usize| between(depth(x, y, 0), depth(x, y, 1), part.z);
        let sheet = |x: usize| between(row(x, 0), row(x, 1), part.y);
        between(sheet(0), sheet(1), part.x)
    }
}

/// For each place of a line the least of `value + distance²`: the lower envelope of parabolas.
fn nearest_squares(values: &[f64]) -> Vec<f64> {
    let n = values.len();
    // Parabolas of the envelope by their places, and where each begins to be the lowest.
    let (mut places, mut begins) = (vec![0_usize; n], vec![f64::NEG_INFINITY; n + 1]);
    let mut last = 0;
    begins[1] = f64::INFINITY;
    for q in 1..n {
        let meets = |p: usize| {
            let (a, b) = (q as f64, p as f64);
            ((values[q] + a * a) - (values[p] + b * b)) / (2.0 * (a - b))
        };
        let mut s = meets(places[last]);
        while s <= begins[last] {
            last -= 1;
            s = meets(places[last]);
        }
        last += 1;
        places[last] = q;
        begins[last] = s;
        begins[last + 1] = f64::INFINITY;
    }
    let mut at = 0;
    (0..n)
        .map(|q| {
            while begins[at + 1] < q as f64 {
                at += 1;
            }
            let away = q as f64 - places[at] as f64;
            away * away + values[places[at]]
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::envelope::Envelope;
    use crate::shape;
    use linden_base::input::TriangleMesh;
    use linden_base::knob::Value;
    use linden_base::monitor::Quiet;

    fn ball() -> Box<dyn Crown> {
        shape("sphere").unwrap().of(&[("crown_radius", Value::Real(3.0))]).unwrap()
    }

    fn cylinder(height: f64, radius: f64) -> Box<dyn Crown> {
        let set = [("crown_height", Value::Real(height)), ("crown_radius", Value::Real(radius))];
        shape("cylinder").unwrap().of(&set).unwrap()
    }

    #[test]
    fn squares_of_distances_are_the_least_of_all() {
        for i in 0..200 {
            let key = Key::new(2).child(i);
            let values: Vec<f64> = (0..=i % 30)
                .map(|k| if key.child(k).unit() < 0.3 { 0.0 } else { key.child(k).bits() as f64 % 50.0 })
                .collect();
            for (q, found) in nearest_squares(&values).into_iter().enumerate() {
                let away = |p: usize| (p as f64 - q as f64) * (p as f64 - q as f64);
                let least = (0..values.len()).map(|p| values[p] + away(p)).fold(f64::INFINITY, f64::min);
                assert!((found - least).abs() < 1e-9, "{values:?} at {q}");
            }
        }
    }

    #[test]
    fn depths_are_distances_to_the_surface() {
        let in_ball = |p: DVec3| 1.0 - (p - DVec3::Y * 3.0).length() / 3.0;
        let in_cylinder = |p: DVec3| {
            let side = 2.0 - libm::hypot(p.x, p.z);
            side.min(p.y).min(9.0 - p.y) / 2.0
        };
        let check = |crown: &dyn Crown, exact: &dyn Fn(DVec3) -> f64, slack: f64| {
            let depths = Depths::of(crown, &Quiet).unwrap();
            for i in 0..3000 {
                let p = crown.sample(Key::new(1).child(i));
                assert!((depths.at(p) - exact(p)).abs() < slack, "{p}: {} {}", depths.at(p), exact(p));
            }
        };
        // A cube in deepest distances: 1/24, and 9/48/2.
        check(&*ball(), &in_ball, 1.3 / 24.0);
        check(&*cylinder(9.0, 2.0), &in_cylinder, 1.3 * 9.0 / 48.0 / 2.0);
    }

    /// Counts in ten layers of equal volume against the integral of the law over each.
    fn check_layers(
        crown: Box<dyn Crown>,
        favor: Favor,
        layer: impl Fn(DVec3) -> f64,
        law: impl Fn(f64) -> f64,
    ) {
        const POINTS: u64 = 60_000;
        let crown = Favored::new(crown, favor, None, &Quiet).unwrap();
        let mut counts = [0_f64; 10];
        for i in 0..POINTS {
            let p = crown.sample(Key::new(6).child(i));
            assert!(crown.contains(p));
            counts[((layer(p) * 10.0) as usize).min(9)] += 1.0;
        }
        let share =
            |i: u32| (0..100).map(|k| law((f64::from(i) + (f64::from(k) + 0.5) / 100.0) / 10.0)).sum::<f64>();
        let total: f64 = (0..10).map(share).sum();
        for (i, count) in counts.into_iter().enumerate() {
            let expected = POINTS as f64 * share(i as u32) / total;
            // Five standard deviations, and what half a cube of the grid is worth.
            let slack = 5.0 * expected.sqrt() + 0.05 * expected;
            assert!((count - expected).abs() < slack, "{favor:?}, layer {i}: {count} for {expected}");
        }
    }

    #[test]
    fn points_gather_as_the_law_says() {
        // Layers of equal volume in a ball are equal steps of the cube of the radius, in a
        // cylinder of height.
        let cubed = |p: DVec3| {
            let r = (p - DVec3::Y * 3.0).length() / 3.0;
            r * r * r
        };
        for shell in [0.4, 1.0] {
            let favor = Favor { shell, top: 0.0 };
            check_layers(ball(), favor, cubed, |cube| favor.density(1.0 - libm::cbrt(cube), 0.0));
        }
        for top in [0.4, 1.0] {
            let favor = Favor { shell: 0.0, top };
            check_layers(cylinder(5.0, 2.0), favor, |p| p.y / 5.0, |height| favor.density(0.0, height));
        }
        // By hand: three quarters of the strength at half the height.
        assert!((Favor { shell: 0.0, top: 1.0 }.density(0.5, 0.5) - (1.0 - 0.95 * 0.75)).abs() < 1e-12);
        assert!((Favor { shell: 1.0, top: 0.0 }.density(0.5, 0.5) - (1.0 - 0.95 * 0.875)).abs() < 1e-12);
        assert!((Favor::default().density(0.3, 0.6) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn a_twentieth_is_left_between_clumps() {
        const POINTS: u64 = 40_000;
        let clumps = Clumps { share: 1.0, size_m: 1.2, key: Key::new(5) };
        let even = ball();
        let gathered = Favored::new(ball(), Favor::default(), Some(clumps), &Quiet).unwrap();
        // How many lie where the density is 1, and where it is least.
        let counts = |crown: &dyn Crown| {
            let densities = (0..POINTS).map(|i| clumps.density(crown.sample(Key::new(8).child(i))));
            densities.fold([0.0, 0.0], |[whole, least], density| {
                [whole + f64::from(density == 1.0), least + f64::from(density < 1.0 - STRENGTH + 1e-9)]
            })
        };
        let ([whole, least], [gathered_whole, gathered_least]) = (counts(&*even), counts(&gathered));
        assert!(whole > 3000.0 && least > 3000.0, "{whole} {least}");
        let expected = (1.0 - STRENGTH) * least * gathered_whole / whole;
        assert!((gathered_least - expected).abs() < 5.0 * expected.sqrt(), "{gathered_least} for {expected}");
    }

    #[test]
    fn a_mesh_has_a_shell_too() {
        let corner = |i: u32| DVec3::new(f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2));
        let quads = [[0, 4, 5, 1], [0, 2, 6, 4], [1, 5, 7, 3], [0, 1, 3, 2], [4, 6, 7, 5], [2, 3, 7, 6]];
        let mesh = TriangleMesh {
            positions: (0..8).map(corner).collect(),
            triangles: quads.iter().flat_map(|q| [[q[0], q[1], q[2]], [q[0], q[2], q[3]]]).collect(),
        };
        let envelope = Box::new(Envelope::new(&mesh, &Quiet).unwrap());
        // In a cube of side 1 the part with a depth beyond `d` halves is (1 - d)³.
        let depth = |p: DVec3| {
            let across = 0.5 - p.x.abs().max(p.z.abs());
            2.0 * across.min(p.y).min(1.0 - p.y)
        };
        let favor = Favor { shell: 1.0, top: 0.0 };
        let layer = |p: DVec3| {
            let s = 1.0 - depth(p);
            s * s * s
        };
        check_layers(envelope, favor, layer, |cube| favor.density(1.0 - libm::cbrt(cube), 0.0));
    }
}
