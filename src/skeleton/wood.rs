//! The knobs of the wood: its shape between growth and surface, and how thick it is.

use linden_base::field;
use linden_base::knob::{Field, Kind, Knob, Value, integer, real, real_or_auto};

use crate::refine::{Refinement, STEPS, Step};
use crate::{AxisRule, Width, WidthSteps, Wood};

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
            width,
            details(
                "pipe gives trunks what their twigs add up to (Shinozaki et al. 1964; Runions et al. 2007, \
                 section 4.3). order keeps one radius all along an axis and takes order_ratio of it for the \
                 next order: a diagram's look. taper draws for each axis what share of its parent it begins \
                 with and what share of that it ends with: slender, even limbs. grammar is what a grammar's \
                 ! or the bark of a scan says."
            ),
            see_also(&["radius_exponent", "order_ratio", "taper_base_min", "base_radius", "scan_radius"])
        ),
        field!(
            "axes",
            Kind::Choice(AxisRule::WORDS),
            "",
            "which child of a node continues its axis: what a grammar writes outside brackets, or the thickest; auto: the grammar's where there is one",
            axes,
            details(
                "In an axial tree the bracketed branch is the lateral (ABOP, section 1.6.1), however thick \
                 it is; where all are bracketed the axis ends, and each of them begins one. Orders, the \
                 branches of a cylinder table, branching angles and width=order go by it. thickest follows \
                 the wood: the thickest child, among equals the straightest, as for all trees that no \
                 grammar wrote."
            ),
            see_also(&["width", "order_ratio", "radius_exponent"])
        ),
        field!(
            "width_steps",
            Kind::Choice(WidthSteps::WORDS),
            "",
            "how the radius goes from node to node: evenly (taper), or in a step at each node (cylinder)",
            width_steps,
            details(
                "With cylinder each segment is as thick all along as the node that it ends in: !(1)F!(0.5)F \
                 of a grammar is a cylinder on a cylinder, a table of cylinders has the radii that were \
                 asked for, and volumes are sums of π r² l, with ends=cut (no buds on its tips) to the last \
                 digit. taper draws wood as it grows, and what stands above a fork is spread along it by \
                 width_smoothing."
            ),
            see_also(&["width", "width_smoothing", "ends", "segment_width"])
        ),
        field!(
            "base_radius",
            real_or_auto(1e-5, 100.0),
            "m",
            "radius at the foot; auto: follows from the tips (pipe model with tip_radius), the grammar or the slenderness",
            base_radius_m,
            details(
                "Of the thickest stem, before any flare. With the pipe model it scales all wood; a \
                 tip_radius beside it is only the least that twigs have. A tree of 15 m has 0.09 to 0.25 m, \
                 from a dense stand to the open."
            ),
            see_also(&["tip_radius", "slenderness", "flare"])
        ),
        field!(
            "tip_radius",
            real_or_auto(1e-5, 10.0),
            "m",
            "radius of the thinnest twigs; auto: follows from the base",
            tip_radius_m,
            details(
                "Alone, with the pipe model, it decides the trunk: the base is tip_radius times the n-th \
                 root of the number of tips, so that 4000 tips of 0.003 m stand on a trunk of 0.19 m with \
                 radius_exponent=2. With base_radius, or another rule, nothing is thinner than this and the \
                 rest stays. Of a scan whose radii are measured it says how thick its twigs are, which wood too \
                 thin to be measured tapers to (auto: 1.5 mm)."
            ),
            see_also(&["base_radius", "radius_exponent", "twig_taper"])
        ),
        field!(
            "slenderness",
            real(1.0, 1000.0),
            "",
            "height / diameter at the foot, where neither radius is given: 30-50 in the open, 80-100 in dense stands",
            slenderness,
            details(
                "Foresters' h/d. A tree 15 m high gets a trunk of 0.25 m radius at 30, of 0.09 m at 80. The \
                 height is that of the tree itself, from its lowest node to its highest, so that trunk and \
                 crown scale together."
            ),
            see_also(&["base_radius", "tip_radius"])
        ),
        field!(
            "radius_exponent",
            real(1.0, 10.0),
            "",
            "n of the pipe model r^n = sum of children's r^n: larger is a thinner trunk",
            radius_exponent,
            details(
                "2 keeps the area of the cross-section above and below a fork (Leonardo's rule); measured \
                 trees have 1.8 to 2.3. The trunk is what stays where base_radius or slenderness decides: \
                 then 3 makes stout twigs and 1.5 hair-thin ones. With tip_radius the twigs stay and the \
                 trunk changes."
            ),
            see_also(&["width", "tip_radius", "base_radius", "angle_share"])
        ),
        field!(
            "angle_share",
            real(0.0, 1.0),
            "",
            "for the pipe model: how much less of a fork goes to children that turn away; 0: tips alone count",
            angle_share,
            details(
                "At 1 a child that leaves at a right angle claims half of what it would get straight on, so \
                 that leaders keep their thickness and what turns aside starts thin; at 0.5 three quarters. \
                 Sums at forks stay those of the pipe model. The tendency is that of Murray 1926: of two \
                 vessels the thinner turns more."
            ),
            see_also(&["radius_exponent", "width"])
        ),
        field!(
            "order_ratio",
            real(0.01, 1.0),
            "",
            "for width=order: radius of a branch / radius of the one it leaves",
            order_ratio,
            details(
                "0.5 halves the radius from order to order: a base of 0.2 m has twigs of 0.025 m in the \
                 third. 0.8 leaves limbs nearly as thick as the trunk."
            ),
            see_also(&["width", "taper_base_min"])
        ),
        field!(
            "taper_base_min",
            real(0.01, 1.0),
            "",
            "for width=taper: least radius of a branch's base / radius of its parent there",
            taper_base.min,
            details(
                "For each branch a share between this and taper_base_max is drawn, keyed by its place. Near \
                 to each other (0.7 and 0.75) all branches look alike; far apart (0.2 and 0.9) limbs and \
                 twigs leave side by side."
            ),
            see_also(&["taper_base_max", "taper_tip_min", "width"])
        ),
        field!(
            "taper_base_max",
            real(0.01, 1.0),
            "",
            "for width=taper: largest radius of a branch's base / radius of its parent there",
            taper_base.max,
            see_also(&["taper_base_min", "width"])
        ),
        field!(
            "taper_tip_min",
            real(0.0, 1.0),
            "",
            "for width=taper: least radius of a tip / radius of its branch's base",
            taper_tip.min,
            details(
                "For each branch a share between this and taper_tip_max is drawn; the radius falls evenly \
                 from base to tip. 0.1 to 0.3 looks grown, 1 makes rods."
            ),
            see_also(&["taper_tip_max", "taper_base_min", "width"])
        ),
        field!(
            "taper_tip_max",
            real(0.0, 1.0),
            "",
            "for width=taper: largest radius of a tip / radius of its branch's base",
            taper_tip.max,
            see_also(&["taper_tip_min", "width"])
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
            )
            .details(
                "Runions et al. 2007, section 4, decimate the nodes, move each halfway towards its parent, \
                 which makes branching angles smaller, and subdivide what is left. prune decimate relocate \
                 subdivide suits most grown trees. What growth leaves has segments of one length and \
                 corners at each. Radii are found afterwards, and obstacles are not entered.",
            )
            .see_also(&["relocate_share", "decimate_tolerance", "smooth_rounds", "subdivisions"]),
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
            prune_nodes,
            see_also(&["refine"])
        ),
        field!(
            "decimate_tolerance",
            real(0.0, 100.0),
            "segments",
            "for refine=decimate: how far axes may move, in mean segment lengths",
            decimate_tolerance,
            details(
                "0 drops nodes of straight stretches only. 0.25 cannot be seen and makes trees lighter; at \
                 1 and more limbs get corners, which subdivide then makes long curves of."
            ),
            see_also(&["refine", "subdivisions", "step"])
        ),
        field!(
            "relocate_share",
            real(0.0, 1.0),
            "",
            "for refine=relocate: how far each node goes towards its parent; 0.5 is halfway",
            relocate_share,
            details(
                "Each segment becomes a mean of itself and the one before it, so that branches leave at \
                 smaller angles and run along their parents first. 0.5 is Runions et al. 2007; tips lose as \
                 large a share of their last segment."
            ),
            see_also(&["refine", "smooth_rounds"])
        ),
        field!(
            "smooth_rounds",
            integer(1, 100),
            "",
            "for refine=smooth: how often each node is averaged with its neighbours",
            smooth_rounds,
            details(
                "A round takes each node halfway onto the line between its neighbours along the axis; feet \
                 and tips stay. 2 takes the zigzag out of growth, 20 and more straighten limbs."
            ),
            see_also(&["refine", "relocate_share", "subdivisions"])
        ),
        field!(
            "subdivisions",
            integer(1, 6),
            "",
            "for refine=subdivide: how often each segment is halved",
            subdivisions,
            details(
                "Each doubles the nodes and rounds corners off, towards a cubic B-spline (Lane & Riesenfeld \
                 1980). 1 is enough for most trees; beyond 2 there are only more nodes."
            ),
            see_also(&["refine", "rings", "step"])
        ),
        field!(
            "trunk_curve",
            Kind::Reals { min: -1000.0, max: 1000.0, most: MOST_CONTROLS * 3 },
            "m",
            "control points x y z of a Bezier curve that the trunk is bent onto, from its foot, like 0 3 0 1 6 0; 0: as grown",
            trunk_curve,
            details(
                "The foot is the first control point, the others count from there: 0 3 0 1 6 0 rises \
                 straight and then leans to +X. The stem is stretched to the length of the curve; what \
                 hangs on it keeps its shape and turns as the stem turns."
            ),
            see_also(&["sway", "gnarl", "refine"])
        ),
        field!(
            "sway",
            real(0.0, 1.0),
            "",
            "how far trunk and limbs swing to the side / their length, at random",
            sway,
            details(
                "Slow waves, a little less and a little more than one over an axis' length; each axis sets \
                 out in its old direction. 0.03 takes the ruler out of a trunk, 0.1 makes it lean and come \
                 back, 0.3 snakes."
            ),
            see_also(&["gnarl", "trunk_curve"])
        ),
        field!(
            "gnarl",
            real(0.0, 4.0),
            "",
            "how far wood bends to and fro over a few times its thickness / that thickness: old wood is gnarled",
            gnarl,
            details(
                "Bends are as long as nine radii of the wood, so that trunk and twigs each have their \
                 measure. 0.3 is a tree of some age, 1 and more an old olive or a bonsai. It needs nodes to \
                 bend: let subdivide give it some where segments are longer than the bends."
            ),
            see_also(&["trunk_gnarl", "sway", "refine", "subdivisions"])
        ),
        field!(
            "trunk_gnarl",
            real(0.0, 1.0),
            "",
            "how much of gnarl a trunk has below its lowest limb; 0: the bole is as it grew",
            trunk_gnarl,
            details(
                "What leant or broke in a young stem is overgrown: an oak's bole is straight below crooked \
                 limbs (0.2), an olive's or an old apple's is not (1). A limb is a branch of at least 0.15 of \
                 the trunk's thickness there; above the lowest the trunk takes on the whole gnarl within \
                 nine radii. A trunk without limbs is all bole; of stems that part at the ground only one has one."
            ),
            see_also(&["gnarl", "sway", "trunk_curve"])
        ),
        field!(
            "epicormic",
            real(0.0, 20.0),
            "1/m",
            "burls with leafy shoots on a metre of trunk, less than half as many on thick limbs; 0: none",
            side.epicormic_per_m,
            details(
                "Buds that slept under the bark sprout where light comes to old wood: oaks, limes, willows and poplars. \
                 A burl bears 3 to 7 shoots with the leaves of the tree, in its seasons; they are axes like all others, \
                 in every format, count as foliage where the crown's base is measured, and come with the last step of \
                 growth: a younger tree (age) has none. 0.3 to 1 suits an oak, 4 a lime full of them."
            ),
            see_also(&["epicormic_length", "epicormic_range", "dead_twigs"])
        ),
        field!(
            "epicormic_length",
            real(0.01, 10.0),
            "m",
            "mean length of epicormic shoots",
            side.epicormic_length_m,
            see_also(&["epicormic"])
        ),
        field!(
            "epicormic_range",
            Kind::Reals { min: 0.0, max: 1.0, most: 2 },
            "",
            "between which shares of the tree's height epicormic shoots stand",
            side.epicormic_range,
            see_also(&["epicormic"])
        ),
        field!(
            "dead_twigs",
            real(0.0, 100.0),
            "1/m",
            "dead twigs on a metre of stem, half as many on the inner parts of its limbs; 0: none",
            side.dead_per_m,
            details(
                "What the shade of the crown has killed stays on conifers for years: fine, grey, drooping, without a \
                 needle, below the living crown and inside of it. They are axes like all others, in dead_color, and \
                 come with the last step of growth: a younger tree (age) has none. 3 to 8 suits a spruce, 1 to 2 a pine \
                 or larch; dead_below takes the needles of low limbs."
            ),
            see_also(&["dead_length", "dead_range", "dead_below", "dead_color", "stubs"])
        ),
        field!(
            "dead_length",
            real(0.01, 10.0),
            "m",
            "mean length of dead twigs on the stem; those on limbs are less than half as long",
            side.dead_length_m,
            see_also(&["dead_twigs"])
        ),
        field!(
            "dead_range",
            Kind::Reals { min: 0.0, max: 1.0, most: 2 },
            "",
            "between which shares of the tree's height dead twigs leave",
            side.dead_range,
            see_also(&["dead_twigs"])
        ),
        field!(
            "dead_below",
            real(0.0, 1.0),
            "",
            "limbs that leave the stem below this share of the tree's height are dead, with all that they bear; 0: none",
            side.dead_below,
            details(
                "They are as they grew, in dead_color and without leaves: the lowest whorls of a spruce that stood in \
                 a wood. Not in younger trees (age). With dead_twigs it makes a skirt below the living crown."
            ),
            see_also(&["dead_twigs", "dead_color", "stubs"])
        ),
    ];
}
