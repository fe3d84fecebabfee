//! Numbers as decimal text: integers, and single-precision floats by their shortest digits.
//!
//! Both have their digits side by side in one register, and are stored in pieces of a length that the compiler knows.

use std::hint::select_unpredictable;

use super::records::piece;

/// Bytes that [`float`] may touch: those of any number, and a register more.
pub(super) const FLOAT_ROOM: usize = 32;

const EIGHT: u32 = 100_000_000;
const ASCII_ZEROS: u64 = 0x3030_3030_3030_3030;

/// An integer in decimal, to be written any number of times.
#[derive(Clone, Copy)]
pub struct Digits {
    pub(super) text: [u8; 16],
    pub(super) len: usize,
}

impl Digits {
    /// The digits of a number.
    #[inline]
    pub fn of(n: u32) -> Self {
        let mut text = [0; 16];
        if n < EIGHT {
            let low = eight_digits(n);
            // The first digit is in the lowest byte, so zeros to be dropped are trailing ones.
            let zeros = low.trailing_zeros().min(56) / 8;
            text[..8].copy_from_slice(&((low >> (8 * zeros)) | ASCII_ZEROS).to_le_bytes());
            return Self { text, len: 8 - zeros as usize };
        }
        let (high, low) = (n / EIGHT, eight_digits(n % EIGHT));
        let mut len = 0;
        if high >= 10 {
            text[0] = b'0' + (high / 10) as u8;
            len = 1;
        }
        text[len] = b'0' + (high % 10) as u8;
        text[len + 1..len + 9].copy_from_slice(&(low | ASCII_ZEROS).to_le_bytes());
        Self { text, len: len + 9 }
    }

    /// Stores them from a place on, of which 16 bytes may be touched, and gives the place behind them.
    #[inline]
    pub(crate) fn put<const N: usize>(self, room: &mut [u8; N], at: usize) -> usize {
        *piece(room, at) = self.text;
        at + self.len
    }
}

/// The eight decimal digits of a number below 10⁸, one per byte, the first in the lowest: halves, then
/// quarters, then digits are divided side by side in one register. The multiplications are divisions by 10⁴, 100
/// and 10, exact for numbers below 10⁸, 10⁴ and 10²; what is left of each goes up into its place by a second one.
#[inline]
fn eight_digits(n: u32) -> u64 {
    let n = u64::from(n);
    let halves = (n << 32) - ((n * 109_951_163) >> 40) * ((10_000 << 32) - 1);
    let hundreds = (halves * 10_486) >> 20 & 0x0000_007f_0000_007f;
    let quarters = (halves << 16) - hundreds * ((100 << 16) - 1);
    let tens = (quarters * 103) >> 10 & 0x000f_000f_000f_000f;
    (quarters << 8) - tens * ((10 << 8) - 1)
}

/// Writes the shortest decimals that read back as a finite `x`, the nearest of them, whole numbers without a point, and
/// gives their length.
#[inline]
pub(super) fn float(x: f32, room: &mut [u8; FLOAT_ROOM]) -> usize {
    debug_assert!(x.is_finite());
    shortest(x, room).unwrap_or_else(|| rare(x, room))
}

/// [`float`] of zeros, powers of two, and what is tiny or huge.
#[cold]
fn rare(x: f32, room: &mut [u8; FLOAT_ROOM]) -> usize {
    let mut buffer = zmij::Buffer::new();
    let text = buffer.format_finite(x);
    let text = text.strip_suffix(".0").unwrap_or(text).as_bytes();
    room.iter_mut().zip(text).for_each(|(place, digit)| *place = *digit);
    text.len()
}

/// The exponent of the least numbers that [`shortest`] takes, as it is stored: 2⁻¹³.
const LEAST: u32 = 127 - 13;
/// How many powers of two there are from there to 2²³.
const BINADES: usize = 36;
/// Bits behind the point of products of a significand and a unit: the least numbers are multiples of 2⁻³⁶.
const POINT: u32 = 36;

/// Numbers between two powers of two, which are equally far away from each other.
#[derive(Clone, Copy)]
struct Binade {
    /// The distance of two of them in units of the largest power of ten that is not larger, 1 to 10, times
    /// 2^[`POINT`]. It is exact.
    unit: u64,
    /// The power of ten from which on a number in these units has one more digit than the least one.
    longer: u32,
}

/// Where the digits go of a number with as many digits before the point.
#[derive(Clone, Copy)]
struct Layout {
    /// What a number is multiplied by, so that it has nine digits.
    scale: u32,
    /// Digits before the point, 0 where the first one is behind it.
    whole: u8,
    /// Bytes that the text is longer than its digits: the point, and zeros at the front.
    more: u8,
    /// Of the first eight digits, those that are before the point, as bits to be kept.
    kept: u64,
    /// What stands in the first eight bytes instead of the others.
    put: u64,
}

static BINADE: [Binade; BINADES] = tables().0;
/// Two for each of [`BINADE`]: of numbers below [`Binade::longer`], and of the others.
static LAYOUT: [Layout; 2 * BINADES] = tables().1;

const fn tables() -> ([Binade; BINADES], [Layout; 2 * BINADES]) {
    let mut binades = [Binade { unit: 0, longer: 0 }; BINADES];
    let mut layouts = [Layout { scale: 0, whole: 0, more: 0, kept: 0, put: 0 }; 2 * BINADES];
    let mut i = 0;
    while i < BINADES {
        // Numbers here are multiples of 2^−shift.
        let shift = POINT - i as u32;
        let mut decimals = 0;
        while 10_u64.pow(decimals) >> shift == 0 {
            decimals += 1;
        }
        let unit = 10_u64.pow(decimals) << (POINT - shift);
        let digits = 1 + (unit >> (POINT - 23)).ilog10();
        binades[i] = Binade { unit, longer: 10_u32.pow(digits) };
        let mut longer = 0;
        while longer < 2 {
            let digits = digits + longer;
            let scale = if digits < 9 { 10_u32.pow(9 - digits) } else { 1 };
            layouts[2 * i + longer as usize] = if digits > decimals {
                let whole = digits - decimals;
                let kept = u64::MAX >> (64 - 8 * whole);
                let put = if whole < 8 { (b'.' as u64) << (8 * whole) } else { 0 };
                Layout { scale, whole: whole as u8, more: 1, kept, put }
            } else {
                let put = ASCII_ZEROS - 0x30_00 + ((b'.' as u64) << 8);
                Layout { scale, whole: 0, more: 2 + (decimals - digits) as u8, kept: 0, put }
            };
            longer += 1;
        }
        i += 1;
    }
    (binades, layouts)
}

/// [`float`] of magnitudes from 2⁻¹³ to 2²³ but for powers of two: `None` for all else. By Schubfach (Raffaello
/// Giulietti, The Schubfach way to render doubles, 2021), which is exact in 64 bits here. No branch depends on the
/// digits, as no processor could foresee it.
// A call would store the registers that all of it is in.
#[inline(always)]
fn shortest(x: f32, room: &mut [u8; FLOAT_ROOM]) -> Option<usize> {
    const ONE: u64 = 1 << POINT;
    let bits = x.to_bits();
    let fraction = bits & 0x007f_ffff;
    // At a power of two the next smaller number is half as far away as the next greater one.
    if fraction == 0 {
        return None;
    }
    let binade = ((bits >> 23) & 0xff).wrapping_sub(LEAST) as usize;
    let Binade { unit, longer } = *BINADE.get(binade)?;
    let c = u64::from(fraction | 0x0080_0000);
    let number = c * unit;
    let integer = number >> POINT;
    // ⌊integer / 10⌋, exact for integers below 2²⁸.
    let tens = (integer * 0x1999_999a) >> 32;
    let over_ten = number - tens * (10 * ONE);
    // Twice how far away a decimal may be that is read back as this number: with the ends of the interval if it is even.
    let reach = unit - (c & 1);
    // At most one multiple of ten is inside; without one the nearer of two integers is.
    let (down, up) = (2 * over_ten <= reach, 20 * ONE - 2 * over_ten <= reach);
    let (coarse, fine) = (10 * (tens + u64::from(up)), (number + ONE / 2 - 1 + (integer & 1)) >> POINT);
    let significand = select_unpredictable(down | up, coarse, fine) as u32;
    let Layout { scale, whole, more, kept, put } =
        *LAYOUT.get(2 * binade + usize::from(significand >= longer))?;
    let nine = significand * scale;
    let eight = nine / 10;
    let last = nine - 10 * eight;
    let digits = eight_digits(eight);
    // Without zeros at the end; the first digit is none.
    let len = 8 - (digits | 1).leading_zeros() as usize / 8;
    let len = select_unpredictable(last == 0, len, 9);
    let digits = digits | ASCII_ZEROS;
    // Both are small, and masks tell the compiler that the room is large enough.
    let (whole, more) = (usize::from(whole & 7), usize::from(more & 7));
    room[0] = b'-';
    let sign = (bits >> 31) as usize;
    *piece(room, sign) = (digits & kept | put).to_le_bytes();
    *piece(room, sign + whole + more) = (digits >> (8 * whole)).to_le_bytes();
    room[sign + more + 8] = b'0' + last as u8;
    Some(sign + select_unpredictable(len > whole, len + more, whole))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The text, beside that of zmij, letter by letter, and that of the standard library, which rounds up where two of the
    /// shortest are equally near, and knows no exponents.
    fn compare(x: f32) {
        for x in [x, -x] {
            let mut room = [b'?'; FLOAT_ROOM];
            let len = float(x, &mut room);
            let text = std::str::from_utf8(&room[..len]).unwrap();
            let mut buffer = zmij::Buffer::new();
            let known = buffer.format_finite(x);
            assert_eq!(text, known.strip_suffix(".0").unwrap_or(known), "{:#x}", x.to_bits());
            assert_eq!(text.parse::<f32>().unwrap().to_bits(), x.to_bits());
            let other = x.to_string();
            if text != other && !text.contains('e') {
                let [ours, others] = [text, &other].map(|text| text.parse::<f64>().unwrap() - f64::from(x));
                assert!((ours + others).abs() < 1e-6 * ours.abs(), "{text} and {other}");
                assert_eq!((text.len(), text.parse()), (other.len(), Ok(x)));
            }
        }
    }

    #[test]
    fn floats_are_those_of_std() {
        // Next to powers of two and of ten, where intervals and the number of digits change.
        let tens = (-45..39).map(|e| format!("1e{e}").parse::<f32>().unwrap());
        let powers = (0..255_u32).map(|biased| f32::from_bits(biased << 23)).chain(tens);
        for bits in powers.flat_map(|x| x.to_bits().saturating_sub(100)..x.to_bits() + 100) {
            if f32::from_bits(bits).is_finite() {
                compare(f32::from_bits(bits));
            }
        }
        // All over the numbers that are formatted here, and over all.
        let (least, end) = ((1.0_f32 / 8192.0).to_bits(), 8_388_608_f32.to_bits());
        (0..300_000_u32).map(|i| i.wrapping_mul(2_654_435_761)).for_each(|random| {
            compare(f32::from_bits(least + ((u64::from(random) * u64::from(end - least)) >> 32) as u32));
            let any = f32::from_bits(random);
            if any.is_finite() {
                compare(any);
            }
        });
        // Few digits, halves and quarters, whole numbers.
        (1..30_000_u16).map(f32::from).for_each(|n| {
            [n, n / 4.0, n / 10.0, n / 1000.0, n * 128.0, n * 250.0].into_iter().for_each(compare);
        });
        [0.0, f32::MAX, f32::MIN_POSITIVE, f32::from_bits(1)].into_iter().for_each(compare);
    }

    #[test]
    fn no_power_of_two_and_nothing_tiny_or_huge_is_taken() {
        let mut room = [0; FLOAT_ROOM];
        for binade in 0..256_u32 {
            let [power, next] =
                [0, 1].map(|fraction| shortest(f32::from_bits(binade << 23 | fraction), &mut room));
            assert!(power.is_none());
            assert_eq!(next.is_some(), (127 - 13..127 + 23).contains(&binade));
        }
    }

    #[test]
    fn integers_are_those_of_std() {
        let powers = (0..10).flat_map(|e| [10u32.pow(e) - 1, 10u32.pow(e), 10u32.pow(e) + 1]);
        let spread = (0..200_000u32).map(|i| i.wrapping_mul(2_654_435_761) >> (i % 32));
        for n in (0..=10_100).chain(powers).chain(spread).chain([99_999_999, u32::MAX]) {
            let Digits { text, len } = Digits::of(n);
            assert_eq!(&text[..len], n.to_string().as_bytes());
        }
    }
}
