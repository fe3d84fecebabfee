//! Knobs of `[wind]` that change nothing.

use linden_plant::wind::Wind;

use super::{Rule, when};

pub(super) static RULES: &[Rule] = &[
    Rule {
        knobs: &["bones", "bone_order"],
        why: |preset| when(preset.dressing.wind.wind != Wind::Bones, "it is for wind=bones"),
    },
    Rule {
        knobs: &["wind_strength", "wind_frequency", "wind_direction", "gustiness"],
        why: |preset| when(preset.dressing.wind.wind == Wind::Off, "wind is off"),
    },
    Rule {
        knobs: &["wind_strength", "wind_frequency", "gustiness"],
        why: |preset| {
            let is_still = preset.dressing.wind.wind == Wind::Attributes;
            when(is_still, "the attributes are the same in any wind: it is for wind=sway and wind=bones")
        },
    },
];
