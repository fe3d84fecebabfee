//! Fingerprints of arrays: XXH3 (128 bits) over little-endian words, the same on all machines.

use glam::{Vec2, Vec3};
use xxhash_rust::xxh3::Xxh3;

/// Bytes that are handed on at once.
const BLOCK: usize = 1 << 14;

/// Takes arrays one after the other.
pub(crate) struct Fingerprint {
    hasher: Xxh3,
    block: Vec<u8>,
}

impl Fingerprint {
    pub fn new() -> Self {
        Self { hasher: Xxh3::new(), block: Vec::with_capacity(BLOCK) }
    }

    /// An array of words. Its length ends it, so that entries cannot move from one to the next unseen.
    pub fn words(&mut self, words: impl IntoIterator<Item = u32>) {
        let mut count = 0_u64;
        for word in words {
            self.block.extend_from_slice(&word.to_le_bytes());
            count += 1;
            if self.block.len() >= BLOCK {
                self.hasher.update(&self.block);
                self.block.clear();
            }
        }
        self.block.extend_from_slice(&count.to_le_bytes());
    }

    /// Numbers by their bits.
    pub fn reals(&mut self, reals: &[f32]) {
        self.words(reals.iter().map(|real| real.to_bits()));
    }

    /// The same of vectors.
    pub fn vectors(&mut self, vectors: &[Vec3]) {
        self.words(vectors.iter().flat_map(Vec3::to_array).map(f32::to_bits));
    }

    /// The same of vectors in a plane.
    pub fn plane_vectors(&mut self, vectors: &[Vec2]) {
        self.words(vectors.iter().flat_map(Vec2::to_array).map(f32::to_bits));
    }

    pub fn finish(mut self) -> u128 {
        self.hasher.update(&self.block);
        self.hasher.digest128()
    }
}
