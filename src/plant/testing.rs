//! Trees of linden's presets for the tests of this crate.
//!
//! Tests see this crate twice: as what is tested, and as what `linden` depends on. Skeletons and organs
//! are the same for both; what is of this crate is read anew from the preset's document.

use std::sync::Arc;

use linden_base::document::{Datum, Entry, NamesFiles, Node};
use linden_base::knob::{Field, set};
use linden_base::monitor::{Monitor, Phase, Quiet};
use linden_pipeline::grow::Grown;
use linden_pipeline::preset::{Preset, builtin};
use linden_pipeline::recipe::Recipe;
use linden_skeleton::organs::Organs;

use crate::scene::{Material, Wrap};
use crate::settings::{
    self, BarkSettings, DetailSettings, Dressing, FoliageSettings, LeafKind, WindSettings,
};
use crate::surface::Tubes;
use crate::texture::DrawnPictures;
use crate::{Body, Specimen, Wanted};

/// A material of one colour.
pub fn plain(base_color: [f32; 3], double_sided: bool) -> Material {
    Material {
        name: "plain".to_owned(),
        base_color,
        base_color_picture: None,
        normal_picture: None,
        roughness: 1.0,
        double_sided,
        cutout: None,
        wrap: Wrap::Clamp,
        translucency: None,
        passing_picture: None,
    }
}

/// Nobody wants anything any more: what asks, stops.
pub struct Stop;

impl Monitor for Stop {
    fn is_cancelled(&self) -> bool {
        true
    }

    fn advance(&self, _: Phase, _: u64, _: Option<u64>) {}
}

/// A recipe, and how its tree looks.
pub struct Subject {
    pub recipe: Recipe,
    pub dressing: Dressing,
}

impl Subject {
    pub fn of(recipe: Recipe) -> Self {
        let dressing = dressing(&recipe.preset);
        Self { recipe, dressing }
    }

    /// A built-in preset with some knobs turned.
    pub fn builtin(id: &str, knobs: &[(&str, &str)]) -> Self {
        let mut recipe = builtin(id).unwrap().recipe(&Quiet).unwrap();
        for (knob, value) in knobs {
            recipe.preset.set(knob, value).unwrap();
        }
        Self::of(recipe)
    }

    pub fn grow(&self) -> Grown {
        linden_pipeline::grow::grow(&self.recipe, &Quiet).unwrap()
    }

    pub fn with<R>(&self, work: impl FnOnce(&Specimen<'_>) -> R) -> R {
        let preset = &self.recipe.preset;
        let line = |_: &Dressing, _: &Organs| self.recipe.to_line();
        work(&Specimen {
            name: &preset.name,
            seed: preset.seed(),
            dressing: &self.dressing,
            inputs: &self.recipe.inputs,
            drawn: &DrawnPictures::default(),
            wanted: Wanted::ALL,
            recipe: &line,
        })
    }

    pub fn dress(&self, grown: &Grown) -> crate::scene::Scene {
        self.with(|specimen| crate::dress::dress(specimen, body(grown), &Quiet)).unwrap()
    }
}

pub fn body(grown: &Grown) -> Body<'_> {
    Body { skeleton: &grown.skeleton, organs: &grown.organs, given: &grown.given, foot_in_file: None }
}

fn dressing(preset: &Preset) -> Dressing {
    let document = Node::from_toml(&preset.to_toml().unwrap()).unwrap();
    let Datum::Table(tables) = &document.datum else { panic!("a document is a table") };
    let mut dressing = Dressing::default();
    for table in tables {
        let Datum::Table(entries) = &table.node.datum else { continue };
        for entry in entries {
            match table.key.as_str() {
                "surface" => turn(Tubes::FIELDS, &mut dressing.tubes, entry),
                "bark" if dressing.bark.take_file(entry).unwrap() => {}
                "bark" => turn(BarkSettings::FIELDS, &mut dressing.bark, entry),
                "foliage" if settings::read(&mut dressing.foliage, entry).unwrap() => {}
                "foliage" if LeafKind::FIELDS.iter().any(|field| field.knob.is_called(&entry.key)) => {
                    turn(LeafKind::FIELDS, &mut dressing.foliage.first, entry);
                }
                "foliage" => turn(FoliageSettings::FIELDS, &mut dressing.foliage, entry),
                "detail" => turn(DetailSettings::FIELDS, &mut dressing.detail, entry),
                "wind" => turn(WindSettings::FIELDS, &mut dressing.wind, entry),
                _ => {}
            }
        }
    }
    dressing
}

fn turn<T>(fields: &[Field<T>], settings: &mut T, entry: &Entry) {
    let field = fields.iter().find(|field| field.knob.is_called(&entry.key)).unwrap();
    let value = entry.node.value(&entry.key, &field.knob.kind).unwrap();
    assert!(set(fields, settings, &entry.key, value));
}

/// A tree of a preset that nothing is turned of.
pub fn skeleton(id: &str) -> Arc<linden_skeleton::Skeleton> {
    Subject::builtin(id, &[]).grow().skeleton
}
