//! Grows trees: presets → generators → skeleton → surface → scene.
//!
//! Takes bytes and values, gives values. This crate opens no file, reads no clock and writes to no
//! terminal; the same recipe gives the same bits on any machine and any number of threads.
//! Lengths are metres, Y is up, angles in the interface are degrees unless a name says `_rad`.
//!
//! | module | is |
//! |---|---|
//! | [`preset`] | documents ⇄ settings, built-in presets, the table of all knobs |
//! | [`recipe`] | a preset with its files: everything to grow the same tree again |
//! | [`provenance`] | fingerprints of recipes and trees, and whether a tree is the one that it was |
//! | [`generators`] | the registry of generators |
//! | [`grow`](mod@grow) | recipe → skeleton |
//! | [`dress`](mod@dress) | skeleton → scene, levels of detail, seasons |
//! | [`report`] | every number of a tree, with its definition |
//! | [`forest`] | many trees, laid out |
//! | [`manifest`] | many trees: sources, seeds and values of knobs, as numbered items |
//! | [`forecast`] | how large a tree will be, before it is grown |
//!
//! What these stand on is here too, by its names: [`knob`], [`input`], [`picture`], [`monitor`] …
//! (`linden_base`), [`skeleton`], [`lsystem`], [`colonization`], [`scan`], [`growth`], and, of
//! `linden_plant`, [`surface`], [`foliage`], [`texture`], [`wind`], [`scene`], [`stage`].
//!
//! Programs have all of it from the crate `linden`, under the same names: where an example says `linden_pipeline::`, they
//! write `linden::`.

pub mod dress;
pub mod forecast;
pub mod forest;
pub mod generators;
pub mod grow;
pub mod manifest;
pub mod preset;
pub mod provenance;
pub mod recipe;
pub mod report;

pub use linden_base::{color, document, glam, hull, input, knob, memory, mesh, monitor, picture, random};
pub use linden_colonization as colonization;
pub use linden_growth as growth;
pub use linden_lsystem as lsystem;
pub use linden_plant::{Body, Specimen, Wanted};
pub use linden_plant::{canopy, detail, foliage, scene, season, settings, stage, surface, texture, wind};
pub use linden_qsm as qsm;
pub use linden_scan as scan;
pub use linden_self_organizing as self_organizing;
pub use linden_skeleton as skeleton;
pub use linden_weber_penn as weber_penn;

pub use glam::{DVec3, Vec2, Vec3};
pub use monitor::{Cancelled, Monitor, Quiet};
pub use skeleton::{Branching, Edge, NO_PARENT, Skeleton};
