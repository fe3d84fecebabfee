//! More stations along an axis, on a smooth curve through those that are there.

use glam::Vec3;

use super::Tubes;
use super::path::Station;
use linden_skeleton::{Skeleton, WidthSteps};

/// On smooth wood the curve turns by no more than this from ring to ring on average of a segment, radians: 2.5 degrees.
/// It does not turn evenly; where it turns most it is three times as much, of which no corner is seen.
const MEAN_TURN: f32 = 0.043_633_23;
/// What that takes at most: a segment between two nodes where the axis turns by 20 degrees.
pub(super) const MOST_SMOOTH_RINGS: u32 = 8;

/// How many rings there are between nodes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fineness {
    /// Everywhere.
    pub rings: u32,
    /// Wood from this radius on, metres, has as many as its curve needs; 0: none has.
    pub smooth_radius_m: f32,
}

impl Fineness {
    /// Of a tree: steps that were asked for have no curve.
    pub fn of(skeleton: &Skeleton, tubes: &Tubes) -> Self {
        let (rings, share) = (tubes.rings, tubes.smooth_wood);
        if share == 0.0 || skeleton.width_steps == WidthSteps::Cylinder {
            return Self { rings, smooth_radius_m: 0.0 };
        }
        let thickest_m = skeleton.radii.iter().copied().fold(0.0, f32::max);
        Self { rings, smooth_radius_m: (share * thickest_m).max(f32::MIN_POSITIVE) }
    }

    /// The most of a segment of a radius.
    pub fn most(self, radius_m: f32) -> u32 {
        let is_smooth = self.smooth_radius_m > 0.0 && radius_m >= self.smooth_radius_m;
        if is_smooth { self.rings.max(MOST_SMOOTH_RINGS) } else { self.rings }
    }

    /// Of a segment of a radius at whose ends the axis turns so far, radians.
    fn rings(self, radius_m: f32, turns: impl FnOnce() -> [f32; 2]) -> u32 {
        let most = self.most(radius_m);
        if most == self.rings {
            return self.rings;
        }
        // Within a segment the curve takes half of the turn at each end.
        let [first, last] = turns();
        let needed = libm::ceilf((first + last) / (2.0 * MEAN_TURN) - 1e-3) as u32;
        needed.clamp(self.rings, most)
    }
}

/// Puts stations between neighbours, evenly in the curve's parameter, on the centripetal
/// Catmull-Rom spline through all of them (Yuksel, Schaefer & Keyser 2011: of all
/// parametrisations the one without cusps and loops within a segment). Radii go linearly.
///
/// At its ends the curve leads on straight. Straight axes stay where they are.
pub(super) fn subdivide(stations: &mut Vec<Station>, fineness: Fineness) {
    let is_fine = |station: &Station| fineness.most(station.radius) > 1;
    if stations.len() < 2
        || (fineness.smooth_radius_m == 0.0 && fineness.rings < 2)
        || !stations.iter().any(is_fine)
    {
        return;
    }
    let coarse = std::mem::take(stations);
    stations.reserve(coarse.len() * fineness.rings as usize);
    let counts = segments(&coarse, fineness);
    for ((i, pair), rings) in coarse.windows(2).enumerate().zip(counts) {
        let (from, to) = (pair[0], pair[1]);
        stations.push(from);
        if rings < 2 {
            continue;
        }
        let mirrored = |of: Vec3, at: Vec3| at * 2.0 - of;
        let before = if i == 0 { mirrored(to.position, from.position) } else { coarse[i - 1].position };
        let after = coarse.get(i + 2).map_or(mirrored(from.position, to.position), |next| next.position);
        let arc = Arc::new([before, from.position, to.position, after]);
        stations.extend((1..rings).map(|k| {
            let t = k as f32 / rings as f32;
            Station { position: arc.at(t), ..from.toward(&to, t) }
        }));
    }
    stations.extend(coarse.last());
}

/// How many rings each segment has: one at its begin, and those up to its end.
pub(super) fn segments(stations: &[Station], fineness: Fineness) -> impl Iterator<Item = u32> {
    let way = |i: usize| stations[i + 1].position - stations[i].position;
    let turn = move |i: usize| {
        let is_end = i == 0 || i + 1 == stations.len();
        if is_end { 0.0 } else { between(way(i - 1), way(i)) }
    };
    stations
        .windows(2)
        .enumerate()
        .map(move |(i, pair)| fineness.rings(pair[0].radius.max(pair[1].radius), || [turn(i), turn(i + 1)]))
}

/// The angle between two ways, radians; 0 where one has no length.
fn between(a: Vec3, b: Vec3) -> f32 {
    libm::atan2f(a.cross(b).length(), a.dot(b))
}

/// The part of the spline between the inner two of four points.
struct Arc {
    points: [Vec3; 4],
    /// Square roots of the distances between them: the centripetal knots' intervals.
    intervals: [f32; 3],
}

impl Arc {
    fn new(points: [Vec3; 4]) -> Self {
        let interval = |i: usize| points[i].distance(points[i + 1]).sqrt();
        Self { points, intervals: [interval(0), interval(1), interval(2)] }
    }

    /// `t` from 0 at the second to 1 at the third point, by the pyramid of Barry & Goldman 1988.
    fn at(&self, t: f32) -> Vec3 {
        let [p0, p1, p2, p3] = self.points;
        let [a, b, c] = self.intervals;
        // Coinciding points have no curve between them, and none bends the arc beside it.
        if a == 0.0 || b == 0.0 || c == 0.0 {
            return p1.lerp(p2, t);
        }
        let u = t * b;
        let first = p0.lerp(p1, (a + u) / a);
        let middle = p1.lerp(p2, t);
        let last = p2.lerp(p3, (u - b) / c);
        first.lerp(middle, (a + u) / (a + b)).lerp(middle.lerp(last, u / (b + c)), t)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::tests::tree;
    use crate::surface::{bends, count};
    use linden_base::monitor::Quiet;
    use linden_base::random::Key;
    use linden_skeleton::{NO_PARENT, Wood};

    fn through(points: &[(f32, f32)], rings: u32) -> Vec<Vec3> {
        let station = |&(x, y): &(f32, f32)| Station::new(Vec3::new(x, y, 0.0), y);
        let mut stations: Vec<Station> = points.iter().map(station).collect();
        subdivide(&mut stations, Fineness { rings, smooth_radius_m: 0.0 });
        stations.iter().map(|station| station.position).collect()
    }

    #[test]
    fn the_nodes_stay_on_the_curve_and_straight_wood_stays_straight() {
        let points = [(0., 0.), (0., 1.), (1., 1.), (1.1, 5.)];
        let fine = through(&points, 4);
        assert_eq!(fine.len(), 13);
        for (i, &(x, y)) in points.iter().enumerate() {
            assert_eq!(fine[4 * i], Vec3::new(x, y, 0.0));
        }
        let straight = through(&[(0., 0.), (0., 0.1), (0., 5.), (0., 5.2)], 8);
        assert!(straight.iter().all(|p| p.x == 0.0) && straight.is_sorted_by(|a, b| a.y < b.y));
        assert_eq!(through(&points, 1).len(), 4);
    }

    /// Points on a circle at equal angles: the curve between them stays near the circle, where the
    /// chord is far from it.
    #[test]
    fn the_curve_follows_a_circle() {
        let circle: Vec<(f32, f32)> =
            (0..9).map(|i| libm::sincosf(i as f32 * std::f32::consts::FRAC_PI_4)).collect();
        let fine = through(&circle, 4);
        let chord = 1.0 - libm::cosf(std::f32::consts::PI / 8.0);
        // The ends lead on straight; between them the curve has both neighbours.
        for p in &fine[4..29] {
            assert!((p.length() - 1.0).abs() < chord * 0.2, "{p}");
        }
    }

    /// A stem that turns by 20 degrees at its third node and by less at others, as thick as it is told.
    fn bent(radius_m: f32, fineness: Fineness) -> Vec<Station> {
        let mut place = Vec3::ZERO;
        let mut stations = vec![Station::new(place, radius_m)];
        for degrees in [0.0_f32, 0.0, 20.0, 24.0, 24.0, 24.0] {
            let (x, y) = libm::sincosf(degrees.to_radians());
            place += Vec3::new(x, y, 0.0) * 0.3;
            stations.push(Station::new(place, radius_m));
        }
        subdivide(&mut stations, fineness);
        stations
    }

    #[test]
    fn thick_wood_has_rings_where_it_bends_and_no_corner_is_left() {
        let fineness = Fineness { rings: 1, smooth_radius_m: 0.1 };
        assert_eq!(bent(0.09, fineness).len(), 7, "thin wood has a ring for each node");
        let smooth = bent(0.1, fineness);
        // Half of 20 degrees takes four rings, 12 of them five, half of 4 one; what is straight has none between.
        assert_eq!(smooth.len(), 7 + 3 + 4);
        let plain = bent(0.1, Fineness { smooth_radius_m: 0.0, ..fineness });
        assert!(plain.iter().all(|node| smooth.iter().any(|other| other.position == node.position)));
        let turn = |stations: &[Station]| {
            let ways: Vec<Vec3> =
                stations.windows(2).map(|pair| pair[1].position - pair[0].position).collect();
            ways.windows(2).map(|pair| pair[0].angle_between(pair[1]).to_degrees()).fold(0.0, f32::max)
        };
        assert!(turn(&plain) > 19.0 && turn(&smooth) < 8.0, "{} {}", turn(&plain), turn(&smooth));
        // No fewer than all wood has: one segment needs five. And no more than MOST_SMOOTH_RINGS however it turns.
        assert_eq!(bent(0.1, Fineness { rings: 4, ..fineness }).len(), 6 * 4 + 1 + 1);
        let mut hairpin = [0.0, 1.0, 0.0].map(|x| Station::new(Vec3::X * x, 0.2)).to_vec();
        subdivide(&mut hairpin, fineness);
        assert_eq!(hairpin.len(), 1 + 2 * MOST_SMOOTH_RINGS as usize);
    }

    /// A stem that turns a little here and there, or nowhere, with straight laterals.
    fn bowed(seed: u64) -> Skeleton {
        let key = Key::new(seed);
        let (mut positions, mut parents) = (vec![Vec3::ZERO], vec![NO_PARENT]);
        let (mut stem, mut degrees) = (0, 0.0);
        for i in 0..8 {
            let key = key.child(i);
            if key.named("turns").unit() < 0.2 * (seed % 4) as f64 {
                degrees += key.named("by").between(-9.0, 9.0) as f32;
            }
            let (x, y) = libm::sincosf(degrees.to_radians());
            let along = Vec3::new(x, y, 0.0) * 0.5;
            positions.push(positions[stem as usize] + along);
            parents.push(stem);
            stem = positions.len() as u32 - 1;
            let side = along.cross(Vec3::Z);
            for reach in [1.0, 2.0] {
                positions.push(positions[stem as usize] + side * reach);
                parents.push(if reach == 1.0 { stem } else { positions.len() as u32 - 2 });
            }
        }
        tree(positions, parents, &Wood { tip_radius_m: Some(0.01), ..Wood::default() })
    }

    #[test]
    fn what_is_said_of_bends_is_what_the_tube_has() {
        let triangles = |skeleton: &Skeleton, smooth_wood: f32| {
            let tubes = Tubes { smooth_wood, ..Tubes::default() };
            let all = count(skeleton, &tubes, &Quiet).unwrap();
            (all.iter().map(|tube| tube.triangles).sum::<usize>(), bends(skeleton, &tubes))
        };
        let mut seen = [0, 0];
        for seed in 0..60 {
            let skeleton = bowed(seed);
            let (plain, never) = triangles(&skeleton, 0.0);
            assert!(!never);
            for share in [0.01, 0.5, 0.8, 1.0] {
                let (smooth, bends) = triangles(&skeleton, share);
                assert_eq!(smooth > plain, bends, "{seed} {share}: {smooth} {plain}");
                seen[usize::from(bends)] += 1;
            }
        }
        assert!(seen.iter().all(|&count| count > 20), "{seen:?}");
    }
}
