//! Leaves as few meshes in many places, before every client: the same tree as baked.

use linden::Quiet;
use linden::dress::dress;
use linden::dress::levels;
use linden::foliage::PROTOTYPES;
use linden::grow::{Grown, grow};
use linden::preset::builtin;
use linden::recipe::Recipe;
use linden::scene::Scene;
use linden::stage::{Place, Stage};
use linden_exporters::{Bundle, Options, find};
use linden_tests::fixtures::{export, export_stage};

use crate::foliage;
use crate::outside::{exported, run};

const ON: (&str, &str) = ("instances", "true");

/// A small tree with a few hundred leaves of several variants, on which berries hang.
pub fn dressed(settings: &[(&str, &str)]) -> (Recipe, Grown, Scene) {
    let mut preset = builtin("dressed-simple").unwrap().load().unwrap();
    let small = [("points", "60"), ("leaves_per_m", "8")];
    let pictures = [("bark_size", "64"), ("leaf_size", "128"), ("card_size", "128")];
    for (knob, value) in small.into_iter().chain(pictures).chain(settings.iter().copied()) {
        preset.set(knob, value).unwrap();
    }
    let recipe = Recipe::new(preset);
    let grown = grow(&recipe, &Quiet).unwrap();
    let scene = dress(&recipe, &grown, &Quiet).unwrap();
    (recipe, grown, scene)
}

#[test]
fn instanced_leaves_are_the_baked_ones() {
    let dir = exported("clients-instances");
    let flat = ("leaf_normals", "flat");
    for (name, scene) in [
        ("outlines", foliage::scene().2),
        ("cards", dressed(&[("leaf_form", "card"), flat]).2),
        ("curved", dressed(&[("leaf_form", "curved")]).2),
    ] {
        // The first is baked: what the others are compared with.
        export(&scene, "obj", &[], &dir.join(format!("{name}.obj"))).unwrap();
        for format in ["gltf", "glb", "usda", "usdz"] {
            export(&scene, format, &[ON], &dir.join(format!("{name}.{format}"))).unwrap();
        }
        let small = dir.join(format!("{name}_small.glb"));
        export(&scene, "glb", &[ON, ("quantize", "true")], &small).unwrap();
        export(&scene, "ply", &[], &small.with_extension("ply")).unwrap();
        let setting = dir.join(format!("{name}_setting.obj"));
        let stage = Stage::of(&scene).in_setting();
        export_stage(&stage, "obj", &[], &setting).unwrap();
        for format in ["glb", "usda"] {
            export_stage(&stage, format, &[ON], &setting.with_extension(format)).unwrap();
        }
    }
    run("check.py", &dir);
}

#[test]
fn instanced_leaves_have_levels() {
    let dir = exported("clients-instances-levels");
    let (mut recipe, grown, _) = dressed(&[]);
    recipe.preset.set("lods", "2").unwrap();
    let levels = levels(&recipe, &grown, &Quiet).unwrap();
    let stage = levels.stage();
    assert_eq!(stage.levels(), 2);
    for level in 0..2 {
        let name = dir.join(format!("tree_LOD{level}.obj"));
        export_stage(&stage.at_level(level), "obj", &[], &name).unwrap();
        // Readers find the finest of several levels.
        let stage = if level == 0 { stage.clone() } else { stage.at_level(1) };
        for format in ["glb", "usda"] {
            export_stage(&stage, format, &[ON], &name.with_extension(format)).unwrap();
        }
    }
    run("check.py", &dir);
}

#[test]
fn seasons_have_instances_of_their_own() {
    let (_, _, summer) = dressed(&[]);
    let mut autumn = summer.clone();
    autumn.materials[1].roughness = 0.9;
    let mut stage = Stage::of(&summer);
    let mut late = stage.plants[0].seasons[0].clone();
    "autumn".clone_into(&mut late.name);
    late.levels[0].scene = &autumn;
    stage.plants[0].seasons.push(late);
    let dir = exported("clients-instances-seasons");
    export(&summer, "obj", &[], &dir.join("tree.obj")).unwrap();
    export_stage(&stage, "usda", &[ON], &dir.join("tree.usda")).unwrap();
    run("check.py", &dir);
    let text = std::fs::read_to_string(dir.join("tree.usda")).unwrap();
    let count = |what: &str| text.matches(what).count();
    assert_eq!((count("def PointInstancer \"leaves_instances\""), count("_wood\" (")), (2, 1));
}

#[test]
fn each_variant_is_one_mesh_however_many_leaves() {
    let (_, grown, scene) = dressed(&[]);
    let dir = tempfile::tempdir().unwrap();
    let target = dir.path().join("tree.glb");
    export(&scene, "glb", &[ON], &target).unwrap();
    let (document, buffers) = {
        let file = gltf::Gltf::from_slice_without_validation(&std::fs::read(&target).unwrap()).unwrap();
        (file.document, file.blob.unwrap())
    };
    let variants = grown.organs.shapes.len();
    assert!(variants > 1 && grown.organs.len() > 200);
    assert_eq!(document.meshes().count(), 1 + variants);
    assert_eq!(document.nodes().count(), 2 + variants, "the root, the wood and a node for each");
    let json = document.into_json();
    assert_eq!(json.extensions_required, ["EXT_mesh_gpu_instancing"]);
    assert!(buffers.len() > 40 * grown.organs.len());
    let last = usize::from(*grown.organs.placed.prototypes.iter().max().unwrap());
    assert!(last < PROTOTYPES.len() + variants);
}

/// What is said of an export.
fn notes(stage: &Stage<'_>, format: &str, options: &[(&str, &str)]) -> (Vec<String>, Vec<u8>) {
    let dir = tempfile::tempdir().unwrap();
    let target = dir.path().join("tree.any");
    let exporter = find(format).unwrap();
    let mut values = Options::new(exporter.format());
    for (name, value) in options {
        values.set(name, value).unwrap();
    }
    let mut bundle = Bundle::create(&target).unwrap();
    exporter.write(stage, &values, &mut bundle, &Quiet).unwrap();
    let notes = bundle.notes().to_vec();
    bundle.commit().unwrap();
    (notes, std::fs::read(&target).unwrap())
}

#[test]
fn what_is_no_copy_stays_and_is_told() {
    let (_, _, blown) = dressed(&[("wind", "sway")]);
    let (_, _, dome) = dressed(&[("leaf_normals", "dome")]);
    let (_, _, flat) = dressed(&[("leaf_normals", "flat")]);
    for format in ["glb", "usdz"] {
        let (said, swaying) = notes(&Stage::of(&blown), format, &[ON]);
        assert!(said.iter().any(|line| line.contains("wind")), "{format}: {said:?}");
        assert_eq!(swaying, notes(&Stage::of(&blown), format, &[]).1);
        let (said, _) = notes(&Stage::of(&dome), format, &[ON]);
        assert!(said.iter().any(|line| line.contains("leaf_normals=dome")), "{format}: {said:?}");
        let (said, bytes) = notes(&Stage::of(&flat), format, &[ON]);
        assert_eq!(said, [""; 0], "{format}");
        assert_ne!(bytes, notes(&Stage::of(&flat), format, &[]).1);
    }
    // Phones refuse instancers.
    let ar = ("flavor", "ar");
    assert_eq!(notes(&Stage::of(&flat), "usdz", &[ar, ON]).1, notes(&Stage::of(&flat), "usdz", &[ar]).1);
    // In a forest the trees are the instances.
    let mut forest = Stage::of(&flat);
    forest.places.push(Place { position: glam::Vec3::X * 9.0, ..Place::origin(0) });
    let text = String::from_utf8(notes(&forest, "usda", &[ON]).1).unwrap();
    assert_eq!(text.matches("def PointInstancer").count(), 1);
}

#[test]
fn instances_do_not_depend_on_the_number_of_threads() {
    let (_, _, scene) = dressed(&[]);
    let with = |threads: usize, format: &str| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| notes(&Stage::of(&scene), format, &[ON]).1)
    };
    for format in ["glb", "usdz"] {
        assert!(with(1, format) == with(2, format), "{format}");
    }
}
