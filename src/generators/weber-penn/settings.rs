//! The settings: the parameters of the paper, by its names.

use linden_base::field;
use linden_base::knob::{Field, Kind, integer, real};

use crate::level::Level;
use crate::shape::{CrownShape, Dialect, Envelope};

/// The most levels of stems.
pub const MAX_LEVELS: u32 = 8;

/// A tree by the parameters of Weber & Penn 1995. Lists have a number for each level, the trunk first; the
/// last holds for all further ones. Where the paper writes `nDownAngleV` there is `down_angle_v`.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct WeberPenn {
    /// How long branches are by where they leave the trunk.
    pub shape: CrownShape,
    /// Whose reading is followed where programs differ.
    pub dialect: Dialect,
    /// Levels of stems: 1 is a trunk alone.
    pub levels: u32,
    /// The bare share of the trunk, of the scale.
    pub base_size: f64,
    /// The tree's size, metres: the trunk is as long times its `length`.
    pub scale_m: f64,
    /// The most by which it differs, metres.
    pub scale_spread_m: f64,
    /// Radius of the trunk ÷ its length.
    pub ratio: f64,
    /// How fast radii fall with lengths from a stem to its children.
    pub ratio_power: f64,
    /// Factor of the trunk's radius.
    pub trunk_scale: f64,
    /// The most by which it differs.
    pub trunk_scale_spread: f64,
    /// Clones at the end of the trunk's first segment; below 0: up to so many.
    pub base_splits: f64,
    /// Length ÷ the parent's.
    pub length: Vec<f64>,
    /// The most by which it differs.
    pub length_spread: Vec<f64>,
    /// How stems thin: see [`tapered`](crate::tapered).
    pub taper: Vec<f64>,
    /// Angle from the parent, degrees.
    pub down_angle_deg: Vec<f64>,
    /// The most by which it differs, degrees; below 0: by where the stem leaves.
    pub down_angle_spread_deg: Vec<f64>,
    /// From a stem to the next one about their parent, degrees; below 0: on alternating sides.
    pub rotate_deg: Vec<f64>,
    /// The most by which it differs, degrees.
    pub rotate_spread_deg: Vec<f64>,
    /// The most stems on a parent; the first number: trunks. Below 0: a fan at the parent's tip.
    pub branches: Vec<f64>,
    /// Where within a segment stems leave: 0 whorls at its base, 1 spread along it.
    pub branch_dist: Vec<f64>,
    /// Clones a segment.
    pub seg_splits: Vec<f64>,
    /// How far stems and clones part, degrees.
    pub split_angle_deg: Vec<f64>,
    /// The most by which that differs, degrees.
    pub split_angle_spread_deg: Vec<f64>,
    /// Segments a stem.
    pub curve_res: Vec<f64>,
    /// How far stems bend, degrees.
    pub curve_deg: Vec<f64>,
    /// How far their upper halves bend, degrees; 0: as the lower.
    pub curve_back_deg: Vec<f64>,
    /// The most by which they bend to and fro, degrees; below 0: a helix of that slope.
    pub curve_spread_deg: Vec<f64>,
    /// Whether stems are curves through the ends of their segments.
    pub smooth: bool,
    /// How far stems of the levels from 2 on turn up, below 0 down.
    pub attraction_up: f64,
    /// The most leaves a stem of the last level; below 0: a fan at its tip.
    pub leaves: f64,
    /// How many leaves stems have by where they leave, as `shape`.
    pub leaf_dist: CrownShape,
    /// Length of a leaf, metres.
    pub leaf_scale_m: f64,
    /// The most by which lengths of leaves differ, as a share.
    pub leaf_scale_spread: f64,
    /// How far leaves turn to the light, 0 to 1.
    pub leaf_bend: f64,
    /// The share of the leaves that is there, each larger in return.
    pub leaf_quality: f64,
    /// Stalk ÷ length of a leaf.
    pub leaf_stem: f64,
    /// How far stems are shortened to the envelope, 0 to 1.
    pub prune_ratio: f64,
    /// The envelope.
    pub envelope: Envelope,
    /// Larger trees are refused.
    pub max_nodes: u32,
    /// Of the stems of a level, every n-th grows: samples of large trees.
    pub(crate) thinned: Thinned,
}

/// Which stems of a sample grow.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Thinned {
    pub level: usize,
    pub every: usize,
}

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
                 look like is in the section foliage, whose leaf_form is to be set and whose leaves_per_m to be 0: \
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

    /// The parameters of a level; deeper levels than lists are long have the last.
    pub(crate) fn level(&self, level: usize) -> Level {
        let at = |list: &[f64]| list.get(level).or(list.last()).copied().unwrap_or(0.0);
        Level {
            length: at(&self.length),
            length_spread: at(&self.length_spread),
            taper: at(&self.taper),
            down_angle: at(&self.down_angle_deg).to_radians(),
            down_angle_spread: at(&self.down_angle_spread_deg).to_radians(),
            rotate: at(&self.rotate_deg).to_radians(),
            rotate_spread: at(&self.rotate_spread_deg).to_radians(),
            branches: at(&self.branches),
            branch_dist: at(&self.branch_dist),
            seg_splits: at(&self.seg_splits),
            split_angle: at(&self.split_angle_deg).to_radians(),
            split_angle_spread: at(&self.split_angle_spread_deg).to_radians(),
            segments: libm::round(at(&self.curve_res)).max(1.0) as u32,
            curve: at(&self.curve_deg).to_radians(),
            curve_back: at(&self.curve_back_deg).to_radians(),
            curve_spread: at(&self.curve_spread_deg).to_radians(),
        }
    }

    /// The share of the longest branch by the paper's ratio.
    pub(crate) fn shape_ratio(&self, shape: CrownShape, r: f64) -> f64 {
        shape.ratio(r, self.dialect, &self.envelope)
    }

    /// Why a knob changes nothing as these settings stand, and what would let it.
    pub(crate) fn why_idle(&self, knob: &str) -> Option<&'static str> {
        let only = |list: &[f64], is_idle: fn(f64) -> bool| {
            (0..self.levels as usize)
                .all(|level| is_idle(list.get(level).or(list.last()).copied().unwrap_or(0.0)))
        };
        let has_leaves = self.leaves != 0.0 && self.levels > 1;
        match knob {
            "leaves" if self.levels == 1 => Some("levels=1: a trunk alone has no leaves"),
            "leaf_dist" | "leaf_scale" | "leaf_scale_v" | "leaf_bend" | "leaf_quality" | "leaf_stem"
                if !has_leaves =>
            {
                Some("there are no leaves: leaves is 0, or levels 1")
            }
            "prune_width" if self.prune_ratio == 0.0 => Some("prune_ratio is 0"),
            "prune_width_peak" | "prune_power_low" | "prune_power_high"
                if self.prune_ratio == 0.0 && self.shape != CrownShape::Envelope =>
            {
                Some("prune_ratio is 0, and shape is not envelope")
            }
            "attraction_up" if self.levels < 3 => Some("it is for level 2 and deeper; levels is below 3"),
            "split_angle" | "split_angle_v"
                if self.base_splits == 0.0 && only(&self.seg_splits, |splits| splits == 0.0) =>
            {
                Some("nothing splits: seg_splits and base_splits are 0")
            }
            "rotate" | "rotate_v" | "branch_dist" if self.levels == 1 && !has_leaves => {
                Some("levels=1: nothing leaves the trunk")
            }
            _ => None,
        }
    }
}

impl Default for WeberPenn {
    /// What the parameters are where a file says nothing: those of Arbaro, which are nearest to the paper.
    fn default() -> Self {
        Self {
            shape: CrownShape::Conical,
            dialect: Dialect::Paper,
            levels: 3,
            base_size: 0.25,
            scale_m: 10.0,
            scale_spread_m: 0.0,
            ratio: 0.05,
            ratio_power: 1.0,
            trunk_scale: 1.0,
            trunk_scale_spread: 0.0,
            base_splits: 0.0,
            length: vec![1.0, 0.5, 0.5, 0.5],
            length_spread: vec![0.0],
            taper: vec![1.0],
            down_angle_deg: vec![0.0, 30.0, 30.0, 30.0],
            down_angle_spread_deg: vec![0.0],
            rotate_deg: vec![0.0, 120.0, 120.0, 120.0],
            rotate_spread_deg: vec![0.0],
            branches: vec![1.0, 10.0, 5.0, 5.0],
            branch_dist: vec![0.0, 1.0, 1.0, 1.0],
            seg_splits: vec![0.0],
            split_angle_deg: vec![0.0],
            split_angle_spread_deg: vec![0.0],
            curve_res: vec![3.0, 3.0, 1.0, 1.0],
            curve_deg: vec![0.0],
            curve_back_deg: vec![0.0],
            curve_spread_deg: vec![0.0],
            smooth: true,
            attraction_up: 0.0,
            leaves: 0.0,
            leaf_dist: CrownShape::TaperedCylindrical,
            leaf_scale_m: 0.2,
            leaf_scale_spread: 0.0,
            leaf_bend: 0.3,
            leaf_quality: 1.0,
            leaf_stem: 0.0,
            prune_ratio: 0.0,
            envelope: Envelope { width: 0.5, width_peak: 0.5, power_low: 0.5, power_high: 0.5 },
            max_nodes: 20_000_000,
            thinned: Thinned { level: 0, every: 1 },
        }
    }
}
