//! Skeleton → scene: everything that is to be seen.

use std::sync::Arc;

use glam::Vec3;

use crate::foliage::{
    self, Cover, DressedKind, DressedOrgans, Foliage, FoliageError, Instances, Look, ShedLeaf,
};
use crate::moss::{self, MossSteps, Mossy};
use crate::scene::{Material, Part, Scene, Wrap};
use crate::settings::{Dressing, Form, LIMBS, LeafKind, TWIGS};
use crate::surface::relief::{self, Heights, ReliefError};
use crate::surface::{self, Junction, SurfaceError};
use crate::texture::{self, BarkError, BarkPictures};
use crate::wind::{Blown, Field};
use crate::wood_parts;
use crate::{Body, Specimen};
use linden_base::color::linear;
use linden_base::input::A_PICTURE;
use linden_base::knob::printable;
use linden_base::mesh::Mesh;
use linden_base::monitor::Holding;
use linden_base::monitor::{Cancelled, Monitor};
use linden_skeleton::organs::{LeafShape, Organs};
use linden_skeleton::{AxisKind, NO_PARENT, Skeleton};

/// Bark scatters light in all directions; nothing on it shines.
const BARK_ROUGHNESS: f32 = 0.9;

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

/// For messages about memory.
const BLOWING: &str = "computing the wind";
const PARTING: &str = "parting the wood by its bark";
const PARTING_ADVICE: &str = "lower sides, or let all wood have one bark (limb_radius=0, moss=0)";
const BLOWING_ADVICE: &str = "use wind=attributes, a budget of triangles, or no wind";

/// Parts and materials of leaves are called so, and of the cards in place of them.
const LEAVES: &str = "leaves";
const CARDS: &str = "branches";
/// What the wood of dead twigs and its material are called, after `wood` and `bark`.
const DEAD: &str = "dead";
/// Leaves are a little glossy.
const LEAF_ROUGHNESS: f32 = 0.6;

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
    bark: Material,
    /// Of limbs, then of twigs, where they have one of their own: the largest radius of the wood that wears it,
    /// metres, and what it is called.
    thin_barks: Vec<(&'static str, f32, Material)>,
    /// The bark under more and more moss, where any grows.
    mossy: Vec<Material>,
    /// Which of these.
    moss_steps: MossSteps,
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
        let (bark, thin_barks) = (bark(specimen, monitor)?, thin_barks(specimen, monitor)?);
        let mossy = moss::materials(specimen, &bark, monitor)?;
        let (covers, shapes) = (Vec::new(), Vec::new().into());
        let moss_steps = MossSteps::All;
        let bare = Self { bark, thin_barks, mossy, moss_steps, covers, shapes, cards: None };
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

    /// The same with some of the mossy parts.
    pub(crate) fn with_moss(self, moss_steps: MossSteps) -> Self {
        Self { moss_steps, ..self }
    }

    /// Of all kinds.
    pub(crate) const fn shapes(&self) -> &Arc<[LeafShape]> {
        &self.shapes
    }

    /// The same barks without anything on the wood.
    fn bare(&self) -> Self {
        let (bark, thin_barks, mossy) = (self.bark.clone(), self.thin_barks.clone(), self.mossy.clone());
        let (covers, shapes) = (Vec::new(), Vec::new().into());
        Self { bark, thin_barks, mossy, moss_steps: self.moss_steps, covers, shapes, cards: None }
    }

    /// What the thinnest wood is covered with.
    pub(crate) fn twig_bark(&self) -> &Material {
        self.thin_barks.last().map_or(&self.bark, |(_, _, bark)| bark)
    }

    /// What wood is covered with, the thinnest first: the largest radius that wears it, metres, without bound the last.
    pub(crate) fn barks(&self) -> impl Iterator<Item = (f32, &Material)> {
        let thin = self.thin_barks.iter().rev().map(|(_, most_m, bark)| (*most_m, bark));
        thin.chain(std::iter::once((f32::INFINITY, &self.bark)))
    }

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

    /// Bytes of the barks' pictures.
    fn bark_bytes(&self) -> u64 {
        let barks = std::iter::once(&self.bark).chain(self.thin_barks.iter().map(|(_, _, bark)| bark));
        let pictures = barks.flat_map(|bark| [&bark.base_color_picture, &bark.normal_picture]);
        pictures.flatten().map(|picture| picture.rgba().len() as u64).sum::<u64>() + moss::bytes(&self.mossy)
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
        let tubes = &specimen.dressing.tubes;
        if !specimen.wanted.surface {
            return Ok(Scene {
                name: specimen.name.to_owned(),
                recipe: String::new(),
                materials: vec![self.bark.clone()],
                parts: Vec::new(),
                skeleton: Arc::clone(body.skeleton),
                organs: self.organs(specimen, body.organs),
                foot_in_file: body.foot_in_file,
            });
        }
        let held = body.bytes() + specimen.inputs.bytes() + self.bytes();
        let monitor: &dyn Monitor = &Holding::new(monitor, held);
        let wood = surface::sweep(body.skeleton, tubes, monitor)?;
        let mut materials = vec![self.bark.clone()];
        let mut wood = Part::new("wood", 0, wood);
        if let Some(blown) = blown {
            let bytes = wood.bytes() + blown.field.bytes_for(wood.mesh.positions.len());
            monitor.admit(BLOWING, bytes, BLOWING_ADVICE).map_err(SurfaceError::from)?;
            let tubes = surface::count(body.skeleton, tubes, monitor)?;
            wood.wind = Some(blown.wood(&wood.mesh, &tubes, monitor)?);
        }
        let (mut parts, mut is_thick) = self.by_thickness(wood, specimen, body.skeleton, monitor)?;
        if let Some(trunk) = parts.first_mut().filter(|part| part.material == 0) {
            stretch(&mut trunk.mesh, &self.bark);
        }
        if let Some(heights) = heights(specimen, blown.is_some()) {
            let height_m = specimen.dressing.bark.relief_height_m;
            // Roots go below it.
            let ground_m = (tubes.features.roots.count > 0).then(|| foot_m(body.skeleton));
            if let Some((trunk, thin)) = parts.split_first_mut().filter(|(part, _)| part.material == 0) {
                let thin: Vec<&Mesh> = thin.iter().map(|part| &part.mesh).collect();
                relief::lay(&mut trunk.mesh, &thin, &heights, (ground_m, height_m), &mut is_thick, monitor)?;
            }
        }
        if parts.iter().any(|part| part.material > 0) {
            materials.extend(self.thin_barks.iter().map(|(_, _, bark)| bark.clone()));
            let color = specimen.dressing.bark.dead_color;
            let dead = || bark_material(format!("bark_{DEAD}"), color, None);
            materials.extend(has_dead(body.skeleton).then(dead));
        }
        if let Some(trunk) = parts.first().filter(|part| part.material == 0 && !is_thick.is_empty()) {
            let parted: u64 = parts.iter().map(Part::bytes).sum();
            monitor
                .admit(PARTING, parted + moss::bytes_to_cut(trunk), PARTING_ADVICE)
                .map_err(SurfaceError::from)?;
            let mossy = Mossy::on(specimen, foot_m(body.skeleton), body.skeleton.foot_radius_m());
            let all = parts.iter().map(|part| part.mesh.triangles.len()).sum();
            let (cut, kept) = mossy.cut(trunk, &is_thick, materials.len(), (self.moss_steps, all));
            parts.splice(..1, cut);
            materials.extend(kept.into_iter().map(|step| self.mossy[step].clone()));
        }
        let wooded = Holding::new(monitor, parts.iter().map(Part::bytes).sum());
        let organs = self.organs(specimen, body.organs);
        self.leaves((body.organs, &organs), blown, &mut materials, &mut parts, &wooded)?;
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

    /// The wood, in as many parts as it has barks, and for each triangle of the first whether it is thick enough for
    /// moss, where any grows. A solid has no tubes to tell thick from thin: it is one, and bare.
    fn by_thickness(
        &self,
        wood: Part,
        specimen: &Specimen<'_>,
        skeleton: &Skeleton,
        monitor: &dyn Monitor,
    ) -> Result<(Vec<Part>, Vec<bool>), SurfaceError> {
        let Dressing { tubes, bark, .. } = specimen.dressing;
        let is_bare = self.mossy.is_empty() || self.moss_steps == MossSteps::None;
        let has_dead = has_dead(skeleton);
        if self.thin_barks.is_empty() && is_bare && !has_dead || tubes.junction == Junction::Watertight {
            return Ok((vec![wood], Vec::new()));
        }
        let counts = surface::count(skeleton, tubes, monitor)?;
        // Of each triangle whether it is thin, and whether it is thick: moss grows there.
        let marks = 2 * wood.mesh.triangles.len() as u64;
        monitor.admit(
            PARTING,
            wood.bytes() + wood_parts::bytes_for(&wood) + std::mem::size_of_val(&counts[..]) as u64 + marks,
            PARTING_ADVICE,
        )?;
        let limits_m: Vec<f32> = self.thin_barks.iter().map(|(_, radius_m, _)| *radius_m).collect();
        let mut classes = surface::classes(&wood.mesh, &counts, skeleton, &limits_m, monitor)?;
        if has_dead {
            let dead = limits_m.len() as u8 + 1;
            let mut first = 0;
            for (axis, amount) in counts.iter().enumerate() {
                if skeleton.kind_of(axis) == AxisKind::Dead {
                    classes[first..first + amount.triangles].fill(dead);
                }
                first += amount.triangles;
            }
        }
        let mut is_thick = Vec::new();
        if !is_bare {
            let least_m = bark.moss.least_radius_m(skeleton.foot_radius_m());
            let thin = surface::classes(&wood.mesh, &counts, skeleton, &[least_m], monitor)?;
            let of_trunk = classes.iter().zip(thin).filter(|(class, _)| **class == 0);
            is_thick = of_trunk.map(|(_, thin)| thin == 0).collect();
        }
        if limits_m.is_empty() && !has_dead {
            return Ok((vec![wood], is_thick));
        }
        let names = self.thin_barks.iter().map(|(name, _, _)| *name).chain(has_dead.then_some(DEAD));
        let names: Vec<&str> = names.collect();
        Ok((wood_parts::cut(&wood, &classes, &names), is_thick))
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
    fn leaves(
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

/// Draws the pictures of a plant that do not depend on how it grows, into [`Specimen::drawn`], where dressing it finds
/// them: beside growth, that is, where another core has nothing to do.
///
/// # Errors
/// [`DressError`], as dressing would say it.
pub fn draw_ahead(specimen: &Specimen<'_>, monitor: &dyn Monitor) -> Result<(), DressError> {
    moss::materials(specimen, &bark(specimen, monitor)?, monitor)?;
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

/// The bark, with pictures that are drawn or given by the user.
fn bark(specimen: &Specimen<'_>, monitor: &dyn Monitor) -> Result<Material, DressError> {
    let look = &specimen.dressing.bark;
    let drawn = look.bark();
    if !specimen.wanted.colors {
        return Ok(bark_material("bark".to_owned(), drawn.color, None));
    }
    let find = |knob, file: &Option<String>| match file {
        None => Ok(None),
        Some(file) => match specimen.picture(file) {
            Some(picture) => Ok(Some(picture)),
            None => Err(DressError::NoPicture { knob, file: file.clone() }),
        },
    };
    let (color, normal) = (find("bark_picture", &look.picture)?, find("bark_normal", &look.normal)?);
    let (base_color, mean) = match color {
        Some(found) => (Some(texture::opaque(&found.picture)), found.mean_color),
        None => (None, drawn.color),
    };
    let normal = normal.map(|found| texture::opaque(&found.picture));
    let BarkPictures { base_color, normal } = match (base_color, normal) {
        (Some(base_color), Some(normal)) => BarkPictures { base_color, normal },
        (Some(base_color), None) => {
            let normal = specimen.drawn.relief(&base_color, drawn.relief, monitor)?;
            BarkPictures { base_color, normal }
        }
        (None, Some(normal)) => BarkPictures { normal, ..specimen.drawn.bark(&drawn, monitor)? },
        (None, None) => specimen.drawn.bark(&drawn, monitor)?,
    };
    let [n, p] = [&normal, &base_color].map(|picture| [picture.width(), picture.height()]);
    // To a pixel of the larger one's side.
    let [n_area, p_area] = [[n[0], p[1]], [p[0], n[1]]].map(|[w, h]| u64::from(w) * u64::from(h));
    if n_area.abs_diff(p_area) > u64::from(n[0].max(n[1]).max(p[0]).max(p[1])) {
        return Err(DressError::Proportions { normal: n, picture: p });
    }
    Ok(bark_material("bark".to_owned(), mean, Some(BarkPictures { base_color, normal })))
}

/// The barks of limbs and twigs, where they have one of their own.
fn thin_barks(
    specimen: &Specimen<'_>,
    monitor: &dyn Monitor,
) -> Result<Vec<(&'static str, f32, Material)>, BarkError> {
    let barks = specimen.dressing.bark.thin_barks();
    let drawn = barks.into_iter().map(|(name, radius_m, bark)| {
        let pictures = specimen.wanted.colors.then(|| specimen.drawn.bark(&bark, monitor)).transpose()?;
        Ok((name, radius_m, bark_material(format!("bark_{name}"), bark.color, pictures)))
    });
    drawn.collect()
}

fn bark_material(name: String, mean: [u8; 3], pictures: Option<BarkPictures>) -> Material {
    let (base_color_picture, normal_picture) =
        pictures.map(|BarkPictures { base_color, normal }| (base_color, normal)).unzip();
    Material {
        name,
        base_color: linear(mean),
        base_color_picture,
        normal_picture,
        roughness: BARK_ROUGHNESS,
        double_sided: false,
        cutout: None,
        wrap: Wrap::Repeat,
        translucency: None,
        passing_picture: None,
    }
}

/// Values a row of the bark's heights: more than a mesh shows.
const HEIGHTS: usize = 256;

/// What is laid on the wood: drawn bark, on the only level of a tree that stands still.
fn heights(specimen: &Specimen<'_>, is_blown: bool) -> Option<Heights> {
    let (look, detail) = (&specimen.dressing.bark, &specimen.dressing.detail);
    let is_drawn = look.picture.is_none() && look.normal.is_none();
    let is_whole = detail.levels() == 1 && detail.finest() == 0;
    let is_laid = look.relief_height_m > 0.0 && is_drawn && is_whole && !is_blown;
    let bark = look.bark();
    is_laid.then(|| Heights { values: bark.heights(HEIGHTS), side: HEIGHTS, relief: bark.relief })
}

/// Height of the lowest foot of a stem, metres.
fn foot_m(skeleton: &Skeleton) -> f32 {
    let stems = skeleton.axes.iter().filter(|axis| axis.parent == NO_PARENT);
    let feet = stems.filter_map(|axis| skeleton.nodes_of(axis).first());
    feet.map(|&foot| skeleton.positions[foot as usize].y).fold(f32::INFINITY, f32::min)
}

/// Of a scene's materials the bark of the thinnest living wood, and that of dead wood where there is any: what is seen of
/// wood from so far that it is lines.
pub fn thinnest_barks(materials: &[Material]) -> [Option<&Material>; 2] {
    let named = |ending: &str| {
        materials
            .iter()
            .find(|material| material.name.strip_prefix("bark_").is_some_and(|name| name == ending))
    };
    let living = named(TWIGS).or_else(|| named(LIMBS)).or(materials.first());
    [living, named(DEAD)]
}

/// Whether there are dead twigs.
fn has_dead(skeleton: &Skeleton) -> bool {
    (0..skeleton.axes.len()).any(|axis| skeleton.kind_of(axis) == AxisKind::Dead)
}

/// Lays a bark that is not square on as it is: [`crate::surface::Tubes::bark_tile_m`] is its width.
fn stretch(wood: &mut Mesh, bark: &Material) {
    let Some(picture) = &bark.base_color_picture else { return };
    if picture.width() != picture.height() {
        let aspect = picture.width() as f32 / picture.height() as f32;
        wood.uvs.iter_mut().for_each(|uv| uv.y *= aspect);
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Wanted;
    use crate::testing::{Stop, Subject, body};
    use linden_base::monitor::Quiet;

    #[test]
    fn what_is_drawn_ahead_is_not_drawn_again() {
        let subject = Subject::builtin(
            "drawn-oak",
            &[("points", "300"), ("leaf_size", "64"), ("limb_radius", "0.05"), ("moss", "0.5")],
        );
        let grown = subject.grow();
        subject.with(|specimen| {
            let pictures = |monitor: &dyn Monitor| {
                let (covers, _) = covers(specimen, &grown.organs, monitor)?;
                Ok::<_, DressError>((bark(specimen, monitor)?, thin_barks(specimen, monitor)?, covers))
            };
            assert!(matches!(pictures(&Stop), Err(DressError::Cancelled(_))));
            draw_ahead(specimen, &Quiet).unwrap();
            let found = pictures(&Stop).unwrap();
            // As they are drawn when nothing is there yet: bark, that of limbs, leaves.
            let anew = subject.dress(&grown).materials;
            assert_eq!((&found.0, &found.1[0].2), (&anew[0], &anew[1]));
            let leaves = found.2[0].as_ref().map(|cover| &cover.base_color);
            let worn = anew.iter().find(|material| material.name == LEAVES);
            assert!(leaves.is_some() && leaves == worn.and_then(|worn| worn.base_color_picture.as_ref()));
            let mossy = moss::materials(specimen, &found.0, &Stop).unwrap();
            assert!(mossy.len() == moss::STEPS.len() && mossy.iter().all(|mossy| anew.contains(mossy)));
        });
    }

    #[test]
    fn lines_of_wood_have_the_thinnest_bark_and_dead_wood_its_own() {
        let barks = |knobs: &[(&str, &str)]| {
            let small = [("points", "300"), ("leaf_size", "64"), ("bark_size", "64"), ("dead_twigs", "0")];
            let subject = Subject::builtin("drawn-oak", &[&small[..], knobs].concat());
            let scene = subject.dress(&subject.grow());
            thinnest_barks(&scene.materials).map(|bark| bark.map_or(String::new(), |bark| bark.name.clone()))
        };
        assert_eq!(barks(&[]), ["bark", ""]);
        assert_eq!(barks(&[("limb_radius", "0.05")]), ["bark_limbs", ""]);
        let both = [("limb_radius", "0.05"), ("twig_radius", "0.01"), ("dead_twigs", "6")];
        assert_eq!(barks(&both), ["bark_twigs", "bark_dead"]);
        assert_eq!(thinnest_barks(&[]), [None, None]);
    }

    #[test]
    fn dead_twigs_are_bare_and_shoots_have_leaves() {
        let small = [("points", "300"), ("leaf_size", "64"), ("bark_size", "64")];
        let of = |knobs: &[(&str, &str)]| {
            let subject = Subject::builtin("drawn-oak", &[&small[..], knobs].concat());
            let grown = subject.grow();
            let scene = subject.dress(&grown);
            (grown, scene)
        };
        let (before, bare) = of(&[("dead_twigs", "0"), ("epicormic", "0")]);
        let (after, scene) = of(&[("dead_twigs", "6"), ("epicormic", "2")]);
        let skeleton = &after.skeleton;
        let axis_of = skeleton.axis_of_nodes();
        let kind = |node: u32| skeleton.kind_of(axis_of[node as usize] as usize);
        let placed = &after.organs.placed;
        let on = |wanted: AxisKind| {
            (0..placed.len()).filter(|&organ| kind(placed.growth.nodes[organ]) == wanted).count()
        };
        assert_eq!(on(AxisKind::Dead), 0);
        assert!(on(AxisKind::Shoot) > 50, "{}", on(AxisKind::Shoot));
        // What grew has the leaves that it had, in the same places.
        let grown = (0..placed.len()).filter(|&organ| kind(placed.growth.nodes[organ]) == AxisKind::Grown);
        let places: Vec<Vec3> = grown.map(|organ| placed.positions[organ]).collect();
        assert_eq!(places, before.organs.placed.positions);
        // The dead have a colour of their own, and nothing else has.
        let dead = scene.parts.iter().find(|part| part.name == "wood_dead").unwrap();
        assert_eq!(scene.materials[dead.material].name, "bark_dead");
        let dead_axes = (0..skeleton.axes.len()).filter(|&axis| skeleton.kind_of(axis) == AxisKind::Dead);
        let nodes: usize = dead_axes.map(|axis| skeleton.axes[axis].len as usize).sum();
        assert!(
            dead.mesh.triangles.len() > 4 * nodes && !bare.materials.iter().any(|m| m.name == "bark_dead")
        );
        for at in dead.mesh.positions.iter().step_by(7) {
            let near = |node: &usize| {
                kind(*node as u32) == AxisKind::Dead && skeleton.positions[*node].distance(*at) < 0.7
            };
            assert!((0..skeleton.positions.len()).any(|node| near(&node)), "{at}");
        }
    }

    #[test]
    fn what_nobody_wants_is_not_made() {
        let subject =
            Subject::builtin("drawn-oak", &[("points", "300"), ("leaf_size", "64"), ("limb_radius", "0.05")]);
        let grown = subject.grow();
        subject.with(|specimen| {
            let specimen = Specimen { wanted: Wanted::SKELETON, ..*specimen };
            // Not even where all that may be asked is whether to stop.
            let wardrobe = Wardrobe::new(&specimen, &grown.organs, &Stop).unwrap();
            let scene = wardrobe.dress(&specimen, body(&grown), None, &Stop).unwrap();
            assert!(scene.parts.is_empty() && scene.materials[0].base_color_picture.is_none());
            assert_eq!(scene.skeleton, grown.skeleton);
        });
    }
}
