//! The table of all knobs that presets have. Documents, the command line, the schema, the help and
//! the workbench's form are made from it; a new knob is a field and a row, both in its section's file.

use super::item::Field;
use super::{
    Colonization, LeafKind, Preset, Space, bark, colonization, detail, leaf_knobs, lsystem, surface, wind,
    wood,
};
use crate::colonization::crown::{self, SHAPES, ShapeKnob};
use crate::knob::{Kind, Knob, Value};

/// The table of a document that a knob stands in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Section {
    /// Before all tables.
    Tree,
    /// `[lsystem]`
    LSystem,
    /// `[colonization]`
    Colonization,
    /// `[wood]`
    Wood,
    /// `[surface]`
    Surface,
    /// `[bark]`
    Bark,
    /// `[foliage]`
    Foliage,
    /// `[detail]`
    Detail,
    /// `[wind]`
    Wind,
}

impl Section {
    /// All sections, in the order of a document.
    pub const ALL: [Self; 9] = [
        Self::Tree,
        Self::LSystem,
        Self::Colonization,
        Self::Wood,
        Self::Surface,
        Self::Bark,
        Self::Foliage,
        Self::Detail,
        Self::Wind,
    ];

    /// Whether its knobs leave the skeleton as it is: they say what covers it and what is shown of it.
    pub const fn covers(self) -> bool {
        matches!(self, Self::Surface | Self::Bark | Self::Foliage | Self::Detail | Self::Wind)
    }

    /// The table's key, empty for [`Section::Tree`].
    pub const fn key(self) -> &'static str {
        match self {
            Self::Tree => "",
            Self::LSystem => "lsystem",
            Self::Colonization => "colonization",
            Self::Wood => "wood",
            Self::Surface => "surface",
            Self::Bark => "bark",
            Self::Foliage => "foliage",
            Self::Detail => "detail",
            Self::Wind => "wind",
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
    pub(super) access: Access,
}

/// How a knob reaches its field.
#[derive(Clone, Copy)]
pub(super) enum Access {
    Field {
        read: fn(&Preset) -> Option<Value>,
        write: fn(&mut Preset, Value),
    },
    Dimension(&'static ShapeKnob),
    /// Of the first kind of leaves.
    Leaf(Field<LeafKind>),
}

impl PresetKnob {
    /// The row for a crown shape's knob.
    pub(super) const fn of_shape(own: &'static ShapeKnob) -> Self {
        Self { knob: own.knob, section: Section::Colonization, access: Access::Dimension(own) }
    }

    /// The knob's value, `None` when the preset does not have the knob.
    pub fn read(&self, preset: &Preset) -> Option<Value> {
        match self.access {
            Access::Field { read, .. } => read(preset),
            Access::Dimension(own) => {
                let Space::Shape { dimensions, .. } = &preset.colonization()?.space else { return None };
                let set = dimensions.iter().find(|(name, _)| *name == own.knob.name);
                Some(set.map_or_else(own.default, |(_, value)| value.clone()))
            }
            Access::Leaf(own) => Some((own.read)(&preset.foliage.first)),
        }
    }

    /// Sets the knob to a value that its kind has checked.
    pub(super) fn write(&self, preset: &mut Preset, value: Value) {
        match self.access {
            Access::Field { write, .. } => write(preset, value),
            Access::Dimension(own) => {
                let Some(Colonization { space: Space::Shape { shape, dimensions }, .. }) =
                    preset.colonization_mut()
                else {
                    return;
                };
                dimensions.push((own.knob.name, value));
                if let Ok(shape) = crown::shape(shape) {
                    *dimensions = shape.complete(dimensions);
                }
            }
            Access::Leaf(own) => (own.write)(&mut preset.foliage.first, value),
        }
    }
}

/// The knobs of all crown shapes, each name once.
pub fn shape_knobs() -> Vec<PresetKnob> {
    let mut all: Vec<PresetKnob> = Vec::new();
    for own in SHAPES.iter().flat_map(|shape| shape.knobs) {
        if all.iter().all(|known| known.knob.name != own.knob.name) {
            all.push(PresetKnob::of_shape(own));
        }
    }
    all
}

/// A row: section, name, kind, unit, help, and the path from the preset to the field.
macro_rules! row {
    ($section:ident, $name:literal, $kind:expr, $unit:literal, $help:literal, $($part:ident)? . $field:ident $(. $rest:ident)*) => {
        $crate::preset::knobs::PresetKnob {
            knob: $crate::knob::Knob { name: $name, kind: $kind, unit: $unit, help: $help },
            section: $crate::preset::knobs::Section::$section,
            access: row!(@access $($part)? . $field $(. $rest)*),
        }
    };
    (@access lsystem . $field:ident) => { row!(@part lsystem, lsystem_mut, $field) };
    (@access colonization . $field:ident) => { row!(@part colonization, colonization_mut, $field) };
    (@access . $field:ident $(. $rest:ident)*) => {
        $crate::preset::knobs::Access::Field {
            read: |preset| Some($crate::preset::setting::Setting::to_value(&preset.$field$(.$rest)*)),
            write: |preset, value| $crate::preset::setting::assign(&mut preset.$field$(.$rest)*, value),
        }
    };
    (@part $part:ident, $part_mut:ident, $field:ident) => {
        $crate::preset::knobs::Access::Field {
            read: |preset| preset.$part().map(|own| $crate::preset::setting::Setting::to_value(&own.$field)),
            write: |preset, value| {
                if let Some(own) = preset.$part_mut() {
                    $crate::preset::setting::assign(&mut own.$field, value);
                }
            },
        }
    };
}

pub(super) use row;

pub(super) const fn real(min: f64, max: f64) -> Kind {
    Kind::Real { min, max, auto: false, names: &[] }
}

pub(super) const fn real_or_auto(min: f64, max: f64) -> Kind {
    Kind::Real { min, max, auto: true, names: &[] }
}

pub(super) const fn length_or_auto(min: f64, max: f64) -> Kind {
    Kind::Length { min, max, auto: true }
}

pub(super) const fn integer(min: u64, max: u64) -> Kind {
    Kind::Integer { min, max }
}

/// What stands before all tables.
const TREE: &[PresetKnob] = &[
    row!(Tree, "seed", integer(0, u64::MAX), "", "the root of all random choices: another seed, another tree", .seed),
];

/// The rows of all sections, in the order of a document.
const SECTIONS: [&[PresetKnob]; 9] = [
    TREE,
    lsystem::KNOBS,
    colonization::KNOBS,
    wood::KNOBS,
    surface::KNOBS,
    bark::KNOBS,
    leaf_knobs::KNOBS,
    detail::KNOBS,
    wind::KNOBS,
];

/// How many rows all sections have.
const COUNT: usize = {
    let (mut count, mut section) = (0, 0);
    while section < SECTIONS.len() {
        count += SECTIONS[section].len();
        section += 1;
    }
    count
};

/// All knobs but those of the crown shapes.
pub static KNOBS: &[PresetKnob] = &{
    let mut all = [TREE[0]; COUNT];
    let (mut filled, mut section) = (0, 0);
    while section < SECTIONS.len() {
        let mut row = 0;
        while row < SECTIONS[section].len() {
            all[filled] = SECTIONS[section][row];
            filled += 1;
            row += 1;
        }
        section += 1;
    }
    all
};
