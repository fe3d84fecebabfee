//! `[surface]`: how the skin is made.

use linden_base::field;
use linden_base::knob::{Field, Kind, integer, real, real_or_auto};

use crate::surface::{Ends, Junction, Tubes};

impl Tubes {
    /// Its knobs.
    pub const FIELDS: &[Field<Self>] = &[
        field!(
            "sides",
            integer(3, 128),
            "",
            "sides of the thickest wood; thinner wood has fewer, down to 3",
            sides
        ),
        field!(
            "rings",
            integer(1, 32),
            "",
            "rings per segment: more follow a smooth curve through the nodes",
            rings
        ),
        field!(
            "bark_tile",
            real(0.01, 100.0),
            "m",
            "edge of the square of bark that one picture covers",
            bark_tile_m
        ),
        field!(
            "junction",
            Kind::Choice(Junction::WORDS),
            "",
            "how branches meet: tubes that overlap, the same with collars, or one closed solid for printing and simulation (slow)",
            junction
        ),
        field!(
            "junction_detail",
            integer(4, 512),
            "",
            "for junction=watertight: cells across the thickest wood; twigs thinner than two cells are made as thick",
            junction_detail
        ),
        field!(
            "flare",
            real(0.0, 4.0),
            "",
            "how much wider the foot of a stem is than its trunk, as a share of the radius",
            features.flare
        ),
        field!(
            "flare_height",
            real_or_auto(0.0, 100.0),
            "m",
            "how high the flare reaches; auto: 5 radii of the foot",
            features.flare_height_m
        ),
        field!(
            "flare_ridges",
            integer(0, 16),
            "",
            "buttresses round a flared foot; 0: it is round",
            features.flare_ridges
        ),
        field!(
            "flare_depth",
            real(0.0, 1.0),
            "",
            "how much of the flare is buttresses",
            features.flare_depth
        ),
        field!(
            "collar",
            real(0.0, 1.0),
            "",
            "how far wood swells round the foot of a branch: radius of the fillet / radius of the wood that it leaves",
            features.collar
        ),
        field!(
            "twig_taper",
            real(0.0, 1.0),
            "",
            "how much thinner a twig gets between its last fork and its bud",
            features.twig_taper
        ),
        field!(
            "ends",
            Kind::Choice(Ends::WORDS),
            "",
            "how branches end: in a bud, sawn off, or snapped",
            features.ends
        ),
        field!(
            "ends_above",
            real(0.0, 100.0),
            "m",
            "thinner ends are buds whatever ends says",
            features.ends_above_m
        ),
    ];
}
