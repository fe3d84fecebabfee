//! The light that leaves take from each other.

use glam::Vec3;

/// How much light is left of what falls on a piece of a tree, or on all of it, where it is seen, by colour: what it is drawn on
/// is flat, and what leaves within the piece take from each other is drawn with it.
///
/// Leaves that lie at random are `τ / (1 − exp(−τ))` layers where there are any, at an optical thickness of τ. A look
/// reaches down to a depth t with `exp(−t)`; light, of which leaves scatter a share ω (`color`) on, with `exp(−κt)`, κ =
/// √(1 − ω) (Goudriaan 1977, *Crop Micrometeorology*). What is seen has `∫exp(−(1 + κ)t)dt / ∫exp(−t)dt` of the light.
pub(in crate::detail) fn light_within(layers: f32, color: Vec3) -> Vec3 {
    /// Newton's rounds: each about doubles the digits, and a guess is near.
    const ROUNDS: u32 = 6;
    // For many layers they are the thickness, for few twice what they are more than one.
    let mut depth = (2.0 * (layers - 1.0)).min(layers);
    for _ in 0..ROUNDS {
        if depth < 1e-3 {
            return Vec3::ONE;
        }
        let through = libm::expf(-depth);
        let covered = 1.0 - through;
        let slope = (covered - depth * through) / (covered * covered);
        depth -= (depth / covered - layers) / slope;
    }
    let left = color.to_array().map(|scattered| {
        let reach = 1.0 + (1.0 - scattered.clamp(0.0, 1.0)).sqrt();
        (1.0 - libm::expf(-reach * depth)) / (reach * (1.0 - libm::expf(-depth)))
    });
    Vec3::from(left)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn light_within_a_piece_is_what_falls_through_it_to_what_is_seen() {
        assert_eq!(light_within(1.0, Vec3::splat(0.5)), Vec3::ONE);
        let color = Vec3::new(0.0, 0.2, 0.9);
        for depth in [0.05, 0.3, 1.0, 2.0, 5.0, 12.0_f64] {
            let layers = depth / (1.0 - libm::exp(-depth));
            let found = light_within(layers as f32, color);
            for (found, scattered) in found.to_array().into_iter().zip(color.to_array()) {
                // Leaves in thin slices, each hiding what lies below from looks and, less, from light.
                let slices = 50_000;
                let reach = (1.0 - f64::from(scattered)).sqrt();
                let (mut seen, mut lit) = (0.0, 0.0);
                for i in 0..slices {
                    let t = depth * (f64::from(i) + 0.5) / f64::from(slices);
                    seen += libm::exp(-t);
                    lit += libm::exp(-t) * libm::exp(-reach * t);
                }
                let expected = lit / seen;
                assert!((f64::from(found) - expected).abs() < 1e-3, "{depth}: {found}, not {expected}");
            }
        }
    }
}
