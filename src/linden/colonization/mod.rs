//! Space colonization: crowns, points, growth (RLP07: Runions, Lane & Prusinkiewicz 2007).

pub mod crown;
pub mod growth;
pub(crate) mod plant;
pub mod scan;
pub mod scatter;
pub mod trunk;

pub use growth::{
    Attraction, Growth, GrowthError, GrowthRule, Habit, Meet, NodeSet, Obstacle, Stop, grow, grow_among,
};
pub use plant::{PartError, outline};
