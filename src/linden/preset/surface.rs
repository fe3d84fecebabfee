//! `[surface]`: how the skin is made.

use super::knobs::{PresetKnob, integer, real, row};

/// The section's knobs.
pub(super) const KNOBS: &[PresetKnob] = &[
    row!(Surface, "sides", integer(3, 128), "", "sides of the thickest wood; thinner wood has fewer, down to 3", .tubes.sides),
    row!(Surface, "rings", integer(1, 32), "", "rings per segment: more follow a smooth curve through the nodes", .tubes.rings),
    row!(Surface, "bark_tile", real(0.01, 100.0), "m", "edge of the square of bark that one picture covers", .tubes.bark_tile_m),
];
