//! More stations along an axis, on a smooth curve through those that are there.

use glam::Vec3;

use super::path::Station;

/// Puts `rings - 1` stations between neighbours, evenly in the curve's parameter, on the centripetal
/// Catmull-Rom spline through all of them (Yuksel, Schaefer & Keyser 2011: of all
/// parametrisations the one without cusps and loops within a segment). Radii go linearly.
///
/// At its ends the curve leads on straight. Straight axes stay where they are.
pub(super) fn subdivide(stations: &mut Vec<Station>, rings: u32) {
    if rings < 2 || stations.len() < 2 {
        return;
    }
    let coarse = std::mem::take(stations);
    stations.reserve(coarse.len() * rings as usize);
    for (i, pair) in coarse.windows(2).enumerate() {
        let (from, to) = (pair[0], pair[1]);
        stations.push(from);
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

    fn through(points: &[(f32, f32)], rings: u32) -> Vec<Vec3> {
        let station = |&(x, y): &(f32, f32)| Station::new(Vec3::new(x, y, 0.0), y);
        let mut stations: Vec<Station> = points.iter().map(station).collect();
        subdivide(&mut stations, rings);
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
}
