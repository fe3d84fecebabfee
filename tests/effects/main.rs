//! Nothing that is asked for is without effect in silence: every knob in every generator, and every knob
//! and every option of every format, changes bytes, is refused, or is named in a note.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

mod plants;

use std::collections::BTreeMap;
use std::fs;

use linden::Quiet;
use linden::dress::{Level, levels, year};
use linden::grow::grow;
use linden::knob::{Kind, Value};
use linden::preset::{PresetKnob, Section};
use linden::recipe::Recipe;
use linden::season::Season;
use linden::stage::Stage;
use linden_exporters::{Bundle, Exporter, LooksIn, Options, REGISTRY, find};
use plants::{Plant, plants};
use rayon::prelude::*;

/// The files of an export by name, and what was said.
#[derive(Clone, Debug, Default, PartialEq)]
struct Export {
    files: BTreeMap<String, Vec<u8>>,
    notes: Vec<String>,
}

impl Export {
    fn says(&self, name: &str) -> bool {
        self.notes.iter().any(|note| names(note, name))
    }
}

/// Whether a note has a name as a word.
fn names(note: &str, name: &str) -> bool {
    note.split(|c: char| !(c.is_alphanumeric() || c == '_')).any(|word| word == name)
}

/// A tree in levels as it stands in a file, but for the recipe, which holds every knob.
struct Dressed {
    seasons: Vec<(Season, Vec<Level>)>,
    notes: Vec<String>,
}

impl Dressed {
    fn of(recipe: &Recipe, seasons: &[Season]) -> Result<Self, String> {
        let grown = grow(recipe, &Quiet).map_err(|error| error.to_string())?;
        let mut notes = grown.notes.clone();
        let said = |error: linden::detail::DetailError| error.to_string();
        let mut seasons = if seasons.is_empty() {
            let dressed = levels(recipe, &grown, &Quiet).map_err(said)?;
            notes.extend(dressed.notes);
            vec![(Season { name: "summer".to_owned(), season: 0.35 }, dressed.levels)]
        } else {
            let dressed = year(recipe, &grown, seasons, &Quiet).map_err(said)?;
            notes.extend(dressed.notes);
            dressed.seasons
        };
        for level in seasons.iter_mut().flat_map(|(_, levels)| levels) {
            "{}".clone_into(&mut level.scene.recipe);
        }
        Ok(Self { seasons, notes })
    }

    /// How many levels it has.
    fn levels(&self) -> usize {
        self.seasons[0].1.len()
    }

    /// As `linden export` writes it: a file for each level and season where the format holds one.
    fn export(&self, exporter: &dyn Exporter, options: &Options, turned: &[&str], scene: bool) -> Export {
        let mut stage = Stage::of(&self.seasons[0].1[0].scene);
        stage.plants[0].seasons = self
            .seasons
            .iter()
            .map(|(season, levels)| linden::stage::Season {
                name: season.name.clone(),
                levels: levels.iter().map(Level::on_stage).collect(),
            })
            .collect();
        let stage = stage.turned_by(turned.iter().copied());
        let stage = if scene { stage.in_setting() } else { stage };
        let format = exporter.format();
        let count = |looks: LooksIn, count: usize| if looks == LooksIn::Files { count } else { 1 };
        let mut export = Export { notes: self.notes.clone(), ..Export::default() };
        for season in 0..count(format.seasons(), stage.seasons()) {
            for level in 0..count(format.levels_with(options), stage.levels()) {
                let mut part = stage.clone();
                if format.seasons() == LooksIn::Files {
                    part = part.in_season(season);
                }
                if format.levels_with(options) == LooksIn::Files {
                    part = part.at_level(level);
                }
                let folder = tempfile::tempdir().unwrap();
                let mut bundle = Bundle::create(&folder.path().join("tree.any")).unwrap().unsynced();
                exporter.write(&part, options, &mut bundle, &Quiet).unwrap();
                export.notes.extend_from_slice(bundle.notes());
                for file in bundle.commit().unwrap() {
                    let name = file.path.file_name().unwrap().to_string_lossy();
                    let bytes = fs::read(&file.path).unwrap();
                    export.files.insert(format!("{season} {level} {name}"), bytes);
                }
            }
        }
        export
    }
}

fn of_format(id: &str) -> (&'static dyn Exporter, Options) {
    let exporter = find(id).unwrap();
    (exporter, Options::new(exporter.format()))
}

/// All that is to be seen of a tree: the surface with everything on it, and the axial tree.
fn seen(recipe: &Recipe) -> Result<(Export, Export), String> {
    let dressed = Dressed::of(recipe, &[])?;
    let [surface, skeleton] = ["glb", "ply-skeleton"].map(|id| {
        let (exporter, mut options) = of_format(id);
        if id == "glb" {
            // All that materials are.
            options.set("translucency", "true").unwrap();
        }
        dressed.export(exporter, &options, &[], false)
    });
    // What the skeleton's format says of levels is no effect.
    Ok((surface, Export { notes: Vec::new(), ..skeleton }))
}

/// Values that a knob may be turned to, the likeliest to show first.
fn values(kind: &Kind, now: &Value) -> Vec<String> {
    let number = |x: f64, min: f64, max: f64| {
        let between = min + 0.3 * (if max.is_finite() { max } else { 100.0 } - min);
        vec![1.37 * x, 0.61 * x, 0.3, between, min, 0.01, 2.0, max]
    };
    let texts: Vec<String> = match (*kind, now) {
        (Kind::Real { min, max, .. }, now) => {
            let x = if let Value::Real(x) = now { *x } else { 0.5 };
            number(x, min, max).iter().map(f64::to_string).collect()
        }
        (Kind::Integer { min, .. }, Value::Integer(n)) => {
            [n + 1, n.saturating_sub(1), 2 * n, 5 * n, min].map(|n| n.to_string()).to_vec()
        }
        (Kind::Length { .. }, _) => ["3D", "7D", "0.2", "1.5"].map(str::to_owned).to_vec(),
        (Kind::Choice(words), _) => words.iter().map(|&word| word.to_owned()).collect(),
        (Kind::Switch, _) => vec!["true".to_owned(), "false".to_owned()],
        (Kind::Vector { .. }, _) => vec!["0.3,0.9,-0.4".to_owned(), "1,0.5,0".to_owned()],
        (Kind::Color { .. }, _) => vec!["#c04010".to_owned()],
        (Kind::Profile { most, .. }, _) => {
            let pairs = ["0,1", "1.5,1.2", "2,0.4", "3,0.1"];
            (1..=most.min(4)).rev().map(|count| pairs[..count].join("; ")).collect()
        }
        (Kind::Reals { .. }, _) => {
            ["1 3 0 2 4 1", "0.4", "0.1 0.2", "2 3", "300 100", "-0.5 0.2"].map(str::to_owned).to_vec()
        }
        (Kind::Words(words) | Kind::Sequence { words, .. }, _) => {
            words.iter().map(|&word| word.to_owned()).collect()
        }
        (Kind::Colors { .. }, _) => vec!["#c04010 #10c040".to_owned(), "#c04010".to_owned()],
        (Kind::Integer { .. }, _) => Vec::new(),
    };
    let differs = |text: &String| kind.parse(text).is_ok_and(|value| value != *now);
    texts.into_iter().filter(differs).collect()
}

/// Values that would take too long to see, with nothing to learn from them.
fn is_slow(name: &str, value: &str) -> bool {
    matches!((name, value), ("junction", "watertight")) || name == "subdivisions" && value > "2"
}

/// What came of turning a knob.
enum Came {
    /// Something changed, or it was refused: with this value.
    Effect(String),
    /// Nothing changed.
    Nothing,
}

/// Values that are tried of a knob that is said to change nothing: with all of them the test takes twice as long.
const TRIED_OF_IDLE: usize = 2;

fn turned(plant: &Plant, row: &PresetKnob, before: &(Export, Export)) -> Came {
    let preset = &plant.recipe.preset;
    let values = values(&row.knob.kind, &row.read(preset).unwrap());
    assert!(!values.is_empty(), "no value to turn {} to", row.knob.name);
    let most = if preset.idle(row.knob.name).is_some() { TRIED_OF_IDLE } else { usize::MAX };
    for value in values.iter().filter(|value| !is_slow(row.knob.name, value)).take(most) {
        let mut recipe = plant.recipe.clone();
        recipe.preset.set(row.knob.name, value).unwrap();
        match seen(&recipe) {
            Ok(after) if after == *before => {}
            Ok(_) | Err(_) => return Came::Effect(value.clone()),
        }
    }
    Came::Nothing
}

/// Turns every knob of every plant.
#[test]
fn every_knob_has_an_effect_or_a_note_that_names_it() {
    let plants = plants();
    let befores: Vec<_> = plants.par_iter().map(|plant| seen(&plant.recipe).unwrap()).collect();
    let all: Vec<_> = plants
        .iter()
        .zip(&befores)
        .flat_map(|(plant, before)| {
            plant.recipe.preset.knobs().into_iter().map(move |(row, _)| (plant, before, row))
        })
        .collect();
    assert!(all.len() > 900, "{}", all.len());
    let mut faults: Vec<String> = all
        .par_iter()
        .filter_map(|(plant, before, row)| {
            let name = row.knob.name;
            let preset = &plant.recipe.preset;
            match (turned(plant, row, before), preset.idle(name)) {
                (Came::Effect(_), None) | (Came::Nothing, Some(_)) => None,
                (Came::Nothing, None) => {
                    Some(format!("{}: {name} changes nothing, and nothing is said", plant.name))
                }
                (Came::Effect(value), Some(why)) => {
                    // What lifts the reason itself has an effect: then there is nothing to say.
                    let mut lifted = preset.clone();
                    lifted.set(name, &value).unwrap();
                    let why = lifted.idle(name).map(|_| why)?;
                    Some(format!("{}: {name}={value} has an effect, though '{why}'", plant.name))
                }
            }
        })
        .collect();
    faults.sort();
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

/// Turns what says how leaves look, of every outline.
#[test]
fn every_knob_of_an_outline_has_an_effect_or_a_note_that_names_it() {
    let plant = plants().into_iter().find(|plant| plant.name == "crown").unwrap();
    let outlines = plant.recipe.preset.knobs().into_iter().find_map(|(row, _)| match row.knob.kind {
        Kind::Choice(words) if row.knob.name == "leaf_outline" => Some(words),
        _ => None,
    });
    let names = ["leaf_width", "leaf_lobes", "leaf_lobe_depth", "leaf_margin", "leaf_petiole"];
    let mut faults: Vec<String> = outlines
        .unwrap()
        .par_iter()
        .flat_map_iter(|outline| {
            let mut outlined = Plant { name: outline, recipe: plant.recipe.clone() };
            outlined.recipe.preset.set("leaf_outline", outline).unwrap();
            outlined.recipe.preset.set("leaf_size", "96").unwrap();
            outlined.recipe.preset.set("points", "5").unwrap();
            let before = seen(&outlined.recipe).unwrap();
            let rows =
                outlined.recipe.preset.knobs().into_iter().filter(|(row, _)| names.contains(&row.knob.name));
            let faults = rows.filter_map(|(row, _)| {
                let idle = outlined.recipe.preset.idle(row.knob.name);
                match (turned(&outlined, &row, &before), idle) {
                    (Came::Effect(_), None) | (Came::Nothing, Some(_)) => None,
                    (_, idle) => Some(format!("{outline}: {} is said to be {idle:?}", row.knob.name)),
                }
            });
            faults.collect::<Vec<_>>()
        })
        .collect();
    faults.sort();
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

/// Turns knobs that have an effect somewhere, and writes all formats.
#[test]
fn what_a_format_cannot_hold_of_a_knob_is_noted() {
    let plant = plants().into_iter().find(|plant| plant.name == "everything").unwrap();
    let before = Dressed::of(&plant.recipe, &[]).unwrap();
    let seen_before = seen(&plant.recipe).unwrap();
    let formats: Vec<(&dyn Exporter, Options)> =
        REGISTRY.iter().map(|exporter| (*exporter, Options::new(exporter.format()))).collect();
    let exports: Vec<Export> =
        formats.iter().map(|(exporter, options)| before.export(*exporter, options, &[], false)).collect();
    let rows = plant.recipe.preset.knobs();
    let mut faults: Vec<String> = rows
        .par_iter()
        .flat_map_iter(|(row, _)| {
            let mut faults = Vec::new();
            let name = row.knob.name;
            let Came::Effect(value) = turned(&plant, row, &seen_before) else { return faults };
            let mut recipe = plant.recipe.clone();
            recipe.preset.set(name, &value).unwrap();
            // What is refused is named already.
            let Ok(after) = Dressed::of(&recipe, &[]) else { return faults };
            for ((exporter, options), before) in formats.iter().zip(&exports) {
                let after = after.export(*exporter, options, &[name], false);
                let id = exporter.format().id;
                if after.files == before.files && !after.says(name) && !before.says(name) {
                    faults.push(format!("{id}: {name}={value} changes nothing, and nothing is said"));
                }
                if row.section == Section::Tree || !row.section.covers() {
                    continue;
                }
                if after.files != before.files
                    && after.notes.iter().any(|note| names(note, name) && note.contains("nothing in it"))
                {
                    faults.push(format!("{id}: {name}={value} has an effect, and a note denies it"));
                }
            }
            faults
        })
        .collect();
    faults.sort();
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

/// Asks every format for levels, seasons, planes, wind and a scene.
#[test]
fn what_a_format_cannot_hold_of_an_export_is_noted() {
    type Asked<'a> = (&'a str, &'a [(&'a str, &'a str)], &'a [Season], bool);
    let plain = plants().into_iter().find(|plant| plant.name == "crown").unwrap().recipe;
    let before = Dressed::of(&plain, &[]).unwrap();
    let seasons = Season::parse_list("summer,autumn").unwrap();
    let asked: [Asked<'_>; 8] = [
        ("lods", &[("lods", "2")], &[], false),
        ("lods", &[("lod_triangles", "900 300")], &[], false),
        ("lods", &[("billboard", "2"), ("billboard_size", "64")], &[], false),
        ("wind", &[("wind", "attributes")], &[], false),
        ("wind", &[("wind", "sway")], &[], false),
        ("wind", &[("wind", "bones")], &[], false),
        ("seasons", &[], &seasons, false),
        ("scene", &[], &[], true),
    ];
    let mut faults = Vec::new();
    for (name, knobs, seasons, scene) in asked {
        let mut recipe = plain.clone();
        for (knob, value) in knobs {
            recipe.preset.set(knob, value).unwrap();
        }
        let after = Dressed::of(&recipe, seasons).unwrap();
        for exporter in REGISTRY {
            let options = Options::new(exporter.format());
            let [before, after] = [(&before, false), (&after, scene)]
                .map(|(dressed, scene)| dressed.export(*exporter, &options, &[], scene));
            let id = exporter.format().id;
            // Names of files differ already where each level has one.
            let bytes = |export: &Export| -> Vec<Vec<u8>> { export.files.values().cloned().collect() };
            if bytes(&before) == bytes(&after) && !after.says(name) {
                faults.push(format!("{id}: {name} {knobs:?} changes nothing, and nothing is said"));
            }
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

/// Turns every option of every format.
#[test]
fn every_option_of_a_format_has_an_effect_or_a_note_that_names_it() {
    let mut faults = Vec::new();
    for plant in plants()
        .iter()
        .filter(|plant| ["crown", "bare", "everything", "windy", "jointed"].contains(&plant.name))
    {
        let dressed = Dressed::of(&plant.recipe, &[]).unwrap();
        for exporter in REGISTRY {
            let format = exporter.format();
            let plain = Options::new(format);
            let before = dressed.export(*exporter, &plain, &[], false);
            for spec in format.options {
                let name = spec.knob.name;
                let now = spec.knob.kind.parse(spec.default).unwrap();
                for value in values(&spec.knob.kind, &now) {
                    let mut options = plain.clone();
                    options.set(name, &value).unwrap();
                    let after = dressed.export(*exporter, &options, &[], false);
                    // One level in a file each is one file.
                    let is_alone = name == "lods" && value == "files" && dressed.levels() == 1;
                    if after.files == before.files && !after.says(name) && !is_alone {
                        faults.push(format!(
                            "{}: {}.{name}={value} changes nothing, and nothing is said",
                            plant.name, format.id
                        ));
                    }
                }
            }
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}
