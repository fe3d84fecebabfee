//! Space colonization: crowns, points, growth (RLP07: Runions, Lane & Prusinkiewicz 2007).

pub mod crown;
pub mod scan;
pub mod scatter;
