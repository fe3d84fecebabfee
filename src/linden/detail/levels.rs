//! A recipe's chain of levels: the tree as its knobs want it, and what stands for it from afar.

use std::sync::Arc;

use super::billboard::{Billboard, billboard};
use super::{DetailError, Simplified, Simplifier};
use crate::dress::Wardrobe;
use crate::grow::Grown;
use crate::memory::Holding;
use crate::monitor::Monitor;
use crate::preset::Preset;
use crate::recipe::Recipe;
use crate::scene::Scene;
use crate::stage::{self, Stage};
use crate::surface::Tubes;
use crate::wind::{Blown, Field};

/// Levels of detail of one tree.
#[derive(Debug)]
pub struct Levels {
    /// Finest first; at least one.
    pub levels: Vec<Level>,
    /// What the user should know.
    pub notes: Vec<String>,
}

impl Levels {
    /// What exporters take.
    pub fn stage(&self) -> Stage<'_> {
        let levels = self.levels.iter();
        let levels = levels.map(|Level { scene, coverage }| stage::Level { scene, coverage: *coverage });
        // There is one at least.
        Stage::of_levels(&self.levels[0].scene, levels.collect())
    }
}

/// A tree in one level of detail.
#[derive(Debug)]
pub struct Level {
    /// How it looks. Its skeleton is the whole tree's.
    pub scene: Scene,
    /// The level serves while the tree takes at least this share of the picture's height; 0 for the last.
    pub coverage: f32,
}

/// The finest level serves down to this share of the picture's height.
const NEAR: f32 = 0.5;

/// Dresses a tree in all levels that its preset asks for: `triangles` for the finest, `lods` of them
/// (each `lod_ratio` of the triangles before), and a last one of `billboard` planes.
///
/// # Errors
/// [`DetailError`]: a budget that is too small, memory, cancelled, whatever dressing finds.
pub fn levels(recipe: &Recipe, grown: &Grown, monitor: &dyn Monitor) -> Result<Levels, DetailError> {
    let Preset { detail, .. } = &recipe.preset;
    let mut notes = Vec::new();
    let mut scenes: Vec<Scene> = Vec::new();
    let field = Field::of(&recipe.preset, &grown.skeleton);
    let wardrobe = Wardrobe::new(recipe, &grown.organs, monitor)?;
    if detail.triangles == 0 && detail.lods <= 1 {
        let blown = field.as_ref().map(|field| Blown { field, axes: None });
        scenes.push(wardrobe.dress(recipe, grown, blown, monitor)?);
    } else {
        let simplifier = Simplifier::new(&recipe.preset, grown, monitor)?;
        let full = simplifier.full_triangles(monitor)?;
        let least = simplifier.least_triangles(monitor)?;
        let mut budget = if detail.triangles == 0 { full } else { detail.triangles };
        if budget > full {
            notes.push(format!("triangles={budget}: the tree has no more than {full}"));
            budget = full;
        }
        for level in 0..detail.lods.max(1) {
            if level > 0 && budget < least {
                notes.push(format!(
                    "lods={}: after {level} levels nothing is left to leave out ({least} triangles)",
                    detail.lods
                ));
                break;
            }
            let own = simplifier.within(budget, monitor)?;
            let held = Holding::new(monitor, scenes.iter().map(Scene::bytes).sum());
            let thin = simplifier.simplified(&own, &held)?;
            scenes.push(dressed(thin, &wardrobe, field.as_ref(), recipe, grown, &held)?);
            budget = (budget as f64 * detail.lod_ratio) as u64;
        }
    }
    if detail.billboard > 0 {
        let how = Billboard { planes: detail.billboard, size_px: detail.billboard_size_px };
        let held = Holding::new(monitor, scenes.iter().skip(1).map(Scene::bytes).sum());
        scenes.push(billboard(&scenes[0], &how, &held)?);
    }
    // So many triangles per pixel: the height goes with the root of their number.
    let step = (detail.lod_ratio as f32).sqrt();
    let last = scenes.len() - 1;
    let mut coverage = NEAR / step;
    let level = |(index, scene)| {
        coverage *= step;
        Level { scene, coverage: if index == last { 0.0 } else { coverage } }
    };
    Ok(Levels { levels: scenes.into_iter().enumerate().map(level).collect(), notes })
}

/// The finest level's wood and leaves, as `triangles` has them, and how the wood is swept: what is
/// measured where nothing is to be dressed.
///
/// # Errors
/// [`DetailError`].
pub fn finest(recipe: &Recipe, grown: &Grown, monitor: &dyn Monitor) -> Result<(Grown, Tubes), DetailError> {
    let Preset { detail, tubes, .. } = &recipe.preset;
    if detail.triangles == 0 {
        return Ok((grown.clone(), *tubes));
    }
    let simplifier = Simplifier::new(&recipe.preset, grown, monitor)?;
    let own = simplifier.within(detail.triangles, monitor)?;
    let Simplified { skeleton, organs, tubes, .. } = simplifier.simplified(&own, monitor)?;
    Ok((Grown { skeleton: Arc::new(skeleton), organs: Arc::new(organs), ..grown.clone() }, tubes))
}

/// Dresses a level.
fn dressed(
    Simplified { skeleton, axes, organs, tubes }: Simplified,
    wardrobe: &Wardrobe,
    field: Option<&Field<'_>>,
    recipe: &Recipe,
    grown: &Grown,
    monitor: &dyn Monitor,
) -> Result<Scene, DetailError> {
    let mut own = recipe.clone();
    own.preset.tubes = tubes;
    let thin = Grown { skeleton: Arc::new(skeleton), organs: Arc::new(organs), ..grown.clone() };
    let blown = field.map(|field| Blown { field, axes: Some(&axes) });
    let mut scene = wardrobe.dress(&own, &thin, blown, monitor)?;
    // Whatever is shown of it, this is the tree.
    scene.recipe = recipe.to_line();
    scene.skeleton = Arc::clone(&grown.skeleton);
    Ok(scene)
}
