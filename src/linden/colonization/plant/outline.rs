//! The crown of a recipe as lines.

use glam::{DVec3, Vec3};

use super::standing::Standing;
use crate::colonization::crown::compound::dashed;
use crate::grow::GrowError;
use crate::monitor::Monitor;
use crate::preset::Generator;
use crate::recipe::Recipe;

/// Polylines that draw the crown of a recipe, metres, where the tree of [`crate::grow::grow`]
/// stands; obstacles too, and, dashed, what is subtracted or shaded. None for L-systems and given points, which have no crown to draw.
///
/// ```
/// use linden::{Quiet, colonization::outline, preset::builtin, recipe::Recipe};
/// let preset = builtin("cypress").unwrap().load().map_err(|fault| fault.message)?;
/// assert!(!outline(&Recipe::new(preset), &Quiet)?.is_empty());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// Those of growing that have to do with the crown: its dimensions, its mesh; cancelled.
pub fn outline(recipe: &Recipe, monitor: &dyn Monitor) -> Result<Vec<Vec<Vec3>>, GrowError> {
    let Generator::Colonization(settings) = &recipe.preset.generator else { return Ok(Vec::new()) };
    let Some(standing) = Standing::new(settings, recipe, monitor)? else { return Ok(Vec::new()) };
    let shift = settings.shift(standing.root, standing.origin, false) + DVec3::Y * standing.lift;
    let mut lines = standing.crown.outline();
    // With parts, the crown stands where it is to, without a lift.
    lines.extend(standing.grove.obstacles.iter().flat_map(|obstacle| obstacle.solid.outline()));
    lines.extend(standing.shades.iter().flat_map(|shade| dashed(&shade.solid.outline())));
    for place in lines.iter_mut().flatten() {
        *place = (place.as_dvec3() + shift).as_vec3();
    }
    Ok(lines)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grow::grow;
    use crate::monitor::Quiet;
    use crate::preset::builtin;
    use crate::scene::Bounds;

    fn recipe(id: &str, settings: &[(&str, &str)]) -> Recipe {
        let row = builtin(id).unwrap();
        let mut preset = row.load().unwrap_or_else(|fault| panic!("{id}: {fault}"));
        for (knob, value) in settings {
            preset.set(knob, value).unwrap();
        }
        Recipe { preset, inputs: row.recipe(&Quiet).unwrap().inputs }
    }

    #[test]
    fn the_outline_stands_where_the_points_are() {
        let cases: [(&str, &[(&str, &str)]); 7] = [
            ("fir", &[]),
            ("cypress", &[("crown_base", "3")]),
            ("sphere", &[("root", "5,2,-3")]),
            ("sphere", &[("root", "5,2,-3"), ("origin", "root")]),
            ("heart", &[]),
            ("heart", &[("origin", "root")]),
            ("simple", &[("origin", "keep")]),
        ];
        for (id, settings) in cases {
            let recipe = recipe(id, settings);
            let points = grow(&recipe, &Quiet).unwrap().colonized.unwrap().points;
            let lines = outline(&recipe, &Quiet).unwrap();
            let bounds = |places: &mut dyn Iterator<Item = Vec3>| Bounds::of(places).unwrap();
            let (inner, outer) = (bounds(&mut points.into_iter()), bounds(&mut lines.into_iter().flatten()));
            // Many points in a solid come near its box on all sides; cuts through a mesh miss its ends
            // by at most an eighth.
            let slack = outer.size().max_element() * 0.15;
            for (a, b) in [(inner.min, outer.min), (inner.max, outer.max)] {
                assert!((a - b).abs().max_element() < slack, "{id} {settings:?}: {a} {b}");
            }
        }
    }

    #[test]
    fn what_has_no_crown_has_no_outline() {
        assert_eq!(outline(&recipe("abop-c", &[]), &Quiet).unwrap(), Vec::<Vec<Vec3>>::new());
        let missing = Recipe::new(recipe("heart", &[]).preset);
        assert!(matches!(outline(&missing, &Quiet), Err(GrowError::WrongInput { .. })));
    }
}
