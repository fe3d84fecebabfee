//! Randomness keyed by paths.
//!
//! A [`Key`] is a place in a tree of names and numbers: the seed is the root, and each choice asks
//! the key of its own place (`seed / "points" / 17`). Nothing is drawn from a shared stream, so
//! threads, order and later additions change no choice made elsewhere.
//!
//! What is drawn at a place comes from the crates `rand` and `rand_distr`: [`Key::rng`] is a generator
//! for their distributions. Both are exported from here, as the versions whose traits it has.

pub use {rand, rand_distr};

use glam::{DVec2, DVec3};
use rand::distr::uniform::{UniformFloat, UniformSampler};
use rand::{Rng, RngExt, SeedableRng};
use rand_distr::{Distribution, StandardNormal, UnitBall, UnitCircle, UnitDisc};
use rand_xoshiro::SplitMix64;
use xxhash_rust::xxh3::xxh3_64;

/// Odd, bits well spread: 2^64 divided by the golden ratio, as in Steele, Lea & Flood 2014
/// ("Fast splittable pseudorandom number generators", `SplitMix64`).
const GOLDEN_GAMMA: u64 = 0x9E37_79B9_7F4A_7C15;

/// π (3 − √5), 137.5°: turned by it again and again, nothing comes to stand above another. Leaves of a spiral do.
pub const GOLDEN_ANGLE: f64 = 2.399_963_229_728_653;

/// One place where something is chosen at random.
///
/// ```
/// use linden_base::random::Key;
/// let leaf = Key::new(7).named("leaf").child(3);
/// assert_eq!(leaf.unit(), Key::new(7).named("leaf").child(3).unit());
/// assert_ne!(leaf.unit(), Key::new(7).named("leaf").child(4).unit());
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Key(u64);

impl Key {
    /// The root of all choices of one seed.
    pub const fn new(seed: u64) -> Self {
        Self(mix(seed ^ GOLDEN_GAMMA))
    }

    /// The `index`-th place below this one.
    #[must_use]
    pub const fn child(self, index: u64) -> Self {
        Self(mix(self.0 ^ index.wrapping_add(1).wrapping_mul(GOLDEN_GAMMA)))
    }

    /// The place below this one that serves `purpose`.
    #[must_use]
    pub fn named(self, purpose: &str) -> Self {
        Self(mix(self.0 ^ xxh3_64(purpose.as_bytes())))
    }

    /// A generator for any distribution of `rand` and `rand_distr`. It gives the same numbers on every machine,
    /// whatever the version of `rand`: `SplitMix64` is defined by its paper. Its first number is [`Key::bits`].
    ///
    /// A distribution is as portable as its arithmetic: those with logarithms or powers are the platform's,
    /// see [`Key::normal`].
    ///
    /// ```
    /// use linden_base::random::Key;
    /// use linden_base::random::rand_distr::{Distribution, UnitSphere};
    /// let [x, y, z]: [f64; 3] = UnitSphere.sample(&mut Key::new(7).named("direction").rng());
    /// assert!((x * x + y * y + z * z - 1.0).abs() < 1e-12);
    /// ```
    pub fn rng(self) -> SplitMix64 {
        // The generator adds its gamma before it mixes.
        SplitMix64::seed_from_u64(self.0.wrapping_sub(GOLDEN_GAMMA))
    }

    /// All 64 bits of the choice made here.
    pub fn bits(self) -> u64 {
        self.rng().next_u64()
    }

    /// Uniform in `[0, 1)`, 53 bits.
    pub fn unit(self) -> f64 {
        self.rng().random()
    }

    /// Uniform in `[low, high)`; `low` where that is empty or not finite.
    pub fn between(self, low: f64, high: f64) -> f64 {
        UniformFloat::<f64>::sample_single(low, high, &mut self.rng()).unwrap_or(low)
    }

    /// Of the normal distribution with mean 0 and standard deviation 1.
    ///
    /// Drawn as `f32`: behind 3.65 deviations `rand_distr` takes the platform's logarithm (`num-traits` has
    /// the standard library's wherever one crate of a program asks for it), whose last bit differs between
    /// machines; rounded to 24 bits, it does not show.
    pub fn normal(self) -> f64 {
        self.rng().sample::<f32, _>(StandardNormal).into()
    }

    /// Uniform on the circle of radius 1.
    pub fn on_circle(self) -> DVec2 {
        DVec2::from_array(UnitCircle.sample(&mut self.rng()))
    }

    /// Uniform in the disc of radius 1.
    pub fn in_disc(self) -> DVec2 {
        DVec2::from_array(UnitDisc.sample(&mut self.rng()))
    }

    /// Uniform in the ball of radius 1.
    pub fn in_ball(self) -> DVec3 {
        DVec3::from_array(UnitBall.sample(&mut self.rng()))
    }
}

/// The finaliser of `SplitMix64`, a bijection in which each input bit moves half of the output bits. It
/// derives places from places, where the generator would have to be seeded for one number; and it is `const`.
const fn mix(mut z: u64) -> u64 {
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    z ^ (z >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand_distr::UnitSphere;

    #[test]
    fn a_thousand_children_spread_evenly() {
        let root = Key::new(1).named("test");
        let mut bins = [0_u32; 10];
        for i in 0..10_000 {
            bins[(root.child(i).unit() * 10.0) as usize] += 1;
        }
        // 1000 expected per bin, standard deviation 30.
        assert!(bins.iter().all(|&n| (850..1150).contains(&n)), "{bins:?}");
    }

    #[test]
    fn the_stream_is_the_published_splitmix() {
        // First output of SplitMix64 for the state 0, from the paper's reference implementation.
        assert_eq!(mix(GOLDEN_GAMMA), 0xE220_A839_7B1D_CDAF);
        for key in [Key::new(0), Key::new(7).named("points").child(3)] {
            assert_eq!(key.rng().next_u64(), mix(key.0));
            assert_eq!(key.unit(), (key.bits() >> 11) as f64 / (1_u64 << 53) as f64);
        }
    }

    /// Other values here are other trees for everybody's seeds: then the changelog needs a line, and the
    /// digests of the presets are to be made anew. A newer `rand` may bring that about.
    #[test]
    fn the_streams_are_pinned() {
        let key = Key::new(7).named("points");
        let mut rng = key.rng();
        let numbers = [(); 3].map(|()| rng.next_u64());
        assert_eq!(numbers, [0xFA24_72DA_300D_8E79, 0x72D9_D938_8066_D1EB, 0xE687_8286_E6C9_9009]);
        assert_eq!(key.child(3).unit(), 0.626_964_707_771_427_8);
        assert_eq!(key.child(3).between(-2.5, 4.0), 1.575_270_600_514_280_7);
        // The last one from behind 3.65 deviations.
        let normal = [0, 1, 2, 337].map(|i| key.child(i).normal() as f32);
        assert_eq!(normal, [0.904_728_95, 1.030_876, 0.754_174_65, -4.282_843]);
        assert_eq!(key.on_circle().to_array(), [0.977_087_079_898_425_5, -0.212_839_935_856_896_64]);
        assert_eq!(key.in_disc().to_array(), [0.954_237_324_273_076_8, -0.102_726_790_820_449_22]);
        let ball = [0.266_522_568_131_966_06, -0.249_284_572_039_941_03, 0.884_855_301_211_729_7];
        assert_eq!(key.in_ball().to_array(), ball);
        let sphere = [0.536_000_585_168_305_7, -0.057_702_228_357_256_934, -0.842_243_329_176_219];
        let drawn: [f64; 3] = UnitSphere.sample(&mut key.rng());
        assert_eq!(drawn, sphere);
    }

    #[test]
    fn a_range_that_is_none_gives_its_low_end() {
        let key = Key::new(5);
        let (inf, nan) = (f64::INFINITY, f64::NAN);
        for (low, high) in
            [(2.0, 2.0), (2.0, 1.0), (2.0, inf), (2.0, nan), (-inf, inf), (-f64::MAX, f64::MAX)]
        {
            assert_eq!(key.between(low, high), low, "{low} {high}");
        }
        assert!(key.between(nan, 1.0).is_nan());
    }

    #[test]
    fn the_normal_distribution_has_its_moments_and_its_tail() {
        let numbers: Vec<f64> = (0..200_000).map(|i| Key::new(2).child(i).normal()).collect();
        let power = |x: f64, n: usize| (0..n).map(|_| x).product::<f64>();
        let mean = |n: usize| numbers.iter().map(|&x| power(x, n)).sum::<f64>() / numbers.len() as f64;
        // Standard errors: 0.0022, 0.0032, 0.0087, 0.022.
        assert!(mean(1).abs() < 0.01, "{}", mean(1));
        assert!((mean(2) - 1.0).abs() < 0.015, "{}", mean(2));
        assert!(mean(3).abs() < 0.04, "{}", mean(3));
        assert!((mean(4) - 3.0).abs() < 0.1, "{}", mean(4));
        // 2.2e-4 of them lie beyond 3.7: 44 expected, standard deviation 6.6.
        let far = numbers.iter().filter(|x| x.abs() > 3.7).count();
        assert!((18..70).contains(&far), "{far}");
    }
}
