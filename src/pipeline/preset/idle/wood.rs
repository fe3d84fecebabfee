//! Knobs of `[wood]` that change nothing.

use linden_skeleton::generator::RadiiFrom;
use linden_skeleton::{AxisRule, Width};

use super::{Rule, when};

pub(super) static RULES: &[Rule] = &[
    Rule {
        knobs: &["width"],
        why: |preset| {
            let gives_none = preset.generator.traits(&preset.wood).radii == RadiiFrom::Rule;
            when(
                gives_none && preset.wood.width == Width::Grammar,
                "this generator gives no widths: width=grammar is as width=pipe",
            )
        },
    },
    Rule {
        knobs: &["axes"],
        why: |preset| {
            let axes = preset.generator.traits(&preset.wood).axes;
            when(
                axes == AxisRule::Thickest,
                "it is for grammars: nothing else says which branch goes on but its thickness",
            )
        },
    },
    Rule {
        knobs: &["slenderness"],
        why: |preset| match preset.settled_width() {
            Some(Width::Grammar) if preset.grows_by().id() == "lsystem" => {
                Some("the grammar decides how thick the wood is; width=pipe goes by the height")
            }
            Some(Width::Grammar) => {
                Some("the generator decides how thick the wood is; width=pipe goes by the height")
            }
            None => Some(OF_SCANS),
            _ if preset.wood.base_radius_m.is_some() => Some("base_radius decides how thick the wood is"),
            Some(Width::Pipe) if preset.wood.tip_radius_m.is_some() => {
                Some("tip_radius decides how thick the wood is")
            }
            _ => None,
        },
    },
    Rule {
        knobs: &["radius_exponent"],
        why: |preset| when(!preset.is_width(Width::Pipe), "it is for width=pipe"),
    },
    Rule {
        knobs: &["angle_share"],
        why: |preset| match preset.settled_width() {
            None => Some(OF_SCANS),
            Some(width) => when(width != Width::Pipe, "it is for width=pipe"),
        },
    },
    Rule {
        knobs: &["order_ratio"],
        why: |preset| when(preset.wood.width != Width::Order, "it is for width=order"),
    },
    Rule {
        knobs: &["taper_base_min", "taper_base_max", "taper_tip_min", "taper_tip_max"],
        why: |preset| when(preset.wood.width != Width::Taper, "it is for width=taper"),
    },
    Rule {
        knobs: &["prune_nodes"],
        why: |preset| {
            when(!preset.refines("prune"), "it is for refine=prune").or(when(
                preset.generator.traits(&preset.wood).knows_use,
                "prune takes the twigs that caught no point, whatever their length",
            ))
        },
    },
    Rule {
        knobs: &["decimate_tolerance"],
        why: |preset| when(!preset.refines("decimate"), "it is for refine=decimate"),
    },
    Rule {
        knobs: &["relocate_share"],
        why: |preset| when(!preset.refines("relocate"), "it is for refine=relocate"),
    },
    Rule {
        knobs: &["smooth_rounds"],
        why: |preset| when(!preset.refines("smooth"), "it is for refine=smooth"),
    },
    Rule {
        knobs: &["subdivisions"],
        why: |preset| when(!preset.refines("subdivide"), "it is for refine=subdivide"),
    },
    Rule {
        knobs: &["trunk_gnarl"],
        why: |preset| when(preset.refinement.gnarl <= 0.0, "it is a share of gnarl, which is 0"),
    },
];

/// Why what decides the radii of other trees may not decide those of a scanned one.
const OF_SCANS: &str = "the points on the bark say how thick the wood is, where there are enough; scan_radius=pipe leaves that to the pipe model";
