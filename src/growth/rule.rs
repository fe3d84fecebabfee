//! What a growth is told: lengths, limits, and the plant's habit.

use glam::{DVec3, Vec3};

use super::{FARTHEST_M, GrowthError};

/// How nodes follow points. Lengths in metres.
#[derive(Clone, Debug, PartialEq)]
pub struct GrowthRule {
    /// Length of an internode, `D` in RLP07; above zero.
    pub step: f32,
    /// How far a point makes itself felt, `d_i`; above `kill`, may be infinite. Beyond about 20 steps
    /// it costs far more time than it changes.
    pub influence: f32,
    /// How near a node must come to a point to use it up, `d_k`; not below `step`, or growth would
    /// step over points for ever.
    pub kill: f32,
    /// Added to each unit direction of growth: `(0, 0.2, 0)` bends branches up a little.
    pub tropism: Vec3,
    /// The most iterations.
    pub max_iterations: u32,
    /// The most nodes, those at the start included.
    pub max_nodes: u32,
    /// The habit, which sets a species apart; [`GrowthHabit::PLAIN`] is RLP07's rule.
    pub habit: GrowthHabit,
}

/// How a plant departs from RLP07's rule: what the module's documentation calls its habit.
#[derive(Clone, Debug, PartialEq)]
pub struct GrowthHabit {
    /// Which points pull at a node.
    pub attraction: Attraction,
    /// What is added of straight up to each unit direction of growth, by the order of the axis, 0 for
    /// the stem; the last number holds for all higher orders, none is zero. Below zero: downwards.
    pub gravitropism: Vec<f32>,
    /// As `gravitropism`, but towards the light.
    pub phototropism: Vec<f32>,
    /// The direction in which the light is; any length but zero.
    pub light: Vec3,
    /// What is added of straight down for each metre that a node lies sideways of its root: the lever
    /// by which a branch's weight bends it. 1/m.
    pub gravity: f32,
    /// From 0 to 1: which share of an axis, from its tip down, bears no laterals while the tip grows.
    pub apical_control: f32,
    /// The most children of a node, those at the start included; above zero.
    pub max_children: u32,
    /// In how many groups, in the order given, the points become active; above zero.
    pub waves: u32,
    /// How many iterations after a group the next one becomes active; 0: only when growth would end.
    pub wave_interval: u32,
}

linden_base::words! {
    /// Which points pull at a node.
    Attraction {
        /// Those to which no node is nearer, as in RLP07.
        Nearest = "nearest",
        /// All within the influence distance, as long as it is the nearest node to one of them.
        All = "all"
    }
}

impl GrowthHabit {
    /// Nothing but RLP07's rule.
    pub const PLAIN: Self = Self {
        attraction: Attraction::Nearest,
        gravitropism: Vec::new(),
        phototropism: Vec::new(),
        light: Vec3::Y,
        gravity: 0.0,
        apical_control: 0.0,
        max_children: u32::MAX,
        waves: 1,
        wave_interval: 0,
    };

    /// Whether nodes must know their place on the axes of the tree.
    pub(super) fn needs_axes(&self) -> bool {
        self.gravitropism.iter().chain(&self.phototropism).any(|&some| some != 0.0)
            || self.gravity != 0.0
            || self.apical_control > 0.0
    }

    fn check(&self) -> Result<(), GrowthError> {
        let wrong = |knob, problem| Err(GrowthError::GrowthHabit { knob, problem });
        for (knob, by_order) in [("gravitropism", &self.gravitropism), ("phototropism", &self.phototropism)] {
            if !by_order.iter().all(|some| some.is_finite()) {
                return wrong(knob, "must be finite for every order");
            }
        }
        if !self.gravity.is_finite() {
            return wrong("gravity", "must be finite");
        }
        if !(self.light.is_finite() && self.light != Vec3::ZERO) {
            return wrong("light", "must be a finite direction that is not zero");
        }
        if !(0.0..=1.0).contains(&self.apical_control) {
            return wrong("apical_control", "must be from 0 to 1");
        }
        if self.max_children == 0 {
            return wrong("max_children", "must be above zero");
        }
        if self.waves == 0 {
            return wrong("waves", "must be above zero");
        }
        Ok(())
    }
}

impl Default for GrowthHabit {
    fn default() -> Self {
        Self::PLAIN
    }
}

impl GrowthRule {
    pub(super) fn check(&self) -> Result<(), GrowthError> {
        let &Self { step, influence, kill, tropism, .. } = self;
        for (knob, value, most) in
            [("step", step, FARTHEST_M), ("kill", kill, FARTHEST_M), ("influence", influence, f32::INFINITY)]
        {
            // Written so that NaN fails.
            if !(value > 0.0 && value <= most) {
                return Err(GrowthError::Length { knob, value });
            }
        }
        if !tropism.is_finite() {
            return Err(GrowthError::Tropism(tropism));
        }
        if kill < step {
            return Err(GrowthError::KillBelowStep { kill, step });
        }
        if influence <= kill {
            return Err(GrowthError::InfluenceWithinKill { influence, kill });
        }
        self.habit.check()
    }

    /// What is added to the unit pull at a node of some order, `lever_m` sideways of its root.
    pub(super) fn bend(&self, order: u8, lever_m: f64) -> DVec3 {
        let GrowthHabit { gravitropism, phototropism, light, gravity, .. } = &self.habit;
        let of = |by_order: &[f32]| {
            let some = by_order.get(usize::from(order)).or(by_order.last());
            some.copied().map_or(0.0, f64::from)
        };
        let light = light.as_dvec3();
        let light = light / (light.x * light.x + light.y * light.y + light.z * light.z).sqrt();
        let mut bend = self.tropism.as_dvec3() + light * of(phototropism);
        bend.y += of(gravitropism) - f64::from(*gravity) * lever_m;
        bend
    }
}
