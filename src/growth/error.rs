//! Why nothing can grow.

use glam::Vec3;

use super::FARTHEST_M;
use linden_base::memory::OverMemory;
use linden_base::monitor::Cancelled;

/// Why nothing can grow.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum GrowthError {
    /// A length of the rule is zero, negative, not a number, or too long.
    #[error(
        "cannot grow: {knob} is {value} m, but must be above zero and at most {FARTHEST_M:e} m \
         (only influence may be infinite)"
    )]
    Length {
        /// `step`, `influence` or `kill`.
        knob: &'static str,
        /// Metres.
        value: f32,
    },
    /// A component of the tropism is not finite.
    #[error("cannot grow: tropism is ({}, {}, {}), but must be finite", .0.x, .0.y, .0.z)]
    Tropism(Vec3),
    /// Growth would step over points for ever.
    #[error(
        "cannot grow: the kill distance, {kill} m, is shorter than the step, {step} m, so nodes would step \
         over points without using them up; raise kill to at least {step} m or shorten step"
    )]
    KillBelowStep {
        /// Metres.
        kill: f32,
        /// Metres.
        step: f32,
    },
    /// Every point would die before it could be felt.
    #[error(
        "cannot grow: the influence distance, {influence} m, is not above the kill distance, {kill} m, so \
         points would be used up before they are felt; raise influence or lower kill"
    )]
    InfluenceWithinKill {
        /// Metres.
        influence: f32,
        /// Metres.
        kill: f32,
    },
    /// A value of the habit is out of its range.
    #[error("cannot grow: {knob} {problem}")]
    GrowthHabit {
        /// The knob.
        knob: &'static str,
        /// What it must be.
        problem: &'static str,
    },
    /// There is nothing to grow towards.
    #[error("cannot grow: there are no attraction points; ask for at least one")]
    NoPoints,
    /// Points are counted in 32 bits.
    #[error("cannot grow: {0} attraction points are more than the {max} that can be counted", max = u32::MAX)]
    TooManyPoints(usize),
    /// A point has a coordinate that is not finite or too large.
    #[error(
        "cannot grow: attraction point {index} lies at ({}, {}, {}), but coordinates must be finite and within \
         ±{FARTHEST_M:e} m; remove or move it", .at.x, .at.y, .at.z
    )]
    Point {
        /// Index into the points given.
        index: usize,
        /// Metres.
        at: Vec3,
    },
    /// There is nothing to grow from.
    #[error("cannot grow: there is no node to grow from; give at least a root")]
    NoStart,
    /// The nodes to grow from are not a branching structure.
    #[error("cannot grow: node {index} of the start {problem}")]
    Start {
        /// Index of the node.
        index: usize,
        /// What is wrong with it.
        problem: &'static str,
    },
    /// No live point is within the influence distance of a node at the start.
    #[error(
        "cannot grow: nothing is in reach; the nearest attraction point is {nearest_m} m away and the influence \
         distance is {influence_m} m; raise influence, or let a trunk lead to the crown"
    )]
    NothingInReach {
        /// Distance of the nearest live point from the nearest node, metres.
        nearest_m: f32,
        /// Metres.
        influence_m: f32,
    },
    /// The points, or the nodes that grow, would take more memory than there may be.
    #[error(transparent)]
    Memory(#[from] OverMemory),
    /// Nobody wants the result any more.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// Why nothing grew into the points of a [`Site`](crate::site::Site).
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum StandError {
    /// The result was no longer wanted.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// There is no memory for what comes next.
    #[error(transparent)]
    Memory(#[from] OverMemory),
    /// Growth itself.
    #[error(transparent)]
    Growth(GrowthError),
    /// No iteration placed a node.
    #[error(
        "nothing grew: {reached} of {points} points lie within the kill distance ({kill_m} m) of the root or \
         trunk from the start; lower kill or step, or move root away"
    )]
    NothingGrew {
        /// All attraction points.
        points: usize,
        /// Those that were used up at the start.
        reached: usize,
        /// Metres.
        kill_m: f32,
    },
    /// Obstacles stand in every way.
    #[error("nothing grew: obstacles stand in the way of every first step; move root, or what is in the way")]
    WalledIn,
    /// Single precision cannot hold a tree there.
    #[error(
        "the tree would stand {farthest_m:.0} m from the origin, where coordinates in single precision are \
         {gap_m:.1e} m apart, too coarse for steps of {step_m} m; use origin=root, or a nearer root"
    )]
    TooFar {
        /// Largest coordinate of the root, metres.
        farthest_m: f64,
        /// Distance of neighbouring numbers there, metres.
        gap_m: f64,
        /// Length of a segment, metres.
        step_m: f64,
    },
    /// A trunk of too many segments.
    #[error(
        "the trunk would have {segments:.0} segments, more than max_nodes={max_nodes}; shorten trunk or lengthen step"
    )]
    TrunkTooLong {
        /// Trunk ÷ step.
        segments: f64,
        /// The limit.
        max_nodes: u32,
    },
}

linden_base::from_cancellable!(StandError: GrowthError => Growth);
