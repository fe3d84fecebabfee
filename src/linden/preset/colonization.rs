//! `[colonization]`: where the attraction points are, and how the tree reaches for them.

use super::knobs::{Access, PresetKnob, Section, integer, length_or_auto, real, real_or_auto, row};
use super::setting::{Length, Origin, Pull, ScanRadius, UpAxis};
use super::{Generator, Part, Preset};
use crate::colonization::crown::{self, SHAPES};
use crate::knob::{Kind, Knob, Value};

/// Where the attraction points are, and how the tree reaches for them.
#[derive(Clone, Debug, PartialEq)]
pub struct Colonization {
    /// What the crown fills.
    pub space: Space,
    /// What else there is: pieces of the crown, other trees, obstacles, shade. In the order of the
    /// document, which matters: each adds to or takes from what was there before.
    pub parts: Vec<Part>,
    /// Height of a crown shape's base above the root, metres; `None`: on top of the trunk.
    pub crown_base_m: Option<f64>,
    /// How far growth has come: the share of its iterations.
    pub age: f64,
    /// How many attraction points are drawn in a crown.
    pub points: u32,
    /// How far points gather near the crown's surface, 0 to 1; see [`crate::colonization::crown::favor`].
    pub shell_density: f64,
    /// How far points gather at the crown's top, 0 to 1.
    pub top_density: f64,
    /// How far points gather in clumps, 0 to 1; see [`crate::colonization::crown::clumps`].
    pub clumps: f64,
    /// Distance of clumps, metres; `None`: a fifth of the crown's longest side.
    pub clump_size_m: Option<f64>,
    /// `D`: length of a segment, metres; `None`: from the spacing of the points.
    pub step_m: Option<f64>,
    /// How far a point pulls.
    pub influence: Length,
    /// How near a node must come to a point for it to be reached.
    pub kill: Length,
    /// Growth stops after so many iterations.
    pub max_iterations: u32,
    /// Growth stops at so many nodes.
    pub max_nodes: u32,
    /// Where the tree stands, metres, in the coordinates of the input; `None`: below the crown, at
    /// the foot of a scan.
    pub root: Option<[f64; 3]>,
    /// Height of the bare trunk, metres; `None`: until the first point is in reach.
    pub trunk_m: Option<f64>,
    /// Added to every growth direction.
    pub tropism: [f64; 3],
    /// Which points pull at a node.
    pub attraction: Pull,
    /// Added straight up to growth directions, by the order of the axis; at least one number.
    pub gravitropism: Vec<f64>,
    /// Added towards the light to growth directions, by the order of the axis; at least one number.
    pub phototropism: Vec<f64>,
    /// Direction to the light, not zero.
    pub light: [f64; 3],
    /// Added straight down for each metre sideways of the root, 1/m.
    pub gravity: f64,
    /// Share of a growing axis, from its tip, that bears no laterals.
    pub apical_control: f64,
    /// The most children of a node; 0: any number.
    pub max_children: u32,
    /// Groups in which the points become active.
    pub waves: u32,
    /// Iterations from one group to the next; 0: when growth would end.
    pub wave_interval: u32,
    /// Whether given points lie on the surface of a tree, as a scanner's do, and are moved onto its
    /// axes first.
    pub contract: bool,
    /// Where the radii of a scanned tree come from.
    pub scan_radius: ScanRadius,
    /// Whether points of a scan that hardly any others are near are left out.
    pub noise_filter: bool,
    /// How many stems a scan shows, rounded; `None`: as many as stand apart on the ground.
    pub stems: Option<f64>,
    /// Metres for a unit of given points; `None`: 1, or what makes a possible tree of a scan.
    pub scale: Option<f64>,
    /// Which axis of an input file points up.
    pub up: UpAxis,
    /// Whether the tree is moved to stand on the origin.
    pub origin: Origin,
}

/// What the crown fills.
#[derive(Clone, Debug, PartialEq)]
pub enum Space {
    /// One of [`crate::colonization::crown::SHAPES`], with the dimensions that were set.
    Shape {
        /// Its id.
        shape: String,
        /// What was set of its knobs.
        dimensions: Vec<(&'static str, Value)>,
    },
    /// The inside of a mesh.
    Envelope {
        /// The file, relative to the preset's.
        file: String,
    },
    /// Points that are given, as by a scanner.
    Points {
        /// The file, relative to the preset's.
        file: String,
    },
}

impl Space {
    /// The file that is needed beside the preset.
    pub fn file(&self) -> Option<&str> {
        match self {
            Self::Shape { .. } => None,
            Self::Envelope { file } | Self::Points { file } => Some(file),
        }
    }
}

impl Colonization {
    /// A space with everything else as it is when nobody says.
    pub(super) fn of(space: Space) -> Self {
        Self {
            space,
            parts: Vec::new(),
            crown_base_m: None,
            age: 1.0,
            points: 2000,
            shell_density: 0.0,
            top_density: 0.0,
            clumps: 0.0,
            clump_size_m: None,
            step_m: None,
            influence: Length::Auto,
            kill: Length::Auto,
            max_iterations: 100_000,
            max_nodes: 50_000_000,
            root: None,
            trunk_m: None,
            tropism: [0.0; 3],
            attraction: Pull::Nearest,
            gravitropism: vec![0.0],
            phototropism: vec![0.0],
            light: [0.0, 1.0, 0.0],
            gravity: 0.0,
            apical_control: 0.0,
            max_children: 0,
            waves: 1,
            wave_interval: 0,
            contract: true,
            scan_radius: ScanRadius::Points,
            noise_filter: true,
            stems: None,
            scale: None,
            up: UpAxis::Auto,
            origin: Origin::Auto,
        }
    }
}

/// The ids of all crown shapes.
pub(super) const SHAPE_IDS: [&str; SHAPES.len()] = {
    let mut ids = [""; SHAPES.len()];
    let mut i = 0;
    while i < ids.len() {
        ids[i] = SHAPES[i].id;
        i += 1;
    }
    ids
};

/// What to do instead where a crown's shape is said to be a mesh: `instead`, as an end for the message that
/// `word` is no shape. Empty for other words.
pub(super) fn mesh_hint(word: &str, instead: &str) -> String {
    let word = word.trim().to_ascii_lowercase();
    let is_file = [".obj", ".ply"].iter().any(|ending| word.ends_with(ending));
    let is_mesh = is_file || ["mesh", "envelope", "file", "obj", "ply"].contains(&word.as_str());
    if is_mesh { format!("; {instead}") } else { String::new() }
}

/// A number for each order of axes, the last for all higher ones.
const BY_ORDER: Kind = Kind::Reals { min: -10.0, max: 10.0, most: 8 };

/// The section's knobs, without those of the crown shapes.
pub(super) const KNOBS: &[PresetKnob] = &[
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
        "shell_density",
        real(0.0, 1.0),
        "",
        "how far the points gather near the crown's surface; 0: evenly, 1: the heart has a twentieth of its density",
        colonization.shell_density
    ),
    row!(
        Colonization,
        "top_density",
        real(0.0, 1.0),
        "",
        "how far the points gather at the crown's top; 0: evenly, 1: the base has a twentieth of its density",
        colonization.top_density
    ),
    row!(
        Colonization,
        "clumps",
        real(0.0, 1.0),
        "",
        "how far the points gather in clumps, as leaves do at the ends of limbs; 0: evenly, 1: a twentieth is left between them",
        colonization.clumps
    ),
    row!(
        Colonization,
        "clump_size",
        real_or_auto(1e-3, 1e3),
        "m",
        "distance of neighbouring clumps; auto: a fifth of the crown's longest side",
        colonization.clump_size_m
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
        "age",
        real(0.0, 1.0),
        "",
        "how far growth has come: the young tree after this share of all iterations; 1: the whole tree",
        colonization.age
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
        "attraction",
        Kind::Choice(Pull::WORDS),
        "",
        "points that pull at a node: those nearest to it, or all within the influence distance",
        colonization.attraction
    ),
    row!(
        Colonization,
        "gravitropism",
        BY_ORDER,
        "",
        "added upwards to growth directions, by order of the axis: 0.5 -0.2 lifts the stem and lets branches sag",
        colonization.gravitropism
    ),
    row!(
        Colonization,
        "phototropism",
        BY_ORDER,
        "",
        "added towards the light to growth directions, by order of the axis",
        colonization.phototropism
    ),
    row!(
        Colonization,
        "light",
        Kind::Vector { auto: false },
        "",
        "direction to the light, for phototropism",
        colonization.light
    ),
    row!(
        Colonization,
        "gravity",
        real(-10.0, 10.0),
        "1/m",
        "added downwards to growth directions for each metre sideways of the root",
        colonization.gravity
    ),
    row!(
        Colonization,
        "apical_control",
        real(0.0, 1.0),
        "",
        "share of a growing axis, from its tip, that bears no laterals: 0 spreading, 1 one leader to the top",
        colonization.apical_control
    ),
    row!(
        Colonization,
        "max_children",
        integer(0, 1000),
        "",
        "most children of a node; 0: any number",
        colonization.max_children
    ),
    row!(
        Colonization,
        "waves",
        integer(1, 1000),
        "",
        "groups in which the points appear, one after the other",
        colonization.waves
    ),
    row!(
        Colonization,
        "wave_interval",
        integer(0, 1_000_000_000),
        "iterations",
        "from one wave to the next; 0: when growth would end",
        colonization.wave_interval
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
        "scan_radius",
        Kind::Choice(ScanRadius::WORDS),
        "",
        "radii of a scanned tree; points: from the points on its bark, where there are enough; pipe: as of any tree",
        colonization.scan_radius
    ),
    row!(
        Colonization,
        "noise_filter",
        Kind::Switch,
        "",
        "points of a scan that hardly any others are near are left out",
        colonization.noise_filter
    ),
    row!(
        Colonization,
        "stems",
        real_or_auto(1.0, 1000.0),
        "stems",
        "stems of a scan, each with a root; auto: those that stand clearly apart on the ground",
        colonization.stems
    ),
    row!(
        Colonization,
        "scale",
        real_or_auto(1e-6, 1e6),
        "m",
        "metres for a unit of given points; auto: 1, for a scan 0.01 or 0.001 where 1 would make it higher than trees are",
        colonization.scale
    ),
    row!(
        Colonization,
        "up",
        Kind::Choice(UpAxis::WORDS),
        "",
        "axis of an input file that points up; auto: z for XYZ, y for PLY and OBJ, the other where a scan's stem stands along it",
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
];

impl Preset {
    pub(super) fn colonization(&self) -> Option<&Colonization> {
        if let Generator::Colonization(own) = &self.generator { Some(own) } else { None }
    }

    pub(super) fn colonization_mut(&mut self) -> Option<&mut Colonization> {
        if let Generator::Colonization(own) = &mut self.generator { Some(own) } else { None }
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
            if let Ok(new) = crown::shape(&word) {
                *dimensions = new.complete(dimensions);
            }
            *shape = word;
        }
    }
}
