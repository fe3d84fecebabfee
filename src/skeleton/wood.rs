//! The knobs of the wood: its shape between growth and surface, and how thick it is.

use linden_base::field;
use linden_base::knob::{Field, Kind, Knob, Value, integer, real, real_or_auto};

use crate::refine::{Refinement, STEPS, Step};
use crate::{Width, Wood};

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

/// Control points of a trunk's curve, beside its foot.
const MOST_CONTROLS: usize = 12;

impl Wood {
    /// Its knobs.
    pub const FIELDS: &[Field<Self>] = &[
        field!(
            "width",
            Kind::Choice(Width::WORDS),
            "",
            "rule for the radii: pipe model, halved per branching order, tapers drawn per axis, or the grammar's own; auto: the grammar's (or scan's) where it gives them, else pipe",
            width
        ),
        field!(
            "base_radius",
            real_or_auto(1e-5, 100.0),
            "m",
            "radius at the foot; auto: follows from the tips (pipe model with tip_radius), the grammar or the slenderness",
            base_radius_m
        ),
        field!(
            "tip_radius",
            real_or_auto(1e-5, 10.0),
            "m",
            "radius of the thinnest twigs; auto: follows from the base",
            tip_radius_m
        ),
        field!(
            "slenderness",
            real(1.0, 1000.0),
            "",
            "height / diameter at the foot, where neither radius is given: 30-50 in the open, 80-100 in dense stands",
            slenderness
        ),
        field!(
            "radius_exponent",
            real(1.0, 10.0),
            "",
            "n of the pipe model r^n = sum of children's r^n: larger is a thinner trunk",
            radius_exponent
        ),
        field!(
            "angle_share",
            real(0.0, 1.0),
            "",
            "for the pipe model: how much less of a fork goes to children that turn away; 0: tips alone count",
            angle_share
        ),
        field!(
            "order_ratio",
            real(0.01, 1.0),
            "",
            "for width=order: radius of a branch / radius of the one it leaves",
            order_ratio
        ),
        field!(
            "taper_base_min",
            real(0.01, 1.0),
            "",
            "for width=taper: least radius of a branch's base / radius of its parent there",
            taper_base.min
        ),
        field!(
            "taper_base_max",
            real(0.01, 1.0),
            "",
            "for width=taper: largest radius of a branch's base / radius of its parent there",
            taper_base.max
        ),
        field!(
            "taper_tip_min",
            real(0.0, 1.0),
            "",
            "for width=taper: least radius of a tip / radius of its branch's base",
            taper_tip.min
        ),
        field!(
            "taper_tip_max",
            real(0.0, 1.0),
            "",
            "for width=taper: largest radius of a tip / radius of its branch's base",
            taper_tip.max
        ),
    ];
}

impl Refinement {
    /// Its knobs.
    pub const FIELDS: &[Field<Self>] = &[
        Field {
            knob: Knob::new(
                "refine",
                Kind::Words(&STEP_NAMES),
                "",
                "what is done to the axes after growth, in this order: prune barren or short twigs, decimate nodes, relocate them towards their parents, smooth wiggles, subdivide into curves",
            ),
            read: |refinement| {
                Value::Words(refinement.steps.iter().map(|step| step.name.to_owned()).collect())
            },
            write: |refinement, value| {
                let Value::Words(words) = value else { return };
                if let Some(steps) = words.iter().map(|word| Step::named(word)).collect() {
                    refinement.steps = steps;
                }
            },
        },
        field!(
            "prune_nodes",
            integer(1, 1000),
            "nodes",
            "for refine=prune, where nobody knows which twigs caught a point: the longest side twig that goes",
            prune_nodes
        ),
        field!(
            "decimate_tolerance",
            real(0.0, 100.0),
            "segments",
            "for refine=decimate: how far axes may move, in mean segment lengths",
            decimate_tolerance
        ),
        field!(
            "relocate_share",
            real(0.0, 1.0),
            "",
            "for refine=relocate: how far each node goes towards its parent; 0.5 is halfway",
            relocate_share
        ),
        field!(
            "smooth_rounds",
            integer(1, 100),
            "",
            "for refine=smooth: how often each node is averaged with its neighbours",
            smooth_rounds
        ),
        field!(
            "subdivisions",
            integer(1, 6),
            "",
            "for refine=subdivide: how often each segment is halved",
            subdivisions
        ),
        field!(
            "trunk_curve",
            Kind::Reals { min: -1000.0, max: 1000.0, most: MOST_CONTROLS * 3 },
            "m",
            "control points x y z of a Bezier curve that the trunk is bent onto, from its foot, like 0 3 0 1 6 0; 0: as grown",
            trunk_curve
        ),
        field!(
            "sway",
            real(0.0, 1.0),
            "",
            "how far trunk and limbs swing to the side / their length, at random",
            sway
        ),
        field!(
            "gnarl",
            real(0.0, 4.0),
            "",
            "how far wood bends to and fro over a few times its thickness / that thickness: old wood is gnarled",
            gnarl
        ),
    ];
}
