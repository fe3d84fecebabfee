//! The parametric trees of Weber & Penn 1995, *Creation and Rendering of Realistic Trees* (SIGGRAPH 95).
//!
//! A tree is stems on stems: a trunk of level 0, branches of level 1, and so on. Each level has its parameters:
//! how long its stems are, at which angles they leave, how they bend, fork and thin. Stems of the last level bear
//! leaves.
//!
//! | module | is |
//! |---|---|
//! | [`WeberPenn`] | the parameters, by the paper's names, and their knobs |
//! | [`CrownShape`], [`Envelope`] | how long branches are by where they leave the trunk; what prunes them |
//! | [`tapered`] | how thick a stem is along its length |
//! | [`grow()`] | all stems, level by level, on any number of threads the same |
//! | [`forecast()`] | how many there will be, in closed form |
//! | [`read_parameters`] | parameter files of Arbaro, Sapling and tree-gen |
//! | [`GENERATOR`] | the generator |
//!
//! Takes settings and a key, gives a branching with radii, and leaves. Knows no preset and opens no file.
//!
//! ```
//! use linden_base::monitor::Quiet;
//! use linden_base::random::Key;
//! use linden_weber_penn::{WeberPenn, grow};
//!
//! let mut settings = WeberPenn::default();
//! settings.branches = vec![1.0, 20.0, 10.0];
//! settings.leaves = 8.0;
//! let drawn = grow(&settings, Key::new(7), &Quiet)?;
//! assert_eq!(drawn.stems[..2], [1, 20]);
//! assert!(drawn.organs.len() > 500);
//! # Ok::<(), linden_weber_penn::WeberPennError>(())
//! ```

mod course;
mod error;
mod forecast;
mod generator;
mod grow;
mod knobs;
mod leaf;
mod level;
mod read;
mod sample;
mod settings;
mod shape;
mod stem;
mod taper;

pub use error::WeberPennError;
pub use forecast::{Forecast, LevelForecast, forecast};
pub use generator::GENERATOR;
pub use grow::{Drawn, MAX_LEAVES, grow};
pub use read::{MAX_BYTES, ParameterFile, ParameterLook, Program, read_parameters};
pub use settings::{MAX_LEVELS, WeberPenn};
pub use shape::{CrownShape, Dialect, Envelope};
pub use taper::tapered;
