//! Randomness keyed by paths.
//!
//! A [`Key`] is a place in a tree of names and numbers: the seed is the root, and each choice asks
//! the key of its own place (`seed / "points" / 17`). Nothing is drawn from a shared stream, so
//! threads, order and later additions change no choice made elsewhere.

use xxhash_rust::xxh3::xxh3_64;

/// Odd, bits well spread: 2^64 divided by the golden ratio, as in Steele, Lea & Flood 2014
/// ("Fast splittable pseudorandom number generators", `SplitMix64`).
const GOLDEN_GAMMA: u64 = 0x9E37_79B9_7F4A_7C15;

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

    /// All 64 bits of the choice made here.
    pub const fn bits(self) -> u64 {
        mix(self.0)
    }

    /// Uniform in `[0, 1)`, 53 bits.
    pub fn unit(self) -> f64 {
        (self.bits() >> 11) as f64 * (1.0 / (1_u64 << 53) as f64)
    }

    /// Uniform in `[low, high)`.
    pub fn between(self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }
}

/// The finaliser of `SplitMix64`, a bijection in which each input bit moves half of the output bits.
const fn mix(mut z: u64) -> u64 {
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    z ^ (z >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

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
    }
}
