//! Trees that compete: a forest of one kind as one growth in which each tree has its own root.
//!
//! Trees that fill crowns have a crown each, and compete for points; those that grow by light take it from each
//! other.

use super::error::{ForestError, Loner};
use super::planned::PlannedTree;
use super::{ForestKind, Layout};
use crate::preset::{
    Colonization, CrownPart, GrowthSettings, LSystem, MOST_NODES, MOST_OBSTACLES, MOST_PARTS, MOST_TREES,
    Neighbour, Obstacle, Role, SelfOrganizing, Solid, Space, WeberPenn,
};
use linden_base::knob::printable;
use linden_plant::stage::Place;

/// Trees of a forest in one growth.
pub(super) struct Stand {
    /// All of them. The root of the first stands at its origin.
    pub tree: PlannedTree,
    /// How much larger it stands than it grows.
    pub scale: f32,
}

impl Stand {
    /// The trees of some places, the first of which is `tree`. None is turned: no two grow alike anyway.
    pub fn new(
        tree: &PlannedTree,
        places: &[Place],
        kind: &ForestKind,
        layout: &Layout,
    ) -> Result<Self, ForestError> {
        match tree.recipe.preset.settings::<SelfOrganizing>() {
            Some(rules) => by_light(tree, rules, places, kind, layout),
            None => in_crowns(tree, places),
        }
    }
}

/// Trees that take each other's light. All grow by the same rules: light decides which of them gets large, and the
/// sizes of places are left out. Each has the obstacles of its kind.
fn by_light(
    tree: &PlannedTree,
    rules: &SelfOrganizing,
    places: &[Place],
    kind: &ForestKind,
    layout: &Layout,
) -> Result<Stand, ForestError> {
    let preset = &tree.recipe.preset;
    if !rules.stand.is_empty() {
        return Err(ForestError::Loner { kind: printable(&preset.id), why: Loner::Stand });
    }
    if rules.obstacles.iter().any(Obstacle::is_unplaced) {
        return Err(ForestError::Loner { kind: printable(&preset.id), why: Loner::Parts });
    }
    let scale = kind.size as f32;
    let [first, others @ ..] = places else { return Ok(Stand { tree: tree.clone(), scale }) };
    let stems = places.len() as u64;
    let most = MOST_OBSTACLES.checked_div(rules.obstacles.len()).unwrap_or(MOST_TREES);
    if places.len() > most {
        return Err(ForestError::TooManyStems { stems, most: most as u64 });
    }
    let from_first = |place: &Place| {
        let at = (place.position - first.position).as_dvec3() / kind.size;
        Neighbour::at([at.x, at.z])
    };
    let mut rules = rules.clone();
    rules.stand = others.iter().map(from_first).collect();
    let beside = |tree: &Neighbour| rules.obstacles.iter().map(|obstacle| obstacle.beside(tree.at)).collect();
    let further: Vec<Vec<Obstacle>> = rules.stand.iter().map(beside).collect();
    rules.obstacles.extend(further.into_iter().flatten());
    rules.max_nodes = rules.max_nodes.saturating_mul(stems as u32).min(MOST_NODES);
    let mut preset = preset.clone();
    preset.generator = Box::new(rules);
    let recipe = tree.recipe.with_preset(preset);
    let mut notes = tree.notes.clone();
    if ![0.0, Layout::default().size_spread].contains(&layout.size_spread) {
        notes.push(
            "size_spread changes nothing where trees compete for light: all grow by the same rules, and light \
             decides which gets large"
                .to_owned(),
        );
    }
    Ok(Stand { tree: PlannedTree { recipe, stems, notes, ..tree.clone() }, scale })
}

/// Trees that fill crowns: each has that of its kind, as large beside the first as its place says, and as many points
/// more as one tree has by itself.
fn in_crowns(tree: &PlannedTree, places: &[Place]) -> Result<Stand, ForestError> {
    let alone = |why| ForestError::Loner { kind: printable(&tree.recipe.preset.id), why };
    let preset = &tree.recipe.preset;
    let Some(colonization) = preset.settings::<Colonization>() else {
        return Err(alone(if preset.settings::<LSystem>().is_some() {
            Loner::LSystem
        } else if preset.settings::<WeberPenn>().is_some() {
            Loner::Drawn
        } else {
            Loner::Given
        }));
    };
    let Space::Shape { shape, dimensions } = &colonization.space else { return Err(alone(Loner::Given)) };
    let is_unplaced = |part: &CrownPart| part.at.is_none() && matches!(part.solid, Solid::Mesh { .. });
    if colonization.parts.iter().any(|part| part.role == Role::Tree || is_unplaced(part)) {
        return Err(alone(Loner::Parts));
    }
    let [first, others @ ..] = places else { return Ok(Stand { tree: tree.clone(), scale: 1.0 }) };
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
    Ok(Stand { tree: PlannedTree { recipe, stems, ..tree.clone() }, scale: first.scale })
}
