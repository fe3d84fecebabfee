//! Trees that compete: a forest of one kind as one growth in which each tree has its own root and crown.

use super::error::{ForestError, Loner};
use super::planned::PlannedTree;
use crate::preset::{Colonization, CrownPart, GrowthSettings, LSystem, MOST_PARTS, Role, Solid, Space};
use linden_base::knob::printable;
use linden_plant::stage::Place;

/// One tree that is all those of some places. The root of the first stands at its origin.
///
/// Each has the crown of its kind, as large beside the first as its place says, and as many points more as
/// one tree has by itself. None is turned: no two grow alike anyway.
pub(super) fn together(tree: &PlannedTree, places: &[Place]) -> Result<PlannedTree, ForestError> {
    let alone = |why| ForestError::Loner { kind: printable(&tree.recipe.preset.id), why };
    let preset = &tree.recipe.preset;
    let Some(colonization) = preset.settings::<Colonization>() else {
        let is_lsystem = preset.settings::<LSystem>().is_some();
        return Err(alone(if is_lsystem { Loner::LSystem } else { Loner::Given }));
    };
    let Space::Shape { shape, dimensions } = &colonization.space else { return Err(alone(Loner::Given)) };
    let is_unplaced = |part: &CrownPart| part.at.is_none() && matches!(part.solid, Solid::Mesh { .. });
    if colonization.parts.iter().any(|part| part.role == Role::Tree || is_unplaced(part)) {
        return Err(alone(Loner::Parts));
    }
    let [first, others @ ..] = places else { return Ok(tree.clone()) };
    let stems = places.len() as u64;
    let most = (1 + MOST_PARTS / (1 + colonization.parts.len())) as u64;
    if stems > most {
        return Err(ForestError::TooManyStems { stems, most });
    }
    let mut parts = colonization.parts.clone();
    for place in others {
        let size = f64::from(place.scale / first.scale);
        let root = ((place.position - first.position) / first.scale).as_dvec3().to_array();
        let from_root = |at: [f64; 3]| [0, 1, 2].map(|i| root[i] + at[i] * size);
        let crown = Solid::Shape { shape: shape.clone(), dimensions: dimensions.clone() };
        parts.push(CrownPart {
            at: colonization.crown_base_m.map(|height| from_root([0.0, height, 0.0])),
            scale: size,
            root: Some(root),
            trunk_m: colonization.growth.trunk_m.map(|trunk| trunk * size),
            ..CrownPart::of(Role::Tree, crown)
        });
        parts.extend(colonization.parts.iter().map(|part| CrownPart {
            at: Some(from_root(part.at.unwrap_or_default())),
            scale: part.scale * size,
            ..part.clone()
        }));
    }
    let points = colonization.points.saturating_mul(stems as u32);
    let max_nodes = colonization.growth.max_nodes.saturating_mul(stems as u32);
    let growth = GrowthSettings { max_nodes, ..colonization.growth.clone() };
    let grown = Colonization { parts, points, growth, ..colonization.clone() };
    let mut preset = preset.clone();
    preset.generator = Box::new(grown);
    let recipe = tree.recipe.with_preset(preset);
    Ok(PlannedTree { recipe, stems, ..tree.clone() })
}
