//! Space colonization: crowns, points, growth (RLP07: Runions, Lane & Prusinkiewicz 2007).

pub mod growth;

pub use growth::{Growth, GrowthError, GrowthRule, Stop, grow};
