//! Trees that grow into crowns by space colonization (RLP07: Runions, Lane & Prusinkiewicz 2007).
//!
//! | module | is |
//! |---|---|
//! | [`crown`] | solids that crowns are made of: shapes by their dimensions, meshes, compounds |
//! | [`scatter`] | attraction points, uniform in a crown's volume |
//! | [`Colonization`] | the settings and their knobs |
//! | [`CrownDraft`] | a crown shape by handles that can be dragged |
//! | [`CrownPart`] | what else there is: pieces of the crown, other trees, obstacles, shade |
//! | [`GENERATOR`] | the generator |
//!
//! Takes settings and meshes, gives a branching; growth itself is `linden_growth`. Knows no preset and opens
//! no file.
//!
//! ```
//! use linden_base::input::Inputs;
//! use linden_base::monitor::Quiet;
//! use linden_colonization::{Colonization, Space, crown};
//! use linden_skeleton::Wood;
//! use linden_skeleton::generator::{Settings, Task};
//!
//! let dome = Colonization { points: 500, ..Colonization::of(Space::of_shape(crown::shape("dome")?)) };
//! let task = Task { seed: 7, inputs: &Inputs::new(), wood: Wood::default() };
//! let grown = dome.grow(&task, &Quiet)?;
//! assert!(grown.branching.positions.len() > 50);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod error;
mod generator;
mod handles;
mod obstacles;
mod part;
mod parts;
mod sample;
pub mod scatter;
mod settings;
mod shape_knobs;
mod standing;

pub use linden_crown as crown;

pub use error::ColonizationError;
pub use generator::GENERATOR;
pub use handles::{CrownDraft, CrownHandle, HandleMoves, MESH_HAS_NO_PROFILE};
pub use part::{CrownPart, MOST_PARTS, PART_CROWN, PART_KNOBS, PartKnob, Role, Solid};
pub use parts::PartError;
pub use settings::{Colonization, Space};
