//! Knobs of `[surface]` that change nothing.

use linden_plant::surface::{Ends, Junction};
use linden_skeleton::{AxisRule, Width, WidthSteps};

use super::{ONE_BARK, Rule, when};

pub(super) static RULES: &[Rule] = &[
    Rule {
        knobs: &["junction_detail"],
        why: |preset| {
            when(preset.dressing.tubes.junction != Junction::Watertight, "it is for junction=watertight")
        },
    },
    Rule {
        knobs: &["width_steps", "width_smoothing"],
        why: |preset| {
            let traits = preset.generator.traits(&preset.wood);
            // Where all go on in brackets, the wood of an axis that ends runs on into a thinner one.
            when(
                preset.settled_width() == Some(Width::Order) && traits.axes == AxisRule::Thickest,
                "width=order keeps one radius all along an axis",
            )
        },
    },
    Rule {
        knobs: &["ground_slope"],
        why: |preset| {
            when(
                preset.wood.width_steps == WidthSteps::Cylinder
                    && preset.dressing.tubes.features.roots.count == 0,
                "width_steps=cylinder keeps stems as they are, and surface_roots is 0",
            )
        },
    },
    Rule {
        knobs: &["foot_depth"],
        why: |preset| {
            when(
                preset.wood.width_steps == WidthSteps::Cylinder,
                "width_steps=cylinder keeps stems as they are",
            )
        },
    },
    Rule {
        knobs: &["width_smoothing", "smooth_wood"],
        why: |preset| {
            when(preset.wood.width_steps == WidthSteps::Cylinder, "width_steps=cylinder keeps its steps")
        },
    },
    Rule {
        knobs: &["flare_height", "flare_ridges", "flare_depth"],
        why: |preset| when(preset.dressing.tubes.features.flare == 0.0, "flare is 0"),
    },
    Rule {
        knobs: &["flare_height"],
        why: |preset| {
            when(preset.dressing.tubes.features.flare_height_m == Some(0.0), "a flare of no height is none")
        },
    },
    Rule {
        knobs: &["flare_depth"],
        why: |preset| when(preset.dressing.tubes.features.flare_ridges == 0, "flare_ridges is 0"),
    },
    Rule {
        knobs: &["flare_ridges"],
        why: |preset| when(preset.dressing.tubes.features.flare_depth == 0.0, "flare_depth is 0"),
    },
    Rule {
        knobs: &["trunk_lobe_depth"],
        why: |preset| when(preset.dressing.tubes.features.lobes == 0, "trunk_lobes is 0"),
    },
    Rule {
        knobs: &["trunk_lobes"],
        why: |preset| when(preset.dressing.tubes.features.lobe_depth == 0.0, "trunk_lobe_depth is 0"),
    },
    Rule {
        knobs: &["root_reach", "root_rise"],
        why: |preset| when(preset.dressing.tubes.features.roots.count == 0, "surface_roots is 0"),
    },
    Rule {
        knobs: &["stub_length"],
        why: |preset| when(preset.dressing.tubes.features.stubs.per_m == 0.0, "stubs is 0"),
    },
    Rule {
        knobs: &["ends_above"],
        why: |preset| {
            when(preset.dressing.tubes.features.ends == Ends::Bud, "all ends are buds: it is for other ends")
        },
    },
    Rule {
        knobs: &["epicormic_length", "epicormic_range"],
        why: |preset| when(preset.refinement.side.epicormic_per_m == 0.0, "epicormic is 0"),
    },
    Rule {
        knobs: &["dead_length", "dead_range"],
        why: |preset| when(preset.refinement.side.dead_per_m == 0.0, "dead_twigs is 0"),
    },
    Rule {
        knobs: &["dead_color"],
        why: |preset| {
            let side = &preset.refinement.side;
            when(side.dead_per_m == 0.0 && side.dead_below == 0.0, "dead_twigs and dead_below are 0")
        },
    },
    Rule {
        knobs: &["dead_color"],
        why: |preset| when(preset.dressing.tubes.junction == Junction::Watertight, ONE_BARK),
    },
];
