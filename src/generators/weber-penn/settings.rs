//! The settings: the parameters of the paper, by its names.

use std::borrow::Cow;

use crate::level::Level;
use crate::shape::{CrownShape, Dialect, Envelope};

/// No tree is smaller than this share of the grown one.
const LEAST_AGE: f64 = 0.01;

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
    /// The share of its size that the tree has reached.
    pub age: f64,
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

impl WeberPenn {
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

    /// The parameters of the tree at its age: as large as it has grown by then, with as many stems to a metre and as
    /// many leaves to a metre of twig as when it is whole, and leaves as large as ever.
    pub(crate) fn at_age(&self) -> Cow<'_, Self> {
        let share = self.age;
        if share >= 1.0 {
            return Cow::Borrowed(self);
        }
        let share = share.max(LEAST_AGE);
        let mut young = Self { age: 1.0, ..self.clone() };
        young.scale_m *= share;
        young.scale_spread_m *= share;
        let branches = |level: usize| self.level(level).branches;
        // One at least of each: a sapling, not a pole.
        let fewer = |count: f64| (count.abs() * share).max(count.abs().min(1.0)).copysign(count);
        young.branches = (0..=self.levels as usize)
            .map(|level| if level == 0 { branches(0) } else { fewer(branches(level)) })
            .collect();
        young.leaves = fewer(self.leaves);
        Cow::Owned(young)
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
            "base_size" | "shape" | "dialect" | "down_angle" | "down_angle_v" | "rotate" | "rotate_v"
            | "branch_dist" | "prune_ratio" | "ratio_power"
                if self.levels == 1 =>
            {
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
            age: 1.0,
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
