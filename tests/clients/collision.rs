//! Shapes for physics, before every client.

use glam::Vec3;
use linden::stage::{Place, Stage};
use linden_tests::fixtures::export_stage;

use crate::instances::dressed;
use crate::outside::{exported, run};

#[test]
fn every_client_takes_shapes_for_physics() {
    let dir = exported("clients-collision");
    let leafy = dressed(&[]).2;
    let stage = Stage::of(&leafy);
    for shapes in ["capsules", "hull"] {
        for way in ["omi", "unreal", "godot"] {
            let options = [("collision", shapes), ("collision_as", way)];
            export_stage(&stage, "glb", &options, &dir.join(format!("{way}_{shapes}.glb"))).unwrap();
        }
    }
    run("collision.py", &dir);
    for format in ["usda", "usdz"] {
        export_stage(&stage, format, &[("collision", "hull")], &dir.join(format!("leafy.{format}"))).unwrap();
    }
    let packed =
        [("collision", "hull"), ("collision_as", "unreal"), ("quantize", "true"), ("compress", "meshopt")];
    export_stage(&stage, "glb", &packed, &dir.join("packed.glb")).unwrap();
    // A body wherever a tree stands.
    let mut wood = stage.clone();
    wood.places.push(Place { position: Vec3::X * 9.0, turn_rad: 1.0, scale: 1.5, plant: 0 });
    for format in ["glb", "usda"] {
        export_stage(&wood, format, &[("collision", "capsules")], &dir.join(format!("wood.{format}")))
            .unwrap();
    }
    run("check.py", &dir);

    let (document, ..) = gltf::import(dir.join("wood.glb")).unwrap();
    let groups = document.nodes().filter(|node| {
        node.name().is_some_and(|name| name.contains("_collision_") && node.children().len() > 0)
    });
    let places: Vec<[f32; 3]> = groups.map(|node| node.transform().decomposed().0).collect();
    assert_eq!(places, [[0.0; 3], [9.0, 0.0, 0.0]]);
}
