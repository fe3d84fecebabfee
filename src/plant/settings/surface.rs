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
            sides,
            details(
                "Thinner wood has as few as keep it equally near to round: with 24 on the trunk a limb of a \
                 quarter of its radius has about half as many, a twig 3. 8 to 12 serve a game, 48 a \
                 close-up of the trunk. To reach a number of triangles take triangles instead."
            ),
            see_also(&["rings", "triangles", "junction"])
        ),
        field!(
            "rings",
            integer(1, 32),
            "",
            "rings per segment: more follow a smooth curve through the nodes",
            rings,
            details(
                "1 puts rings at nodes alone, and limbs have a corner at each. 2 to 4 bend smoothly and \
                 multiply the triangles of wood as often. subdivide in refine does the same for the \
                 skeleton, with which leaves and forks move, too."
            ),
            see_also(&["smooth_wood", "sides", "subdivisions", "triangles"])
        ),
        field!(
            "smooth_wood",
            real(0.0, 1.0),
            "",
            "wood from this share of the thickest radius on has as many rings as its curve needs to have no corners; 0: none",
            smooth_wood,
            details(
                "Trunks and limbs then turn by a few degrees from ring to ring, with up to 8 rings per segment; straight \
                 wood has none more. 0.15 adds some thousand triangles to an oak. Coarser levels of detail have it on \
                 thicker wood alone."
            ),
            see_also(&["rings", "sides", "triangles"])
        ),
        field!(
            "width_smoothing",
            real(0.0, 100.0),
            "",
            "over how many radii the surface spreads a change of the radius; 0: from one node to the next",
            width_smoothing,
            details(
                "The pipe model ends a limb's share of the trunk all at once above its fork; wood takes a few \
                 diameters for it. 2 does, 0 leaves each node the radius that the skeleton has, 10 makes \
                 trunks that taper evenly. width_steps=cylinder keeps its steps."
            ),
            see_also(&["width_steps", "rings", "radius_exponent"])
        ),
        field!(
            "bark_tile",
            real(0.01, 100.0),
            "m",
            "edge of the square of bark that one picture covers",
            bark_tile_m,
            details(
                "The usual 0.5 m with bark_size=512 is a millimetre a pixel. Larger tiles enlarge furrows; \
                 smaller ones repeat visibly on a thick trunk. Round thin wood a half, a quarter and so on \
                 of the picture goes."
            ),
            see_also(&["bark_size", "bark"])
        ),
        field!(
            "junction",
            Kind::Choice(Junction::WORDS),
            "",
            "how branches meet: tubes that overlap, the same with collars, or one closed solid for printing and simulation (slow: the oak about a minute on two cores, 310 MB as GLB)",
            junction,
            details(
                "overlap is lightest: each branch is a closed tube that starts inside its parent. blend \
                 adds fillets, of 0.6 where collar is 0. watertight is one closed surface without inner \
                 walls; it takes time and memory, its detail comes from junction_detail, and it cannot be \
                 thinned out to triangles or moved by wind."
            ),
            see_also(&["collar", "junction_detail", "triangles", "wind"])
        ),
        field!(
            "junction_detail",
            integer(4, 512),
            "",
            "for junction=watertight: cells across the thickest wood; twigs thinner than two cells are made as thick",
            junction_detail,
            details(
                "A cell's side is the largest diameter divided by this: 0.02 m at 32 for a trunk 0.6 m \
                 thick. Triangles grow with the square, and more than 20 million are refused. 128 and more \
                 keep twigs thin for a print."
            ),
            see_also(&["junction", "sides"])
        ),
        field!(
            "flare",
            real(0.0, 4.0),
            "",
            "how much wider the foot of a stem is than its trunk, as a share of the radius",
            features.flare,
            details(
                "At 0.35 the foot is 1.35 times as wide as its trunk, steep at the ground and gone at \
                 flare_height. 0.3 to 0.5 suits most trees, 1 and more one with buttresses."
            ),
            see_also(&["flare_height", "flare_ridges", "flare_depth", "base_radius"])
        ),
        field!(
            "flare_height",
            real_or_auto(0.0, 100.0),
            "m",
            "how high the flare reaches; auto: 5 radii of the foot",
            features.flare_height_m,
            see_also(&["flare"])
        ),
        field!(
            "flare_ridges",
            integer(0, 16),
            "",
            "buttresses round a flared foot; 0: it is round",
            features.flare_ridges,
            details(
                "4 to 7 look like roots that leave the trunk; they are neither equally far apart nor \
                 equally strong. The foot has at least 12 sides for each."
            ),
            see_also(&["flare_depth", "flare", "sides"])
        ),
        field!(
            "flare_depth",
            real(0.0, 1.0),
            "",
            "how much of the flare is buttresses",
            features.flare_depth,
            see_also(&["flare_ridges", "flare"])
        ),
        field!(
            "foot_depth",
            real(0.0, 10.0),
            "",
            "how far the foot of a stem goes on into the ground, in its radii; 0: it ends there",
            features.foot_depth,
            details(
                "For trees on slopes: at 1 no gap shows on the lower side of one of 45 degrees, with buttresses \
                 (flare_ridges) of 33. The origin stays at the ground, and heights count from there. A stem that \
                 leans goes as far as it needs to be closed all around in any case."
            ),
            see_also(&["ground_slope", "flare", "surface_roots"])
        ),
        field!(
            "foot_height",
            real(0.0, 100.0),
            "m",
            "the trunk up to this height has the bark of the foot: foot_bark and foot_color; 0: all has that of the trunk",
            features.foot_height_m,
            details(
                "Old trunks are rough below where they are smooth or flaking above: birch, Scots pine, cherry, gum. Over the last \
                 two tiles (bark_tile) below this height the bark of the trunk tears open over it; it ends on whole tiles, and is nothing below half of one. The wood is \
                 written in parts, wood_foot and wood_foot_edge, each with pictures of its own; levels of detail below \
                 5000 triangles have neither. Roots above the ground have it too, and so has thick wood that \
                 hangs so low."
            ),
            see_also(&["foot_bark", "foot_color", "bark", "limb_radius"])
        ),
        field!(
            "ground_slope",
            real(-60.0, 60.0),
            "°",
            "how steep the ground falls towards +X: the foot and the roots follow it",
            features.ground_slope_deg,
            details(
                "For a tree that is turned until its +X points downhill: surface_roots lie on the slope, and the \
                 foot goes as deep as it needs there. The tree itself grows as it does on level ground. Grounds of \
                 scenes and previews stay level."
            ),
            see_also(&["foot_depth", "surface_roots"])
        ),
        field!(
            "trunk_lobes",
            integer(0, 24),
            "",
            "lobes round a stem, all along it; 0: it is round",
            features.lobes,
            details(
                "Lobes of Weber & Penn 1995: the cross-section is a sine round the circle, where flare_ridges are \
                 buttresses of the foot alone. An aspen has 5, a willow 9. A stem has at least 6 sides for each, \
                 up to its tip."
            ),
            see_also(&["trunk_lobe_depth", "flare_ridges", "sides"])
        ),
        field!(
            "trunk_lobe_depth",
            real(0.0, 0.5),
            "",
            "how far lobes of a stem stand out and in, as a share of the radius",
            features.lobe_depth,
            see_also(&["trunk_lobes"])
        ),
        field!(
            "surface_roots",
            integer(0, 24),
            "",
            "roots on the ground round the foot, half in the soil; 0: none",
            features.roots.count,
            details(
                "They leave the trunk at its buttresses as far as it has such (flare_ridges), the strongest \
                 first, then in the widest gaps; some fork, and all dive below the ground before they end. 4 \
                 to 7 suit an old oak or beech, 8 to 12 thinner ones a spruce. A thinner stem has fewer, \
                 several stems of one stool have those of the thickest. They are surface alone: measures of \
                 the wood, CSV, MTG and QSM files are without them, wind does not move them, and levels of \
                 detail drop them like limbs of their thickness."
            ),
            see_also(&["root_reach", "root_rise", "flare_ridges", "flare"])
        ),
        field!(
            "root_reach",
            real(2.0, 20.0),
            "",
            "how far roots run from the middle of the foot before they are gone, in radii of the trunk there",
            features.roots.reach,
            details(
                "5 shows their beginnings, 8 to 12 a tree that stands on rock or whose soil was washed away. \
                 Each is up to a third shorter or a quarter longer."
            ),
            see_also(&["surface_roots", "root_rise"])
        ),
        field!(
            "root_rise",
            real(0.0, 1.0),
            "",
            "how much of the roots the soil shows",
            features.roots.rise,
            details(
                "At 0 they crop out here and there, at 0.5 about half of them is seen, at 1 they lie on the \
                 ground. They rise and sink on their way in any case."
            ),
            see_also(&["surface_roots", "root_reach"])
        ),
        field!(
            "stubs",
            real(0.0, 20.0),
            "1/m",
            "what is left of shed limbs on a metre of the bole: dead snags and healed swellings; 0: it is smooth",
            features.stubs.per_m,
            details(
                "They stand from above the flare to the lowest limb and a fifth into the crown, round the trunk \
                 as branches did. About two in five have healed: the bark has closed over them. 0.5 to 1 suits \
                 an oak, 2 to 4 a spruce that stood in a wood. They are surface alone, like surface_roots, and \
                 bark_relief_height lays its relief on them too."
            ),
            see_also(&["stub_length", "surface_roots", "bark_relief_height"])
        ),
        field!(
            "stub_length",
            real(0.0, 2.0),
            "m",
            "how long snags are on average; 0: all have healed",
            features.stubs.length_m,
            see_also(&["stubs"])
        ),
        field!(
            "collar",
            real(0.0, 1.0),
            "",
            "how far wood swells round the foot of a branch: radius of the fillet / radius of the wood that it leaves",
            features.collar,
            details(
                "0.3 to 0.6 is what bark does round a branch, 1 melts limbs into their trunk. It fills \
                 acute crotches, and is never wider than two radii of the branch, so that twigs on a trunk \
                 lift little. Each costs up to 14 rings."
            ),
            see_also(&["junction", "sides"])
        ),
        field!(
            "twig_taper",
            real(0.0, 1.0),
            "",
            "how much thinner a twig gets between its last fork and its bud",
            features.twig_taper,
            details(
                "By the pipe model a twig beyond its last fork has one thickness and ends like a stick. 0.5 \
                 to 0.7 draws it thin to its bud."
            ),
            see_also(&["tip_radius", "ends"])
        ),
        field!(
            "ends",
            Kind::Choice(Ends::WORDS),
            "",
            "how branches end: in a bud, sawn off, or snapped",
            features.ends,
            details(
                "A bud is a point one radius beyond the last node. cut is a flat disc, as of a pollard or a \
                 pruned tree; broken is a rim of splinters, torn farther on one side, round a hollow. Ends \
                 thinner than ends_above are buds in any case."
            ),
            see_also(&["ends_above", "twig_taper"])
        ),
        field!(
            "ends_above",
            real(0.0, 100.0),
            "m",
            "thinner ends are buds whatever ends says",
            features.ends_above_m,
            see_also(&["ends"])
        ),
    ];
}
