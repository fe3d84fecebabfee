//! Knobs of `[bark]` that change nothing.

use linden_plant::settings::{BarkSettings, DetailSettings, Dressing};
use linden_plant::surface::Junction;
use linden_plant::wind::Wind;

use super::{ONE_BARK, Rule, when};

const FOOT: &[&str] = &["foot_height", "foot_bark", "foot_color"];

/// Why the trunk of a small level is in one part.
const SMALL: &str = "levels of fewer than 5000 triangles have none";

fn is_small(detail: &DetailSettings) -> bool {
    (1..BarkSettings::LEAST_TRIANGLES).contains(&detail.finest())
}

pub(super) static RULES: &[Rule] = &[
    Rule {
        knobs: &["bark", "bark_color", "bark_grain", "bark_seed"],
        why: |preset| {
            when(preset.dressing.bark.picture.is_some(), "bark_picture stands in place of the drawn one")
        },
    },
    Rule {
        knobs: &["bark_relief", "bark_size"],
        why: |preset| {
            when(
                preset.dressing.bark.picture.is_some() && preset.dressing.bark.normal.is_some(),
                "the pictures are given",
            )
        },
    },
    Rule {
        knobs: &["bark_lenticels"],
        why: |preset| {
            let bark = &preset.dressing.bark;
            let has_thin = !bark.thin_barks().is_empty();
            when(
                bark.picture.is_some() && !has_thin,
                "bark_picture stands in place of the drawn one, and limbs and twigs have no bark of their own",
            )
        },
    },
    Rule {
        knobs: &["limb_bark", "limb_color"],
        why: |preset| when(preset.dressing.bark.limbs.radius_m == 0.0, "limb_radius is 0"),
    },
    Rule {
        knobs: &["twig_bark", "twig_color"],
        why: |preset| when(preset.dressing.bark.twigs.radius_m == 0.0, "twig_radius is 0"),
    },
    Rule {
        knobs: &["limb_radius", "limb_bark", "limb_color", "twig_radius", "twig_bark", "twig_color"],
        why: |preset| when(preset.dressing.tubes.junction == Junction::Watertight, ONE_BARK),
    },
    Rule {
        knobs: &["foot_bark", "foot_color"],
        why: |preset| when(preset.dressing.tubes.features.foot_height_m == 0.0, "foot_height is 0"),
    },
    Rule {
        knobs: FOOT,
        why: |preset| {
            let Dressing { bark, detail, tubes, .. } = &preset.dressing;
            let is_none = tubes.features.foot_height_m > 0.0 && tubes.foot_edge().is_none();
            when(!bark.is_drawn(), "the trunk's bark is a picture of yours")
                .or(when(tubes.junction == Junction::Watertight, ONE_BARK))
                .or(when(is_small(detail), SMALL))
                .or(when(is_none, "foot_height is less than half of bark_tile"))
        },
    },
    Rule {
        knobs: &["moss_side", "moss_height", "moss_radius", "moss_color"],
        why: |preset| when(preset.dressing.bark.moss.amount == 0.0, "moss is 0"),
    },
    Rule {
        knobs: &["moss", "moss_side", "moss_height", "moss_radius", "moss_color"],
        why: |preset| when(preset.dressing.tubes.junction == Junction::Watertight, ONE_BARK),
    },
    Rule {
        knobs: &["moss", "moss_side", "moss_height", "moss_radius", "moss_color"],
        why: |preset| when(is_small(&preset.dressing.detail), SMALL),
    },
    Rule {
        knobs: &["bark_relief_height"],
        why: |preset| {
            let Dressing { bark, detail, wind, .. } = &preset.dressing;
            when(
                bark.picture.is_some() || bark.normal.is_some(),
                "it is for drawn bark, and a picture stands in its place",
            )
            .or(when(
                detail.levels() > 1 || detail.finest() > 0,
                "it is for one level of detail without a budget of triangles",
            ))
            .or(when(wind.wind != Wind::Off, "it is for wood that stands still, and wind moves it"))
        },
    },
];
