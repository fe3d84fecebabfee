//! Trees that sway: what they say about themselves holds in each frame, with leaves and without.

use glam::Vec3;
use linden::Quiet;
use linden::dress::levels;
use linden::grow::grow;
use linden::preset::builtin;
use linden::recipe::Recipe;
use linden::stage::{Place, Plant, Stage};
use linden_tests::fixtures::{export, export_stage};

use crate::instances::dressed;
use crate::outside::{exported, run};

#[test]
fn every_client_takes_what_sways() {
    let dir = exported("clients-wind");
    let sway = ("wind", "sway");
    let leafy = dressed(&[sway]).2;
    let bare = dressed(&[sway, ("leaf_keep", "0")]).2;
    for (name, scene) in [("leafy", &leafy), ("bare", &bare)] {
        for format in ["glb", "gltf", "usda", "usdz"] {
            export(scene, format, &[], &dir.join(format!("{name}.{format}"))).unwrap();
        }
    }
    // Meshes of a forest have targets for all that one of their parts does.
    let mut wood = Stage::of(&leafy);
    wood.plants.push(Plant::of(&bare));
    wood.places.push(Place { position: Vec3::X * 9.0, ..Place::origin(1) });
    for format in ["glb", "usda"] {
        export_stage(&wood, format, &[], &dir.join(format!("wood.{format}"))).unwrap();
    }
    run("check.py", &dir);

    let targets = |file: &str| -> Vec<usize> {
        let (document, ..) = gltf::import(dir.join(file)).unwrap();
        document
            .meshes()
            .flat_map(|mesh| mesh.primitives().map(|p| p.morph_targets().count()).collect::<Vec<_>>())
            .collect()
    };
    assert_eq!((targets("bare.glb"), targets("leafy.glb")[0]), (vec![4], 4), "wood does not flutter");
    let leaves = &targets("leafy.glb")[1..];
    assert!(leaves.iter().all(|count| *count == 6) && !leaves.is_empty());

    // Trees of a forest are instances, which nothing bakes.
    std::fs::remove_file(dir.join("wood.usda")).unwrap();
    run("wind.py", &dir);
}

#[test]
fn packed_wind_is_the_wind_within_a_step() {
    let dir = exported("clients-wind-packed");
    let scene = dressed(&[("wind", "attributes")]).2;
    let packed = ("wind_as", "packed");
    export(&scene, "glb", &[packed], &dir.join("whole.glb")).unwrap();
    export(&scene, "glb", &[packed, ("quantize", "true")], &dir.join("quantized.glb")).unwrap();
    run("check.py", &dir);
    let (document, buffers, _) = gltf::import(dir.join("whole.glb")).unwrap();
    assert_eq!(document.meshes().count(), scene.parts.len());
    for (mesh, part) in document.meshes().zip(&scene.parts) {
        let told: serde_json::Value = serde_json::from_str(mesh.extras().as_ref().unwrap().get()).unwrap();
        let [x, y, z, side] = [0, 1, 2, 3].map(|i| told["linden_wind_cube"][i].as_f64().unwrap() as f32);
        let primitive = mesh.primitives().next().unwrap();
        let reader = primitive.reader(|buffer| Some(&buffers[buffer.index()].0[..]));
        let colors = reader.read_colors(0).unwrap().into_rgba_f32();
        let flat = reader.read_tex_coords(1).unwrap().into_f32();
        let high = reader.read_tex_coords(2).unwrap().into_f32();
        let wind = part.wind.as_ref().unwrap();
        for (((color, flat), high), (motion, pivot)) in
            colors.zip(flat).zip(high).zip(wind.motions.iter().zip(&wind.pivots))
        {
            let [level, phase, sway, flutter] = *motion;
            for (read, told) in color.into_iter().zip([phase, sway, flutter, 1.0]) {
                assert!((read - told).abs() <= 0.5 / 255.0 + 1e-6, "{color:?} of {motion:?}");
            }
            let read = Vec3::new(x, y, z) + side * Vec3::new(flat[0], high[0], flat[1]);
            assert!(read.distance(Vec3::from_slice(&pivot[..3])) < 1e-4 * side, "{read} of {pivot:?}");
            assert_eq!((high[1] * 16.0).round(), level);
        }
    }
}

/// The formula is read out of the document by `swing.py`.
#[test]
fn limbs_stay_on_the_stem_in_the_shader_of_the_document() {
    let dir = exported("clients-wind-shader");
    for (id, options) in [
        ("silver-birch", &[][..]),
        ("scots-pine", &[("wind_as", "packed")]),
        ("weeping-willow", &[("wind_as", "packed")]),
    ] {
        let mut preset = builtin(id).unwrap().load().unwrap();
        for (knob, value) in
            [("wind", "attributes"), ("triangles", "10000"), ("bark_size", "64"), ("leaf_size", "128")]
        {
            preset.set(knob, value).unwrap();
        }
        let recipe = Recipe::new(preset);
        let grown = grow(&recipe, &Quiet).unwrap();
        let dressed = levels(&recipe, &grown, &Quiet).unwrap();
        export(&dressed.levels[0].scene, "glb", options, &dir.join(format!("{id}.glb"))).unwrap();
    }
    run("swing.py", &dir);
}
