//! What every growth into attraction points can be told: lengths, limits, habit, and where the tree stands.

use glam::DVec3;
use linden_base::input::Up;
use linden_base::knob::{Field, Kind, Length, integer, length_or_auto, real, real_or_auto};
use linden_base::{field, words};
use linden_skeleton::generator::SampleSize;

use crate::{Attraction, Habit};

words! {
    /// Which axis of an input file points up.
    UpAxis {
        /// The one that is usual for the format: z for XYZ, y for PLY and OBJ.
        Auto = "auto",
        /// y.
        Y = "y",
        /// z.
        Z = "z"
    }
}

words! {
    /// Whether a tree is moved to stand on the origin.
    Origin {
        /// Moved when it grows into given points, kept in a mesh.
        Auto = "auto",
        /// Moved.
        Root = "root",
        /// Kept where its input is.
        Keep = "keep"
    }
}

/// How a tree grows into attraction points, wherever these come from.
#[derive(Clone, Debug, PartialEq)]
pub struct GrowthSettings {
    /// `D`: length of a segment, metres; `None`: from the spacing of the points.
    pub step_m: Option<f64>,
    /// How far a point pulls.
    pub influence: Length,
    /// How near a node must come to a point for it to be reached.
    pub kill: Length,
    /// How far growth has come: the share of its iterations.
    pub age: f64,
    /// Growth stops after this number of iterations.
    pub max_iterations: u32,
    /// Growth stops at this number of nodes.
    pub max_nodes: u32,
    /// Where the tree stands, metres, in the coordinates of the input; `None`: below the crown, at
    /// the foot of a scan.
    pub root: Option<[f64; 3]>,
    /// Height of the bare trunk, metres; `None`: until the first point is in reach.
    pub trunk_m: Option<f64>,
    /// Added to every growth direction.
    pub tropism: [f64; 3],
    /// Which points pull at a node.
    pub attraction: Attraction,
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
    /// Which axis of an input file points up.
    pub up: UpAxis,
    /// Whether the tree is moved to stand on the origin.
    pub origin: Origin,
}

impl Default for GrowthSettings {
    fn default() -> Self {
        Self {
            step_m: None,
            influence: Length::Auto,
            kill: Length::Auto,
            age: 1.0,
            max_iterations: 100_000,
            max_nodes: 50_000_000,
            root: None,
            trunk_m: None,
            tropism: [0.0; 3],
            attraction: Attraction::Nearest,
            gravitropism: vec![0.0],
            phototropism: vec![0.0],
            light: [0.0, 1.0, 0.0],
            gravity: 0.0,
            apical_control: 0.0,
            max_children: 0,
            waves: 1,
            wave_interval: 0,
            up: UpAxis::Auto,
            origin: Origin::Auto,
        }
    }
}

/// A number for each order of axes, the last for all higher ones.
const BY_ORDER: Kind = Kind::Reals { min: -10.0, max: 10.0, most: 8 };

impl GrowthSettings {
    /// The knobs of growth itself.
    pub const FIELDS: &[Field<Self>] = &[
        field!(
            "step",
            real_or_auto(1e-5, 1e3),
            "m",
            "length of a segment (D); auto: from the spacing of the points",
            step_m
        ),
        field!(
            "influence",
            length_or_auto(0.0, f64::INFINITY),
            "m",
            "how far a point pulls a node",
            influence
        ),
        field!(
            "kill",
            length_or_auto(0.0, f64::INFINITY),
            "m",
            "how near a node must come to a point to reach it; at least the step",
            kill
        ),
        field!(
            "age",
            real(0.0, 1.0),
            "",
            "how far growth has come: the young tree after this share of all iterations; 1: the whole tree",
            age
        ),
        field!(
            "max_iterations",
            integer(1, 1_000_000_000),
            "",
            "growth stops after so many iterations",
            max_iterations
        ),
        field!("max_nodes", integer(2, 4_000_000_000), "nodes", "growth stops at so many nodes", max_nodes),
        field!(
            "root",
            Kind::Vector { auto: true },
            "m",
            "where the tree stands; auto: below the crown, at the foot of a scan",
            root
        ),
        field!(
            "trunk",
            real_or_auto(0.0, 1e3),
            "m",
            "height of the bare trunk; auto: until the first point is in reach",
            trunk_m
        ),
        field!(
            "tropism",
            Kind::Vector { auto: false },
            "",
            "added to every growth direction (unit length before): 0,0.3,0 grows up",
            tropism
        ),
        field!(
            "attraction",
            Kind::Choice(Attraction::WORDS),
            "",
            "points that pull at a node: those nearest to it, or all within the influence distance",
            attraction
        ),
        field!(
            "gravitropism",
            BY_ORDER,
            "",
            "added upwards to growth directions, by order of the axis: 0.5 -0.2 lifts the stem and lets branches sag",
            gravitropism
        ),
        field!(
            "phototropism",
            BY_ORDER,
            "",
            "added towards the light to growth directions, by order of the axis",
            phototropism
        ),
        field!("light", Kind::Vector { auto: false }, "", "direction to the light, for phototropism", light),
        field!(
            "gravity",
            real(-10.0, 10.0),
            "1/m",
            "added downwards to growth directions for each metre sideways of the root",
            gravity
        ),
        field!(
            "apical_control",
            real(0.0, 1.0),
            "",
            "share of a growing axis, from its tip, that bears no laterals: 0 spreading, 1 one leader to the top",
            apical_control
        ),
        field!("max_children", integer(0, 1000), "", "most children of a node; 0: any number", max_children),
        field!(
            "waves",
            integer(1, 1000),
            "",
            "groups in which the points appear, one after the other",
            waves
        ),
        field!(
            "wave_interval",
            integer(0, 1_000_000_000),
            "iterations",
            "from one wave to the next; 0: when growth would end",
            wave_interval
        ),
    ];

    /// The knobs that say where the tree stands in the coordinates of its input.
    pub const PLACE_FIELDS: &[Field<Self>] = &[
        field!(
            "up",
            Kind::Choice(UpAxis::WORDS),
            "",
            "axis of an input file that points up; auto: z for XYZ, y for PLY and OBJ, the other where a scan's stem stands along it",
            up
        ),
        field!(
            "origin",
            Kind::Choice(Origin::WORDS),
            "",
            "root: the tree is moved to stand on 0,0,0; keep: it stays where its input is; auto: root for points, keep for a mesh",
            origin
        ),
    ];

    /// Whether the tree is moved to stand on the origin.
    pub fn moves_to_root(&self, unless_told: bool) -> bool {
        match self.origin {
            Origin::Root => true,
            Origin::Keep => false,
            Origin::Auto => unless_told,
        }
    }

    /// From the coordinates of a [`Site`](crate::site::Site) to where the tree is to stand.
    pub fn shift(&self, root: DVec3, origin: DVec3, moves_unless_told: bool) -> DVec3 {
        if self.moves_to_root(moves_unless_told) { -root } else { origin }
    }

    /// The axis that points up in an input file.
    pub fn up(&self, default: Up) -> Up {
        self.given_up().unwrap_or(default)
    }

    /// The axis that the user says points up.
    pub const fn given_up(&self) -> Option<Up> {
        match self.up {
            UpAxis::Y => Some(Up::Y),
            UpAxis::Z => Some(Up::Z),
            UpAxis::Auto => None,
        }
    }

    /// The root that the user gave, turned to Y up.
    pub fn given_root(&self, up: Up) -> Option<DVec3> {
        self.root.map(|root| {
            let mut place = [DVec3::from_array(root)];
            up.to_y_up(&mut place);
            place[0]
        })
    }

    /// Leaves the tree where its input has it, unless it was told to stand elsewhere.
    pub fn stay(&mut self) {
        if self.origin == Origin::Auto {
            self.origin = Origin::Keep;
        }
    }

    /// Lowers the limit of nodes; whether a tree with as many was cut short.
    ///
    /// # Errors
    /// Too many points to begin with.
    pub fn limit(&mut self, points: usize, size: &SampleSize) -> Result<bool, String> {
        if points > size.points {
            return Err(format!("{points} points"));
        }
        let is_lowered = self.max_nodes > size.nodes;
        self.max_nodes = self.max_nodes.min(size.nodes);
        Ok(is_lowered)
    }

    /// Why a knob changes nothing as these settings stand, and what would let it.
    pub fn idle(&self, knob: &str) -> Option<&'static str> {
        match knob {
            "light" if self.phototropism.iter().all(|&x| x == 0.0) => Some("phototropism is 0"),
            "wave_interval" if self.waves == 1 => Some("waves is 1"),
            _ => None,
        }
    }

    pub(crate) fn habit(&self) -> Habit {
        let by_order = |numbers: &[f64]| numbers.iter().map(|&x| x as f32).collect();
        Habit {
            attraction: self.attraction,
            gravitropism: by_order(&self.gravitropism),
            phototropism: by_order(&self.phototropism),
            light: DVec3::from_array(self.light).as_vec3(),
            gravity: self.gravity as f32,
            apical_control: self.apical_control as f32,
            max_children: if self.max_children == 0 { u32::MAX } else { self.max_children },
            waves: self.waves,
            wave_interval: self.wave_interval,
        }
    }
}
