//! The table of all knobs that presets have. Documents, the command line, the schema, the help and
//! the workbench's form are made from it; a new knob is a field and a row.

use super::setting::{Origin, Setting, UpAxis, assign};
use super::{Colonization, Generator, LSystem, Preset, Space};
use crate::colonization::crown::{SHAPES, ShapeKnob};
use crate::knob::{Kind, Knob, Value};
use crate::lsystem::{MAX_DERIVATIONS, MAX_SYMBOLS};
use crate::texture::BarkStyle;

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
}

impl Section {
    /// All sections, in the order of a document.
    pub const ALL: [Self; 6] =
        [Self::Tree, Self::LSystem, Self::Colonization, Self::Wood, Self::Surface, Self::Bark];

    /// The table's key, empty for [`Section::Tree`].
    pub const fn key(self) -> &'static str {
        match self {
            Self::Tree => "",
            Self::LSystem => "lsystem",
            Self::Colonization => "colonization",
            Self::Wood => "wood",
            Self::Surface => "surface",
            Self::Bark => "bark",
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
    Field { read: fn(&Preset) -> Option<Value>, write: fn(&mut Preset, Value) },
    Dimension(&'static ShapeKnob),
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
        }
    }

    /// Sets the knob to a value that its kind has checked.
    pub(super) fn write(&self, preset: &mut Preset, value: Value) {
        match self.access {
            Access::Field { write, .. } => write(preset, value),
            Access::Dimension(own) => {
                let Some(Colonization { space: Space::Shape { dimensions, .. }, .. }) =
                    preset.colonization_mut()
                else {
                    return;
                };
                dimensions.retain(|(name, _)| *name != own.knob.name);
                dimensions.push((own.knob.name, value));
            }
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

impl Preset {
    pub(super) fn colonization(&self) -> Option<&Colonization> {
        if let Generator::Colonization(own) = &self.generator { Some(own) } else { None }
    }

    pub(super) fn colonization_mut(&mut self) -> Option<&mut Colonization> {
        if let Generator::Colonization(own) = &mut self.generator { Some(own) } else { None }
    }

    fn lsystem(&self) -> Option<&LSystem> {
        if let Generator::LSystem(own) = &self.generator { Some(own) } else { None }
    }

    fn lsystem_mut(&mut self) -> Option<&mut LSystem> {
        if let Generator::LSystem(own) = &mut self.generator { Some(own) } else { None }
    }

    fn crown(&self) -> Option<Value> {
        match &self.colonization()?.space {
            Space::Shape { shape, .. } => Some(Value::Word(shape.clone())),
            _ => None,
        }
    }

    /// Another crown shape keeps the dimensions that it shares with the one before.
    fn write_crown(&mut self, value: Value) {
        let (Some(own), Value::Word(word)) = (self.colonization_mut(), value) else { return };
        if let Space::Shape { shape, dimensions } = &mut own.space {
            let fits = |name: &str| {
                SHAPES.iter().any(|s| s.id == word && s.knobs.iter().any(|own| own.knob.name == name))
            };
            dimensions.retain(|(name, _)| fits(name));
            *shape = word;
        }
    }
}

/// A row: section, name, kind, unit, help, and the path from the preset to the field.
macro_rules! row {
    ($section:ident, $name:literal, $kind:expr, $unit:literal, $help:literal, $($part:ident)? . $field:ident $(. $rest:ident)*) => {
        PresetKnob {
            knob: Knob { name: $name, kind: $kind, unit: $unit, help: $help },
            section: Section::$section,
            access: row!(@access $($part)? . $field $(. $rest)*),
        }
    };
    (@access lsystem . $field:ident) => { row!(@part lsystem, lsystem_mut, $field) };
    (@access colonization . $field:ident) => { row!(@part colonization, colonization_mut, $field) };
    (@access . $field:ident $(. $rest:ident)*) => {
        Access::Field {
            read: |preset| Some(preset.$field$(.$rest)*.to_value()),
            write: |preset, value| assign(&mut preset.$field$(.$rest)*, value),
        }
    };
    (@part $part:ident, $part_mut:ident, $field:ident) => {
        Access::Field {
            read: |preset| preset.$part().map(|own| own.$field.to_value()),
            write: |preset, value| {
                if let Some(own) = preset.$part_mut() {
                    assign(&mut own.$field, value);
                }
            },
        }
    };
}

const fn real(min: f64, max: f64) -> Kind {
    Kind::Real { min, max, auto: false }
}

const fn real_or_auto(min: f64, max: f64) -> Kind {
    Kind::Real { min, max, auto: true }
}

const fn length_or_auto(min: f64, max: f64) -> Kind {
    Kind::Length { min, max, auto: true }
}

const fn integer(min: u64, max: u64) -> Kind {
    Kind::Integer { min, max }
}

/// The ids of all crown shapes.
const SHAPE_IDS: [&str; SHAPES.len()] = {
    let mut ids = [""; SHAPES.len()];
    let mut i = 0;
    while i < ids.len() {
        ids[i] = SHAPES[i].id;
        i += 1;
    }
    ids
};

/// The names of all kinds of bark.
const BARK_STYLES: [&str; BarkStyle::ALL.len()] = {
    let mut names = [""; BarkStyle::ALL.len()];
    let mut i = 0;
    while i < names.len() {
        names[i] = BarkStyle::ALL[i].0;
        i += 1;
    }
    names
};

/// All knobs but those of the crown shapes.
pub static KNOBS: &[PresetKnob] = &[
    row!(Tree, "seed", integer(0, u64::MAX), "", "the root of all random choices: another seed, another tree", .seed),
    row!(
        LSystem,
        "derivations",
        integer(0, MAX_DERIVATIONS as u64),
        "",
        "how often the rules are applied",
        lsystem.derivations
    ),
    row!(LSystem, "angle", real(-360.0, 360.0), "deg", "turn of + - & ^ \\ /", lsystem.angle_deg),
    row!(LSystem, "segment_length", real(1e-4, 1e3), "m", "length of an F", lsystem.segment_length_m),
    row!(
        LSystem,
        "symbol_limit",
        integer(1, MAX_SYMBOLS),
        "symbols",
        "derivations that would give more are refused",
        lsystem.symbol_limit
    ),
    PresetKnob {
        knob: Knob {
            name: "crown",
            kind: Kind::Choice(&SHAPE_IDS),
            unit: "",
            help: "shape that the attraction points fill",
        },
        section: Section::Colonization,
        access: Access::Field { read: Preset::crown, write: Preset::write_crown },
    },
    row!(
        Colonization,
        "crown_base",
        real_or_auto(0.0, 1e3),
        "m",
        "height of the crown's base above the root; auto: on top of the trunk",
        colonization.crown_base_m
    ),
    row!(
        Colonization,
        "points",
        integer(1, 100_000_000),
        "points",
        "how many attraction points are drawn",
        colonization.points
    ),
    row!(
        Colonization,
        "step",
        real_or_auto(1e-5, 1e3),
        "m",
        "length of a segment (D); auto: from the spacing of the points",
        colonization.step_m
    ),
    row!(
        Colonization,
        "influence",
        length_or_auto(0.0, f64::INFINITY),
        "m",
        "how far a point pulls a node",
        colonization.influence
    ),
    row!(
        Colonization,
        "kill",
        length_or_auto(0.0, f64::INFINITY),
        "m",
        "how near a node must come to a point to reach it; at least the step",
        colonization.kill
    ),
    row!(
        Colonization,
        "max_iterations",
        integer(1, 1_000_000_000),
        "",
        "growth stops after so many iterations",
        colonization.max_iterations
    ),
    row!(
        Colonization,
        "max_nodes",
        integer(2, 4_000_000_000),
        "nodes",
        "growth stops at so many nodes",
        colonization.max_nodes
    ),
    row!(
        Colonization,
        "root",
        Kind::Vector { auto: true },
        "m",
        "where the tree stands; auto: below the crown, at the foot of a scan",
        colonization.root
    ),
    row!(
        Colonization,
        "trunk",
        real_or_auto(0.0, 1e3),
        "m",
        "height of the bare trunk; auto: until the first point is in reach",
        colonization.trunk_m
    ),
    row!(
        Colonization,
        "tropism",
        Kind::Vector { auto: false },
        "",
        "added to every growth direction (unit length before): 0,0.3,0 grows up",
        colonization.tropism
    ),
    row!(
        Colonization,
        "contract",
        Kind::Switch,
        "",
        "for given points: they lie on bark, as a scanner's do, and are moved onto the axes of branches first",
        colonization.contract
    ),
    row!(
        Colonization,
        "up",
        Kind::Choice(UpAxis::WORDS),
        "",
        "axis of an input file that points up; auto: z for XYZ, y for PLY and OBJ",
        colonization.up
    ),
    row!(
        Colonization,
        "origin",
        Kind::Choice(Origin::WORDS),
        "",
        "root: the tree is moved to stand on 0,0,0; keep: it stays where its input is; auto: root for points, keep for a mesh",
        colonization.origin
    ),
    row!(Wood, "radius_exponent", real(1.0, 10.0), "", "n of the pipe model r^n = sum of children's r^n: larger is a thinner trunk", .wood.radius_exponent),
    row!(Wood, "tip_radius", real_or_auto(1e-5, 10.0), "m", "radius of the thinnest twigs; auto: follows from the base", .wood.tip_radius_m),
    row!(Wood, "base_radius", real_or_auto(1e-5, 100.0), "m", "radius at the foot; auto: follows from the tips, or is 1/60 of the height", .wood.base_radius_m),
    row!(Surface, "sides", integer(3, 128), "", "sides of the thickest wood; thinner wood has fewer, down to 3", .tubes.sides),
    row!(Surface, "bark_tile", real(0.01, 100.0), "m", "edge of the square of bark that one picture covers", .tubes.bark_tile_m),
    row!(Bark, "bark", Kind::Choice(&BARK_STYLES), "", "kind of bark", .bark.style),
    row!(Bark, "bark_color", Kind::Color { auto: true }, "sRGB", "mean colour; auto: the usual one of its kind", .bark.color),
    row!(Bark, "bark_relief", real_or_auto(0.0, 0.5), "", "depth of the furrows, as a share of the picture's side; auto: the usual one of its kind", .bark.relief),
    row!(Bark, "bark_grain", real(0.0, 3.0), "", "strength of the grain: 0 polished, 1 usual", .bark.grain),
    row!(Bark, "bark_size", integer(16, 4096), "px", "side of the drawn pictures", .bark.size_px),
];
