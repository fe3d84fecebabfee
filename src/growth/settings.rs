//! What every growth into attraction points can be told: lengths, limits, habit, and where the tree stands.

use glam::DVec3;
use linden_base::input::Up;
use linden_base::knob::{Field, Kind, Length, integer, length_or_auto, real, real_or_auto};
use linden_base::{field, words};
use linden_skeleton::generator::SampleSize;

use crate::{Attraction, GrowthHabit};

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
            step_m,
            details(
                "The unit of growth, D in Runions et al. 2007: each iteration places segments of this \
                 length, and influence and kill are best given in it. Short segments bend smoothly and take \
                 more nodes for the same wood; long ones give stiff, angular limbs. auto is a third of the \
                 mean spacing of the points; for a scan it is twice the spacing of its points or 1/1000 of \
                 its height, whichever is more. It cannot be above kill."
            ),
            see_also(&["influence", "kill", "points", "subdivisions"])
        ),
        field!(
            "influence",
            length_or_auto(0.0, f64::INFINITY),
            "m",
            "how far a point pulls a node",
            influence,
            details(
                "The distance d_i of Runions et al. 2007, whose figures have 8D to 17D. Small: limbs wind \
                 from point to point, and points far from any branch may never be reached. Large: limbs run \
                 far and straight towards the mean of many points. auto is 17D, for a scan 6D. It must be \
                 above kill; beyond 20D it takes much time and changes little."
            ),
            see_also(&["kill", "step", "attraction", "trunk"])
        ),
        field!(
            "kill",
            length_or_auto(0.0, f64::INFINITY),
            "m",
            "how near a node must come to a point to reach it; at least the step",
            kill,
            details(
                "The distance d_k of Runions et al. 2007, whose figures have 2D to 20D. At 2D dense fine \
                 twigs fill the crown; at 8D few branches are left, straight and far apart. auto is 3D, for \
                 a scan 2D. Growth would step over points for ever if it were below the step, so that is \
                 refused."
            ),
            see_also(&["influence", "step", "points"])
        ),
        field!(
            "age",
            real(0.0, 1.0),
            "",
            "how far growth has come: the young tree after this share of all iterations; 1: the whole tree",
            age,
            details(
                "The whole tree grows first; then what was not yet there is left out. At 0.3 the trunk and \
                 the first limbs stand where they stand at 1, with fewer twigs. By the pipe model the young \
                 trunk is thinner, because it bears fewer tips."
            ),
            see_also(&["max_iterations", "leaf_max_age", "width"])
        ),
        field!(
            "max_iterations",
            integer(1, 1_000_000_000),
            "",
            "growth stops after so many iterations",
            max_iterations,
            see_also(&["age", "max_nodes"])
        ),
        field!(
            "max_nodes",
            integer(2, 4_000_000_000),
            "nodes",
            "growth stops at so many nodes",
            max_nodes,
            see_also(&["max_iterations", "step", "points"])
        ),
        field!(
            "root",
            Kind::Vector { auto: true },
            "m",
            "where the tree stands; auto: below the crown, at the foot of a scan",
            root,
            details(
                "Given in the coordinates of the input. auto stands below the middle of an envelope, or \
                 where its body is lowest if there is none over the middle, as over that of a ring; on \
                 the ground y = 0 if the envelope hangs over it by no more than its height. An envelope of \
                 several shells that stand apart is a grove, a tree in each; with a root it is the crown \
                 of one tree. A place that is given stays the foot of the tree whatever origin says, which \
                 only decides where the finished tree is moved to."
            ),
            see_also(&["origin", "up", "trunk"])
        ),
        field!(
            "trunk",
            real_or_auto(0.0, 1e3),
            "m",
            "height of the bare trunk; auto: until the first point is in reach",
            trunk_m,
            details(
                "How far the stem rises straight up before growth begins. It carries a crown shape, too: \
                 the crown's base stands on top of it unless crown_base says otherwise. 0 lets branches \
                 leave the ground, as of a shrub. auto walks up until the first point is within influence; \
                 a crown shape then stands a quarter of its height above the ground, and in an envelope \
                 that is hollow below, or on legs, the trunk rises to the body over it. A crown beyond \
                 reach of the trunk is refused."
            ),
            see_also(&["crown_base", "influence", "root"])
        ),
        field!(
            "tropism",
            Kind::Vector { auto: false },
            "",
            "added to every growth direction (unit length before): 0,0.3,0 grows up",
            tropism,
            details(
                "The bias of Runions et al. 2007: it is added to each unit direction, which is then made a \
                 unit again, on stem and twigs alike. 0,0.3,0 lifts all branches a little; 0.3,0,0 combs \
                 the tree to one side, as steady wind does. At a length of 1 it weighs as much as all \
                 points together. gravitropism tells stem and branches apart."
            ),
            see_also(&["gravitropism", "phototropism", "gravity"])
        ),
        field!(
            "attraction",
            Kind::Choice(Attraction::WORDS),
            "",
            "points that pull at a node: those nearest to it, or all within the influence distance",
            attraction,
            details(
                "nearest is the rule of Runions et al. 2007: a point pulls at one node alone, and limbs \
                 part clearly. all lets every point in reach pull at a node, as long as one of them has no \
                 nearer node: directions are means of more points, and branches bend more softly. It takes \
                 more memory and time."
            ),
            see_also(&["influence", "kill"])
        ),
        field!(
            "gravitropism",
            BY_ORDER,
            "",
            "added upwards to growth directions, by order of the axis: 0.5 -0.2 lifts the stem and lets branches sag",
            gravitropism,
            details(
                "The first number is for the stem, the second for branches that leave it, and so on; the \
                 last holds for all further orders. 0.6 0.35 0 -0.15 is an upright stem with limbs that \
                 rise steeply and twigs that sag. Numbers near 1 weigh as much as the points, so that \
                 branches pass by what they grow for. Palubicki et al. 2009 weigh tropism against other \
                 directions of growth in the same way."
            ),
            see_also(&["tropism", "gravity", "phototropism", "apical_control"])
        ),
        field!(
            "phototropism",
            BY_ORDER,
            "",
            "added towards the light to growth directions, by order of the axis",
            phototropism,
            details(
                "As gravitropism, but towards light, which comes from one direction and is shaded by \
                 nothing. With light=1,1,0 and 0.3 the whole crown leans to +X; from straight overhead it \
                 is the same as gravitropism."
            ),
            see_also(&["light", "gravitropism"])
        ),
        field!(
            "light",
            Kind::Vector { auto: false },
            "",
            "direction to the light, for phototropism",
            light,
            details(
                "Only the direction counts, not the length. 0,1,0 is overhead; 1,0.3,0 comes from the side, \
                 as at the edge of a wood."
            ),
            see_also(&["phototropism"])
        ),
        field!(
            "gravity",
            real(-10.0, 10.0),
            "1/m",
            "added downwards to growth directions for each metre sideways of the root",
            gravity,
            details(
                "The lever by which its weight bends a branch: at 0.05 a tip 4 m out from the stem is drawn \
                 down as by gravitropism -0.2, one 1 m out hardly at all. So long boughs arch and hang at \
                 their ends. Below 0 the outer crown rises."
            ),
            see_also(&["gravitropism", "tropism"])
        ),
        field!(
            "apical_control",
            real(0.0, 1.0),
            "",
            "share of a growing axis, from its tip, that bears no laterals: 0 spreading, 1 one leader to the top",
            apical_control,
            details(
                "Nodes in this share of a growing axis wait with their laterals. At 0 they leave at once \
                 and the stem is lost among its limbs, as in an oak; at 0.5 one leaves when the axis is \
                 twice as long as up to there; at 1 when the axis has its length: one leader to the top, as \
                 in a fir. Apical control is about which branches grow most, apical dominance about which \
                 buds break (Wilson 2000)."
            ),
            see_also(&["gravitropism", "waves", "max_children"])
        ),
        field!(
            "max_children",
            integer(0, 1000),
            "",
            "most children of a node; 0: any number",
            max_children,
            details(
                "What continues an axis counts, too: 1 is a stem without branches, 2 lets one lateral leave \
                 at each node. Points of a node that has its number wait for other nodes."
            ),
            see_also(&["apical_control"])
        ),
        field!(
            "waves",
            integer(1, 1000),
            "",
            "groups in which the points appear, one after the other",
            waves,
            details(
                "1 is Runions et al. 2007: all points are there from the start. With 6 to 14 a few great \
                 limbs cross the crown for the first points, and branches of later ones fill the gaps \
                 between them. The points of each group are drawn from the whole crown."
            ),
            see_also(&["wave_interval", "points", "apical_control"])
        ),
        field!(
            "wave_interval",
            integer(0, 1_000_000_000),
            "iterations",
            "from one wave to the next; 0: when growth would end",
            wave_interval,
            details(
                "With 0 a group waits until the tree has nothing left to grow for. A small number lets \
                 groups follow one another so fast that the tree looks as with waves=1."
            ),
            see_also(&["waves"])
        ),
    ];

    /// The knobs that say where the tree stands in the coordinates of its input.
    pub const PLACE_FIELDS: &[Field<Self>] = &[
        field!(
            "up",
            Kind::Choice(UpAxis::WORDS),
            "",
            "axis of an input file that points up; auto: z for XYZ, y for PLY and OBJ, the other where a scan's stem stands along it",
            up,
            see_also(&["root", "origin", "scale"])
        ),
        field!(
            "origin",
            Kind::Choice(Origin::WORDS),
            "",
            "root: the tree is moved to stand on 0,0,0; keep: it stays where its input is; auto: root for points, keep for a mesh",
            origin,
            see_also(&["root", "up"])
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

    pub(crate) fn habit(&self) -> GrowthHabit {
        let by_order = |numbers: &[f64]| numbers.iter().map(|&x| x as f32).collect();
        GrowthHabit {
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
