//! Knobs that change nothing: which of them a preset as it stands does not listen to, and why.
//!
//! Most knobs hang on another one: `stems` is for shrubs, `junction_detail` for watertight wood. Whoever
//! turns one alone would see nothing happen, so it is said. Each rule says what has to be turned as well.
//! What only shows in the finished tree (a `tip_radius` below that of any twig) is no business of these
//! rules.

use super::foliage::{Arrangement, Form, LeafKind};
use super::setting::{Habit, ScanRadius};
use super::{Generator, Preset, Space};
use crate::lsystem::Production;
use crate::skeleton::Width;
use crate::surface::{Ends, Junction};
use crate::wind::Wind;

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
    /// let mut fir = linden::preset::builtin("fir").unwrap().load()?;
    /// fir.set("junction_detail", "64")?;
    /// assert_eq!(fir.idle("junction_detail"), Some("it is for junction=watertight"));
    /// fir.set("junction", "watertight")?;
    /// assert_eq!(fir.idle("junction_detail"), None);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn idle(&self, knob: &str) -> Option<&'static str> {
        RULES.iter().filter(|rule| rule.knobs.contains(&knob)).find_map(|rule| (rule.why)(self))
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
        let gives_radii = match &self.generator {
            Generator::LSystem(own) => self.wood.width == Width::Grammar || own.writes("!", false),
            Generator::Colonization(own) => match own.space {
                Space::Points { .. }
                    if own.contract
                        && own.scan_radius == ScanRadius::Points
                        && self.wood.base_radius_m.is_none() =>
                {
                    return matches!(self.wood.width, Width::Order | Width::Taper).then_some(self.wood.width);
                }
                _ => false,
            },
        };
        Some(self.wood.settled(gives_radii).width)
    }

    fn is_width(&self, width: Width) -> bool {
        self.settled_width().is_none_or(|own| own == width)
    }

    fn refines(&self, step: &str) -> bool {
        self.refinement.steps.iter().any(|own| own.name == step)
    }

    /// Whether leaves of the first kind, or of kinds that take places from it, grow in its places.
    fn has_first_places(&self) -> bool {
        let takes = |kind: &LeafKind| kind.form != Form::None && kind.share > 0.0;
        self.foliage.first.form != Form::None || self.foliage.also.iter().any(takes)
    }

    fn places_organs(&self) -> bool {
        self.lsystem().is_some_and(|own| own.writes("{~", false))
    }
}

impl super::LSystem {
    /// Whether the axiom or a rule writes one of these symbols, `bare`: without arguments.
    fn writes(&self, symbols: &str, bare: bool) -> bool {
        let grammar = &self.grammar;
        let successors = grammar.productions().iter().flat_map(|own| &own.successor);
        let mut written = grammar.axiom().iter().chain(successors);
        written.any(|module| symbols.contains(module.symbol) && (!bare || module.arguments.is_empty()))
    }
}

impl super::LSystem {
    /// Whether every symbol that draws wood is rewritten in every derivation, so that none is older than the
    /// last one.
    fn rewrites_all_wood(&self) -> bool {
        let grammar = &self.grammar;
        let productions = grammar.productions();
        let written = || grammar.axiom().iter().chain(productions.iter().flat_map(|own| &own.successor));
        written().filter(|module| "FG".contains(module.symbol)).all(|module| {
            let fits = |own: &Production| {
                own.predecessor.symbol == module.symbol
                    && own.predecessor.parameters.len() == module.arguments.len()
                    && own.left.is_empty()
                    && own.right.is_empty()
                    && own.condition.is_none()
            };
            productions.iter().any(fits)
        })
    }
}

/// `Some(why)` where it holds.
fn when(holds: bool, why: &'static str) -> Option<&'static str> {
    holds.then_some(why)
}

/// Whether a rule for an L-system's settings holds.
fn lsystem(
    preset: &Preset,
    holds: impl Fn(&super::LSystem) -> bool,
    why: &'static str,
) -> Option<&'static str> {
    when(preset.lsystem().is_some_and(holds), why)
}

/// Whether a rule for the settings of space colonization holds.
fn colonization(
    preset: &Preset,
    holds: impl Fn(&super::Colonization) -> bool,
    why: &'static str,
) -> Option<&'static str> {
    when(preset.colonization().is_some_and(holds), why)
}

const fn is_given(space: &Space) -> bool {
    matches!(space, Space::Points { .. })
}

const LSYSTEM_TURNS: &str = "+-&^\\/";

static RULES: &[Rule] = &[
    // [lsystem]
    Rule {
        knobs: &["derivations"],
        why: |own| lsystem(own, |own| own.grammar.productions().is_empty(), "the grammar has no rules"),
    },
    Rule {
        knobs: &["angle"],
        why: |own| {
            lsystem(own, |own| !own.writes(LSYSTEM_TURNS, true), "each turn of the grammar names its angle")
        },
    },
    Rule {
        knobs: &["segment_width"],
        why: |own| {
            own.lsystem()?;
            if matches!(own.wood.width, Width::Pipe | Width::Order | Width::Taper) {
                return Some("it is for width=grammar");
            }
            when(
                own.wood.width == Width::Auto && own.settled_width() != Some(Width::Grammar),
                "the grammar has no !; with width=grammar all its wood has this width",
            )
            .or(when(own.wood.base_radius_m.is_some(), "base_radius decides how thick the wood is"))
        },
    },
    Rule {
        knobs: &["width_ratio"],
        why: |own| {
            let grammar = own.lsystem()?;
            if matches!(own.wood.width, Width::Pipe | Width::Order | Width::Taper) {
                return Some("it is for width=grammar");
            }
            when(!grammar.writes("!", true), "the grammar has no ! without a number")
        },
    },
    Rule {
        knobs: &["tropism"],
        why: |own| lsystem(own, |own| own.susceptibility == 0.0, "susceptibility is 0"),
    },
    Rule {
        knobs: &["susceptibility"],
        why: |own| lsystem(own, |own| own.tropism == [0.0; 3], "tropism is 0,0,0"),
    },
    Rule {
        knobs: &["angle_jitter"],
        why: |own| lsystem(own, |own| !own.writes(LSYSTEM_TURNS, false), "the grammar has no turns"),
    },
    Rule {
        knobs: &["branch_roll"],
        why: |own| lsystem(own, |own| !own.writes("[", false), "the grammar has no branches"),
    },
    Rule {
        knobs: &["stems", "lean"],
        why: |own| lsystem(own, |own| own.habit != Habit::Shrub, "it is for habit=shrub"),
    },
    // [colonization]
    Rule {
        knobs: &["points", "shell_density", "top_density", "clumps", "clump_size"],
        why: |own| colonization(own, |own| is_given(&own.space), "the points are given"),
    },
    Rule {
        knobs: &["crown_base"],
        why: |own| {
            let is_shape = |own: &super::Colonization| matches!(own.space, Space::Shape { .. });
            colonization(own, |own| !is_shape(own), "it is for crown shapes, and this crown is a file")
        },
    },
    Rule { knobs: &["clump_size"], why: |own| colonization(own, |own| own.clumps == 0.0, "clumps is 0") },
    Rule {
        knobs: &["light"],
        why: |own| colonization(own, |own| own.phototropism.iter().all(|&x| x == 0.0), "phototropism is 0"),
    },
    Rule { knobs: &["wave_interval"], why: |own| colonization(own, |own| own.waves == 1, "waves is 1") },
    Rule {
        knobs: &["contract", "scan_radius", "noise_filter", "stems", "scale"],
        why: |own| {
            colonization(own, |own| !is_given(&own.space), "it is for points that are given, as by a scanner")
        },
    },
    Rule {
        knobs: &["noise_filter", "stems"],
        why: |own| colonization(own, |own| !own.contract, "contract=false: the points are no scan"),
    },
    Rule {
        knobs: &["scan_radius"],
        why: |own| {
            if matches!(own.wood.width, Width::Pipe | Width::Order | Width::Taper) {
                return Some("it is for width=auto");
            }
            colonization(own, |own| !own.contract, "contract=false: the points are no bark")
                .or(when(own.wood.base_radius_m.is_some(), "base_radius decides how thick the wood is"))
        },
    },
    Rule {
        knobs: &["up"],
        why: |own| {
            let reads = |own: &super::Colonization| {
                own.space.file().is_some() || own.parts.iter().any(|part| part.file().is_some())
            };
            colonization(own, |own| !reads(own), "no mesh and no points are read")
        },
    },
    Rule {
        knobs: &["origin"],
        why: |own| {
            let stands = |own: &super::Colonization| {
                let is_there = own.root.is_none_or(|root| root == [0.0; 3]);
                matches!(own.space, Space::Shape { .. }) && is_there
            };
            colonization(own, stands, "the tree stands on the origin anyway")
        },
    },
    // [wood]
    Rule {
        knobs: &["width"],
        why: |own| {
            let is_crown = own.space().is_some_and(|space| !is_given(space));
            when(
                is_crown && own.wood.width == Width::Grammar,
                "space colonization gives no widths: width=grammar is as width=pipe",
            )
        },
    },
    Rule {
        knobs: &["slenderness"],
        why: |own| match own.settled_width() {
            Some(Width::Grammar) => {
                Some("the grammar decides how thick the wood is; width=pipe goes by the height")
            }
            None => Some(OF_SCANS),
            _ if own.wood.base_radius_m.is_some() => Some("base_radius decides how thick the wood is"),
            Some(Width::Pipe) if own.wood.tip_radius_m.is_some() => {
                Some("tip_radius decides how thick the wood is")
            }
            _ => None,
        },
    },
    Rule { knobs: &["radius_exponent"], why: |own| when(!own.is_width(Width::Pipe), "it is for width=pipe") },
    Rule {
        knobs: &["angle_share"],
        why: |own| match own.settled_width() {
            None => Some(OF_SCANS),
            Some(width) => when(width != Width::Pipe, "it is for width=pipe"),
        },
    },
    Rule {
        knobs: &["order_ratio"],
        why: |own| when(own.wood.width != Width::Order, "it is for width=order"),
    },
    Rule {
        knobs: &["taper_base_min", "taper_base_max", "taper_tip_min", "taper_tip_max"],
        why: |own| when(own.wood.width != Width::Taper, "it is for width=taper"),
    },
    Rule {
        knobs: &["prune_nodes"],
        why: |own| {
            when(!own.refines("prune"), "it is for refine=prune").or_else(|| {
                colonization(
                    own,
                    |_| true,
                    "prune takes the twigs that caught no point, whatever their length",
                )
            })
        },
    },
    Rule {
        knobs: &["decimate_tolerance"],
        why: |own| when(!own.refines("decimate"), "it is for refine=decimate"),
    },
    Rule {
        knobs: &["relocate_share"],
        why: |own| when(!own.refines("relocate"), "it is for refine=relocate"),
    },
    Rule { knobs: &["smooth_rounds"], why: |own| when(!own.refines("smooth"), "it is for refine=smooth") },
    Rule {
        knobs: &["subdivisions"],
        why: |own| when(!own.refines("subdivide"), "it is for refine=subdivide"),
    },
    // [surface]
    Rule {
        knobs: &["junction_detail"],
        why: |own| when(own.tubes.junction != Junction::Watertight, "it is for junction=watertight"),
    },
    Rule {
        knobs: &["flare_height", "flare_ridges", "flare_depth"],
        why: |own| when(own.tubes.features.flare == 0.0, "flare is 0"),
    },
    Rule {
        knobs: &["flare_height"],
        why: |own| when(own.tubes.features.flare_height_m == Some(0.0), "a flare of no height is none"),
    },
    Rule {
        knobs: &["flare_depth"],
        why: |own| when(own.tubes.features.flare_ridges == 0, "flare_ridges is 0"),
    },
    Rule {
        knobs: &["flare_ridges"],
        why: |own| when(own.tubes.features.flare_depth == 0.0, "flare_depth is 0"),
    },
    Rule {
        knobs: &["ends_above"],
        why: |own| when(own.tubes.features.ends == Ends::Bud, "all ends are buds: it is for other ends"),
    },
    // [bark]
    Rule {
        knobs: &["bark", "bark_color", "bark_grain"],
        why: |own| when(own.bark.picture.is_some(), "bark_picture stands in place of the drawn one"),
    },
    Rule {
        knobs: &["bark_relief", "bark_size"],
        why: |own| when(own.bark.picture.is_some() && own.bark.normal.is_some(), "the pictures are given"),
    },
    // [foliage]
    Rule {
        knobs: &["season", "leaf_size"],
        why: |own| when(own.foliage.kinds().all(|kind| kind.form == Form::None), "leaf_form is none"),
    },
    Rule {
        knobs: &["season"],
        why: |own| {
            let mut kinds = own.foliage.kinds().filter(|kind| kind.form != Form::None);
            when(kinds.all(|kind| kind.evergreen), "all leaves are evergreen")
        },
    },
    Rule {
        knobs: &["leaf_colors"],
        why: |own| {
            when(
                own.foliage.first.form == Form::None && !own.places_organs(),
                "leaf_form is none, and no grammar places organs",
            )
        },
    },
    Rule { knobs: LOOKS, why: |own| when(own.foliage.first.form == Form::None, "leaf_form is none") },
    Rule { knobs: PLACES, why: |own| when(!own.has_first_places(), "leaf_form is none") },
    Rule {
        knobs: &["leaf_max_age"],
        why: |own| {
            let grammar = own.lsystem().filter(|own| own.derivations > 0)?;
            when(grammar.rewrites_all_wood(), "all segments of this grammar are born in the last derivation")
        },
    },
    Rule {
        knobs: &["leaf_whorl"],
        why: |own| {
            let is_whorled = own.foliage.first.arrangement == Arrangement::Whorled;
            when(!is_whorled, "it is for leaf_arrangement=whorled")
        },
    },
    Rule {
        knobs: &["twig_length", "twig_leaves"],
        why: |own| when(own.foliage.first.form != Form::Twig, "it is for leaf_form=twig"),
    },
    Rule {
        knobs: &["leaves_per_m"],
        why: |own| {
            let has_grid = own.foliage.first.grid.first().is_some_and(|&along| along >= 0.5);
            when(has_grid, "leaf_grid stands in its place")
        },
    },
    Rule {
        knobs: &["evergreen"],
        why: |own| {
            let is_summer = (SUMMER..=TURNING).contains(&own.foliage.season);
            when(is_summer, "in summer (season 0.25 to 0.54) all leaves are alike")
        },
    },
    Rule {
        knobs: &["leaf_lobes", "leaf_lobe_depth", "leaf_margin", "leaf_petiole"],
        why: |own| {
            when(own.foliage.first.form == Form::Mesh, "it is for drawn leaves, and leaf_form is mesh")
        },
    },
    Rule {
        knobs: &["leaf_lobes"],
        why: |own| {
            let LeafKind { outline, form, .. } = &own.foliage.first;
            when(!outline.has_lobes() && *form != Form::Fan, "leaves of this leaf_outline have no lobes")
        },
    },
    Rule {
        knobs: &["leaf_lobe_depth"],
        why: |own| {
            when(
                !own.foliage.first.outline.has_bays(),
                "leaves of this leaf_outline have no bays between lobes",
            )
        },
    },
    Rule {
        knobs: &["leaf_margin"],
        why: |own| when(!own.foliage.first.outline.has_margin(), "leaves of this leaf_outline have no teeth"),
    },
    Rule {
        knobs: &["leaf_petiole"],
        why: |own| when(!own.foliage.first.outline.has_petiole(), "this leaf_outline has no stalk"),
    },
    Rule {
        knobs: &["autumn_colors"],
        why: |own| {
            when(own.foliage.first.evergreen, "the leaves are evergreen")
                .or(when(own.foliage.season < TURNING, "no leaf turns before season=0.54"))
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
            "autumn_colors",
            "leaf_tint_spread",
        ],
        why: |own| when(own.foliage.first.picture.is_some(), "leaf_picture stands in place of the drawn one"),
    },
    Rule {
        knobs: &["leaf_size"],
        why: |own| {
            let mut drawn = own.foliage.kinds().filter(|kind| kind.form != Form::None);
            let is_given = drawn.all(|kind| kind.picture.is_some() || kind.form == Form::Mesh);
            when(is_given, "all pictures of leaves are given")
        },
    },
    // [detail]
    Rule {
        knobs: &["triangles", "lods", "lod_ratio"],
        why: |own| when(!own.detail.budgets().is_empty(), "lod_triangles says how many each level has"),
    },
    Rule {
        knobs: &["lod_ratio"],
        why: |own| when(own.detail.levels() == 1, "there is one level: it is for lods"),
    },
    Rule { knobs: &["billboard_size"], why: |own| when(own.detail.billboard == 0, "billboard is 0") },
    // [wind]
    Rule {
        knobs: &["wind_strength", "wind_frequency", "wind_direction", "gustiness"],
        why: |own| when(own.wind.wind == Wind::Off, "wind is off"),
    },
    Rule {
        knobs: &["wind_strength", "wind_frequency", "gustiness"],
        why: |own| {
            let is_still = own.wind.wind == Wind::Attributes;
            when(is_still, "the attributes are the same in any wind: it is for wind=sway")
        },
    },
];

/// The season from which leaves are full-grown and green.
const SUMMER: f64 = 0.25;

/// The season before which all leaves are as in summer.
const TURNING: f64 = 0.54;

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
    "leaf_angle",
    "leaf_droop",
    "leaf_level",
    "leaf_up",
    "leaf_jitter",
    "leaf_offset",
    "leaf_normals",
    "autumn_colors",
    "leaf_tint_spread",
    "evergreen",
    "leaf_keep",
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
