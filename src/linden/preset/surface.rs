//! `[surface]`: how the skin is made.

use super::knobs::{PresetKnob, integer, real, real_or_auto, row};
use super::setting::Setting;
use crate::knob::{Kind, Value};
use crate::surface::{Ends, Junction};

/// The names of all ways to end.
const ENDS: [&str; Ends::ALL.len()] = {
    let mut names = [""; Ends::ALL.len()];
    let mut i = 0;
    while i < names.len() {
        names[i] = Ends::ALL[i].0;
        i += 1;
    }
    names
};

/// The names of all ways to meet.
const JUNCTIONS: [&str; Junction::ALL.len()] = {
    let mut names = [""; Junction::ALL.len()];
    let mut i = 0;
    while i < names.len() {
        names[i] = Junction::ALL[i].0;
        i += 1;
    }
    names
};

impl Setting for Junction {
    fn to_value(&self) -> Value {
        let name = Self::ALL.iter().find(|(_, junction)| junction == self).map_or("", |(name, _)| name);
        Value::Word(name.to_owned())
    }

    fn from_value(value: Value) -> Option<Self> {
        let word = String::from_value(value)?;
        Self::ALL.into_iter().find(|(name, _)| *name == word).map(|(_, junction)| junction)
    }
}

impl Setting for Ends {
    fn to_value(&self) -> Value {
        let name = Self::ALL.iter().find(|(_, ends)| ends == self).map_or("", |(name, _)| name);
        Value::Word(name.to_owned())
    }

    fn from_value(value: Value) -> Option<Self> {
        let word = String::from_value(value)?;
        Self::ALL.into_iter().find(|(name, _)| *name == word).map(|(_, ends)| ends)
    }
}

/// The section's knobs.
pub(super) const KNOBS: &[PresetKnob] = &[
    row!(Surface, "sides", integer(3, 128), "", "sides of the thickest wood; thinner wood has fewer, down to 3", .tubes.sides),
    row!(Surface, "rings", integer(1, 32), "", "rings per segment: more follow a smooth curve through the nodes", .tubes.rings),
    row!(Surface, "bark_tile", real(0.01, 100.0), "m", "edge of the square of bark that one picture covers", .tubes.bark_tile_m),
    row!(Surface, "junction", Kind::Choice(&JUNCTIONS), "", "how branches meet: tubes that overlap, the same with collars, or one closed solid for printing and simulation (slow)", .tubes.junction),
    row!(Surface, "junction_detail", integer(4, 512), "", "for junction=watertight: cells across the thickest wood; twigs thinner than two cells are made as thick", .tubes.junction_detail),
    row!(Surface, "flare", real(0.0, 4.0), "", "how much wider the foot of a stem is than its trunk, as a share of the radius", .tubes.features.flare),
    row!(Surface, "flare_height", real_or_auto(0.0, 100.0), "m", "how high the flare reaches; auto: 5 radii of the foot", .tubes.features.flare_height_m),
    row!(Surface, "flare_ridges", integer(0, 16), "", "buttresses round a flared foot; 0: it is round", .tubes.features.flare_ridges),
    row!(Surface, "flare_depth", real(0.0, 1.0), "", "how much of the flare is buttresses", .tubes.features.flare_depth),
    row!(Surface, "collar", real(0.0, 1.0), "", "how far wood swells round the foot of a branch: radius of the fillet / radius of the wood that it leaves", .tubes.features.collar),
    row!(Surface, "twig_taper", real(0.0, 1.0), "", "how much thinner a twig gets between its last fork and its bud", .tubes.features.twig_taper),
    row!(Surface, "ends", Kind::Choice(&ENDS), "", "how branches end: in a bud, sawn off, or snapped", .tubes.features.ends),
    row!(Surface, "ends_above", real(0.0, 100.0), "m", "thinner ends are buds whatever ends says", .tubes.features.ends_above_m),
];
