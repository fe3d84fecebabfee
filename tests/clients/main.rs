//! What other programs make of our files.

// A test's helpers panic like the test itself.
#![allow(clippy::unwrap_used, clippy::expect_used)]

mod ages;
mod assembly;
mod blend;
mod bones;
mod collision;
mod compressed;
mod crates;
mod cylinders;
mod foliage;
mod instances;
mod levels;
mod lint;
mod mat;
mod mtg;
mod nanite;
mod numbers;
mod organs;
mod outside;
mod pivots;
mod presets;
mod read_back;
mod references;
mod seasons;
mod skeletons;
mod solid;
mod stage;
mod studio;
mod wind;
