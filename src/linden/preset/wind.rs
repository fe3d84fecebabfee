//! `[wind]`: how it moves.

use super::knobs::{PresetKnob, real, row};
use super::setting::Setting;
use crate::knob::{Kind, Value};
use crate::wind::{Blow, Wind};

/// Whether the tree carries wind, and how it blows.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct WindLook {
    /// What the files are to hold.
    pub wind: Wind,
    /// How it blows.
    pub blow: Blow,
}

/// The names of [`Wind`].
const WINDS: [&str; Wind::ALL.len()] = {
    let mut names = [""; Wind::ALL.len()];
    let mut i = 0;
    while i < names.len() {
        names[i] = Wind::ALL[i].0;
        i += 1;
    }
    names
};

impl Setting for Wind {
    fn to_value(&self) -> Value {
        let name = Self::ALL.iter().find(|(_, wind)| wind == self).map_or("", |(name, _)| name);
        Value::Word(name.to_owned())
    }

    fn from_value(value: Value) -> Option<Self> {
        let word = String::from_value(value)?;
        Self::ALL.into_iter().find(|(name, _)| *name == word).map(|(_, wind)| wind)
    }
}

/// The section's knobs.
pub(super) const KNOBS: &[PresetKnob] = &[
    row!(Wind, "wind", Kind::Choice(&WINDS), "", "in exports: attributes at the vertices for shaders, or these and a sway loop that viewers play (glTF, USD)", .wind.wind),
    row!(Wind, "wind_strength", real(0.0, 1.0), "", "how far everything swings: 0 calm, 1 storm", .wind.blow.strength),
    row!(Wind, "wind_frequency", real(0.05, 1.0), "Hz", "how often stems swing; branches and leaves are faster", .wind.blow.frequency_hz),
    row!(Wind, "wind_direction", real(-360.0, 360.0), "deg", "where it blows to: from +X, counter-clockwise seen from above", .wind.blow.direction_deg),
    row!(Wind, "gustiness", real(0.0, 1.0), "", "how much gusts come and go within the loop", .wind.blow.gustiness),
];
