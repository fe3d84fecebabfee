//! A crown with dents: some boughs reach farther than others, and between them one sees the sky.
//!
//! Lobes look from the middle of the crown into directions spread evenly over a sphere (Fibonacci's spiral, turned and
//! shaken at random). The first is the top's and reaches as far as the crown does; of the others some reach a little
//! farther, most fall short, each by another share, and between neighbours there are clefts. In the direction `q` the
//! crown is `s(q)` times as large about its middle:
//!
//! ```text
//! s(q) = 1 + f · (Σ wᵢ reachᵢ / Σ wᵢ · (1 − cleft · (1 − smoothstep(0, 0.3, φ₂ − φ₁))) − 1),    wᵢ = exp(9 (q · lᵢ − 1))
//! ```
//!
//! where `φ₁` and `φ₂` are the angles to the nearest and the second nearest lobe, and `f` falls from 1 to a quarter on
//! the way down to the crown's base, so that trunks stay as long as they are. Directions are measured in the halves of
//! the crown's box: a tall crown has its lobes one above the other. Points are as dense in all of it.

use glam::{DVec3, Vec3};
use multiversion::multiversion;
use rayon::prelude::*;

use super::Crown;
use super::skin::Skin;
use linden_base::mesh::Bounds;
use linden_base::monitor::{Cancelled, Monitor};
use linden_base::random::{GOLDEN_ANGLE, Key};

/// Lobes of a crown.
const LOBES: usize = 13;
/// How far the longest lobe reaches beyond the crown, at the full amount.
const LONGEST: f64 = 0.2;
/// By how much less the shortest one reaches.
const SHORTEST: f64 = 0.65;
/// How deep clefts are, at the full amount.
const CLEFT: f64 = 0.5;
/// How fast a lobe's share falls off with the angle.
const FALL: f64 = 9.0;
/// The difference of two angles from which on there is no cleft, radians.
const WIDE: f64 = 0.3;
/// How far lobes are shaken off the spiral, in the distance of neighbours.
const SHAKEN: f64 = 0.35;
/// Points that measure the volume.
const PROBES: u64 = 1 << 14;
/// What is left of the dents at the crown's base, and between which heights of a direction they fade.
const AT_BASE: f64 = 0.25;
const FADES: [f64; 2] = [-0.1, -0.8];

/// Where a crown is dented.
#[derive(Clone, Debug)]
pub struct Dents {
    lobes: Lobes,
    cleft: f64,
    middle: DVec3,
    half: DVec3,
}

impl Dents {
    /// Of a crown in a box: `amount` is 0 for none, 1 for lobes and clefts as long and deep as they can be.
    pub fn new(bounds: Bounds, amount: f64, key: Key) -> Self {
        let turn = key.named("turn").between(0.0, std::f64::consts::TAU);
        let apart = (4.0 * std::f64::consts::PI / LOBES as f64).sqrt();
        // Each lobe takes a rank at random, so that some reach all the way in every crown.
        let mut ranks: Vec<usize> = (1..LOBES).collect();
        ranks.sort_by_key(|&rank| key.named("rank").child(rank as u64).bits());
        let lobe = |i: usize| {
            // From the top down.
            let y = 1.0 - 2.0 * i as f64 / (LOBES as f64 - 0.5);
            let round = (1.0 - y * y).max(0.0).sqrt();
            let (sin, cos) = libm::sincos(turn + GOLDEN_ANGLE * i as f64);
            let even = DVec3::new(round * cos, y, round * sin);
            let shaken = SHAKEN * apart * if i == 0 { 0.5 } else { 1.0 };
            let way = (even + key.named("lobe").child(i as u64).in_ball() * shaken).normalize_or(even);
            let reach = match i {
                0 => 1.0,
                _ => {
                    // From nearly 0 to 1; few fall far short.
                    let short = ranks[i - 1] as f64 / (LOBES - 1) as f64;
                    1.0 + amount * (LONGEST - SHORTEST * short * short)
                }
            };
            (way, reach)
        };
        let half = (bounds.size().as_dvec3() / 2.0).max(DVec3::splat(1e-6));
        let middle = ((bounds.min + bounds.max) / 2.0).as_dvec3();
        Self { lobes: Lobes::of((0..LOBES).map(lobe)), cleft: CLEFT * amount, middle, half }
    }

    /// How large the crown is in the direction of a place, as a share of the whole one.
    pub fn share(&self, p: DVec3) -> f64 {
        let q = ((p - self.middle) / self.half).normalize_or_zero();
        if q == DVec3::ZERO {
            return 1.0;
        }
        let mut cosines = [0.0; LANES];
        let mut weights = [0.0; LANES];
        weigh(&self.lobes, q, &mut cosines, &mut weights);
        let (mut sum, mut whole) = (0.0, 0.0);
        let mut nearest = [-1.0_f64; 2];
        for ((&cos, &weight), &reach) in cosines.iter().zip(&weights).zip(&self.lobes.reach).take(LOBES) {
            sum += weight * reach;
            whole += weight;
            nearest = [nearest[0].max(cos), nearest[1].max(nearest[0].min(cos))];
        }
        let cleft = self.cleft * shut(nearest);
        let low = ((FADES[0] - q.y) / (FADES[0] - FADES[1])).clamp(0.0, 1.0);
        1.0 + (1.0 - (1.0 - AT_BASE) * low) * (sum / whole * (1.0 - cleft) - 1.0)
    }

    /// Where a place of the whole crown is in the dented one.
    fn moved(&self, place: Vec3) -> Vec3 {
        let p = place.as_dvec3();
        (self.middle + (p - self.middle) * self.share(p)).as_vec3()
    }
}

/// How far a cleft is there between the two lobes whose directions are nearest, by their cosines, the nearer first:
/// 1 where both are as near, 0 from [`WIDE`] on.
fn shut([first, second]: [f64; 2]) -> f64 {
    // The arc cosine is nowhere less steep between two cosines than at the smaller of them, if it is positive: what
    // is certainly as wide needs no angle.
    const CERTAINLY: f64 = (WIDE + 1e-6) * (WIDE + 1e-6);
    let apart = first - second;
    if second >= 0.0 && apart * apart >= CERTAINLY * (1.0 - second * second) {
        return 0.0;
    }
    let [first, second] = [first, second].map(|cos| libm::acos(cos.clamp(-1.0, 1.0)));
    let t = ((second - first) / WIDE).clamp(0.0, 1.0);
    1.0 - t * t * (3.0 - 2.0 * t)
}

/// Lobes side by side, as vectors of the processor take them.
const LANES: usize = LOBES.next_multiple_of(4);

/// Directions, unit vectors, and how far each reaches, 1 the whole way. What is beyond the last is zero.
#[derive(Clone, Debug, Default)]
struct Lobes {
    x: [f64; LANES],
    y: [f64; LANES],
    z: [f64; LANES],
    reach: [f64; LANES],
}

impl Lobes {
    fn of(lobes: impl Iterator<Item = (DVec3, f64)>) -> Self {
        let mut all = Self::default();
        for (i, (way, reach)) in lobes.take(LANES).enumerate() {
            (all.x[i], all.y[i], all.z[i], all.reach[i]) = (way.x, way.y, way.z, reach);
        }
        all
    }
}

/// The cosine between a direction and each lobe, and how much that lobe has to say there: e to the power of
/// [`FALL`] (cos - 1), which is from -18 to 0 but for rounding.
///
/// All at once, by the method that `libm::exp` takes for one after another (Sun Microsystems 2004, `e_exp.c`), and
/// in its order, so that the bits are those of `libm::exp`.
#[multiversion(targets("x86_64+avx2"))]
fn weigh(lobes: &Lobes, way: DVec3, cosines: &mut [f64; LANES], weights: &mut [f64; LANES]) {
    /// ln 2 in two parts, the first of which is exact times a small integer.
    const LN2: [f64; 2] = [6.931_471_803_691_238e-1, 1.908_214_929_270_587_7e-10];
    /// Of the polynomial for r (e^r + 1) / (e^r - 1) - 2 in r².
    const REMEZ: [f64; 5] = [
        1.666_666_666_666_660_2e-1,
        -2.777_777_777_701_559_3e-3,
        6.613_756_321_437_934e-5,
        -1.653_390_220_546_525_2e-6,
        4.138_136_797_057_238_5e-8,
    ];
    /// From here on up nothing is taken off: half of ln 2 but for the last bits, which `libm::exp` leaves out.
    const WHOLE: f64 = -f64::from_bits(0x3fd6_2e43_0000_0000);
    /// From here on up the exponential is a straight line.
    const LINE: f64 = -f64::from_bits(0x3e30_0001_0000_0000);
    /// Adding it leaves a whole number in the lowest bits.
    const SHIFT: f64 = (1_u64 << 52) as f64;
    for i in 0..LANES {
        let cos = way.x * lobes.x[i] + way.y * lobes.y[i] + way.z * lobes.z[i];
        cosines[i] = cos;
        let x = FALL * (cos - 1.0);
        let turns = (std::f64::consts::LOG2_E * x - 0.5).trunc();
        let k = if x > WHOLE { 0.0 } else { turns };
        let (high, low) = (x - k * LN2[0], k * LN2[1]);
        let r = high - low;
        let r2 = r * r;
        let c = r - r2 * (REMEZ[0] + r2 * (REMEZ[1] + r2 * (REMEZ[2] + r2 * (REMEZ[3] + r2 * REMEZ[4]))));
        let scaled = 1.0 + (r * c / (2.0 - c) - low + high);
        let power = f64::from_bits((k + 1023.0 + SHIFT).to_bits() << 52);
        weights[i] = if x > LINE { 1.0 + x } else { scaled * power };
    }
}

/// A crown with dents.
pub struct Uneven {
    crown: Box<dyn Crown>,
    dents: Dents,
    /// The largest of all shares.
    most: f64,
    volume_m3: f64,
}

impl Uneven {
    /// The dented crown.
    ///
    /// # Errors
    /// [`Cancelled`].
    pub fn new(
        crown: Box<dyn Crown>,
        amount: f64,
        key: Key,
        monitor: &dyn Monitor,
    ) -> Result<Self, Cancelled> {
        let dents = Dents::new(crown.bounds(), amount, key);
        let most = 1.0 + LONGEST * amount;
        let probe = Key::new(0).named("uneven");
        let cubes: Vec<f64> = (0..PROBES)
            .into_par_iter()
            .map(|i| {
                monitor.check()?;
                Ok(cube(dents.share(crown.sample(probe.child(i)))))
            })
            .collect::<Result<_, Cancelled>>()?;
        // In their order, for any number of threads.
        let volume_m3 = crown.volume_m3() * cubes.iter().sum::<f64>() / PROBES as f64;
        Ok(Self { crown, dents, most, volume_m3 })
    }
}

fn cube(x: f64) -> f64 {
    x * x * x
}

impl Crown for Uneven {
    fn bounds(&self) -> Bounds {
        let Bounds { min, max } = self.crown.bounds();
        let far = (max - min) * (0.5 * (self.most - 1.0)) as f32;
        // Nothing is lower than the base or higher than the top by more than lobes are beside them.
        Bounds { min: min - far, max: max + far }
    }

    fn contains(&self, p: DVec3) -> bool {
        let Dents { middle, .. } = self.dents;
        self.crown.contains(middle + (p - middle) / self.dents.share(p))
    }

    /// A place of the whole crown, moved in or out, with the chance that its direction has as much room. A few attempts
    /// on average: no share is below a fifth.
    fn sample(&self, key: Key) -> DVec3 {
        let Dents { middle, .. } = self.dents;
        let mut attempt = 0;
        loop {
            let key = key.child(attempt);
            let p = self.crown.sample(key);
            let share = self.dents.share(p);
            if key.named("room").unit() * cube(self.most) < cube(share) {
                return middle + (p - middle) * share;
            }
            attempt += 1;
        }
    }

    fn outline(&self) -> Vec<Vec<Vec3>> {
        let mut lines = self.crown.outline();
        for place in lines.iter_mut().flatten() {
            *place = self.dents.moved(*place);
        }
        lines
    }

    fn skin(&self) -> Skin {
        self.crown.skin().moved(|place| self.dents.moved(place))
    }

    fn volume_m3(&self) -> f64 {
        self.volume_m3
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shape;
    use linden_base::knob::Value;
    use linden_base::monitor::Quiet;

    fn ball() -> Box<dyn Crown> {
        shape("sphere").unwrap().of(&[("crown_radius", Value::Real(3.0))]).unwrap()
    }

    fn dented(amount: f64, seed: u64) -> Uneven {
        Uneven::new(ball(), amount, Key::new(seed), &Quiet).unwrap()
    }

    /// How far the crown reaches from its middle in directions over a sphere, in its radius.
    fn reaches(crown: &Uneven) -> Vec<(f64, f64)> {
        let directions = (0..400).map(|i| Key::new(77).child(i).in_ball().normalize());
        let reach = |way: DVec3| {
            let steps = (0..800).filter(|i| crown.contains(DVec3::Y * 3.0 + way * (f64::from(*i) * 0.005)));
            (steps.count() as f64 / 600.0, way.y)
        };
        directions.map(reach).collect()
    }

    #[test]
    fn sectors_of_the_crown_reach_differently_far_and_some_all_the_way() {
        for seed in 0..4 {
            let reaches = reaches(&dented(1.0, seed));
            let upper: Vec<f64> =
                reaches.iter().filter(|(_, y)| *y > -0.1).map(|(reach, _)| *reach).collect();
            let share = |from: f64, to: f64| {
                upper.iter().filter(|reach| (from..to).contains(*reach)).count() as f64 / upper.len() as f64
            };
            assert!(share(0.95, 1.21) > 0.1, "seed {seed}: {}", share(0.95, 1.21));
            assert!(share(0.0, 0.75) > 0.15, "seed {seed}: {}", share(0.0, 0.75));
            // The heart stays, and at the base nearly all.
            assert!(share(0.0, 0.2) == 0.0);
            assert!(reaches.iter().filter(|(_, y)| *y < -0.85).all(|(reach, _)| (0.8..1.1).contains(reach)));
        }
        let even = reaches(&dented(0.0, 1));
        assert!(even.iter().all(|(reach, _)| (0.98..1.02).contains(reach)));
    }

    #[test]
    fn points_are_within_and_as_dense_everywhere() {
        let crown = dented(1.0, 5);
        let bounds = crown.bounds();
        // Of places in the box that it contains, and of those that it draws: as many in each half of each axis.
        let mut inside = [0.0; 6];
        let mut drawn = [0.0; 6];
        let count = |halves: &mut [f64; 6], p: DVec3| {
            for (axis, x) in (p - DVec3::Y * 3.0).to_array().into_iter().enumerate() {
                halves[2 * axis + usize::from(x > 0.0)] += 1.0;
            }
        };
        let (mut all, mut kept) = (0.0, 0.0);
        for i in 0..200_000 {
            let key = Key::new(8).child(i);
            let p = DVec3::from([0, 1, 2].map(|axis| key.child(axis).between(-3.6, 3.6))) + DVec3::Y * 3.0;
            all += 1.0;
            if crown.contains(p) {
                kept += 1.0;
                count(&mut inside, p);
            }
        }
        let counted_m3 = kept / all * 7.2 * 7.2 * 7.2;
        assert!((counted_m3 / crown.volume_m3() - 1.0).abs() < 0.03, "{counted_m3} {}", crown.volume_m3());
        for i in 0..60_000 {
            let p = crown.sample(Key::new(3).child(i));
            assert!(
                crown.contains(p)
                    && p.as_vec3().cmpge(bounds.min).all()
                    && p.as_vec3().cmple(bounds.max).all()
            );
            count(&mut drawn, p);
        }
        for (inside, drawn) in inside.iter().zip(&drawn) {
            assert!((inside / kept - drawn / 60_000.0).abs() < 0.012, "{inside} of {kept}, {drawn} of 60000");
        }
    }

    /// Each of the thirteen exponentials that the share is a mean by, one after another, and no angle left out.
    #[test]
    fn shares_have_the_bits_of_the_plain_formula() {
        let formula = |dents: &Dents, p: DVec3| {
            let q = ((p - dents.middle) / dents.half).normalize_or_zero();
            let (mut sum, mut weights) = (0.0, 0.0);
            let mut cosines = Vec::new();
            for i in 0..LOBES {
                let way = DVec3::new(dents.lobes.x[i], dents.lobes.y[i], dents.lobes.z[i]);
                let cos = q.dot(way);
                let weight = libm::exp(FALL * (cos - 1.0));
                sum += weight * dents.lobes.reach[i];
                weights += weight;
                cosines.push(cos);
            }
            cosines.sort_by(|a, b| b.total_cmp(a));
            let [first, second] = [cosines[0], cosines[1]].map(|cos| libm::acos(cos.clamp(-1.0, 1.0)));
            let t = ((second - first) / WIDE).clamp(0.0, 1.0);
            let cleft = dents.cleft * (1.0 - t * t * (3.0 - 2.0 * t));
            let low = ((FADES[0] - q.y) / (FADES[0] - FADES[1])).clamp(0.0, 1.0);
            1.0 + (1.0 - (1.0 - AT_BASE) * low) * (sum / weights * (1.0 - cleft) - 1.0)
        };
        for seed in 0..20 {
            let dents = dented(0.05 * seed as f64, seed).dents;
            let lobes = (0..LOBES).map(|i| DVec3::new(dents.lobes.x[i], dents.lobes.y[i], dents.lobes.z[i]));
            let along = lobes.map(|way| dents.middle + way);
            let any = (0..20_000).map(|i| DVec3::Y * 3.0 + Key::new(seed).child(i).in_ball() * 4.0);
            for p in along.chain(any) {
                assert_eq!(dents.share(p).to_bits(), formula(&dents, p).to_bits(), "seed {seed}: {p}");
            }
        }
    }

    /// Over the whole range of exponents, and on both sides of each place where the method changes.
    #[test]
    fn exponentials_have_the_bits_of_libm() {
        let of = |x: f64| {
            // Along one lobe, so that the cosine is what was asked for.
            let lobes = Lobes::of([(DVec3::X, 1.0)].into_iter());
            let (mut cosines, mut weights) = ([0.0; LANES], [0.0; LANES]);
            let cos = 1.0 + x / FALL;
            weigh(&lobes, DVec3::X * cos, &mut cosines, &mut weights);
            assert_eq!(weights[0].to_bits(), libm::exp(FALL * (cos - 1.0)).to_bits(), "{x}");
        };
        for i in 0..400_000 {
            of(-18.1 * f64::from(i) / 400_000.0);
        }
        for edge in [0.0, 0.5, 1.5, 2.0, 10.0].map(|turns: f64| -turns * std::f64::consts::LN_2) {
            (-2000..2000).for_each(|i| of(edge + f64::from(i) * 1e-15));
        }
        for power in 0..60 {
            of(-libm::scalbn(1.0, -power));
            of(libm::scalbn(1.0, -power - 45));
        }
    }

    #[test]
    fn each_seed_has_dents_of_its_own() {
        let [a, b] = [1, 2].map(|seed| reaches(&dented(0.8, seed)));
        let differ = a.iter().zip(&b).filter(|(a, b)| (a.0 - b.0).abs() > 0.1).count();
        assert!(differ > 100, "{differ} of 400 directions differ");
        assert_eq!(reaches(&dented(0.8, 1)), a);
    }

    /// A surface is where the crown ends.
    #[test]
    fn the_picture_of_it_is_its_surface() {
        let crown = dented(1.0, 4);
        let middle = DVec3::Y * 3.0;
        for place in crown.skin().positions {
            let way = place.as_dvec3() - middle;
            assert!(crown.contains(middle + way * 0.97) && !crown.contains(middle + way * 1.03), "{place}");
        }
    }
}
