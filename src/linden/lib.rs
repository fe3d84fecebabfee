//! Grows trees: presets → generators → skeleton → surface → scene.
//!
//! Takes bytes and values, gives values. This crate opens no file, reads no clock and writes to no
//! terminal; the same recipe gives the same bits on any machine and any number of threads.
//! Lengths are metres, Y is up, angles in the interface are degrees unless a name says `_rad`.

pub mod colonization;
pub mod color;
pub mod detail;
pub mod dress;
pub mod foliage;
pub mod forecast;
pub mod forest;
pub mod grow;
pub mod input;
pub mod knob;
pub mod lsystem;
pub mod memory;
pub mod monitor;
pub mod picture;
pub mod preset;
pub mod random;
pub mod recipe;
pub mod scene;
pub mod season;
pub mod skeleton;
pub mod stage;
pub mod surface;
pub mod texture;
pub mod wind;

pub use glam::{DVec3, Vec2, Vec3};
pub use monitor::{Cancelled, Monitor, Quiet};
pub use skeleton::{Branching, NO_PARENT, Skeleton};
