//! Leaves and other organs in the pictures of their kinds.

use std::sync::Arc;

use glam::Vec3;
use linden_base::color::linear;
use linden_base::monitor::{Holding, Monitor};
use linden_skeleton::organs::{LeafShape, Organs};

use super::{BLOWING, BLOWING_ADVICE, Wardrobe};
use crate::Specimen;
use crate::foliage::{
    self, Cover, DressedKind, DressedOrgans, Foliage, FoliageError, Instances, Look, ShedLeaf,
};
use crate::scene::{Material, Part, Wrap};
use crate::settings::LeafKind;
use crate::wind::Blown;

/// Parts and materials of leaves are called so, and of the cards in place of them.
pub(super) const LEAVES: &str = "leaves";
const CARDS: &str = "branches";

/// Leaves are a little glossy.
const LEAF_ROUGHNESS: f32 = 0.6;

impl Wardrobe {
    /// Organs alone, without wind.
    ///
    /// # Errors
    /// [`FoliageError`].
    pub(crate) fn foliage(
        &self,
        specimen: &Specimen<'_>,
        organs: &Arc<Organs>,
        monitor: &dyn Monitor,
    ) -> Result<(Vec<Material>, Vec<Part>), FoliageError> {
        let (mut materials, mut parts) = (Vec::new(), Vec::new());
        let dressed = self.organs(specimen, organs);
        self.leaves((organs, &dressed), None, &mut materials, &mut parts, monitor)?;
        Ok((materials, parts))
    }

    /// The organs in the shapes and pictures of their kinds.
    pub(crate) fn organs(&self, specimen: &Specimen<'_>, organs: &Arc<Organs>) -> DressedOrgans {
        let foliage = &specimen.dressing.foliage;
        // A recipe with other kinds than the organs grew by: the shapes they grew with fit at least.
        let fit = self.shapes.len() == organs.shapes.len();
        let shapes = Arc::clone(if fit { &self.shapes } else { &organs.shapes });
        let covers = self.covers.iter().map(Option::as_ref).chain(std::iter::repeat(None));
        let dressed = |(kind, cover): (&LeafKind, Option<&Cover>)| DressedKind {
            name: kind.label(),
            class: kind.class(),
            mask: cover.and_then(Cover::mask).cloned(),
            shed: ShedLeaf::of(kind),
        };
        let kinds = foliage.kinds().zip(covers).map(dressed).collect();
        DressedOrgans::new(Arc::clone(organs), shapes, kinds, foliage.turtle_colors())
    }

    /// Adds what grows on the wood, in the pictures of its kinds.
    pub(super) fn leaves(
        &self,
        (organs, dressed): (&Organs, &DressedOrgans),
        blown: Option<Blown<'_>>,
        materials: &mut Vec<Material>,
        parts: &mut Vec<Part>,
        monitor: &dyn Monitor,
    ) -> Result<(), FoliageError> {
        let (shapes, colors) = (dressed.shapes(), dressed.colors());
        let wooden = parts.len();
        for Foliage { look, mesh } in foliage::meshes_of(organs, shapes, colors.len(), monitor)? {
            let numbered =
                |name: &str, i: usize| if i == 0 { name.to_owned() } else { format!("{name}_{i}") };
            let cover = match look {
                Look::Color(_) => None,
                Look::Kind(kind) => self.covers.get(kind).and_then(Option::as_ref),
            };
            let (name, base_color) = match look {
                // Both may be there: what a grammar placed itself, and leaves.
                Look::Color(i) => (
                    numbered(if organs.shapes.is_empty() { "leaves" } else { "organs" }, i),
                    colors.get(i).copied().map_or([0.0; 3], linear),
                ),
                Look::Kind(i) => {
                    let name = if self.cards == Some(i) { CARDS.to_owned() } else { numbered(LEAVES, i) };
                    (name, cover.map_or([0.0; 3], mean_color))
                }
            };
            let mut part = Part::new(name.clone(), materials.len(), mesh);
            let is_placed = !organs.placed.prototypes.is_empty();
            part.instances = is_placed.then(|| Instances::of(dressed, look));
            if let Some(blown) = blown {
                let held: u64 = parts.iter().skip(wooden).map(Part::bytes).sum();
                let bytes = held + part.bytes() + blown.field.bytes_for(part.mesh.positions.len());
                monitor.admit(BLOWING, bytes, BLOWING_ADVICE)?;
                part.wind = Some(blown.leaves(&part.mesh, organs, look, colors.len(), monitor)?);
            }
            parts.push(part);
            materials.push(Material {
                name,
                base_color,
                base_color_picture: cover.map(|cover| Arc::clone(&cover.base_color)),
                normal_picture: cover.and_then(|cover| cover.normal.clone()),
                roughness: LEAF_ROUGHNESS,
                double_sided: cover.is_none_or(|cover| cover.backs.is_empty()),
                cutout: cover.and_then(|cover| cover.cutout),
                wrap: Wrap::Clamp,
                translucency: cover.and_then(|cover| cover.translucency),
                passing_picture: cover.and_then(|cover| cover.passing.clone()),
            });
        }
        Ok(())
    }
}

/// The shapes of leaves as they are dressed: they follow the pictures' outlines, which are finer than those
/// that the organs grew with ([`Organs::shapes`]).
///
/// # Errors
/// [`FoliageError`].
pub fn leaf_shapes(
    specimen: &Specimen<'_>,
    organs: &Organs,
    monitor: &dyn Monitor,
) -> Result<Vec<LeafShape>, FoliageError> {
    let shapes = covers(specimen, organs, monitor)?.1;
    Ok(if shapes.len() == organs.shapes.len() { shapes } else { organs.shapes.to_vec() })
}

/// What covers each kind of which there are organs, and the shapes that fit.
pub(crate) fn covers(
    specimen: &Specimen<'_>,
    organs: &Organs,
    monitor: &dyn Monitor,
) -> Result<(Vec<Option<Cover>>, Vec<LeafShape>), FoliageError> {
    let foliage = &specimen.dressing.foliage;
    let (mut covers, mut shapes) = (Vec::new(), Vec::new());
    if !specimen.wanted.surface && !specimen.wanted.organs {
        return Ok((covers, shapes));
    }
    let mut pictures = 0;
    for (index, kind) in foliage.kinds().enumerate() {
        if !organs.shapes.iter().any(|shape| usize::from(shape.kind) == index) {
            covers.push(None);
            continue;
        }
        let holding = Holding::new(monitor, pictures);
        let cover = foliage::cover(specimen, index, kind, foliage.size_px, &holding)?;
        let normal = cover.normal.as_ref().map_or(0, |normal| normal.rgba().len());
        pictures += (cover.base_color.rgba().len() + normal) as u64;
        shapes.extend(foliage::kind_shapes(specimen, index, kind, &cover)?);
        covers.push(Some(cover));
    }
    Ok((covers, shapes))
}

/// Of all variants, linear.
fn mean_color(cover: &Cover) -> [f32; 3] {
    let sum = cover.cells.iter().map(|cell| Vec3::from(linear(cell.color))).sum::<Vec3>();
    (sum / cover.cells.len().max(1) as f32).to_array()
}
