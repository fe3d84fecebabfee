//! Skeleton → scene: everything that is to be seen.

mod bark;
mod error;
mod leaves;
#[cfg(test)]
mod tests;
mod wood;

use std::sync::Arc;

use linden_base::monitor::{Holding, Monitor};
use linden_skeleton::organs::{LeafShape, Organs};

use self::bark::{Coat, coats, picture_bytes, thin_barks};
use crate::foliage::{self, Cover};
use crate::scene::{Material, Part, Scene};
use crate::settings::Form;
use crate::wind::{Blown, Field};
use crate::wood_parts::Cuts;
use crate::{Body, Specimen};

pub(crate) use self::bark::bark_material;
pub use self::bark::thinnest_barks;
pub use self::error::DressError;
pub(crate) use self::leaves::covers;
pub use self::leaves::leaf_shapes;

/// For messages about memory.
const BLOWING: &str = "computing the wind";
const BLOWING_ADVICE: &str = "use wind=attributes, a budget of triangles, or no wind";

/// What the wood of dead twigs and its material are called, after `wood` and `bark`.
const DEAD: &str = "dead";

/// Gives a grown tree its surface, its foliage (a part for each kind and for each of a grammar's
/// colours) and materials. Only pictures use the seed.
///
/// # Errors
/// [`DressError`]: too large, or cancelled.
pub fn dress(specimen: &Specimen<'_>, body: Body<'_>, monitor: &dyn Monitor) -> Result<Scene, DressError> {
    let held = Holding::new(monitor, body.bytes());
    let wardrobe = Wardrobe::new(specimen, body.organs, &held)?;
    let field = Field::of(specimen, body.skeleton);
    let blown = field.as_ref().map(|field| Blown { field, axes: None });
    let mut scene = wardrobe.dress(specimen, body, blown, monitor)?;
    scene.recipe = (specimen.recipe)(specimen.dressing, body.organs);
    Ok(scene)
}

/// The pictures of a tree's bark and leaves, drawn once for all of its levels of detail and looks.
pub struct Wardrobe {
    trunk: Coat,
    /// Of its foot and of the edge above that, where it has one of its own.
    foot: Vec<Coat>,
    /// Of limbs, then of twigs, where they have one of their own: the largest radius of the wood that wears it,
    /// metres, and what it is called.
    thin_barks: Vec<(&'static str, f32, Material)>,
    /// Into which parts the trunk is cut.
    cuts: Cuts,
    /// By kind; `None` where no organ is of it.
    covers: Vec<Option<Cover>>,
    shapes: Arc<[LeafShape]>,
    /// The kind that branch cards are, where there are any.
    cards: Option<usize>,
}

impl Wardrobe {
    /// Draws the pictures that the bark and these organs need.
    ///
    /// # Errors
    /// [`DressError`].
    pub fn new(specimen: &Specimen<'_>, organs: &Organs, monitor: &dyn Monitor) -> Result<Self, DressError> {
        let ((trunk, foot), thin_barks) = (coats(specimen, monitor)?, thin_barks(specimen, monitor)?);
        let (covers, shapes) = (Vec::new(), Vec::new().into());
        let bare = Self { trunk, foot, thin_barks, cuts: Cuts::All, covers, shapes, cards: None };
        bare.in_season(specimen, organs, monitor)
    }

    /// The same bark with the leaves of another season.
    ///
    /// # Errors
    /// [`DressError`].
    pub(crate) fn in_season(
        &self,
        specimen: &Specimen<'_>,
        organs: &Organs,
        monitor: &dyn Monitor,
    ) -> Result<Self, DressError> {
        let (covers, shapes) = covers(specimen, organs, &Holding::new(monitor, self.bark_bytes()))?;
        Ok(Self { covers, shapes: shapes.into(), ..self.bare() })
    }

    /// The same bark, with branch cards in place of leaves.
    pub(crate) fn with_cards(&self, cover: Cover, shapes: Arc<[LeafShape]>) -> Self {
        Self { covers: vec![Some(cover)], shapes, cards: Some(0), ..self.bare() }
    }

    /// The same with branch cards beside leaves, as a further kind.
    pub(crate) fn with_leaves_and_cards(&self, cover: Cover, cards: &[LeafShape]) -> Self {
        let kind = self.covers.len();
        let numbered = cards.iter().map(|card| LeafShape { kind: kind as u8, ..card.clone() });
        let shapes = self.shapes.iter().cloned().chain(numbered).collect();
        let covers = self.covers.iter().cloned().chain([Some(cover)]).collect();
        Self { covers, shapes, cards: Some(kind), ..self.bare() }
    }

    /// The same with leaves of other shapes, as many of each kind.
    pub(crate) fn with_shapes(&self, shapes: Arc<[LeafShape]>) -> Self {
        Self { covers: self.covers.clone(), shapes, cards: self.cards, ..self.bare() }
    }

    /// The same with the trunk in more or fewer parts.
    pub(crate) fn cut_into(self, cuts: Cuts) -> Self {
        Self { cuts, ..self }
    }

    /// Of all kinds.
    pub(crate) const fn shapes(&self) -> &Arc<[LeafShape]> {
        &self.shapes
    }

    /// The same barks without anything on the wood.
    fn bare(&self) -> Self {
        Self {
            trunk: self.trunk.clone(),
            foot: self.foot.clone(),
            thin_barks: self.thin_barks.clone(),
            cuts: self.cuts,
            covers: Vec::new(),
            shapes: Vec::new().into(),
            cards: None,
        }
    }

    /// What the thinnest wood is covered with.
    pub(crate) fn twig_bark(&self) -> &Material {
        self.thin_barks.last().map_or(&self.trunk.bark, |(_, _, bark)| bark)
    }

    /// What wood is covered with, the thinnest first: the largest radius that wears it, metres, without bound the last.
    pub(crate) fn barks(&self) -> impl Iterator<Item = (f32, &Material)> {
        let thin = self.thin_barks.iter().rev().map(|(_, most_m, bark)| (*most_m, bark));
        thin.chain(std::iter::once((f32::INFINITY, &self.trunk.bark)))
    }

    /// Bytes of the barks' pictures.
    fn bark_bytes(&self) -> u64 {
        let coats = std::iter::once(&self.trunk).chain(&self.foot).map(Coat::bytes);
        coats.sum::<u64>() + self.thin_barks.iter().map(|(_, _, bark)| picture_bytes(bark)).sum::<u64>()
    }

    /// Bytes of the pictures.
    fn bytes(&self) -> u64 {
        let covers = self.covers.iter().flatten();
        let covers = covers.flat_map(|cover| std::iter::once(&cover.base_color).chain(cover.normal.as_ref()));
        self.bark_bytes() + covers.map(|picture| picture.rgba().len() as u64).sum::<u64>()
    }

    /// As [`dress`](dress()), with these pictures and this wind, and without the recipe: the body may be a
    /// level of the tree.
    ///
    /// # Errors
    /// [`DressError`].
    pub(crate) fn dress(
        &self,
        specimen: &Specimen<'_>,
        body: Body<'_>,
        blown: Option<Blown<'_>>,
        monitor: &dyn Monitor,
    ) -> Result<Scene, DressError> {
        let organs = self.organs(specimen, body.organs);
        let (parts, materials) = if specimen.wanted.surface {
            let held = body.bytes() + specimen.inputs.bytes() + self.bytes();
            let monitor: &dyn Monitor = &Holding::new(monitor, held);
            let (mut parts, mut materials) = self.wood(specimen, body, blown, monitor)?;
            let wooded = Holding::new(monitor, parts.iter().map(Part::bytes).sum());
            self.leaves((body.organs, &organs), blown, &mut materials, &mut parts, &wooded)?;
            (parts, materials)
        } else {
            (Vec::new(), vec![self.trunk.bark.clone()])
        };
        Ok(Scene {
            name: specimen.name.to_owned(),
            recipe: String::new(),
            materials,
            parts,
            skeleton: Arc::clone(body.skeleton),
            organs,
            foot_in_file: body.foot_in_file,
        })
    }
}

/// Draws the pictures of a plant that do not depend on how it grows, into [`Specimen::drawn`], where dressing it finds
/// them: beside growth, that is, where another core has nothing to do.
///
/// # Errors
/// [`DressError`], as dressing would say it.
pub fn draw_ahead(specimen: &Specimen<'_>, monitor: &dyn Monitor) -> Result<(), DressError> {
    coats(specimen, monitor)?;
    thin_barks(specimen, monitor)?;
    // Cards show leaves in smaller pictures, and which levels have cards is known of grown trees alone.
    let has_budget = !specimen.dressing.detail.is_whole();
    let has_leaves = specimen.wanted.surface || specimen.wanted.organs;
    let foliage = &specimen.dressing.foliage;
    if has_leaves && !has_budget && foliage.first.form != Form::None {
        foliage::cover(specimen, 0, &foliage.first, foliage.size_px, monitor)?;
    }
    Ok(())
}
