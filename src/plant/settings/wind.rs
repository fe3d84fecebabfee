//! `[wind]`: how it moves.

use linden_base::field;
use linden_base::knob::{Field, Kind, integer, real};

use crate::wind::{Blow, BoneSettings, Wind};

/// Whether the tree carries wind, and how it blows.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct WindSettings {
    /// What the files are to hold.
    pub wind: Wind,
    /// How it blows.
    pub blow: Blow,
    /// Where joints are.
    pub bones: BoneSettings,
}

impl WindSettings {
    /// Its knobs.
    pub const FIELDS: &[Field<Self>] = &[
        field!(
            "wind",
            Kind::Choice(Wind::WORDS),
            "",
            "in exports: attributes at the vertices for shaders, these and a sway loop that viewers play, or that loop by joints (glTF, USD)",
            wind,
            details(
                "attributes are level, phase, sway and flutter of each vertex with the pivot of its branch \
                 or leaf; sway adds morph targets with a loop that repeats; bones has joints along stems and branches \
                 that turn in the same loop, in a fraction of the bytes: leaves go with their twig and do not \
                 flutter. Stems bend as a whole, branches \
                 swing where they leave their parent, leaves flutter, and the foot stands still. The \
                 workbench shows wind whatever this says. A watertight solid cannot be moved."
            ),
            see_also(&[
                "bones",
                "wind_strength",
                "wind_frequency",
                "wind_direction",
                "gustiness",
                "junction"
            ])
        ),
        field!(
            "bones",
            integer(2, 1024),
            "",
            "the most joints of wind=bones: they go where most of the wood swings",
            bones.most,
            details(
                "An axis has up to 6, evenly along it, and only where what bears it has some. Up to 256, vertices are \
                 bound in 8 bytes, beyond that in 12; many engines take no more than 256, phones far fewer."
            ),
            see_also(&["bone_order", "wind"])
        ),
        field!(
            "bone_order",
            integer(0, 8),
            "",
            "the deepest order of axes with joints of their own: 0 stems alone, 1 branches too",
            bones.order,
            details("Finer wood and leaves go with the joints of what bears them."),
            see_also(&["bones", "wind"])
        ),
        field!(
            "wind_strength",
            real(0.0, 1.0),
            "",
            "how far everything swings: 0 calm, 1 storm",
            blow.strength,
            details(
                "At 1 the top of a stem goes 5 % of its height to the side, tips of thin branches up to 22 \
                 % of their length and tips of leaves 35 %; at 0.4 two fifths of that, a fresh breeze."
            ),
            see_also(&["gustiness", "wind_frequency"])
        ),
        field!(
            "wind_frequency",
            real(0.05, 1.0),
            "Hz",
            "how often stems swing; branches and leaves are faster",
            blow.frequency_hz,
            details(
                "The loop is two swings of the stems, 6.7 s at 0.3 Hz, in which branches swing five times \
                 and leaves thirteen times. Tall trees are slow (0.2), saplings fast (0.8)."
            ),
            see_also(&["wind_strength", "gustiness"])
        ),
        field!(
            "wind_direction",
            real(-360.0, 360.0),
            "deg",
            "where it blows to: from +X, counter-clockwise seen from above",
            blow.direction_deg,
            see_also(&["wind_strength"])
        ),
        field!(
            "gustiness",
            real(0.0, 1.0),
            "",
            "how much gusts come and go within the loop",
            blow.gustiness,
            details(
                "0 swings evenly; at 1 one strong and some lesser gusts come in each loop, up to 60 % above \
                 the mean."
            ),
            see_also(&["wind_strength", "wind_frequency"])
        ),
    ];
}
