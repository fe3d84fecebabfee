//! Leaves in every format, before every client and read back.

use linden::Quiet;
use linden::dress::dress;
use linden::grow::{Grown, grow};
use linden::preset::builtin;
use linden::recipe::Recipe;
use linden::scene::Scene;
use linden_exporters::{Estimate, Options, REGISTRY};
use linden_tests::fixtures::export;

use crate::outside::{exported, run};

/// A branch with outlines of three kinds and every organ, in four colours of which three are given.
fn scene() -> (Recipe, Grown, Scene) {
    let mut preset = builtin("abop-a").unwrap().load().unwrap();
    "Leafy".clone_into(&mut preset.name);
    let linden::preset::Generator::LSystem(own) = &mut preset.generator else { panic!("it is one") };
    let rules = [
        "A -> FF[&+FEA]/////[&-F'~LA]///////F~NA",
        "E -> [^^{-f+f+f-|-f+f+f}''~K'~B{[++G.][+G.][G.][-G.]}{f++++++++f----f}]",
    ];
    own.grammar = linden::lsystem::Grammar::new("A", &rules).unwrap();
    (own.derivations, own.angle_deg) = (5, 22.5);
    preset.set("leaf_colors", "#406020 #708030 #d04060").unwrap();
    let recipe = Recipe { preset, inputs: Vec::new() };
    let grown = grow(&recipe, &Quiet).unwrap();
    let scene = dress(&recipe, &grown, &Quiet).unwrap();
    (recipe, grown, scene)
}

#[test]
fn every_client_takes_leaves() {
    let dir = exported("clients-foliage");
    let (_, _, scene) = scene();
    for exporter in REGISTRY {
        let format = exporter.format();
        let name = match format.extensions.first() {
            Some(ending) => format!("leafy.{ending}"),
            None => "leafy_skeleton.ply".to_owned(),
        };
        export(&scene, format.id, &[], &dir.join(name)).unwrap();
    }
    run("check.py", &dir);
}

#[test]
fn each_colour_is_a_double_sided_part_of_its_own() {
    let (_, grown, scene) = scene();
    let names: Vec<&str> = scene.parts.iter().map(|part| part.name.as_str()).collect();
    assert_eq!(names, ["wood", "leaves", "leaves_1", "leaves_2"]);
    for part in &scene.parts[1..] {
        let material = &scene.materials[part.material];
        assert_eq!(material.name, part.name);
        assert!(material.double_sided && material.base_color_picture.is_none());
    }
    assert!(grown.organs.len() > 100);
    let dir = tempfile::tempdir().unwrap();
    let target = dir.path().join("leafy.glb");
    export(&scene, "glb", &[], &target).unwrap();
    let (document, buffers, _) = gltf::import(&target).unwrap();
    let sides: Vec<bool> = document.materials().map(|material| material.double_sided()).collect();
    assert_eq!(sides, [false, true, true, true]);
    for (mesh, part) in document.meshes().zip(&scene.parts) {
        let primitive = mesh.primitives().next().unwrap();
        let reader = primitive.reader(|buffer| Some(&buffers[buffer.index()]));
        assert_eq!(reader.read_positions().unwrap().count(), part.mesh.positions.len());
    }
    let target = dir.path().join("leafy.usda");
    export(&scene, "usda", &[], &target).unwrap();
    let text = std::fs::read_to_string(&target).unwrap();
    assert_eq!(text.matches("uniform bool doubleSided = 1").count(), 3);
}

#[test]
fn estimates_know_of_leaves() {
    let (recipe, grown, scene) = scene();
    let estimate = Estimate::new(&recipe, &grown, &Quiet).unwrap();
    let near = |what: &str, estimated: u64, real: u64| {
        let ratio = estimated as f64 / real as f64;
        assert!((0.7..1.3).contains(&ratio), "{what}: {estimated} of {real}");
    };
    let count = |of: fn(&linden::scene::Mesh) -> usize| {
        scene.parts.iter().map(|part| of(&part.mesh) as u64).sum::<u64>()
    };
    near("triangles", estimate.triangles, count(|mesh| mesh.triangles.len()));
    near("vertices", estimate.vertices, count(|mesh| mesh.positions.len()));
    let dir = tempfile::tempdir().unwrap();
    for exporter in REGISTRY {
        let format = exporter.format();
        let written = export(&scene, format.id, &[], &dir.path().join("leafy.any")).unwrap();
        let real = written.iter().map(|file| file.bytes).sum();
        near(format.id, estimate.bytes(format, &Options::new(format)), real);
    }
}
