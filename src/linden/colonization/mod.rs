//! Space colonization: crowns, points, growth (RLP07: Runions, Lane & Prusinkiewicz 2007).

pub mod crown;
pub mod growth;
pub(crate) mod plant;
pub mod scan;
pub mod scatter;
pub mod trunk;

pub use growth::{Growth, GrowthError, GrowthRule, Stop, grow};
pub use plant::{PartError, outline};
