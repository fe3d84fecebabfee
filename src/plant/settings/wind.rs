//! `[wind]`: how it moves.

use linden_base::field;
use linden_base::knob::{Field, Kind, real};

use crate::wind::{Blow, Wind};

/// Whether the tree carries wind, and how it blows.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct WindSettings {
    /// What the files are to hold.
    pub wind: Wind,
    /// How it blows.
    pub blow: Blow,
}

impl WindSettings {
    /// Its knobs.
    pub const FIELDS: &[Field<Self>] = &[
        field!(
            "wind",
            Kind::Choice(Wind::WORDS),
            "",
            "in exports: attributes at the vertices for shaders, or these and a sway loop that viewers play (glTF, USD)",
            wind
        ),
        field!(
            "wind_strength",
            real(0.0, 1.0),
            "",
            "how far everything swings: 0 calm, 1 storm",
            blow.strength
        ),
        field!(
            "wind_frequency",
            real(0.05, 1.0),
            "Hz",
            "how often stems swing; branches and leaves are faster",
            blow.frequency_hz
        ),
        field!(
            "wind_direction",
            real(-360.0, 360.0),
            "deg",
            "where it blows to: from +X, counter-clockwise seen from above",
            blow.direction_deg
        ),
        field!("gustiness", real(0.0, 1.0), "", "how much gusts come and go within the loop", blow.gustiness),
    ];
}
