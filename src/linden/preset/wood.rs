//! `[wood]`: its shape between growth and surface, and how thick it is.

use super::Preset;
use super::knobs::{PresetKnob, integer, real, real_or_auto, row};
use super::setting::Setting;
use crate::knob::{Kind, Value};
use crate::random::Key;
use crate::skeleton::Width;
use crate::skeleton::refine::{STEPS, Step};

impl Preset {
    /// The key of what radii draw.
    pub fn wood_key(&self) -> Key {
        Key::new(self.seed).named("wood")
    }
}

/// The names of all rules for radii.
const WIDTHS: [&str; Width::ALL.len()] = {
    let mut names = [""; Width::ALL.len()];
    let mut i = 0;
    while i < names.len() {
        names[i] = Width::ALL[i].0;
        i += 1;
    }
    names
};

/// The names of all steps of refinement.
const STEP_NAMES: [&str; STEPS.len()] = {
    let mut names = [""; STEPS.len()];
    let mut i = 0;
    while i < names.len() {
        names[i] = STEPS[i].name;
        i += 1;
    }
    names
};

impl Setting for Width {
    fn to_value(&self) -> Value {
        let name = Self::ALL.iter().find(|(_, width)| width == self).map_or("", |(name, _)| name);
        Value::Word(name.to_owned())
    }

    fn from_value(value: Value) -> Option<Self> {
        let word = String::from_value(value)?;
        Self::ALL.into_iter().find(|(name, _)| *name == word).map(|(_, width)| width)
    }
}

impl Setting for Vec<Step> {
    fn to_value(&self) -> Value {
        Value::Words(self.iter().map(|step| step.name.to_owned()).collect())
    }

    fn from_value(value: Value) -> Option<Self> {
        let Value::Words(words) = value else { return None };
        words.iter().map(|word| Step::named(word)).collect()
    }
}

/// Control points of a trunk's curve, beside its foot.
const MOST_CONTROLS: usize = 12;

/// The section's knobs.
pub(super) const KNOBS: &[PresetKnob] = &[
    row!(Wood, "width", Kind::Choice(&WIDTHS), "", "rule for the radii: pipe model, halved per branching order, tapers drawn per axis, or the grammar's own; auto: the grammar's (or scan's) where it gives them, else pipe", .wood.width),
    row!(Wood, "base_radius", real_or_auto(1e-5, 100.0), "m", "radius at the foot; auto: follows from the tips (pipe model with tip_radius), the grammar or the slenderness", .wood.base_radius_m),
    row!(Wood, "tip_radius", real_or_auto(1e-5, 10.0), "m", "radius of the thinnest twigs; auto: follows from the base", .wood.tip_radius_m),
    row!(Wood, "slenderness", real(1.0, 1000.0), "", "height / diameter at the foot, where neither radius is given: 30-50 in the open, 80-100 in dense stands", .wood.slenderness),
    row!(Wood, "radius_exponent", real(1.0, 10.0), "", "n of the pipe model r^n = sum of children's r^n: larger is a thinner trunk", .wood.radius_exponent),
    row!(Wood, "angle_share", real(0.0, 1.0), "", "for the pipe model: how much less of a fork goes to children that turn away; 0: tips alone count", .wood.angle_share),
    row!(Wood, "order_ratio", real(0.01, 1.0), "", "for width=order: radius of a branch / radius of the one it leaves", .wood.order_ratio),
    row!(Wood, "taper_base_min", real(0.01, 1.0), "", "for width=taper: least radius of a branch's base / radius of its parent there", .wood.taper_base.min),
    row!(Wood, "taper_base_max", real(0.01, 1.0), "", "for width=taper: largest radius of a branch's base / radius of its parent there", .wood.taper_base.max),
    row!(Wood, "taper_tip_min", real(0.0, 1.0), "", "for width=taper: least radius of a tip / radius of its branch's base", .wood.taper_tip.min),
    row!(Wood, "taper_tip_max", real(0.0, 1.0), "", "for width=taper: largest radius of a tip / radius of its branch's base", .wood.taper_tip.max),
    row!(Wood, "refine", Kind::Words(&STEP_NAMES), "", "what is done to the axes after growth, in this order: prune barren or short twigs, decimate nodes, relocate them towards their parents, smooth wiggles, subdivide into curves", .refinement.steps),
    row!(Wood, "prune_nodes", integer(1, 1000), "nodes", "for refine=prune, where nobody knows which twigs caught a point: the longest side twig that goes", .refinement.prune_nodes),
    row!(Wood, "decimate_tolerance", real(0.0, 100.0), "segments", "for refine=decimate: how far axes may move, in mean segment lengths", .refinement.decimate_tolerance),
    row!(Wood, "relocate_share", real(0.0, 1.0), "", "for refine=relocate: how far each node goes towards its parent; 0.5 is halfway", .refinement.relocate_share),
    row!(Wood, "smooth_rounds", integer(1, 100), "", "for refine=smooth: how often each node is averaged with its neighbours", .refinement.smooth_rounds),
    row!(Wood, "subdivisions", integer(1, 6), "", "for refine=subdivide: how often each segment is halved", .refinement.subdivisions),
    row!(Wood, "trunk_curve", Kind::Reals { min: -1000.0, max: 1000.0, most: MOST_CONTROLS * 3 }, "m", "control points x y z of a Bezier curve that the trunk is bent onto, from its foot, like 0 3 0 1 6 0; 0: as grown", .refinement.trunk_curve),
    row!(Wood, "sway", real(0.0, 1.0), "", "how far trunk and limbs swing to the side / their length, at random", .refinement.sway),
    row!(Wood, "gnarl", real(0.0, 4.0), "", "how far wood bends to and fro over a few times its thickness / that thickness: old wood is gnarled", .refinement.gnarl),
];
