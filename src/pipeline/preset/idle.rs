//! Knobs that change nothing: which of them a preset as it stands does not listen to, and why.
//!
//! Most knobs hang on another one: `stems` is for shrubs, `junction_detail` for watertight wood. Whoever
//! turns one alone would see nothing happen, so it is said. Each rule says what has to be turned as well.
//! What only shows in the finished tree (a `tip_radius` below that of any twig) is no business of these
//! rules.

use linden_plant::foliage::Calendar;
use linden_plant::settings::{
    Arrangement, Cluster, Dressing, FoliageSettings, Form, LeafKind, LodForm, LodForms, TURNING,
};
use linden_plant::surface::{Ends, Junction};
use linden_plant::texture::leaf::{LeafLook, Outline};
use linden_plant::wind::Wind;
use linden_skeleton::generator::RadiiFrom;
use linden_skeleton::{AxisRule, Width, WidthSteps};

use super::{Preset, Section};

/// Some knobs, and why they change nothing; `None` where they do.
struct Rule {
    knobs: &'static [&'static str],
    why: fn(&Preset) -> Option<&'static str>,
}

impl Preset {
    /// Why a knob changes nothing in this preset as it stands, and what would let it; `None` where it has
    /// an effect, or where that only shows in the tree.
    ///
    /// ```
    /// let mut fir = linden_pipeline::preset::builtin("fir").unwrap().load()?;
    /// fir.set("junction_detail", "64")?;
    /// assert_eq!(fir.idle("junction_detail"), Some("it is for junction=watertight"));
    /// fir.set("junction", "watertight")?;
    /// assert_eq!(fir.idle("junction_detail"), None);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn idle(&self, knob: &str) -> Option<&'static str> {
        if let Some(row) = self.kind_knob(knob).ok().flatten()
            && let Section::Kind(kind) = row.section
        {
            return self.idle_of_kind(kind, row.short_name());
        }
        let of_others =
            || RULES.iter().filter(|rule| rule.knobs.contains(&knob)).find_map(|rule| (rule.why)(self));
        self.generator.idle(knob, &self.wood).or_else(of_others)
    }

    /// The same for a knob of a further kind of foliage.
    fn idle_of_kind(&self, number: usize, knob: &str) -> Option<&'static str> {
        let kind = self.dressing.foliage.also.get(number)?;
        if kind.share > 0.0 && PLACES.contains(&knob) {
            return Some("the kind takes places of the first one: it is for share=0");
        }
        // What holds for the first kind holds for each.
        let mut swapped = self.clone();
        let FoliageSettings { first, also, .. } = &mut swapped.dressing.foliage;
        std::mem::swap(first, &mut also[number]);
        swapped.idle(knob)
    }

    /// A line for each of some knobs that changes nothing: `stems changes nothing: it is for habit=shrub`.
    pub fn idle_notes<'k>(&self, knobs: impl IntoIterator<Item = &'k str>) -> Vec<String> {
        let mut notes: Vec<String> = Vec::new();
        for knob in knobs {
            if let Some(why) = self.idle(knob) {
                let note = format!("{knob} changes nothing: {why}");
                if !notes.contains(&note) {
                    notes.push(note);
                }
            }
        }
        notes
    }

    /// The rule for radii that holds; `None` for a scan, whose points may say how thick the wood is.
    fn settled_width(&self) -> Option<Width> {
        let gives_radii = match self.generator.traits(&self.wood).radii {
            RadiiFrom::Rule => false,
            RadiiFrom::Generator => true,
            RadiiFrom::Measured => {
                return matches!(self.wood.width, Width::Order | Width::Taper).then_some(self.wood.width);
            }
        };
        Some(self.wood.settled(gives_radii, false).width)
    }

    fn is_width(&self, width: Width) -> bool {
        self.settled_width().is_none_or(|settled| settled == width)
    }

    fn refines(&self, step: &str) -> bool {
        self.refinement.steps.iter().any(|known| known.name == step)
    }

    /// Whether leaves of the first kind, or of kinds that take places from it, grow in its places.
    fn has_first_places(&self) -> bool {
        let takes = |kind: &LeafKind| kind.form != Form::None && kind.share > 0.0;
        self.dressing.foliage.first.form != Form::None || self.dressing.foliage.also.iter().any(takes)
    }

    /// Whether another seed may give another tree, its leaves and its wind included.
    fn leaves_to_chance(&self) -> bool {
        let Dressing { foliage, wind, .. } = &self.dressing;
        let bears_leaves = foliage.kinds().any(|kind| kind.form != Form::None) || self.places_organs();
        let wanders = self.refines("wander") && (self.refinement.sway > 0.0 || self.refinement.gnarl > 0.0);
        let tapers = self.settled_width().is_none_or(|width| matches!(width, Width::Taper | Width::Order));
        self.has_spreads()
            || self.generator.draws()
            || bears_leaves
            || wanders
            || tapers
            || wind.wind != Wind::Off
    }

    fn places_organs(&self) -> bool {
        self.generator.traits(&self.wood).places_organs
    }
}

/// `Some(why)` where it holds.
fn when(holds: bool, why: &'static str) -> Option<&'static str> {
    holds.then_some(why)
}

/// For all that differs from one part of the wood to another.
const ONE_BARK: &str = "junction=watertight makes one solid of all wood, with one bark";

static RULES: &[Rule] = &[
    // Before all tables.
    Rule {
        knobs: &["seed"],
        why: |preset| {
            when(
                !preset.leaves_to_chance(),
                "nothing is left to chance: angle_jitter, length_jitter and leaves would be; bark_seed is for the bark",
            )
        },
    },
    // [wood]
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
            Some(Width::Grammar) => {
                Some("the grammar decides how thick the wood is; width=pipe goes by the height")
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
    // [surface]
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
    // [bark]
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
        knobs: &["moss_side", "moss_height", "moss_radius", "moss_color"],
        why: |preset| when(preset.dressing.bark.moss.amount == 0.0, "moss is 0"),
    },
    Rule {
        knobs: &["moss", "moss_side", "moss_height", "moss_radius", "moss_color"],
        why: |preset| when(preset.dressing.tubes.junction == Junction::Watertight, ONE_BARK),
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
    // [foliage]
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
        knobs: &["twig_length", "twig_leaves", "twig_tuft"],
        why: |preset| when(preset.dressing.foliage.first.form != Form::Twig, "it is for leaf_form=twig"),
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
    // [detail]
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
    // [wind]
    Rule {
        knobs: &["bones", "bone_order"],
        why: |preset| when(preset.dressing.wind.wind != Wind::Bones, "it is for wind=bones"),
    },
    Rule {
        knobs: &["wind_strength", "wind_frequency", "wind_direction", "gustiness"],
        why: |preset| when(preset.dressing.wind.wind == Wind::Off, "wind is off"),
    },
    Rule {
        knobs: &["wind_strength", "wind_frequency", "gustiness"],
        why: |preset| {
            let is_still = preset.dressing.wind.wind == Wind::Attributes;
            when(is_still, "the attributes are the same in any wind: it is for wind=sway and wind=bones")
        },
    },
];

/// The season from which leaves are full-grown and green.
const SUMMER: f64 = 0.25;

/// Why what decides the radii of other trees may not decide those of a scanned one.
const OF_SCANS: &str = "the points on the bark say how thick the wood is, where there are enough; scan_radius=pipe leaves that to the pipe model";

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

/// What says where leaves grow.
const PLACES: &[&str] = &[
    "leaf_arrangement",
    "leaf_whorl",
    "leaves_per_m",
    "leaf_count",
    "leaf_max_radius",
    "leaf_max_age",
    "leaf_tip",
    "leaf_terminal",
    "leaf_grid",
    "leaf_from",
];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::preset::{KNOBS, builtin};

    #[test]
    fn rules_name_knobs_that_there_are() {
        for name in RULES.iter().flat_map(|rule| rule.knobs) {
            assert!(KNOBS.iter().any(|row| row.knob.name == *name), "{name}");
        }
    }

    #[test]
    fn notes_name_the_knob_and_what_it_waits_for() {
        let mut preset = builtin("abop-a").unwrap().load().unwrap();
        preset.set("stems", "5").unwrap();
        preset.set("width", "order").unwrap();
        let notes = preset.idle_notes(["stems", "angle", "stems", "order_ratio", "segment_width"]);
        assert_eq!(
            notes,
            [
                "stems changes nothing: it is for habit=shrub",
                "segment_width changes nothing: it is for width=grammar"
            ]
        );
    }
}
