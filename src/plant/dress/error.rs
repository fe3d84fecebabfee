//! Why a tree has no scene.

use linden_base::input::A_PICTURE;
use linden_base::knob::printable;
use linden_base::monitor::Cancelled;

use crate::foliage::FoliageError;
use crate::surface::SurfaceError;
use crate::surface::relief::ReliefError;
use crate::texture::BarkError;

/// Why a tree has no scene.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DressError {
    /// The result was no longer wanted.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// The surface.
    #[error(transparent)]
    Surface(SurfaceError),
    /// Leaves and the like.
    #[error(transparent)]
    Foliage(FoliageError),
    /// The bark's pictures.
    #[error(transparent)]
    Bark(BarkError),
    /// The bark's relief in the mesh.
    #[error(transparent)]
    Relief(ReliefError),
    /// A file for the bark that is missing or holds something else.
    #[error("'{knob}' is '{}', which must hold {A_PICTURE}", printable(.file))]
    NoPicture {
        /// The preset's key.
        knob: &'static str,
        /// As the preset names it.
        file: String,
    },
    /// Normals that do not lie on the picture.
    #[error(
        "'bark_normal' has {} × {} pixels and the bark's picture {} × {}: one must be the other, scaled; use \
         pictures of the same proportions",
        .normal[0], .normal[1], .picture[0], .picture[1]
    )]
    Proportions {
        /// Width and height, pixels.
        normal: [u32; 2],
        /// Width and height, pixels.
        picture: [u32; 2],
    },
}

linden_base::from_cancellable!(
    DressError: SurfaceError => Surface, FoliageError => Foliage, BarkError => Bark, ReliefError => Relief
);
