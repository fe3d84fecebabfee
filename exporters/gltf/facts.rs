//! What a file says of a tree in plain numbers, for programs that choose among levels of detail: `linden_tree` in extras.

use linden_pipeline::scene::Bounds;
use linden_pipeline::season::SEASONS;
use linden_pipeline::stage::{OnlyLevel, Plant};
use serde::{Deserialize, Serialize};

use crate::writing::distinct::PlantModel;

/// A tree in a level of detail.
#[derive(Clone, Serialize)]
pub(super) struct TreeFacts {
    /// 0 is the finest; `None` where all are in one file.
    #[serde(skip_serializing_if = "Option::is_none")]
    level: Option<usize>,
    /// How many there are.
    levels: usize,
    /// From which share of the picture's height the level serves, and down to which.
    #[serde(skip_serializing_if = "Option::is_none")]
    screen_from: Option<f32>,
    #[serde(skip_serializing_if = "Option::is_none")]
    screen_to: Option<f32>,
    triangles: u64,
    /// From the foot to the top.
    height_m: f32,
    /// From the vertical through the foot to what is farthest of it.
    reach_m: f32,
    bounds_m: BoxFacts,
    /// The season's name, where it has one.
    #[serde(skip_serializing_if = "Option::is_none")]
    season: Option<&'static str>,
    /// The knob `season`.
    #[serde(skip_serializing_if = "Option::is_none")]
    season_at: Option<f64>,
    unit: &'static str,
    up: &'static str,
}

#[derive(Clone, Serialize)]
struct BoxFacts {
    min: [f32; 3],
    max: [f32; 3],
}

impl TreeFacts {
    /// Those of a plant in a level; `None` of one without a surface.
    pub fn of_level(plant: &Plant<'_>, level: usize, model: &PlantModel<'_>) -> Option<Self> {
        let levels = plant.levels();
        let from = level.checked_sub(1).and_then(|before| levels.get(before));
        let OnlyLevel { number, of, from } = plant.only.unwrap_or(OnlyLevel {
            number: level,
            of: levels.len(),
            from: from.map_or(1.0, |before| before.coverage),
        });
        let (level, screen_to) = (Some(number), levels.get(level).map(|level| level.coverage));
        Some(Self { level, levels: of, screen_from: Some(from), screen_to, ..Self::of_tree(plant, model)? })
    }

    /// Those of a plant whose levels are all in the file; of the finest.
    pub fn of_tree(plant: &Plant<'_>, model: &PlantModel<'_>) -> Option<Self> {
        let boxes = || {
            let parts = model.parts.iter();
            parts.map(|part| part.copies.as_ref().map_or(part.bounds, |copies| copies.seen))
        };
        let bounds @ Bounds { min, max } = boxes().reduce(Bounds::union)?;
        let far = |point: &glam::Vec3| libm::hypotf(point.x, point.z);
        let reach_m = if model.parts.iter().any(|part| part.copies.is_some()) {
            bounds.corners().iter().map(far).fold(0.0, f32::max)
        } else {
            model.parts.iter().flat_map(|part| &part.mesh.positions).map(far).fold(0.0, f32::max)
        };
        let triangles = model.parts.iter().map(|part| {
            let places = part.copies.as_ref().map_or(1, |copies| copies.placements.len());
            part.mesh.triangles.len() as u64 * places as u64
        });
        let season_at = season_of(&model.scene.recipe);
        let name = SEASONS.iter().find(|(_, at)| season_at == Some(*at)).map(|(name, _)| *name);
        Some(Self {
            level: None,
            levels: plant.levels().len(),
            screen_from: None,
            screen_to: None,
            triangles: triangles.sum(),
            height_m: max.y,
            reach_m,
            bounds_m: BoxFacts { min: min.to_array(), max: max.to_array() },
            season: name,
            season_at,
            unit: "m",
            up: "+Y",
        })
    }
}

/// The knob `season` of a recipe.
fn season_of(recipe: &str) -> Option<f64> {
    #[derive(Deserialize)]
    struct Told {
        foliage: Foliage,
    }
    #[derive(Deserialize)]
    struct Foliage {
        season: f64,
    }
    serde_json::from_str::<Told>(recipe).ok().map(|told| told.foliage.season)
}
