//! Round lengths for scale bars.

/// The longest round length (1, 2 or 5 times a power of ten, metres) that takes at most `max_px`
/// pixels, and how many it takes. `None` when nothing can be shown: no room, or no scale.
///
/// ```
/// use linden_raster::nice_length_m;
/// assert_eq!(nice_length_m(100.0, 30.0), Some((2.0, 60.0)));
/// ```
pub fn nice_length_m(max_px: f32, px_per_m: f32) -> Option<(f32, f32)> {
    let longest_m = f64::from(max_px) / f64::from(px_per_m);
    if !(longest_m.is_finite() && longest_m > 0.0 && px_per_m > 0.0) {
        return None;
    }
    let exponent = libm::floor(libm::log10(longest_m)) as i32;
    // One decade below and above: the logarithm of a power of ten may be off by a rounding.
    let steps = (exponent - 1..=exponent + 1).flat_map(|e| [1.0, 2.0, 5.0].map(|digit| digit * power(e)));
    let (length_m, _) = steps.map(|m| (m, m * f64::from(px_per_m))).rfind(|&(m, _)| m <= longest_m)?;
    Some((length_m as f32, (length_m * f64::from(px_per_m)) as f32))
}

fn power(exponent: i32) -> f64 {
    libm::exp10(f64::from(exponent))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_are_round_and_fit() {
        for i in 0..4000 {
            let px_per_m = libm::expf(i as f32 / 200.0 - 10.0);
            let (length_m, px) = nice_length_m(80.0, px_per_m).unwrap();
            // The next one is at most 2.5 times as long.
            assert!(px <= 80.001 && px > 80.0 / 2.501, "{px_per_m}: {length_m} m are {px} px");
            let text = format!("{length_m:e}");
            let digits = text.split('e').next().unwrap();
            assert!(["1", "2", "5"].contains(&digits), "{px_per_m}: {text}");
        }
    }

    #[test]
    fn what_fits_exactly_is_taken() {
        assert_eq!(nice_length_m(10.0, 10.0), Some((1.0, 10.0)));
        assert_eq!(nice_length_m(1000.0, 1.0), Some((1000.0, 1000.0)));
    }

    #[test]
    fn nonsense_has_no_length() {
        for (max_px, px_per_m) in
            [(0.0, 1.0), (1.0, 0.0), (f32::NAN, 1.0), (5.0, f32::INFINITY), (-1.0, 1.0), (-1.0, -1.0)]
        {
            assert_eq!(nice_length_m(max_px, px_per_m), None, "{max_px} {px_per_m}");
        }
    }
}
