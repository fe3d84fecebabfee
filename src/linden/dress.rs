//! Skeleton → scene: everything that is to be seen.

use std::sync::Arc;

use crate::color::linear;
use crate::foliage::{self, Foliage, FoliageError};
use crate::grow::Grown;
use crate::knob::printable;
use crate::memory::Holding;
use crate::monitor::{Cancelled, Monitor, from_cancellable};
use crate::random::Key;
use crate::recipe::{Input, Recipe};
use crate::scene::{Material, Part, Scene};
use crate::surface::{self, SurfaceError};
use crate::texture::{BarkError, BarkPictures};

/// Bark scatters light in all directions; nothing on it shines.
const BARK_ROUGHNESS: f32 = 0.9;

/// Why a tree has no scene.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
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

/// Gives a grown tree its surface, its foliage (a part for each colour of it) and materials. Only the
/// bark's pictures use the seed.
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
    };
    let mut materials = vec![material];
    let mut parts = vec![Part { name: "wood".to_owned(), material: 0, mesh: wood }];
    let colors = &preset.foliage.leaf_colors;
    let pictures = [&materials[0].base_color_picture, &materials[0].normal_picture];
    let pictures: u64 = pictures.into_iter().flatten().map(|picture| picture.rgba().len() as u64).sum();
    let wooded = Holding::new(monitor, parts[0].mesh.bytes() + pictures);
    for Foliage { color, mesh } in foliage::meshes(&grown.organs, colors.len(), &wooded)? {
        let name = if color == 0 { "leaves".to_owned() } else { format!("leaves_{color}") };
        parts.push(Part { name: name.clone(), material: materials.len(), mesh });
        materials.push(Material {
            name,
            base_color: colors.get(color).copied().map_or([0.0; 3], linear),
            base_color_picture: None,
            normal_picture: None,
            roughness: LEAF_ROUGHNESS,
            double_sided: true,
        });
    }
    let name = if preset.name.trim().is_empty() { &preset.id } else { &preset.name };
    Ok(Scene {
        name: printable(name),
        recipe: recipe.to_line(),
        materials,
        parts,
        skeleton: Arc::clone(&grown.skeleton),
    })
}
