//! Draws trees on the CPU: camera + [`Skeleton`](linden_pipeline::Skeleton) or [`Surface`] → RGBA pixels.
//!
//! Takes values, gives values: this crate opens no file and writes to no terminal. The same tree,
//! camera, style and size give the same pixels, whatever the number of threads.
//!
//! | module | is |
//! |---|---|
//! | [`camera`] | where the picture is taken from |
//! | [`extent`] | what is framed |
//! | [`style`] | what it is painted with |
//! | [`color`] | the colour spaces and ramps behind it |
//! | [`skeleton`] | the axial tree as tapered strokes |
//! | [`surface`] | meshes, shaded |
//! | [`drawing`] | flat drawings as in a book: pixels by tiny-skia, or SVG |
//! | [`person`], [`scale`] | how large it all is |
//! | [`memory`] | how much memory a picture takes |
//!
//! Both drawers share the light (`light`), the shade that the tree throws (`shade`), the strokes (`strokes`: twigs
//! thinner than a pixel are strokes on a surface too) and what is behind the tree (`backdrop`).

pub mod camera;
pub mod color;
pub mod drawing;
pub mod extent;
pub mod memory;
pub mod person;
pub mod scale;
pub mod skeleton;
pub mod style;
pub mod surface;

mod backdrop;
mod canvas;
mod light;
mod shade;
mod strokes;

use linden_pipeline::memory::OverMemory;

pub use camera::{Camera, View};
pub use drawing::slice::{Cut, Slice};
pub use drawing::{Drawing, draw_flat};
pub use extent::Extent;
pub use person::{PERSON_M, Person};
pub use scale::nice_length_m;
pub use skeleton::draw_skeleton;
pub use style::{Background, Handle, Landscape, Paint, Style};
pub use surface::{Surface, draw_stage, draw_surface, stage_extent};

/// The longest side of a picture, pixels: 8192² pixels are 268 MB.
pub const MAX_SIDE: u32 = 8192;

/// A picture's size in pixels, each side from 1 to [`MAX_SIDE`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Size {
    width: u32,
    height: u32,
}

impl Size {
    /// Checks the sides.
    ///
    /// # Errors
    /// [`RasterError::Size`] when a side is 0 or longer than [`MAX_SIDE`].
    pub fn new(width: u32, height: u32) -> Result<Self, RasterError> {
        if (1..=MAX_SIDE).contains(&width) && (1..=MAX_SIDE).contains(&height) {
            Ok(Self { width, height })
        } else {
            Err(RasterError::Size { width, height })
        }
    }

    /// Pixels per row.
    pub const fn width(self) -> u32 {
        self.width
    }

    /// Rows.
    pub const fn height(self) -> u32 {
        self.height
    }
}

/// Why there is no picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum RasterError {
    /// A side is 0 or too long.
    #[error("a picture of {width}×{height} pixels cannot be drawn: each side must be 1 to {MAX_SIDE} pixels")]
    Size {
        /// Pixels per row that were asked for.
        width: u32,
        /// Rows that were asked for.
        height: u32,
    },
    /// The skeleton has no node.
    #[error("there is nothing to draw: the skeleton has no node; let the generator grow for more steps")]
    Empty,
    /// A node is somewhere that no picture can show.
    #[error("node {0} of the skeleton cannot be drawn: its position or radius is not a finite number")]
    NotFinite(usize),
    /// The skeleton's arrays contradict each other.
    #[error(
        "the skeleton cannot be drawn: node {0} lacks a radius, a birth step, an axis or an earlier parent"
    )]
    Inconsistent(usize),
    /// A mesh contradicts itself.
    #[error(
        "part {0} of the surface cannot be drawn: its material, a corner of a triangle, a normal or a texture coordinate is missing, or a vertex is not at a finite place"
    )]
    Mesh(usize),
    /// Nobody wants the picture any more.
    #[error(transparent)]
    Cancelled(#[from] linden_pipeline::Cancelled),
    /// It would take more memory than there may be.
    #[error(transparent)]
    Memory(#[from] OverMemory),
}
