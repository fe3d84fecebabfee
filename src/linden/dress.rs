//! Skeleton → scene: everything that is to be seen. Uses no randomness of its own.

use std::sync::Arc;

use crate::grow::Grown;
use crate::knob::printable;
use crate::monitor::Monitor;
use crate::recipe::Recipe;
use crate::scene::{Material, Part, Scene};
use crate::surface::{self, SurfaceError};

/// Gives a grown tree its surface and materials.
///
/// # Errors
/// [`SurfaceError`]: too large, or cancelled.
pub fn dress(recipe: &Recipe, grown: &Grown, monitor: &dyn Monitor) -> Result<Scene, SurfaceError> {
    let preset = &recipe.preset;
    let wood = surface::sweep(&grown.skeleton, &preset.tubes, monitor)?;
    let material = Material {
        name: "bark".to_owned(),
        base_color: [0.2, 0.13, 0.08],
        base_color_picture: None,
        normal_picture: None,
        roughness: 0.9,
        double_sided: false,
    };
    let name = if preset.name.trim().is_empty() { &preset.id } else { &preset.name };
    Ok(Scene {
        name: printable(name),
        recipe: recipe.to_line(),
        materials: vec![material],
        parts: vec![Part { name: "wood".to_owned(), material: 0, mesh: wood }],
        skeleton: Arc::clone(&grown.skeleton),
    })
}
