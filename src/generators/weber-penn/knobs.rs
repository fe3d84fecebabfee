//! The table of knobs: a parameter of the paper a row.

use linden_base::field;
use linden_base::knob::{Field, Kind, integer, real};

use crate::WeberPenn;
use crate::settings::MAX_LEVELS;
use crate::shape::{CrownShape, Dialect};

/// A list with a number for each level.
const fn per_level(min: f64, max: f64) -> Kind {
    Kind::Reals { min, max, most: MAX_LEVELS as usize }
}

impl WeberPenn {
    /// The knobs, by the paper's names.
    pub const FIELDS: &[Field<Self>] = &[
        field!(
            "shape",
            Kind::Choice(CrownShape::WORDS),
            "",
            "the crown: how long branches are by where they leave the trunk",
            shape,
            details(
                "Shape 0 to 8 of the paper, in this order. conical is longest at the crown's base; flame and \
                 tend-flame three tenths up; envelope goes by prune_width_peak, prune_power_low and \
                 prune_power_high."
            ),
            see_also(&["base_size", "length", "prune_ratio"])
        ),
        field!(
            "dialect",
            Kind::Choice(Dialect::WORDS),
            "",
            "whose reading of the paper holds where programs differ",
            dialect,
            details(
                "arbaro: with shape=conical branches shrink to nothing at the top, and so do the angles that a \
                 negative down_angle_v gives; the first child of every stem leaves to the same side, where the \
                 paper says nothing and linden draws it. Files of Arbaro are read with it."
            ),
            see_also(&["shape", "down_angle_v", "rotate"])
        ),
        field!(
            "levels",
            integer(1, MAX_LEVELS as u64),
            "",
            "levels of stems: 1 is a trunk alone; leaves are on the last",
            levels,
            see_also(&["branches", "leaves"])
        ),
        field!(
            "age",
            real(0.0, 1.0),
            "",
            "how far growth has come: the young tree at this share of its size; 1: the whole tree",
            age,
            details(
                "The paper has no time. At 0.3 scale is three tenths, and so are the numbers of branches and leaves \
                 of each stem, one at least; leaves keep their size."
            ),
            see_also(&["scale", "branches", "leaves"])
        ),
        field!(
            "base_size",
            real(0.0, 1.0),
            "",
            "the bare share of the trunk",
            base_size,
            see_also(&["shape", "scale"])
        ),
        field!(
            "scale",
            real(0.01, 1000.0),
            "m",
            "size of the tree: the trunk is as long times its length",
            scale_m,
            details(
                "All lengths but that of leaves follow from it. scale_v draws another size for each seed; a \
                 tree is never smaller than a tenth of scale."
            ),
            see_also(&["scale_v", "length", "ratio"])
        ),
        field!(
            "scale_v",
            real(0.0, 1000.0),
            "m",
            "the most by which the size differs from seed to seed",
            scale_spread_m,
            see_also(&["scale"])
        ),
        field!(
            "ratio",
            real(0.0001, 1.0),
            "",
            "radius of the trunk / its length",
            ratio,
            see_also(&["ratio_power", "trunk_scale", "flare"])
        ),
        field!(
            "ratio_power",
            real(0.0, 10.0),
            "",
            "how fast stems get thin: radius / parent's radius is (length / parent's length) to this power",
            ratio_power,
            see_also(&["ratio", "taper"])
        ),
        field!(
            "trunk_scale",
            real(0.01, 10.0),
            "",
            "factor of the trunk's radius: 0Scale of the paper",
            trunk_scale,
            see_also(&["trunk_scale_v", "ratio"])
        ),
        field!(
            "trunk_scale_v",
            real(0.0, 10.0),
            "",
            "the most by which that factor differs from seed to seed",
            trunk_scale_spread,
            see_also(&["trunk_scale"])
        ),
        field!(
            "base_splits",
            real(-16.0, 16.0),
            "",
            "clones of the trunk at the end of its first segment; below 0: up to so many",
            base_splits,
            see_also(&["seg_splits", "split_angle", "curve_res"])
        ),
        field!(
            "length",
            per_level(0.0, 100.0),
            "",
            "length of stems / their parent's, for each level; the trunk's: of scale",
            length,
            details(
                "Level 1 times the share that shape gives where a branch leaves; deeper levels of what the \
                 parent's length is without 0.6 of the way to the place. Drawn once for the children of a \
                 parent."
            ),
            see_also(&["length_v", "shape", "scale"])
        ),
        field!(
            "length_v",
            per_level(0.0, 100.0),
            "",
            "the most by which length differs, for each level",
            length_spread,
            see_also(&["length"])
        ),
        field!(
            "taper",
            per_level(0.0, 3.0),
            "",
            "how stems thin, for each level: 0 not at all, 1 to a point, 2 with a round end, 3 as a string of balls",
            taper,
            see_also(&["ratio_power", "ratio"])
        ),
        field!(
            "down_angle",
            per_level(-360.0, 360.0),
            "deg",
            "angle from the parent, for each level",
            down_angle_deg,
            details(
                "0 goes on along the parent, 90 leaves square to it. The trunk's number means nothing. Leaves go \
                 by the number behind the last level's."
            ),
            see_also(&["down_angle_v", "rotate", "curve"])
        ),
        field!(
            "down_angle_v",
            per_level(-360.0, 360.0),
            "deg",
            "the most by which down_angle differs; below 0: by where the stem leaves",
            down_angle_spread_deg,
            details(
                "At -50 with down_angle=60 the lowest branches leave at 110 degrees and the highest at 30; \
                 values above 0 are drawn for each stem."
            ),
            see_also(&["down_angle", "dialect"])
        ),
        field!(
            "rotate",
            per_level(-360.0, 360.0),
            "deg",
            "from a stem to the next about their parent; below 0: on alternating sides",
            rotate_deg,
            details(
                "A spiral: 140 is near to the golden angle. Below 0 stems lie in a plane or two: at -90 flat to \
                 the left and right, at -120 and -60 as far from the upper or the lower side."
            ),
            see_also(&["rotate_v", "down_angle", "dialect"])
        ),
        field!(
            "rotate_v",
            per_level(0.0, 360.0),
            "deg",
            "the most by which rotate differs, for each level",
            rotate_spread_deg,
            see_also(&["rotate"])
        ),
        field!(
            "branches",
            per_level(-10_000.0, 10_000.0),
            "",
            "the most stems on a parent, for each level; the first number: trunks; below 0: a fan at its tip",
            branches,
            details(
                "Level 1 has exactly as many, shorter parents have fewer, and stems near a parent's tip, too. \
                 The tree grows with the product of all: 1 50 30 makes 1200 stems, which leaves multiplies."
            ),
            see_also(&["levels", "branch_dist", "leaves", "max_nodes"])
        ),
        field!(
            "branch_dist",
            per_level(0.0, 1.0),
            "",
            "where within a segment stems leave: 0 in whorls at its base, 1 spread along it",
            branch_dist,
            see_also(&["branches", "curve_res"])
        ),
        field!(
            "seg_splits",
            per_level(0.0, 8.0),
            "",
            "clones a segment, for each level; fractions are spread over stems",
            seg_splits,
            details(
                "A stem forks at the end of a segment into itself and clones of as much length as it has left. \
                 0.2 forks every fifth segment: the error of rounding is carried on to the next segment. With 1 \
                 and 8 segments a stem ends in 128 tips."
            ),
            see_also(&["split_angle", "base_splits", "curve_res"])
        ),
        field!(
            "split_angle",
            per_level(-360.0, 360.0),
            "deg",
            "how far stems and clones part, less the angle to the vertical; below 0: forks lie flat",
            split_angle_deg,
            see_also(&["split_angle_v", "seg_splits"])
        ),
        field!(
            "split_angle_v",
            per_level(0.0, 360.0),
            "deg",
            "the most by which split_angle differs, for each level",
            split_angle_spread_deg,
            see_also(&["split_angle"])
        ),
        field!(
            "curve_res",
            per_level(1.0, 200.0),
            "",
            "segments of a stem, for each level",
            curve_res,
            see_also(&["curve", "seg_splits", "smooth"])
        ),
        field!(
            "curve",
            per_level(-3600.0, 3600.0),
            "deg",
            "how far stems bend away from their parent; below 0: to it",
            curve_deg,
            details(
                "Over all segments together. A level branch with -40 rises towards its tip. With curve_back it is \
                 the lower half that bends so."
            ),
            see_also(&["curve_back", "curve_v", "curve_res", "attraction_up"])
        ),
        field!(
            "curve_back",
            per_level(-3600.0, 3600.0),
            "deg",
            "how far their upper halves bend; 0: as curve has it",
            curve_back_deg,
            see_also(&["curve"])
        ),
        field!(
            "curve_v",
            per_level(-3600.0, 3600.0),
            "deg",
            "the most by which stems bend at random; below 0: a helix of that slope",
            curve_spread_deg,
            details(
                "Drawn for each segment, of the whole divided by the segments. A helix turns once a segment; its \
                 slope is its angle to the stem's way, below 90."
            ),
            see_also(&["curve", "curve_res"])
        ),
        field!(
            "smooth",
            Kind::Switch,
            "",
            "stems are curves through the ends of their segments; false: straight from one to the next",
            smooth,
            see_also(&["curve_res", "rings"])
        ),
        field!(
            "attraction_up",
            real(-100.0, 100.0),
            "",
            "how far stems of level 2 and deeper turn up; below 0: how far they hang",
            attraction_up,
            details(
                "1 would turn a level stem up over its length if it did not turn about its own axis; from 10 on \
                 stems swing to and fro. The paper has 0.5 to 0.8, for the willow -3."
            ),
            see_also(&["curve", "prune_ratio"])
        ),
        field!(
            "leaves",
            real(-10_000.0, 10_000.0),
            "",
            "the most leaves on a stem of the last level; below 0: a fan at its tip",
            leaves,
            details(
                "Stems have more of them the nearer they are to their parent's tip, as leaf_dist says. What they \
                 look like is in the section foliage, whose leaf_form is to be set (none: no leaves) and whose leaves_per_m to be 0: \
                 leaf_outline, leaf_width, colours, season and leaf_keep are for them."
            ),
            see_also(&["leaf_scale", "leaf_bend", "leaf_form", "leaf_keep", "season"])
        ),
        field!(
            "leaf_dist",
            Kind::Choice(CrownShape::WORDS),
            "",
            "how many leaves a stem has by where it leaves its parent, as shape",
            leaf_dist,
            see_also(&["leaves"])
        ),
        field!(
            "leaf_scale",
            real(0.001, 100.0),
            "m",
            "length of a leaf",
            leaf_scale_m,
            details(
                "Whatever the tree's size. season unfolds leaves; LeafScaleX of the paper, width by length, is \
                 leaf_width of the section foliage."
            ),
            see_also(&["leaf_scale_v", "leaves", "leaf_quality", "leaf_width"])
        ),
        field!(
            "leaf_scale_v",
            real(0.0, 1.0),
            "",
            "the most by which leaves are longer or shorter, as a share",
            leaf_scale_spread,
            see_also(&["leaf_scale"])
        ),
        field!(
            "leaf_bend",
            real(0.0, 1.0),
            "",
            "how far leaves turn out of the crown and up to the sky",
            leaf_bend,
            see_also(&["leaves", "down_angle"])
        ),
        field!(
            "leaf_quality",
            real(0.001, 1.0),
            "",
            "the share of the leaves that is there; each is larger by as much",
            leaf_quality,
            see_also(&["leaves", "leaf_scale", "leaf_keep"])
        ),
        field!(
            "leaf_stem",
            real(0.0, 10.0),
            "",
            "a stalk between twig and leaf / the leaf's length; leaf_petiole draws one",
            leaf_stem,
            see_also(&["leaf_scale", "leaf_petiole"])
        ),
        field!(
            "prune_ratio",
            real(0.0, 1.0),
            "",
            "how far stems are shortened to stay in the envelope; 0: there is none, 1: none leaves it",
            prune_ratio,
            details(
                "Each stem is tried shorter and shorter until the ends of all its segments are inside, with the \
                 same bends; its children are then those of a shorter stem. The trunk is spared. The envelope \
                 begins at base_size: what hangs lower is cut."
            ),
            see_also(&["prune_width", "prune_width_peak", "prune_power_low", "prune_power_high", "shape"])
        ),
        field!(
            "prune_width",
            real(0.0, 10.0),
            "",
            "the envelope's widest radius / scale",
            envelope.width,
            see_also(&["prune_ratio"])
        ),
        field!(
            "prune_width_peak",
            real(0.0, 1.0),
            "",
            "where the envelope is widest: 0 at the crown's base, 1 at its top",
            envelope.width_peak,
            see_also(&["prune_ratio"])
        ),
        field!(
            "prune_power_low",
            real(0.0, 100.0),
            "",
            "the envelope below its widest place: 1 a cone, 0.5 rounder, 2 hollow",
            envelope.power_low,
            see_also(&["prune_ratio"])
        ),
        field!(
            "prune_power_high",
            real(0.0, 100.0),
            "",
            "the envelope above its widest place: 1 a cone, 0.5 rounder, 2 hollow",
            envelope.power_high,
            see_also(&["prune_ratio"])
        ),
        field!(
            "max_nodes",
            integer(2, 4_000_000_000),
            "nodes",
            "larger trees are refused",
            max_nodes,
            see_also(&["branches", "seg_splits", "levels"])
        ),
    ];
}
