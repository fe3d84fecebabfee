//! Numbers as decimal text: integers, and single-precision floats by their shortest digits.
//!
//! Both have their digits side by side in one register, and are stored in pieces of a length that the compiler knows.

/// Bytes that [`shortest`] may touch: a sign, seven digits, a point and a register of sixteen, rounded up.
pub(super) const FLOAT_ROOM: usize = 32;

const EIGHT: u32 = 100_000_000;
const ASCII_ZEROS: u64 = 0x3030_3030_3030_3030;
const WIDE_ASCII_ZEROS: u128 = (ASCII_ZEROS as u128) << 64 | ASCII_ZEROS as u128;

/// Powers of ten.
const POWERS: [u64; 16] = {
    let mut powers = [1; 16];
    let mut i = 1;
    while i < 16 {
        powers[i] = 10 * powers[i - 1];
        i += 1;
    }
    powers
};

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
        let low = eight_digits(n % EIGHT);
        let mut text = [0; 16];
        if n < EIGHT {
            // The first digit is in the lowest byte, so zeros to be dropped are trailing ones.
            let zeros = low.trailing_zeros().min(56) / 8;
            text[..8].copy_from_slice(&((low >> (8 * zeros)) | ASCII_ZEROS).to_le_bytes());
            return Self { text, len: 8 - zeros as usize };
        }
        let high = n / EIGHT;
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
        room[at..at + 16].copy_from_slice(&self.text);
        at + self.len
    }
}

/// The eight decimal digits of a number below 10⁸, one per byte, the first in the lowest: halves, then
/// quarters, then digits are divided side by side in one register. The multiplications are divisions
/// by 100 and 10, exact for numbers below 10⁴ and 10².
#[inline]
fn eight_digits(n: u32) -> u64 {
    let halves = u64::from(n / 10_000) | u64::from(n % 10_000) << 32;
    let hundreds = (halves * 10_486) >> 20 & 0x0000_007f_0000_007f;
    let quarters = hundreds | (halves - hundreds * 100) << 16;
    let tens = (quarters * 103) >> 10 & 0x000f_000f_000f_000f;
    tens | (quarters - tens * 10) << 8
}

/// Writes the shortest decimals that read back as `x`, the nearest of them, whole numbers without a point, and gives their
/// length; `None` for what is neither zero nor of a magnitude from 2⁻¹³ to 10⁷.
#[inline]
pub(super) fn shortest(x: f32, room: &mut [u8; FLOAT_ROOM]) -> Option<usize> {
    const LEAST: u32 = (127 - 13) << 23;
    const END: u32 = 10_000_000_f32.to_bits();
    let bits = x.to_bits() & (u32::MAX >> 1);
    room[0] = b'-';
    let sign = usize::from(x.is_sign_negative());
    if bits == 0 {
        room[sign] = b'0';
        return Some(sign + 1);
    }
    if !(LEAST..END).contains(&bits) {
        return None;
    }
    let (significand, exponent) = decimal(bits);
    // Nine digits with zeros behind: the first, and eight in a register.
    let (has_eight, has_nine) = (significand >= EIGHT / 10, significand >= EIGHT);
    let digits = 7 + i32::from(has_eight) + i32::from(has_nine);
    let nine = significand
        * if has_nine {
            1
        } else if has_eight {
            10
        } else {
            100
        };
    let rest = eight_digits(nine % EIGHT);
    let len = 9 - rest.leading_zeros() as usize / 8;
    // Digits before the point: 7 at most, −3 at least (four decimals of zeros would be below 2⁻¹³).
    let whole = digits + exponent;
    // Without branches, which no processor can foresee here: zeros in front where the first digit is behind the point.
    let zeros = (1 - whole).max(0) & 7;
    let whole = (whole.max(1) & 7) as usize;
    let text = (u128::from(nine / EIGHT) | u128::from(rest) << 8) << (8 * zeros) | WIDE_ASCII_ZEROS;
    let len = len + zeros as usize;
    room[sign..sign + 16].copy_from_slice(&text.to_le_bytes());
    room[sign + whole] = if len > whole { b'.' } else { b'0' };
    room[sign + whole + 1..sign + whole + 17].copy_from_slice(&(text >> (8 * whole)).to_le_bytes());
    Some(sign + if len > whole { len + 1 } else { whole })
}

/// The shortest decimals of the magnitude with these bits, as an integer of seven to nine digits with zeros behind, and its
/// exponent: by Schubfach (Raffaello Giulietti, The Schubfach way to render doubles, 2021). From 2⁻¹³ to 2²⁴ it is exact in
/// 64 bits: a number is c / 2^shift, and c · 10¹¹ < 2⁶¹.
#[inline]
fn decimal(bits: u32) -> (u32, i32) {
    let fraction = bits & 0x007f_ffff;
    let c = fraction | 0x0080_0000;
    let shift = 150 - (bits >> 23) as i32;
    // At a power of two the next smaller number is half as far away as the next greater one.
    let closer = fraction == 0;
    // ⌊log₁₀ 2^−shift⌋, of ¾ of that where it is closer: the distance of two numbers is 1 to 10 units of this exponent.
    let exponent = (-shift * 1_262_611 - if closer { 524_031 } else { 0 }) >> 22;
    let power = POWERS[(-exponent & 15) as usize];
    // In parts of a unit: the number, and twice how far below and above it is read back as itself (with the ends of the
    // interval if it is even).
    let (unit, number) = (1 << shift, u64::from(c) * power);
    let odd = u64::from(c & 1);
    let (below, above) = ((power >> u32::from(closer)) - odd, power - odd);
    let whole = number >> shift;
    let tens = whole / 10;
    let over_ten = 2 * (number - ((10 * tens) << shift));
    let over_one = 2 * (number - (whole << shift));
    // At most one multiple of ten is inside. Without one it is the nearer of two integers, which is outside only where the
    // smaller numbers are closer.
    let (down, up) = (over_ten <= below, 20 * unit - over_ten <= above);
    let nearer = over_one > (unit - (whole & 1)).min(below);
    // Both are there, so that one is taken without a branch.
    let (coarse, fine) = (10 * (tens + u64::from(up)), whole + u64::from(nearer));
    (if down | up { coarse } else { fine } as u32, exponent)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 2⁻¹³.
    const LEAST_F32: f32 = 1.0 / 8192.0;

    /// The text, beside that of zmij, letter by letter, and that of the standard library, which rounds up where two of the
    /// shortest are equally near.
    fn compare(x: f32) {
        for x in [x, -x] {
            let mut room = [b'?'; FLOAT_ROOM];
            let len = shortest(x, &mut room).unwrap();
            let text = std::str::from_utf8(&room[..len]).unwrap();
            let mut buffer = zmij::Buffer::new();
            let known = buffer.format_finite(x);
            assert_eq!(text, known.strip_suffix(".0").unwrap_or(known), "{:#x}", x.to_bits());
            let other = x.to_string();
            if text != other {
                let [ours, others] = [text, &other].map(|text| text.parse::<f64>().unwrap() - f64::from(x));
                assert!((ours + others).abs() < 1e-6 * ours.abs(), "{text} and {other}");
                assert_eq!((text.len(), text.parse()), (other.len(), Ok(x)));
            }
        }
    }

    #[test]
    fn floats_are_those_of_std() {
        let (least, end) = (LEAST_F32.to_bits(), 1e7_f32.to_bits());
        // Next to powers of two and of ten, where intervals and the number of digits change.
        let tens = [1e-3_f32, 0.01, 0.1, 1.0, 10.0, 100.0, 1e3, 1e4, 1e5, 1e6];
        let powers = (114..151_u32).map(|biased| f32::from_bits(biased << 23)).chain(tens);
        for bits in powers.flat_map(|x| x.to_bits() - 100..x.to_bits() + 100) {
            if (least..end).contains(&bits) {
                compare(f32::from_bits(bits));
            }
        }
        (0..300_000_u32).for_each(|i| {
            compare(f32::from_bits(
                least + ((u64::from(i.wrapping_mul(2_654_435_761)) * u64::from(end - least)) >> 32) as u32,
            ));
        });
        // Few digits, halves and quarters, whole numbers.
        (1..30_000_u16).map(f32::from).for_each(|n| {
            [n, n / 4.0, n / 10.0, n / 1000.0, n * 128.0, n * 250.0]
                .into_iter()
                .filter(|&x| x < 1e7)
                .for_each(compare);
        });
        compare(0.0);
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

    #[test]
    fn what_is_tiny_or_huge_is_left_to_others() {
        for x in [1e-5, LEAST_F32.next_down(), 1e7, f32::MAX, f32::INFINITY, f32::NAN, f32::MIN_POSITIVE] {
            assert!(shortest(x, &mut [0; FLOAT_ROOM]).is_none());
            assert!(shortest(-x, &mut [0; FLOAT_ROOM]).is_none());
        }
    }
}
