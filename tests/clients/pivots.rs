//! Pivots in pictures: each vertex names a texel with what it turns about.

use std::fs;

use glam::Vec3;
use linden::Quiet;
use linden::dress::dress;
use linden::grow::grow;
use linden::preset::builtin;
use linden::recipe::Recipe;
use linden::scene::Scene;
use linden::stage::{Place, Plant, Stage};
use linden_tests::fixtures::{export, export_stage};

use crate::instances::dressed;
use crate::outside::{exported, run};

const PIVOTS: (&str, &str) = ("wind_as", "pivot-painter");

/// An umbrella that forks nine times, one axis from the other.
fn forked() -> Scene {
    let mut preset = builtin("dressed-aono-d").unwrap().load().unwrap();
    for (knob, value) in [("wind", "attributes"), ("bark_size", "32"), ("leaf_size", "32")] {
        preset.set(knob, value).unwrap();
    }
    let recipe = Recipe::new(preset);
    dress(&recipe, &grow(&recipe, &Quiet).unwrap(), &Quiet).unwrap()
}

/// The axes of a tree, by its skeleton.
fn axes(scene: &Scene) -> String {
    let wood = &scene.skeleton;
    let mut owner = vec![0; wood.positions.len()];
    for (index, axis) in wood.axes.iter().enumerate() {
        wood.nodes_of(axis).iter().for_each(|&node| owner[node as usize] = index);
    }
    let told = wood.axes.iter().enumerate().map(|(index, axis)| {
        let is_stem = axis.order == 0;
        let nodes = wood.nodes_of(axis);
        let foot = if is_stem { nodes[0] } else { axis.parent };
        let pivot = wood.positions[foot as usize];
        let along: Vec3 = (wood.positions[*nodes.last().unwrap() as usize] - pivot).normalize();
        let parent = if is_stem { index } else { owner[axis.parent as usize] };
        serde_json::json!({
            "axis": index, "level": axis.order, "parent": parent,
            "pivot": pivot.to_array(), "along": along.to_array(),
        })
    });
    serde_json::Value::Array(told.collect()).to_string()
}

#[test]
fn texels_have_the_pivots_of_the_vertices_that_name_them() {
    let dir = exported("clients-pivots");
    let scene = forked();
    assert!(scene.skeleton.axes.iter().any(|axis| axis.order > 3), "some axes go with what bears them");
    export(&scene, "glb", &[], &dir.join("attributes.glb")).unwrap();
    export(&scene, "glb", &[PIVOTS], &dir.join("pivots.glb")).unwrap();
    export(&scene, "glb", &[PIVOTS, ("quantize", "true")], &dir.join("pivots small.glb")).unwrap();
    export(&scene, "gltf", &[PIVOTS], &dir.join("text.gltf")).unwrap();
    assert_eq!(
        fs::read(dir.join("text_pivots.exr")).unwrap(),
        fs::read(dir.join("pivots_pivots.exr")).unwrap(),
        "whatever the file around them"
    );
    run("check.py", &dir);
    fs::write(dir.join("axes.json"), axes(&scene)).unwrap();
    run("pivots.py", &dir);
}

#[test]
fn plants_have_pictures_of_their_own() {
    let dir = exported("clients-pivots-forest");
    let (one, other) =
        (dressed(&[("wind", "attributes")]).2, dressed(&[("wind", "attributes"), ("seed", "9")]).2);
    let mut wood = Stage::of(&one);
    wood.plants.push(Plant::of(&other));
    wood.places.push(Place { position: Vec3::X * 9.0, ..Place::origin(1) });
    let written = export_stage(&wood, "glb", &[PIVOTS], &dir.join("wood.glb")).unwrap();
    assert_eq!(written.len(), 5);
    let (document, ..) = gltf::import(dir.join("wood.glb")).unwrap();
    let mut pictures = std::collections::BTreeSet::new();
    for mesh in document.meshes() {
        let told: serde_json::Value = serde_json::from_str(mesh.extras().as_ref().unwrap().get()).unwrap();
        for kind in ["pivots", "axes"] {
            let name = told["linden_pivot_painter"][kind].as_str().unwrap();
            assert!(dir.join(name).is_file(), "{name}");
            pictures.insert(name.to_owned());
        }
    }
    assert_eq!(pictures.len(), 4);
}
