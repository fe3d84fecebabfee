//! The sRGB curve (IEC 61966-2-1): code values, which files and screens have, and linear light, which
//! shading and means are made in. Both run from 0 to 1.
//!
//! Two formulas by `libm`: the crate palette takes the platform's power, whose bits differ between machines.

use std::sync::LazyLock;

/// From code value to linear light.
pub fn decode(c: f32) -> f32 {
    if c <= 0.040_45 { c / 12.92 } else { libm::powf((c + 0.055) / 1.055, 2.4) }
}

/// From linear light to code value.
pub fn encode(c: f32) -> f32 {
    if c <= 0.003_130_8 { c * 12.92 } else { 1.055 * libm::powf(c, 1.0 / 2.4) - 0.055 }
}

/// From linear light to a code value of 8 bits, the nearest: what `encode(light) * 255 + 0.5` is cut off to, many times
/// faster. Light beyond 0 to 1 is clamped.
pub fn code(light: f32) -> u8 {
    // The negation takes NaN as black.
    if !(light > 0.0) {
        return 0;
    }
    let curve = &*CURVE;
    let light = light.min(1.0);
    let mut code = curve.first[step_of(light)];
    while curve.least.get(usize::from(code)).is_some_and(|&least| light >= least) {
        code += 1;
    }
    code
}

/// What [`code`] looks codes up in.
struct Curve {
    /// The least light of code 1, 2 …
    least: [f32; 255],
    /// By [`step_of`]: the code of the least light that has it.
    first: Vec<u8>,
}

/// Bits of a float that do not count for where its code is looked for: 64 steps to each doubling of the light.
const FINER: u32 = f32::MANTISSA_DIGITS - 1 - 6;
/// Below it everything has code 0.
const DARKEST: f32 = 1.0 / 8192.0;

fn step_of(light: f32) -> usize {
    (light.max(DARKEST).to_bits() - DARKEST.to_bits()) as usize >> FINER
}

static CURVE: LazyLock<Curve> = LazyLock::new(|| {
    let by_formula = |light: f32| (encode(light) * 255.0 + 0.5) as u8;
    // Positive floats are in the order of their bits.
    let least = std::array::from_fn(|i| {
        let (mut below, mut above) = (0_u32, 1.0_f32.to_bits());
        while above - below > 1 {
            let middle = below.midpoint(above);
            if usize::from(by_formula(f32::from_bits(middle))) > i { above = middle } else { below = middle }
        }
        f32::from_bits(above)
    });
    let steps = 0..=step_of(1.0);
    let first = steps.map(|step| by_formula(f32::from_bits(DARKEST.to_bits() + ((step as u32) << FINER))));
    Curve { least, first: first.collect() }
});

/// Linear light of an sRGB colour.
pub fn linear(srgb: [u8; 3]) -> [f32; 3] {
    static LIGHT: LazyLock<[f32; 256]> =
        LazyLock::new(|| std::array::from_fn(|code| decode(code as f32 / 255.0)));
    srgb.map(|c| LIGHT[usize::from(c)])
}

/// Relative luminance of linear light (ITU-R BT.709, whose primaries sRGB has).
pub fn luminance([r, g, b]: [f32; 3]) -> f32 {
    0.2126 * r + 0.7152 * g + 0.0722 * b
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn curves_are_inverse() {
        for c in 0..=255_u8 {
            let back = encode(decode(f32::from(c) / 255.0)) * 255.0;
            assert!((back - f32::from(c)).abs() < 0.01, "{c} {back}");
        }
    }

    #[test]
    fn codes_are_those_of_the_formula() {
        let by_formula = |light: f32| (encode(light) * 255.0 + 0.5) as u8;
        // Everywhere, and on both sides of where each code begins.
        let mut checked = 0;
        for bits in (1.0e-6_f32.to_bits()..=1.0_f32.to_bits()).step_by(97) {
            let light = f32::from_bits(bits);
            assert_eq!(code(light), by_formula(light), "{light}");
            checked += 1;
        }
        for least in CURVE.least {
            for bits in least.to_bits() - 2..=least.to_bits() + 2 {
                let light = f32::from_bits(bits).min(1.0);
                assert_eq!(code(light), by_formula(light), "{light}");
            }
        }
        assert!(checked > 1_000_000, "{checked}");
        assert_eq!([f32::NAN, -1.0, 0.0, 1.0, 7.0, f32::INFINITY].map(code), [0, 0, 0, 255, 255, 255]);
    }

    #[test]
    fn middle_grey_is_a_fifth_of_the_light() {
        // Code value 128 has 21.586 % of the light of white.
        assert!((linear([128; 3])[0] - 0.215_860_5).abs() < 1e-6);
    }
}
