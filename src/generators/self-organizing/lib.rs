//! Trees that organize themselves: buds compete for light, year by year.
//!
//! Pałubicki et al. 2009, *Self-organizing tree models for image synthesis* (ACM Transactions on Graphics 28(3)).
//! Nothing is drawn in advance: crown, bare bole and gaps between crowns come out of the competition. In a year
//!
//! 1. each bud reads its light from a grid, of shade or of the sky's light, and the light of all buds is summed down to the foot;
//! 2. vigor times that light is shared among the buds again;
//! 3. branches that were too dark for too long are shed;
//! 4. a bud with a share of 1 or more grows a shoot of as many internodes, towards the light, up or level;
//! 5. new nodes cast shade, shed ones cast none any more;
//! 6. branches bend under the weight that came upon them.
//!
//! Wood thickens by the pipe model, in which shed tips stay.
//!
//! | module | is |
//! |---|---|
//! | [`SelfOrganizing`] | the settings and their knobs |
//! | [`grow()`], [`grow_stand`], [`grow_among`] | a tree; trees that shade each other; both among obstacles |
//! | [`Obstacle`], [`Barriers`] | a solid that nothing grows into, in documents and as it stands |
//! | [`GENERATOR`] | the generator |
//!
//! Takes settings, meshes and a key, gives a branching with radii, births and edges. Shade is counted in integers and
//! random choices follow from places in the tree, so that any number of threads gives the same tree. Knows no preset
//! and opens no file.
//!
//! ```
//! use linden_base::monitor::Quiet;
//! use linden_base::random::Key;
//! use linden_self_organizing::{SelfOrganizing, grow};
//!
//! let mut settings = SelfOrganizing::default();
//! settings.years = 12;
//! let young = grow(&settings, Key::new(7), &Quiet)?;
//! settings.years = 20;
//! let old = grow(&settings, Key::new(7), &Quiet)?;
//! assert!(old.branching.positions.len() > 2 * young.branching.positions.len());
//! // Branches in the shade are gone.
//! assert!(old.shed > 100);
//! # Ok::<(), linden_self_organizing::SelfOrganizingError>(())
//! ```

mod barriers;
mod bend;
mod error;
mod gap;
mod generator;
mod grow;
mod knobs;
mod light;
mod obstacle;
mod plane;
#[cfg(test)]
mod predictions;
mod sample;
mod settings;
mod shadow;
mod share;
mod shed;
mod shoot;
mod sky;
mod stand;
mod stool;
mod sums;
mod tree;
#[cfg(test)]
mod wall_predictions;

pub use barriers::Barriers;
pub use error::{ObstacleError, SelfOrganizingError};
pub use generator::GENERATOR;
pub use grow::{Grown, Planted, grow, grow_among, grow_stand};
pub use knobs::MOST_NODES;
pub use obstacle::{MOST_OBSTACLES, Obstacle, ObstacleSolid};
pub use settings::{LightModel, MAX_ORDERS, Phyllotaxis, SelfOrganizing, Sharing};
pub use stand::{MOST_TREES, Neighbour};
