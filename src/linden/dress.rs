//! Skeleton → scene: everything that is to be seen.

use std::sync::Arc;

use glam::Vec3;

use crate::color::linear;
use crate::foliage::{self, CUTOUT, Cover, Foliage, FoliageError, Look, Organs, Shape};
use crate::grow::Grown;
use crate::knob::printable;
use crate::memory::Holding;
use crate::monitor::{Cancelled, Monitor, from_cancellable};
use crate::random::Key;
use crate::recipe::{Input, Recipe};
use crate::scene::{Material, Part, Scene, Wrap};
use crate::surface::{self, SurfaceError};
use crate::texture::{BarkError, BarkPictures};

/// Bark scatters light in all directions; nothing on it shines.
const BARK_ROUGHNESS: f32 = 0.9;

/// Why a tree has no scene.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
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
}

from_cancellable!(DressError: SurfaceError => Surface, FoliageError => Foliage, BarkError => Bark);

/// Leaves are a little glossy.
const LEAF_ROUGHNESS: f32 = 0.6;

/// Gives a grown tree its surface, its foliage (a part for each kind and for each of a grammar's
/// colours) and materials. Only pictures use the seed.
///
/// # Errors
/// [`DressError`]: too large, or cancelled.
pub fn dress(recipe: &Recipe, grown: &Grown, monitor: &dyn Monitor) -> Result<Scene, DressError> {
    let preset = &recipe.preset;
    let held = grown.bytes() + recipe.inputs.iter().map(Input::bytes).sum::<u64>();
    let monitor: &dyn Monitor = &Holding::new(monitor, held);
    let wood = surface::sweep(&grown.skeleton, &preset.tubes, monitor)?;
    let bark = preset.bark.bark(Key::new(preset.seed).named("bark"));
    let BarkPictures { base_color, normal } = bark.draw(&Holding::new(monitor, wood.bytes()))?;
    let material = Material {
        name: "bark".to_owned(),
        base_color: linear(bark.color),
        base_color_picture: Some(base_color),
        normal_picture: Some(normal),
        roughness: BARK_ROUGHNESS,
        double_sided: false,
        cutout: None,
        wrap: Wrap::Repeat,
    };
    let mut materials = vec![material];
    let mut parts = vec![Part { name: "wood".to_owned(), material: 0, mesh: wood }];
    let pictures = [&materials[0].base_color_picture, &materials[0].normal_picture];
    let pictures: u64 = pictures.into_iter().flatten().map(|picture| picture.rgba().len() as u64).sum();
    let wooded = Holding::new(monitor, parts[0].mesh.bytes() + pictures);
    leaves(recipe, &grown.organs, &mut materials, &mut parts, &wooded)?;
    let name = if preset.name.trim().is_empty() { &preset.id } else { &preset.name };
    Ok(Scene {
        name: printable(name),
        recipe: recipe.to_line(),
        materials,
        parts,
        skeleton: Arc::clone(&grown.skeleton),
    })
}

/// Adds what grows on the wood, in the pictures of its kinds.
fn leaves(
    recipe: &Recipe,
    organs: &Organs,
    materials: &mut Vec<Material>,
    parts: &mut Vec<Part>,
    monitor: &dyn Monitor,
) -> Result<(), FoliageError> {
    let foliage = &recipe.preset.foliage;
    let colors = foliage.turtle_colors();
    let mut covers: Vec<Option<Cover>> = Vec::new();
    let mut shapes: Vec<Shape> = Vec::new();
    let mut pictures = 0;
    for (index, kind) in foliage.kinds().enumerate() {
        let is_there = organs.shapes.iter().any(|shape| usize::from(shape.kind) == index);
        let cover = if is_there {
            let own = foliage::cover(recipe, index, kind, foliage.size_px, &Holding::new(monitor, pictures))?;
            let normal = own.normal.as_ref().map_or(0, |normal| normal.rgba().len());
            pictures += (own.base_color.rgba().len() + normal) as u64;
            shapes.extend(foliage::kind_shapes(recipe, index, kind, &own.cells)?);
            Some(own)
        } else {
            None
        };
        covers.push(cover);
    }
    let monitor = Holding::new(monitor, pictures);
    // A recipe with other kinds than the organs grew by: their own shapes fit them at least.
    let shapes = if shapes.len() == organs.shapes.len() { &shapes } else { &organs.shapes[..] };
    for Foliage { look, mesh } in foliage::meshes_of(organs, shapes, colors.len(), &monitor)? {
        let numbered = |name: &str, i: usize| if i == 0 { name.to_owned() } else { format!("{name}_{i}") };
        let cover = match look {
            Look::Color(_) => None,
            Look::Kind(kind) => covers.get(kind).and_then(Option::as_ref),
        };
        let (name, base_color) = match look {
            // Both may be there: what a grammar placed itself, and leaves.
            Look::Color(i) => (
                numbered(if organs.shapes.is_empty() { "leaves" } else { "organs" }, i),
                colors.get(i).copied().map_or([0.0; 3], linear),
            ),
            Look::Kind(i) => (numbered("leaves", i), cover.map_or([0.0; 3], mean_color)),
        };
        parts.push(Part { name: name.clone(), material: materials.len(), mesh });
        materials.push(Material {
            name,
            base_color,
            base_color_picture: cover.map(|own| Arc::clone(&own.base_color)),
            normal_picture: cover.and_then(|own| own.normal.clone()),
            roughness: LEAF_ROUGHNESS,
            double_sided: true,
            cutout: cover.filter(|own| own.is_cut_out).map(|_| CUTOUT),
            wrap: Wrap::Clamp,
        });
    }
    Ok(())
}

/// Of all variants, linear.
fn mean_color(cover: &Cover) -> [f32; 3] {
    let sum = cover.cells.iter().map(|cell| Vec3::from(linear(cell.color))).sum::<Vec3>();
    (sum / cover.cells.len().max(1) as f32).to_array()
}
