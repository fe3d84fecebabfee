//! A recipe's chain of levels: the tree as its knobs want it, and what stands for it from afar.

use std::sync::Arc;

use super::billboard::{Billboard, billboard};
use super::{Detail, DetailError, Simplified, Simplifier};
use crate::dress::dress;
use crate::grow::Grown;
use crate::memory::Holding;
use crate::monitor::Monitor;
use crate::preset::Preset;
use crate::recipe::Recipe;
use crate::scene::{Material, Scene};

/// Levels of detail of one tree.
#[derive(Debug)]
pub struct Levels {
    /// Finest first; at least one.
    pub levels: Vec<Level>,
    /// What the user should know.
    pub notes: Vec<String>,
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
    if detail.triangles == 0 && detail.lods <= 1 {
        scenes.push(dress(recipe, grown, monitor)?);
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
            scenes.push(simplifier.scene(&own, recipe, grown, scenes.first(), &held)?);
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

impl Simplifier<'_> {
    /// Dresses a level. Materials are those of `finer`, where there is one: pictures are drawn once.
    fn scene(
        &self,
        detail: &Detail,
        recipe: &Recipe,
        grown: &Grown,
        finer: Option<&Scene>,
        monitor: &dyn Monitor,
    ) -> Result<Scene, DetailError> {
        let Simplified { skeleton, organs, tubes, .. } = self.simplified(detail, monitor)?;
        let mut own = recipe.clone();
        own.preset.tubes = tubes;
        if finer.is_some() {
            own.preset.bark.size_px = SMALLEST_PICTURE_PX;
        }
        let thin = Grown { skeleton: Arc::new(skeleton), organs: Arc::new(organs), ..grown.clone() };
        let mut scene = dress(&own, &thin, monitor)?;
        scene.recipe = recipe.to_line();
        scene.skeleton = Arc::clone(&grown.skeleton);
        for material in &mut scene.materials {
            let same = |known: &&Material| known.name == material.name;
            if let Some(known) = finer.and_then(|finer| finer.materials.iter().find(same)) {
                material.clone_from(known);
            }
        }
        Ok(scene)
    }
}

/// Pictures that are drawn to be thrown away.
const SMALLEST_PICTURE_PX: u32 = 16;
