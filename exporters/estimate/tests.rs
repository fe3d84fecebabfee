//! Estimates beside real files.

use std::sync::{Arc, LazyLock};

use linden_pipeline::Quiet;
use linden_pipeline::dress::dress;
use linden_pipeline::dress::levels;
use linden_pipeline::grow::grow;
use linden_pipeline::mesh::Mesh;
use linden_pipeline::preset::builtins;
use linden_pipeline::stage::Stage;
use linden_pipeline::texture::{BarkStyle, DrawnPictures};
use rayon::prelude::*;

use super::*;
use crate::{Bundle, Exporter, REGISTRY};

/// Says what is off by more than 30 %.
fn off(what: &str, estimated: u64, real: u64) -> Option<String> {
    let ratio = estimated as f64 / real as f64;
    (!(0.7..=1.3).contains(&ratio)).then(|| format!("{what}: {estimated} is {ratio:.2} of {real}"))
}

fn within(what: &str, estimated: u64, real: u64) {
    assert_eq!(off(what, estimated, real), None);
}

/// Every choice of a switch or word that a format has, one at a time.
fn all_options(format: &'static Format) -> Vec<Options> {
    let plain = Options::new(format);
    let mut all = vec![plain.clone()];
    for spec in format.options {
        let values: Vec<&str> = match spec.knob.kind {
            linden_pipeline::knob::Kind::Switch => vec!["false", "true"],
            linden_pipeline::knob::Kind::Choice(words) => words.to_vec(),
            _ => vec![spec.default],
        };
        let with = |options: &Options, value: &str| {
            let mut options = options.clone();
            options.set(spec.knob.name, value).unwrap();
            options
        };
        let others = values.into_iter().filter(|value| *value != spec.default);
        all.extend(others.map(|value| with(&plain, value)));
    }
    // Without pictures, of which little else would be seen.
    let mut smallest = plain;
    let turned =
        [("pictures", "false"), ("instances", "true"), ("quantize", "true"), ("compress", "meshopt")];
    for (name, value) in turned {
        if format.options.iter().any(|spec| spec.knob.name == name) {
            smallest.set(name, value).unwrap();
            all.push(smallest.clone());
        }
    }
    all
}

/// Triangles of a large tree.
const LARGE: u64 = 30_000;
/// Of one that takes seconds to dress: every third is.
const VERY_LARGE: u64 = 300_000;

/// Which files a tree is written to: those that are its turn, of which each is that of one tree in so many.
#[derive(Clone, Copy)]
struct Turn {
    tree: usize,
    trees: usize,
}

impl Turn {
    fn has(self, file: usize) -> bool {
        (file + self.tree).is_multiple_of(self.trees)
    }
}

/// Every format with each of its options; of large trees without options, for the time that these take.
fn all_files(triangles: u64) -> Vec<(&'static dyn Exporter, Options)> {
    let most = if triangles > LARGE { 1 } else { usize::MAX };
    let files = REGISTRY.iter().flat_map(|&exporter| {
        let all = all_options(exporter.format()).into_iter().take(most);
        all.map(move |options| (exporter, options))
    });
    files.collect()
}

/// Estimates beside what they are of.
#[derive(Default)]
struct Compared {
    trees: usize,
    /// Files large enough to be compared.
    files: usize,
    /// Those that are off.
    faults: Vec<String>,
}

impl Compared {
    fn and(mut self, other: Self) -> Self {
        self.faults.extend(other.faults);
        Self { trees: self.trees + other.trees, files: self.files + other.files, faults: self.faults }
    }
}

/// Counts a tree, writes it to the files whose turn it is, and says which estimates are off.
fn all_off(what: &str, turn: Turn, recipe: &Recipe) -> Compared {
    let mut faults = Vec::new();
    let grown = grow(recipe, &Quiet).unwrap_or_else(|error| panic!("{what}: {error}"));
    let estimate = Estimate::new(recipe, &grown, &Quiet).unwrap();
    if estimate.triangles > VERY_LARGE && !turn.tree.is_multiple_of(3) {
        return Compared::default();
    }
    let levels = levels(recipe, &grown, &Quiet).unwrap();
    let finest = &levels.levels[0].scene;
    let vertices = finest.parts.iter().map(|part| part.mesh.positions.len() as u64).sum();
    let triangles = finest.parts.iter().map(|part| part.mesh.triangles.len() as u64).sum();
    faults.extend(off(what, estimate.vertices, vertices));
    faults.extend(off(what, estimate.triangles, triangles));
    let is_counted = recipe.preset.dressing.detail.finest() == 0
        && recipe.preset.dressing.tubes.junction != Junction::Watertight
        // Where two barks meet, both have the ring.
        && recipe.preset.dressing.bark.thin_barks().is_empty()
        && recipe.preset.dressing.bark.moss.amount == 0.0
        && recipe.preset.dressing.foot_bark().is_none()
        && grown.organs.polygons.ends.is_empty();
    if is_counted && (estimate.vertices, estimate.triangles) != (vertices, triangles) {
        faults.push(format!("{what}: {estimate:?} is not {vertices} vertices, {triangles} triangles"));
    }
    let mut files = 0;
    let its = all_files(triangles).into_iter().enumerate().filter(|&(file, _)| turn.has(file));
    for (_, (exporter, options)) in its {
        let format = exporter.format();
        let write = |stage: &Stage<'_>| -> u64 {
            let dir = tempfile::tempdir().unwrap();
            let mut bundle = Bundle::create(&dir.path().join("tree.any")).unwrap().unsynced();
            exporter.write(stage, &options, &mut bundle, &Quiet).unwrap();
            bundle.commit().unwrap().iter().map(|file| file.bytes).sum()
        };
        let real = match format.levels_with(&options) {
            LooksIn::Files => levels.levels.iter().map(|level| write(&Stage::of(&level.scene))).sum(),
            _ => write(&levels.stage()),
        };
        // A file of a few pages is mostly what stands around the tree.
        if real > 32_768 {
            files += 1;
            let values: Vec<String> = options.iter().map(|(_, v)| v.to_string()).collect();
            let what = format!("{what} as {} {}", format.id, values.join(" "));
            faults.extend(off(&what, estimate.bytes(format, &options).unwrap(), real));
        }
    }
    Compared { trees: 1, files, faults }
}

#[test]
fn estimates_are_near_the_real_files() {
    let each = builtins().par_iter().enumerate().map(|(tree, builtin)| {
        all_off(builtin.id, Turn { tree, trees: 8 }, &builtin.recipe(&Quiet).unwrap())
    });
    let all = each.reduce(Compared::default, Compared::and);
    assert_eq!(all.faults, [""; 0]);
    assert!(all.trees >= 70 && all.files >= 450, "of {} trees {} files", all.trees, all.files);
}

#[test]
fn budgets_levels_and_wind_are_estimated_too() {
    let cases: [&[(&str, &str)]; 7] = [
        &[("triangles", "12000")],
        &[("lods", "3"), ("triangles", "20000")],
        &[("lods", "2"), ("lod_ratio", "0.6"), ("billboard", "2"), ("triangles", "9000")],
        &[("billboard", "3"), ("billboard_size", "256"), ("triangles", "20000")],
        &[("wind", "attributes"), ("triangles", "15000")],
        &[("wind", "sway"), ("lods", "2"), ("triangles", "20000")],
        &[("wind", "bones"), ("lods", "2"), ("triangles", "20000")],
    ];
    let plants = ["oak", "dressed-fir", "box"];
    // Bark and leaves of a plant are those of all its cases.
    let drawn = Arc::new(DrawnPictures::default());
    // Each case has every second file with one of the plants, the next case the others.
    let all = (0..plants.len()).flat_map(|plant| (0..cases.len()).map(move |case| (plant, case)));
    let each = all.collect::<Vec<_>>().into_par_iter().map(|(plant, case)| {
        let (id, knobs) = (plants[plant], cases[case]);
        let turn = Turn { tree: plant + plants.len() * case, trees: 2 * plants.len() };
        let mut preset = linden_pipeline::preset::builtin(id).unwrap().load().unwrap();
        for (knob, value) in knobs {
            preset.set(knob, value).unwrap();
        }
        all_off(&format!("{id} {knobs:?}"), turn, &Recipe::new(preset).drawn_into(&drawn))
    });
    let all = each.reduce(Compared::default, Compared::and);
    assert_eq!(all.faults, [""; 0]);
    assert_eq!(all.trees, plants.len() * cases.len());
}

#[test]
fn other_surfaces_and_barks_are_estimated_too() {
    for (knob, value) in [
        ("sides", "3"),
        ("sides", "8"),
        ("sides", "96"),
        ("rings", "2"),
        ("rings", "7"),
        ("bark_size", "128"),
        ("bark_size", "1024"),
        ("bark", "smooth"),
        ("bark", "plated"),
        ("bark_grain", "3"),
        ("bark_grain", "0"),
        ("moss", "0.6"),
    ] {
        let mut preset = linden_pipeline::preset::builtin("older-f").unwrap().load().unwrap();
        preset.set(knob, value).unwrap();
        let recipe = Recipe::new(preset);
        let grown = grow(&recipe, &Quiet).unwrap();
        let estimate = Estimate::new(&recipe, &grown, &Quiet).unwrap();
        let scene = dress(&recipe, &grown, &Quiet).unwrap();
        let what = format!("{knob}={value}");
        let sum = |of: &dyn Fn(&Mesh) -> usize| scene.parts.iter().map(|part| of(&part.mesh) as u64).sum();
        within(&what, estimate.triangles, sum(&|mesh| mesh.triangles.len()));
        within(&what, estimate.vertices, sum(&|mesh| mesh.positions.len()));
        let stage = Stage::of(&scene);
        let distinct = crate::writing::distinct::DistinctMeshes::of(&stage, &Quiet).unwrap();
        let pictures = crate::writing::pictures::of_materials(&distinct.materials);
        let real: usize =
            crate::writing::pictures::compress(&pictures).unwrap().iter().map(|png| png.len()).sum();
        within(&what, estimate.picture_bytes(&estimate.levels), real as u64);
    }
}

#[test]
fn bark_from_a_file_is_estimated_by_its_file() {
    let preset = linden_pipeline::preset::builtin("older-f").unwrap().load().unwrap();
    let key = linden_pipeline::random::Key::new(3);
    for style in [BarkStyle::Ridged, BarkStyle::Plated, BarkStyle::Birch] {
        let mut recipe = Recipe::new(preset.clone());
        let bark = linden_pipeline::texture::Bark {
            size_px: 512,
            ..linden_pipeline::texture::Bark::new(style, key)
        };
        let photograph = bark.draw(&Quiet).unwrap().base_color;
        let png = photograph.png().unwrap();
        let input = linden_pipeline::recipe::Input::read("my.png", png, &Quiet).unwrap();
        assert!(recipe.put_file("bark_picture", "my.png", &input));
        let grown = grow(&recipe, &Quiet).unwrap();
        let estimate = Estimate::new(&recipe, &grown, &Quiet).unwrap();
        let scene = dress(&recipe, &grown, &Quiet).unwrap();
        let stage = Stage::of(&scene);
        let distinct = crate::writing::distinct::DistinctMeshes::of(&stage, &Quiet).unwrap();
        let pictures = crate::writing::pictures::of_materials(&distinct.materials);
        let real: usize =
            crate::writing::pictures::compress(&pictures).unwrap().iter().map(|png| png.len()).sum();
        within(&format!("{style:?}"), estimate.picture_bytes(&estimate.levels), real as u64);
    }
}

static UNKNOWN: LazyLock<Format> =
    LazyLock::new(|| Format { estimate: None, ..*crate::find("obj").unwrap().format() });

#[test]
fn a_format_without_an_estimate_is_unknown_not_empty() {
    let recipe = Recipe::new(linden_pipeline::preset::builtin("older-f").unwrap().load().unwrap());
    let grown = grow(&recipe, &Quiet).unwrap();
    let estimate = Estimate::new(&recipe, &grown, &Quiet).unwrap();
    let options = Options::new(&UNKNOWN);
    assert_eq!(estimate.bytes(&UNKNOWN, &options), None);
    assert_eq!(estimate.level_bytes(0, &UNKNOWN, &options), None);
    assert_eq!(estimate.write_seconds(&UNKNOWN, &options), None);
    let obj = crate::find("obj").unwrap().format();
    assert!(estimate.bytes(obj, &Options::new(obj)) > Some(1000));
}

#[test]
fn digits_are_counted() {
    for count in [1, 9, 10, 11, 99, 100, 4321] {
        let sum: usize = (1..=count).map(|n: u64| n.to_string().len()).sum();
        assert!((mean_digits(count) - sum as f64 / count as f64).abs() < 1e-12, "{count}");
    }
}
