//! What is on a stage, each thing once: meshes with their boxes, materials with their names.
//!
//! Scenes hold their materials for themselves; the levels of a plant, and trees of a kind, share them.
//! Equal materials become one here, under a name that no other has.

use std::borrow::Cow;
use std::collections::BTreeSet;

use linden::Monitor;
use linden::foliage::Placement;
use linden::scene::{Bounds, Material, Mesh, Scene};
use linden::stage::{Ground, Place, Sky, Stage};
use linden::wind::PartWind;

use crate::{ExportError, sound};

/// Everything on a stage, checked.
pub(crate) struct Cast<'a> {
    /// All that is distinct: plant by plant, season by season, level by level.
    pub models: Vec<Model<'a>>,
    /// Each once.
    pub looks: Vec<Look<'a>>,
    /// The ground that all stand on.
    pub ground: Option<Piece<'a>>,
    /// The sky as a mesh: for formats that have none.
    pub dome: Option<Piece<'a>>,
    /// By plant: its first model, and how many seasons and levels it has.
    plants: Vec<Range>,
}

#[derive(Clone, Copy)]
struct Range {
    first: usize,
    seasons: usize,
    levels: usize,
}

/// A scene as the exporters of meshes see it.
pub(crate) struct Model<'a> {
    /// Where it comes from.
    pub scene: &'a Scene,
    /// Its parts.
    pub pieces: Vec<Piece<'a>>,
    /// Its materials, those that no part has included.
    pub looks: Vec<usize>,
}

/// A mesh with one material.
pub(crate) struct Piece<'a> {
    /// Unique within its model.
    pub name: Cow<'a, str>,
    /// The geometry.
    pub mesh: Cow<'a, Mesh>,
    /// Smallest and largest of the stored coordinates, exactly.
    pub bounds: Bounds,
    /// Index into [`Cast::looks`].
    pub look: usize,
    /// How it swings.
    pub wind: Option<&'a PartWind>,
    /// Where it stands, in units of its own, instead of once as it is.
    pub copies: Option<Stand<'a>>,
}

/// A mesh of a part that stands in many places.
pub(crate) struct Stand<'a> {
    /// The part's name: its copies are together.
    pub part: &'a str,
    /// At least one.
    pub placements: Vec<Placement>,
    /// Around the boxes of all copies.
    pub seen: Bounds,
}

/// A material under a name that no other has.
pub(crate) struct Look<'a> {
    /// Lower-case identifier: `bark`; `norway_spruce_bark` where there are several kinds of plants.
    pub name: String,
    /// The material.
    pub material: &'a Material,
}

impl Piece<'_> {
    /// Whether both stand in the same places.
    pub fn is_placed_as(&self, other: &Self) -> bool {
        let [own, other] = [self, other].map(|own| own.copies.as_ref().map(|own| &own.placements));
        own == other
    }

    /// The part that it is copies of, if it is.
    pub fn copied_part(&self) -> Option<&str> {
        self.copies.as_ref().map(|own| own.part)
    }
}

impl<'a> Cast<'a> {
    /// Checks the plants of a stage and lists them.
    ///
    /// # Errors
    /// [`ExportError::Scene`] for a stage or scene that breaks a promise of its types, and
    /// [`ExportError::Cancelled`].
    pub fn of(stage: &'a Stage<'_>, monitor: &dyn Monitor) -> Result<Self, ExportError> {
        sound::check_stage(stage)?;
        let mut cast =
            Self { models: Vec::new(), looks: Vec::new(), ground: None, dome: None, plants: Vec::new() };
        let mut names = BTreeSet::new();
        for plant in &stage.plants {
            let (seasons, levels) = (plant.seasons.len(), plant.levels().len());
            cast.plants.push(Range { first: cast.models.len(), seasons, levels });
            for scene in plant.scenes() {
                let bounds = sound::check(scene, monitor)?;
                let looks: Vec<usize> = scene
                    .materials
                    .iter()
                    .map(|material| {
                        let kind = (stage.plants.len() > 1).then_some(scene.name.as_str());
                        cast.look(material, kind, &mut names)
                    })
                    .collect();
                let pieces: Vec<Piece<'_>> = scene
                    .parts
                    .iter()
                    .zip(bounds)
                    .map(|(part, bounds)| Piece {
                        name: Cow::Borrowed(&part.name),
                        mesh: Cow::Borrowed(&part.mesh),
                        bounds,
                        look: looks[part.material],
                        wind: part.wind.as_ref(),
                        copies: None,
                    })
                    .collect();
                cast.models.push(Model { scene, pieces, looks });
            }
        }
        Ok(cast)
    }

    /// As [`Cast::of`], for formats that hold what stands around plants too.
    ///
    /// # Errors
    /// As [`Cast::of`].
    pub fn in_setting(stage: &'a Stage<'_>, monitor: &dyn Monitor) -> Result<Self, ExportError> {
        let mut cast = Self::of(stage, monitor)?;
        if let Some(Ground { mesh, material }) = stage.setting.as_ref().map(|setting| &setting.ground) {
            cast.ground = Some(cast.around("Ground", mesh, material, monitor)?);
        }
        Ok(cast)
    }

    /// As [`Cast::in_setting`], with the sky as a mesh.
    ///
    /// # Errors
    /// As [`Cast::of`].
    pub fn under_dome(stage: &'a Stage<'_>, monitor: &dyn Monitor) -> Result<Self, ExportError> {
        let mut cast = Self::in_setting(stage, monitor)?;
        if let Some(Sky { dome, material, .. }) = stage.setting.as_ref().map(|setting| &setting.sky) {
            cast.dome = Some(cast.around("Sky", dome, material, monitor)?);
        }
        Ok(cast)
    }

    fn around(
        &mut self,
        name: &'a str,
        mesh: &'a Mesh,
        material: &'a Material,
        monitor: &dyn Monitor,
    ) -> Result<Piece<'a>, ExportError> {
        let bounds = sound::check_around(name, mesh, material, monitor)?;
        let mut names = self.looks.iter().map(|look| look.name.clone()).collect();
        let look = self.look(material, None, &mut names);
        let (name, mesh) = (Cow::Borrowed(name), Cow::Borrowed(mesh));
        Ok(Piece { name, mesh, bounds, look, wind: None, copies: None })
    }

    /// The index of a material; lists it if it is new. `kind` is what its plant is called where there
    /// are several.
    fn look(&mut self, material: &'a Material, kind: Option<&str>, names: &mut BTreeSet<String>) -> usize {
        if let Some(known) = self.looks.iter().position(|look| look.material == material) {
            return known;
        }
        let plain = match kind {
            Some(kind) => format!("{}_{}", identifier(kind), material.name),
            None => material.name.clone(),
        };
        let mut name = plain.clone();
        let mut number = 2;
        while !names.insert(name.clone()) {
            name = format!("{plain}_{number}");
            number += 1;
        }
        self.looks.push(Look { name, material });
        self.looks.len() - 1
    }

    /// The model of a plant in one of its seasons and levels.
    pub fn model(&self, plant: usize, season: usize, level: usize) -> usize {
        let range = self.plants[plant];
        range.first + season * range.levels + level
    }

    /// All models of a plant.
    pub fn models_of(&self, plant: usize) -> &[Model<'a>] {
        let Range { first, seasons, levels } = self.plants[plant];
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

    /// All meshes, each once; ground and sky come last.
    pub fn pieces(&self) -> impl Iterator<Item = &Piece<'a>> {
        self.models.iter().flat_map(|model| &model.pieces).chain(&self.ground).chain(&self.dome)
    }

    /// How many copies of pieces stand somewhere.
    pub fn placements(&self) -> usize {
        self.pieces().filter_map(|piece| piece.copies.as_ref()).map(|own| own.placements.len()).sum()
    }

    /// What stands where, seen from near.
    pub fn placed<'s>(&'s self, stage: &'s Stage<'_>) -> impl Iterator<Item = (&'s Place, &'s Model<'a>)> {
        stage.places.iter().map(|place| (place, &self.models[self.model(place.plant, 0, 0)]))
    }
}

/// Lower-case ASCII letters, digits and `_`.
fn identifier(name: &str) -> String {
    name.chars().map(|c| if c.is_ascii_alphanumeric() { c.to_ascii_lowercase() } else { '_' }).collect()
}
