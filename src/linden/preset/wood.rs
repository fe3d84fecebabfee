//! `[wood]`: how thick it is.

use super::knobs::{PresetKnob, real, real_or_auto, row};

/// The section's knobs.
pub(super) const KNOBS: &[PresetKnob] = &[
    row!(Wood, "radius_exponent", real(1.0, 10.0), "", "n of the pipe model r^n = sum of children's r^n: larger is a thinner trunk", .wood.radius_exponent),
    row!(Wood, "tip_radius", real_or_auto(1e-5, 10.0), "m", "radius of the thinnest twigs; auto: follows from the base", .wood.tip_radius_m),
    row!(Wood, "base_radius", real_or_auto(1e-5, 100.0), "m", "radius at the foot; auto: follows from the tips, or is 1/60 of the height", .wood.base_radius_m),
];
