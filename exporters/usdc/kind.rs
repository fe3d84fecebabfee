//! Types of values, by their names in text and their numbers in crate files.

use super::literal::Literal;

/// What numbers a value is of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Scalar {
    Bool,
    Int,
    UInt64,
    Half,
    Float,
    Double,
    String,
    Token,
    Asset,
}

/// A type.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Kind {
    /// Its number (`crateDataTypes.h` of OpenUSD).
    pub number: u8,
    pub scalar: Scalar,
    /// Numbers of a value.
    pub numbers: usize,
    /// Whether the first number stands last: text has the real part of a quaternion first.
    pub is_turn: bool,
}

/// Types that layers here have.
#[rustfmt::skip] // a line for each
const KINDS: &[(&[&str], u8, Scalar, usize)] = &[
    (&["bool"], 1, Scalar::Bool, 1),
    (&["int"], 3, Scalar::Int, 1),
    (&["uint64"], 6, Scalar::UInt64, 1),
    (&["half"], 7, Scalar::Half, 1),
    (&["float"], 8, Scalar::Float, 1),
    (&["double"], 9, Scalar::Double, 1),
    (&["string"], 10, Scalar::String, 1),
    (&["token"], 11, Scalar::Token, 1),
    (&["asset"], 12, Scalar::Asset, 1),
    (&["matrix4d"], 15, Scalar::Double, 16),
    (&["quatf"], 17, Scalar::Float, 4),
    (&["quath"], 18, Scalar::Half, 4),
    (&["float2", "texCoord2f"], 20, Scalar::Float, 2),
    (&["double3"], 23, Scalar::Double, 3),
    (&["float3", "point3f", "normal3f", "vector3f", "color3f"], 24, Scalar::Float, 3),
    (&["half3"], 25, Scalar::Half, 3),
    (&["float4", "color4f"], 28, Scalar::Float, 4),
];

impl Kind {
    pub fn of(name: &str) -> Option<Self> {
        let (names, number, scalar, numbers) = KINDS.iter().find(|(names, ..)| names.contains(&name))?;
        let is_turn = names[0].starts_with("quat");
        Some(Self { number: *number, scalar: *scalar, numbers: *numbers, is_turn })
    }

    /// Appends the bytes of a value of numbers.
    pub fn push(self, bytes: &mut Vec<u8>, value: &Literal<'_>) -> Option<()> {
        let mut words = Vec::with_capacity(self.numbers);
        flatten(value, &mut words)?;
        if words.len() != self.numbers {
            return None;
        }
        if self.is_turn {
            words.rotate_left(1);
        }
        for word in words {
            match self.scalar {
                Scalar::Bool => bytes.push(u8::from(matches!(word, "1" | "true"))),
                Scalar::Int => bytes.extend(word.parse::<i32>().ok()?.to_le_bytes()),
                Scalar::UInt64 => bytes.extend(word.parse::<u64>().ok()?.to_le_bytes()),
                Scalar::Half => bytes.extend(half(word.parse().ok()?).to_le_bytes()),
                Scalar::Float => bytes.extend(word.parse::<f32>().ok()?.to_le_bytes()),
                Scalar::Double => bytes.extend(word.parse::<f64>().ok()?.to_le_bytes()),
                Scalar::String | Scalar::Token | Scalar::Asset => return None,
            }
        }
        Some(())
    }
}

fn flatten<'t>(value: &Literal<'t>, words: &mut Vec<&'t str>) -> Option<()> {
    match value {
        Literal::Word(word) => words.push(word),
        Literal::Tuple(values) => return values.iter().try_for_each(|value| flatten(value, words)),
        _ => return None,
    }
    Some(())
}

/// A float in 16 bits (IEEE 754 binary16), the nearest, of two the even one.
pub(super) fn half(x: f32) -> u16 {
    half::f16::from_f32(x).to_bits()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What a half means, by its definition.
    fn float(half: u16) -> f32 {
        let sign = if half >> 15 == 1 { -1.0 } else { 1.0 };
        let (exponent, mantissa) = (i32::from((half >> 10) & 31), f32::from(half & 1023) / 1024.0);
        match exponent {
            0 => sign * mantissa * libm::exp2f(-14.0),
            _ => sign * (1.0 + mantissa) * libm::exp2f((exponent - 15) as f32),
        }
    }

    #[test]
    fn halves_are_the_nearest() {
        for bits in 0..0x7c00_u16 {
            assert_eq!(half(float(bits)), bits);
            if bits + 1 == 0x7c00 {
                break;
            }
            let (here, next) = (float(bits), float(bits + 1));
            let middle = f32::midpoint(here, next);
            assert_eq!(half(middle), bits + (bits & 1), "of two the even one");
            assert_eq!(half(middle.next_down()), bits);
            assert_eq!(half(-middle.next_up()), 0x8000 | (bits + 1));
        }
        assert_eq!([half(1e9), half(f32::NEG_INFINITY)], [0x7c00, 0xfc00]);
    }
}
