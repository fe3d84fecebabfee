//! Pictures of half floats as `OpenEXR`: scan lines as they are, which every reader of the format reads.
//!
//! After "`OpenEXR` File Layout" (Academy Software Foundation): a header of attributes, where each line begins, and the
//! lines, channel by channel. Written here because the whole of it is shorter than what a crate for it would bring.

use half::f16;

/// A number as the nearest half (IEEE 754 binary16), of two equally near the even one; what is too large as the largest.
pub(crate) fn half(x: f32) -> u16 {
    f16::from_f32(x).clamp(f16::MIN, f16::MAX).to_bits()
}

/// A picture of halfs as bits, red, green, blue and alpha; rows from the top.
pub(crate) fn encode(width: u32, height: u32, pixels: &[[u16; 4]]) -> Vec<u8> {
    let mut file = Vec::with_capacity(400 + 8 * pixels.len() + 16 * height as usize);
    // The magic number, and version 2: one part of scan lines, short names.
    file.extend([0x76, 0x2f, 0x31, 0x01, 2, 0, 0, 0]);
    let mut attribute = |name: &str, kind: &str, value: &[u8]| {
        file.extend(name.bytes().chain([0]).chain(kind.bytes()).chain([0]));
        file.extend((value.len() as u32).to_le_bytes());
        file.extend(value);
    };
    // Channels in the order of their names: a half each, linear, one sample a pixel.
    let channel = |name: u8| {
        let numbers = [1_u32, 0, 1, 1];
        [name, 0].into_iter().chain(numbers.into_iter().flat_map(u32::to_le_bytes))
    };
    let channels: Vec<u8> = b"ABGR".iter().copied().flat_map(channel).chain([0]).collect();
    let window = [0, 0, width.saturating_sub(1), height.saturating_sub(1)].map(u32::to_le_bytes);
    attribute("channels", "chlist", &channels);
    attribute("compression", "compression", &[0]);
    attribute("dataWindow", "box2i", window.as_flattened());
    attribute("displayWindow", "box2i", window.as_flattened());
    attribute("lineOrder", "lineOrder", &[0]);
    attribute("pixelAspectRatio", "float", &1.0_f32.to_le_bytes());
    attribute("screenWindowCenter", "v2f", &[0; 8]);
    attribute("screenWindowWidth", "float", &1.0_f32.to_le_bytes());
    file.push(0);
    let line = 8 * u64::from(width);
    let first = file.len() as u64 + 8 * u64::from(height);
    file.extend((0..u64::from(height)).flat_map(|y| (first + y * (8 + line)).to_le_bytes()));
    for (y, row) in (0_u32..).zip(pixels.chunks_exact((width as usize).max(1))) {
        file.extend(y.to_le_bytes());
        file.extend((line as u32).to_le_bytes());
        for channel in [3, 2, 1, 0] {
            file.extend(row.iter().flat_map(|pixel| pixel[channel].to_le_bytes()));
        }
    }
    file
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What a half means, by its definition.
    fn meant(bits: u16) -> f64 {
        let (exponent, fraction) = (i32::from(bits >> 10 & 31), f64::from(bits & 1023));
        let size = match exponent {
            0 => libm::ldexp(fraction, -24),
            _ => libm::ldexp(1.0 + fraction / 1024.0, exponent - 15),
        };
        if bits & 0x8000 == 0 { size } else { -size }
    }

    #[test]
    fn halfs_are_the_nearest_ones() {
        for bits in (0..0x7c00).chain(0x8000..0xfc00) {
            assert_eq!(half(meant(bits) as f32), bits);
        }
        // Between two: the nearer one, and of two equally near the even one.
        for low in 0..0x7bff_u16 {
            let (a, b) = (meant(low), meant(low + 1));
            let even = low + (low & 1);
            for (share, expected) in [(0.49, low), (0.5, even), (0.51, low + 1)] {
                let x = (a + (b - a) * share) as f32;
                assert_eq!((half(x), half(-x)), (expected, 0x8000 | expected), "{a} to {b}");
            }
        }
        assert_eq!((half(1e9), half(-1e9), half(65519.0)), (0x7bff, 0xfbff, 0x7bff));
    }
}
