//! The table of all knobs that presets have. Documents, the command line, the schema, the help and
//! the workbench's form are made from it; a new knob is a field and a row, both beside the settings that it
//! turns.

use std::sync::LazyLock;

use linden_base::knob::{Field, FieldValue, Knob, Spread, Value, integer};
use linden_plant::settings::{BarkSettings, DetailSettings, FoliageSettings, LeafKind, WindSettings};
use linden_plant::surface::Tubes;
use linden_skeleton::Wood;
use linden_skeleton::refine::Refinement;

use super::Preset;
use crate::generators;

/// The table of a document that a knob stands in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Section {
    /// Before all tables.
    Tree,
    /// The table of a generator, by its id: `[lsystem]`.
    Generator(&'static str),
    /// `[wood]`
    Wood,
    /// `[surface]`
    Surface,
    /// `[bark]`
    Bark,
    /// `[foliage]`
    Foliage,
    /// A further kind of foliage, `[[foliage.also]]`, by its number from 0. No document has more sections for it.
    Kind(usize),
    /// `[detail]`
    Detail,
    /// `[wind]`
    Wind,
}

impl Section {
    /// All sections that have a table of their own, in the order of a document.
    pub fn all() -> Vec<Self> {
        let generators = generators::all().iter().map(|generator| Self::Generator(generator.id()));
        let rest = [Self::Wood, Self::Surface, Self::Bark, Self::Foliage, Self::Detail, Self::Wind];
        std::iter::once(Self::Tree).chain(generators).chain(rest).collect()
    }

    /// Whether its knobs leave the skeleton as it is: they say what covers it and what is shown of it.
    pub const fn covers(self) -> bool {
        matches!(self, Self::Surface | Self::Bark | Self::Foliage | Self::Kind(_) | Self::Detail | Self::Wind)
    }

    /// The table's key, empty for [`Section::Tree`].
    pub const fn key(self) -> &'static str {
        match self {
            Self::Tree => "",
            Self::Generator(id) => id,
            Self::Wood => "wood",
            Self::Surface => "surface",
            Self::Bark => "bark",
            Self::Foliage => "foliage",
            Self::Kind(_) => "foliage.also",
            Self::Detail => "detail",
            Self::Wind => "wind",
        }
    }

    /// What people call it.
    pub fn title(self) -> &'static str {
        match self {
            Self::Tree => "Tree",
            Self::Generator(id) => generators::find(id).map_or(id, |generator| generator.name()),
            Self::Wood => "Wood",
            Self::Surface => "Surface",
            Self::Bark => "Bark",
            Self::Foliage => "Foliage",
            Self::Kind(_) => "Further foliage",
            Self::Detail => "Levels of detail",
            Self::Wind => "Wind",
        }
    }
}

/// A row of the table.
#[derive(Clone, Copy)]
pub struct PresetKnob {
    /// Name, kind, unit, help.
    pub knob: Knob,
    /// Where documents have it.
    pub section: Section,
    access: Access,
}

/// How a knob reaches its field.
#[derive(Clone, Copy)]
enum Access {
    Tree(Field<Preset>),
    /// By its name.
    Generator,
    Wood(Field<Wood>),
    Refinement(Field<Refinement>),
    Surface(Field<Tubes>),
    Bark(Field<BarkSettings>),
    /// Of the first kind of leaves.
    Leaf(Field<LeafKind>),
    /// Of a further kind, by its number.
    Kind(usize, Field<LeafKind>),
    Foliage(Field<FoliageSettings>),
    Detail(Field<DetailSettings>),
    Wind(Field<WindSettings>),
}

impl PresetKnob {
    /// The row for a knob of a generator.
    pub(super) const fn of_generator(id: &'static str, knob: Knob) -> Self {
        Self { knob, section: Section::Generator(id), access: Access::Generator }
    }

    /// The row for a knob of a further kind of foliage.
    pub(super) const fn of_kind(kind: usize, knob: Knob, field: Field<LeafKind>) -> Self {
        Self { knob, section: Section::Kind(kind), access: Access::Kind(kind, field) }
    }

    /// The knob's value, `None` when the preset does not have the knob.
    pub fn read(&self, preset: &Preset) -> Option<Value> {
        let dressing = &preset.dressing;
        Some(match &self.access {
            Access::Tree(field) => (field.read)(preset),
            Access::Generator => {
                if self.section.key() != preset.generator.generator().id() {
                    return None;
                }
                return preset
                    .generator
                    .knobs()
                    .into_iter()
                    .find(|(knob, _)| knob.name == self.knob.name)
                    .map(|(_, value)| value);
            }
            Access::Wood(field) => (field.read)(&preset.wood),
            Access::Refinement(field) => (field.read)(&preset.refinement),
            Access::Surface(field) => (field.read)(&dressing.tubes),
            Access::Bark(field) => (field.read)(&dressing.bark),
            Access::Leaf(field) => (field.read)(&dressing.foliage.first),
            Access::Kind(kind, field) => (field.read)(dressing.foliage.also.get(*kind)?),
            Access::Foliage(field) => (field.read)(&dressing.foliage),
            Access::Detail(field) => (field.read)(&dressing.detail),
            Access::Wind(field) => (field.read)(&dressing.wind),
        })
    }

    /// Reads a spread of this knob.
    ///
    /// # Errors
    /// What was expected instead, without the knob's name.
    pub(super) fn parse_spread(&self, text: &str) -> Result<Spread, String> {
        if self.section == Section::Tree {
            return Err("the seed is what draws spreads, and has none itself; give one number".to_owned());
        }
        Spread::parse(&self.knob.kind, text)
    }

    /// Sets the knob to a value that its kind has checked.
    pub(super) fn write(&self, preset: &mut Preset, value: Value) {
        match &self.access {
            Access::Tree(field) => (field.write)(preset, value),
            Access::Generator => {
                preset.generator.set(self.knob.name, value);
            }
            Access::Wood(field) => (field.write)(&mut preset.wood, value),
            Access::Refinement(field) => (field.write)(&mut preset.refinement, value),
            Access::Surface(field) => (field.write)(&mut preset.dressing.tubes, value),
            Access::Bark(field) => (field.write)(&mut preset.dressing.bark, value),
            Access::Leaf(field) => (field.write)(&mut preset.dressing.foliage.first, value),
            Access::Kind(kind, field) => {
                if let Some(kind) = preset.dressing.foliage.also.get_mut(*kind) {
                    (field.write)(kind, value);
                }
            }
            Access::Foliage(field) => (field.write)(&mut preset.dressing.foliage, value),
            Access::Detail(field) => (field.write)(&mut preset.dressing.detail, value),
            Access::Wind(field) => (field.write)(&mut preset.dressing.wind, value),
        }
    }
}

/// What stands before all tables.
const TREE: Field<Preset> = Field {
    knob: Knob::new(
        "seed",
        integer(0, u64::MAX),
        "",
        "the root of all random choices: another seed, another tree",
    )
    .details(
        "Points of a crown, choices of a grammar, tapers and leaves all draw from it, each with a key \
         of its own, so that turning a knob of leaves moves no branch; knobs with a spread, as '4 ± 0.6', draw their \
         value. The same seed gives the same files on every machine, with any number of threads. A grammar \
         without chance grows the same plant from every seed.",
    )
    .see_also(&["angle_jitter", "points", "sway", "bark_seed"]),
    read: |preset| preset.seed().to_value(),
    write: |preset, value| {
        if let Some(seed) = u64::from_value(value) {
            preset.set_seed(seed);
        }
    },
};

/// The rows that stand before the generators'.
pub(super) fn before() -> &'static [PresetKnob] {
    static BEFORE: [PresetKnob; 1] =
        [PresetKnob { knob: TREE.knob, section: Section::Tree, access: Access::Tree(TREE) }];
    &BEFORE
}

/// The rows that stand behind the generators'.
pub(super) fn behind() -> &'static [PresetKnob] {
    static BEHIND: LazyLock<Vec<PresetKnob>> = LazyLock::new(|| rows_behind().collect());
    &BEHIND
}

fn rows_behind() -> impl Iterator<Item = PresetKnob> {
    fn rows<T>(
        section: Section,
        access: fn(Field<T>) -> Access,
        fields: &'static [Field<T>],
    ) -> impl Iterator<Item = PresetKnob> {
        fields.iter().map(move |field| PresetKnob { knob: field.knob, section, access: access(*field) })
    }
    rows(Section::Wood, Access::Wood, Wood::FIELDS)
        .chain(rows(Section::Wood, Access::Refinement, Refinement::FIELDS))
        .chain(rows(Section::Surface, Access::Surface, Tubes::FIELDS))
        .chain(rows(Section::Bark, Access::Bark, BarkSettings::FIELDS))
        .chain(rows(Section::Foliage, Access::Leaf, LeafKind::FIELDS))
        .chain(rows(Section::Foliage, Access::Foliage, FoliageSettings::FIELDS))
        .chain(rows(Section::Detail, Access::Detail, DetailSettings::FIELDS))
        .chain(rows(Section::Wind, Access::Wind, WindSettings::FIELDS))
}

/// All knobs, in the order of a document. Generators may have knobs of the same name.
pub static KNOBS: LazyLock<Vec<PresetKnob>> = LazyLock::new(|| {
    let generators = generators::all().iter().flat_map(|generator| {
        generator.knobs().into_iter().map(|knob| PresetKnob::of_generator(generator.id(), knob))
    });
    before().iter().copied().chain(generators).chain(behind().iter().copied()).collect()
});

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;
    use crate::preset::LEAF_KNOBS;

    /// All knobs of presets, those of further kinds of leaves among them.
    fn all() -> Vec<Knob> {
        KNOBS.iter().map(|row| row.knob).chain(LEAF_KNOBS.iter().map(|row| row.knob)).collect()
    }

    #[test]
    fn see_also_names_other_knobs() {
        let names: BTreeSet<&str> = all().iter().map(|knob| knob.name).collect();
        for knob in all() {
            let mut seen = BTreeSet::from([knob.name]);
            for other in knob.see_also {
                assert!(names.contains(other), "{}: '{other}' is no knob", knob.name);
                assert!(seen.insert(other), "{}: '{other}' is named twice, or is itself", knob.name);
            }
        }
    }

    #[test]
    fn details_say_more_than_help() {
        for Knob { name, help, details, .. } in all() {
            assert!(!details.contains(help), "{name}: details repeat help");
            if !details.is_empty() {
                assert!(details.ends_with('.'), "{name}: no sentence: {details}");
                assert!((60..700).contains(&details.len()), "{name}: {} letters", details.len());
                assert!(!details.contains("  ") && !details.contains('\n'), "{name}: badly joined lines");
            }
        }
    }

    #[test]
    fn what_shapes_a_tree_is_explained() {
        let mut shaping: Vec<&str> = "
            seed derivations angle habit stems lean tropism susceptibility
            crown crown_height crown_radius profile profile_points profile_kind crown_base points
            shell_density top_density clumps clump_size
            step influence kill age trunk attraction gravitropism phototropism gravity apical_control waves
            contract scan_radius scale
            width base_radius tip_radius slenderness radius_exponent angle_share order_ratio
            taper_base_min taper_tip_min refine relocate_share subdivisions trunk_curve sway gnarl trunk_gnarl
            junction flare collar bark
            leaf_form leaf_outline leaf_length leaf_arrangement leaves_per_m leaf_angle leaf_droop season
            triangles lods billboard wind wind_strength"
            .split_whitespace()
            .collect();
        for knob in all() {
            // A name that several tables have is explained in each.
            if shaping.contains(&knob.name) {
                assert!(!knob.details.is_empty(), "{} has no details", knob.name);
                assert!(!knob.see_also.is_empty(), "{} names no other knobs", knob.name);
            }
        }
        shaping.retain(|name| all().iter().all(|knob| knob.name != *name));
        assert!(shaping.is_empty(), "no knobs: {shaping:?}");
    }
}
