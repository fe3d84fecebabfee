//! Knobs of `[foliage]` that change nothing.

use linden_plant::foliage::Calendar;
use linden_plant::settings::{Arrangement, Cluster, FoliageSettings, Form, LeafKind, TURNING};
use linden_plant::texture::leaf::{LeafLook, Outline};

use super::{PLACES, Rule, when};

pub(super) static RULES: &[Rule] = &[
    Rule {
        knobs: &["season", "leaf_size", "leaf_seed"],
        why: |preset| {
            when(preset.dressing.foliage.kinds().all(|kind| kind.form == Form::None), "leaf_form is none")
        },
    },
    Rule {
        knobs: &["season"],
        why: |preset| {
            let mut kinds = preset.dressing.foliage.kinds().filter(|kind| kind.form != Form::None);
            when(kinds.all(|kind| !Calendar::of(kind).changes()), "all leaves are evergreen")
        },
    },
    Rule {
        knobs: &["leaf_colors"],
        why: |preset| {
            when(
                preset.dressing.foliage.first.form == Form::None && !preset.places_organs(),
                "leaf_form is none, and no grammar places organs",
            )
        },
    },
    Rule {
        knobs: LOOKS,
        why: |preset| when(preset.dressing.foliage.first.form == Form::None, "leaf_form is none"),
    },
    Rule {
        knobs: &[
            "leaves",
            "leaf_dist",
            "leaf_scale",
            "leaf_scale_v",
            "leaf_bend",
            "leaf_quality",
            "leaf_stem",
        ],
        // Of Weber and Penn's trees alone, whose leaves need a form.
        why: |preset| when(preset.dressing.foliage.first.form == Form::None, "leaf_form is none"),
    },
    Rule { knobs: PLACES, why: |preset| when(!preset.has_first_places(), "leaf_form is none") },
    Rule {
        knobs: &["leaf_max_age"],
        why: |preset| {
            when(
                !preset.generator.traits(&preset.wood).tells_age,
                "all segments of this grammar are born in the last derivation",
            )
        },
    },
    Rule {
        knobs: &["leaf_whorl"],
        why: |preset| {
            let is_whorled = preset.dressing.foliage.first.arrangement == Arrangement::Whorled;
            when(!is_whorled, "it is for leaf_arrangement=whorled")
        },
    },
    Rule {
        knobs: &["twig_length", "twig_leaves", "twig_tuft", "twig_shoots"],
        why: |preset| when(preset.dressing.foliage.first.form != Form::Twig, "it is for leaf_form=twig"),
    },
    Rule {
        knobs: &["twig_shoots"],
        why: |preset| {
            when(
                preset.dressing.foliage.first.twig_leaves < 4,
                "a side shoot needs a twig of 4 leaves (twig_leaves)",
            )
        },
    },
    Rule {
        knobs: &["leaves_per_m"],
        why: |preset| {
            let has_grid = preset.dressing.foliage.first.grid.first().is_some_and(|&along| along >= 0.5);
            when(has_grid, "leaf_grid stands in its place")
        },
    },
    Rule {
        knobs: &["evergreen"],
        why: |preset| {
            let FoliageSettings { season, first, .. } = &preset.dressing.foliage;
            let LeafKind { season_range, turn_range, season_fade, .. } = LeafKind::default();
            let is_usual = first.season_range == season_range
                && first.turn_range == turn_range
                && first.season_fade == season_fade;
            let is_summer = is_usual && (SUMMER..=TURNING[0]).contains(season);
            when(is_summer, "in summer (season 0.25 to 0.54) all leaves are alike")
        },
    },
    Rule {
        knobs: &["leaf_lobes", "leaf_lobe_depth", "leaf_margin", "leaf_petiole", "back_colors"],
        why: |preset| {
            when(
                preset.dressing.foliage.first.form == Form::Mesh,
                "it is for drawn leaves, and leaf_form is mesh",
            )
        },
    },
    Rule {
        knobs: &["leaf_translucency"],
        why: |preset| {
            let LeafKind { back_colors, picture, form, .. } = &preset.dressing.foliage.first;
            let is_drawn = picture.is_none() && *form != Form::Mesh;
            when(
                is_drawn && back_colors.is_some(),
                "back_colors gives leaves two faces, and no light passes both",
            )
        },
    },
    Rule {
        knobs: &["leaf_lobes"],
        why: |preset| {
            let LeafKind { outline, form, .. } = &preset.dressing.foliage.first;
            when(!outline.has_lobes() && *form != Form::Fan, "leaves of this leaf_outline have no lobes")
        },
    },
    Rule {
        knobs: &["leaf_lobe_depth"],
        why: |preset| {
            when(
                !preset.dressing.foliage.first.outline.has_bays(),
                "leaves of this leaf_outline have no bays between lobes",
            )
        },
    },
    Rule {
        knobs: &["leaf_margin"],
        why: |preset| {
            when(
                !preset.dressing.foliage.first.outline.has_margin(),
                "leaves of this leaf_outline have no teeth",
            )
        },
    },
    Rule {
        knobs: &["leaf_petiole"],
        why: |preset| {
            when(!preset.dressing.foliage.first.outline.has_petiole(), "this leaf_outline has no stalk")
        },
    },
    Rule {
        knobs: &["autumn_colors", "turn_range"],
        why: |preset| {
            let FoliageSettings { season, first, .. } = &preset.dressing.foliage;
            let turns_from = first.turn_range.iter().copied().fold(f64::INFINITY, f64::min);
            when(first.evergreen, "the leaves are evergreen").or(when(
                *season < turns_from,
                "no leaf turns before turn_range begins (season=0.54, where it says nothing else)",
            ))
        },
    },
    Rule {
        knobs: &["turn_range"],
        why: |preset| {
            let LeafKind { outline, form, autumn_colors, .. } = &preset.dressing.foliage.first;
            let has_usual = *form != Form::Mesh && !LeafLook::new(*outline).autumn_colors.is_empty();
            when(autumn_colors.is_none() && !has_usual, "this kind has no autumn_colors")
        },
    },
    Rule {
        knobs: &["young_colors"],
        why: |preset| {
            let FoliageSettings { season, first, .. } = &preset.dressing.foliage;
            when(first.evergreen, "the leaves are evergreen").or(when(
                Calendar::of(first).ripeness(*season as f32) >= 1.0,
                "the leaves are no longer young in this season: it is for a quarter of the year after season_range begins",
            ))
        },
    },
    Rule {
        knobs: &["season_fade"],
        why: |preset| {
            let first = &preset.dressing.foliage.first;
            when(!Calendar::of(first).changes(), "the leaves are evergreen, all the year")
        },
    },
    Rule {
        knobs: &["petal_rows"],
        why: |preset| {
            let LeafKind { outline, form, .. } = &preset.dressing.foliage.first;
            when(*outline != Outline::Blossom || *form == Form::Mesh, "it is for leaf_outline=blossom")
        },
    },
    Rule {
        knobs: &["cluster_count", "cluster_length", "cluster_stalk", "cluster_facing"],
        why: |preset| when(preset.dressing.foliage.first.cluster == Cluster::None, "cluster is none"),
    },
    Rule {
        knobs: OUT_OF_SEASON,
        why: |preset| {
            let FoliageSettings { season, first, .. } = &preset.dressing.foliage;
            when(
                !Calendar::of(first).is_there(*season as f32),
                "season_range says that none of them is there in this season",
            )
        },
    },
    Rule {
        knobs: &[
            "leaf_outline",
            "leaf_lobes",
            "leaf_lobe_depth",
            "leaf_margin",
            "leaf_petiole",
            "leaf_colors",
            "back_colors",
            "autumn_colors",
            "young_colors",
            "turn_range",
            "petal_rows",
            "leaf_tint_spread",
            "leaf_shade",
        ],
        why: |preset| {
            when(
                preset.dressing.foliage.first.picture.is_some(),
                "leaf_picture stands in place of the drawn one",
            )
        },
    },
    Rule {
        knobs: &["leaf_size", "leaf_seed"],
        why: |preset| {
            let mut drawn = preset.dressing.foliage.kinds().filter(|kind| kind.form != Form::None);
            let is_given = drawn.all(|kind| kind.picture.is_some() || kind.form == Form::Mesh);
            when(is_given, "all pictures of leaves are given")
        },
    },
];

/// What says how a leaf of the first kind looks.
const LOOKS: &[&str] = &[
    "leaf_outline",
    "leaf_length",
    "leaf_width",
    "leaf_size_spread",
    "leaf_lobes",
    "leaf_lobe_depth",
    "leaf_margin",
    "leaf_petiole",
    "twig_length",
    "twig_leaves",
    "twig_tuft",
    "twig_shoots",
    "leaf_angle",
    "leaf_droop",
    "leaf_level",
    "leaf_up",
    "leaf_jitter",
    "leaf_offset",
    "leaf_normals",
    "back_colors",
    "autumn_colors",
    "leaf_tint_spread",
    "leaf_shade",
    "leaf_translucency",
    "evergreen",
    "leaf_keep",
    "season_range",
    "season_fade",
    "young_colors",
    "turn_range",
    "petal_rows",
    "cluster",
    "cluster_count",
    "cluster_length",
    "cluster_stalk",
    "cluster_facing",
    "lod_form",
    "lod_weight",
];

/// What changes nothing of leaves that are not there: most of what says how they look.
const OUT_OF_SEASON: &[&str] = &[
    "leaf_outline",
    "leaf_length",
    "leaf_width",
    "leaf_size_spread",
    "leaf_angle",
    "leaf_droop",
    "leaf_level",
    "leaf_up",
    "leaf_jitter",
    "leaf_offset",
    "leaf_normals",
    "leaf_keep",
    "back_colors",
    "autumn_colors",
    "young_colors",
    "turn_range",
    "petal_rows",
    "cluster",
    "cluster_count",
    "cluster_length",
    "cluster_stalk",
    "cluster_facing",
    "lod_form",
    "lod_weight",
];

/// The season from which leaves are full-grown and green.
const SUMMER: f64 = 0.25;
