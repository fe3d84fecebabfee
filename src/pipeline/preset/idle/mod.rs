//! Knobs that change nothing: which of them a preset as it stands does not listen to, and why.
//!
//! Most knobs hang on another one: `stems` is for shrubs, `junction_detail` for watertight wood. Whoever
//! turns one alone would see nothing happen, so it is said. Each rule says what has to be turned as well.
//! What only shows in the finished tree (a `tip_radius` below that of any twig) is no business of these
//! rules.

mod bark;
mod detail;
mod foliage;
mod surface;
mod wind;
mod wood;

use linden_plant::settings::{Dressing, FoliageSettings, Form, LeafKind};
use linden_plant::wind::Wind;
use linden_skeleton::Width;
use linden_skeleton::generator::{Bears, RadiiFrom};

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
            || rules().filter(|rule| rule.knobs.contains(&knob)).find_map(|rule| (rule.why)(self));
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
        let tapers = self.settled_width().is_none_or(|width| matches!(width, Width::Taper | Width::Order));
        self.has_spreads()
            || self.generator.draws()
            || bears_leaves
            || self.refinement.wanders()
            || tapers
            || wind.wind != Wind::Off
    }

    /// Whether the generator's organs are there: leaves that need a form are not, where `leaf_form` is none.
    fn places_organs(&self) -> bool {
        self.generator.traits(&self.wood).bears != Bears::Nothing && !self.lacks_form()
    }

    /// Whether the generator's leaves are missing since `leaf_form` is none.
    fn lacks_form(&self) -> bool {
        let bears = self.generator.traits(&self.wood).bears;
        bears == Bears::Leaves && self.dressing.foliage.first.form == Form::None
    }
}

/// `Some(why)` where it holds.
fn when(holds: bool, why: &'static str) -> Option<&'static str> {
    holds.then_some(why)
}

/// For all that differs from one part of the wood to another.
const ONE_BARK: &str = "junction=watertight makes one solid of all wood, with one bark";

/// All rules, as documents have their tables. Of several that name a knob the first that holds is said.
fn rules() -> impl Iterator<Item = &'static Rule> {
    [OF_NO_TABLE, wood::RULES, surface::RULES, bark::RULES, foliage::RULES, detail::RULES, wind::RULES]
        .into_iter()
        .flatten()
}

/// What stands before all tables.
static OF_NO_TABLE: &[Rule] = &[Rule {
    knobs: &["seed"],
    why: |preset| {
        when(
            !preset.leaves_to_chance(),
            "nothing is left to chance: angle_jitter, length_jitter, sway, gnarl and leaves would be; bark_seed is for the bark",
        )
    },
}];

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
        for name in rules().flat_map(|rule| rule.knobs) {
            assert!(KNOBS.iter().any(|row| row.knob.name == *name), "{name}");
        }
    }

    #[test]
    fn leaves_that_need_a_form_are_idle_without_one() {
        let mut aspen = builtin("wp-quaking-aspen").unwrap().load().unwrap();
        let of = |preset: &Preset| ["leaves", "leaf_keep", "season"].map(|knob| preset.idle(knob));
        assert_eq!(of(&aspen), [None; 3]);
        aspen.set("leaf_form", "none").unwrap();
        assert_eq!(of(&aspen), [Some("leaf_form is none"); 3]);
    }

    #[test]
    fn a_seed_counts_where_wood_wanders() {
        let mut preset = builtin("abop-a").unwrap().load().unwrap();
        assert!(preset.idle("seed").is_some());
        assert_eq!(preset.idle("trunk_gnarl"), Some("it is a share of gnarl, which is 0"));
        for knob in ["gnarl", "sway"] {
            preset.set(knob, "0.2").unwrap();
            assert_eq!(preset.idle("seed"), None, "{knob}");
            preset.set(knob, "0").unwrap();
        }
        preset.set("gnarl", "0.2").unwrap();
        assert_eq!(preset.idle("trunk_gnarl"), None);
    }

    #[test]
    fn only_a_grammar_is_called_one() {
        for (id, decides) in [("so-oak", "the generator"), ("abop-honda-a", "the grammar")] {
            let preset = builtin(id).unwrap().load().unwrap();
            let why = preset.idle("slenderness").unwrap();
            assert!(why.starts_with(decides), "{id}: {why}");
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
