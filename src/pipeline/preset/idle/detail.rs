//! Knobs of `[detail]` that change nothing.

use linden_plant::settings::{Form, LodForm, LodForms};

use super::{Rule, when};

pub(super) static RULES: &[Rule] = &[
    Rule {
        knobs: &["triangles", "lods", "lod_ratio"],
        why: |preset| {
            when(!preset.dressing.detail.budgets().is_empty(), "lod_triangles says how many each level has")
        },
    },
    Rule {
        knobs: &["lod_ratio"],
        why: |preset| when(preset.dressing.detail.levels() == 1, "there is one level: it is for lods"),
    },
    Rule {
        knobs: &["branch_cards", "card_size"],
        why: |preset| {
            when(preset.dressing.detail.is_whole(), "all leaves are shown: it is for triangles and lods")
        },
    },
    Rule {
        knobs: &["lod_form", "lod_weight"],
        why: |preset| {
            when(
                preset.dressing.detail.is_whole(),
                "there is one level, with everything: it is for triangles and lods",
            )
        },
    },
    Rule {
        knobs: &["lod_form"],
        why: |preset| {
            let all_cards = |forms: &LodForms| {
                !forms.0.is_empty() && forms.0.iter().all(|form| *form == LodForm::BranchCard)
            };
            let is_idle =
                !preset.dressing.detail.branch_cards && all_cards(&preset.dressing.foliage.first.lod_forms);
            when(is_idle, "branch_cards is false")
        },
    },
    Rule {
        knobs: &["lod_weight"],
        why: |preset| {
            let kinds = preset.dressing.foliage.kinds().filter(|kind| kind.form != Form::None).count();
            when(kinds < 2 && !preset.places_organs(), "there is one kind: weights count by their ratios")
        },
    },
    Rule {
        knobs: &["card_size"],
        why: |preset| when(!preset.dressing.detail.branch_cards, "branch_cards is false"),
    },
    Rule {
        knobs: &["billboard_size"],
        why: |preset| when(preset.dressing.detail.billboard == 0, "billboard is 0"),
    },
];
