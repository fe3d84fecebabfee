//! Leaves as they lie on the ground: single ones, also of kinds that grow as whole twigs.

use std::sync::Arc;

use super::dressed::area;
use super::{form, look};
use crate::settings::{Form, LeafKind};
use crate::texture::leaf::{Cell, LeafError, LeafLook, LeafPictures};
use linden_base::mesh::Mesh;
use linden_base::monitor::Monitor;
use linden_base::picture::Picture;
use linden_base::random::Key;
use linden_skeleton::organs::OrganClass;

/// When the last leaves fall, as the knob `season`.
const FALL: f32 = 0.9;
/// Side of the picture, pixels: they are seen from some steps away.
const SIZE_PX: u32 = 256;

/// A leaf as it lies on the ground.
#[derive(Clone, Debug, PartialEq)]
pub struct FallenLeaf {
    /// Variants of it, from the origin along +Y, upper side to +Z, in units of `size_m`; at least one.
    pub meshes: Vec<Mesh>,
    /// The picture that cuts them out, sRGB; `None`: the meshes have the leaf's outline.
    pub picture: Option<Arc<Picture>>,
    /// One unit of the meshes, metres.
    pub size_m: f32,
    /// One side of a leaf, square metres, on average.
    pub area_m2: f32,
}

impl FallenLeaf {
    pub(super) fn of(meshes: Vec<Mesh>, picture: Option<Arc<Picture>>, size_m: f32) -> Self {
        let all: f64 = meshes.iter().map(|mesh| area(mesh, picture.as_deref())).sum();
        let area_m2 = (all / meshes.len().max(1) as f64) as f32 * size_m * size_m;
        Self { meshes, picture, size_m, area_m2 }
    }
}

/// How a kind's leaf is drawn once it has fallen.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct ShedLeaf {
    look: LeafLook,
    size_m: f32,
}

impl ShedLeaf {
    /// A kind's; `None` for blossoms and fruit, and where shapes or pictures are the user's.
    pub fn of(kind: &LeafKind) -> Option<Self> {
        let is_drawn = kind.picture.is_none() && !matches!(kind.form, Form::None | Form::Mesh);
        (is_drawn && kind.class() == OrganClass::Leaf)
            .then(|| Self { look: look::look(kind, FALL, SIZE_PX), size_m: kind.length_m as f32 })
    }

    /// Draws it.
    pub fn draw(&self, monitor: &dyn Monitor) -> Result<FallenLeaf, LeafError> {
        let LeafPictures { base_color, cells, .. } =
            self.look.draw(Key::new(0).named("fallen leaf"), monitor)?;
        let meshes = cells.iter().map(|cell: &Cell| form::curled(cell)).collect();
        Ok(FallenLeaf::of(meshes, Some(base_color), self.size_m))
    }
}
