//! Trees that sway: what they say about themselves holds in each frame, with leaves and without.

use glam::Vec3;
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
