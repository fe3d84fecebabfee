//! Radii that the generator gave, fitted to the ends that are asked for.

use rayon::prelude::*;

use super::{THINNEST_PER_BASE, Wood};

/// Scales radii so that the thickest is the base radius, where one is asked for, and makes nothing
/// thinner than the tip radius (a thousandth of the thickest where none is asked for).
pub(super) fn within(mut radii: Vec<f32>, wood: &Wood) -> Vec<f32> {
    let thickest = f64::from(radii.par_iter().copied().reduce(|| 0.0, f32::max));
    let base = wood.base_radius_m.unwrap_or(thickest);
    let thinnest = wood.tip_radius_m.unwrap_or(base * THINNEST_PER_BASE) as f32;
    // 1 exactly where nothing is asked for: then the radii keep their bits.
    let scale = base / thickest;
    radii.par_iter_mut().for_each(|radius| *radius = ((f64::from(*radius) * scale) as f32).max(thinnest));
    radii
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn given_radii_are_kept_scaled_and_bounded() {
        let wood = Wood::default();
        assert_eq!(within(vec![0.3, 0.2, 0.0, -1.0], &wood), [0.3, 0.2, 0.0003, 0.0003]);
        let scaled = Wood { base_radius_m: Some(0.6), tip_radius_m: Some(0.5), ..wood };
        assert_eq!(within(vec![0.3, 0.2], &scaled), [0.6, 0.5]);
    }
}
