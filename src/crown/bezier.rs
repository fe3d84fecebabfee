//! A solid of revolution: one cubic Bézier curve turned about the axis.
//!
//! The profile is the true curve: height AND radius come from the parameter, so the height may
//! turn back (an overhanging lower edge, a dented top). Ends that do not touch the axis are closed
//! by discs. The solid is everything that the closed profile winds around.

use std::f64::consts::PI;

use glam::{DVec3, Vec3};

use super::skin::Skin;
use super::{
    Crown, CrownError, Dimensions, SIZE_LIMIT_M, Shape, ShapeKnob, level, radius_squared, revolve,
    round_bounds,
};
use linden_base::knob::{Kind, Knob, Value};
use linden_base::mesh::Bounds;
use linden_base::random::Key;

/// The row of the table of shapes.
pub const SHAPE: Shape = Shape {
    id: "bezier",
    help: "a profile drawn by four control points, like a cypress",
    knobs: &[ShapeKnob {
        knob: Knob::new(
            "profile",
            Kind::Profile { least: 4, most: 4 },
            "m",
            "four control points height,radius of the curve that is turned about the axis",
        )
        .details(
            "The curve runs from the first point to the last; the second and third draw it their way \
             without lying on it. Heights may turn back, for an edge that overhangs or a dented top. Ends \
             off the axis are closed by discs. The four of a cypress are 0,2; 2,1; 7,4.5; 12,0.5.",
        )
        .see_also(&["profile_points", "crown"]),
        default: || Value::Profile(vec![[0.0, 2.0], [2.0, 1.0], [7.0, 4.5], [12.0, 0.5]]),
    }],
    build,
};

/// A solid that fills less of its box is refused: drawing its points would take for ever.
const LEAST_FILL: f64 = 1e-3;

/// Slices of equal height per monotone piece, for the volume: relative error below 1e-5.
const SLICES: u32 = 2048;

fn build(dimensions: &Dimensions) -> Result<Box<dyn Crown>, CrownError> {
    let bad = |problem: &str| CrownError::BadValue { knob: "profile", problem: problem.to_owned() };
    let pairs: [[f64; 2]; 4] =
        dimensions.profile("profile")?.try_into().map_err(|_| bad("expected 4 pairs height,radius"))?;
    if pairs.iter().flatten().any(|x| x.is_nan() || x.abs() > SIZE_LIMIT_M) {
        return Err(bad(&format!("a height or radius is beyond {SIZE_LIMIT_M} m")));
    }
    if pairs.iter().any(|pair| pair[1] < 0.0) {
        return Err(bad("a radius is below 0"));
    }
    let solid = Revolved::new(pairs);
    let fill = solid.volume_m3 / solid.cylinder_m3();
    // NaN when the curve has no height or no radius at all.
    if fill.is_nan() || fill < LEAST_FILL {
        let problem = "the profile is flat or a thread; move its control points apart in height and radius";
        return Err(CrownError::Hollow { shape: "bezier", problem: problem.to_owned() });
    }
    Ok(Box::new(solid))
}

/// One coordinate of the curve, as Bernstein coefficients.
#[derive(Clone, Copy)]
struct Cubic([f64; 4]);

impl Cubic {
    fn at(self, t: f64) -> f64 {
        let [a, b, c, d] = self.0;
        let s = 1.0 - t;
        s * s * s * a + 3.0 * s * s * t * b + 3.0 * s * t * t * c + t * t * t * d
    }

    /// 0, 1 and every parameter between them at which the coordinate turns back, in order.
    fn turns(self) -> Vec<f64> {
        let [a, b, c, d] = self.0;
        // The derivative / 3 is u (1-t)² + 2 v t (1-t) + w t².
        let (u, v, w) = (b - a, c - b, d - c);
        let (square, half_linear) = (u - 2.0 * v + w, v - u);
        let mut turns = vec![0.0];
        let discriminant = half_linear * half_linear - square * u;
        if discriminant > 0.0 {
            // The stable form: no difference of nearly equal numbers.
            let q = -(half_linear + discriminant.sqrt().copysign(half_linear));
            turns.extend([q / square, u / q].into_iter().filter(|t| 0.0 < *t && *t < 1.0));
            turns.sort_by(f64::total_cmp);
        }
        turns.push(1.0);
        turns
    }

    /// The parameter in `low..high`, where the coordinate is monotone, at which it has the value.
    fn solve(self, value: f64, mut low: f64, mut high: f64) -> f64 {
        let rising = self.at(high) > self.at(low);
        // 52 halvings use up the significand.
        for _ in 0..52 {
            let middle = 0.5 * (low + high);
            if (self.at(middle) < value) == rising { low = middle } else { high = middle }
        }
        0.5 * (low + high)
    }
}

struct Revolved {
    height: Cubic,
    radius: Cubic,
    /// Parameters between which the height is monotone.
    turns: Vec<f64>,
    low_m: f64,
    high_m: f64,
    widest_m: f64,
    volume_m3: f64,
}

impl Revolved {
    fn new(pairs: [[f64; 2]; 4]) -> Self {
        let (height, radius) = (Cubic(pairs.map(|pair| pair[0])), Cubic(pairs.map(|pair| pair[1])));
        let turns = height.turns();
        let heights = turns.iter().map(|&t| height.at(t));
        let low_m = heights.clone().fold(f64::INFINITY, f64::min);
        let high_m = heights.fold(f64::NEG_INFINITY, f64::max);
        let widest_m = radius.turns().iter().map(|&t| radius.at(t)).fold(0.0, f64::max);
        let mut solid = Self { height, radius, turns, low_m, high_m, widest_m, volume_m3: 0.0 };
        solid.volume_m3 = solid.volume();
        solid
    }

    /// Where the curve passes a height: radius, and +1 going up or -1 coming down.
    fn crossings(&self, height: f64) -> impl Iterator<Item = (f64, i32)> + '_ {
        self.turns.windows(2).filter_map(move |piece| {
            let (from, to) = (self.height.at(piece[0]), self.height.at(piece[1]));
            // Half open, so that a height where two pieces meet is passed once or twice, rightly.
            let passes = if from < to { (from..to).contains(&height) } else { (to..from).contains(&height) };
            let radius = || self.radius.at(self.height.solve(height, piece[0], piece[1]));
            passes.then(|| (radius(), if from < to { 1 } else { -1 }))
        })
    }

    /// Whether the closed profile winds around a place of the half plane. The discs at the ends
    /// are level and so never pass a height.
    fn winds_around(&self, height: f64, radius: f64) -> bool {
        self.crossings(height).filter(|&(r, _)| r > radius).map(|(_, way)| way).sum::<i32>() != 0
    }

    /// The area of the solid at a height: the rings between consecutive crossings that are wound around.
    fn area_m2(&self, height: f64) -> f64 {
        let mut crossings: Vec<_> = self.crossings(height).collect();
        crossings.sort_by(|a, b| b.0.total_cmp(&a.0));
        let (mut winding, mut area) = (0, 0.0);
        for (i, &(radius, way)) in crossings.iter().enumerate() {
            winding += way;
            let inner = crossings.get(i + 1).map_or(0.0, |next| next.0);
            if winding != 0 {
                area += PI * (radius * radius - inner * inner);
            }
        }
        area
    }

    fn volume(&self) -> f64 {
        // Between the heights at which the number of crossings changes, the area is smooth inside.
        let mut heights: Vec<f64> = self.turns.iter().map(|&t| self.height.at(t)).collect();
        heights.sort_by(f64::total_cmp);
        let piece = |low: f64, high: f64| {
            // Substituting h = low + (high - low)(3s² - 2s³) takes away the square roots at turns.
            let slice = |i: u32| {
                let s = (f64::from(i) + 0.5) / f64::from(SLICES);
                let height = low + (high - low) * s * s * (3.0 - 2.0 * s);
                self.area_m2(height) * (high - low) * 6.0 * s * (1.0 - s) / f64::from(SLICES)
            };
            (0..SLICES).map(slice).sum::<f64>()
        };
        heights.windows(2).map(|ends| piece(ends[0], ends[1])).sum()
    }

    fn cylinder_m3(&self) -> f64 {
        PI * self.widest_m * self.widest_m * (self.high_m - self.low_m)
    }
}

impl Crown for Revolved {
    fn bounds(&self) -> Bounds {
        round_bounds(self.low_m, self.high_m, self.widest_m)
    }

    fn contains(&self, p: DVec3) -> bool {
        self.winds_around(p.y, radius_squared(p).sqrt())
    }

    /// Rejection from the cylinder around it: at most `1 / LEAST_FILL` attempts on average.
    fn sample(&self, key: Key) -> DVec3 {
        let mut attempt = 0;
        loop {
            let key = key.child(attempt);
            let height = self.low_m + (self.high_m - self.low_m) * key.child(0).unit();
            let across = self.widest_m * key.child(1).in_disc();
            if self.winds_around(height, across.length()) {
                return level(height, across);
            }
            attempt += 1;
        }
    }

    fn outline(&self) -> Vec<Vec<Vec3>> {
        let at = |t: f64| (self.height.at(t), self.radius.at(t));
        let mut profile: Vec<_> = (0..=32).map(|i| at(f64::from(i) / 32.0)).collect();
        profile.insert(0, (profile[0].0, 0.0));
        profile.push((self.height.at(1.0), 0.0));
        revolve(&profile, &[0.0, 0.25, 0.5, 0.75, 1.0].map(at))
    }

    fn skin(&self) -> Skin {
        let at = |i: i32| (self.height.at(f64::from(i) / 24.0), self.radius.at(f64::from(i) / 24.0));
        Skin::revolved(&(0..=24).map(at).collect::<Vec<_>>())
    }

    fn volume_m3(&self) -> f64 {
        self.volume_m3
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::assert_uniform;
    use crate::units;

    /// Winding number of the finely sampled closed profile by summed angles: no roots, no pieces.
    fn winds_by_angles(pairs: [[f64; 2]; 4], height: f64, radius: f64) -> bool {
        const STEPS: u32 = 4000;
        let (h, r) = (Cubic(pairs.map(|p| p[0])), Cubic(pairs.map(|p| p[1])));
        let mut outline = vec![(h.at(0.0), 0.0)];
        outline.extend((0..=STEPS).map(|i| f64::from(i) / f64::from(STEPS)).map(|t| (h.at(t), r.at(t))));
        outline.push((h.at(1.0), 0.0));
        let mut sum = 0.0;
        for i in 0..outline.len() {
            let (a, b) = (outline[i], outline[(i + 1) % outline.len()]);
            let (a, b) = ((a.0 - height, a.1 - radius), (b.0 - height, b.1 - radius));
            sum += libm::atan2(a.0 * b.1 - a.1 * b.0, a.0 * b.0 + a.1 * b.1);
        }
        sum.abs() > PI
    }

    const PROFILES: [[[f64; 2]; 4]; 5] = [
        [[0.0, 2.0], [2.0, 1.0], [7.0, 4.5], [12.0, 0.5]],
        // The lower edge hangs below the base, the top is dented.
        [[0.0, 0.5], [-4.0, 5.0], [9.0, 6.0], [4.0, 0.0]],
        // Height turns back twice.
        [[0.0, 1.0], [9.0, 3.0], [-3.0, 3.0], [6.0, 1.0]],
        // Starts above where it ends.
        [[8.0, 0.0], [7.0, 4.0], [1.0, 4.0], [0.0, 0.0]],
        // A loop: the curve crosses itself.
        [[0.0, 1.0], [10.0, 8.0], [-4.0, 8.0], [6.0, 1.0]],
    ];

    #[test]
    fn inside_is_what_the_closed_profile_winds_around() {
        for pairs in PROFILES {
            let solid = Revolved::new(pairs);
            let mut inside = 0;
            for i in 0..3000 {
                let [a, b, _] = units(Key::new(5).child(i));
                let height = solid.low_m - 0.5 + (solid.high_m - solid.low_m + 1.0) * a;
                let radius = (solid.widest_m + 0.5) * b;
                let expected = winds_by_angles(pairs, height, radius);
                assert_eq!(solid.winds_around(height, radius), expected, "{pairs:?} at {height}, {radius}");
                inside += u32::from(expected);
            }
            assert!((200..2800).contains(&inside), "{inside}");
        }
    }

    #[test]
    fn points_are_uniform_in_volume() {
        for pairs in PROFILES {
            assert_uniform(&Revolved::new(pairs));
        }
    }

    #[test]
    fn a_straight_profile_is_a_cylinder_or_a_cone() {
        let cylinder = Revolved::new([[0.0, 2.0], [1.0, 2.0], [2.0, 2.0], [3.0, 2.0]]);
        assert!((cylinder.volume_m3 / (PI * 4.0 * 3.0) - 1.0).abs() < 1e-6);
        let cone = Revolved::new([[0.0, 3.0], [2.0, 2.0], [4.0, 1.0], [6.0, 0.0]]);
        assert!((cone.volume_m3 / (PI * 9.0 * 6.0 / 3.0) - 1.0).abs() < 1e-6);
        assert!(cone.contains(DVec3::new(1.49, 3.0, 0.0)) && !cone.contains(DVec3::new(1.51, 3.0, 0.0)));
    }

    #[test]
    fn what_encloses_nothing_is_refused() {
        let refused = |pairs: [[f64; 2]; 4]| SHAPE.of(&[("profile", Value::Profile(pairs.to_vec()))]).err();
        for flat in [
            [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [3.0, 0.0]],
            [[1.0, 1.0], [1.0, 2.0], [1.0, 3.0], [1.0, 1.0]],
            [[1.0, 1.0]; 4],
        ] {
            assert!(matches!(refused(flat), Some(CrownError::Hollow { .. })), "{flat:?}");
        }
        for bad in [
            [[0.0, -1.0], [1.0, 1.0], [2.0, 1.0], [3.0, 1.0]],
            [[0.0, 1.0], [1e300, 1.0], [2.0, 1.0], [3.0, 1.0]],
            [[0.0, 1.0], [f64::NAN, 1.0], [2.0, 1.0], [3.0, 1.0]],
        ] {
            assert!(matches!(refused(bad), Some(CrownError::BadValue { .. })), "{bad:?}");
        }
    }
}
