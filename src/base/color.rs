//! The sRGB curve (IEC 61966-2-1): code values, which files and screens have, and linear light, which
//! shading and means are made in. Both run from 0 to 1.
//!
//! Two formulas by `libm`: the crate palette takes the platform's power, whose bits differ between machines.

/// From code value to linear light.
pub fn decode(c: f32) -> f32 {
    if c <= 0.040_45 { c / 12.92 } else { libm::powf((c + 0.055) / 1.055, 2.4) }
}

/// From linear light to code value.
pub fn encode(c: f32) -> f32 {
    if c <= 0.003_130_8 { c * 12.92 } else { 1.055 * libm::powf(c, 1.0 / 2.4) - 0.055 }
}

/// Linear light of an sRGB colour.
pub fn linear(srgb: [u8; 3]) -> [f32; 3] {
    srgb.map(|c| decode(f32::from(c) / 255.0))
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
    fn middle_grey_is_a_fifth_of_the_light() {
        // Code value 128 has 21.586 % of the light of white.
        assert!((linear([128; 3])[0] - 0.215_860_5).abs() < 1e-6);
    }
}
