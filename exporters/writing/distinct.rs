//! What is on a stage, each thing once: meshes with their boxes, materials with their names.
//!
//! A stage names plants, their seasons and levels, and the places where they stand; a file wants meshes and
//! materials. [`DistinctMeshes`] is that list, and making it checks every number of it.
//!
//! Scenes hold their materials for themselves; the levels of a plant, and trees of a kind, share them.
//! Equal materials become one here, under a name that no other has.

use std::borrow::Cow;
use std::collections::BTreeSet;

use linden_pipeline::Monitor;
use linden_pipeline::Vec2;
use linden_pipeline::foliage::Placement;
use linden_pipeline::scene::{Bounds, Material, Mesh, Scene};
use linden_pipeline::stage::{Ground, Place, Sky, Stage};
use linden_pipeline::wind::{Binding, PartWind};

use super::names::identifier;
use super::validate;
use crate::ExportError;

/// Everything on a stage, checked, each thing once.
///
/// ```
/// use linden_pipeline::{Quiet, dress::dress, grow::grow, preset::builtin, recipe::Recipe, stage::Stage};
/// use linden_exporters::writing::distinct::DistinctMeshes;
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let recipe = Recipe::new(builtin("older-f").unwrap().load()?);
/// let scene = dress(&recipe, &grow(&recipe, &Quiet)?, &Quiet)?;
/// let stage = Stage::of(&scene);
/// let distinct = DistinctMeshes::of(&stage, &Quiet)?;
/// for (place, plant) in distinct.placed(&stage) {
///     for part in &plant.parts {
///         let material = &distinct.materials[part.material];
///         println!("{} of {}: {} triangles", part.name, material.name, part.mesh.triangles.len());
///     }
///     assert!(place.is_origin());
/// }
/// # Ok(())
/// # }
/// ```
pub struct DistinctMeshes<'a> {
    /// All that is distinct: plant by plant, season by season, level by level.
    pub models: Vec<PlantModel<'a>>,
    /// Each once.
    pub materials: Vec<NamedMaterial<'a>>,
    /// What covers the ground, each in many places.
    pub cover: Vec<MeshPart<'a>>,
    /// The ground that all stand on.
    pub ground: Option<MeshPart<'a>>,
    /// The sky as a mesh: for formats that have none.
    pub dome: Option<MeshPart<'a>>,
    /// By plant: its first model, and how many seasons and levels it has.
    plants: Vec<PlantRange>,
}

#[derive(Clone, Copy)]
struct PlantRange {
    first: usize,
    seasons: usize,
    levels: usize,
}

/// A plant in one season and level of detail, as meshes.
#[non_exhaustive]
pub struct PlantModel<'a> {
    /// Where it comes from.
    pub scene: &'a Scene,
    /// Its parts.
    pub parts: Vec<MeshPart<'a>>,
    /// Indices of its materials, those that no part has included.
    pub materials: Vec<usize>,
}

/// A mesh with one material.
#[non_exhaustive]
pub struct MeshPart<'a> {
    /// Unique within its model.
    pub name: Cow<'a, str>,
    /// The geometry.
    pub mesh: Cow<'a, Mesh>,
    /// Smallest and largest of the stored coordinates, exactly.
    pub bounds: Bounds,
    /// Index into [`DistinctMeshes::materials`].
    pub material: usize,
    /// How it swings.
    pub wind: Option<&'a PartWind>,
    /// Where it stands, moved from its origin, instead of once as it is.
    pub copies: Option<MeshCopies<'a>>,
    /// A second set of texture coordinates without overlaps, where one was asked for.
    pub lightmap: Option<Vec<Vec2>>,
}

/// Where a mesh of a part stands in many places.
#[non_exhaustive]
pub struct MeshCopies<'a> {
    /// The name of the part that it is a shape of.
    pub part: &'a str,
    /// At least one.
    pub placements: Vec<Placement>,
    /// Around the boxes of all copies.
    pub seen: Bounds,
    /// By placement: the joints that move it, as far as copies that move are wanted.
    pub bindings: Vec<Binding>,
}

/// A material under a name that no other has.
#[non_exhaustive]
pub struct NamedMaterial<'a> {
    /// Lower-case identifier that says whose it is: `norway_spruce_bark`; `ground` of what belongs to no plant. Programs
    /// that open several files in one project take materials of one name for the same.
    pub name: String,
    /// What its pictures' files are called after the name of the main file: `bark`; `norway_spruce_bark` where there are
    /// several kinds of plants.
    pub file_name: String,
    /// The material.
    pub material: &'a Material,
}

/// Names that are taken.
#[derive(Default)]
struct Names {
    materials: BTreeSet<String>,
    files: BTreeSet<String>,
    /// Whether there are several kinds of plants, whose pictures lie beside each other.
    is_several: bool,
}

/// A name that was not taken, and is now.
fn unique(plain: &str, taken: &mut BTreeSet<String>) -> String {
    let mut name = plain.to_owned();
    let mut number = 2;
    while !taken.insert(name.clone()) {
        name = format!("{plain}_{number}");
        number += 1;
    }
    name
}

impl PlantModel<'_> {
    /// What a part is called where parts of several plants come together: `norway_spruce_wood`.
    pub fn full_name(&self, part: &str) -> String {
        format!("{}_{part}", identifier(&self.scene.name))
    }
}

impl MeshPart<'_> {
    /// Whether both stand in the same places.
    pub fn is_placed_as(&self, other: &Self) -> bool {
        self.copies.as_ref().map(|copies| &copies.placements)
            == other.copies.as_ref().map(|copies| &copies.placements)
    }

    /// Whether a file needs one of both alone, whatever season each is of: they stand, swing and are lit alike.
    pub fn is_same(&self, other: &Self) -> bool {
        self.name == other.name
            && self.material == other.material
            && self.is_placed_as(other)
            && (std::ptr::eq(&raw const *self.mesh, &raw const *other.mesh) || self.mesh == other.mesh)
            && self.wind == other.wind
            && self.lightmap == other.lightmap
    }

    /// The part that it is copies of, if it is.
    pub fn copied_part(&self) -> Option<&str> {
        self.copies.as_ref().map(|copies| copies.part)
    }
}

impl<'a> DistinctMeshes<'a> {
    /// Checks the plants of a stage and lists them.
    ///
    /// # Errors
    /// [`ExportError::Scene`] for a stage or scene that breaks a promise of its types, and
    /// [`ExportError::Cancelled`].
    pub fn of(stage: &'a Stage<'_>, monitor: &dyn Monitor) -> Result<Self, ExportError> {
        validate::stage(stage)?;
        let mut distinct = Self {
            models: Vec::new(),
            materials: Vec::new(),
            cover: Vec::new(),
            ground: None,
            dome: None,
            plants: Vec::new(),
        };
        let mut names = Names { is_several: stage.plants.len() > 1, ..Names::default() };
        for plant in &stage.plants {
            let (seasons, levels) = (plant.seasons.len(), plant.levels().len());
            distinct.plants.push(PlantRange { first: distinct.models.len(), seasons, levels });
            for scene in plant.scenes() {
                let bounds = validate::scene(scene, monitor)?;
                let materials: Vec<usize> = scene
                    .materials
                    .iter()
                    .map(|material| distinct.index_of(material, Some(&scene.name), &mut names))
                    .collect();
                let pieces: Vec<MeshPart<'_>> = scene
                    .parts
                    .iter()
                    .zip(bounds)
                    .map(|(part, bounds)| MeshPart {
                        name: Cow::Borrowed(&part.name),
                        mesh: Cow::Borrowed(&part.mesh),
                        bounds,
                        material: materials[part.material],
                        wind: part.wind.as_ref(),
                        copies: None,
                        lightmap: None,
                    })
                    .collect();
                distinct.models.push(PlantModel { scene, parts: pieces, materials });
            }
        }
        Ok(distinct)
    }

    /// As [`DistinctMeshes::of`], for formats that hold what stands around plants too.
    ///
    /// # Errors
    /// As [`DistinctMeshes::of`].
    pub fn in_setting(stage: &'a Stage<'_>, monitor: &dyn Monitor) -> Result<Self, ExportError> {
        let mut distinct = Self::of(stage, monitor)?;
        if let Some(Ground { mesh, material, cover }) = stage.setting.as_ref().map(|setting| &setting.ground)
        {
            for patch in cover {
                let part = distinct.around(&patch.name, &patch.mesh, &patch.material, monitor)?;
                let placements = patch.placements.clone();
                let seen = patch.bounds().unwrap_or(part.bounds);
                let copies =
                    Some(MeshCopies { part: patch.kind.name(), placements, seen, bindings: Vec::new() });
                distinct.cover.push(MeshPart { copies, ..part });
            }
            distinct.ground = Some(distinct.around("Ground", mesh, material, monitor)?);
        }
        Ok(distinct)
    }

    /// As [`DistinctMeshes::in_setting`], with the sky as a mesh.
    ///
    /// # Errors
    /// As [`DistinctMeshes::of`].
    pub fn under_dome(stage: &'a Stage<'_>, monitor: &dyn Monitor) -> Result<Self, ExportError> {
        let mut distinct = Self::in_setting(stage, monitor)?;
        if let Some(Sky { dome, material, .. }) = stage.setting.as_ref().map(|setting| &setting.sky) {
            distinct.dome = Some(distinct.around("Sky", dome, material, monitor)?);
        }
        Ok(distinct)
    }

    fn around(
        &mut self,
        name: &'a str,
        mesh: &'a Mesh,
        material: &'a Material,
        monitor: &dyn Monitor,
    ) -> Result<MeshPart<'a>, ExportError> {
        let bounds = validate::surroundings(name, mesh, material, monitor)?;
        let mut names = Names {
            materials: self.materials.iter().map(|named| named.name.clone()).collect(),
            files: self.materials.iter().map(|named| named.file_name.clone()).collect(),
            is_several: false,
        };
        let index = self.index_of(material, None, &mut names);
        let (name, mesh) = (Cow::Borrowed(name), Cow::Borrowed(mesh));
        Ok(MeshPart { name, mesh, bounds, material: index, wind: None, copies: None, lightmap: None })
    }

    /// The index of a material; lists it if it is new. `kind` is what its plant is called.
    fn index_of(&mut self, material: &'a Material, kind: Option<&str>, names: &mut Names) -> usize {
        if let Some(known) = self.materials.iter().position(|named| named.material == material) {
            return known;
        }
        let full = match kind {
            Some(kind) => format!("{}_{}", identifier(kind), material.name),
            None => material.name.clone(),
        };
        let file = if names.is_several { full.clone() } else { material.name.clone() };
        let (name, file_name) = (unique(&full, &mut names.materials), unique(&file, &mut names.files));
        self.materials.push(NamedMaterial { name, file_name, material });
        self.materials.len() - 1
    }

    /// The model of a plant in one of its seasons and levels.
    pub fn model(&self, plant: usize, season: usize, level: usize) -> usize {
        let range = self.plants[plant];
        range.first + season * range.levels + level
    }

    /// All models of a plant.
    pub fn models_of(&self, plant: usize) -> &[PlantModel<'a>] {
        let PlantRange { first, seasons, levels } = self.plants[plant];
        &self.models[first..first + seasons * levels]
    }

    /// How many distinct plants there are.
    pub fn plants(&self) -> usize {
        self.plants.len()
    }

    /// How many levels a plant has.
    pub fn levels(&self, plant: usize) -> usize {
        self.plants[plant].levels
    }

    /// How many seasons a plant has.
    pub fn seasons(&self, plant: usize) -> usize {
        self.plants[plant].seasons
    }

    /// All meshes, each once; those of [`DistinctMeshes::surroundings`] come last.
    pub fn parts(&self) -> impl Iterator<Item = &MeshPart<'a>> {
        self.models.iter().flat_map(|model| &model.parts).chain(self.surroundings())
    }

    /// For each of [`DistinctMeshes::parts`] the first that is the same, of any season: itself, but for what does not
    /// change over the year.
    pub fn first_alike(&self) -> Vec<usize> {
        let counts: Vec<usize> = self.models.iter().map(|model| model.parts.len()).collect();
        let first_part = |model: usize| counts[..model].iter().sum::<usize>();
        let mut alike: Vec<usize> = (0..self.parts().count()).collect();
        for plant in 0..self.plants() {
            for (season, level) in
                (1..self.seasons(plant)).flat_map(|s| (0..self.levels(plant)).map(move |l| (s, l)))
            {
                let model = self.model(plant, season, level);
                for (index, piece) in (first_part(model)..).zip(&self.models[model].parts) {
                    let found = (0..season).find_map(|season| {
                        let earlier = self.model(plant, season, level);
                        let at = self.models[earlier].parts.iter().position(|other| other.is_same(piece))?;
                        Some(first_part(earlier) + at)
                    });
                    alike[index] = found.unwrap_or(index);
                }
            }
        }
        alike
    }

    /// What stands round the plants: cover of the ground, ground, sky.
    pub fn surroundings(&self) -> impl Iterator<Item = &MeshPart<'a>> {
        self.cover.iter().chain(&self.ground).chain(&self.dome)
    }

    /// How many copies of pieces stand somewhere.
    pub fn placements(&self) -> usize {
        self.parts().filter_map(|piece| piece.copies.as_ref()).map(|copies| copies.placements.len()).sum()
    }

    /// What stands where, seen from near.
    pub fn placed<'s>(
        &'s self,
        stage: &'s Stage<'_>,
    ) -> impl Iterator<Item = (&'s Place, &'s PlantModel<'a>)> {
        stage.places.iter().map(|place| (place, &self.models[self.model(place.plant, 0, 0)]))
    }
}
