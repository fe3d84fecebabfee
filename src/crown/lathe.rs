//! What a closed polyline of height and radius sweeps when it turns about the axis.
//!
//! Inside is what the profile winds around, whichever way. Between the heights of its corners and
//! crossings the solid is a stack of rings with straight sides, so that its volume is exact and its
//! points are drawn without rejection.

use std::f64::consts::PI;
use std::ops::Range;

use glam::{DVec3, Vec3};

use super::skin::Skin;
use super::{Crown, level, radius_squared, revolve, round_bounds};
use linden_base::mesh::Bounds;
use linden_base::random::Key;

/// A solid of revolution with straight sides.
pub struct Lathe {
    profile: Vec<[f64; 2]>,
    /// From low to high.
    slabs: Vec<Slab>,
    rings: Vec<Ring>,
    low_m: f64,
    high_m: f64,
    widest_m: f64,
    volume_m3: f64,
}

/// The part between two heights; its rings do not touch but at their edges.
struct Slab {
    low_m: f64,
    high_m: f64,
    rings: Range<usize>,
}

/// A ring with straight sides: radii at the slab's lower and upper end.
struct Ring {
    low_m: f64,
    high_m: f64,
    inner_m: [f64; 2],
    outer_m: [f64; 2],
    /// The volume of this ring and of all before it.
    up_to_m3: f64,
}

impl Ring {
    /// Inner and outer radius at a share of the height.
    fn radii(&self, up: f64) -> [f64; 2] {
        [self.inner_m, self.outer_m].map(|[low, high]| low + (high - low) * up)
    }

    /// The volume below a share of the height: that of a frustum less that of another.
    fn below_m3(&self, up: f64) -> f64 {
        let [inner, outer] = self.radii(up);
        let frustum = |a: f64, b: f64| a * a + a * b + b * b;
        let squares = frustum(self.outer_m[0], outer) - frustum(self.inner_m[0], inner);
        PI / 3.0 * up * (self.high_m - self.low_m) * squares
    }

    /// Between which shares of the height so much volume is reached: one of the intervals that halving comes to,
    /// found by Newton's method, so that most halvings need not be done.
    fn guess(&self, below_m3: f64) -> (f64, f64) {
        /// Each about doubles the digits.
        const ROUNDS: u32 = 4;
        /// How many intervals there are in the whole: the more, the less is left to halve.
        const PARTS: [f64; 2] = [(1_u64 << 42) as f64, (1_u64 << 16) as f64];
        /// What rounding adds to a volume, as a share of the cylinder around the ring: far more than it can.
        const CARE: f64 = 1.0 / (1_u64 << 48) as f64;
        let mut up = below_m3 / self.below_m3(1.0);
        for _ in 0..ROUNDS {
            let [inner, outer] = self.radii(up);
            let area = PI * (outer * outer - inner * inner) * (self.high_m - self.low_m);
            up = (up - (self.below_m3(up) - below_m3) / area).clamp(0.0, 1.0);
        }
        let widest = self.outer_m[0].max(self.outer_m[1]);
        let care_m3 = CARE * PI * widest * widest * (self.high_m - self.low_m);
        let is_between = |&(low, high): &(f64, f64)| {
            (low == 0.0 || self.below_m3(low) < below_m3 - care_m3)
                && (high == 1.0 || self.below_m3(high) > below_m3 + care_m3)
        };
        let part = |parts: f64| {
            let part = (up * parts).floor().min(parts - 1.0);
            (part / parts, (part + 1.0) / parts)
        };
        // Newton's method may end in a division by nothing, or at a place right beside the interval.
        PARTS.map(part).into_iter().find(is_between).unwrap_or((0.0, 1.0))
    }
}

/// What is left of a whole after 52 halvings.
const HALVED: f64 = 1.0 / (1_u64 << 52) as f64;

/// A side of the profile that passes a slab.
struct Side {
    /// Radii at the slab's ends.
    radii_m: [f64; 2],
    /// +1 going up, -1 coming down.
    way: i32,
}

impl Lathe {
    /// Takes the corners of the profile: height, radius. Level sides, the discs at the ends among
    /// them, bound the solid like any other.
    pub fn new(profile: &[[f64; 2]]) -> Self {
        let mut solid = Self {
            profile: profile.to_vec(),
            slabs: Vec::new(),
            rings: Vec::new(),
            low_m: profile.iter().map(|corner| corner[0]).fold(f64::INFINITY, f64::min),
            high_m: profile.iter().map(|corner| corner[0]).fold(f64::NEG_INFINITY, f64::max),
            widest_m: profile.iter().map(|corner| corner[1]).fold(0.0, f64::max),
            volume_m3: 0.0,
        };
        let mut heights: Vec<f64> = profile.iter().map(|corner| corner[0]).collect();
        heights.sort_by(f64::total_cmp);
        heights.dedup();
        for ends in heights.windows(2) {
            // Where sides cross, their order changes.
            let sides = solid.sides(ends[0], ends[1]);
            let mut cuts = vec![ends[0], ends[1]];
            cuts.extend(crossings(&sides).map(|up| ends[0] + (ends[1] - ends[0]) * up));
            cuts.sort_by(f64::total_cmp);
            cuts.dedup();
            for slab in cuts.windows(2) {
                solid.stack(slab[0], slab[1]);
            }
        }
        solid
    }

    /// The sides that pass a slab in which none begins or ends.
    fn sides(&self, low: f64, high: f64) -> Vec<Side> {
        let passing = |corners: &[[f64; 2]]| {
            let ([from, a], [to, b]) = (corners[0], corners[1]);
            (from.min(to) <= low && high <= from.max(to)).then(|| Side {
                radii_m: [low, high].map(|height| a + (b - a) * (height - from) / (to - from)),
                way: if from < to { 1 } else { -1 },
            })
        };
        self.profile.windows(2).filter_map(passing).collect()
    }

    /// Adds the rings of a slab in which no sides cross.
    fn stack(&mut self, low_m: f64, high_m: f64) {
        let mut sides = self.sides(low_m, high_m);
        // Straight sides that do not cross are in the order of their middles.
        sides.sort_by(|a, b| (b.radii_m[0] + b.radii_m[1]).total_cmp(&(a.radii_m[0] + a.radii_m[1])));
        let first = self.rings.len();
        let mut winding = 0;
        for (i, side) in sides.iter().enumerate() {
            winding += side.way;
            if winding == 0 {
                continue;
            }
            let inner_m = sides.get(i + 1).map_or([0.0; 2], |next| next.radii_m);
            let ring = Ring { low_m, high_m, inner_m, outer_m: side.radii_m, up_to_m3: 0.0 };
            let volume = ring.below_m3(1.0);
            if volume > 0.0 {
                self.volume_m3 += volume;
                self.rings.push(Ring { up_to_m3: self.volume_m3, ..ring });
            }
        }
        self.slabs.push(Slab { low_m, high_m, rings: first..self.rings.len() });
    }

    /// The volume of the cylinder around it.
    pub fn cylinder_m3(&self) -> f64 {
        PI * self.widest_m * self.widest_m * (self.high_m - self.low_m)
    }
}

/// Shares of a slab's height at which two of its sides cross.
fn crossings(sides: &[Side]) -> impl Iterator<Item = f64> + '_ {
    sides.iter().enumerate().flat_map(move |(i, a)| {
        sides[..i].iter().filter_map(move |b| {
            let [low, high] = [0, 1].map(|end| a.radii_m[end] - b.radii_m[end]);
            (low * high < 0.0).then(|| low / (low - high))
        })
    })
}

impl Crown for Lathe {
    fn bounds(&self) -> Bounds {
        round_bounds(self.low_m, self.high_m, self.widest_m)
    }

    fn contains(&self, p: DVec3) -> bool {
        let Some(slab) = self.slabs.get(self.slabs.partition_point(|slab| slab.high_m < p.y)) else {
            return false;
        };
        if p.y < slab.low_m {
            return false;
        }
        let up = (p.y - slab.low_m) / (slab.high_m - slab.low_m);
        let radius = radius_squared(p).sqrt();
        self.rings[slab.rings.clone()].iter().any(|ring| {
            let [inner, outer] = ring.radii(up);
            (inner..=outer).contains(&radius)
        })
    }

    /// A ring by its volume, a height by the volume below it, a radius by the area within.
    fn sample(&self, key: Key) -> DVec3 {
        let volume = key.child(0).unit() * self.volume_m3;
        let slot = self.rings.partition_point(|ring| ring.up_to_m3 <= volume);
        // Rounding may lead past the last one; a lathe without rings is never drawn from.
        let Some(ring) = self.rings.get(slot).or_else(|| self.rings.last()) else { return DVec3::ZERO };
        let below = volume - (ring.up_to_m3 - ring.below_m3(1.0));
        let (mut low, mut high) = ring.guess(below);
        // As far as 52 halvings of the whole would come, which use up the significand.
        while high - low > HALVED {
            let middle = 0.5 * (low + high);
            if ring.below_m3(middle) < below { low = middle } else { high = middle }
        }
        let up = 0.5 * (low + high);
        let [inner, outer] = ring.radii(up);
        let radius = (inner * inner + (outer * outer - inner * inner) * key.child(1).unit()).sqrt();
        level(ring.low_m + (ring.high_m - ring.low_m) * up, radius * key.child(2).on_circle())
    }

    fn outline(&self) -> Vec<Vec<Vec3>> {
        let mut profile: Vec<(f64, f64)> =
            self.profile.iter().map(|&[height, radius]| (height, radius)).collect();
        // Rings at the widest and narrowest places, evenly thinned where there are many.
        let turns = |i: &usize| {
            let radius = |i: usize| profile[i].1;
            *i == 0
                || *i + 1 == profile.len()
                || (radius(*i) - radius(i - 1)) * (radius(i + 1) - radius(*i)) <= 0.0
        };
        let turning: Vec<usize> = (0..profile.len()).filter(turns).collect();
        let rings: Vec<(f64, f64)> =
            turning.iter().step_by(turning.len().div_ceil(8).max(1)).map(|&i| profile[i]).collect();
        if let (Some(&first), Some(&last)) = (profile.first(), profile.last()) {
            profile.insert(0, (first.0, 0.0));
            profile.push((last.0, 0.0));
        }
        revolve(&profile, &rings)
    }

    fn skin(&self) -> Skin {
        Skin::revolved(&self.profile.iter().map(|&[height, radius]| (height, radius)).collect::<Vec<_>>())
    }

    fn volume_m3(&self) -> f64 {
        self.volume_m3
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{around, units};

    /// Winding number of the closed profile by summed angles: no slabs, no order of sides.
    fn winds_by_angles(profile: &[[f64; 2]], height: f64, radius: f64) -> bool {
        let mut closed = vec![[profile[0][0], 0.0]];
        closed.extend(profile);
        closed.push([profile[profile.len() - 1][0], 0.0]);
        let mut sum = 0.0;
        for i in 0..closed.len() {
            let [a, b] = [closed[i], closed[(i + 1) % closed.len()]].map(|[h, r]| (h - height, r - radius));
            sum += libm::atan2(a.0 * b.1 - a.1 * b.0, a.0 * b.0 + a.1 * b.1);
        }
        sum.abs() > PI
    }

    #[test]
    fn inside_is_what_the_closed_profile_winds_around() {
        let mut inside = 0;
        for i in 0..400 {
            let key = Key::new(8).child(i);
            let corners = 2 + i % 12;
            // Whole numbers, so that corners share heights and sides meet in corners.
            let profile: Vec<[f64; 2]> = (0..corners)
                .map(|k| [0, 1].map(|axis| key.child(k).child(axis).between(0.0, 6.0).floor()))
                .collect();
            let solid = Lathe::new(&profile);
            for k in 0..60 {
                let [a, b, turn] = units(key.named("place").child(k));
                let (height, radius) = (-0.5 + 7.0 * a, 0.01 + 6.5 * b);
                let expected = winds_by_angles(&profile, height, radius);
                let found = solid.contains(around(height, radius, turn));
                assert_eq!(found, expected, "{profile:?} at {height}, {radius}");
                inside += u32::from(expected);
            }
        }
        assert!((3000..20_000).contains(&inside), "{inside}");
    }

    #[test]
    fn heights_are_those_of_halving_alone() {
        for i in 0..300 {
            let key = Key::new(11).child(i);
            let profile: Vec<[f64; 2]> = (0..6)
                .map(|k| [0, 1].map(|axis| key.child(k).child(axis).between(0.0, 6.0).max(1.0) - 1.0))
                .collect();
            let solid = Lathe::new(&profile);
            for ring in &solid.rings {
                for share in [0.0, 1e-12, 1e-3, 0.3, 0.5, 0.97, 1.0 - 1e-12, 1.0] {
                    let below = share * ring.below_m3(1.0);
                    let halved = |mut low: f64, mut high: f64| {
                        while high - low > HALVED {
                            let middle = 0.5 * (low + high);
                            if ring.below_m3(middle) < below { low = middle } else { high = middle }
                        }
                        (low, high)
                    };
                    let (low, high) = ring.guess(below);
                    assert_eq!(halved(low, high), halved(0.0, 1.0), "{profile:?}, {share}");
                }
            }
        }
    }

    #[test]
    fn known_solids_have_their_volumes() {
        let volume = |profile: &[[f64; 2]]| Lathe::new(profile).volume_m3() / PI;
        assert!((volume(&[[0.0, 2.0], [3.0, 2.0]]) - 12.0).abs() < 1e-12);
        assert!((volume(&[[6.0, 0.0], [0.0, 3.0]]) - 18.0).abs() < 1e-12, "a cone, drawn from its tip");
        // A bowl: a cylinder of radius 2 and height 2, less a cone.
        assert!((volume(&[[0.0, 2.0], [2.0, 2.0], [0.0, 0.0]]) - (8.0 - 8.0 / 3.0)).abs() < 1e-12);
        // Sides that cross: both parts count, whichever way they are wound around.
        let crossed = volume(&CROSSED);
        assert!((crossed / crossed_by_slices() - 1.0).abs() < 2e-3, "{crossed}");
    }

    const CROSSED: [[f64; 2]; 4] = [[0.0, 2.0], [4.0, 4.0], [4.0, 2.0], [0.0, 4.0]];

    /// The volume of the crossed profile ÷ π by thin slices and [`winds_by_angles`].
    fn crossed_by_slices() -> f64 {
        const N: i32 = 400;
        let mut sum = 0.0;
        for i in 0..N {
            for k in 0..N {
                let (height, radius) =
                    (4.0 * (f64::from(i) + 0.5) / f64::from(N), 4.0 * (f64::from(k) + 0.5) / f64::from(N));
                if winds_by_angles(&CROSSED, height, radius) {
                    sum += 2.0 * radius * (4.0 / f64::from(N)) * (4.0 / f64::from(N));
                }
            }
        }
        sum
    }
}
