//! What all of linden stands on: settings and their descriptions, keyed randomness, progress and memory
//! limits, colours, pictures, meshes, and the files that users bring.
//!
//! | module | is |
//! |---|---|
//! | [`knob`] | a named, bounded, explained setting, and what users may type for it |
//! | [`document`] | TOML and JSON as trees of values that know their places |
//! | [`random`] | randomness keyed by paths: no order and no thread changes a choice |
//! | [`monitor`] | progress, cancelling, and asking for memory before it is taken |
//! | [`memory`] | forecasts of memory, and the error when there is not enough |
//! | [`input`] | meshes, points and pictures that users bring, from their bytes |
//! | [`mesh`] | triangles, and boxes around them |
//! | [`last`] | the last thing that was worked out, kept for whoever asks again |
//! | [`hull`] | convex hulls of points, in the plane and in space |
//! | [`topology`] | whether a mesh is closed, and what is wrong with it |
//! | [`picture`] | pixels, and what they are as PNG, JPEG and WebP |
//! | [`color`] | sRGB and linear light |
//!
//! Takes bytes and values, gives values: opens no file, reads no clock, writes to no terminal. Knows no tree.
//!
//! ```
//! use linden_base::knob::{Kind, Value};
//! let angle = Kind::Real { min: -360.0, max: 360.0, auto: false, names: &[] };
//! assert_eq!(angle.parse("22.5"), Ok(Value::Real(22.5)));
//! assert!(angle.parse("400").is_err());
//! ```

pub mod color;
pub mod document;
pub mod hull;
pub mod input;
pub mod knob;
pub mod last;
pub mod memory;
pub mod mesh;
pub mod monitor;
pub mod picture;
pub mod random;
pub mod topology;

pub use glam;
