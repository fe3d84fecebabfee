//! Texts that are needed again soon: the corners that triangles share, texture coordinates of a row.

use super::decimal::{self, Digits, FLOAT_ROOM};
use super::records::piece;

/// The texts of numbers that were asked for lately, up to `N` bytes each. It changes how fast a text comes, never the text.
///
/// `SLOTS` fit into the nearest cache; 256 are more than a ring of a trunk and the one above it have vertices.
pub(crate) struct Recent<const N: usize, const SLOTS: usize> {
    slots: [Slot<N>; SLOTS],
    format: fn(u32, &mut [u8; N]) -> usize,
}

#[derive(Clone, Copy)]
struct Slot<const N: usize> {
    text: [u8; N],
    number: u32,
    len: u32,
}

impl<const N: usize, const SLOTS: usize> Recent<N, SLOTS> {
    /// With what a number is as text: `format` writes it, and gives its length.
    pub fn new(format: fn(u32, &mut [u8; N]) -> usize) -> Self {
        // Every slot holds zero at first: a number like any other, where it stands.
        let mut zero = Slot { text: [0; N], number: 0, len: 0 };
        zero.fill(0, format);
        Self { slots: [zero; SLOTS], format }
    }

    /// Writes the text of a number, of which neighbours have slots of their own, and gives its length.
    #[inline]
    pub fn put(&mut self, number: u32, room: &mut [u8; N]) -> usize {
        self.put_from(number, number, room)
    }

    #[inline]
    fn put_from(&mut self, slot: u32, number: u32, room: &mut [u8; N]) -> usize {
        let slot = &mut self.slots[slot as usize % SLOTS];
        if slot.number != number {
            slot.fill(number, self.format);
        }
        *room = slot.text;
        slot.len as usize
    }
}

impl<const N: usize> Slot<N> {
    #[cold]
    #[inline(never)]
    fn fill(&mut self, number: u32, format: fn(u32, &mut [u8; N]) -> usize) {
        self.number = number;
        self.len = format(number, &mut self.text) as u32;
    }
}

/// Integers in decimal.
pub(crate) struct RecentIntegers(Recent<16, 256>);

impl Default for RecentIntegers {
    fn default() -> Self {
        Self(Recent::new(|n, text| Digits::of(n).put(text, 0)))
    }
}

impl RecentIntegers {
    #[inline]
    pub fn put(&mut self, n: u32, room: &mut [u8; 16]) -> usize {
        self.0.put(n, room)
    }
}

/// Floats by their shortest digits, as [`decimal::float`] writes them.
pub(crate) struct RecentFloats(Recent<FLOAT_TEXT, FLOAT_SLOTS>);

/// A power of two: places are the first bits of a product.
const FLOAT_SLOTS: usize = 512;
/// As many bytes as any float has.
const FLOAT_TEXT: usize = 24;

impl Default for RecentFloats {
    fn default() -> Self {
        Self(Recent::new(|bits, text| {
            let mut room = [0; FLOAT_ROOM];
            let len = decimal::float(f32::from_bits(bits), &mut room);
            text.copy_from_slice(&room[..FLOAT_TEXT]);
            len
        }))
    }
}

impl RecentFloats {
    #[inline]
    pub fn put(&mut self, x: f32, room: &mut [u8; FLOAT_ROOM]) -> usize {
        let bits = x.to_bits();
        // By Fibonacci hashing: round numbers differ in their first bits alone.
        self.0.put_from(
            bits.wrapping_mul(0x9e37_79b9) >> (u32::BITS - FLOAT_SLOTS.ilog2()),
            bits,
            piece(room, 0),
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_those_of_std_however_often_they_come() {
        let mut integers = RecentIntegers::default();
        let mut floats = RecentFloats::default();
        // Some at once again, some after others have had their slot, some never.
        let numbers = (0..100_000_u32).map(|i| (i % 7 * i).wrapping_mul(2_654_435_761) >> (i % 32));
        for n in numbers.chain([0, 1, 0, 256, 0, u32::MAX, 0]) {
            let mut room = [0; 16];
            let len = integers.put(n, &mut room);
            assert_eq!(&room[..len], n.to_string().as_bytes());
            let x = [n as f32 / 64.0, f32::from_bits(n), -0.0][n as usize % 3];
            if x.is_finite() {
                let (mut room, mut plain) = ([0; FLOAT_ROOM], [0; FLOAT_ROOM]);
                let lens = [floats.put(x, &mut room), decimal::float(x, &mut plain)];
                assert_eq!(room[..lens[0]], plain[..lens[1]], "{x}");
            }
        }
    }
}
