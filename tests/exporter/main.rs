//! A format of another crate: written with what `linden-exporters` makes public and nothing else, it gets
//! all that linden's formats get.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use std::io::{self, Cursor};
use std::path::Path;

use linden::dress::{dress, levels};
use linden::grow::{Grown, grow};
use linden::monitor::Phase;
use linden::preset::builtin;
use linden::recipe::Recipe;
use linden::scene::Scene;
use linden::stage::Stage;
use linden::{Monitor, Quiet};
use linden_exporters::writing::distinct::DistinctMeshes;
use linden_exporters::writing::records::{self, Digits};
use linden_exporters::writing::{fit, mean_digits, memory, one_word, pictures, recipe_in_comments};
use linden_exporters::{
    Amounts, Bundle, Encoding, Estimate, ExportError, Exporter, Format, GENERATOR, Holds, LooksIn,
    OptionSpec, Options, Readable, Registry, find,
};

/// Points and triangles a line each, with the name of each part before them; pictures lie beside it.
struct Lines;

static FORMAT: Format = Format {
    id: "lines",
    name: "Lines of text",
    extensions: &["lines"],
    media_type: "text/plain",
    self_contained: false,
    help: "a point or a triangle a line",
    options: &[OptionSpec::switch("pictures", true, "pictures beside the file")],
    holds: Holds { normals: false, ..Holds::MESH },
    levels_by: None,
    encoding: |_| Encoding::Text,
    estimate: Some(estimate),
};

fn estimate(amounts: &Amounts, options: &Options) -> u64 {
    let Amounts { vertices, triangles, recipe_bytes, picture_bytes, .. } = *amounts;
    let lines = 31.0 * vertices as f64 + triangles as f64 * (3.0 * mean_digits(vertices) + 4.0);
    lines as u64 + recipe_bytes + if options.is_on("pictures") { picture_bytes } else { 0 }
}

impl Exporter for Lines {
    fn format(&self) -> &'static Format {
        &FORMAT
    }

    fn recipe(&self, file: &mut dyn Readable) -> io::Result<Option<String>> {
        recipe_in_comments(file)
    }

    fn write(
        &self,
        stage: &Stage<'_>,
        options: &Options,
        bundle: &mut Bundle,
        monitor: &dyn Monitor,
    ) -> Result<(), ExportError> {
        let stage = &fit(stage, &FORMAT, bundle);
        let distinct = DistinctMeshes::of(stage, monitor)?;
        let is_shown = options.is_on("pictures") && bundle.takes_side_files();
        let pictures = if is_shown { pictures::of_materials(&distinct.materials) } else { Vec::new() };
        memory::admit(stage, &pictures, memory::formatting(&distinct), monitor)?;
        for (named, png) in pictures.iter().zip(pictures::compress(&pictures)?) {
            bundle.write_picture(&named.suffix, &png, monitor)?;
        }
        bundle.write_main(None, monitor, |out| {
            out.write(format!("# {GENERATOR}\n# recipe: {}\n", stage.recipe).as_bytes())?;
            let mut before = 0;
            for (place, plant) in distinct.placed(stage) {
                let motion = place.motion();
                for part in &plant.parts {
                    out.write(format!("part {}\n", one_word(&part.name)).as_bytes())?;
                    let mesh = &*part.mesh;
                    records::write(out, mesh.positions.len(), |text, range| {
                        for &point in &mesh.positions[range] {
                            let point = motion.map_or(point, |motion| motion.point(point));
                            text.floats(point.to_array(), b" ");
                            text.byte(b'\n');
                        }
                    })?;
                    records::write(out, mesh.triangles.len(), |text, range| {
                        for triangle in &mesh.triangles[range] {
                            text.byte(b't');
                            for &vertex in triangle {
                                text.byte(b' ');
                                text.digits(Digits::of(before + vertex));
                            }
                            text.byte(b'\n');
                        }
                    })?;
                    before += mesh.positions.len() as u32;
                }
            }
            Ok(())
        })
    }
}

fn recipe(knobs: &[(&str, &str)]) -> (Recipe, Grown) {
    let mut preset = builtin("dressed-simple").unwrap().load().unwrap();
    let small = [("points", "300"), ("bark_size", "64"), ("leaf_size", "64")];
    for (knob, value) in small.iter().chain(knobs) {
        preset.set(knob, value).unwrap();
    }
    let recipe = Recipe::new(preset);
    let grown = grow(&recipe, &Quiet).unwrap();
    (recipe, grown)
}

fn scene(knobs: &[(&str, &str)]) -> Scene {
    let (recipe, grown) = recipe(knobs);
    dress(&recipe, &grown, &Quiet).unwrap()
}

fn written(stage: &Stage<'_>, path: &Path, monitor: &dyn Monitor) -> Result<(u64, Vec<String>), ExportError> {
    let mut bundle = Bundle::create(path)?;
    Lines.write(stage, &Options::new(&FORMAT), &mut bundle, monitor)?;
    let notes = bundle.notes().to_vec();
    Ok((bundle.commit()?.iter().map(|file| file.bytes).sum(), notes))
}

#[test]
fn it_is_found_among_the_others_and_its_recipe_is_read() {
    let registry = Registry::new().with(&Lines);
    assert_eq!(registry.find("lines").unwrap().format().id, "lines");
    assert_eq!(registry.for_path(Path::new("a/Fir.LINES")).unwrap().format().id, "lines");
    assert_eq!(registry.find("glb").unwrap().format().id, "glb");
    let said = registry.find("line").err().unwrap().to_string();
    assert!(said.contains("did you mean 'lines'?"), "{said}");
    assert!(find("lines").is_err(), "linden's formats stay as they are");

    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("fir.lines");
    let scene = scene(&[]);
    written(&Stage::of(&scene), &path, &Quiet).unwrap();
    let bytes = std::fs::read(&path).unwrap();
    let found = registry.recipe_in(&mut Cursor::new(&bytes)).unwrap();
    assert_eq!(found, Some(scene.recipe));
    let triangles = bytes.split(|&byte| byte == b'\n').filter(|line| line.starts_with(b"t ")).count();
    assert_eq!(triangles, scene.parts.iter().map(|part| part.mesh.triangles.len()).sum::<usize>());
    assert!(folder.path().join("fir_bark.png").is_file());
}

#[test]
fn its_files_are_estimated() {
    let folder = tempfile::tempdir().unwrap();
    let (recipe, grown) = recipe(&[("lods", "2"), ("triangles", "8000")]);
    let estimate = Estimate::new(&recipe, &grown, &Quiet).unwrap();
    let options = Options::new(&FORMAT);
    assert_eq!(FORMAT.levels(), LooksIn::Files);
    let levels = levels(&recipe, &grown, &Quiet).unwrap();
    let mut sum = 0;
    for (number, level) in levels.levels.iter().enumerate() {
        let path = folder.path().join(format!("{number}.lines"));
        let (bytes, _) = written(&Stage::of(&level.scene), &path, &Quiet).unwrap();
        let ratio = estimate.level_bytes(number, &FORMAT, &options).unwrap() as f64 / bytes as f64;
        assert!((0.7..1.3).contains(&ratio), "level {number}: {ratio}");
        sum += bytes;
    }
    let all = estimate.bytes(&FORMAT, &options).unwrap();
    assert!((0.7..1.3).contains(&(all as f64 / sum as f64)), "{all} of {sum}");
    let seconds = estimate.write_seconds(&FORMAT, &options).unwrap();
    assert!((seconds / all as f64 - 2.2e-9).abs() < 1e-9, "text: {seconds} s");
}

#[test]
fn what_it_cannot_hold_is_noted() {
    let scene = scene(&[("wind", "attributes")]);
    let stage = Stage::of(&scene).in_setting().turned_by(["bark_relief", "wind_strength"]);
    let folder = tempfile::tempdir().unwrap();
    let (_, notes) = written(&stage, &folder.path().join("fir.lines"), &Quiet).unwrap();
    for said in ["no pictures of normals: bark_relief", "no wind: wind and wind_strength", "no camera"] {
        assert!(notes.iter().any(|note| note.starts_with("lines holds") && note.contains(said)), "{notes:?}");
    }
}

#[test]
fn a_broken_scene_or_too_little_memory_leaves_nothing_behind() {
    /// Less than anything takes.
    struct Poor;
    impl Monitor for Poor {
        fn is_cancelled(&self) -> bool {
            false
        }
        fn advance(&self, _: Phase, _: u64, _: Option<u64>) {}
        fn memory_limit(&self) -> u64 {
            1000
        }
    }
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("fir.lines");
    let mut scene = scene(&[]);
    assert!(matches!(written(&Stage::of(&scene), &path, &Poor), Err(ExportError::Memory(_))));
    scene.parts[0].mesh.positions[7].y = f32::NAN;
    let said = written(&Stage::of(&scene), &path, &Quiet).unwrap_err().to_string();
    assert!(said.contains("a position is NaN (vertex 7)"), "{said}");
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
}
